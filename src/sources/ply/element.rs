//! What is taken of each element of a PLY file.

use glam::{DVec3, Vec2, Vec3};
use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use crate::sources::mesh::draft::{Corner, Draft, NONE};
use crate::sources::mesh::quoted;

/// Names of the channels of a colour.
pub(super) const RED: &[&str] = &["red", "r", "diffuse_red"];
pub(super) const GREEN: &[&str] = &["green", "g", "diffuse_green"];
pub(super) const BLUE: &[&str] = &["blue", "b", "diffuse_blue"];
const OPACITY: &[&str] = &["alpha", "a", "diffuse_alpha"];

/// Names of texture coordinates.
pub(super) const TEXTURE_U: &[&str] = &["s", "u", "texture_u", "s0", "u0"];
pub(super) const TEXTURE_V: &[&str] = &["t", "v", "texture_v", "t0", "v0"];

const INDICES: &[&str] = &["vertex_indices", "vertex_index"];

/// The texture coordinates of a face's corners, two numbers each.
pub(super) const CORNER_TEXTURE: &str = "texcoord";

pub(super) fn is_vertex_property(name: &str) -> bool {
    let others: [&[&str]; 8] =
        [&["x", "y", "z", "nx", "ny", "nz"], RED, GREEN, BLUE, OPACITY, TEXTURE_U, TEXTURE_V, &[]];
    others.iter().any(|names| names.contains(&name))
}

pub(super) fn is_face_property(name: &str) -> bool {
    INDICES.contains(&name) || name == CORNER_TEXTURE
}

/// An element out of a line of text.
pub(super) fn from_text<E: PropertyAccess>(line: &str, element: &ElementDef) -> Result<E, String> {
    let mut words = line.split_whitespace();
    let mut number = |name: &str| {
        let word = words.next().ok_or_else(|| format!("its line ends before `{name}`; is it cut off?"))?;
        word.parse::<f64>().map_err(|_| format!("`{}` is not a number; write it like -1.5e3", quoted(word)))
    };
    let mut read = E::new();
    for (name, property) in &element.properties {
        let value = match &property.data_type {
            PropertyType::Scalar(kind) => scalar(number(name)?, kind),
            PropertyType::List(_, _) => {
                let count = number(name)?;
                // As many as the line has, whatever it says.
                let mut list = Vec::new();
                while (list.len() as f64) < count {
                    list.push(number(name)?);
                }
                Property::ListDouble(list)
            }
        };
        if read.set_property(name, value) == PropertyAccessResult::UnsupportedType {
            return Err(format!("`{name}` is of the wrong type; export the mesh again"));
        }
    }
    Ok(read)
}

/// A number as its type has it; all of them fit into a double.
fn scalar(value: f64, kind: &ScalarType) -> Property {
    match kind {
        ScalarType::Char => Property::Char(value as i8),
        ScalarType::UChar => Property::UChar(value as u8),
        ScalarType::Short => Property::Short(value as i16),
        ScalarType::UShort => Property::UShort(value as u16),
        ScalarType::Int => Property::Int(value as i32),
        ScalarType::UInt => Property::UInt(value as u32),
        ScalarType::Float | ScalarType::Double => Property::Double(value),
    }
}

/// An element of which nothing is taken.
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

/// A vertex; its colour is as the file writes it, integers scaled to 1.
pub(super) struct Vertex {
    pub position: DVec3,
    pub normal: Vec3,
    pub colour: [f32; 4],
    pub texture: Vec2,
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self { position: DVec3::ZERO, normal: Vec3::ZERO, colour: [0.0, 0.0, 0.0, 1.0], texture: Vec2::ZERO }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some((value, unit)) = number(&property) else {
            let is_known = is_vertex_property(name);
            return if is_known {
                PropertyAccessResult::UnsupportedType
            } else {
                PropertyAccessResult::Ignored
            };
        };
        match name {
            "x" => self.position.x = value,
            "y" => self.position.y = value,
            "z" => self.position.z = value,
            "nx" => self.normal.x = value as f32,
            "ny" => self.normal.y = value as f32,
            "nz" => self.normal.z = value as f32,
            _ if RED.contains(&name) => self.colour[0] = (value / unit) as f32,
            _ if GREEN.contains(&name) => self.colour[1] = (value / unit) as f32,
            _ if BLUE.contains(&name) => self.colour[2] = (value / unit) as f32,
            _ if OPACITY.contains(&name) => self.colour[3] = (value / unit) as f32,
            _ if TEXTURE_U.contains(&name) => self.texture.x = value as f32,
            _ if TEXTURE_V.contains(&name) => self.texture.y = value as f32,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

/// A number, and what full intensity is in numbers of its type.
fn number(property: &Property) -> Option<(f64, f64)> {
    Some(match *property {
        Property::Char(value) => (value.into(), 127.0),
        Property::UChar(value) => (value.into(), 255.0),
        Property::Short(value) => (value.into(), 32_767.0),
        Property::UShort(value) => (value.into(), 65_535.0),
        // Wider integers hold bytes as well.
        Property::Int(value) => (value.into(), 255.0),
        Property::UInt(value) => (value.into(), 255.0),
        Property::Float(value) => (value.into(), 1.0),
        Property::Double(value) => (value, 1.0),
        _ => return None,
    })
}

/// A face, or a run of triangle strips.
pub(super) struct Face {
    /// `NONE` for what is no index; in strips it ends one.
    indices: Vec<u32>,
    texture: Vec<f32>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self { indices: Vec::new(), texture: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if INDICES.contains(&name) {
            let Some(indices) = indices(property) else { return PropertyAccessResult::UnsupportedType };
            self.indices = indices;
        } else if name == CORNER_TEXTURE {
            match property {
                Property::ListFloat(values) => self.texture = values,
                Property::ListDouble(values) => self.texture = values.into_iter().map(|v| v as f32).collect(),
                _ => return PropertyAccessResult::Ignored,
            }
        } else {
            return PropertyAccessResult::Ignored;
        }
        PropertyAccessResult::Set
    }
}

fn indices(property: Property) -> Option<Vec<u32>> {
    let signed = |value: i64| u32::try_from(value).unwrap_or(NONE);
    Some(match property {
        Property::ListUInt(values) => values,
        Property::ListInt(values) => values.into_iter().map(|value| signed(value.into())).collect(),
        Property::ListUShort(values) => values.into_iter().map(u32::from).collect(),
        Property::ListShort(values) => values.into_iter().map(|value| signed(value.into())).collect(),
        Property::ListUChar(values) => values.into_iter().map(u32::from).collect(),
        Property::ListChar(values) => values.into_iter().map(|value| signed(value.into())).collect(),
        // Written by programs that know no other type; a cast saturates.
        Property::ListFloat(values) => values.into_iter().map(|value| signed(value as i64)).collect(),
        Property::ListDouble(values) => values.into_iter().map(|value| signed(value as i64)).collect(),
        _ => return None,
    })
}

impl Face {
    /// Adds it to a draft whose normals and, if `has_texture`, texture coordinates have the indices of the vertices. False if it has fewer
    /// than three corners.
    pub fn push(self, draft: &mut Draft, has_normals: bool, has_texture: bool) -> bool {
        let own_texture = !self.texture.is_empty() && self.texture.len() == 2 * self.indices.len();
        let first = draft.texture_coordinates.len() as u32;
        if own_texture {
            draft.texture_coordinates.extend(self.texture.chunks_exact(2).map(Vec2::from_slice));
        }
        let corner = |(place, position): (usize, u32)| Corner {
            position,
            normal: if has_normals { position } else { NONE },
            texture: match (own_texture, has_texture) {
                (true, _) => first + place as u32,
                (false, true) => position,
                (false, false) => NONE,
            },
        };
        let corners: Vec<Corner> = self.indices.into_iter().enumerate().map(corner).collect();
        if corners.len() >= 3 {
            draft.push_face(&corners, NONE, NONE);
        }
        corners.len() >= 3
    }

    /// Adds the triangles of strips.
    pub fn push_strips(self, draft: &mut Draft, has_normals: bool, has_texture: bool) {
        for strip in self.indices.split(|&index| index == NONE) {
            for (place, triangle) in strip.windows(3).enumerate() {
                let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
                let indices = if place % 2 == 0 { vec![a, b, c] } else { vec![b, a, c] };
                if a != b && b != c && c != a {
                    Self { indices, texture: Vec::new() }.push(draft, has_normals, has_texture);
                }
            }
        }
    }
}
