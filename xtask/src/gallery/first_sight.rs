//! Every file of the folder of test data as the program opens it without a scene, beside what F3D makes of it.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use image::{Rgb, RgbImage};

use super::{FOLDER, compose, program};
use crate::environment::Environment;
use crate::process::Program;

/// Files in a column of a sheet; each has a picture of ours and one of F3D's.
const ROWS: usize = 6;
const COLUMNS: usize = 6;

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
    let peer = peer(&folder).map_err(|error| eprintln!("without F3D: {error:#}")).ok();
    let mut cells = Vec::new();
    for (index, file) in files.iter().enumerate() {
        let name = file.strip_prefix(&data).unwrap_or(file).display().to_string();
        let (ours, theirs) =
            (folder.join(format!("{index:03}.png")), folder.join(format!("{index:03}_f3d.png")));
        _ = fs::remove_file(&ours);
        _ = fs::remove_file(&theirs);
        let size = format!("{across}x{down}");
        let drawn = program()
            .arguments(["render", "--size", &size, "-o"])
            .arguments([text(&ours), text(file)])
            .inside(environment)
            .capture();
        if let Err(error) = drawn {
            eprintln!("{name}: {error:#}");
        }
        if let Some(peer) = &peer {
            let arguments = [across.to_string(), down.to_string()];
            let drawn = Program::new(&text(peer))
                .arguments(["xtask/src/gallery/first_sight.py"])
                .arguments(arguments)
                .arguments([text(file), text(&theirs)])
                .inside(environment)
                .capture();
            if let Err(error) = drawn {
                eprintln!("{name}: F3D: {error:#}");
            }
        }
        cells.push((name.clone(), read(&ours, across, down)));
        cells.push((format!("F3D: {name}"), read(&theirs, across, down)));
    }
    for (number, cells) in cells.chunks(ROWS * COLUMNS).enumerate() {
        let path = Path::new(FOLDER).join(format!("first_sight_{number}.png"));
        let title = "Files opened without a scene: ours, and F3D's defaults beside it";
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

/// A Python with F3D in it, made in the folder.
fn peer(folder: &Path) -> Result<PathBuf> {
    let python = folder.join(if cfg!(windows) { "venv/Scripts/python.exe" } else { "venv/bin/python" });
    if !python.is_file() {
        Program::new("python3").arguments(["-m", "venv"]).arguments([text(&folder.join("venv"))]).run()?;
        Program::new(&text(&python)).arguments(["-m", "pip", "install", "--quiet", "f3d"]).run()?;
    }
    Ok(python)
}
