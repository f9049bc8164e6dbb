//! Every file of the folder of test data as the program opens it without a scene, beside what F3D and VTK make of it by themselves.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use image::{Rgb, RgbImage};

use super::{FOLDER, compose, program};
use crate::environment::Environment;
use crate::process::Program;

/// Cells of a sheet; each file has a picture of ours and one of each peer's.
const ROWS: usize = 6;
const COLUMNS: usize = 6;

/// Programs that are asked, and what `first_sight.py` calls them.
const PEERS: [(&str, &str); 2] = [("F3D", "f3d"), ("VTK", "vtk")];

/// Endings of what is opened.
const ENDINGS: [&str; 16] = [
    "obj", "ply", "stl", "gltf", "glb", "nrrd", "nhdr", "nii", "mha", "mhd", "dcm", "vtk", "vti", "tif",
    "tiff", "npy",
];

/// Draws all files, some to a sheet. What cannot be opened is an empty cell, and told.
pub fn run((across, down): (u32, u32), environment: &Environment) -> Result<()> {
    let Some(data) = environment.value("TYNDALL_DATA").map(PathBuf::from) else {
        bail!("let TYNDALL_DATA name the folder whose files are to be opened");
    };
    let mut files = Vec::new();
    collect(&data, &mut files)?;
    files.sort();
    let folder = Path::new(FOLDER).join("first_sight");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let python = python(&folder).map_err(|error| eprintln!("without F3D and VTK: {error:#}")).ok();
    let mut cells = Vec::new();
    for (index, file) in files.iter().enumerate() {
        let name = file.strip_prefix(&data).unwrap_or(file).display().to_string();
        let size = format!("{across}x{down}");
        let picture = folder.join(format!("{index:03}.png"));
        let ours =
            program().arguments(["render", "--size", &size, "-o"]).arguments([text(&picture), text(file)]);
        draw(&name, &picture, ours.inside(environment));
        cells.push((name.clone(), read(&picture, across, down)));
        for (title, peer) in PEERS {
            let picture = folder.join(format!("{index:03}_{peer}.png"));
            if let Some(python) = &python {
                let arguments = ["xtask/src/gallery/first_sight.py", peer].map(str::to_owned);
                let theirs = Program::new(&text(python)).arguments(arguments).arguments([
                    across.to_string(),
                    down.to_string(),
                    text(file),
                    text(&picture),
                ]);
                draw(&format!("{name}: {title}"), &picture, theirs.inside(environment));
            }
            cells.push((format!("{title}: {name}"), read(&picture, across, down)));
        }
    }
    for (number, cells) in cells.chunks(ROWS * COLUMNS).enumerate() {
        let path = Path::new(FOLDER).join(format!("first_sight_{number}.png"));
        let title = "Files opened without a scene: ours, and the defaults of F3D and VTK beside it";
        compose::sheet(title, cells, COLUMNS).save(&path).with_context(|| path.display().to_string())?;
        eprintln!("{}", path.display());
    }
    Ok(())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
            continue;
        }
        let name = path.to_string_lossy().to_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        if ENDINGS.iter().any(|ending| name.ends_with(&format!(".{ending}"))) {
            files.push(path);
        }
    }
    Ok(())
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

/// The picture, or an empty one.
fn read(path: &Path, across: u32, down: u32) -> RgbImage {
    match image::open(path) {
        Ok(picture) => picture.to_rgb8(),
        Err(_) => RgbImage::from_pixel(across, down, Rgb([60, 20, 20])),
    }
}

/// Has a program draw a picture; what it cannot is told.
fn draw(name: &str, picture: &Path, drawing: Program) {
    _ = fs::remove_file(picture);
    if let Err(error) = drawing.capture() {
        eprintln!("{name}: {error:#}");
    }
}

/// A Python with F3D and VTK in it, made in the folder.
fn python(folder: &Path) -> Result<PathBuf> {
    let python = folder.join(if cfg!(windows) { "venv/Scripts/python.exe" } else { "venv/bin/python" });
    if !python.is_file() {
        Program::new("python3").arguments(["-m", "venv"]).arguments([text(&folder.join("venv"))]).run()?;
        let wheels = ["-m", "pip", "install", "--quiet", "f3d", "vtk"];
        Program::new(&text(&python)).arguments(wheels).run()?;
    }
    Ok(python)
}
