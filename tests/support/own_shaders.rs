//! Tests whose shaders are their own. `TYNDALL_SHADERS` belongs to the process, so each test runs itself again with it set.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Says to a test that it is the one run again.
const AGAIN: &str = "TYNDALL_TEST_AGAIN";

/// Runs a test in a process whose shaders are in a folder of their own.
pub fn with_own_shaders(test: &str, run: impl FnOnce(&Path)) {
    if std::env::var_os(AGAIN).is_some() {
        return run(&PathBuf::from(std::env::var_os("TYNDALL_SHADERS").unwrap()));
    }
    let folder = tempfile::tempdir().unwrap();
    let shaders = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    for sub in ["", "shared"] {
        fs::create_dir_all(folder.path().join(sub)).unwrap();
        for entry in fs::read_dir(shaders.join(sub)).unwrap().map(Result::unwrap) {
            if entry.path().is_file() {
                fs::copy(entry.path(), folder.path().join(sub).join(entry.file_name())).unwrap();
            }
        }
    }
    let again = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", test, "--nocapture"])
        .env("TYNDALL_SHADERS", folder.path())
        .env(AGAIN, "yes")
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&again.stdout).into_owned() + &String::from_utf8_lossy(&again.stderr);
    assert!(again.status.success() && text.contains("1 passed"), "{text}");
}
