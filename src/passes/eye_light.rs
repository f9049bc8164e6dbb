//! Light that goes on towards the eye, for light volumes with `towards_eye`: the only light that depends on the viewer.
//!
//! Reads [`LightCells`], [`LightVolumes`] and [`SummedLight`]; writes [`EyeLight`], rgba16float, one texel a cell. Reruns when one of them
//! changes, or the direction from the middle of the volume to the eye.

pub mod sweep;

use self::sweep::{AxisSweep, SliceUniform, slice_binding};
use super::light_cells::LightCells;
use super::light_volume::{LightVolume, LightVolumes, lighting_in_force, lookup, scene_from_texture};
use super::summed_light::SummedLight;
use super::volume_shadow::{self, VolumeShadow, VolumeShadows};
use crate::components::{Placement, Projection, SceneSettings, Shading, VolumeLighting};
use crate::failure::Failure;
use crate::gpu::{
    Gpu, GpuError, Grid, Kernel, KernelDescriptor, PassTimer, binding, storage, storage_of, uniform_buffer,
    uniform_each,
};
use crate::loading::LoadedVolume;
use crate::optics::{peak::Peak, phase::henyey_greenstein};
use crate::view::View;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use glam::{DAffine3, DVec3, UVec3, Vec2, Vec4};

/// Light towards the eye in the cells of a volume.
#[derive(Component, Debug)]
pub(crate) struct EyeLight {
    /// Radiance, as a share of [`SummedLight::scale`].
    pub grid: Grid,
    recipe: Recipe,
}

#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    cells: u64,
    light_volumes: Vec<u64>,
    shadows: Vec<Option<u64>>,
    summed: u64,
    sweeps: Vec<AxisSweep>,
    slopes: Vec<Vec2>,
    sources: Vec<Vec4>,
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct EyeSweeper {
    /// And for which lights, and which of them have a shadow, they are made.
    kernels: Option<(Vec<bool>, [Kernel; 2])>,
}

mirror! {
    /// Mirror of `EyeSweep` in `shaders/eye_light.wgsl`.
    "eye_light":
    pub(crate) struct EyeSweepUniform as "EyeSweep" {
        slope: Vec2,
        lights: u32,
        scale: f32,
    }
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The bindings of the kernels in front of those of light volumes.
const FIXED_BINDINGS: usize = 9;

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
        &'static LightVolumes,
        &'static SummedLight,
        Option<&'static VolumeShadows>,
        Option<&'static EyeLight>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    (gpu, settings, view): (Res<Gpu>, Res<SceneSettings>, Res<View>),
    volumes: Volumes,
    former: Query<Entity, (With<EyeLight>, Without<LightCells>)>,
    mut sweeper: ResMut<EyeSweeper>,
    (mut timer, mut report, mut failure): (Option<ResMut<PassTimer>>, ResMut<Report>, ResMut<Failure>),
) {
    for entity in &former {
        commands.entity(entity).remove::<EyeLight>();
    }
    let mut held = 0;
    for (entity, loaded, placement, lighting, shading, cells, light_volumes, summed, shadows, kept) in
        &volumes
    {
        if failure.stands_on(entity) {
            continue;
        }
        let lighting = lighting_in_force(lighting, shading, &settings);
        let is_wanted =
            matches!(lighting, VolumeLighting::LightVolume { towards_eye: true, g, .. } if g > 0.0);
        if !is_wanted {
            commands.entity(entity).remove::<EyeLight>();
            continue;
        }
        let scene_from_texture = scene_from_texture(loaded, placement, &settings);
        let shadows: Vec<Option<&VolumeShadow>> =
            light_volumes.0.iter().map(|volume| shadows?.of(volume.light)).collect();
        let recipe = recipe(&lighting, scene_from_texture, &view, cells, (light_volumes, &shadows), summed);
        if let Some(kept) = kept.filter(|kept| kept.recipe == recipe) {
            held += kept.grid.bytes();
            continue;
        }
        let timing = timer.as_deref_mut();
        let lights = (light_volumes.0.as_slice(), shadows.as_slice());
        let swept = || sweep(&gpu, &mut sweeper, cells, lights, summed, &recipe, timing, &mut report);
        match gpu.attempt("eye_light", swept) {
            Ok(grid) => {
                held += grid.bytes();
                commands.entity(entity).insert(EyeLight { grid, recipe });
            }
            Err(error) => failure.on(entity, "eye_light", "VolumeLighting", error),
        }
    }
    report.hold("eye_light", held);
}

fn recipe(
    lighting: &VolumeLighting,
    scene_from_texture: DAffine3,
    view: &View,
    cells: &LightCells,
    (light_volumes, shadows): (&LightVolumes, &[Option<&VolumeShadow>]),
    summed: &SummedLight,
) -> Recipe {
    let towards = towards_eye(view, scene_from_texture.transform_point3(DVec3::splat(0.5)));
    let direction = scene_from_texture.inverse().transform_vector3(towards);
    let sweeps = AxisSweep::all(lighting, cells.grid.size(), direction, scene_from_texture);
    let VolumeLighting::LightVolume { g, .. } = *lighting else {
        unreachable!("only light volumes come here")
    };
    let cap = Peak::new(f64::from(g)).cap;
    let source = |light: &LightVolume| {
        let travels = scene_from_texture.transform_vector3(light.sweep.step()).normalize();
        let phase = henyey_greenstein(f64::from(g), travels.dot(towards)).min(cap);
        (summed.irradiance(light.light) * phase as f32).extend(0.0)
    };
    Recipe {
        cells: cells.version,
        light_volumes: light_volumes.0.iter().map(|volume| volume.version).collect(),
        shadows: shadows.iter().map(|shadow| Some(shadow.as_ref()?.version)).collect(),
        summed: summed.version,
        slopes: sweeps.iter().map(|sweep| sweep.slope(direction).as_vec2()).collect(),
        sweeps,
        sources: light_volumes.0.iter().map(source).collect(),
    }
}

/// The direction from a place in the scene to the eye.
fn towards_eye(view: &View, place: DVec3) -> DVec3 {
    let in_eye = view.eye_from_scene.transform_point3(place);
    let back = match view.projection {
        Projection::Perspective { .. } if in_eye.length() > 1e-9 => -in_eye,
        _ => DVec3::Z,
    };
    view.eye_from_scene.inverse().transform_vector3(back).normalize()
}

#[expect(clippy::too_many_arguments, reason = "what the sweeps read and write")]
fn sweep(
    gpu: &Gpu,
    sweeper: &mut EyeSweeper,
    cells: &LightCells,
    (light_volumes, shadows): (&[LightVolume], &[Option<&VolumeShadow>]),
    summed: &SummedLight,
    recipe: &Recipe,
    mut timer: Option<&mut PassTimer>,
    report: &mut Report,
) -> Result<Grid, GpuError> {
    let light_volumes: Vec<&LightVolume> = light_volumes.iter().collect();
    let size: UVec3 = cells.grid.size();
    let count = u64::from(size.element_product());
    let [along, keep] = sweeper.kernels(gpu, shadows.iter().map(Option::is_some).collect(), report)?;
    let grid = Grid::new(gpu, "eye light", size, FORMAT)?;
    let widest = recipe.sweeps.iter().map(AxisSweep::columns).max().unwrap_or(1);
    let faces = storage(gpu, "faces", 64 * u64::from(widest));
    let towards_eye = storage(gpu, "towards eye", 16 * count);
    let mut sources = recipe.sources.clone();
    // A buffer cannot be empty.
    sources.push(Vec4::ZERO);
    let sources = storage_of(gpu, "sources", bytemuck::cast_slice(&sources));
    let indices: Vec<_> = (0..size.max_element()).map(|index| SliceUniform { index }).collect();
    let (slices, stride) = uniform_each(gpu, "slices", &indices);
    let (lookups, sampler) = (lookup::sweeps(gpu, &light_volumes), lookup::sampler(gpu));
    let shadows: Vec<&VolumeShadow> = shadows.iter().flatten().copied().collect();
    let shadow_places = volume_shadow::places(gpu, &shadows);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for (index, (sweep, slope)) in recipe.sweeps.iter().zip(&recipe.slopes).enumerate() {
        let uniform = uniform_buffer(gpu, "scatter sweep", &sweep.uniform());
        let eye = EyeSweepUniform { slope: *slope, lights: light_volumes.len() as u32, scale: summed.scale };
        let eye = uniform_buffer(gpu, "eye sweep", &eye);
        let mut resources = vec![
            uniform.as_entire_binding(),
            slice_binding(&slices),
            wgpu::BindingResource::TextureView(&cells.grid.view),
            faces.as_entire_binding(),
            wgpu::BindingResource::TextureView(&summed.fluence.view),
            towards_eye.as_entire_binding(),
            eye.as_entire_binding(),
            sources.as_entire_binding(),
            wgpu::BindingResource::TextureView(&grid.view),
        ];
        resources.extend(lookup::resources(&light_volumes, &lookups, &sampler));
        resources.extend(volume_shadow::resources(&shadows, &shadow_places));
        let offsets = (0..sweep.slices()).map(|slice| slice * stride);
        let timing = timer.as_deref_mut().and_then(|timer| timer.time_compute("eye_light"));
        along.sweep(gpu, &mut encoder, &resources, sweep.columns(), offsets, timing);
        if index + 1 == recipe.sweeps.len() {
            keep.sweep(gpu, &mut encoder, &resources, count as u32, std::iter::once(0), None);
        }
        report.ran("eye_light", &[("cells", count)]);
    }
    gpu.queue.submit([encoder.finish()]);
    Ok(grid)
}

impl EyeSweeper {
    /// The kernels, made for lights of which some have a shadow.
    fn kernels(
        &mut self,
        gpu: &Gpu,
        shadowed: Vec<bool>,
        report: &mut Report,
    ) -> Result<&[Kernel; 2], GpuError> {
        let kernels = match self.kernels.take() {
            Some((made_for, kernels)) if made_for == shadowed => kernels,
            _ => {
                report.pipelines.extend(["eye_light"; 2]);
                [make(gpu, &shadowed, "sweep")?, make(gpu, &shadowed, "keep")?]
            }
        };
        Ok(&self.kernels.insert((shadowed, kernels)).1)
    }
}

fn make(gpu: &Gpu, shadowed: &[bool], entry_point: &str) -> Result<Kernel, GpuError> {
    let filtering = lookup::filtering(gpu);
    let mut bindings = vec![
        binding::UNIFORM,
        binding::UNIFORM_EACH,
        binding::texture(wgpu::TextureViewDimension::D3, false),
        binding::STORAGE_OUT,
        binding::texture(wgpu::TextureViewDimension::D3, false),
        binding::STORAGE_OUT,
        binding::UNIFORM,
        binding::STORAGE,
        binding::grid_out(FORMAT),
    ];
    bindings.extend(lookup::bindings(shadowed.len(), filtering));
    let first_shadow = bindings.len();
    bindings.extend(volume_shadow::bindings(shadowed));
    let generated = [
        lookup::light_volumes_module(shadowed.len(), filtering, FIXED_BINDINGS),
        volume_shadow::module(shadowed, first_shadow),
    ];
    Kernel::new(
        gpu,
        &KernelDescriptor { name: "eye_light", generated: &generated, entry_point, bindings: &bindings },
    )
}
