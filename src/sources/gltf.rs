//! glTF 2.0, as text with its buffers and as one binary file.
//!
//! The crate `gltf` knows the document; what is in the buffers is read here, as the crate's own accessors panic where offsets, strides and
//! counts do not fit, its validation does where an index points outside, and neither knows quantised positions.
//!
//! Read: the default scene (the first one if none is), with each node's place; triangles, strips and fans, with or without indices;
//! positions, normals, the first colours, and the texture coordinates of the base colour's picture; sparse and quantised accessors; base
//! colour, metalness and roughness as factors (see [`super::mesh::phong`]); media of `KHR_materials_volume` with
//! `KHR_materials_volume_scatter` (see [`material`]). Buffers and pictures are inside, in `data:` URIs, or in files beside.
//! A length is 1 metre, as it is in glTF: scenes of other units scale it.
//!
//! Not read, with a note: skins, morph targets, animations, instances, cameras, lights, points and lines, other pictures than that of the
//! base colour. Refused: Draco and meshopt compression, and what else a file says that it requires.

mod accessors;
mod buffers;
mod material;
mod nodes;
mod primitive;

use std::collections::BTreeSet;
use std::path::Path;

use gltf::json;

use super::mesh::draft::Draft;
use super::mesh::{Normals, counted, listed, quoted};
use super::{MeshData, SourceError};
use buffers::Buffers;

/// What a binary file begins with.
pub(super) const MAGIC: &[u8] = b"glTF";

/// The longest file that is read, in bytes, buffers beside it not counted: 2 GiB.
pub(super) const MAX_GLTF_BYTES: u64 = 1 << 31;

/// Bytes of a binary file's header.
const HEADER: usize = 12;

/// Names in one note, at most.
const MOST_NAMED: usize = 12;

/// Extensions that may be required: read, or harmless where they are not.
const KNOWN_EXTENSIONS: &[&str] = &[
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_materials_ior",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_materials_scatter",
    "KHR_materials_sss",
    "KHR_materials_transmission",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_pbrSpecularGlossiness",
];

/// Extensions without which nothing of a mesh can be read.
const COMPRESSION: &[&str] =
    &["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Whether a text file begins like a glTF document.
pub(super) fn is_text(head: &[u8]) -> bool {
    let head = head.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(head).trim_ascii_start();
    let names: [&[u8]; 5] =
        [b"\"asset\"", b"\"accessors\"", b"\"bufferViews\"", b"\"meshes\"", b"\"scenes\""];
    head.starts_with(b"{") && names.iter().any(|name| head.windows(name.len()).any(|word| word == *name))
}

/// Reads the meshes of a glTF document as one.
///
/// # Errors
///
/// If the document or what it names in its buffers cannot be understood or is not there, or no triangle is left.
pub(super) fn read(path: &Path, bytes: &[u8], rule: Normals) -> Result<MeshData, SourceError> {
    let (text, binary) = split(path, bytes)?;
    let root: json::Root = json::deserialize::from_slice(text).map_err(|error| SourceError::Field {
        path: path.to_owned(),
        field: "JSON".to_owned(),
        problem: format!("{error}; export the file again"),
    })?;
    refuse_unknown(path, &root)?;
    let file = File { path, root: &root, buffers: Buffers::new(path, &root, binary) };
    let mut draft = Draft::default();
    let mut unused = BTreeSet::new();
    nodes::read(&file, &mut draft, &mut unused)?;
    unused.extend(unused_of(&root));
    if !unused.is_empty() {
        let unused: Vec<String> = unused.into_iter().take(MOST_NAMED).collect();
        draft.notes.push(format!("not used: {}", listed(&unused)));
    }
    let found = counted(root.meshes.len() as u64, "mesh");
    let mesh = draft.finish(path, rule)?;
    if mesh.triangles.is_empty() {
        let found = [vec![found.replace("meshs", "meshes")], mesh.notes].concat().join(", ");
        return Err(SourceError::NoTriangles { path: path.to_owned(), found });
    }
    Ok(mesh)
}

/// A document with its buffers.
struct File<'a> {
    path: &'a Path,
    root: &'a json::Root,
    buffers: Buffers<'a>,
}

impl File<'_> {
    /// An error at a place of the document.
    fn error(&self, field: &str, problem: &str) -> SourceError {
        let (path, field) = (self.path.to_owned(), field.to_owned());
        SourceError::Field { path, field, problem: format!("{problem}; export the file again") }
    }
}

/// The JSON of a file, and the binary chunk that may follow it.
fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), SourceError> {
    if !bytes.starts_with(MAGIC) {
        return Ok((bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes), None));
    }
    let error = |found: String, mend: &str| SourceError::Unsupported {
        path: path.to_owned(),
        found,
        mend: mend.to_owned(),
    };
    let again = "fetch or export it again";
    let number =
        |at: usize| bytes.get(at..at + 4).and_then(|number| number.try_into().ok()).map(u32::from_le_bytes);
    let version = number(4).unwrap_or(0);
    if version != 2 {
        return Err(error(format!("binary glTF of version {version}"), "version 2 is read; convert it"));
    }
    let mut chunks = [None, None];
    let mut at = HEADER;
    for (chunk, kind) in chunks.iter_mut().zip([b"JSON", b"BIN\0"]) {
        let Some(length) = number(at) else { break };
        if bytes.get(at + 4..at + 8) != Some(kind) {
            break;
        }
        let start = at + 8;
        let end = start + length as usize;
        *chunk = Some(bytes.get(start..end).ok_or_else(|| {
            let kind = String::from_utf8_lossy(kind).trim_end_matches('\0').to_owned();
            let there = bytes.len() - start;
            error(format!("its {kind} chunk of {length} bytes is cut off after {there}"), again)
        })?);
        at = end.next_multiple_of(4);
    }
    let [text, binary] = chunks;
    let text = text.ok_or_else(|| error("binary glTF without a JSON chunk".to_owned(), again))?;
    Ok((text, binary))
}

/// Refuses what cannot be read without an extension that is not known here.
fn refuse_unknown(path: &Path, root: &json::Root) -> Result<(), SourceError> {
    let unknown = |name: &&String| !KNOWN_EXTENSIONS.contains(&name.as_str()) && !is_of_looks(name);
    let Some(name) = root.extensions_required.iter().find(unknown) else { return Ok(()) };
    let (found, mend) = if COMPRESSION.contains(&name.as_str()) {
        (
            format!("its meshes are compressed ({name})"),
            "export it without compression, or unpack it, as with `gltf-transform copy`",
        )
    } else {
        (format!("it requires the extension {}", quoted(name)), "export it without that")
    };
    Err(SourceError::Unsupported { path: path.to_owned(), found, mend: mend.to_owned() })
}

/// Extensions that change how a surface looks, but not where it is.
fn is_of_looks(name: &str) -> bool {
    ["KHR_materials_", "EXT_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "EXT_lights_"]
        .iter()
        .any(|prefix| name.starts_with(prefix))
}

/// What the document has beside meshes.
fn unused_of(root: &json::Root) -> Vec<String> {
    let counts = [
        (root.animations.len(), "animation"),
        (root.skins.len(), "skin"),
        (root.cameras.len(), "camera"),
        (root.scenes.len().saturating_sub(1), "other scene"),
    ];
    let counts = counts.into_iter().filter(|(count, _)| *count > 0);
    let mut unused: Vec<String> = counts.map(|(count, noun)| counted(count as u64, noun)).collect();
    let others = root.extensions_used.iter().filter(|name| !KNOWN_EXTENSIONS.contains(&name.as_str()));
    unused.extend(others.map(|name| quoted(name)));
    unused
}

#[cfg(test)]
mod tests;
