//! Wavefront OBJ meshes.
//!
//! Read: vertices, normals, faces of any number of corners, relative indices, continued lines, all objects and groups as one
//! mesh. Not read: materials, texture coordinates, colours, weights, points, lines, free-form curves and surfaces.

mod scan;
mod statements;
mod triangulate;

use std::{
    io::{BufRead, BufReader, Read},
    path::Path,
};

use glam::{DVec3, Vec3};

use super::{
    MeshData, SourceError, file,
    mesh::{Normals, counted},
};
use scan::{Found, Scanner};

/// The longest file that is read, in bytes: 1 GiB. In memory it may take ten times that while it is read.
pub const MAX_OBJ_BYTES: u64 = 1 << 30;

/// Bytes at the beginning that tell text from anything else.
const HEAD_BYTES: usize = 4096;

/// Reads an OBJ mesh; several objects become one mesh. One that lies far away from its origin is moved near it, which its `origin` tells.
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
    let mut input = BufReader::with_capacity(1 << 16, file.take(MAX_OBJ_BYTES));
    let head = input.fill_buf().map_err(|cause| file::io_error(path, cause))?;
    let byte_order_mark = check_encoding(path, &head[..head.len().min(HEAD_BYTES)])?;
    input.consume(byte_order_mark);
    let mut scanner = Scanner::new(path, input);
    let (numbers, normals, faces) = parse(&mut scanner)?;
    let origin = origin_of(&scanner.vertices);
    let positions: Vec<Vec3> = numbers
        .into_iter()
        .map(|number| {
            scanner
                .vertices
                .get(scan::number_of(number))
                .map_or(Vec3::NAN, |vertex| (vertex - origin).as_vec3())
        })
        .collect();
    let mut notes = notes_on(&scanner.found);
    let groups = scanner.has_groups.then_some(scanner.groups.as_slice());
    let (triangles, groups) = triangles_of(path, &positions, (&faces, groups), &mut notes)?;
    let mut mesh = MeshData::from_file(&positions, &normals, &triangles, groups.as_deref(), rule);
    mesh.origin = origin;
    if mesh.triangles.is_empty() {
        notes.append(&mut mesh.notes);
        return Err(SourceError::NoTriangles {
            path: path.to_owned(),
            found: describe(&scanner.found, &notes),
        });
    }
    notes.append(&mut mesh.notes);
    mesh.notes = notes;
    Ok(mesh)
}

/// How many times farther from the origin than it is large a mesh must lie to be moved there: beyond, single precision would show.
const FAR: f64 = 256.0;

/// What positions are to be relative to.
fn origin_of(vertices: &[DVec3]) -> DVec3 {
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let finite = vertices.iter().filter(|vertex| vertex.is_finite());
    let (low, high) = finite.fold(none, |(low, high), vertex| (low.min(*vertex), high.max(*vertex)));
    let (centre, extent) = ((low + high) / 2.0, (high - low).max_element());
    let is_far = centre.is_finite() && centre.abs().max_element() > FAR * extent;
    // Whole units, so that what is written stays recognisable.
    if is_far && extent > 0.0 { centre.round() } else { DVec3::ZERO }
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
        ("PLY", "export the mesh as OBJ")
    } else if head.contains(&0) {
        ("binary data", "export the mesh as Wavefront OBJ")
    } else {
        return Ok(if head.starts_with(&[0xef, 0xbb, 0xbf]) { 3 } else { 0 });
    };
    Err(SourceError::Encoding { path: path.to_owned(), expected: "OBJ text in UTF-8", found, mend })
}

/// The corners of all faces, each with its place in the vectors.
struct Faces {
    indices: Vec<u32>,
    /// Corners of each face; empty if all have three.
    arities: Vec<u32>,
}

impl Faces {
    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let faces = if self.arities.is_empty() { self.indices.len() / 3 } else { self.arities.len() };
        let mut rest = self.indices.as_slice();
        (0..faces).map_while(move |face| {
            let corners = self.arities.get(face).map_or(3, |&corners| corners as usize);
            let (corners, others) = rest.split_at_checked(corners)?;
            rest = others;
            Some(corners)
        })
    }
}

/// Has `tobj` parse what the scanner gives; normals that the file lacks are NaN.
fn parse(scanner: &mut Scanner<'_, impl BufRead>) -> Result<(Vec<Vec3>, Vec<Vec3>, Faces), SourceError> {
    let options = tobj::LoadOptions { single_index: true, ..Default::default() };
    let parsed = tobj::load_obj_buf(scanner, &options, |_| Ok(Default::default()));
    if let Some(error) = scanner.error.take() {
        return Err(error);
    }
    if let Some(error) = scanner.index_error() {
        return Err(error);
    }
    let (models, _) = parsed.map_err(|error| {
        scanner.line_error(&format!("{error}; expected Wavefront OBJ, export the mesh again"))
    })?;
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    let mut faces = Faces { indices: Vec::new(), arities: Vec::new() };
    // The scanner leaves out what would begin a second model.
    if let Some(model) = models.into_iter().next() {
        positions = vectors(&model.mesh.positions);
        normals = vectors(&model.mesh.normals);
        faces = Faces { indices: model.mesh.indices, arities: model.mesh.face_arities };
    }
    Ok((positions, normals, faces))
}

fn vectors(numbers: &[f32]) -> Vec<Vec3> {
    numbers.chunks_exact(3).map(Vec3::from_slice).collect()
}

/// Cuts the faces up; those with a coordinate that is not finite are left out, with a note.
fn triangles_of(
    path: &Path,
    positions: &[Vec3],
    (faces, groups): (&Faces, Option<&[u32]>),
    notes: &mut Vec<String>,
) -> Result<(Vec<[u32; 3]>, Option<Vec<u32>>), SourceError> {
    let is_finite =
        |corner: &u32| positions.get(*corner as usize).is_some_and(|position| position.is_finite());
    let mut triangles = Vec::with_capacity(faces.indices.len() / 3);
    let mut dropped = 0_u64;
    let (mut corners, mut cut) = (Vec::new(), Vec::new());
    let mut group_of = groups.map(|_| Vec::new());
    for (index, face) in faces.iter().enumerate() {
        if !face.iter().all(is_finite) {
            dropped += 1;
            continue;
        }
        corners.clear();
        corners.extend(face.iter().map(|&corner| positions[corner as usize]));
        cut.clear();
        triangulate::triangulate(&corners, &mut cut);
        if let (Some(all), Some(groups)) = (&mut group_of, groups) {
            all.extend(std::iter::repeat_n(groups.get(index).copied().unwrap_or(0), cut.len()));
        }
        triangles.extend(cut.iter().map(|triangle| triangle.map(|corner| face[corner])));
    }
    if triangles.len() > u32::MAX as usize / 3 {
        return Err(SourceError::TooManyTriangles { path: path.to_owned(), limit: u64::from(u32::MAX) / 3 });
    }
    if dropped > 0 {
        let not_finite = positions.iter().filter(|position| !position.is_finite()).count();
        let (vertices, faces) = (counted(positions.len() as u64, "used vertex"), counted(dropped, "face"));
        notes.push(format!("{not_finite} of {vertices} with a NaN or infinite coordinate; {faces} dropped"));
    }
    Ok((triangles, group_of))
}

fn notes_on(found: &Found) -> Vec<String> {
    let short = counted(found.short_faces, "face");
    let elements = counted(found.points_and_lines, "point or line element");
    let free_forms = counted(found.free_forms, "free-form curve or surface");
    let weights = counted(found.weights, "weight");
    let mut notes: Vec<_> = [
        (found.short_faces, format!("{short} with fewer than three corners dropped")),
        (found.points_and_lines, format!("{elements} ignored")),
        (found.free_forms, format!("{free_forms} ignored")),
        (found.weights, format!("{weights} (a fourth number of `v`) ignored: only rational curves have any")),
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
fn describe(found: &Found, notes: &[String]) -> String {
    let mut parts =
        vec![format!("{} and {}", counted(found.vertices, "vertex"), counted(found.faces, "face"))];
    parts.extend_from_slice(notes);
    parts.join(", ")
}

#[cfg(test)]
mod tests;
