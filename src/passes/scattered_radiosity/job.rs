//! One mesh, one light, one set of samples.

use super::kernels::{Place, Scatterer, Variant};
use crate::components::{Auto, DipoleModel, MapStrategy, SampleRadius, ScatteringMaps};
use crate::gpu::{
    Gpu, GpuError, Invocations, PassTimer, read_buffer, storage_array, uniform_array, uniform_buffer,
};
use crate::loading::LoadedMesh;
use crate::optics::sampling::ExponentialDisc;
use crate::passes::body::Body;
use crate::passes::light_gbuffer::LightView;
use crate::passes::medium::MediumUniform;
use crate::passes::scattering_gbuffer::CameraMaps;
use crate::passes::surface_points::SurfacePoints;
use crate::view::normal_matrix;
use crate::{mirrors::mirror, report::Report};
use glam::{DMat4, Mat4, Vec2, Vec3, Vec4};

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
        keep: f32,
        gain: Vec3,
    }
}

mirror! {
    /// Mirror of `Gathering` in `shaders/gather.wgsl`.
    "gather":
    pub(crate) struct GatheringUniform as "Gathering" {
        first: u32,
        keep: f32,
        gain: Vec3,
    }
}

/// Where a set of samples goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Destination {
    /// The layer.
    pub layer: usize,
    /// Which set of samples it is, from 0.
    pub set: u32,
    /// How much what is there already counts.
    pub keep: f32,
    /// How much what is found counts.
    pub gain: Vec3,
}

/// How samples are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sampling {
    strategy: MapStrategy,
    samples: u32,
    /// Of which the nearest are taken.
    candidates: u32,
    /// How far away they are at most, in body space.
    radius: f32,
}

impl Sampling {
    /// What a mesh's settings come to.
    pub fn of(maps: &ScatteringMaps, body: &Body) -> Self {
        let samples = maps.samples.min(MOST_CANDIDATES);
        let candidates = match (maps.strategy, maps.candidates) {
            (MapStrategy::Uniform, Auto::Value(candidates)) => candidates.clamp(samples, MOST_CANDIDATES),
            _ => samples,
        };
        let radius = match maps.radius {
            SampleRadius::Auto => f32::INFINITY,
            SampleRadius::Millimetres(radius) => radius / body.millimetres as f32,
        };
        // No two points of a body are further apart.
        Self { strategy: maps.strategy, samples, candidates, radius: radius.min(2.0) }
    }
}

/// One mesh's part of the pass.
pub(super) struct Job<'a> {
    pub gpu: &'a Gpu,
    pub body: &'a Body,
    pub sampling: Sampling,
    /// Whether further sets of samples are averaged in.
    pub is_progressive: bool,
    pub points: &'a SurfacePoints,
    pub mesh: &'a LoadedMesh,
    pub medium: &'a MediumUniform,
    pub model: DipoleModel,
}

/// The radius over which a dipole is nearly constant, in mean free paths.
const CORE: f32 = 0.1;

/// The most points of a published disc.
const MOST_CANDIDATES: u32 = 4096;

impl Job<'_> {
    /// Adds a set of samples to the layer of a light.
    #[expect(clippy::too_many_arguments, reason = "what the pass reads and writes")]
    pub fn run(
        &self,
        scatterer: &mut Scatterer,
        view: &LightView,
        maps: Option<&CameraMaps>,
        to: Destination,
        layers: &wgpu::Buffer,
        mut timer: Option<&mut PassTimer>,
        report: &mut Report,
    ) -> Result<(), GpuError> {
        let gpu = self.gpu;
        let estimator = self.estimator(view, to);
        let disc = self.disc(&estimator, to.set);
        let capacity = (disc.len() as u32).next_power_of_two();
        let variant = Variant {
            standard: self.model == DipoleModel::StandardDipole,
            uniform: (!disc.is_empty()).then_some((capacity, estimator.candidates == estimator.samples)),
        };
        let medium = uniform_buffer(gpu, "medium", self.medium);
        let uniform = uniform_buffer(gpu, "estimator", &estimator);
        let disc = uniform_array(gpu, "discs", &disc, capacity as usize);
        let mut common = vec![
            medium.as_entire_binding(),
            uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(&view.target.view),
        ];
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        if let Some(maps) = maps {
            self.at_texels(
                scatterer,
                variant,
                view,
                maps,
                &common,
                &disc,
                &mut encoder,
                timer.as_deref_mut(),
                report,
            )?;
            self.gather(scatterer, maps, to, layers, &mut encoder, report)?;
        }
        common.extend([self.points.mesh.vertices.as_entire_binding(), layers.as_entire_binding()]);
        let (place, invocations) = match maps {
            None => (Place::Points, Invocations::Count(self.points.count)),
            Some(maps) => {
                common.extend([maps.unseen.as_entire_binding(), maps.counts.as_entire_binding()]);
                (Place::Unseen, Invocations::Planned(&maps.dispatches, 12))
            }
        };
        if variant.uniform.is_some() {
            common.push(disc.as_entire_binding());
        }
        let kernel = scatterer.kernel(gpu, place, variant, report)?;
        let timing = timer.and_then(|timer| timer.time_compute("scattered_radiosity"));
        kernel.run(gpu, &mut encoder, &common, invocations, timing);
        gpu.queue.submit([encoder.finish()]);
        self.count(maps, report)
    }

    /// Notes what was done. How many texels were worth it and how many points no camera sees only the GPU knows.
    fn count(&self, maps: Option<&CameraMaps>, report: &mut Report) -> Result<(), GpuError> {
        match maps {
            None => report.ran("scattered_radiosity", &[("points", u64::from(self.points.count))]),
            Some(maps) if report.measure => {
                let counts = read_buffer(self.gpu, &maps.counts)?;
                let counts: Vec<u32> = counts.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect();
                let [texels, unseen] = [u64::from(counts[0]), u64::from(counts[1])];
                report.ran("scattered_radiosity", &[("texels", texels), ("points no camera sees", unseen)]);
            }
            Some(_) => report.ran("scattered_radiosity", &[]),
        }
        Ok(())
    }

    #[expect(clippy::too_many_arguments, reason = "what one dispatch reads and writes")]
    fn at_texels(
        &self,
        scatterer: &mut Scatterer,
        variant: Variant,
        view: &LightView,
        maps: &CameraMaps,
        common: &[wgpu::BindingResource],
        disc: &wgpu::Buffer,
        encoder: &mut wgpu::CommandEncoder,
        timer: Option<&mut PassTimer>,
        report: &mut Report,
    ) -> Result<(), GpuError> {
        let rotations: Vec<Mat4> = maps
            .views
            .iter()
            .map(|own| DMat4::from(view.view.view_from_body * own.view_from_body.inverse()).as_mat4())
            .collect();
        let texel = |own: &crate::passes::gbuffer::OrthographicView| own.texels_per_length().recip() as f32;
        let views: Vec<Vec4> = maps
            .views
            .iter()
            .map(|own| own.low.truncate().as_vec2().extend(texel(own)).extend(0.0))
            .collect();
        let rotations = storage_array(self.gpu, "light from view", &rotations);
        let views = storage_array(self.gpu, "views", &views);
        let mut resources = common.to_vec();
        resources.extend([
            maps.texels.as_entire_binding(),
            maps.counts.as_entire_binding(),
            wgpu::BindingResource::TextureView(&maps.gbuffer.view),
            wgpu::BindingResource::TextureView(&maps.radiosity.view),
            rotations.as_entire_binding(),
            views.as_entire_binding(),
        ]);
        if variant.uniform.is_some() {
            resources.push(disc.as_entire_binding());
        }
        let kernel = scatterer.kernel(self.gpu, Place::Texels, variant, report)?;
        let timing = timer.and_then(|timer| timer.time_compute("scattered_radiosity"));
        kernel.run(self.gpu, encoder, &resources, Invocations::Planned(&maps.dispatches, 0), timing);
        Ok(())
    }

    fn gather(
        &self,
        scatterer: &mut Scatterer,
        maps: &CameraMaps,
        to: Destination,
        layers: &wgpu::Buffer,
        encoder: &mut wgpu::CommandEncoder,
        report: &mut Report,
    ) -> Result<(), GpuError> {
        let gathering =
            GatheringUniform { first: to.layer as u32 * self.points.count, keep: to.keep, gain: to.gain };
        let gathering = uniform_buffer(self.gpu, "gathering", &gathering);
        let resources = [
            maps.uniform.as_entire_binding(),
            maps.cameras.as_entire_binding(),
            wgpu::BindingResource::TextureView(&maps.gbuffer.view),
            self.points.mesh.vertices.as_entire_binding(),
            maps.best.as_entire_binding(),
            wgpu::BindingResource::TextureView(&maps.radiosity.view),
            gathering.as_entire_binding(),
            layers.as_entire_binding(),
        ];
        let kernel = scatterer.kernel(self.gpu, Place::Gather, Variant::default(), report)?;
        kernel.run(self.gpu, encoder, &resources, Invocations::Count(self.points.count), None);
        Ok(())
    }

    fn estimator(&self, view: &LightView, to: Destination) -> EstimatorUniform {
        let view = &view.view;
        let light_from_mesh = view.view_from_body * self.body.body_from_mesh;
        let largest = self.of_scattering(self.medium.sigma_t_prime).fold(1e-30, f32::max);
        let Sampling { samples, candidates, radius, .. } = self.sampling;
        EstimatorUniform {
            light_from_mesh: DMat4::from(light_from_mesh).as_mat4(),
            light_from_mesh_normal: normal_matrix(light_from_mesh).as_mat4(),
            low: view.low.truncate().as_vec2(),
            inverse_texel: Vec2::splat(view.texels_per_length() as f32),
            samples,
            pass_index: to.set,
            candidates,
            points: self.points.count,
            first: to.layer as u32 * self.points.count,
            core: (CORE / largest).clamp(1e-9, 1.0),
            least_mu: self.least_mu(),
            radius,
            keep: to.keep,
            gain: to.gain,
        }
    }

    /// The least effective transport coefficient of the three channels, per radius of the body.
    fn least_mu(&self) -> f32 {
        self.of_scattering(self.medium.mu * self.medium.sigma_t_prime).fold(f32::INFINITY, f32::min).min(1e30)
    }

    /// The values of the channels that scatter at all; the others send nothing out, whatever their discs are.
    fn of_scattering(&self, values: Vec3) -> impl Iterator<Item = f32> {
        let strength = self.medium.strength;
        (0..3).filter(move |channel| strength[*channel] > 0.0).map(move |channel| values[channel])
    }

    /// The points of the published disc, with the area that each stands for; none for the adaptive strategy.
    fn disc(&self, estimator: &EstimatorUniform, set: u32) -> Vec<Vec4> {
        if self.sampling.strategy == MapStrategy::Adaptive {
            return Vec::new();
        }
        let sigma = f64::from(estimator.least_mu);
        // Beyond that there is nothing to see, nor to find.
        let radius = f64::from(estimator.radius).min(14.0 / sigma.max(1e-20));
        let disc = ExponentialDisc { sigma, radius };
        let count = estimator.candidates as usize;
        // Later sets go on where the sequence stopped.
        let points = disc.points(count * (set as usize + 1));
        let area = |density: f64| 1.0 / (density * count as f64);
        points[count * set as usize..]
            .iter()
            .map(|point| point.position.extend(area(point.density)).extend(0.0).as_vec4())
            .collect()
    }
}
