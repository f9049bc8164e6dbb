//! The variables that every command sets before it runs the program or its tests.

use std::ffi::OsString;
use std::path::Path;

use anyhow::{Context, Result};
use tempfile::TempDir;

use crate::adapter;
use crate::process::is_set;

/// A folder of test data beside the checkout; tests that want it are ignored without it.
const TEST_DATA: &str = "../shared/data";

/// Variables for child processes; what the user has set stays as it is.
pub struct Environment {
    variables: Vec<(&'static str, OsString)>,
    /// Lives as long as the programs that were told of it.
    _runtime_folder: Option<TempDir>,
}

impl Environment {
    pub fn new() -> Result<Self> {
        let mut variables = Vec::new();
        if !is_set("VK_ICD_FILENAMES")
            && !is_set("VK_DRIVER_FILES")
            && !adapter::has_gpu()
            && let Some(manifest) = adapter::lavapipe()
        {
            // Without a GPU the other drivers only cost time and print warnings.
            variables.push(("VK_ICD_FILENAMES", manifest.into_os_string()));
        }
        if !is_set("TYNDALL_DATA") && Path::new(TEST_DATA).is_dir() {
            let folder =
                Path::new(TEST_DATA).canonicalize().context("cannot resolve the test data folder")?;
            variables.push(("TYNDALL_DATA", folder.into_os_string()));
        }
        let mut runtime_folder = None;
        if cfg!(target_os = "linux") && !is_set("XDG_RUNTIME_DIR") {
            // Private to this user, as the window system's sockets require.
            let folder = tempfile::Builder::new().prefix("tyndall-runtime-").tempdir()?;
            variables.push(("XDG_RUNTIME_DIR", folder.path().into()));
            runtime_folder = Some(folder);
        }
        Ok(Self { variables, _runtime_folder: runtime_folder })
    }

    /// What programs inside see under this name.
    pub fn value(&self, name: &str) -> Option<OsString> {
        let own = self.variables().find(|(known, _)| *known == name).map(|(_, value)| value.clone());
        own.or_else(|| std::env::var_os(name))
    }

    pub fn variables(&self) -> impl Iterator<Item = (&'static str, &OsString)> {
        self.variables.iter().map(|(name, value)| (*name, value))
    }
}
