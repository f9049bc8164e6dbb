//! The cargo subcommands of the gate, installed from source where they are missing.

use anyhow::{Context, Result};

use crate::process::{cargo, find};

/// A program of the gate.
struct Tool {
    name: &'static str,
    /// Another version that is already installed will do.
    version: &'static str,
    options: &'static [&'static str],
}

const TOOLS: [Tool; 2] = [
    // Without the part that updates itself, which brings a network stack along.
    Tool {
        name: "cargo-nextest",
        version: "0.9.151",
        options: &["--no-default-features", "--features", "default-no-update"],
    },
    Tool { name: "cargo-deny", version: "0.20.2", options: &[] },
];

/// True where `cargo nextest` works.
pub fn has_nextest() -> bool {
    find("cargo-nextest").is_some()
}

/// Installs what is missing into cargo's own folder for programs.
pub fn install_missing() -> Result<()> {
    for tool in &TOOLS {
        match find(tool.name) {
            Some(path) => eprintln!("{}: {}", tool.name, path.display()),
            None => install(tool).with_context(|| format!("cannot install {}", tool.name))?,
        }
    }
    Ok(())
}

/// Unoptimised and without debug information: both tools mostly wait, for tests or for files, and an optimised
/// build takes several times as long as all the time that it could save.
fn install(tool: &Tool) -> Result<()> {
    eprintln!("{}: installing version {}, once for this machine", tool.name, tool.version);
    cargo()
        .arguments(["install", "--locked", "--debug", &format!("{}@{}", tool.name, tool.version)])
        .arguments(tool.options)
        .variable("CARGO_PROFILE_DEV_DEBUG", "false")
        // Else the tool's crates would pile up in this project's build folder.
        .without_variable("CARGO_TARGET_DIR")
        .run()
}
