//! What was read goes to the GPU, once, and is let go of on the processor.

use super::appearance::Appearance;
use crate::components::Subsurface;
use crate::failure::Failure;
use crate::gpu::{Gpu, GpuError, VolumeFormat, buffer_of};
use crate::loading::{LoadedMesh, LoadedVolume};
use crate::scene::{EntityProblems, Problem};
use crate::sources::volume::is_present;
use crate::sources::{MeshData, Samples};
use crate::{Stage, report::Report};
use bevy_app::{App, Plugin, Update};
use bevy_ecs::prelude::*;
use half::f16;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// Uploads meshes.
pub(crate) struct MeshUploadPlugin;

impl Plugin for MeshUploadPlugin {
    fn build(&self, app: &mut App) {
        let systems = (forget::<MeshBuffers, LoadedMesh>, upload_meshes).chain();
        app.add_systems(Update, systems.in_set(Stage::Upload).run_if(resource_exists::<Gpu>));
    }
}

/// Uploads volumes.
pub(crate) struct VolumeUploadPlugin;

impl Plugin for VolumeUploadPlugin {
    fn build(&self, app: &mut App) {
        let systems = (forget::<VolumeTexture, LoadedVolume>, upload_volumes).chain();
        app.add_systems(Update, systems.in_set(Stage::Upload).run_if(resource_exists::<Gpu>));
    }
}

/// What was uploaded goes with what was read.
fn forget<Uploaded: Component, Read: Component>(
    mut commands: Commands,
    orphans: Query<Entity, (With<Uploaded>, Without<Read>)>,
) {
    for entity in &orphans {
        commands.entity(entity).remove::<Uploaded>();
    }
}

/// A mesh on the GPU: position and normal of each vertex, interleaved, six 32-bit floats. Copies share the buffers.
#[derive(Component, Clone, Debug, PartialEq)]
pub(crate) struct MeshBuffers {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub index_count: u32,
    /// How its file says that it looks.
    pub appearance: Option<Arc<Appearance>>,
}

impl MeshBuffers {
    /// Uploads a mesh.
    ///
    /// # Errors
    ///
    /// If the driver has no room for it.
    pub fn new(gpu: &Gpu, data: &MeshData) -> Result<Self, GpuError> {
        Self::with(gpu, data, || Appearance::new(gpu, data))
    }

    /// Uploads a mesh whose triangles were cut into more, and that looks as it did.
    ///
    /// # Errors
    ///
    /// If the driver has no room for it.
    pub fn refined(&self, gpu: &Gpu, data: &MeshData) -> Result<Self, GpuError> {
        Self::with(gpu, data, || self.appearance.as_ref().map(|appearance| appearance.refined(gpu, data)))
    }

    fn with(
        gpu: &Gpu,
        data: &MeshData,
        appearance: impl FnOnce() -> Option<Appearance>,
    ) -> Result<Self, GpuError> {
        let vertices: Vec<[[f32; 3]; 2]> = data
            .positions
            .iter()
            .zip(&data.normals)
            .map(|(position, normal)| [position.to_array(), normal.to_array()])
            .collect();
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let indices = bytemuck::cast_slice(&data.triangles);
        gpu.attempt("uploading a mesh", || {
            Ok(Self {
                vertices: buffer_of(gpu, "vertices", bytemuck::cast_slice(&vertices), usage),
                indices: buffer_of(gpu, "indices", indices, wgpu::BufferUsages::INDEX),
                index_count: 3 * data.triangles.len() as u32,
                appearance: appearance().map(Arc::new),
            })
        })
    }

    /// Draws all triangles, with the vertices in slot 0.
    pub fn draw(&self, pass: &mut wgpu::RenderPass) {
        self.draw_some(pass, 0..self.index_count, 0..1);
    }

    /// Draws the triangles of some indices as often as there are instances, with the vertices in slot 0.
    pub fn draw_some(&self, pass: &mut wgpu::RenderPass, indices: Range<u32>, instances: Range<u32>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(indices, 0, instances);
    }

    /// Bytes of a vertex.
    pub const VERTEX: u64 = 24;

    /// Bytes that it holds.
    pub fn bytes(&self) -> u64 {
        let appearance = self.appearance.as_ref().map_or(0, |appearance| appearance.bytes());
        self.vertices.size() + self.indices.size() + appearance
    }
}

/// A volume on the GPU. Copies share the texture.
#[derive(Component, Clone, Debug)]
pub(crate) struct VolumeTexture {
    pub view: wgpu::TextureView,
    pub format: VolumeFormat,
    bytes: u64,
}

fn upload_meshes(
    mut commands: Commands,
    gpu: Res<Gpu>,
    mut meshes: Query<(Entity, &mut LoadedMesh, Has<Subsurface>)>,
    all: Query<&MeshBuffers>,
    mut failed: Local<HashSet<Entity>>,
    (mut report, mut failure): (ResMut<Report>, ResMut<Failure>),
) {
    let limit = gpu.device.limits().max_buffer_size;
    // Equal meshes, which share what was read, share what is uploaded. What they share is kept, so that nothing else gets its address.
    let mut uploaded: HashMap<*const MeshData, (MeshBuffers, Arc<MeshData>)> = HashMap::new();
    for (entity, mut mesh, scatters) in &mut meshes {
        let is_due = mesh.is_changed() || failed.contains(&entity);
        if !is_due || failure.stands_on(entity) {
            continue;
        }
        failed.remove(&entity);
        let kept = &mut mesh.bypass_change_detection().data;
        // What scatters is refined from here when the picture or the medium calls for it.
        let Some(data) = (if scatters { kept.clone() } else { kept.take() }) else { continue };
        let (vertices, triangles) = (data.positions.len() as u64, data.triangles.len() as u64);
        let largest = (vertices * MeshBuffers::VERTEX).max(triangles * 12);
        let too_large = (largest > limit).then(|| mesh_too_large(&data, largest, limit).on(entity, "Mesh"));
        let fits = too_large.is_none();
        EntityProblems::set(&mut commands, entity, "upload_meshes", too_large.into_iter().collect());
        if !fits {
            continue;
        }
        if let Some((buffers, _)) = uploaded.get(&Arc::as_ptr(&data)) {
            commands.entity(entity).insert(buffers.clone());
            continue;
        }
        match MeshBuffers::new(&gpu, &data) {
            Ok(buffers) => {
                report.ran("upload_meshes", &[("triangles", data.triangles.len() as u64)]);
                uploaded.insert(Arc::as_ptr(&data), (buffers.clone(), data));
                commands.entity(entity).insert(buffers);
            }
            Err(error) => {
                *kept = Some(data);
                failed.insert(entity);
                failure.on(entity, "upload_meshes", "Mesh", error);
            }
        }
    }
    let bytes_of = |buffers: &MeshBuffers| (buffers.vertices.clone(), buffers.bytes());
    let each: HashMap<wgpu::Buffer, u64> =
        all.iter().chain(uploaded.values().map(|(buffers, _)| buffers)).map(bytes_of).collect();
    report.hold("meshes", each.values().sum());
}

fn mesh_too_large(data: &MeshData, bytes: u64, limit: u64) -> Problem {
    let message = format!(
        "{} triangles need a buffer of {bytes} bytes; this adapter's limit is {limit}",
        data.triangles.len()
    );
    Problem::error(message).help("simplify the mesh, or split it into several entities")
}

fn upload_volumes(
    mut commands: Commands,
    gpu: Res<Gpu>,
    mut volumes: Query<(Entity, &mut LoadedVolume)>,
    all: Query<&VolumeTexture>,
    (mut report, mut failure): (ResMut<Report>, ResMut<Failure>),
) {
    let limit = gpu.device.limits().max_texture_dimension_3d;
    // Equal volumes, which share their samples, share the texture.
    let mut uploaded: HashMap<*const Samples, (VolumeTexture, Arc<Samples>)> = HashMap::new();
    for (entity, mut volume) in &mut volumes {
        if failure.stands_on(entity) {
            continue;
        }
        let volume = volume.bypass_change_detection();
        let Some(samples) = volume.samples.take() else { continue };
        let size = volume.data.size;
        let too_large = volume_too_large(size, limit).map(|problem| problem.on(entity, "Volume"));
        let fits = too_large.is_none();
        EntityProblems::set(&mut commands, entity, "upload_volumes", too_large.into_iter().collect());
        if !fits {
            continue;
        }
        if let Some((texture, _)) = uploaded.get(&Arc::as_ptr(&samples)) {
            commands.entity(entity).insert(texture.clone());
            continue;
        }
        match gpu
            .attempt("uploading a volume", || Ok(texture(&gpu, size, &samples, volume.data.non_finite > 0)))
        {
            Ok(texture) => {
                report.ran("upload_volumes", &[("voxels", samples.len() as u64)]);
                uploaded.insert(Arc::as_ptr(&samples), (texture.clone(), samples));
                commands.entity(entity).insert(texture);
            }
            Err(error) => {
                volume.samples = Some(samples);
                failure.on(entity, "upload_volumes", "Volume", error);
            }
        }
    }
    let bytes_of = |volume: &VolumeTexture| (volume.view.clone(), volume.bytes);
    let each: HashMap<wgpu::TextureView, u64> =
        all.iter().chain(uploaded.values().map(|(texture, _)| texture)).map(bytes_of).collect();
    report.hold("volumes", each.values().sum());
}

fn volume_too_large([x, y, z]: [u32; 3], limit: u32) -> Option<Problem> {
    if [x, y, z].into_iter().all(|side| side <= limit) {
        return None;
    }
    let message = format!("{x} x {y} x {z} voxels are more than this adapter takes: {limit} along each side");
    Some(Problem::error(message).help("downsample the volume, or cut out the part that matters"))
}

fn texture(gpu: &Gpu, size: [u32; 3], samples: &Samples, is_masked: bool) -> VolumeTexture {
    let format = VolumeFormat::choose(gpu, samples.format(), is_masked);
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("volume"),
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: size[2] },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: format.texture,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let slice = size[0] as usize * size[1] as usize;
    let texel = format.texture.block_copy_size(None).unwrap_or(4);
    // Some slices at a time, so that the converted copy stays small.
    let slices = ((4 << 20) / (slice * texel as usize)).clamp(1, size[2] as usize);
    for first in (0..size[2] as usize).step_by(slices) {
        let count = slices.min(size[2] as usize - first);
        let texels = convert(samples, first * slice..(first + count) * slice, format);
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { x: 0, y: 0, z: first as u32 },
                ..texture.as_image_copy()
            },
            &texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(size[0] * texel),
                rows_per_image: Some(size[1]),
            },
            wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: count as u32 },
        );
    }
    let bytes = slice as u64 * u64::from(size[2]) * u64::from(texel);
    VolumeTexture { view: texture.create_view(&Default::default()), format, bytes }
}

/// Samples as texels of a format: see [`VolumeFormat::choose`] for which goes with which.
fn convert(samples: &Samples, range: Range<usize>, format: VolumeFormat) -> Vec<u8> {
    use wgpu::TextureFormat as Format;
    fn bytes<T: bytemuck::Pod>(texels: impl Iterator<Item = T>) -> Vec<u8> {
        bytemuck::cast_slice(&texels.collect::<Vec<T>>()).to_vec()
    }
    match (samples, format.texture) {
        (Samples::U8(s), Format::R8Unorm) => s[range].to_vec(),
        (Samples::Rgba8(s), _) => bytes(s[range].iter().map(|&[red, green, blue, opacity]| {
            let opacity = f32::from(opacity) / 255.0;
            let [red, green, blue] = [red, green, blue].map(|primary| f32::from(primary) * opacity);
            [red, green, blue, opacity].map(f16::from_f32)
        })),
        (Samples::I8(s), Format::R8Unorm) => bytes(s[range].iter().map(|s| (i16::from(*s) + 128) as u8)),
        (Samples::U8(s), Format::R16Float) => {
            let halves: Vec<f16> = (0..=255u8).map(|value| f16::from_f32(f32::from(value))).collect();
            bytes(s[range].iter().map(|s| halves[usize::from(*s)]))
        }
        (Samples::I8(s), Format::R16Float) => bytes(s[range].iter().map(|s| f16::from_f32(f32::from(*s)))),
        (Samples::U16(s), Format::R16Unorm) => bytes(s[range].iter().copied()),
        (Samples::I16(s), Format::R16Unorm) => bytes(s[range].iter().map(|s| (i32::from(*s) + 32768) as u16)),
        (Samples::F32(s), Format::Rg32Float) => {
            bytes(s[range].iter().map(|s| if is_present(*s) { [*s, 1.0] } else { [0.0, 0.0] }))
        }
        (Samples::F32(s), _) => bytes(s[range].iter().copied()),
        (other, _) => bytes(range.map(|index| other.get(index).unwrap_or_default())),
    }
}
