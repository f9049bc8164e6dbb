//! Where the scans are: in the folder that `TYNDALL_DATA` names, or downloaded.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};

use crate::environment::Environment;

/// A mesh that is not part of the project.
#[derive(Clone, Copy)]
pub enum Scan {
    Bunny,
    Dragon,
    Buddha,
    Lucy,
    Sphere,
    Spot,
}

impl Scan {
    /// Its file under meshes/ in the folder of test data.
    fn file(self) -> &'static str {
        match self {
            Self::Bunny => "stanford-bunny.obj",
            Self::Dragon => "dragon_50k_100k.obj",
            Self::Buddha => "buddha_50k_100k.obj",
            Self::Lucy => "lucy_50k_100k.obj",
            Self::Sphere => "uv_sphere_382_800.obj",
            Self::Spot => "spot.obj",
        }
    }

    /// Where `cargo xtask assets --download` leaves one like it, and what to type for it.
    fn download(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Bunny => Some(("assets/downloaded/bunny.obj", "bunny")),
            Self::Dragon => Some(("assets/downloaded/dragon_2.obj", "dragon")),
            _ => None,
        }
    }
}

/// The scan's file.
pub fn find(scan: Scan, environment: &Environment) -> Result<PathBuf> {
    let data = environment.value("TYNDALL_DATA").filter(|folder| !folder.is_empty());
    find_in(scan, data.as_ref(), Path::new(""))
}

fn find_in(scan: Scan, data: Option<&OsString>, root: &Path) -> Result<PathBuf> {
    let in_data = data.map(|folder| Path::new(folder).join("meshes").join(scan.file()));
    if let Some(path) = in_data.filter(|path| path.is_file()) {
        return Ok(path);
    }
    let file = scan.file();
    let Some((path, model)) = scan.download() else {
        bail!("meshes/{file} is missing; let TYNDALL_DATA name a folder that has it");
    };
    let path = root.join(path);
    if !path.is_file() {
        bail!(
            "the mesh is missing; `cargo xtask assets --download {model}` fetches one, or let TYNDALL_DATA name a folder that has \
             meshes/{file}"
        );
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn data_comes_before_downloads() {
        let (data, root) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let folder: OsString = data.path().into();
        let downloaded = root.path().join("assets/downloaded/bunny.obj");
        fs::create_dir_all(downloaded.parent().unwrap()).unwrap();
        fs::write(&downloaded, "").unwrap();
        assert_eq!(find_in(Scan::Bunny, Some(&folder), root.path()).unwrap(), downloaded);

        let scan = data.path().join("meshes/stanford-bunny.obj");
        fs::create_dir(scan.parent().unwrap()).unwrap();
        fs::write(&scan, "").unwrap();
        assert_eq!(find_in(Scan::Bunny, Some(&folder), root.path()).unwrap(), scan);
    }

    #[test]
    fn what_is_missing_is_told_with_what_mends_it() {
        let root = tempfile::tempdir().unwrap();
        let told = |scan| find_in(scan, None, root.path()).unwrap_err().to_string();
        assert!(told(Scan::Dragon).contains("cargo xtask assets --download dragon"));
        assert!(told(Scan::Lucy).contains("TYNDALL_DATA"));
        assert!(told(Scan::Lucy).contains("meshes/lucy_50k_100k.obj"));
    }
}
