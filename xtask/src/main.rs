//! Developer commands of Tyndall, run as `cargo xtask COMMAND` from anywhere in the checkout.
//!
//! They need nothing but Rust: what else is missing, `setup` installs or names. This crate links neither the
//! GPU nor the framework, so that it builds in seconds on a new machine.

mod adapter;
mod assets;
mod ci;
mod demo;
mod environment;
mod gallery;
mod process;
mod setup;
mod test;
mod tools;

use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Developer commands of Tyndall")]
struct Arguments {
    #[command(subcommand)]
    command: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Find a GPU adapter, or install a software one
    Setup {
        /// Install the tools that `ci` needs as well
        #[arg(long)]
        ci: bool,
    },
    /// Run every test of the workspace
    Test {
        /// Passed on to `cargo nextest run`, or to `cargo test` where nextest is not installed
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Render the showcase scene to target/showcase.png
    Demo,
    /// Render contact sheets of translucent scans to target/gallery/
    Gallery(gallery::Arguments),
    /// All that a change has to pass: format, lints, licences, tests, docs, examples, scenes
    Ci,
    /// Make the assets that the project ships, or download others
    Assets(assets::Arguments),
}

fn main() -> ExitCode {
    match run(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(task: Task) -> Result<()> {
    enter_workspace()?;
    match task {
        Task::Setup { ci } => setup::run(ci),
        Task::Test { arguments } => test::run(&arguments),
        Task::Demo => demo::run(),
        Task::Gallery(arguments) => gallery::run(&arguments),
        Task::Ci => ci::run(),
        Task::Assets(arguments) => assets::run(&arguments),
    }
}

/// Every path in this crate starts at the workspace's root.
fn enter_workspace() -> Result<()> {
    // Asked for as it runs: checkouts that share a build folder share this program.
    let folder =
        std::env::var("CARGO_MANIFEST_DIR").unwrap_or_else(|_| env!("CARGO_MANIFEST_DIR").to_owned());
    let root = Path::new(&folder).parent().context("xtask/ lies in the workspace")?;
    std::env::set_current_dir(root).with_context(|| format!("cannot enter {}", root.display()))
}
