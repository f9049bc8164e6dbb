//! Is there a GPU adapter? Answered without linking a GPU library, from what the Vulkan loader would read.
//!
//! Metal and DirectX 12 are part of their systems. Vulkan needs a loader, `libvulkan.so.1`, and at least one
//! driver manifest (<https://github.com/KhronosGroup/Vulkan-Loader>, `LoaderDriverInterface.md`) whose library
//! exists for this processor.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

const LOADER: &str = "libvulkan.so.1";

/// Drivers that draw on the processor, recognised by their library's name.
const SOFTWARE_DRIVERS: [&str; 3] = ["libvulkan_lvp", "libvk_swiftshader", "libvulkan_swrast"];

/// What can draw here.
pub enum Adapter {
    /// Comes with the operating system.
    System(&'static str),
    /// A Vulkan driver, by its manifest.
    Vulkan(PathBuf),
}

/// Why nothing can draw here.
#[derive(Debug, PartialEq, Eq)]
pub enum Missing {
    Loader,
    Driver,
}

/// Finds out what can draw here.
pub fn find() -> Result<Adapter, Missing> {
    if cfg!(target_vendor = "apple") {
        return Ok(Adapter::System("Metal"));
    }
    if cfg!(windows) {
        return Ok(Adapter::System("DirectX 12"));
    }
    let folders = library_folders();
    find_library(Path::new(LOADER), &folders).ok_or(Missing::Loader)?;
    let has_gpu = has_gpu();
    manifests()
        .into_iter()
        .find(|manifest| {
            driver_of(manifest, &folders).is_some_and(|library| has_gpu || is_software(&library))
        })
        .map(Adapter::Vulkan)
        .ok_or(Missing::Driver)
}

/// The manifest of Mesa's software driver, where it is installed.
pub fn lavapipe() -> Option<PathBuf> {
    let folders = library_folders();
    manifests().into_iter().find(|manifest| {
        manifest.file_name().is_some_and(|name| name.to_string_lossy().starts_with("lvp_icd."))
            && driver_of(manifest, &folders).is_some()
    })
}

/// True where the kernel offers a graphics device, so that a hardware driver may find something to drive.
pub fn has_gpu() -> bool {
    let render_node = || {
        let entries = fs::read_dir("/dev/dri").into_iter().flatten().flatten();
        entries.into_iter().any(|entry| entry.file_name().to_string_lossy().starts_with("renderD"))
    };
    ["/dev/nvidiactl", "/dev/nvidia0", "/dev/dxg"].iter().any(|path| Path::new(path).exists())
        || render_node()
}

fn is_software(library: &Path) -> bool {
    let name = library.file_name().unwrap_or_default().to_string_lossy();
    SOFTWARE_DRIVERS.iter().any(|prefix| name.starts_with(prefix))
}

/// Driver manifests in the loader's order; naming some by variable hides all others, as it does for the loader.
fn manifests() -> Vec<PathBuf> {
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        if let Some(list) = std::env::var_os(variable).filter(|list| !list.is_empty()) {
            return std::env::split_paths(&list).flat_map(|path| json_files(&path)).collect();
        }
    }
    let user = std::env::var_os("XDG_DATA_HOME").map(PathBuf::from);
    let user = user.or_else(|| std::env::home_dir().map(|home| home.join(".local/share")));
    let system = ["/etc", "/usr/local/share", "/usr/share", "/run/opengl-driver/share"];
    let parents = user.into_iter().chain(system.into_iter().map(PathBuf::from));
    parents.flat_map(|parent| json_files(&parent.join("vulkan/icd.d"))).collect()
}

/// The file itself, or the manifests in the folder, in a fixed order.
fn json_files(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_owned()];
    }
    let entries = fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut files: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|extension| extension == "json")).collect();
    files.sort();
    files
}

/// The library that a manifest names, where it exists for this processor.
fn driver_of(manifest: &Path, folders: &[PathBuf]) -> Option<PathBuf> {
    let manifest_text = fs::read_to_string(manifest).ok()?;
    let json: serde_json::Value = serde_json::from_str(&manifest_text).ok()?;
    let named = PathBuf::from(json.get("ICD")?.get("library_path")?.as_str()?);
    if named.components().count() == 1 {
        return find_library(&named, folders);
    }
    let library = manifest.parent()?.join(named);
    is_for_this_processor(&library).then_some(library)
}

fn find_library(name: &Path, folders: &[PathBuf]) -> Option<PathBuf> {
    folders.iter().map(|folder| folder.join(name)).find(|path| is_for_this_processor(path))
}

/// Where the dynamic linker looks: LD_LIBRARY_PATH, what /etc/ld.so.conf.d lists, and the built-in folders.
fn library_folders() -> Vec<PathBuf> {
    let from_variable = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    let mut folders: Vec<PathBuf> = std::env::split_paths(&from_variable).collect();
    for entry in fs::read_dir("/etc/ld.so.conf.d").into_iter().flatten().flatten() {
        let lines = fs::read_to_string(entry.path()).unwrap_or_default();
        folders.extend(lines.lines().filter(|line| line.starts_with('/')).map(PathBuf::from));
    }
    for folder in ["/lib", "/usr/lib", "/lib64", "/usr/lib64", "/usr/local/lib", "/run/opengl-driver/lib"] {
        folders.push(folder.into());
    }
    folders
}

/// Compares class and machine of two ELF headers: a 32-bit driver is of no use to a 64-bit program.
fn is_for_this_processor(library: &Path) -> bool {
    let kind = |path: &Path| {
        let mut header = [0; 20];
        File::open(path).and_then(|mut file| file.read_exact(&mut header)).ok()?;
        header.starts_with(b"\x7fELF").then_some((header[4], [header[18], header[19]]))
    };
    kind(library).is_some_and(|found| std::env::current_exe().is_ok_and(|this| kind(&this) == Some(found)))
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use super::*;

    fn manifest_naming(library: &str, folder: &Path) -> PathBuf {
        let path = folder.join("lvp_icd.test.json");
        fs::write(&path, format!(r#"{{"ICD": {{"library_path": "{library}", "api_version": "1.3"}}}}"#))
            .unwrap();
        path
    }

    #[test]
    fn a_manifest_counts_only_with_its_library() {
        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join("libvulkan_lvp.so");
        let folders = [folder.path().to_owned()];
        let bare = manifest_naming("libvulkan_lvp.so", folder.path());
        assert_eq!(driver_of(&bare, &folders), None, "no such file yet");

        fs::copy(std::env::current_exe().unwrap(), &library).unwrap();
        assert_eq!(driver_of(&bare, &folders), Some(library.clone()));
        assert_eq!(driver_of(&bare, &[]), None, "not where the linker looks");
        assert!(is_software(&library));

        let relative = manifest_naming("./libvulkan_lvp.so", folder.path());
        assert!(driver_of(&relative, &[]).is_some());
    }

    #[test]
    fn a_library_for_another_processor_does_not_count() {
        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join("libvulkan_lvp.so");
        let mut header = fs::read(std::env::current_exe().unwrap()).unwrap();
        header[4] = 3 - header[4];
        fs::write(&library, &header[..64]).unwrap();
        assert!(!is_for_this_processor(&library));
        fs::write(&library, "not a library").unwrap();
        assert!(!is_for_this_processor(&library));
    }

    #[test]
    fn a_broken_manifest_is_passed_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("broken.json");
        fs::write(&path, "{").unwrap();
        assert_eq!(driver_of(&path, &[]), None);
    }
}
