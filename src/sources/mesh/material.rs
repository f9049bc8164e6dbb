//! What files say about how surfaces look.

use std::{ops::Range, sync::Arc};

use glam::Vec3;

/// Triangles of a mesh that share a material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshPart {
    /// Which triangles of the mesh.
    pub triangles: Range<u32>,
    /// Which of the mesh's materials.
    pub material: u32,
}

/// How a file says that a surface looks. All colours are linear, with the primaries of sRGB.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MeshMaterial {
    /// What the file calls it.
    pub name: String,
    /// Share of light that is scattered back diffusely, 0 to 1; the texture's colour is multiplied by it.
    pub diffuse: Vec3,
    /// Share of light in the highlight, 0 to 1.
    pub specular: Vec3,
    /// Exponent of the highlight (Blinn and Phong), at least 1.
    pub shininess: f32,
    /// 1 for what hides what is behind it, 0 for what is not seen.
    pub opacity: f32,
    /// The colour at each texture coordinate.
    pub diffuse_texture: Option<Arc<TextureImage>>,
    /// The medium inside, where the file describes one.
    pub subsurface: Option<MeshSubsurface>,
}

impl Default for MeshMaterial {
    fn default() -> Self {
        Self {
            name: String::new(),
            diffuse: Vec3::splat(0.8),
            specular: Vec3::ZERO,
            shininess: 32.0,
            opacity: 1.0,
            diffuse_texture: None,
            subsurface: None,
        }
    }
}

impl MeshMaterial {
    /// A diffuse white surface: what a picture, or colours of vertices, may colour as they are.
    pub(in crate::sources) fn white() -> Self {
        Self { diffuse: Vec3::ONE, ..Self::default() }
    }
}

/// A medium that light enters and is scattered in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshSubsurface {
    /// Absorption in red, green and blue, per millimetre; at least 0.
    pub sigma_a: Vec3,
    /// Scattering in red, green and blue, per millimetre; at least 0.
    pub sigma_s: Vec3,
    /// Mean cosine of the angle of scattering, -1 to 1.
    pub g: f32,
    /// Relative index of refraction.
    pub eta: f32,
}

impl MeshSubsurface {
    /// The `Subsurface` of a scene that is filled with it, as scenes write it.
    pub fn in_ron(&self) -> String {
        let per_channel = |value: Vec3| {
            let [red, green, blue] = value.to_array();
            format!("({red:?}, {green:?}, {blue:?})")
        };
        format!(
            "(material: Custom(sigma_a: {}, sigma_s: {}, g: {:?}, eta: {:?}))",
            per_channel(self.sigma_a),
            per_channel(self.sigma_s),
            self.g,
            self.eta
        )
    }
}

/// A picture that colours a surface.
#[derive(Clone, PartialEq, Eq)]
pub struct TextureImage {
    /// Texels of a row; at least 1.
    pub width: u32,
    /// Rows; at least 1.
    pub height: u32,
    /// Red, green, blue as sRGB encodes them, and opacity, row by row from the top. Texture coordinate (0, 0) is the *lower* left corner
    /// of the picture, (1, 1) the upper right one; outside it repeats.
    pub texels: Vec<[u8; 4]>,
}

impl std::fmt::Debug for TextureImage {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "TextureImage({} x {})", self.width, self.height)
    }
}
