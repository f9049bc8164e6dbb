//! How much of each directional light arrives at each place of a volume.
//!
//! Reads volume textures and [`Classified`]; writes, for each volume whose lighting asks for it and each light, a [`LightVolume`], r32float:
//! columns along the light, see [`sweep`]. Reruns for a volume when its data or transfer function changes, and for a light when it turns against
//! the volume; a driver without memory fails it. Colours of lights and of transfer functions, the viewer and the step of rays change nothing.

pub mod cells;
pub mod lookup;
pub mod medium;
pub mod sweep;
pub mod through;

use super::classify::Classified;
use super::light_budget::KeptLights;
use super::upload::VolumeTexture;
use super::voxels::Reading;
use crate::components::{DirectionalLight, Motion, Placement, SceneSettings, Shading, VolumeLighting};
use crate::failure::Failure;
use crate::gpu::{Gpu, GpuError, Grid, Invocations, PassTimer, binding, uniform_buffer};
use crate::loading::LoadedVolume;
use crate::view::lights_in_order;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use cells::Cells;
use glam::{DAffine3, DVec3};
use medium::{Medium, MediumKernels};
use sweep::{Sweep, SweepUniform};

/// The light volumes of a volume, one for each light, in the order of the lights.
#[derive(Component, Debug, Default)]
pub(crate) struct LightVolumes(pub Vec<LightVolume>);

/// What one light sends into a volume.
#[derive(Debug)]
pub(crate) struct LightVolume {
    /// The light.
    pub light: Entity,
    /// Mean extinction along the light, see `light_volume.wgsl`.
    pub grid: Grid,
    /// Where its columns are.
    pub sweep: Sweep,
    /// What it was made from.
    recipe: Recipe,
    /// Counts up whenever the texels change.
    pub version: u64,
}

impl LightVolume {
    /// What a light sends into a volume, made by a recipe.
    pub fn new(light: Entity, grid: Grid, recipe: Recipe, version: u64) -> Self {
        Self { light, grid, sweep: recipe.sweep, recipe, version }
    }

    /// Slices in front of a place that rays look through for themselves.
    pub fn near(&self) -> u32 {
        self.recipe.near
    }

    /// What a shader needs to look it up.
    pub fn lookup(&self) -> SweepUniform {
        self.sweep.lookup(self.recipe.slice)
    }
}

/// Everything that the texels depend on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Recipe {
    sweep: Sweep,
    /// Scene units that light travels from slice to slice.
    slice: f64,
    /// Slices in front of a place that rays look through for themselves.
    near: u32,
    volume: wgpu::TextureView,
    classified: u64,
}

impl Recipe {
    /// How far light travels from slice to slice, in the texture's space.
    pub fn step(&self) -> DVec3 {
        self.sweep.step()
    }
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct LightSweeper {
    kernels: MediumKernels,
    version: u64,
}

mirror! {
    /// Mirror of `Segments` in `shaders/light_volume.wgsl`.
    "light_volume":
    pub(crate) struct SegmentsUniform as "Segments" {
        length: f32,
        count: u32,
    }
}

/// Format of a light volume.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// The lighting of a volume, with `Shading` taken into account.
pub(crate) fn lighting_in_force(
    lighting: &VolumeLighting,
    shading: Option<&Shading>,
    settings: &SceneSettings,
) -> VolumeLighting {
    match shading.unwrap_or(&settings.shading) {
        Shading::Scattering => lighting.clone(),
        Shading::Local => lighting.local(),
    }
}

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
        Option<&'static mut LightVolumes>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    (gpu, settings, kept_lights): (Res<Gpu>, Res<SceneSettings>, Res<KeptLights>),
    mut volumes: Volumes,
    lights: Query<(Entity, &DirectionalLight, Option<&Motion>)>,
    mut sweeper: ResMut<LightSweeper>,
    (mut timer, mut report, mut failure): (Option<ResMut<PassTimer>>, ResMut<Report>, ResMut<Failure>),
) {
    let mut lights = lights_in_order(&lights);
    lights.truncate(kept_lights.0);
    let mut held = 0;
    for (entity, loaded, classified, texture, placement, lighting, shading, mut kept) in &mut volumes {
        if failure.stands_on(entity) {
            continue;
        }
        let lighting = lighting_in_force(lighting, shading, &settings);
        let Some(resolution) = lighting.light_resolution() else {
            if kept.is_some() {
                commands.entity(entity).remove::<LightVolumes>();
            }
            continue;
        };
        let scene_from_texture = scene_from_texture(loaded, placement, &settings);
        let cells = Cells::of(&gpu, (loaded, classified), resolution, scene_from_texture);
        let mut own = LightVolumes::default();
        let all = kept.as_mut().map_or(&mut own, |kept| kept.bypass_change_detection());
        let mut old = std::mem::take(&mut all.0);
        for (light, to_light) in &lights {
            let volume = (loaded, classified, texture);
            let recipe = recipe(volume, cells, *to_light, scene_from_texture);
            let found =
                old.iter().position(|volume| volume.light == *light).map(|index| old.swap_remove(index));
            if let Some(found) = found.filter(|found| found.recipe == recipe) {
                held += found.grid.bytes();
                all.0.push(found);
                continue;
            }
            let timing = timer.as_mut().and_then(|timer| timer.time_compute("light_volume"));
            match gpu
                .attempt("light_volume", || make(&gpu, &mut sweeper, volume, &recipe, timing, &mut report))
            {
                Ok(grid) => {
                    sweeper.version += 1;
                    held += grid.bytes();
                    all.0.push(LightVolume::new(*light, grid, recipe, sweeper.version));
                }
                Err(error) => failure.on(entity, "light_volume", "VolumeLighting", error),
            }
        }
        if failure.stands_on(entity) {
            // Rather none than that of some lights.
            all.0.clear();
        }
        if kept.is_none() {
            commands.entity(entity).insert(own);
        }
    }
    report.hold("light_volume", held);
}

/// Takes the texture of a volume, 0 to 1 along each axis, to the scene.
pub(crate) fn scene_from_texture(
    loaded: &LoadedVolume,
    placement: &Placement,
    settings: &SceneSettings,
) -> DAffine3 {
    let extent = 2.0 * loaded.half_extent().as_dvec3() / f64::from(settings.millimetres_per_unit);
    placement.0 * DAffine3::from_scale(extent) * DAffine3::from_translation(DVec3::splat(-0.5))
}

/// What the light volume of a volume is made from, for a light in a direction.
pub(crate) fn recipe(
    (_, classified, texture): (&LoadedVolume, &Classified, &VolumeTexture),
    Cells { count, near, .. }: Cells,
    to_light: DVec3,
    scene_from_texture: DAffine3,
) -> Recipe {
    let direction = scene_from_texture.inverse().transform_vector3(-to_light);
    let sweep = Sweep::new(count, direction);
    let slice = scene_from_texture.transform_vector3(sweep.step()).length();
    Recipe { sweep, slice, near, volume: texture.view.clone(), classified: classified.versions.extinction }
}

/// Bytes of a light volume of so many cells, for light that travels in a direction given in the texture's space.
pub(crate) fn bytes_of(cells: Cells, direction: DVec3) -> u64 {
    let texels = Sweep::new(cells.count, direction).size();
    4 * texels.to_array().into_iter().map(u64::from).product::<u64>()
}

pub(crate) fn make(
    gpu: &Gpu,
    sweeper: &mut LightSweeper,
    (loaded, classified, texture): (&LoadedVolume, &Classified, &VolumeTexture),
    recipe: &Recipe,
    timing: Option<wgpu::ComputePassTimestampWrites>,
    report: &mut Report,
) -> Result<Grid, GpuError> {
    let size = recipe.sweep.size();
    let grid = Grid::new(gpu, "light volume", size, FORMAT)?;
    let voxels = DVec3::from(loaded.data.size.map(f64::from));
    // No segment is longer than a voxel, so that nothing which rays see is missed.
    let count = (recipe.sweep.step() * voxels).abs().max_element().ceil().max(1.0) as u32;
    let segments = SegmentsUniform { length: (recipe.slice / f64::from(count)) as f32, count };
    let columns = uniform_buffer(gpu, "columns", &recipe.sweep.columns());
    let segments = uniform_buffer(gpu, "segments", &segments);
    let medium = Medium::new(gpu, loaded, classified, texture, &classified.cumulative.entries);
    let mut resources = medium.resources();
    resources.extend([
        columns.as_entire_binding(),
        wgpu::BindingResource::TextureView(&grid.view),
        segments.as_entire_binding(),
        wgpu::BindingResource::TextureView(&texture.view),
    ]);
    let bindings = [binding::UNIFORM, binding::GRID_OUT, binding::UNIFORM];
    let reading = Reading::of(texture.format, classified);
    let kernel = sweeper.kernels.get(gpu, reading, ("light_volume", "sweep"), &bindings, report)?;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    kernel.run(gpu, &mut encoder, &resources, Invocations::Count(size.x * size.y), timing);
    gpu.queue.submit([encoder.finish()]);
    report.ran("light_volume", &[("texels", size.to_array().into_iter().map(u64::from).product())]);
    Ok(grid)
}
