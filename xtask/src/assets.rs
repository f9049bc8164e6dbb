//! `cargo xtask assets`: the files under assets/ that the project makes itself, and those it can download.

mod bunny;
mod c60;
mod download;
mod lotus;
mod mesh;
mod mri;
mod packages;
mod ply;

use std::fs;
use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result, bail};

/// The options of the command.
#[derive(clap::Args)]
pub struct Arguments {
    /// Only compare the files with what would be made
    #[arg(long, conflicts_with = "download")]
    check: bool,
    /// Fetch a model that may not be committed, into assets/downloaded/
    #[arg(long, value_name = "MODEL")]
    download: Option<packages::Model>,
    /// The dragon's resolution, 1 the finest
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=4), requires = "download")]
    level: u8,
}

/// A file that the project makes.
struct Shipped {
    path: &'static str,
    make: fn() -> Vec<u8>,
}

const SHIPPED: [Shipped; 2] = [
    Shipped { path: "assets/c60_32x32x32_u8.raw", make: c60::raw },
    Shipped { path: "assets/lotus.obj", make: lotus::obj },
];

/// Makes, checks or downloads.
pub fn run(arguments: &Arguments) -> Result<()> {
    match arguments.download {
        Some(model) => download::run(model, arguments.level),
        None if arguments.check => check(),
        None => make(),
    }
}

fn make() -> Result<()> {
    for Shipped { path, make } in SHIPPED {
        let contents = make();
        write(Path::new(path), &contents)?;
        eprintln!("{path}: {} bytes", contents.len());
    }
    Ok(())
}

/// Fails unless every file is byte for byte what `make` would write.
pub fn check() -> Result<()> {
    for Shipped { path, make } in SHIPPED {
        let committed = fs::read(path).with_context(|| format!("cannot read {path}"))?;
        if committed != make() {
            bail!(
                "{path} differs from what this project makes; run `cargo xtask assets` and look at the change"
            );
        }
    }
    Ok(())
}

/// Writes so that a reader finds the old file or the new one, never half of it.
fn write(path: &Path, contents: &[u8]) -> Result<()> {
    let write = || -> Result<()> {
        let folder = path.parent().context("it has no folder")?;
        fs::create_dir_all(folder)?;
        let mut file = tempfile::Builder::new().make_in(folder, |path| fs::File::create_new(path))?;
        file.write_all(contents)?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}
