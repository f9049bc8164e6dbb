//! Wavefront OBJ meshes.
//!
//! Read: vertices, normals, texture coordinates, colours of vertices, faces of any number of corners, smoothing groups, relative indices,
//! continued lines, materials with their colours and pictures, all objects and groups as one mesh. Not read: weights, points, lines,
//! free-form curves and surfaces.

mod library;
mod scan;

use std::{
    io::{BufRead, BufReader, Read},
    path::Path,
};

use super::mesh::draft::Draft;
use super::mesh::{Normals, colour, counted};
use super::{MeshData, SourceError, file};
use scan::Found;

/// The longest file that is read, in bytes: 1 GiB. In memory it may take ten times that while it is read.
pub const MAX_OBJ_BYTES: u64 = 1 << 30;

/// Bytes at the beginning that tell text from anything else.
const HEAD_BYTES: usize = 4096;

/// Reads an OBJ mesh; several objects become one mesh.
///
/// # Errors
///
/// If the file cannot be read, is longer than [`MAX_OBJ_BYTES`], is not 8-bit text, has a number or index that cannot be
/// understood or points outside, or no triangle is left. What is dropped without harm is told in the mesh's notes.
pub fn read_obj(path: &Path, rule: Normals) -> Result<MeshData, SourceError> {
    let (file, bytes) = file::open(path)?;
    if bytes > MAX_OBJ_BYTES {
        let mend = "split or decimate the mesh";
        return Err(SourceError::TooLarge { path: path.to_owned(), bytes, limit: MAX_OBJ_BYTES, mend });
    }
    // It may have grown since.
    read_from(path, BufReader::with_capacity(1 << 16, file.take(MAX_OBJ_BYTES)), rule)
}

/// The same of a stream that begins with the mesh.
pub(super) fn read_from(
    path: &Path,
    mut input: impl BufRead,
    rule: Normals,
) -> Result<MeshData, SourceError> {
    let head = input.fill_buf().map_err(|cause| file::io_error(path, cause))?;
    let byte_order_mark = check_encoding(path, &head[..head.len().min(HEAD_BYTES)])?;
    input.consume(byte_order_mark);
    let scanned = scan::scan(path, input)?;
    let (mut draft, found) = (scanned.draft, scanned.found);
    draft.notes = notes_on(&found);
    tell_colours(&mut draft);
    draft.materials = library::read(path, &scanned.libraries, &scanned.names, &mut draft.notes);
    let vertices = draft.positions.len() as u64;
    let mesh = draft.finish(path, rule)?;
    if mesh.triangles.is_empty() {
        let found = describe(vertices, &found, &mesh.notes);
        return Err(SourceError::NoTriangles { path: path.to_owned(), found });
    }
    Ok(mesh)
}

/// Makes colours linear, and tells what was assumed of them.
fn tell_colours(draft: &mut Draft) {
    if draft.colours.is_empty() {
        return;
    }
    draft.colours.resize(draft.positions.len(), [f32::NAN; 4]);
    let is_of_bytes = colour::decode_vertex_colours(&mut draft.colours);
    if is_of_bytes {
        draft.notes.push("colours of vertices are above 1: taken as 0 to 255".to_owned());
    }
    let given = draft.colours.iter().filter(|colour| !colour[0].is_nan()).count();
    if given < draft.colours.len() {
        let all = counted(draft.colours.len() as u64, "vertex");
        draft.notes.push(format!("{given} of {all} have a colour; the others are white"));
    }
}

/// Whether this is what an OBJ file begins with: statements of it, and a vertex among them.
pub(super) fn is_obj(head: &[u8]) -> bool {
    const KNOWN: &[&str] = &[
        "v",
        "vn",
        "vt",
        "vp",
        "f",
        "fo",
        "l",
        "p",
        "g",
        "o",
        "s",
        "mg",
        "usemtl",
        "mtllib",
        "usemap",
        "maplib",
        "cstype",
        "deg",
        "curv",
        "curv2",
        "surf",
        "parm",
        "trim",
        "hole",
        "end",
        "bevel",
        "c_interp",
        "d_interp",
        "lod",
        "shadow_obj",
        "trace_obj",
        "ctech",
        "stech",
        "bmat",
        "step",
        "sp",
        "scrv",
        "con",
    ];
    let text = String::from_utf8_lossy(head.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(head));
    let mut lines: Vec<&str> = text.split(['\n', '\r']).collect();
    // The last one may be cut off.
    if head.len() >= HEAD_BYTES {
        lines.pop();
    }
    let mut is_continued = false;
    let mut vertices = 0;
    for line in lines {
        let line = line.trim();
        let word = line.split_whitespace().next().unwrap_or_default();
        if !is_continued && !word.is_empty() && !word.starts_with('#') {
            if !KNOWN.contains(&word) {
                return false;
            }
            let numbers = line.split_whitespace().skip(1).take(3);
            vertices +=
                usize::from(word == "v" && numbers.filter(|word| word.parse::<f64>().is_ok()).count() == 3);
        }
        is_continued = line.ends_with('\\');
    }
    vertices > 0
}

/// Refuses what is not 8-bit text; gives the length of a byte order mark to skip.
fn check_encoding(path: &Path, head: &[u8]) -> Result<usize, SourceError> {
    let zeros = |parity: usize| head.iter().skip(parity).step_by(2).filter(|&&byte| byte == 0).count();
    let (found, mend) = if head.starts_with(&[0xff, 0xfe]) || zeros(1) > head.len() / 4 {
        ("UTF-16 (little-endian)", "convert it: iconv -f UTF-16LE -t UTF-8 old.obj > new.obj")
    } else if head.starts_with(&[0xfe, 0xff]) || zeros(0) > head.len() / 4 {
        ("UTF-16 (big-endian)", "convert it: iconv -f UTF-16BE -t UTF-8 old.obj > new.obj")
    } else if head.starts_with(&[0x1f, 0x8b]) {
        ("gzip", "unpack it with gunzip")
    } else if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") {
        ("PLY", "read it as PLY")
    } else if head.contains(&0) {
        ("binary data", "export the mesh as Wavefront OBJ")
    } else {
        return Ok(if head.starts_with(&[0xef, 0xbb, 0xbf]) { 3 } else { 0 });
    };
    Err(SourceError::Encoding { path: path.to_owned(), expected: "OBJ text in UTF-8", found, mend })
}

fn notes_on(found: &Found) -> Vec<String> {
    let short = counted(found.short_faces, "face");
    let elements = counted(found.points_and_lines, "point or line element");
    let free_forms = counted(found.free_forms, "free-form curve or surface");
    let weights = counted(found.weights, "weight");
    let textures = counted(found.odd_textures, "texture coordinate");
    let mut notes: Vec<_> = [
        (found.short_faces, format!("{short} with fewer than three corners dropped")),
        (found.points_and_lines, format!("{elements} ignored")),
        (found.free_forms, format!("{free_forms} ignored")),
        (found.weights, format!("{weights} (a fourth number of `v`) ignored: only rational curves have any")),
        (found.odd_textures, format!("{textures} left out: no such index")),
    ]
    .into_iter()
    .filter_map(|(count, note)| (count > 0).then_some(note))
    .collect();
    if found.is_cut_off {
        notes.push("the file ends within a face: it may be cut off".to_owned());
    }
    notes
}

/// What a file without triangles has instead.
fn describe(vertices: u64, found: &Found, notes: &[String]) -> String {
    let mut parts = vec![format!("{} and {}", counted(vertices, "vertex"), counted(found.faces, "face"))];
    parts.extend_from_slice(notes);
    parts.join(", ")
}

#[cfg(test)]
mod tests;
