//! Light that was scattered before, in the cells of a volume: sweeps away from each light and back.
//!
//! Reads [`LightCells`] and [`LightVolumes`]; writes [`ScatteredLight`]: for each light and cell a vec4f of the fluence and one of the flux along the
//! volume's axes, for an irradiance of 1. Each axis that the light leans to is swept. It counts in a cell the more the light follows it (counted in
//! cells), so that nothing jumps where the nearest axis changes, and the faster the light fades along it there, as across a surface. Reruns when what it reads changes, or the cone of the lighting.

use super::light_cells::LightCells;
use super::light_volume::lookup;
use super::light_volume::{LightVolume, LightVolumes, lighting_in_force, scene_from_texture};
use super::volume_shadow::{self, VolumeShadow, VolumeShadows};
use crate::components::{Auto, Placement, SceneSettings, Shading, VolumeLighting};
use crate::gpu::{
    Gpu, GpuError, Kernel, KernelDescriptor, PassTimer, binding, storage, uniform_buffer, uniform_each,
};
use crate::loading::LoadedVolume;
use crate::optics::two_stream::MU1;
use crate::render::Failure;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use encase::ShaderSize;
use glam::{DAffine3, DVec3, UVec3, Vec2, Vec3};

/// What each light scatters into the cells of a volume, in the order of the lights.
#[derive(Component, Debug, Default)]
pub(crate) struct ScatteredLight(pub Vec<ScatteredLayer>);

/// One light's part.
#[derive(Debug)]
pub(crate) struct ScatteredLayer {
    /// The light.
    pub light: Entity,
    /// Fluence and flux of each cell.
    pub cells: wgpu::Buffer,
    recipe: Recipe,
    /// Counts up whenever the cells change.
    pub version: u64,
}

#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    cells: u64,
    light_volume: u64,
    shadow: Option<u64>,
    sweeps: Vec<AxisSweep>,
}

/// One axis of a light's sweeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisSweep {
    cells: UVec3,
    axis: usize,
    forwards: bool,
    /// Lengths of a cell, scene units.
    lengths: DVec3,
    mu0: f64,
    g: f32,
    /// How much light leans to each axis.
    shares: DVec3,
    /// The width of the cone, as a multiple of what light does.
    width: f64,
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Scatterer {
    /// Without and with a shadow: the look ahead, away from the light and back.
    kernels: [Option<[Kernel; 3]>; 2],
    version: u64,
}

mirror! {
    /// Mirror of `ScatterSweep` in `shaders/scattered_light.wgsl`.
    "scattered_light":
    pub(crate) struct ScatterSweepUniform as "ScatterSweep" {
        cells: UVec3,
        axis: u32,
        shares: Vec3,
        along: f32,
        across: Vec2,
        mu0: f32,
        g: f32,
        forwards: u32,
        spread: f32,
        is_first: u32,
    }
}

mirror! {
    /// Mirror of `Slice` in `shaders/scattered_light.wgsl`.
    "scattered_light":
    pub(crate) struct SliceUniform as "Slice" {
        index: u32,
    }
}

/// The bindings of the kernels in front of those of the light volume.
const FIXED_BINDINGS: usize = 6;

/// An axis that would count for less is not swept, and all others count for less by as much, so that it sets in from nothing.
const LEAST_WEIGHT: f64 = 0.002;

impl AxisSweep {
    /// The sweeps for light that travels in a direction, given in the texture's space.
    pub fn all(
        lighting: &VolumeLighting,
        cells: UVec3,
        direction: DVec3,
        scene_from_texture: DAffine3,
    ) -> Vec<Self> {
        let VolumeLighting::LightVolume { cone_angle, blend, g, .. } = *lighting else { return Vec::new() };
        let in_cells = direction * cells.as_dvec3();
        let nearest = in_cells.abs().max_position();
        let shares = match blend {
            true => (in_cells * in_cells / in_cells.length_squared() - LEAST_WEIGHT).max(DVec3::ZERO),
            false => DVec3::AXES[nearest],
        };
        let shares = shares / shares.element_sum();
        let axes = scene_from_texture.matrix3;
        let axes = [axes.x_axis, axes.y_axis, axes.z_axis];
        let light = scene_from_texture.transform_vector3(direction).normalize();
        let width = match cone_angle {
            Auto::Auto => 1.0,
            Auto::Value(angle) => f64::from(angle).to_radians().tan() / MU1.acos().tan(),
        };
        let sweep = |axis: usize| Self {
            cells,
            axis,
            forwards: direction[axis] >= 0.0,
            lengths: DVec3::from_array([0, 1, 2].map(|axis| axes[axis].length() / f64::from(cells[axis]))),
            mu0: light.dot(axes[axis].normalize()).abs(),
            g,
            shares,
            width,
        };
        (0..3).filter(|axis| shares[*axis] > 0.0).map(sweep).collect()
    }

    /// Cells across and along.
    fn extent(&self) -> UVec3 {
        let [b, c] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        UVec3::new(self.cells[b], self.cells[c], self.cells[self.axis])
    }

    /// Columns of cells along the axis.
    pub fn columns(&self) -> u32 {
        let extent = self.extent();
        extent.x * extent.y
    }

    /// Slices across it.
    pub fn slices(&self) -> u32 {
        self.extent().z
    }

    /// Cells across that a direction, given in the texture's space, moves from slice to slice.
    pub fn slope(&self, direction: DVec3) -> glam::DVec2 {
        let in_cells = direction * self.cells.as_dvec3();
        let [b, c] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        glam::DVec2::new(in_cells[b], in_cells[c]) / in_cells[self.axis].abs()
    }

    pub fn uniform(&self) -> ScatterSweepUniform {
        let [b, c] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        ScatterSweepUniform {
            cells: self.cells,
            axis: self.axis as u32,
            shares: self.shares.as_vec3(),
            across: glam::DVec2::new(self.lengths[b], self.lengths[c]).as_vec2(),
            along: self.lengths[self.axis] as f32,
            mu0: self.mu0 as f32,
            g: self.g,
            forwards: u32::from(self.forwards),
            spread: (2.0 / (3.0 * MU1) * self.width * self.width) as f32,
            is_first: u32::from((0..self.axis).all(|axis| self.shares[axis] == 0.0)),
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
        &'static LightVolumes,
        Option<&'static VolumeShadows>,
        Option<&'static mut ScatteredLight>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    (gpu, settings): (Res<Gpu>, Res<SceneSettings>),
    mut volumes: Volumes,
    former: Query<Entity, (With<ScatteredLight>, Without<LightCells>)>,
    mut scatterer: ResMut<Scatterer>,
    (mut timer, mut report, mut failure): (Option<ResMut<PassTimer>>, ResMut<Report>, ResMut<Failure>),
) {
    for entity in &former {
        commands.entity(entity).remove::<ScatteredLight>();
    }
    let mut held = 0;
    for (entity, loaded, placement, lighting, shading, cells, light_volumes, shadows, mut kept) in
        &mut volumes
    {
        let lighting = lighting_in_force(lighting, shading, &settings);
        let scene_from_texture = scene_from_texture(loaded, placement, &settings);
        let mut own = ScatteredLight::default();
        let all = kept.as_mut().map_or(&mut own, |kept| kept.bypass_change_detection());
        let mut old = std::mem::take(&mut all.0);
        for light_volume in &light_volumes.0 {
            let direction = light_volume.sweep.step();
            let sweeps = AxisSweep::all(&lighting, cells.grid.size(), direction, scene_from_texture);
            let shadow = shadows.and_then(|shadows| shadows.of(light_volume.light));
            let recipe = Recipe {
                cells: cells.version,
                light_volume: light_volume.version,
                shadow: shadow.map(|shadow| shadow.version),
                sweeps,
            };
            let found = old.iter().position(|layer| layer.light == light_volume.light);
            let found = found.map(|index| old.swap_remove(index)).filter(|found| found.recipe == recipe);
            if let Some(found) = found {
                held += found.cells.size();
                all.0.push(found);
                continue;
            }
            let lit = (light_volume, shadow);
            match scatter(&gpu, &mut scatterer, cells, lit, &recipe, timer.as_deref_mut(), &mut report) {
                Ok(buffer) => {
                    scatterer.version += 1;
                    held += buffer.size();
                    let (light, version) = (light_volume.light, scatterer.version);
                    all.0.push(ScatteredLayer { light, cells: buffer, recipe, version });
                }
                Err(error) => failure.keep(Err(error)),
            }
        }
        if kept.is_none() {
            commands.entity(entity).insert(own);
        }
    }
    report.hold("scattered_light", held);
}

/// One of the structs of a buffer of slices.
pub(crate) fn slice_binding(slices: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    let size = std::num::NonZeroU64::new(SliceUniform::SHADER_SIZE.get());
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: slices, offset: 0, size })
}

fn scatter(
    gpu: &Gpu,
    scatterer: &mut Scatterer,
    cells: &LightCells,
    (light_volume, shadow): (&LightVolume, Option<&VolumeShadow>),
    recipe: &Recipe,
    mut timer: Option<&mut PassTimer>,
    report: &mut Report,
) -> Result<wgpu::Buffer, GpuError> {
    let [look_ahead, forward, back] = scatterer.kernels(gpu, shadow.is_some(), report)?;
    let size = cells.grid.size();
    let count = u64::from(size.element_product());
    let widest = recipe.sweeps.iter().map(AxisSweep::columns).max();
    let scattered = storage(gpu, "scattered light", 32 * count);
    let stacks = storage(gpu, "stacks", 48 * count);
    let faces = storage(gpu, "faces", 64 * u64::from(widest.unwrap_or(1)));
    let indices: Vec<_> = (0..size.max_element()).map(|index| SliceUniform { index }).collect();
    let (slices, stride) = uniform_each(gpu, "slices", &indices);
    let light_volumes = [light_volume];
    let (sweeps, sampler) = (lookup::sweeps(gpu, &light_volumes), lookup::sampler(gpu));
    let shadows: Vec<&VolumeShadow> = shadow.into_iter().collect();
    let shadow_places = volume_shadow::places(gpu, &shadows);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for sweep in &recipe.sweeps {
        let uniform = uniform_buffer(gpu, "scatter sweep", &sweep.uniform());
        let mut resources = vec![
            uniform.as_entire_binding(),
            slice_binding(&slices),
            wgpu::BindingResource::TextureView(&cells.grid.view),
            faces.as_entire_binding(),
            stacks.as_entire_binding(),
            scattered.as_entire_binding(),
        ];
        resources.extend(lookup::resources(&light_volumes, &sweeps, &sampler));
        resources.extend(volume_shadow::resources(&shadows, &shadow_places));
        let columns = sweep.columns();
        let away = (0..sweep.slices()).map(|slice| slice * stride);
        let timing = timer.as_deref_mut().and_then(|timer| timer.time_compute("scattered_light"));
        look_ahead.sweep(gpu, &mut encoder, &resources, columns, away.clone().rev(), None);
        forward.sweep(gpu, &mut encoder, &resources, columns, away.clone(), timing);
        let timing = timer.as_deref_mut().and_then(|timer| timer.time_compute("scattered_light"));
        back.sweep(gpu, &mut encoder, &resources, columns, away.rev(), timing);
        report.ran("scattered_light", &[("cells", count)]);
    }
    gpu.queue.submit([encoder.finish()]);
    Ok(scattered)
}

impl Scatterer {
    /// The kernels, made when they are first asked for.
    fn kernels(&mut self, gpu: &Gpu, shadowed: bool, report: &mut Report) -> Result<&[Kernel; 3], GpuError> {
        let known = &mut self.kernels[usize::from(shadowed)];
        let kernels = match known.take() {
            Some(kernels) => kernels,
            None => {
                report.pipelines.extend(["scattered_light"; 3]);
                let make = |entry_point| make(gpu, shadowed, entry_point);
                [make("look_ahead")?, make("forward")?, make("back")?]
            }
        };
        Ok(known.insert(kernels))
    }
}

fn make(gpu: &Gpu, shadowed: bool, entry_point: &str) -> Result<Kernel, GpuError> {
    let filtering = lookup::filtering(gpu);
    let mut bindings = vec![
        binding::UNIFORM,
        binding::UNIFORM_EACH,
        binding::texture(wgpu::TextureViewDimension::D3, false),
        binding::STORAGE_OUT,
        binding::STORAGE_OUT,
        binding::STORAGE_OUT,
    ];
    bindings.extend(lookup::bindings(1, filtering));
    let first_shadow = bindings.len();
    bindings.extend(volume_shadow::bindings(&[shadowed]));
    let generated = [
        lookup::light_volumes_module(1, filtering, FIXED_BINDINGS),
        volume_shadow::module(&[shadowed], first_shadow),
    ];
    Kernel::new(
        gpu,
        &KernelDescriptor {
            name: "scattered_light",
            generated: &generated,
            entry_point,
            bindings: &bindings,
        },
    )
}
