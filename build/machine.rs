//! What the machine that builds the tests has. Shared by the build scripts of several packages.

use std::{
    env,
    path::{Path, PathBuf},
};

/// Sets `cfg(tyndall_gpu)` where a graphics adapter can be expected, so that tests which draw read *ignored* elsewhere.
pub fn tell_gpu() {
    println!("cargo::rustc-check-cfg=cfg(tyndall_gpu)");
    println!("cargo::rerun-if-env-changed=VK_DRIVER_FILES");
    println!("cargo::rerun-if-env-changed=VK_ICD_FILENAMES");
    for folder in manifest_folders() {
        println!("cargo::rerun-if-changed={}", folder.display());
    }
    let system = env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    if matches!(system.as_str(), "macos" | "windows") || has_vulkan_driver() {
        println!("cargo::rustc-cfg=tyndall_gpu");
    }
}

/// Sets `cfg(tyndall_display)` where windows can be opened on an X server in memory, Xvfb.
#[allow(dead_code, reason = "packages whose tests open no window do not ask")]
pub fn tell_display() {
    println!("cargo::rustc-check-cfg=cfg(tyndall_display)");
    println!("cargo::rerun-if-env-changed=PATH");
    let folders =
        env::var_os("PATH").map(|path| env::split_paths(&path).collect::<Vec<_>>()).unwrap_or_default();
    match folders.iter().map(|folder| folder.join("Xvfb")).find(|program| program.is_file()) {
        Some(program) => {
            println!("cargo::rerun-if-changed={}", program.display());
            println!("cargo::rustc-cfg=tyndall_display");
        }
        // It may be installed into any of them.
        None => folders.iter().filter(|folder| folder.is_dir()).for_each(|folder| {
            println!("cargo::rerun-if-changed={}", folder.display());
        }),
    }
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
