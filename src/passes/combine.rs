//! The light that leaves each point of a translucent mesh, of all lights together.
//!
//! Reads [`ScatteredRadiosity`] and the lights' irradiance; writes [`Radiosity`], one vec4f a point, which the surface pass interpolates.
//! Reruns when either changes; a light's colour changes nothing before this pass.

use super::body::Body;
use super::light_gbuffer::LightViews;
use super::scattered_radiosity::ScatteredRadiosity;
use super::surface_points::SurfacePoints;
use crate::components::DirectionalLight;
use crate::failure::Failure;
use crate::gpu::{
    Gpu, GpuError, Invocations, Kernel, KernelDescriptor, PassTimer, binding, storage, storage_of,
    uniform_buffer,
};
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use glam::{Vec3, Vec4};

/// What leaves each point of a mesh.
#[derive(Component, Debug)]
pub(crate) struct Radiosity {
    /// One vec4f a point.
    pub points: wgpu::Buffer,
    made: (u64, Vec<Vec3>),
}

mirror! {
    /// Mirror of `Combination` in `shaders/combine.wgsl`.
    "combine":
    pub(crate) struct CombinationUniform as "Combination" {
        points: u32,
        lights: u32,
    }
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Combiner {
    kernel: Option<Kernel>,
}

type Bodies<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static SurfacePoints,
        &'static LightViews,
        &'static ScatteredRadiosity,
        Option<&'static mut Radiosity>,
    ),
    With<Body>,
>;

pub(crate) fn run(
    mut commands: Commands,
    gpu: Res<Gpu>,
    mut bodies: Bodies,
    lights: Query<&DirectionalLight>,
    mut combiner: ResMut<Combiner>,
    mut timer: Option<ResMut<PassTimer>>,
    (mut report, mut failure): (ResMut<Report>, ResMut<Failure>),
) {
    let mut held = 0;
    for (entity, points, views, layers, mut radiosity) in &mut bodies {
        if failure.stands_on(entity) {
            continue;
        }
        let irradiance = |light: Entity| lights.get(light).map_or(Vec3::ZERO, |light| light.irradiance);
        let irradiances: Vec<Vec3> = match layers.is_shared {
            true => vec![Vec3::ONE],
            false => views.0.iter().map(|view| irradiance(view.light)).collect(),
        };
        let made = (layers.version, irradiances);
        let size = 16 * u64::from(points.count);
        held += size;
        let mut new = None;
        let kept = match radiosity.as_deref_mut() {
            Some(kept) if kept.points.size() == size && kept.made == made => continue,
            Some(kept) if kept.points.size() == size => kept,
            _ => new.insert(Radiosity { points: storage(&gpu, "combine", size), made: (0, Vec::new()) }),
        };
        let timing = timer.as_mut().and_then(|timer| timer.time_compute("combine"));
        let points = (points.count, &kept.points);
        let drawn = || draw(&gpu, &mut combiner, points, &made.1, &layers.layers, timing, &mut report);
        match gpu.attempt("combine", drawn) {
            Ok(()) => kept.made = made,
            Err(error) => failure.on(entity, "combine", "Subsurface", error),
        }
        if let Some(new) = new {
            commands.entity(entity).insert(new);
        }
    }
    report.hold("combine", held);
}

fn draw(
    gpu: &Gpu,
    combiner: &mut Combiner,
    (points, radiosity): (u32, &wgpu::Buffer),
    irradiances: &[Vec3],
    layers: &wgpu::Buffer,
    timing: Option<wgpu::ComputePassTimestampWrites>,
    report: &mut Report,
) -> Result<(), GpuError> {
    if combiner.kernel.is_none() {
        combiner.kernel = Some(make(gpu)?);
        report.pipelines.push("combine");
    }
    let Some(kernel) = &combiner.kernel else { return Ok(()) };
    let uniform = CombinationUniform { points, lights: irradiances.len() as u32 };
    let uniform = uniform_buffer(gpu, "combination", &uniform);
    let mut factors: Vec<Vec4> = irradiances.iter().map(|irradiance| irradiance.extend(0.0)).collect();
    // A buffer cannot be empty.
    factors.push(Vec4::ZERO);
    let factors = storage_of(gpu, "irradiances", bytemuck::cast_slice(&factors));
    let resources = [
        uniform.as_entire_binding(),
        factors.as_entire_binding(),
        layers.as_entire_binding(),
        radiosity.as_entire_binding(),
    ];
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    kernel.run(gpu, &mut encoder, &resources, Invocations::Count(points), timing);
    gpu.queue.submit([encoder.finish()]);
    report.ran("combine", &[("points", u64::from(points))]);
    Ok(())
}

fn make(gpu: &Gpu) -> Result<Kernel, GpuError> {
    Kernel::new(
        gpu,
        &KernelDescriptor {
            name: "combine",
            generated: &[],
            entry_point: "combine",
            bindings: &[binding::UNIFORM, binding::STORAGE, binding::STORAGE, binding::STORAGE_OUT],
        },
    )
}
