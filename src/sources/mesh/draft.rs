//! What a reader found in a file, before it is a mesh.

use glam::{DVec3, Vec2, Vec3};

use super::MeshMaterial;

/// In the place of an index: there is none.
pub(in crate::sources) const NONE: u32 = u32::MAX;

/// One number for each of many items, of which most may have none.
#[derive(Debug, Default)]
pub(in crate::sources) struct Sparse(Vec<u32>);

impl Sparse {
    /// Says the number of an item; items come in order.
    pub fn set(&mut self, item: usize, number: u32) {
        if number != NONE {
            self.0.resize(item, NONE);
            self.0.push(number);
        }
    }

    /// The number of an item, or [`NONE`].
    pub fn get(&self, item: usize) -> u32 {
        self.0.get(item).copied().unwrap_or(NONE)
    }

    /// Whether no item has one.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// A corner of a face: indices into positions, normals and texture coordinates, the latter two may be [`NONE`].
#[derive(Debug, Clone, Copy)]
pub(in crate::sources) struct Corner {
    pub position: u32,
    pub normal: u32,
    pub texture: u32,
}

impl Corner {
    /// A corner of which only the position is known.
    pub fn at(position: u32) -> Self {
        Self { position, normal: NONE, texture: NONE }
    }
}

/// Polygons with what a file says about them. Indices may point anywhere; no number needs to be finite.
#[derive(Debug, Default)]
pub(in crate::sources) struct Draft {
    /// In the file's coordinates.
    pub positions: Vec<DVec3>,
    /// Linear colour and opacity of each position, NaN where the file gives none; empty without any.
    pub colours: Vec<[f32; 4]>,
    /// Of any length and direction.
    pub normals: Vec<Vec3>,
    /// (0, 0) in the lower left corner of a picture.
    pub texture_coordinates: Vec<Vec2>,
    /// What faces may be made of.
    pub materials: Vec<MeshMaterial>,
    /// What a person should know, so far.
    pub notes: Vec<String>,
    /// The positions of the corners of all faces, one face after the other.
    pub(super) corners: Vec<u32>,
    pub(super) corner_normals: Sparse,
    pub(super) corner_textures: Sparse,
    /// Corners of each face; empty if all have three.
    pub(super) arities: Vec<u32>,
    /// The smoothing group of each face: 0 is flat, [`NONE`] is not said.
    pub(super) groups: Sparse,
    /// The material of each face.
    pub(super) face_materials: Sparse,
}

impl Draft {
    /// How many faces there are.
    pub fn faces(&self) -> usize {
        if self.arities.is_empty() { self.corners.len() / 3 } else { self.arities.len() }
    }

    /// How many corners all faces have.
    pub fn corners(&self) -> usize {
        self.corners.len()
    }

    /// Whether every face has three corners.
    pub fn is_of_triangles(&self) -> bool {
        self.arities.is_empty()
    }

    /// Adds a face of at least three corners; `group` and `material` may be [`NONE`].
    pub fn push_face(&mut self, corners: &[Corner], group: u32, material: u32) {
        let face = self.faces();
        if self.arities.is_empty() && corners.len() != 3 {
            self.arities = vec![3; face];
        }
        if corners.len() != 3 || !self.arities.is_empty() {
            self.arities.push(corners.len() as u32);
        }
        for corner in corners {
            let place = self.corners.len();
            self.corners.push(corner.position);
            self.corner_normals.set(place, corner.normal);
            self.corner_textures.set(place, corner.texture);
        }
        self.groups.set(face, group);
        self.face_materials.set(face, material);
    }

    /// Gives all faces one material.
    pub fn give_material(&mut self, material: MeshMaterial) {
        self.face_materials = Sparse(vec![self.materials.len() as u32; self.faces()]);
        self.materials.push(material);
    }

    /// Where each face's corners begin, and how many there are.
    pub(super) fn spans(&self) -> impl Iterator<Item = (usize, usize)> {
        let mut start = 0;
        (0..self.faces()).map(move |face| {
            let count = self.arities.get(face).map_or(3, |&corners| corners as usize);
            start += count;
            (start - count, count)
        })
    }
}
