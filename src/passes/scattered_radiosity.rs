//! The light that leaves each point of a translucent mesh, of each light.
//!
//! Reads the points ([`SurfacePoints`]), the [`LightViews`] and the medium; writes [`ScatteredRadiosity`], one vec4f a point and light.
//! Reruns for the lights whose view changed, and for all lights where the medium, the points or the settings of the maps changed; as
//! long as nothing does, further sets of samples can be averaged in.

use super::body::Body;
use super::light_gbuffer::{LightFrame, LightView, LightViews};
use super::medium::MediumUniform;
use super::surface_points::SurfacePoints;
use super::upload::MeshBuffers;
use crate::components::{DipoleModel, ScatteringMaps, Subsurface};
use crate::gpu::{Gpu, GpuError, Kernel, KernelDescriptor, PassTimer, binding, storage, uniform_buffer};
use crate::render::Failure;
use crate::view::normal_matrix;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use glam::{DMat4, Mat4, Vec2, Vec3};
use std::collections::HashMap;

/// What leaves each point, by light.
#[derive(Component, Debug)]
pub(crate) struct ScatteredRadiosity {
    /// One vec4f a point, one layer of them after the other.
    pub layers: wgpu::Buffer,
    /// What each layer was made from; none where that failed.
    made: Vec<Option<Recipe>>,
    medium: (Subsurface, f64, MediumUniform),
    /// Counts up whenever the layers change.
    pub version: u64,
}

/// Everything that a layer depends on.
#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    view: u64,
    points: MeshBuffers,
    maps: ScatteringMaps,
    medium: MediumUniform,
}

mirror! {
    /// Mirror of `Estimator` in `shaders/shared/estimator.wgsl`.
    "scattered_radiosity":
    pub(crate) struct EstimatorUniform as "Estimator" {
        light_from_mesh: Mat4,
        light_from_mesh_normal: Mat4,
        low: Vec2,
        inverse_texel: Vec2,
        samples: u32,
        pass_index: u32,
        candidates: u32,
        points: u32,
        first: u32,
        core: f32,
        least_mu: f32,
        radius: f32,
        irradiance: Vec3,
    }
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Scatterer {
    /// Kernels by whether they are for the standard dipole.
    kernels: HashMap<bool, Kernel>,
    version: u64,
}

type Bodies<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static Body,
        &'static Subsurface,
        &'static ScatteringMaps,
        &'static SurfacePoints,
        &'static LightViews,
        Option<&'static mut ScatteredRadiosity>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    gpu: Res<Gpu>,
    mut bodies: Bodies,
    former: Query<Entity, (With<ScatteredRadiosity>, Without<Body>)>,
    mut scatterer: ResMut<Scatterer>,
    mut timer: Option<ResMut<PassTimer>>,
    (mut report, mut failure): (ResMut<Report>, ResMut<Failure>),
) {
    for entity in &former {
        commands.entity(entity).remove::<ScatteredRadiosity>();
    }
    let mut held = 0;
    for (entity, body, subsurface, maps, points, views, radiosity) in &mut bodies {
        let before = radiosity.as_ref().map(|radiosity| &radiosity.medium);
        let same = before.filter(|(known, length, _)| known == subsurface && *length == body.millimetres);
        let Some(medium) =
            same.map(|known| known.2.clone()).or_else(|| MediumUniform::new(subsurface, body.millimetres))
        else {
            continue;
        };
        let job = Job { gpu: &gpu, body, maps, points, medium: &medium, model: subsurface.model };
        let size = 16 * u64::from(points.count) * views.0.len().max(1) as u64;
        held += size;
        let mut new = None;
        let mut radiosity = radiosity;
        let kept = match radiosity.as_deref_mut() {
            Some(kept) if kept.layers.size() == size => kept,
            _ => new.insert(ScatteredRadiosity {
                layers: storage(&gpu, "scattered_radiosity", size),
                made: Vec::new(),
                medium: (subsurface.clone(), body.millimetres, medium.clone()),
                version: 0,
            }),
        };
        kept.medium = (subsurface.clone(), body.millimetres, medium.clone());
        kept.made.resize(views.0.len(), None);
        for (layer, view) in views.0.iter().enumerate() {
            let recipe = Recipe {
                view: view.version,
                points: points.mesh.clone(),
                maps: maps.clone(),
                medium: medium.clone(),
            };
            if kept.made[layer].as_ref() == Some(&recipe) {
                continue;
            }
            kept.made[layer] = None;
            let timing = timer.as_mut().and_then(|timer| timer.time_compute("scattered_radiosity"));
            match job.run(&mut scatterer, view, layer, &kept.layers, timing, &mut report) {
                Ok(()) => {
                    kept.made[layer] = Some(recipe);
                    scatterer.version += 1;
                    kept.version = scatterer.version;
                }
                Err(error) => failure.keep(Err(error)),
            }
        }
        if let Some(new) = new {
            commands.entity(entity).insert(new);
        }
    }
    report.hold("scattered_radiosity", held);
}

/// One mesh's part of the pass.
struct Job<'a> {
    gpu: &'a Gpu,
    body: &'a Body,
    maps: &'a ScatteringMaps,
    points: &'a SurfacePoints,
    medium: &'a MediumUniform,
    model: DipoleModel,
}

impl Job<'_> {
    fn run(
        &self,
        scatterer: &mut Scatterer,
        view: &LightView,
        layer: usize,
        layers: &wgpu::Buffer,
        timing: Option<wgpu::ComputePassTimestampWrites>,
        report: &mut Report,
    ) -> Result<(), GpuError> {
        let standard = self.model == DipoleModel::StandardDipole;
        if !scatterer.kernels.contains_key(&standard) {
            scatterer.kernels.insert(standard, make(self.gpu, standard)?);
            report.pipelines.push("scattered_radiosity");
        }
        let Some(kernel) = scatterer.kernels.get(&standard) else { return Ok(()) };
        let medium = uniform_buffer(self.gpu, "medium", self.medium);
        let estimator = uniform_buffer(self.gpu, "estimator", &self.estimator(&view.frame, layer));
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let resources = [
            medium.as_entire_binding(),
            estimator.as_entire_binding(),
            wgpu::BindingResource::TextureView(&view.target.view),
            self.points.mesh.vertices.as_entire_binding(),
            layers.as_entire_binding(),
        ];
        kernel.run(self.gpu, &mut encoder, &resources, self.points.count, timing);
        self.gpu.queue.submit([encoder.finish()]);
        report.ran("scattered_radiosity", &[("points", u64::from(self.points.count))]);
        Ok(())
    }

    fn estimator(&self, frame: &LightFrame, layer: usize) -> EstimatorUniform {
        let light_from_mesh = frame.light_from_body * self.body.body_from_mesh;
        let largest = self.medium.sigma_t_prime.max_element();
        let least_mu = (self.medium.mu * self.medium.sigma_t_prime).min_element();
        EstimatorUniform {
            light_from_mesh: DMat4::from(light_from_mesh).as_mat4(),
            light_from_mesh_normal: normal_matrix(light_from_mesh).as_mat4(),
            low: frame.low.truncate().as_vec2(),
            inverse_texel: Vec2::splat(frame.texels_per_length() as f32),
            samples: self.maps.samples,
            pass_index: 0,
            candidates: self.maps.samples,
            points: self.points.count,
            first: layer as u32 * self.points.count,
            core: (CORE / largest).clamp(1e-9, 1.0),
            least_mu,
            // No two points of a body are further apart.
            radius: 2.0,
            irradiance: Vec3::ONE,
        }
    }
}

/// The radius over which a dipole is nearly constant, in mean free paths.
const CORE: f32 = 0.1;

fn make(gpu: &Gpu, standard: bool) -> Result<Kernel, GpuError> {
    Kernel::new(
        gpu,
        &KernelDescriptor {
            name: "scattered_radiosity",
            generated: &[sampling_module(standard)],
            entry_point: "at_vertices",
            bindings: &[
                binding::UNIFORM,
                binding::UNIFORM,
                binding::TEXTURE,
                binding::STORAGE,
                binding::STORAGE_OUT,
            ],
        },
    )
}

/// The WGSL module `sampling`: how discs are sampled, and which dipole is evaluated.
pub(crate) fn sampling_module(standard: bool) -> (&'static str, String) {
    ("sampling", format!("#import sampling_adaptive\nconst STANDARD_DIPOLE = {standard};\n"))
}
