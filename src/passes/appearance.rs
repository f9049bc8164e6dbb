//! How files say that meshes look, on the GPU: colours of vertices, and materials and pictures of parts.

use super::mipmaps::{self, Level};
use crate::gpu::{Gpu, buffer_of};
use crate::sources::MeshData;
use crate::sources::mesh::{MeshMaterial, TextureImage};
use glam::{Vec2, Vec3};
use half::f16;
use std::ops::Range;
use std::sync::Arc;

/// How a mesh looks, where its file says so.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Appearance {
    /// Linear colour and texture coordinate of each vertex, interleaved: see [`VERTEX`].
    pub vertices: wgpu::Buffer,
    /// What looks alike, in the order of the triangles, of which each belongs to one.
    pub parts: Vec<Part>,
    texture_bytes: u64,
}

/// Triangles of one material.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    /// Which of the mesh's indices.
    pub indices: Range<u32>,
    /// What the file says of them.
    pub material: Option<Material>,
    /// The picture; one white texel where there is none.
    pub texture: wgpu::TextureView,
}

/// The material of a part: see [`MeshMaterial`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Material {
    pub diffuse: Vec3,
    pub specular: Vec3,
    pub shininess: f32,
}

/// Colour and texture coordinate of a vertex.
pub(crate) const VERTEX: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![3 => Float16x4, 4 => Float32x2];

impl Appearance {
    /// What a mesh brings; `None` where it says nothing of how it looks.
    pub fn new(gpu: &Gpu, data: &MeshData) -> Option<Self> {
        if data.colours.is_empty() && data.parts.is_empty() {
            return None;
        }
        let mut textures = Textures::default();
        let part = |(triangles, material): (Range<u32>, Option<&MeshMaterial>)| Part {
            indices: 3 * triangles.start..3 * triangles.end,
            material: material.map(|material| Material {
                diffuse: material.diffuse,
                specular: material.specular,
                shininess: material.shininess,
            }),
            texture: textures.view(gpu, material.and_then(|material| material.diffuse_texture.as_ref())),
        };
        let parts = all_triangles(data).map(part).collect();
        Some(Self { vertices: vertices(gpu, data), parts, texture_bytes: textures.bytes })
    }

    /// The same of a mesh whose triangles were cut into more.
    pub fn refined(&self, gpu: &Gpu, data: &MeshData) -> Self {
        let moved = |(part, (triangles, _)): (&Part, (Range<u32>, _))| Part {
            indices: 3 * triangles.start..3 * triangles.end,
            ..part.clone()
        };
        let parts = self.parts.iter().zip(all_triangles(data)).map(moved).collect();
        // The textures are those of the coarse mesh.
        Self { vertices: vertices(gpu, data), parts, texture_bytes: 0 }
    }

    /// Bytes that vertices and textures hold.
    pub fn bytes(&self) -> u64 {
        self.vertices.size() + self.texture_bytes
    }
}

/// The triangles that share a material, and those between them that have none.
fn all_triangles(data: &MeshData) -> impl Iterator<Item = (Range<u32>, Option<&MeshMaterial>)> {
    let count = data.triangles.len() as u32;
    let mut done = 0;
    let ends = std::iter::once((count..count, None));
    let parts =
        data.parts.iter().map(|part| (part.triangles.clone(), data.materials.get(part.material as usize)));
    parts
        .chain(ends)
        .flat_map(move |(triangles, material)| {
            let bare = done..triangles.start;
            done = triangles.end;
            [(bare, None), (triangles, material)]
        })
        .filter(|(triangles, _)| !triangles.is_empty())
}

fn vertices(gpu: &Gpu, data: &MeshData) -> wgpu::Buffer {
    #[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
    #[repr(C)]
    struct Vertex {
        colour: [f16; 4],
        texture: [f32; 2],
    }
    let vertex = |index| Vertex {
        colour: data.colours.get(index).unwrap_or(&[1.0; 4]).map(f16::from_f32),
        texture: data.texture_coordinates.get(index).map_or([0.0; 2], Vec2::to_array),
    };
    let vertices: Vec<Vertex> = (0..data.positions.len()).map(vertex).collect();
    buffer_of(gpu, "colours of vertices", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX)
}

/// The textures of a mesh, each once.
#[derive(Default)]
struct Textures {
    known: Vec<(Option<Arc<TextureImage>>, wgpu::TextureView)>,
    bytes: u64,
}

impl Textures {
    fn view(&mut self, gpu: &Gpu, image: Option<&Arc<TextureImage>>) -> wgpu::TextureView {
        let is_it = |known: &Option<Arc<TextureImage>>| match (known, image) {
            (Some(known), Some(image)) => Arc::ptr_eq(known, image),
            (None, None) => true,
            _ => false,
        };
        if let Some((_, view)) = self.known.iter().find(|(known, _)| is_it(known)) {
            return view.clone();
        }
        let levels = match image {
            Some(image) => mipmaps::levels(image, gpu.device.limits().max_texture_dimension_2d),
            None => vec![Level { width: 1, height: 1, texels: vec![[u8::MAX; 4]] }],
        };
        let view = upload(gpu, &levels);
        self.bytes += levels.iter().map(|level| 4 * level.texels.len() as u64).sum::<u64>();
        self.known.push((image.cloned(), view.clone()));
        view
    }
}

fn upload(gpu: &Gpu, levels: &[Level]) -> wgpu::TextureView {
    let extent =
        |level: &Level| wgpu::Extent3d { width: level.width, height: level.height, depth_or_array_layers: 1 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture of a mesh"),
        size: levels.first().map(extent).unwrap_or_default(),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (index, level) in levels.iter().enumerate() {
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: index as u32, ..texture.as_image_copy() },
            bytemuck::cast_slice(&level.texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * level.width),
                rows_per_image: Some(level.height),
            },
            extent(level),
        );
    }
    texture.create_view(&Default::default())
}

/// The bindings of the module `albedo`.
pub(crate) const BINDINGS: [wgpu::BindingType; 2] =
    [crate::gpu::binding::texture(wgpu::TextureViewDimension::D2, true), crate::gpu::binding::SAMPLER];

/// The module `albedo` of a shader: `textured(at)` is the picture's colour at a texture coordinate, with bindings from `first` on; white
/// where there are no pictures.
pub(crate) fn module(first: Option<usize>) -> (&'static str, String) {
    let text = match first {
        None => "fn textured(at: vec2f) -> vec3f {\n    return vec3f(1.0);\n}\n".to_owned(),
        // Coordinates grow upwards, rows of texels downwards.
        Some(first) => format!(
            "@group(0) @binding({first}) var picture_of_mesh: texture_2d<f32>;\n@group(0) @binding({}) var repeating_picture: sampler;\n\
             fn textured(at: vec2f) -> vec3f {{\n    return textureSample(picture_of_mesh, repeating_picture, vec2f(at.x, 1.0 - at.y)).rgb;\n}}\n",
            first + 1
        ),
    };
    ("albedo", text)
}

/// What pictures of meshes are looked up with: they repeat.
pub(crate) fn sampler(gpu: &Gpu) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("pictures of meshes"),
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sources::MeshPart;

    #[test]
    fn every_triangle_belongs_to_one_part() {
        let part = |triangles: Range<u32>, material| MeshPart { triangles, material };
        let data = MeshData {
            triangles: vec![[0, 1, 2]; 10],
            parts: vec![part(2..4, 1), part(4..5, 0), part(7..7, 0), part(8..9, 7)],
            materials: vec![MeshMaterial { name: "a".into(), ..Default::default() }, MeshMaterial::default()],
            ..MeshData::default()
        };
        let found: Vec<_> = all_triangles(&data)
            .map(|(range, material)| (range, material.map(|m| m.name.as_str())))
            .collect();
        assert_eq!(
            found,
            [
                (0..2, None),
                (2..4, Some("")),
                (4..5, Some("a")),
                (5..7, None),
                (7..8, None),
                (8..9, None),
                (9..10, None)
            ]
        );
    }
}
