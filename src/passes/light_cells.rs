//! The medium of a volume, as coarse as light that was scattered often is.
//!
//! Reads volume textures and [`Classified`]; writes [`LightCells`], rgba32float, one texel a cell: mean albedo and extinction. Reruns for a volume
//! when its data, its transfer function or the resolution of its light changes.

use super::classify::Classified;
use super::light_budget::KeptLights;
use super::light_volume::cells::Cells;
use super::light_volume::medium::{Medium, MediumKernels};
use super::light_volume::{lighting_in_force, scene_from_texture};
use super::upload::VolumeTexture;
use super::voxels::Reading;
use crate::components::{Placement, SceneSettings, Shading, VolumeLighting};
use crate::failure::Failure;
use crate::gpu::{Gpu, GpuError, Grid, Invocations, PassTimer, binding, uniform_buffer};
use crate::loading::LoadedVolume;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use glam::UVec3;

/// The cells of a volume in which light is scattered often.
#[derive(Component, Debug)]
pub(crate) struct LightCells {
    /// Albedo and extinction per scene unit.
    pub grid: Grid,
    /// What it was made from.
    recipe: Recipe,
    /// Counts up whenever the texels change.
    pub version: u64,
}

#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    cells: UVec3,
    volume: wgpu::TextureView,
    classified: u64,
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct CellAverager {
    kernels: MediumKernels,
    version: u64,
}

mirror! {
    /// Mirror of `Cells` in `shaders/light_cells.wgsl`.
    "light_cells":
    pub(crate) struct CellsUniform as "Cells" {
        count: UVec3,
        samples: UVec3,
    }
}

/// Nodes of direct light to a cell of scattered light, along each axis.
const COARSER: f64 = 4.0;

/// Cells along an axis: at least so many, or the voxels there are, and at most so many.
const FEWEST: u32 = 16;
const MOST: u32 = 128;

/// In a dense medium, mean free paths that a cell is long at most; fluence that is interpolated between longer ones shows as spots. As far as so many cells
/// along each axis go.
const FREE_PATHS: f64 = 1.6;
const MOST_DENSE: u32 = 64;

type Volumes<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static LoadedVolume,
        &'static Classified,
        &'static VolumeTexture,
        &'static Placement,
        &'static VolumeLighting,
        Option<&'static Shading>,
        Option<&'static LightCells>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    (gpu, settings, kept_lights): (Res<Gpu>, Res<SceneSettings>, Res<KeptLights>),
    volumes: Volumes,
    former: Query<Entity, (With<LightCells>, Without<LoadedVolume>)>,
    lights: Query<(), With<crate::components::DirectionalLight>>,
    mut averager: ResMut<CellAverager>,
    (mut timer, mut report, mut failure): (Option<ResMut<PassTimer>>, ResMut<Report>, ResMut<Failure>),
) {
    for entity in &former {
        commands.entity(entity).remove::<LightCells>();
    }
    let mut held = 0;
    for (entity, loaded, classified, texture, placement, lighting, shading, kept) in &volumes {
        if failure.stands_on(entity) {
            continue;
        }
        let lighting = lighting_in_force(lighting, shading, &settings);
        let is_often = matches!(lighting, VolumeLighting::LightVolume { .. });
        // Light that is scattered once needs cells where lights share one sum.
        let is_wanted = !lights.is_empty() && (is_often || lights.iter().count() > kept_lights.0);
        let Some(resolution) = lighting.light_resolution().filter(|_| is_wanted) else {
            commands.entity(entity).remove::<LightCells>();
            continue;
        };
        let scene_from_texture = scene_from_texture(loaded, placement, &settings);
        let fine = Cells::of(&gpu, (loaded, classified), 1.0, scene_from_texture);
        let cells = coarser(fine, loaded.data.size, resolution);
        let recipe = Recipe { cells, volume: texture.view.clone(), classified: classified.versions.table };
        if let Some(kept) = kept.filter(|kept| kept.recipe == recipe) {
            held += kept.grid.bytes();
            continue;
        }
        let timing = timer.as_mut().and_then(|timer| timer.time_compute("light_cells"));
        let volume = (loaded, classified, texture);
        match gpu.attempt("light_cells", || make(&gpu, &mut averager, volume, cells, timing, &mut report)) {
            Ok(grid) => {
                averager.version += 1;
                held += grid.bytes();
                commands.entity(entity).insert(LightCells { grid, recipe, version: averager.version });
            }
            Err(error) => failure.on(entity, "light_cells", "VolumeLighting", error),
        }
    }
    report.hold("light_cells", held);
}

/// The cells of scattered light, for those of direct light at a resolution of 1.
fn coarser(fine: Cells, voxels: [u32; 3], resolution: f32) -> UVec3 {
    let along = |axis: usize| {
        let at_resolution = |cells: f64| (cells * f64::from(resolution)).ceil() as u32;
        let least = voxels[axis].min(FEWEST);
        let in_free_paths = at_resolution(fine.free_paths[axis] / FREE_PATHS);
        let fewest = if fine.is_dense { in_free_paths.clamp(least, MOST_DENSE) } else { least };
        at_resolution(f64::from(voxels[axis]) / COARSER).clamp(fewest, MOST)
    };
    UVec3::new(along(0), along(1), along(2))
}

fn make(
    gpu: &Gpu,
    averager: &mut CellAverager,
    (loaded, classified, texture): (&LoadedVolume, &Classified, &VolumeTexture),
    cells: UVec3,
    timing: Option<wgpu::ComputePassTimestampWrites>,
    report: &mut Report,
) -> Result<Grid, GpuError> {
    let grid = Grid::new(gpu, "light cells", cells, wgpu::TextureFormat::Rgba32Float)?;
    // Every other voxel, with its neighbours by interpolation; each, where nothing is interpolated.
    let every = if classified.is_nearest { 1.0 } else { 2.0 };
    let voxels = UVec3::from(loaded.data.size).as_vec3() / cells.as_vec3();
    let samples = (voxels / every).ceil().as_uvec3().clamp(UVec3::ONE, UVec3::splat(16));
    let uniform = uniform_buffer(gpu, "cells", &CellsUniform { count: cells, samples });
    let entries: Vec<[f32; 4]> = classified.table.entries.iter().map(|entry| entry.to_array()).collect();
    let medium = Medium::new(gpu, loaded, classified, texture, &entries);
    let mut resources = medium.resources();
    resources.extend([
        uniform.as_entire_binding(),
        wgpu::BindingResource::TextureView(&grid.view),
        wgpu::BindingResource::TextureView(&texture.view),
    ]);
    let bindings = [binding::UNIFORM, binding::grid_out(wgpu::TextureFormat::Rgba32Float)];
    let reading = Reading::of(texture.format, classified);
    let kernel = averager.kernels.get(gpu, reading, ("light_cells", "average"), &bindings, report)?;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    kernel.run(gpu, &mut encoder, &resources, Invocations::Count(cells.element_product()), timing);
    gpu.queue.submit([encoder.finish()]);
    let samples = u64::from(cells.element_product()) * u64::from(samples.element_product());
    report.ran("light_cells", &[("cells", u64::from(cells.element_product())), ("samples", samples)]);
    Ok(grid)
}
