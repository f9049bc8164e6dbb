//! The light that leaves each point of a translucent mesh, of each light.
//!
//! Reads the points ([`SurfacePoints`]), the [`LightViews`], the medium and, where maps are asked for, the [`CameraMaps`]; writes
//! [`ScatteredRadiosity`], one vec4f a point and light. Reruns for the lights whose view changed, and for all lights where the medium,
//! the points or the maps changed; while nothing does, further sets of samples are averaged in as [`Refinement`] says.

mod job;
mod kernels;

use super::body::Body;
use super::gbuffer::Gbuffer;
use super::light_budget::LightBudget;
use super::light_gbuffer::{LightView, LightViews};
use super::medium::{Dipole, LEAST_DISTANCE, MediumUniform};
use super::scattering_gbuffer::{self, CameraMaps, TexelChooser};
use super::surface_points::SurfacePoints;
use super::upload::MeshBuffers;
use crate::components::{DipoleModel, DirectionalLight, ScatteringMaps, Subsurface};
use crate::failure::Failure;
use crate::gpu::{Gpu, GpuError, PassTimer, storage};
use crate::loading::LoadedMesh;
use crate::optics::medium::Medium;
use crate::report::Report;
use crate::view::Coarseness;
use bevy_ecs::prelude::*;
use glam::Vec3;
use job::{Destination, Job, Sampling};
pub(crate) use job::{EstimatorUniform, GatheringUniform};
pub(crate) use kernels::{Scatterer, listing_module, sampling_module};

/// What leaves each point, by light.
#[derive(Component, Debug)]
pub(crate) struct ScatteredRadiosity {
    /// One vec4f a point, one layer of them after the other.
    pub layers: wgpu::Buffer,
    /// Bytes of a layer.
    layer: u64,
    /// What each layer was made from, and of how many sets of samples it is the mean.
    made: Vec<Option<(Recipe, u32)>>,
    /// The model, and what it was made from.
    dipole: ([Medium; 3], DipoleModel, Dipole),
    /// Whether all lights share one layer, in which their irradiance is already.
    pub is_shared: bool,
    /// Counts up whenever the layers change.
    pub version: u64,
}

/// Everything that a layer depends on.
#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    view: u64,
    points: MeshBuffers,
    sampling: Sampling,
    cameras: Option<scattering_gbuffer::Recipe>,
    medium: MediumUniform,
    /// Of the light, where all lights share a layer.
    irradiance: Option<Vec3>,
}

/// Samples of a point while the picture is to follow a hand, at least.
const FEWEST_SAMPLES: u32 = 16;

/// How far the light that leaves translucent meshes is refined while nothing changes: each further set of samples, with cameras elsewhere,
/// is averaged with those before. Meshes with `progressive: false` have one set.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refinement {
    /// Sets of samples that are wanted.
    pub sets: u32,
    /// Sets that an update may add.
    pub per_update: u32,
}

impl Default for Refinement {
    fn default() -> Self {
        Self { sets: 1, per_update: 1 }
    }
}

type Bodies<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static Body,
        &'static Subsurface,
        &'static ScatteringMaps,
        (&'static SurfacePoints, &'static LoadedMesh),
        &'static LightViews,
        Option<&'static CameraMaps>,
        Option<&'static mut ScatteredRadiosity>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    (gpu, refinement, coarseness, budget): (Res<Gpu>, Res<Refinement>, Res<Coarseness>, Res<LightBudget>),
    lights: Query<&DirectionalLight>,
    mut bodies: Bodies,
    mut tools: (ResMut<Scatterer>, ResMut<Gbuffer>, ResMut<TexelChooser>),
    mut timer: Option<ResMut<PassTimer>>,
    (mut report, mut failure): (ResMut<Report>, ResMut<Failure>),
) {
    let irradiance = |light: Entity| lights.get(light).map_or(Vec3::ZERO, |light| light.irradiance);
    let (mut held, mut sharing) = (0, 0);
    for (entity, body, subsurface, maps, (points, mesh), views, cameras, mut radiosity) in &mut bodies {
        if failure.stands_on(entity) {
            continue;
        }
        let layer = 16 * u64::from(points.count);
        let is_shared = layer * views.0.len() as u64 > budget.mesh;
        sharing = sharing.max(if is_shared { views.0.len() } else { 0 });
        let size = if is_shared { layer } else { layer * views.0.len().max(1) as u64 };
        held += size;
        let mut new = None;
        let kept = match radiosity.as_deref_mut() {
            Some(kept) if kept.layer == layer && kept.is_shared == is_shared => kept,
            _ => match ScatteredRadiosity::new(&gpu, layer, size, is_shared, subsurface) {
                Some(radiosity) => new.insert(radiosity),
                None => continue,
            },
        };
        if !is_shared {
            kept.arrange(&gpu, size, views);
        }
        kept.keep_dipole(subsurface);
        let medium = kept.dipole.2.uniform(LEAST_DISTANCE, body.millimetres);
        let in_full = Sampling::of(maps, body);
        let job = Job {
            gpu: &gpu,
            body,
            sampling: Sampling::of(&coarser(maps, coarseness.light), body),
            is_progressive: maps.progressive,
            points,
            mesh,
            medium: &medium,
            model: subsurface.model,
        };
        let asked = (*refinement, &irradiance as &dyn Fn(Entity) -> Vec3);
        let timer = timer.as_deref_mut();
        let refined = || kept.refine(&job, in_full, views, cameras, asked, &mut tools, timer, &mut report);
        if let Err(error) = gpu.attempt("scattered_radiosity", refined) {
            failure.on(entity, "scattered_radiosity", "Subsurface", error);
        }
        if let Some(new) = new {
            commands.entity(entity).insert(new);
        }
    }
    report.hold("scattered_radiosity", held);
    report.share("scattered_radiosity", sharing);
}

/// Of how many sets of samples the mesh that has fewest is the mean, and how many are wanted; none where no mesh is to be refined.
pub(crate) fn refined(world: &mut World, wanted: u32) -> Option<(u32, u32)> {
    let mut bodies = world.query_filtered::<(&ScatteringMaps, Option<&ScatteredRadiosity>), With<Body>>();
    let progressive = bodies.iter(world).filter(|(maps, _)| maps.progressive);
    let sets_of = |made: &Option<(Recipe, u32)>| made.as_ref().map_or(0, |(_, sets)| *sets);
    let sets = |radiosity: &ScatteredRadiosity| radiosity.made.iter().map(sets_of).min();
    let fewest = progressive.filter_map(|(_, radiosity)| radiosity.map_or(Some(0), sets)).min()?;
    Some((fewest.min(wanted), wanted))
}

/// The same maps with fewer samples: a share of `light` squared, but no fewer than a picture takes that nobody takes for another.
fn coarser(maps: &ScatteringMaps, light: f32) -> ScatteringMaps {
    let samples = (maps.samples as f32 * light * light) as u32;
    ScatteringMaps { samples: samples.max(FEWEST_SAMPLES).min(maps.samples), ..maps.clone() }
}

impl ScatteredRadiosity {
    fn new(gpu: &Gpu, layer: u64, size: u64, is_shared: bool, subsurface: &Subsurface) -> Option<Self> {
        let dipole = (subsurface.coefficients()?, subsurface.model, Dipole::new(subsurface)?);
        Some(Self {
            layers: storage(gpu, "scattered_radiosity", size),
            layer,
            made: Vec::new(),
            dipole,
            is_shared,
            version: 0,
        })
    }

    /// Brings the layers into the order of the lights where some have come or gone. What the others send out stays.
    fn arrange(&mut self, gpu: &Gpu, size: u64, views: &LightViews) {
        let is_of = |made: &Option<(Recipe, u32)>, view: &LightView| {
            made.as_ref().is_some_and(|(recipe, _)| recipe.view == view.version)
        };
        let formers: Vec<Option<usize>> =
            views.0.iter().map(|view| self.made.iter().position(|made| is_of(made, view))).collect();
        let mut places = formers.iter().enumerate();
        if self.layers.size() == size
            && places.all(|(layer, former)| former.is_none_or(|former| former == layer))
        {
            self.made.resize(views.0.len(), None);
            return;
        }
        let layers = storage(gpu, "scattered_radiosity", size);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for (layer, former) in formers.iter().enumerate() {
            if let Some(former) = former {
                let [from, to] = [*former, layer].map(|layer| self.layer * layer as u64);
                encoder.copy_buffer_to_buffer(&self.layers, from, &layers, to, self.layer);
            }
        }
        gpu.queue.submit([encoder.finish()]);
        self.made = formers.into_iter().map(|former| self.made[former?].take()).collect();
        self.layers = layers;
    }

    /// Derives the model anew if what it is made from has changed.
    fn keep_dipole(&mut self, subsurface: &Subsurface) {
        let (media, model, _) = &self.dipole;
        if let Some(now) = subsurface.coefficients()
            && (*media, *model) != (now, subsurface.model)
            && let Some(dipole) = Dipole::new(subsurface)
        {
            self.dipole = (now, subsurface.model, dipole);
        }
    }

    /// Brings every layer up to date, and adds sets of samples where more are wanted.
    #[expect(clippy::too_many_arguments, reason = "what the pass reads and writes")]
    fn refine(
        &mut self,
        job: &Job,
        in_full: Sampling,
        views: &LightViews,
        cameras: Option<&CameraMaps>,
        (refinement, irradiance): (Refinement, &dyn Fn(Entity) -> Vec3),
        tools: &mut (ResMut<Scatterer>, ResMut<Gbuffer>, ResMut<TexelChooser>),
        mut timer: Option<&mut PassTimer>,
        report: &mut Report,
    ) -> Result<(), GpuError> {
        if self.is_shared && self.made.len() != views.0.len() {
            // What a light that is gone sent out cannot be taken back.
            self.made.clear();
        }
        self.made.resize(views.0.len(), None);
        let wanted = if job.is_progressive { refinement.sets.max(1) } else { 1 };
        let self_shared = self.is_shared;
        let recipe = |layer: usize, sampling: Sampling| Recipe {
            view: views.0[layer].version,
            points: job.points.mesh.clone(),
            sampling,
            cameras: cameras.map(|maps| maps.recipe.clone()),
            medium: job.medium.clone(),
            irradiance: self_shared.then(|| irradiance(views.0[layer].light)),
        };
        // One that no longer averages shows its first set again.
        let is_current = |made: &(Recipe, u32), layer| {
            [in_full, job.sampling].iter().any(|sampling| made.0 == recipe(layer, *sampling))
                && (job.is_progressive || made.1 == 1)
        };
        for _ in 0..refinement.per_update.max(1) {
            // Layers start again with what they are made from, so they can be at different sets; lights that share one start together.
            let sets_of = |(layer, made): (usize, &Option<(Recipe, u32)>)| {
                made.as_ref().filter(|made| is_current(made, layer)).map_or(0, |made| made.1)
            };
            let mut sets: Vec<u32> = self.made.iter().enumerate().map(sets_of).collect();
            if self.is_shared && sets.contains(&0) {
                sets.fill(0);
            }
            let Some(set) = sets.iter().copied().min().filter(|set| *set < wanted) else { break };
            let turned = match cameras {
                Some(maps) if set > 0 => Some(scattering_gbuffer::build(
                    job.gpu,
                    &mut tools.1,
                    &mut tools.2,
                    job.mesh,
                    maps.recipe.clone(),
                    set,
                    timer.as_deref_mut(),
                    report,
                )?),
                _ => None,
            };
            let maps = turned.as_ref().or(cameras);
            for (layer, view) in views.0.iter().enumerate().filter(|(layer, _)| sets[*layer] == set) {
                let share = 1.0 / (set + 1) as f32;
                let to = match self.is_shared {
                    false => Destination { layer, set, keep: 1.0 - share, gain: Vec3::splat(share) },
                    // The first light of a set makes room for it.
                    true => Destination {
                        layer: 0,
                        set,
                        keep: if layer == 0 { 1.0 - share } else { 1.0 },
                        gain: share * irradiance(view.light),
                    },
                };
                job.run(&mut tools.0, view, maps, to, &self.layers, timer.as_deref_mut(), report)?;
                self.made[layer] = Some((recipe(layer, job.sampling), set + 1));
                self.version = tools.0.next_version();
            }
        }
        Ok(())
    }
}
