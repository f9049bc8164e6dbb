//! Meshes in files that say what they hold.
//!
//! | format | files | reader |
//! |---|---|---|
//! | Wavefront OBJ | .obj with its .mtl and pictures | own: statements, in double precision |
//! | PLY | .ply, text and binary | the crate `ply-rs-bw` |
//! | STL | .stl, text and binary | binary: the crate `stl_io`; text: own |
//! | glTF 2.0 | .gltf with its buffers, .glb | documents: the crate `gltf`; what is in the buffers: own |
//!
//! Any of them may be packed by gzip as a whole. Every reader hands a draft of polygons to the same steps: positions relative to an origin
//! where they lie far out, faces cut into triangles, triangles turned to face one way, normals made where there are none, equal vertices
//! joined. See [`Normals`] and [`MeshData`].

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::mesh::Normals;
use super::raw::GZIP_MAGIC;
use super::{MeshData, SourceError, file, gltf, obj, ply, stl};

/// Bytes that are looked at to tell formats apart.
const HEAD: u64 = 1 << 16;

/// Bytes that a packed file may hold: 1 GiB.
const MOST_UNPACKED: u64 = 1 << 30;

/// A format of meshes that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stanford's polygon files.
    Ply,
    /// Triangles for printing.
    Stl,
    /// glTF, as text or binary.
    Gltf,
}

/// Reads a mesh from a file that says itself what it holds.
///
/// The format is told by the content, and by the name only where the content says nothing. What a person should know about how it was read
/// is in [`MeshData::notes`].
///
/// # Errors
///
/// If the format is none that is read, or its reader refuses the file.
pub fn read_mesh(path: &Path, rule: Normals) -> Result<MeshData, SourceError> {
    let (mut file, bytes) = file::open(path)?;
    let is_packed = file::begins_with(path, &mut file, &GZIP_MAGIC)?;
    if is_packed {
        let content = unpack(path, file)?;
        let format = format_of(&content[..content.len().min(HEAD as usize)], content.len() as u64, path);
        let format = format.ok_or_else(|| unknown(path))?;
        return read_content(path, format, content, rule);
    }
    let format = format_of(&head(path, &mut file)?, bytes, path).ok_or_else(|| unknown(path))?;
    let limit = match format {
        MeshFormat::Obj => return obj::read_obj(path, rule),
        MeshFormat::Ply => MAX_PLY_BYTES,
        MeshFormat::Stl => stl::MAX_STL_BYTES,
        MeshFormat::Gltf => gltf::MAX_GLTF_BYTES,
    };
    if bytes > limit {
        let mend = "split or decimate the mesh";
        return Err(SourceError::TooLarge { path: path.to_owned(), bytes, limit, mend });
    }
    // It may have grown since.
    let mut input = BufReader::with_capacity(1 << 16, file.take(limit));
    match format {
        MeshFormat::Ply => ply::read(path, input, rule),
        MeshFormat::Stl => stl::read(path, input, rule),
        MeshFormat::Obj | MeshFormat::Gltf => {
            let mut content = Vec::new();
            input.read_to_end(&mut content).map_err(|cause| file::io_error(path, cause))?;
            read_content(path, format, content, rule)
        }
    }
}

/// The longest PLY file that is read, in bytes: 2 GiB.
const MAX_PLY_BYTES: u64 = 1 << 31;

fn read_content(
    path: &Path,
    format: MeshFormat,
    content: Vec<u8>,
    rule: Normals,
) -> Result<MeshData, SourceError> {
    match format {
        MeshFormat::Obj => obj::read_from(path, content.as_slice(), rule),
        MeshFormat::Ply => ply::read(path, content.as_slice(), rule),
        MeshFormat::Stl => stl::read(path, content.as_slice(), rule),
        MeshFormat::Gltf => gltf::read(path, &content, rule),
    }
}

/// The first bytes of a file; it is back at its beginning afterwards.
fn head(path: &Path, file: &mut File) -> Result<Vec<u8>, SourceError> {
    let mut head = Vec::new();
    let read = (&mut *file).take(HEAD).read_to_end(&mut head);
    read.and_then(|_| file.seek(SeekFrom::Start(0))).map_err(|cause| file::io_error(path, cause))?;
    Ok(head)
}

fn unpack(path: &Path, file: File) -> Result<Vec<u8>, SourceError> {
    let mut content = Vec::new();
    let read = MultiGzDecoder::new(BufReader::new(file)).take(MOST_UNPACKED + 1).read_to_end(&mut content);
    let unpacked = content.len() as u64;
    if let Err(cause) = read {
        let (problem, mend) = (format!("the gzip is corrupt or cut off ({cause})"), "fetch or pack it again");
        return Err(SourceError::Packed { path: path.to_owned(), unpacked, problem, mend });
    }
    if unpacked > MOST_UNPACKED {
        let mend = "split or decimate the mesh";
        return Err(SourceError::TooLarge {
            path: path.to_owned(),
            bytes: unpacked,
            limit: MOST_UNPACKED,
            mend,
        });
    }
    Ok(content)
}

/// The mesh format of a file by its first bytes, unpacked, and by its name where they say nothing. `bytes` is its whole length.
pub(super) fn format_of(head: &[u8], bytes: u64, path: &Path) -> Option<MeshFormat> {
    format_of_content(head, bytes).or_else(|| format_of_name(path))
}

/// The mesh format that the first bytes tell.
pub(super) fn format_of_content(head: &[u8], bytes: u64) -> Option<MeshFormat> {
    let is_ply =
        head.strip_prefix(ply::MAGIC).is_some_and(|rest| rest.first().is_some_and(u8::is_ascii_whitespace));
    if head.starts_with(gltf::MAGIC) {
        Some(MeshFormat::Gltf)
    } else if is_ply {
        Some(MeshFormat::Ply)
    } else if stl::is_binary(head, bytes) || stl::is_text(head) {
        Some(MeshFormat::Stl)
    } else if gltf::is_text(head) {
        Some(MeshFormat::Gltf)
    } else if obj::is_obj(head) {
        Some(MeshFormat::Obj)
    } else {
        None
    }
}

/// The mesh format that the name tells.
pub(super) fn format_of_name(path: &Path) -> Option<MeshFormat> {
    match ending(path).as_str() {
        "obj" => Some(MeshFormat::Obj),
        "ply" => Some(MeshFormat::Ply),
        "stl" => Some(MeshFormat::Stl),
        "gltf" | "glb" => Some(MeshFormat::Gltf),
        _ => None,
    }
}

/// What a name ends in, small, `.gz` left out.
fn ending(path: &Path) -> String {
    let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.').map(|(_, ending)| ending.to_owned()).unwrap_or_default()
}

fn unknown(path: &Path) -> SourceError {
    let found = match ending(path).as_str() {
        "fbx" => "FBX files are not read",
        "dae" => "COLLADA files are not read",
        "3ds" | "max" | "blend" | "c4d" | "ma" | "mb" => "scenes of modelling programs are not read",
        "off" => "OFF files are not read",
        "3mf" => "3MF files are not read",
        "usd" | "usda" | "usdc" | "usdz" | "abc" => "USD and Alembic files are not read",
        "wrl" | "x3d" => "VRML and X3D files are not read",
        "step" | "stp" | "iges" | "igs" | "ifc" => "models of curves and solids are not read",
        "vtp" | "vtu" => "meshes of VTK are not read",
        "mtl" => "a material library has no surface",
        _ => "not a mesh format that is known",
    };
    let mend = "export the mesh as glTF, PLY, STL or Wavefront OBJ";
    SourceError::Unsupported { path: path.to_owned(), found: found.to_owned(), mend: mend.to_owned() }
}

#[cfg(test)]
mod reported;
#[cfg(test)]
mod tests;
