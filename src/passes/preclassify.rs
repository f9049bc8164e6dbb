//! Colour and extinction of each voxel, for volumes that are classified before they are interpolated.
//!
//! Reads volume textures and [`Classified`]; writes [`ClassifiedVoxels`]: a 3D texture, rgba16float, of the volume's size, colour times
//! extinction and extinction as shares of the greatest. Runs for a volume when its data or its function changes.

use super::classify::Classified;
use super::light_volume::lighting_in_force;
use super::raycast::table_texture;
use super::upload::VolumeTexture;
use super::voxels::{self, Reading};
use crate::components::{Classification, SceneSettings, Shading, VolumeLighting};
use crate::failure::Failure;
use crate::gpu::{
    Gpu, GpuError, Invocations, Kernel, KernelDescriptor, PassTimer, Texels, binding, uniform_buffer,
};
use crate::loading::LoadedVolume;
use crate::scene::{Problem, Problems};
use crate::view::Comparison;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use glam::Vec4;

/// The kernels, one for each kind of texels, from when it is first needed.
#[derive(Resource, Default, Debug)]
pub(crate) struct Preclassifier(Vec<(Texels, Kernel)>);

/// The classified voxels of a volume.
#[derive(Component, Debug)]
pub(crate) struct ClassifiedVoxels {
    pub view: wgpu::TextureView,
    /// What they are shares of: colour, and extinction.
    pub greatest: [f32; 2],
}

mirror! {
    /// Mirror of `Voxels` in `shaders/preclassify.wgsl`.
    "preclassify":
    pub(crate) struct VoxelsUniform as "Voxels" {
        lookup_scale: f32,
        lookup_offset: f32,
        entries: u32,
        is_exact: u32,
        greatest_colour: f32,
        greatest_extinction: f32,
    }
}

type Preclassifiable<'a> = (
    Entity,
    Ref<'a, Classified>,
    Ref<'a, VolumeTexture>,
    &'a LoadedVolume,
    Has<ClassifiedVoxels>,
    &'a VolumeLighting,
    Option<&'a Shading>,
);

pub(crate) fn preclassify(
    mut commands: Commands,
    (gpu, settings, comparison): (Res<Gpu>, Res<SceneSettings>, Res<Comparison>),
    volumes: Query<Preclassifiable>,
    orphans: Query<Entity, (With<ClassifiedVoxels>, Without<LoadedVolume>)>,
    mut kernels: ResMut<Preclassifier>,
    mut timer: Option<ResMut<PassTimer>>,
    (mut report, mut failure, mut problems): (ResMut<Report>, ResMut<Failure>, ResMut<Problems>),
) {
    for entity in &orphans {
        commands.entity(entity).remove::<ClassifiedVoxels>();
    }
    let (mut bytes, mut changed) = (0, !orphans.is_empty());
    for (entity, classified, texture, loaded, has, lighting, shading) in &volumes {
        if failure.stands_on(entity) {
            continue;
        }
        let lighting = lighting_in_force(lighting, shading, &settings);
        let has_normals =
            lighting.takes_normals() || comparison.0.is_some() && lighting.local().takes_normals();
        let is_wanted = match classified.is_nearest {
            // To smooth what is there, for normals.
            true => has_normals,
            false => classified.classification == Classification::Pre,
        };
        if !is_wanted {
            if has {
                commands.entity(entity).remove::<ClassifiedVoxels>();
                changed = true;
            }
            continue;
        }
        let count = loaded.data.size.iter().map(|side| u64::from(*side)).product::<u64>();
        bytes += 8 * count;
        if has && !classified.is_changed() && !texture.is_changed() {
            continue;
        }
        changed = true;
        let Ok(count) = u32::try_from(count) else {
            let problem = Problem::error(format!("{count} voxels are too many to be classified beforehand"));
            problems.0.push(
                problem
                    .help("classify samples: `classification: Post`")
                    .on(entity, "TransferFunction.classification"),
            );
            continue;
        };
        let timing = timer.as_mut().and_then(|timer| timer.time_compute("preclassify"));
        let made = || {
            let kernel = ready(&gpu, &mut kernels, Reading::of(texture.format, &classified), &mut report)?;
            Ok(classified_voxels(&gpu, kernel, &classified, &texture, loaded.data.size, timing))
        };
        match gpu.attempt("preclassify", made) {
            Ok(voxels) => {
                report.ran("preclassify", &[("voxels", u64::from(count))]);
                commands.entity(entity).insert(voxels);
            }
            Err(error) => failure.on(entity, "preclassify", "TransferFunction.classification", error),
        }
    }
    if changed {
        report.hold("classified voxels", bytes);
    }
}

fn ready<'a>(
    gpu: &Gpu,
    kernels: &'a mut Preclassifier,
    reading: Reading,
    report: &mut Report,
) -> Result<&'a Kernel, GpuError> {
    let index = match kernels.0.iter().position(|(made_for, _)| *made_for == reading.texels) {
        Some(index) => index,
        None => {
            kernels.0.push((reading.texels, make(gpu, reading)?));
            report.pipelines.push("preclassify");
            kernels.0.len() - 1
        }
    };
    Ok(&kernels.0[index].1)
}

fn make(gpu: &Gpu, reading: Reading) -> Result<Kernel, GpuError> {
    let bindings = [
        binding::UNIFORM,
        binding::texture(wgpu::TextureViewDimension::D3, false),
        binding::TEXTURE,
        binding::VOXELS_OUT,
    ];
    let name = "preclassify";
    let generated = [voxels::texels_module(reading)];
    Kernel::new(
        gpu,
        &KernelDescriptor { name, generated: &generated, entry_point: name, bindings: &bindings },
    )
}

fn classified_voxels(
    gpu: &Gpu,
    kernel: &Kernel,
    classified: &Classified,
    samples: &VolumeTexture,
    [width, height, depth]: [u32; 3],
    timing: Option<wgpu::ComputePassTimestampWrites>,
) -> ClassifiedVoxels {
    let entries = &classified.table.entries;
    // Nothing may be divided by 0.
    let greatest = |of: &dyn Fn(&Vec4) -> f32| entries.iter().map(of).fold(1e-30f32, f32::max);
    let greatest = [greatest(&|entry| entry.truncate().max_element()), greatest(&|entry| entry.w)];
    let (lookup_scale, lookup_offset) = classified.lookup(samples.format);
    let uniform = VoxelsUniform {
        lookup_scale,
        lookup_offset,
        entries: entries.len() as u32,
        is_exact: u32::from(classified.table.is_exact),
        greatest_colour: greatest[0],
        greatest_extinction: greatest[1],
    };
    let uniform = uniform_buffer(gpu, "voxels", &uniform);
    let table = table_texture(gpu, entries);
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("classified voxels"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: depth },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    let table = table.create_view(&Default::default());
    let resources = [
        uniform.as_entire_binding(),
        wgpu::BindingResource::TextureView(&samples.view),
        wgpu::BindingResource::TextureView(&table),
        wgpu::BindingResource::TextureView(&view),
    ];
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    kernel.run(gpu, &mut encoder, &resources, Invocations::Count(width * height * depth), timing);
    gpu.queue.submit([encoder.finish()]);
    ClassifiedVoxels { view, greatest }
}
