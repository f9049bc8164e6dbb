//! Polygon files of Stanford, PLY: text, and binary of either byte order, by the crate `ply-rs-bw`.
//!
//! Read: positions, normals, colours and texture coordinates of vertices; faces with index lists of any type, their texture coordinates,
//! triangle strips; the picture that a comment `TextureFile` names, as MeshLab writes it. All other elements and properties are skipped,
//! and named in a note. Colours are sRGB-encoded, in bytes as in floats.
//!
//! The crate reads headers, and binary elements one after the other, so that no more is in memory than the mesh. Elements of text are read
//! here: its grammar refuses numbers such as `.5`, `1.` and `nan`, and it parses what a header calls `float` in single precision.

mod element;
mod header;

use std::io::{self, BufRead};
use std::path::Path;

use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess};

use super::mesh::draft::Draft;
use super::mesh::{MeshMaterial, Normals, colour, counted};
use super::texture::Textures;
use super::{MeshData, SourceError};
use element::{Face, Skipped, Vertex};
use header::Lines;

/// What a PLY file begins with.
pub(super) const MAGIC: &[u8] = b"ply";

/// Reads a PLY mesh from a stream that begins with it.
///
/// # Errors
///
/// If the header or an element cannot be understood, the file ends too early, or no triangle is left.
pub(super) fn read(path: &Path, input: impl BufRead, rule: Normals) -> Result<MeshData, SourceError> {
    let mut lines = Lines::new(path, input);
    let header = lines.header()?;
    let mut reader =
        Reader { lines, encoding: header.encoding, has: Has::of(&header), draft: Draft::default() };
    reader.draft.notes.extend(header::unused(&header));
    for element in header.elements.values() {
        // An element without properties takes no bytes, however many there are.
        if !element.properties.is_empty() {
            reader.element(element)?;
        }
    }
    reader.finish(path, &header, rule)
}

/// What the vertices and faces have.
#[derive(Clone, Copy)]
struct Has {
    normals: bool,
    colours: bool,
    /// Texture coordinates of vertices, where faces have none of their own.
    texture: bool,
}

impl Has {
    fn of(header: &Header) -> Self {
        let has = |element: &str, names: &[&str]| {
            let element = header.elements.get(element);
            element.is_some_and(|element| names.iter().any(|name| element.properties.contains_key(*name)))
        };
        let all = |names: &[&[&str]]| names.iter().all(|names| has("vertex", names));
        Self {
            normals: all(&[&["nx"], &["ny"], &["nz"]]),
            colours: all(&[element::RED, element::GREEN, element::BLUE]),
            texture: all(&[element::TEXTURE_U, element::TEXTURE_V])
                && !has("face", &[element::CORNER_TEXTURE]),
        }
    }
}

struct Reader<'a, R> {
    lines: Lines<'a, R>,
    encoding: Encoding,
    has: Has,
    draft: Draft,
}

impl<R: BufRead> Reader<'_, R> {
    /// Reads all elements of a kind.
    fn element(&mut self, element: &ElementDef) -> Result<(), SourceError> {
        let Has { normals, colours, texture } = self.has;
        let mut short_faces = 0;
        match element.name.as_str() {
            "vertex" => {
                if let Some(name) =
                    ["x", "y", "z"].into_iter().find(|name| !element.properties.contains_key(*name))
                {
                    return Err(self
                        .lines
                        .error("vertex", &format!("it has no `{name}`; export the mesh again")));
                }
                self.each(element, |draft, vertex: Vertex| {
                    draft.positions.push(vertex.position);
                    draft.colours.extend(colours.then_some(vertex.colour));
                    draft.normals.extend(normals.then_some(vertex.normal));
                    draft.texture_coordinates.extend(texture.then_some(vertex.texture));
                })?;
            }
            "face" => self.each(element, |draft, face: Face| {
                short_faces += u64::from(!face.push(draft, normals, texture));
            })?,
            "tristrips" => {
                self.each(element, |draft, face: Face| face.push_strips(draft, normals, texture))?;
            }
            _ => self.each(element, |_, _: Skipped| {})?,
        }
        if short_faces > 0 {
            let faces = counted(short_faces, "face");
            self.draft.notes.push(format!("{faces} with fewer than three corners dropped"));
        }
        Ok(())
    }

    /// Reads elements, and hands each on.
    fn each<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut take: impl FnMut(&mut Draft, E),
    ) -> Result<(), SourceError> {
        let parser = Parser::<E>::new();
        let place = |number: usize| format!("{} {number} of {}", element.name, element.count);
        for number in 1..=element.count {
            let read = match self.encoding {
                Encoding::Ascii => match self.lines.next_filled()? {
                    Some(line) => match element::from_text(line, element) {
                        Ok(read) => Some(Ok(read)),
                        Err(problem) => {
                            return Err(self.lines.error(&place(number), &problem));
                        }
                    },
                    None => None,
                },
                Encoding::BinaryBigEndian => {
                    Some(parser.read_big_endian_element(&mut self.lines.input, element))
                }
                Encoding::BinaryLittleEndian => {
                    Some(parser.read_little_endian_element(&mut self.lines.input, element))
                }
            };
            let problem = match read {
                Some(Ok(read)) => {
                    take(&mut self.draft, read);
                    continue;
                }
                Some(Err(error)) if error.kind() != io::ErrorKind::UnexpectedEof => {
                    let text = error.to_string();
                    let first = text.lines().next().unwrap_or_default().trim_end_matches('.').to_owned();
                    format!("{first}; export the mesh again")
                }
                _ => {
                    "the file ends before it is complete: it is cut off; fetch or export it again".to_owned()
                }
            };
            return Err(self.lines.error(&place(number), &problem));
        }
        Ok(())
    }

    fn finish(mut self, path: &Path, header: &Header, rule: Normals) -> Result<MeshData, SourceError> {
        let draft = &mut self.draft;
        if colour::decode_vertex_colours(&mut draft.colours) {
            draft.notes.push("colours of vertices are above 1: taken as 0 to 255".to_owned());
        }
        let texture = header.comments.iter().find_map(|comment| comment.trim().strip_prefix("TextureFile"));
        if let Some(name) = texture {
            let mut textures = Textures::default();
            let folder = path.parent().unwrap_or(Path::new(""));
            let picture = textures.load(&[folder], name.trim());
            draft.notes.append(&mut textures.notes);
            if picture.is_some() {
                draft.give_material(MeshMaterial { diffuse_texture: picture, ..MeshMaterial::white() });
            }
        }
        let found = format!(
            "{} and {}",
            counted(draft.positions.len() as u64, "vertex"),
            counted(draft.faces() as u64, "face")
        );
        let mesh = self.draft.finish(path, rule)?;
        if mesh.triangles.is_empty() {
            let found = [vec![found], mesh.notes].concat().join(", ");
            return Err(SourceError::NoTriangles { path: path.to_owned(), found });
        }
        Ok(mesh)
    }
}

#[cfg(test)]
mod tests;
