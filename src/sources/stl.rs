//! STL meshes, text and binary: triangles without vertices in common.
//!
//! Equal positions become one, so that edges are soft or hard by the angle; the normals that the file gives to facets say nothing that
//! their corners do not, and are left out. So are colours of facets, with a note.
//!
//! Binary triangles are read by the crate `stl_io`. Its reader of text is not used: it parses in single precision, reads one solid of
//! several, refuses a `solid` without a name, and takes a binary file whose header begins with `solid` for text.

use std::io::{BufRead, Cursor, Read};
use std::path::Path;

use glam::DVec3;

use super::mesh::draft::{Corner, Draft, NONE};
use super::mesh::{Normals, counted, quoted};
use super::statements::Statements;
use super::{MeshData, SourceError, file};

/// The longest file that is read, in bytes: 2 GiB.
pub(super) const MAX_STL_BYTES: u64 = 1 << 31;

/// Bytes before the number of triangles, which takes four.
const HEADER: usize = 80;

/// Bytes of a triangle.
const TRIANGLE: usize = 50;

/// Whether this is what a binary STL file of so many bytes begins with: it has no mark but its length.
pub(super) fn is_binary(head: &[u8], bytes: u64) -> bool {
    triangles(head).is_some_and(|count| bytes == (HEADER + 4) as u64 + count * TRIANGLE as u64)
}

/// Whether this is what a text STL file begins with.
pub(super) fn is_text(head: &[u8]) -> bool {
    let head = head.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(head).trim_ascii_start();
    let begins = head.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    begins && head.get(5).is_none_or(u8::is_ascii_whitespace) && !head.contains(&0)
}

/// The number of triangles in a binary header.
fn triangles(head: &[u8]) -> Option<u64> {
    let count = head.get(HEADER..HEADER + 4)?.try_into().ok()?;
    Some(u32::from_le_bytes(count).into())
}

/// Reads an STL mesh from a stream that begins with it.
///
/// # Errors
///
/// If it is cut off, a statement or number cannot be understood, or no triangle is left.
pub(super) fn read(path: &Path, mut input: impl BufRead, rule: Normals) -> Result<MeshData, SourceError> {
    let mut bytes = Vec::new();
    let read = (&mut input).take(MAX_STL_BYTES).read_to_end(&mut bytes);
    read.map_err(|cause| file::io_error(path, cause))?;
    let draft = if !is_binary(&bytes, bytes.len() as u64) && is_text(&bytes[..bytes.len().min(1024)]) {
        read_text(path, &bytes)?
    } else {
        read_binary(path, bytes)?
    };
    let found = counted(draft.faces() as u64, "facet");
    let mesh = draft.finish(path, rule)?;
    if mesh.triangles.is_empty() {
        let found = [vec![found], mesh.notes].concat().join(", ");
        return Err(SourceError::NoTriangles { path: path.to_owned(), found });
    }
    Ok(mesh)
}

fn read_binary(path: &Path, mut bytes: Vec<u8>) -> Result<Draft, SourceError> {
    let count = triangles(&bytes).unwrap_or(0);
    let expected = (HEADER + 4) as u64 + count * TRIANGLE as u64;
    let length = bytes.len() as u64;
    if length < expected || length < (HEADER + 4) as u64 {
        return Err(SourceError::Length {
            path: path.to_owned(),
            found: counted(length, "byte"),
            expected: format!("an STL header and {} need {expected}", counted(count, "triangle")),
            difference: format!("{} fewer than expected", expected - length),
            mend: "the file is cut off, or no STL file: fetch or export it again".to_owned(),
        });
    }
    let mut draft = Draft::default();
    if length > expected {
        draft.notes.push(format!("{} after the last triangle left out", counted(length - expected, "byte")));
    }
    let of_triangles = &bytes[HEADER + 4..expected as usize];
    let colours =
        of_triangles.chunks_exact(TRIANGLE).filter(|triangle| triangle[48..] != [0, 0]).count() as u64;
    let has_colour = bytes[..HEADER].windows(6).any(|word| word == b"COLOR=");
    if colours > 0 || has_colour {
        draft.notes.push(format!("colours (attribute bytes) of {} are not used", counted(colours, "facet")));
    }
    // What the header says must not be taken for text.
    bytes[..HEADER].fill(0);
    let mut bytes = Cursor::new(bytes);
    let reader = stl_io::create_stl_reader(&mut bytes).map_err(|cause| file::io_error(path, cause))?;
    for triangle in reader {
        let triangle = triangle.map_err(|cause| file::io_error(path, cause))?;
        let corners = triangle.vertices.map(|corner| DVec3::from_array(corner.0.map(f64::from)));
        push_facet(&mut draft, &corners);
    }
    Ok(draft)
}

fn push_facet(draft: &mut Draft, corners: &[DVec3]) {
    let first = draft.positions.len() as u32;
    draft.positions.extend_from_slice(corners);
    let corners: Vec<Corner> = (first..first + corners.len() as u32).map(Corner::at).collect();
    draft.push_face(&corners, NONE, NONE);
}

/// What is known while text is read.
#[derive(Default)]
struct Text {
    draft: Draft,
    corners: Vec<DVec3>,
    /// Facets of fewer than three corners.
    short: u64,
    /// Whether a facet has begun and not ended.
    is_in_facet: bool,
}

fn read_text(path: &Path, bytes: &[u8]) -> Result<Draft, SourceError> {
    let mut statements = Statements::new(bytes);
    let mut text = Text::default();
    while statements.advance().map_err(|cause| file::io_error(path, cause))? {
        let statement = statements.text();
        let read = text.statement(statement.trim_start_matches('\u{feff}'));
        read.map_err(|problem| {
            let cut_off = if statements.is_terminated {
                ""
            } else {
                "; the file ends within this line: is it cut off?"
            };
            let problem = format!("{problem}{cut_off}");
            SourceError::Line { path: path.to_owned(), line: statements.line, problem }
        })?;
    }
    let mut draft = text.draft;
    if text.short > 0 {
        draft.notes.push(format!("{} with fewer than three corners dropped", counted(text.short, "facet")));
    }
    if text.is_in_facet {
        draft.notes.push("the file ends within a facet: it may be cut off".to_owned());
    }
    Ok(draft)
}

impl Text {
    fn statement(&mut self, statement: &str) -> Result<(), String> {
        let mut words = statement.split_whitespace();
        let keyword = words.next().unwrap_or_default().to_ascii_lowercase();
        match keyword.as_str() {
            "vertex" => self.corners.push(position(&mut words)?),
            "facet" => {
                self.corners.clear();
                self.is_in_facet = true;
            }
            "endfacet" => {
                self.is_in_facet = false;
                if self.corners.len() >= 3 {
                    push_facet(&mut self.draft, &self.corners);
                } else {
                    self.short += 1;
                }
            }
            "" | "solid" | "endsolid" | "outer" | "endloop" | "color" => {}
            _ => {
                let quoted = quoted(&keyword);
                return Err(format!("`{quoted}` is no statement of STL; export the mesh again"));
            }
        }
        Ok(())
    }
}

fn position<'w>(words: &mut impl Iterator<Item = &'w str>) -> Result<DVec3, String> {
    let mut position = DVec3::ZERO;
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let word =
            words.next().ok_or_else(|| format!("`vertex` needs three numbers, {name} is missing; add it"))?;
        position[axis] = word.parse().map_err(|_| {
            format!("`{}` is not a number; `vertex` needs three, write it like -1.5e3", quoted(word))
        })?;
    }
    Ok(position)
}

#[cfg(test)]
mod tests;
