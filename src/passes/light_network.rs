//! The network in which light diffuses through a volume: how well it passes from cell to cell, and what of it stays or leaves.
//!
//! Reads [`LightCells`]; writes [`LightNetwork`]: what escapes of each cell (a buffer of vec4f), and for each of the levels, rgba32float, what cells
//! let go of and how they are linked. Reruns when the cells change, the volume is scaled, or `g`, the cone or `towards_eye` of its lighting changes; lights
//! and the viewer play no part.

pub mod directions;
pub mod levels;

use super::light_cells::LightCells;
use super::light_volume::{lighting_in_force, scene_from_texture};
use crate::components::{Auto, Placement, SceneSettings, Shading, VolumeLighting};
use crate::failure::Failure;
use crate::gpu::{
    Gpu, GpuError, Grid, Invocations, Kernel, KernelDescriptor, PassTimer, binding, storage, uniform_buffer,
    uniform_each,
};
use crate::loading::LoadedVolume;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use directions::Fan;
use glam::{DAffine3, DVec3};
use levels::LevelShape;

/// What the light of a volume diffuses through.
#[derive(Component, Debug)]
pub(crate) struct LightNetwork {
    /// For each cell the mean over all directions of (direction, 1) times the transmittance to the outside.
    pub escape: wgpu::Buffer,
    /// The finest first.
    pub levels: Vec<Level>,
    recipe: Recipe,
    /// Counts up whenever anything in it changes.
    pub version: u64,
}

/// One level of it.
#[derive(Debug)]
pub(crate) struct Level {
    /// Its cells.
    pub shape: LevelShape,
    /// The same for shaders.
    pub uniform: wgpu::Buffer,
    /// What cells let go of, for each colour.
    pub sinks: Grid,
    /// How each is linked to the next along each axis, for each colour.
    pub links: [Grid; 3],
}

#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    cells: u64,
    edges: DVec3,
    g: f32,
    aside: f32,
    spread: f32,
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct NetworkMaker {
    kernels: Option<Kernels>,
    version: u64,
}

#[derive(Debug)]
struct Kernels {
    average: Kernel,
    surround: Kernel,
    follow: Kernel,
    connect: Kernel,
    coarsen: Kernel,
}

mirror! {
    /// Mirror of `Diffusion` in `shaders/light_network.wgsl`.
    "light_network":
    pub(crate) struct DiffusionUniform as "Diffusion" {
        g: f32,
        aside: f32,
        spread: f32,
    }
}

/// Half angle of the cone in which light spreads as it diffuses: its tangent is that of the mean cosine 0.45 of a stream.
pub(crate) const CONE_ANGLE: f64 = 63.0;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

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
        Option<&'static LightNetwork>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    (gpu, settings): (Res<Gpu>, Res<SceneSettings>),
    volumes: Volumes,
    former: Query<Entity, (With<LightNetwork>, Without<LightCells>)>,
    mut maker: ResMut<NetworkMaker>,
    (mut timer, mut report, mut failure): (Option<ResMut<PassTimer>>, ResMut<Report>, ResMut<Failure>),
) {
    for entity in &former {
        commands.entity(entity).remove::<LightNetwork>();
    }
    let mut held = 0;
    for (entity, loaded, placement, lighting, shading, cells, kept) in &volumes {
        let VolumeLighting::LightVolume { g, cone_angle, towards_eye, .. } =
            lighting_in_force(lighting, shading, &settings)
        else {
            commands.entity(entity).remove::<LightNetwork>();
            continue;
        };
        let spread = match cone_angle {
            Auto::Auto => 1.0,
            Auto::Value(angle) => {
                (f64::from(angle).to_radians().tan() / CONE_ANGLE.to_radians().tan()).powi(2) as f32
            }
        };
        let edges = edges(scene_from_texture(loaded, placement, &settings), cells);
        let recipe = Recipe { cells: cells.version, edges, g, aside: aside(g, towards_eye), spread };
        if let Some(kept) = kept.filter(|kept| kept.recipe.is_same(&recipe)) {
            held += kept.bytes();
            continue;
        }
        let timing = timer.as_mut().and_then(|timer| timer.time_compute("light_network"));
        maker.version += 1;
        let version = maker.version;
        match gpu.attempt("light_network", || make(&gpu, &mut maker, cells, &recipe, timing, &mut report)) {
            Ok((escape, levels)) => {
                let network = LightNetwork { escape, levels, recipe, version };
                held += network.bytes();
                commands.entity(entity).insert(network);
            }
            Err(error) => failure.on(entity, "light_network", "VolumeLighting", error),
        }
    }
    report.hold("light_network", held);
}

impl Recipe {
    /// Turning a volume moves the last digits of its edges.
    fn is_same(&self, other: &Self) -> bool {
        let is_as_large = (self.edges - other.edges).abs().cmple(1e-12 * self.edges).all();
        is_as_large && Self { edges: self.edges, ..*other } == *self
    }
}

/// The share of scattered light that leaves the way it came to the eye: what is not in the peak, or, where light goes on towards the eye, not
/// in its cone.
pub(crate) fn aside(g: f32, towards_eye: bool) -> f32 {
    let ahead = g.max(0.0);
    if towards_eye { 1.0 - ahead } else { (1.0 - ahead) * (1.0 + ahead) }
}

/// Edges of a cell in the scene, as far as the axes of a volume stand upright on each other.
fn edges(scene_from_texture: DAffine3, cells: &LightCells) -> DVec3 {
    let axes = scene_from_texture.matrix3;
    let lengths = DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
    // A volume without any thickness has cells of some.
    (lengths / cells.grid.size().as_dvec3()).max(DVec3::splat(1e-30))
}

impl LightNetwork {
    fn bytes(&self) -> u64 {
        let grids = self.levels.iter().flat_map(|level| level.links.iter().chain([&level.sinks]));
        self.escape.size() + grids.map(Grid::bytes).sum::<u64>()
    }
}

fn view(grid: &Grid) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(&grid.view)
}

fn make(
    gpu: &Gpu,
    maker: &mut NetworkMaker,
    cells: &LightCells,
    recipe: &Recipe,
    timing: Option<wgpu::ComputePassTimestampWrites>,
    report: &mut Report,
) -> Result<(wgpu::Buffer, Vec<Level>), GpuError> {
    let kernels = maker.kernels(gpu, report)?;
    let shapes = LevelShape::all(cells.grid.size(), recipe.edges);
    let grid = |shape: &LevelShape, format| Grid::new(gpu, "light network", shape.cells, format);
    let mut levels = Vec::new();
    for shape in shapes {
        let uniform = uniform_buffer(gpu, "level", &shape.uniform());
        let links = [grid(&shape, FORMAT)?, grid(&shape, FORMAT)?, grid(&shape, FORMAT)?];
        levels.push(Level { shape, uniform, sinks: grid(&shape, FORMAT)?, links });
    }
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let around = surroundings(gpu, kernels, &mut encoder, cells, &levels)?;
    let escape = escape(gpu, kernels, &mut encoder, cells, &levels[0], recipe.aside, timing);
    let Recipe { g, aside, spread, .. } = *recipe;
    let diffusion = uniform_buffer(gpu, "diffusion", &DiffusionUniform { g, aside, spread });
    let Level { shape, uniform, sinks, links: [x, y, z] } = &levels[0];
    let mut resources = vec![uniform.as_entire_binding(), view(&cells.grid), view(&around)];
    resources.extend([escape.as_entire_binding(), view(sinks), view(x), view(y), view(z)]);
    resources.push(diffusion.as_entire_binding());
    kernels.connect.run(gpu, &mut encoder, &resources, Invocations::Count(shape.count()), None);
    for pair in levels.windows(2) {
        let Level { uniform, sinks, links: [x, y, z], .. } = &pair[0];
        let mut resources = vec![uniform.as_entire_binding(), view(sinks), view(x), view(y)];
        let Level { sinks, links: [x, y, coarse_z], shape, .. } = &pair[1];
        resources.extend([view(sinks), view(x), view(y), view(coarse_z), view(z)]);
        kernels.coarsen.run(gpu, &mut encoder, &resources, Invocations::Count(shape.count()), None);
    }
    gpu.queue.submit([encoder.finish()]);
    let count = u64::from(levels[0].shape.count());
    report.ran("light_network", &[("cells", count)]);
    Ok((escape, levels))
}

/// Extinction of the surroundings of each cell of the finest level.
fn surroundings(
    gpu: &Gpu,
    kernels: &Kernels,
    encoder: &mut wgpu::CommandEncoder,
    cells: &LightCells,
    levels: &[Level],
) -> Result<Grid, GpuError> {
    let mut means: Vec<Grid> = Vec::new();
    for pair in levels.windows(2) {
        let mean = Grid::new(gpu, "mean extinction", pair[1].shape.cells, FORMAT)?;
        let fine = means.last().unwrap_or(&cells.grid);
        let resources = [pair[0].uniform.as_entire_binding(), view(fine), view(&mean)];
        kernels.average.run(gpu, encoder, &resources, Invocations::Count(pair[1].shape.count()), None);
        means.push(mean);
    }
    let format = wgpu::TextureFormat::R32Float;
    // Above the coarsest level is nothing.
    let mut wider = Grid::new(gpu, "nothing around", glam::UVec3::ONE, format)?;
    for (index, level) in levels.iter().enumerate().rev() {
        let own = index.checked_sub(1).map_or(&cells.grid, |index| &means[index]);
        let around = Grid::new(gpu, "surroundings", level.shape.cells, format)?;
        let resources = [level.uniform.as_entire_binding(), view(own), view(&wider), view(&around)];
        kernels.surround.run(gpu, encoder, &resources, Invocations::Count(level.shape.count()), None);
        wider = around;
    }
    Ok(wider)
}

/// What escapes of each cell.
fn escape(
    gpu: &Gpu,
    kernels: &Kernels,
    encoder: &mut wgpu::CommandEncoder,
    cells: &LightCells,
    level: &Level,
    aside: f32,
    timing: Option<wgpu::ComputePassTimestampWrites>,
) -> wgpu::Buffer {
    let cells_along = level.shape.cells;
    let escape = storage(gpu, "what escapes", 16 * u64::from(level.shape.count()));
    let fans = Fan::all(level.shape.edges);
    let columns = fans.iter().map(|fan| fan.columns(cells_along)).max().unwrap_or(1);
    let planes = storage(gpu, "what gets out of slices", 32 * u64::from(columns));
    let steps = fans.iter().flat_map(|fan| (0..cells_along[fan.axis]).map(|slice| fan.uniform(slice, aside)));
    let (uniforms, stride) = uniform_each(gpu, "fans", &steps.collect::<Vec<_>>());
    let size = <directions::FanUniform as encase::ShaderSize>::SHADER_SIZE;
    let one = wgpu::BufferBinding { buffer: &uniforms, offset: 0, size: Some(size) };
    let resources = [
        level.uniform.as_entire_binding(),
        wgpu::BindingResource::Buffer(one),
        view(&cells.grid),
        escape.as_entire_binding(),
        planes.as_entire_binding(),
    ];
    let mut timing = timing;
    let mut first = 0;
    for fan in fans {
        let slices = cells_along[fan.axis];
        let offsets = (first..first + slices).map(|step| step * stride);
        kernels.follow.sweep(gpu, encoder, &resources, fan.columns(cells_along), offsets, timing.take());
        first += slices;
    }
    escape
}

impl NetworkMaker {
    /// The kernels, made when they are first asked for.
    fn kernels(&mut self, gpu: &Gpu, report: &mut Report) -> Result<&Kernels, GpuError> {
        let kernels = match self.kernels.take() {
            Some(kernels) => kernels,
            None => Kernels::new(gpu, report)?,
        };
        Ok(self.kernels.insert(kernels))
    }
}

impl Kernels {
    fn new(gpu: &Gpu, report: &mut Report) -> Result<Self, GpuError> {
        let read = binding::texture(wgpu::TextureViewDimension::D3, false);
        let write = binding::grid_out(FORMAT);
        let mut make = |name, entry_point, bindings: &[wgpu::BindingType]| {
            report.pipelines.push(name);
            Kernel::new(gpu, &KernelDescriptor { name, generated: &[], entry_point, bindings })
        };
        let name = "light_network";
        let four = [write; 4];
        let connect =
            [&[binding::UNIFORM, read, read, binding::STORAGE][..], &four, &[binding::UNIFORM]].concat();
        let coarsen = [&[binding::UNIFORM, read, read, read][..], &four, &[read]].concat();
        Ok(Self {
            average: make(name, "average", &[binding::UNIFORM, read, write])?,
            surround: make(name, "surround", &[binding::UNIFORM, read, read, binding::GRID_OUT])?,
            follow: make(
                "light_escape",
                "follow",
                &[binding::UNIFORM, binding::UNIFORM_EACH, read, binding::STORAGE_OUT, binding::STORAGE_OUT],
            )?,
            connect: make(name, "connect", &connect)?,
            coarsen: make(name, "coarsen", &coarsen)?,
        })
    }
}
