//! A primitive of a glTF mesh: its vertices and triangles.

use std::collections::BTreeSet;

use glam::{Affine2, DMat4, Vec2, Vec3};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;

use super::material::Materials;
use super::{File, nodes};
use crate::sources::mesh::draft::{Corner, Draft, NONE};

/// Where a mesh is put.
pub(super) struct Placed {
    pub placement: DMat4,
    /// What normals are moved by.
    pub normals: DMat4,
    pub is_mirrored: bool,
}

/// Adds a primitive to the draft.
pub(super) fn add(
    file: &File<'_>,
    primitive: &Primitive,
    placed: &Placed,
    draft: &mut Draft,
    materials: &mut Materials<'_>,
    unused: &mut BTreeSet<String>,
) -> Result<(), String> {
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
    let mode = match primitive.mode {
        Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
        Checked::Valid(Mode::Points) => return told(unused, "points"),
        Checked::Valid(_) => return told(unused, "lines"),
        Checked::Invalid => return Err("its mode is none that there is".to_owned()),
    };
    if primitive.targets.is_some() {
        unused.insert("morph targets".to_owned());
    }
    refuse_compressed(file, primitive)?;
    let position = attribute(Semantic::Positions).ok_or("it has no POSITION")?;
    let positions = file.floats::<3>(position)?;
    let count = positions.len();
    let first = (draft.positions.len(), draft.normals.len(), draft.texture_coordinates.len());
    let normals = attribute(Semantic::Normals).map(|index| file.floats::<3>(index)).transpose()?;
    let material = primitive.material.map(|material| materials.number(file, material)).transpose()?;
    let look = material.map(|number| materials.texture(number)).unwrap_or_default();
    let texture = attribute(Semantic::TexCoords(look.set)).filter(|_| look.is_any);
    let texture = texture.map(|index| file.floats::<2>(index)).transpose()?;
    let colours = colours(file, primitive)?;
    for (name, length) in [
        ("NORMAL", normals.as_ref().map(Vec::len)),
        ("TEXCOORD", texture.as_ref().map(Vec::len)),
        ("COLOR_0", colours.as_ref().map(Vec::len)),
    ] {
        if length.is_some_and(|length| length != count) {
            return Err(format!("{count} POSITIONs, but {} {name}s", length.unwrap_or(0)));
        }
    }
    draft.positions.extend(positions.into_iter().map(|position| nodes::moved(&placed.placement, position)));
    if let Some(colours) = colours {
        draft.colours.resize(first.0, [f32::NAN; 4]);
        draft.colours.extend(colours);
    } else if !draft.colours.is_empty() {
        draft.colours.resize(draft.positions.len(), [f32::NAN; 4]);
    }
    let has = (normals.is_some(), texture.is_some());
    let normal = |normal: [f32; 3]| {
        // What is longer than single precision reaches is of use only as a direction.
        placed.normals.transform_vector3(Vec3::from_array(normal).as_dvec3()).normalize_or_zero().as_vec3()
    };
    draft.normals.extend(normals.into_iter().flatten().map(normal));
    draft.texture_coordinates.extend(texture.into_iter().flatten().map(|at| look.picture_from(at)));
    let corner = |index: u32| {
        let at = |first: usize, is_any: bool| if is_any { index.saturating_add(first as u32) } else { NONE };
        Corner { position: at(first.0, true), normal: at(first.1, has.0), texture: at(first.2, has.1) }
    };
    let indices = match primitive.indices {
        Some(index) => file.indices(index)?,
        None => (0..count as u32).collect(),
    };
    if let Some(index) = indices.iter().find(|&&index| index as usize >= count) {
        return Err(format!("an index is {index}, but it has {count} vertices"));
    }
    for [a, b, c] in triangles(mode, &indices) {
        let triangle = if placed.is_mirrored { [a, c, b] } else { [a, b, c] };
        draft.push_face(&triangle.map(corner), NONE, material.unwrap_or(NONE));
    }
    Ok(())
}

fn told(unused: &mut BTreeSet<String>, what: &str) -> Result<(), String> {
    unused.insert(what.to_owned());
    Ok(())
}

/// A primitive that is compressed may have its data in the clear as well; then its accessors name buffer views.
fn refuse_compressed(file: &File<'_>, primitive: &Primitive) -> Result<(), String> {
    let compression = primitive
        .extensions
        .as_ref()
        .and_then(|extensions| super::COMPRESSION.iter().find(|name| extensions.others.contains_key(**name)));
    let is_clear = |index: &gltf::json::Index<gltf::json::Accessor>| {
        file.root.get(*index).is_some_and(|accessor| accessor.buffer_view.is_some())
    };
    match compression {
        Some(name) if !primitive.attributes.values().all(is_clear) => {
            Err(format!("it is compressed ({name}), which is not read; export without compression"))
        }
        _ => Ok(()),
    }
}

/// The first colours of vertices, linear as glTF has them.
fn colours(file: &File<'_>, primitive: &Primitive) -> Result<Option<Vec<[f32; 4]>>, String> {
    let Some(&index) = primitive.attributes.get(&Checked::Valid(Semantic::Colors(0))) else {
        return Ok(None);
    };
    let clamped = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 1.0 };
    Ok(Some(if file.components(index) == 4 {
        file.floats::<4>(index)?.into_iter().map(|colour| colour.map(clamped)).collect()
    } else {
        let opaque = |[red, green, blue]: [f32; 3]| [red, green, blue, 1.0].map(clamped);
        file.floats::<3>(index)?.into_iter().map(opaque).collect()
    }))
}

/// The triangles of a list, strip or fan of indices.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let turned = |(place, at): (usize, &[u32])| {
                if place % 2 == 0 { [at[0], at[1], at[2]] } else { [at[1], at[0], at[2]] }
            };
            let whole = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
            indices.windows(3).enumerate().map(turned).filter(whole).collect()
        }
        Mode::TriangleFan => {
            let rim = indices.get(1..).unwrap_or_default();
            rim.windows(2).map(|at| [indices[0], at[0], at[1]]).collect()
        }
        _ => indices.chunks_exact(3).map(|at| [at[0], at[1], at[2]]).collect(),
    }
}

/// How the picture of a material lies on its surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Texture {
    pub is_any: bool,
    /// Which of a vertex's texture coordinates.
    pub set: u32,
    pub transform: Affine2,
}

impl Default for Texture {
    fn default() -> Self {
        Self { is_any: false, set: 0, transform: Affine2::IDENTITY }
    }
}

impl Texture {
    /// Coordinates from the lower left corner, of glTF's from the upper left one.
    fn picture_from(&self, at: [f32; 2]) -> Vec2 {
        let at = self.transform.transform_point2(Vec2::from_array(at));
        Vec2::new(at.x, 1.0 - at.y)
    }
}
