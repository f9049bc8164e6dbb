//! `cargo xtask demo`: one picture that shows what the project does.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use crate::process::cargo;
use crate::setup;

const SCENE: &str = "scenes/showcase.ron";
const PICTURE: &str = "target/showcase.png";

/// Builds the program optimised and renders the showcase. By the line that a person types: selecting a package might choose other features of
/// shared crates, and so build them twice.
pub fn run() -> Result<()> {
    let environment = setup::environment()?;
    fs::create_dir_all("target").context("cannot create target/")?;
    cargo()
        .arguments(["run", "--release", "--"])
        .arguments(["render", SCENE, "-o", PICTURE, "--size", "960x540"])
        .inside(&environment)
        .run()?;
    let picture = Path::new(PICTURE);
    let picture = picture.canonicalize().with_context(|| format!("{PICTURE} was not written"))?;
    eprintln!("The picture is in {}", picture.display());
    Ok(())
}
