//! `cargo xtask gallery`: contact sheets of translucent scans, to judge by eye what no number tells.
//!
//! A sheet is a table of cells; each cell is a scene, written to target/gallery/scenes/, drawn by the program, and put with its label
//! into target/gallery/NAME.png. The scans are not part of the project: see `scans`.

mod compose;
mod first_sight;
mod scans;
mod scene;
mod sheets;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::environment::Environment;
use crate::process::{Program, cargo};
use crate::setup;
use sheets::{SHEETS, Sheet};

const FOLDER: &str = "target/gallery";

/// The options of the command.
#[derive(clap::Args)]
pub struct Arguments {
    /// Only these sheets; may be given more than once
    #[arg(long, value_name = "NAME", value_parser = names())]
    only: Vec<String>,
    /// Pixels of a square cell across and down; others keep the height
    #[arg(long, value_name = "WxH", default_value = "480x480", value_parser = size)]
    size: (u32, u32),
    /// Sets of samples to average in each cell, else as many as the sheet is made for
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    passes: Option<u32>,
    /// Instead of the sheets, every file of the folder TYNDALL_DATA opened without a scene, beside the defaults of F3D and VTK
    #[arg(long, conflicts_with_all = ["only", "passes"])]
    first_sight: bool,
}

fn names() -> clap::builder::PossibleValuesParser {
    SHEETS.iter().map(|sheet| sheet.name).collect::<Vec<_>>().into()
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let pixels = |text: &str| text.parse().ok().filter(|pixels| (1..=8192).contains(pixels));
    let parsed =
        text.split_once(['x', 'X']).and_then(|(across, down)| Some((pixels(across)?, pixels(down)?)));
    parsed.ok_or_else(|| "expected WIDTHxHEIGHT in pixels, such as 480x480".into())
}

/// Draws the sheets whose scans are there. Fails if none is, or one that was asked for.
pub fn run(arguments: &Arguments) -> Result<()> {
    let environment = setup::environment()?;
    if arguments.first_sight {
        fs::create_dir_all(FOLDER).with_context(|| format!("cannot create {FOLDER}"))?;
        return first_sight::run(arguments.size, &environment);
    }
    fs::create_dir_all(Path::new(FOLDER).join("scenes"))
        .with_context(|| format!("cannot create {FOLDER}"))?;
    let wanted =
        |sheet: &&Sheet| arguments.only.is_empty() || arguments.only.iter().any(|name| name == sheet.name);
    let mut drawn = 0;
    for sheet in SHEETS.iter().filter(wanted) {
        match scans::find(sheet.scan, &environment) {
            Ok(file) => {
                let path = draw(sheet, &file, arguments, &environment)?;
                eprintln!("{}", path.display());
                drawn += 1;
            }
            Err(error) if arguments.only.is_empty() => eprintln!("left out `{}`: {error:#}", sheet.name),
            Err(error) => return Err(error),
        }
    }
    if drawn == 0 {
        bail!("none of the scans is there, so there is nothing to draw");
    }
    Ok(())
}

fn draw(sheet: &Sheet, scan: &Path, arguments: &Arguments, environment: &Environment) -> Result<PathBuf> {
    let posed = scene::Posed::read(scan, sheet)?;
    let (across, down) = arguments.size;
    let size = ((f64::from(across) * sheet.aspect).round().max(1.0) as u32, down);
    let passes = arguments.passes.unwrap_or(sheet.passes);
    let mut pictures = Vec::new();
    for (index, cell) in sheet.cells().iter().enumerate() {
        let stem = format!("{FOLDER}/scenes/{}_{index:02}", sheet.name);
        let (file, picture) = (format!("{stem}.ron"), format!("{stem}.png"));
        let text = scene::text(sheet, cell, &posed, size);
        fs::write(&file, text).with_context(|| format!("cannot write {file}"))?;
        eprintln!("{file}: {}", cell.label);
        render(&file, &picture, size, passes, environment)?;
        let image = image::open(&picture).with_context(|| format!("cannot read {picture}"))?;
        pictures.push((cell.label.clone(), image.to_rgb8()));
    }
    let path = Path::new(FOLDER).join(format!("{}.png", sheet.name));
    let composed = compose::sheet(sheet.title, &pictures, sheet.columns);
    composed.save(&path).with_context(|| format!("cannot write {}", path.display()))?;
    Ok(path)
}

fn render(
    scene: &str,
    picture: &str,
    (across, down): (u32, u32),
    passes: u32,
    environment: &Environment,
) -> Result<()> {
    program()
        .arguments(["render", scene, "-o", picture, "--size", &format!("{across}x{down}")])
        .arguments(["--passes", &passes.to_string()])
        .inside(environment)
        .run()
}

/// The optimised program where there is one; brought up to date first, for a stale one would show what no longer is.
fn program() -> Program {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    let program = format!("tyndall{}", std::env::consts::EXE_SUFFIX);
    let profile = if target.join("release").join(program).is_file() { "release" } else { "dev" };
    cargo().arguments(["run", "--quiet", "--profile", profile, "-p", "tyndall-cli", "--bin", "tyndall", "--"])
}
