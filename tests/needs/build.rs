//! Finds out what the machine that builds the tests has.
//!
//! It is this package that follows the environment, not those whose tests ask: with other variables, or another driver, the tests are compiled
//! again, and the library and the program are not.

use std::env;
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    tell("gpu", has_gpu());
    tell("data", has_data());
    tell("display", has_display());
}

/// Sets `cfg(has_…)`.
fn tell(what: &str, is_there: bool) {
    println!("cargo::rustc-check-cfg=cfg(has_{what})");
    if is_there {
        println!("cargo::rustc-cfg=has_{what}");
    }
}

/// Whether a graphics adapter can be expected.
fn has_gpu() -> bool {
    println!("cargo::rerun-if-env-changed=VK_DRIVER_FILES");
    println!("cargo::rerun-if-env-changed=VK_ICD_FILENAMES");
    for folder in manifest_folders() {
        println!("cargo::rerun-if-changed={}", folder.display());
    }
    cfg!(any(target_os = "macos", windows)) || has_vulkan_driver()
}

/// Whether the folder of test data is there.
fn has_data() -> bool {
    println!("cargo::rerun-if-env-changed=TYNDALL_DATA");
    env::var_os("TYNDALL_DATA").is_some_and(|folder| Path::new(&folder).is_dir())
}

/// Whether windows can be opened on an X server in memory, Xvfb.
fn has_display() -> bool {
    println!("cargo::rerun-if-env-changed=PATH");
    let folders =
        env::var_os("PATH").map(|path| env::split_paths(&path).collect::<Vec<_>>()).unwrap_or_default();
    let program = folders.iter().map(|folder| folder.join("Xvfb")).find(|program| program.is_file());
    match &program {
        Some(program) => println!("cargo::rerun-if-changed={}", program.display()),
        // It may be installed into any of them.
        None => folders.iter().filter(|folder| folder.is_dir()).for_each(|folder| {
            println!("cargo::rerun-if-changed={}", folder.display());
        }),
    }
    program.is_some()
}

/// Whether a manifest of a Vulkan driver can be found as the Vulkan loader would find it: where the environment names some, no others count.
fn has_vulkan_driver() -> bool {
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        if let Some(list) = env::var_os(variable) {
            return env::split_paths(&list).any(|path| path.is_file() || has_manifest(&path));
        }
    }
    manifest_folders().iter().any(|folder| has_manifest(folder))
}

fn manifest_folders() -> Vec<PathBuf> {
    let system = ["/etc", "/usr/local/share", "/usr/share", "/run/opengl-driver/share"].map(PathBuf::from);
    let user = env::var_os("XDG_DATA_HOME")
        .map(PathBuf::from)
        .or_else(|| env::home_dir().map(|home| home.join(".local/share")));
    let folders = system.into_iter().chain(user).map(|folder| folder.join("vulkan/icd.d"));
    folders.filter(|folder| folder.is_dir()).collect()
}

fn has_manifest(folder: &Path) -> bool {
    let mut entries = folder.read_dir().into_iter().flatten().flatten();
    entries.any(|entry| entry.path().extension().is_some_and(|ending| ending == "json"))
}
