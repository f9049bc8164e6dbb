//! Scattered light of all lights together, as the ray caster looks it up.
//!
//! Reads [`ScatteredLight`], [`SharedLight`] and the irradiance of the lights; writes [`SummedLight`], rgba16float, one texel a cell: the fluence. Reruns when either changes; a light's colour changes nothing before this pass.

use super::light_cells::LightCells;
use super::scattered_light::{ScatteredLayer, ScatteredLight};
use super::shared_light::SharedLight;
use crate::components::DirectionalLight;
use crate::failure::Failure;
use crate::gpu::{
    Gpu, GpuError, Grid, Invocations, Kernel, KernelDescriptor, PassTimer, binding, storage, storage_of,
    uniform_buffer,
};
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use glam::{UVec3, Vec3, Vec4};

/// The scattered light in the cells of a volume.
#[derive(Component, Debug)]
pub(crate) struct SummedLight {
    /// Fluence, as a share of `scale`.
    pub fluence: Grid,
    /// Greatest irradiance of a light.
    pub scale: f32,
    made: (Vec<u64>, Vec<Vec3>),
    lights: Vec<Entity>,
    /// Counts up whenever the texels change.
    pub version: u64,
}

impl SummedLight {
    /// Irradiance of a light that is part of the sum.
    pub fn irradiance(&self, light: Entity) -> Vec3 {
        let index = self.lights.iter().position(|known| *known == light);
        index.and_then(|index| self.made.1.get(index)).copied().unwrap_or_default()
    }
}

mirror! {
    /// Mirror of `Summation` in `shaders/summed_light.wgsl`.
    "summed_light":
    pub(crate) struct SummationUniform as "Summation" {
        cells: UVec3,
        lights: u32,
    }
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Adder {
    kernel: Option<Kernel>,
    version: u64,
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

type Volumes<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static LightCells,
        Option<&'static ScatteredLight>,
        Option<&'static SharedLight>,
        Option<&'static SummedLight>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    gpu: Res<Gpu>,
    volumes: Volumes,
    former: Query<Entity, (With<SummedLight>, Without<LightCells>)>,
    lights: Query<&DirectionalLight>,
    mut adder: ResMut<Adder>,
    (mut timer, mut report, mut failure): (Option<ResMut<PassTimer>>, ResMut<Report>, ResMut<Failure>),
) {
    for entity in &former {
        commands.entity(entity).remove::<SummedLight>();
    }
    let mut held = 0;
    for (entity, cells, scattered, shared, kept) in &volumes {
        if failure.stands_on(entity) {
            continue;
        }
        let irradiance = |light| lights.get(light).map_or(Vec3::ZERO, |light| light.irradiance);
        let layers = scattered.map_or(&[][..], |scattered| scattered.0.as_slice());
        if layers.is_empty() && shared.is_none() {
            commands.entity(entity).remove::<SummedLight>();
            continue;
        }
        let irradiances: Vec<Vec3> = layers.iter().map(|layer| irradiance(layer.light)).collect();
        let versions: Vec<u64> =
            layers.iter().map(|layer| layer.version).chain(shared.map(|shared| shared.version)).collect();
        let made = (versions, irradiances);
        if let Some(kept) = kept.filter(|kept| kept.made == made) {
            held += kept.fluence.bytes();
            continue;
        }
        let timing = timer.as_mut().and_then(|timer| timer.time_compute("summed_light"));
        match gpu.attempt("summed_light", || {
            sum(&gpu, &mut adder, cells.grid.size(), (layers, shared), made, timing, &mut report)
        }) {
            Ok(summed) => {
                held += summed.fluence.bytes();
                commands.entity(entity).insert(summed);
            }
            Err(error) => failure.on(entity, "summed_light", "VolumeLighting", error),
        }
    }
    report.hold("summed_light", held);
}

fn sum(
    gpu: &Gpu,
    adder: &mut Adder,
    cells: UVec3,
    (scattered, shared): (&[ScatteredLayer], Option<&SharedLight>),
    made: (Vec<u64>, Vec<Vec3>),
    timing: Option<wgpu::ComputePassTimestampWrites>,
    report: &mut Report,
) -> Result<SummedLight, GpuError> {
    if adder.kernel.is_none() {
        adder.kernel = Some(make(gpu)?);
        report.pipelines.push("summed_light");
    }
    let (_, irradiances) = &made;
    let all = irradiances.iter().copied().chain(shared.map(|shared| shared.irradiance));
    let scale = all.map(Vec3::max_element).fold(0.0, f32::max);
    let fluence = Grid::new(gpu, "fluence", cells, FORMAT)?;
    let mut factors: Vec<Vec4> = irradiances
        .iter()
        .map(|irradiance| (*irradiance / scale.max(f32::MIN_POSITIVE)).extend(0.0))
        .collect();
    // What lights share has their irradiance already.
    factors.extend(shared.map(|_| Vec3::splat(scale.max(f32::MIN_POSITIVE).recip()).extend(0.0)));
    let count_of_layers = factors.len();
    let factors = storage_of(gpu, "irradiances", bytemuck::cast_slice(&factors));
    let count = u64::from(cells.element_product());
    let layers = storage(gpu, "layers of lights", 16 * count * count_of_layers as u64);
    let uniform = SummationUniform { cells, lights: count_of_layers as u32 };
    let uniform = uniform_buffer(gpu, "summation", &uniform);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let buffers = scattered.iter().map(|layer| &layer.cells).chain(shared.map(|shared| &shared.cells));
    for (index, buffer) in buffers.enumerate() {
        encoder.copy_buffer_to_buffer(buffer, 0, &layers, 16 * count * index as u64, 16 * count);
    }
    let resources = [
        uniform.as_entire_binding(),
        factors.as_entire_binding(),
        layers.as_entire_binding(),
        wgpu::BindingResource::TextureView(&fluence.view),
    ];
    if let Some(kernel) = &adder.kernel {
        kernel.run(gpu, &mut encoder, &resources, Invocations::Count(count as u32), timing);
    }
    gpu.queue.submit([encoder.finish()]);
    report.ran("summed_light", &[("cells", count)]);
    adder.version += 1;
    let lights = scattered.iter().map(|layer| layer.light).collect();
    Ok(SummedLight { fluence, scale, made, lights, version: adder.version })
}

fn make(gpu: &Gpu) -> Result<Kernel, GpuError> {
    Kernel::new(
        gpu,
        &KernelDescriptor {
            name: "summed_light",
            generated: &[],
            entry_point: "add_up",
            bindings: &[binding::UNIFORM, binding::STORAGE, binding::STORAGE, binding::grid_out(FORMAT)],
        },
    )
}
