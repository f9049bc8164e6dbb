//! Light that was scattered before, in the cells of a volume: what of each light is scattered and does not escape diffuses through the volume.
//!
//! Reads [`LightCells`], [`LightNetwork`], [`LightVolumes`] and [`VolumeShadows`]; writes [`ScatteredLight`]: for each light and cell a vec4f of the
//! fluence, for an irradiance of 1. Reruns when what it reads changes.

mod multigrid;

use super::light_cells::LightCells;
use super::light_network::{LightNetwork, aside};
use super::light_volume::lookup;
use super::light_volume::{LightVolume, LightVolumes, lighting_in_force, scene_from_texture};
use super::volume_shadow::{self, VolumeShadow, VolumeShadows};
use crate::components::{Placement, SceneSettings, Shading, VolumeLighting};
use crate::failure::Failure;
use crate::gpu::{
    Gpu, GpuError, Grid, Invocations, Kernel, KernelDescriptor, PassTimer, binding, storage, uniform_buffer,
};
use crate::loading::LoadedVolume;
use crate::optics::peak::Peak;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use glam::{DAffine3, DVec3, Vec3};
use multigrid::Multigrid;

/// What each light scatters into the cells of a volume, in the order of the lights.
#[derive(Component, Debug, Default)]
pub(crate) struct ScatteredLight(pub Vec<ScatteredLayer>);

/// One light's part.
#[derive(Debug)]
pub(crate) struct ScatteredLayer {
    /// The light.
    pub light: Entity,
    /// Fluence of each cell.
    pub cells: wgpu::Buffer,
    recipe: Recipe,
    /// Counts up whenever the cells change.
    pub version: u64,
}

#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    network: u64,
    light_volume: u64,
    shadow: Option<u64>,
    source: Source,
}

/// How a light crosses cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Source {
    /// Along the axes of the volume, of unit length.
    travels: DVec3,
    pub g: f32,
    /// Share of scattered light that leaves its way to the eye.
    aside: f32,
    /// Which axes count: all, or the nearest.
    axes: DVec3,
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Scatterer {
    /// By whether meshes shadow the light, and whether it is scattered evenly.
    light_up: [[Option<Kernel>; 2]; 2],
    multigrid: Option<Multigrid>,
    version: u64,
}

mirror! {
    /// Mirror of `Source` in `shaders/scattered_light.wgsl`.
    "scattered_light":
    pub(crate) struct SourceUniform as "Source" {
        travels: Vec3,
        g: f32,
        axes: Vec3,
        lobe: f32,
        g_even: f32,
        aside: f32,
    }
}

/// The bindings of the kernel in front of those of the light volume.
const FIXED_BINDINGS: usize = 5;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

impl Source {
    /// For light that travels in a direction, given in the texture's space.
    pub fn new(lighting: &VolumeLighting, direction: DVec3, scene_from_texture: DAffine3) -> Self {
        let VolumeLighting::LightVolume { blend, g, towards_eye, .. } = *lighting else {
            unreachable!("only light volumes have cells")
        };
        let axes = scene_from_texture.matrix3;
        let lengths = DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
        let travels = (direction * lengths).normalize();
        // Light along a face does not come in through it.
        let crossed = DVec3::select(travels.abs().cmpgt(DVec3::splat(1e-6)), DVec3::ONE, DVec3::ZERO);
        let axes = if blend { crossed } else { DVec3::AXES[travels.abs().max_position()] };
        Self { travels, g, axes, aside: aside(g, towards_eye) }
    }

    fn uniform(&self) -> SourceUniform {
        let peak = Peak::new(f64::from(self.g));
        SourceUniform {
            travels: self.travels.as_vec3(),
            g: self.g,
            axes: self.axes.as_vec3(),
            lobe: peak.lobe as f32,
            g_even: peak.g_even as f32,
            aside: self.aside,
        }
    }
}

type Volumes<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static LoadedVolume,
        &'static Placement,
        &'static VolumeLighting,
        Option<&'static Shading>,
        &'static LightCells,
        &'static LightNetwork,
        &'static LightVolumes,
        Option<&'static VolumeShadows>,
        Option<&'static mut ScatteredLight>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    (gpu, settings): (Res<Gpu>, Res<SceneSettings>),
    mut volumes: Volumes,
    former: Query<Entity, (With<ScatteredLight>, Without<LightNetwork>)>,
    mut scatterer: ResMut<Scatterer>,
    (mut timer, mut report, mut failure): (Option<ResMut<PassTimer>>, ResMut<Report>, ResMut<Failure>),
) {
    for entity in &former {
        commands.entity(entity).remove::<ScatteredLight>();
    }
    let mut held = 0;
    for (entity, loaded, placement, lighting, shading, cells, network, light_volumes, shadows, mut kept) in
        &mut volumes
    {
        if failure.stands_on(entity) {
            continue;
        }
        let lighting = lighting_in_force(lighting, shading, &settings);
        let scene_from_texture = scene_from_texture(loaded, placement, &settings);
        let mut own = ScatteredLight::default();
        let all = kept.as_mut().map_or(&mut own, |kept| kept.bypass_change_detection());
        let mut old = std::mem::take(&mut all.0);
        for light_volume in &light_volumes.0 {
            let shadow = shadows.and_then(|shadows| shadows.of(light_volume.light));
            let recipe = Recipe {
                network: network.version,
                light_volume: light_volume.version,
                shadow: shadow.map(|shadow| shadow.version),
                source: Source::new(&lighting, light_volume.sweep.step(), scene_from_texture),
            };
            let found = old.iter().position(|layer| layer.light == light_volume.light);
            let found = found.map(|index| old.swap_remove(index)).filter(|found| found.recipe == recipe);
            if let Some(found) = found {
                held += found.cells.size();
                all.0.push(found);
                continue;
            }
            let medium = (cells, network);
            let timing = timer.as_mut().and_then(|timer| timer.time_compute("scattered_light"));
            let lit = (light_volume, shadow);
            match gpu.attempt("scattered_light", || {
                scatter(&gpu, &mut scatterer, medium, lit, &recipe.source, timing, &mut report)
            }) {
                Ok(buffer) => {
                    scatterer.version += 1;
                    held += buffer.size();
                    let (light, version) = (light_volume.light, scatterer.version);
                    all.0.push(ScatteredLayer { light, cells: buffer, recipe, version });
                }
                Err(error) => failure.on(entity, "scattered_light", "VolumeLighting", error),
            }
        }
        if kept.is_none() {
            commands.entity(entity).insert(own);
        }
    }
    report.hold("scattered_light", held);
}

pub(crate) fn scatter(
    gpu: &Gpu,
    scatterer: &mut Scatterer,
    (cells, network): (&LightCells, &LightNetwork),
    (light_volume, shadow): (&LightVolume, Option<&VolumeShadow>),
    source: &Source,
    timing: Option<wgpu::ComputePassTimestampWrites>,
    report: &mut Report,
) -> Result<wgpu::Buffer, GpuError> {
    let (light_up, multigrid) = scatterer.kernels(gpu, [shadow.is_some(), source.g != 0.0], report)?;
    let level = &network.levels[0];
    let count = level.shape.count();
    let power = Grid::new(gpu, "power", level.shape.cells, FORMAT)?;
    let scattered = storage(gpu, "scattered light", 16 * u64::from(count));
    let uniform = uniform_buffer(gpu, "source", &source.uniform());
    let light_volumes = [light_volume];
    let (sweeps, sampler) = (lookup::sweeps(gpu, &light_volumes), lookup::sampler(gpu));
    let shadows: Vec<&VolumeShadow> = shadow.into_iter().collect();
    let shadow_places = volume_shadow::places(gpu, &shadows);
    let mut resources = vec![
        level.uniform.as_entire_binding(),
        uniform.as_entire_binding(),
        wgpu::BindingResource::TextureView(&cells.grid.view),
        network.escape.as_entire_binding(),
        wgpu::BindingResource::TextureView(&power.view),
    ];
    resources.extend(lookup::resources(&light_volumes, &sweeps, &sampler));
    resources.extend(volume_shadow::resources(&shadows, &shadow_places));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    light_up.run(gpu, &mut encoder, &resources, Invocations::Count(count), timing);
    multigrid.solve(gpu, &mut encoder, &network.levels, power, &scattered)?;
    gpu.queue.submit([encoder.finish()]);
    report.ran("scattered_light", &[("cells", u64::from(count))]);
    Ok(scattered)
}

impl Scatterer {
    /// The kernels, made when they are first asked for.
    fn kernels(
        &mut self,
        gpu: &Gpu,
        [shadowed, leans]: [bool; 2],
        report: &mut Report,
    ) -> Result<(&Kernel, &Multigrid), GpuError> {
        let known = &mut self.light_up[usize::from(shadowed)][usize::from(leans)];
        let light_up = match known.take() {
            Some(kernel) => kernel,
            None => {
                report.pipelines.push("scattered_light");
                make(gpu, shadowed, leans)?
            }
        };
        let multigrid = match self.multigrid.take() {
            Some(multigrid) => multigrid,
            None => Multigrid::new(gpu, report)?,
        };
        Ok((known.insert(light_up), self.multigrid.insert(multigrid)))
    }
}

/// The module `leaning`: whether light is scattered more to some sides than to others.
pub(crate) fn leaning_module(leans: bool) -> (&'static str, String) {
    ("leaning", format!("const LEANS = {leans};\n"))
}

fn make(gpu: &Gpu, shadowed: bool, leans: bool) -> Result<Kernel, GpuError> {
    let filtering = lookup::filtering(gpu);
    let mut bindings = vec![
        binding::UNIFORM,
        binding::UNIFORM,
        binding::texture(wgpu::TextureViewDimension::D3, false),
        binding::STORAGE,
        binding::grid_out(FORMAT),
    ];
    bindings.extend(lookup::bindings(1, filtering));
    let first_shadow = bindings.len();
    bindings.extend(volume_shadow::bindings(&[shadowed]));
    let generated = [
        lookup::light_volumes_module(1, filtering, FIXED_BINDINGS),
        volume_shadow::module(&[shadowed], first_shadow),
        leaning_module(leans),
    ];
    Kernel::new(
        gpu,
        &KernelDescriptor {
            name: "scattered_light",
            generated: &generated,
            entry_point: "light_up",
            bindings: &bindings,
        },
    )
}
