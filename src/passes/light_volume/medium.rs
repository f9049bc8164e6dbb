//! The medium of a volume as kernels that sweep it read it: see `shaders/shared/classified.wgsl`.

use crate::gpu::{Gpu, GpuError, Kernel, KernelDescriptor, binding, texture_of, uniform_buffer};
use crate::loading::LoadedVolume;
use crate::mirrors::mirror;
use crate::passes::classify::Classified;
use crate::passes::raycast::{BRICK_ROW, table_texture};
use crate::passes::upload::VolumeTexture;
use crate::passes::voxels::{self, Reading};
use crate::report::Report;
use glam::{UVec2, UVec3, Vec3};

mirror! {
    /// Mirror of `Classified` in `shaders/shared/classified.wgsl`.
    "light_volume":
    pub(crate) struct ClassifiedUniform as "Classified" {
        lookup_scale: f32,
        lookup_offset: f32,
        last: f32,
        is_exact: u32,
        size: Vec3,
        bricks: UVec3,
    }
}

/// Kernels that read a medium: one for each way in which volumes are read, made when it is first asked for.
#[derive(Default, Debug)]
pub(crate) struct MediumKernels(Vec<(Reading, Kernel)>);

impl MediumKernels {
    /// The kernel `entry_point` of the shader `name`. Its own bindings stand behind those of the medium, and the volume behind them.
    pub fn get(
        &mut self,
        gpu: &Gpu,
        reading: Reading,
        (name, entry_point): (&'static str, &str),
        own: &[wgpu::BindingType],
        report: &mut Report,
    ) -> Result<&Kernel, GpuError> {
        let index = match self.0.iter().position(|(made_for, _)| *made_for == reading) {
            Some(index) => index,
            None => {
                let bindings = [&Medium::BINDINGS, own, &[reading.binding()]].concat();
                let generated = [("volumes", voxels::module(&[reading], bindings.len() - 1))];
                let descriptor =
                    KernelDescriptor { name, generated: &generated, entry_point, bindings: &bindings };
                self.0.push((reading, Kernel::new(gpu, &descriptor)?));
                report.pipelines.push(name);
                self.0.len() - 1
            }
        };
        Ok(&self.0[index].1)
    }
}

/// Its buffers, for the first bindings of a kernel.
pub(crate) struct Medium {
    uniform: wgpu::Buffer,
    table: wgpu::TextureView,
    bricks: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

impl Medium {
    /// The bindings of `classified.wgsl`, from 0.
    pub const BINDINGS: [wgpu::BindingType; 4] =
        [binding::UNIFORM, binding::TEXTURE, binding::INTEGERS, binding::SAMPLER];

    /// What a transfer function makes of a volume, with four numbers for each of its entries: colour and extinction of
    /// [`LookupTable`](crate::optics::transfer::LookupTable), or those of [`Cumulative`](crate::optics::transfer::Cumulative).
    pub fn new(
        gpu: &Gpu,
        loaded: &LoadedVolume,
        classified: &Classified,
        texture: &VolumeTexture,
        entries: &[[f32; 4]],
    ) -> Self {
        let (lookup_scale, lookup_offset) = classified.lookup(texture.format);
        let uniform = ClassifiedUniform {
            lookup_scale,
            lookup_offset,
            last: (entries.len() - 1) as f32,
            is_exact: u32::from(classified.table.is_exact),
            size: UVec3::from(loaded.data.size).as_vec3(),
            bricks: UVec3::from(classified.bricks),
        };
        let table = table_texture(gpu, bytemuck::cast_slice(entries));
        Self {
            uniform: uniform_buffer(gpu, "classified", &uniform),
            table: table.create_view(&Default::default()),
            bricks: brick_texture(gpu, &classified.distances).create_view(&Default::default()),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("linear"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
        }
    }

    /// The resources of those bindings.
    pub fn resources(&self) -> Vec<wgpu::BindingResource<'_>> {
        vec![
            self.uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(&self.table),
            wgpu::BindingResource::TextureView(&self.bricks),
            wgpu::BindingResource::Sampler(&self.sampler),
        ]
    }
}

/// The distances of bricks in rows.
fn brick_texture(gpu: &Gpu, distances: &[u8]) -> wgpu::Texture {
    let mut rows = distances.to_vec();
    rows.resize(rows.len().next_multiple_of(BRICK_ROW as usize), 0);
    let size = UVec2::new(BRICK_ROW, (rows.len() / BRICK_ROW as usize) as u32);
    texture_of(gpu, "brick distances", size, wgpu::TextureFormat::R8Uint, &rows)
}
