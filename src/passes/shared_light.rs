//! Light of the lights that have no light volume of their own: see [`LightBudget`](super::light_budget::LightBudget).
//!
//! Reads what [`light_volume`](super::light_volume) and [`scattered_light`](super::scattered_light) read; writes [`SharedLight`], one vec4f a cell: the
//! fluence of those lights, with their irradiance. What it makes of each on the way is let go of. Reruns when any of them changes.

use super::classify::Classified;
use super::light_budget::KeptLights;
use super::light_cells::LightCells;
use super::light_network::LightNetwork;
use super::light_volume::cells::Cells;
use super::light_volume::{self, LightSweeper, LightVolume, lighting_in_force, lookup, scene_from_texture};
use super::scattered_light::{self, Scatterer, Source};
use super::upload::VolumeTexture;
use super::volume_shadow::{self, VolumeShadow, VolumeShadows};
use crate::components::{DirectionalLight, Motion, Placement, SceneSettings, Shading, VolumeLighting};
use crate::failure::Failure;
use crate::gpu::{Gpu, GpuError, Invocations, Kernel, KernelDescriptor, binding, storage, uniform_buffer};
use crate::loading::LoadedVolume;
use crate::view::lights_in_order;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use glam::{UVec3, Vec3};

/// What lights without a light volume of their own bring into a volume.
#[derive(Component, Debug)]
pub(crate) struct SharedLight {
    /// Fluence of each cell.
    pub cells: wgpu::Buffer,
    /// The sum of their irradiances.
    pub irradiance: Vec3,
    recipe: Recipe,
    /// Counts up whenever the cells change.
    pub version: u64,
}

/// Everything that the cells depend on.
#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    cells: u64,
    network: Option<u64>,
    lights: Vec<Share>,
}

/// A light's part in it.
#[derive(Clone, Debug, PartialEq)]
struct Share {
    sweep: light_volume::Recipe,
    shadow: Option<u64>,
    source: Option<Source>,
    irradiance: Vec3,
}

mirror! {
    /// Mirror of `Share` in `shaders/shared_light.wgsl`.
    "shared_light":
    pub(crate) struct ShareUniform as "Share" {
        irradiance: Vec3,
        cells: UVec3,
        g: f32,
        keep: f32,
    }
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Sharer {
    /// By whether meshes shadow the light.
    kernels: [Option<Kernel>; 2],
    version: u64,
}

type Volumes<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        (&'static LoadedVolume, &'static Classified, &'static VolumeTexture),
        (&'static Placement, &'static VolumeLighting, Option<&'static Shading>),
        (&'static LightCells, Option<&'static LightNetwork>),
        Option<&'static VolumeShadows>,
        Option<&'static SharedLight>,
    ),
>;

type Lights<'w, 's> = Query<'w, 's, (Entity, &'static DirectionalLight, Option<&'static Motion>)>;

pub(crate) fn run(
    mut commands: Commands,
    (gpu, settings, kept_lights): (Res<Gpu>, Res<SceneSettings>, Res<KeptLights>),
    volumes: Volumes,
    former: Query<Entity, (With<SharedLight>, Without<LightCells>)>,
    lights: Lights,
    mut tools: (ResMut<Sharer>, ResMut<LightSweeper>, ResMut<Scatterer>),
    (mut report, mut failure): (ResMut<Report>, ResMut<Failure>),
) {
    for entity in &former {
        commands.entity(entity).remove::<SharedLight>();
    }
    let all = lights_in_order(&lights);
    let sharing = &all[kept_lights.0.min(all.len())..];
    let mut held = 0;
    for (entity, volume, (placement, lighting, shading), (cells, network), shadows, kept) in &volumes {
        if failure.stands_on(entity) {
            continue;
        }
        let lighting = lighting_in_force(lighting, shading, &settings);
        let Some(resolution) = lighting.light_resolution().filter(|_| !sharing.is_empty()) else {
            commands.entity(entity).remove::<SharedLight>();
            continue;
        };
        let scene_from_texture = scene_from_texture(volume.0, placement, &settings);
        let fine = Cells::of(&gpu, (volume.0, volume.1), resolution, scene_from_texture);
        let shadow_of = |light| shadows.and_then(|shadows| shadows.of(light));
        let share = |(light, to_light): &(Entity, glam::DVec3)| {
            let sweep = light_volume::recipe(volume, fine, *to_light, scene_from_texture);
            Share {
                source: network.map(|_| Source::new(&lighting, sweep.step(), scene_from_texture)),
                sweep,
                shadow: shadow_of(*light).map(|shadow| shadow.version),
                irradiance: lights.get(*light).map_or(Vec3::ZERO, |(_, light, _)| light.irradiance),
            }
        };
        let recipe = Recipe {
            cells: cells.version,
            network: network.map(|network| network.version),
            lights: sharing.iter().map(share).collect(),
        };
        if let Some(kept) = kept.filter(|kept| kept.recipe == recipe) {
            held += kept.cells.size();
            continue;
        }
        let shadows: Vec<Option<&VolumeShadow>> =
            sharing.iter().map(|(light, _)| shadow_of(*light)).collect();
        let lights: Vec<Entity> = sharing.iter().map(|(light, _)| *light).collect();
        let summed =
            || sum(&gpu, &mut tools, volume, (cells, network), &recipe, (&lights, &shadows), &mut report);
        match gpu.attempt("shared_light", summed) {
            Ok(buffer) => {
                tools.0.version += 1;
                held += buffer.size();
                let irradiance = recipe.lights.iter().map(|share| share.irradiance).sum();
                let version = tools.0.version;
                commands.entity(entity).insert(SharedLight { cells: buffer, irradiance, recipe, version });
            }
            Err(error) => failure.on(entity, "shared_light", "VolumeLighting", error),
        }
    }
    report.hold("shared_light", held);
}

/// Adds up what the lights of a recipe bring, one after the other, so that there is room for what one of them takes.
fn sum(
    gpu: &Gpu,
    (sharer, sweeper, scatterer): &mut (ResMut<Sharer>, ResMut<LightSweeper>, ResMut<Scatterer>),
    volume: (&LoadedVolume, &Classified, &VolumeTexture),
    (cells, network): (&LightCells, Option<&LightNetwork>),
    recipe: &Recipe,
    (lights, shadows): (&[Entity], &[Option<&VolumeShadow>]),
    report: &mut Report,
) -> Result<wgpu::Buffer, GpuError> {
    let count = cells.grid.size().element_product();
    let fluence = storage(gpu, "shared light", 16 * u64::from(count));
    for (index, share) in recipe.lights.iter().enumerate() {
        let grid = light_volume::make(gpu, sweeper, volume, &share.sweep, None, report)?;
        let light_volume = LightVolume::new(lights[index], grid, share.sweep.clone(), 0);
        let scattered = match (network, &share.source) {
            (Some(network), Some(source)) => {
                let (medium, lit) = ((cells, network), (&light_volume, shadows[index]));
                scattered_light::scatter(gpu, scatterer, medium, lit, source, None, report)?
            }
            // Light that is scattered once; a new buffer is all zeros.
            _ => storage(gpu, "nothing scattered", 16 * u64::from(count)),
        };
        let uniform = ShareUniform {
            irradiance: share.irradiance,
            cells: cells.grid.size(),
            g: share.source.map_or(0.0, |source| source.g),
            keep: if index == 0 { 0.0 } else { 1.0 },
        };
        let uniform = uniform_buffer(gpu, "share", &uniform);
        let light_volumes = [&light_volume];
        let (sweeps, sampler) = (lookup::sweeps(gpu, &light_volumes), lookup::sampler(gpu));
        let own: Vec<&VolumeShadow> = shadows[index].into_iter().collect();
        let places = volume_shadow::places(gpu, &own);
        let mut resources = vec![
            uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(&cells.grid.view),
            scattered.as_entire_binding(),
            fluence.as_entire_binding(),
        ];
        resources.extend(lookup::resources(&light_volumes, &sweeps, &sampler));
        resources.extend(volume_shadow::resources(&own, &places));
        let kernel = sharer.kernel(gpu, shadows[index].is_some(), report)?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        kernel.run(gpu, &mut encoder, &resources, Invocations::Count(count), None);
        gpu.queue.submit([encoder.finish()]);
        gpu.wait("sharing light")?;
    }
    report.ran("shared_light", &[("lights", recipe.lights.len() as u64), ("cells", u64::from(count))]);
    Ok(fluence)
}

impl Sharer {
    fn kernel(&mut self, gpu: &Gpu, shadowed: bool, report: &mut Report) -> Result<&Kernel, GpuError> {
        let known = &mut self.kernels[usize::from(shadowed)];
        match known.take() {
            Some(kernel) => Ok(known.insert(kernel)),
            None => {
                report.pipelines.push("shared_light");
                Ok(known.insert(make(gpu, shadowed)?))
            }
        }
    }
}

fn make(gpu: &Gpu, shadowed: bool) -> Result<Kernel, GpuError> {
    let filtering = lookup::filtering(gpu);
    let mut bindings = vec![
        binding::UNIFORM,
        binding::texture(wgpu::TextureViewDimension::D3, false),
        binding::STORAGE,
        binding::STORAGE_OUT,
    ];
    let first = bindings.len();
    bindings.extend(lookup::bindings(1, filtering));
    let first_shadow = bindings.len();
    bindings.extend(volume_shadow::bindings(&[shadowed]));
    let generated =
        [lookup::light_volumes_module(1, filtering, first), volume_shadow::module(&[shadowed], first_shadow)];
    let descriptor = KernelDescriptor {
        name: "shared_light",
        generated: &generated,
        entry_point: "add",
        bindings: &bindings,
    };
    Kernel::new(gpu, &descriptor)
}
