//! Tells the tests at build time what this machine has, so that a test which cannot run reads *ignored*, never passed.

#[path = "build/machine.rs"]
mod machine;

use std::{env, path::Path};

fn main() {
    println!("cargo::rustc-check-cfg=cfg(tyndall_data)");
    println!("cargo::rerun-if-env-changed=TYNDALL_DATA");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build/machine.rs");
    if env::var_os("TYNDALL_DATA").is_some_and(|folder| Path::new(&folder).is_dir()) {
        println!("cargo::rustc-cfg=tyndall_data");
    }
    machine::tell_gpu();
}
