//! Triangle meshes in memory.

mod assemble;
pub(super) mod colour;
mod creases;
pub(super) mod draft;
mod extremes;
mod finish;
mod inside;
mod join;
mod material;
mod normals;
mod options;
mod orient;
mod origin;
mod outline;
pub(super) mod phong;
mod refine;
mod statistics;
mod topology;
pub(super) mod triangulate;
mod weld;
mod words;

use glam::{DVec3, Vec2, Vec3};

pub use extremes::extremes;
pub use material::{MeshMaterial, MeshPart, MeshSubsurface, TextureImage};
pub use options::{CREASE_DEGREES, Normals};
pub use statistics::MeshStatistics;
pub(super) use words::{counted, listed, quoted};

/// A triangle mesh: every vertex is used, finite and has a unit normal; no triangle has zero area.
///
/// Positions are in the units of the file. Triangles are counter-clockwise seen from the side they face. Colours are linear, with the
/// primaries of sRGB.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct MeshData {
    /// What positions are relative to: 0 unless the mesh lies so far out that single precision would not resolve it.
    pub origin: DVec3,
    /// One position per vertex, relative to the origin.
    pub positions: Vec<Vec3>,
    /// One unit normal per vertex.
    pub normals: Vec<Vec3>,
    /// Three indices into the vertices each.
    pub triangles: Vec<[u32; 3]>,
    /// Red, green, blue and opacity of each vertex, which the diffuse colour is multiplied by; empty if the file says none.
    pub colours: Vec<[f32; 4]>,
    /// One per vertex, (0, 0) in the lower left corner of a picture; empty if the file says none.
    pub texture_coordinates: Vec<Vec2>,
    /// Ascending and disjoint; triangles of no part have no material of their own.
    pub parts: Vec<MeshPart>,
    /// What the parts look like; empty if the file does not say it.
    pub materials: Vec<MeshMaterial>,
    /// What a person should know about how the mesh was read: `3 zero-area triangles dropped`.
    pub notes: Vec<String>,
}

impl MeshData {
    /// A mesh of these triangles, cleaned; each index names a position and the normal of the same index.
    ///
    /// A normal that is missing, zero or not finite is computed: angle-weighted, over all triangles that meet at the position.
    /// Triangles that use a position that is missing or not finite, and triangles of zero area, are dropped; so are vertices no
    /// triangle uses. Vertices equal in position and normal become one. Every such change leaves a note. The result may be
    /// empty.
    pub fn from_triangles(positions: &[Vec3], normals: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        assemble::assemble(positions, normals, triangles)
    }

    /// The least and greatest corner of the axis-aligned box around the vertices, relative to the origin; `None` without any.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold((first, first), |(least, greatest), &position| {
            (least.min(position), greatest.max(position))
        }))
    }

    /// The medium that the file says most of the triangles enclose.
    pub fn medium(&self) -> Option<MeshSubsurface> {
        let medium = |part: &MeshPart| self.materials.get(part.material as usize)?.subsurface;
        let media = self.parts.iter().filter_map(|part| Some((part.triangles.len(), medium(part)?)));
        let all: usize = media.clone().map(|(triangles, _)| triangles).sum();
        let (_, most) = media.max_by_key(|(triangles, _)| *triangles)?;
        (2 * all > self.triangles.len()).then_some(most)
    }

    /// The same shape, of which nothing says what it looks like.
    pub fn without_materials(self) -> Self {
        Self {
            colours: Vec::new(),
            texture_coordinates: Vec::new(),
            parts: Vec::new(),
            materials: Vec::new(),
            ..self
        }
    }

    /// Counts and measures the mesh, after joining vertices of equal position.
    pub fn statistics(&self) -> MeshStatistics {
        MeshStatistics::of(self)
    }
}

#[cfg(test)]
mod crease_tests;
#[cfg(test)]
mod orient_tests;
#[cfg(test)]
mod tests;
