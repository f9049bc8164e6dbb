//! What a directional light reaches of a mesh that scatters, seen from the light.
//!
//! Reads vertices; writes, for each such mesh and light, a [`LightView`], rgba32float: the normal in the light's space (all 0 where no
//! light arrives) and the height towards the light. Its orthographic view is fitted to the mesh, and other meshes stand in its way.
//! Reruns when the light's direction, the mesh, its placement or what stands between the two changes; a driver without memory fails it.

use super::body::Body;
use super::dimmed_gbuffer::{Dimmer, dim};
use super::gbuffer::{FORMAT, Fit, Gbuffer, OrthographicView, seen_box};
use super::light_volume::through::{Shading, Veils};
use super::upload::MeshBuffers;
use crate::components::{DirectionalLight, Motion, Placement, SceneSettings};
use crate::failure::Failure;
use crate::gpu::{Gpu, GpuError, PassTimer, Target};
use crate::loading::LoadedMesh;
use crate::report::Report;
use crate::view::{Coarseness, lights_in_order};
use bevy_ecs::prelude::*;
use glam::{DAffine3, DVec3};

/// The G-buffers of a mesh, one for each light, in the order of the lights.
#[derive(Component, Debug, Default)]
pub(crate) struct LightViews(pub Vec<LightView>);

/// One light's view of a mesh.
#[derive(Debug)]
pub(crate) struct LightView {
    /// The light.
    pub light: Entity,
    /// Normal and height, see `gbuffer.wgsl`.
    pub target: Target,
    /// Where the view is.
    pub view: OrthographicView,
    /// What it was made from.
    recipe: Recipe,
    /// Counts up whenever the texels change.
    pub version: u64,
}

/// Everything that the texels depend on.
#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    to_light: DVec3,
    texels: u32,
    body: Body,
    mesh: MeshBuffers,
    blockers: Vec<Blocker>,
    /// The volumes that the light comes through.
    veils: Vec<(DAffine3, u64)>,
}

/// A mesh that stands between the light and a body.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Blocker {
    pub mesh: MeshBuffers,
    pub placement: Placement,
    /// How far it reaches towards the light, in body space.
    pub top: f64,
}

/// How many views there have been.
#[derive(Resource, Default, Debug)]
pub(crate) struct LightViewVersion(u64);

/// Texels along the longer side of a light's view of a translucent mesh, at most; with very many lights it is fewer.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightTexels(pub u32);

impl Default for LightTexels {
    fn default() -> Self {
        Self(512)
    }
}

/// Bytes of all views of a mesh together, at most; with many lights each gets fewer texels.
const BUDGET: u64 = 256 << 20;

pub(crate) type Meshes<'w, 's> =
    Query<'w, 's, (Entity, &'static MeshBuffers, &'static Placement, &'static LoadedMesh)>;
type Bodies<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static Body,
        &'static MeshBuffers,
        &'static Placement,
        &'static LoadedMesh,
        Option<&'static mut LightViews>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    (gpu, settings, shading): (Res<Gpu>, Res<SceneSettings>, Shading),
    (wanted, coarseness): (Res<LightTexels>, Res<Coarseness>),
    (mut bodies, meshes): (Bodies, Meshes),
    lights: Query<(Entity, &DirectionalLight, Option<&Motion>)>,
    (mut gbuffer, mut dimmer, mut version): (ResMut<Gbuffer>, ResMut<Dimmer>, ResMut<LightViewVersion>),
    (mut timer, mut report, mut failure): (Option<ResMut<PassTimer>>, ResMut<Report>, ResMut<Failure>),
) {
    let lights = lights_in_order(&lights);
    let affordable = (BUDGET / 16 / lights.len().max(1) as u64).isqrt() as u32;
    let in_full = wanted.0.min(affordable).max(16);
    let coarse = ((in_full as f32 * coarseness.light) as u32).max(16);
    let mut held = 0;
    for (entity, body, buffers, placement, mesh, mut views) in &mut bodies {
        if failure.stands_on(entity) {
            continue;
        }
        let mut own = LightViews::default();
        let kept = views.as_mut().map_or(&mut own, |views| views.bypass_change_detection());
        let mut old = std::mem::take(&mut kept.0);
        for (light, to_light) in &lights {
            let light_from_body = OrthographicView::rotation(*to_light);
            let seen = seen_box(light_from_body, body, placement, mesh.bounds);
            let blockers = blockers(body, *to_light, seen, entity, &meshes);
            let veils = Veils::between(&shading, &settings, *light, |placement, bounds| {
                is_between(seen_box(light_from_body, body, placement, bounds), seen)
            });
            let mut recipe = Recipe {
                to_light: *to_light,
                texels: in_full,
                body: body.without_unit(),
                mesh: buffers.clone(),
                blockers,
                veils: veils.recipe(),
            };
            let index = old.iter().position(|view| view.light == *light);
            let view = index.map(|index| old.swap_remove(index));
            let is_full = view.as_ref().is_some_and(|view| view.recipe == recipe);
            recipe.texels = coarse;
            let former = match view {
                Some(view) if is_full || view.recipe == recipe => {
                    held += view.target.bytes();
                    kept.0.push(view);
                    continue;
                }
                other => other,
            };
            let former = former.map(|view| view.target);
            let drawn = || {
                let timing = timer.as_mut().and_then(|timer| timer.time("light_gbuffer"));
                let (view, target) = draw(&gpu, &mut gbuffer, mesh, &recipe, former, timing, &mut report)?;
                let scene_from_view = (view.view_from_body * body.body_from_scene).inverse();
                let timer = timer.as_deref_mut();
                dim(&gpu, &mut dimmer, target, &view, scene_from_view, &veils, timer, &mut report)
                    .map(|target| (view, target))
            };
            match gpu.attempt("light_gbuffer", drawn) {
                Ok((view, target)) => {
                    version.0 += 1;
                    held += target.bytes();
                    kept.0.push(LightView { light: *light, target, view, recipe, version: version.0 });
                }
                Err(error) => failure.on(entity, "light_gbuffer", "Subsurface", error),
            }
        }
        if views.is_none() {
            commands.entity(entity).insert(own);
        }
    }
    report.hold("light_gbuffer", held);
}

/// The meshes, `own` excepted, that stand between the light and what lies between two corners as the light sees it.
pub(crate) fn blockers(
    body: &Body,
    to_light: DVec3,
    seen: (DVec3, DVec3),
    own: Entity,
    meshes: &Meshes,
) -> Vec<Blocker> {
    let light_from_body = OrthographicView::rotation(to_light);
    let mut found: Vec<(Entity, Blocker)> = Vec::new();
    for (entity, buffers, placement, mesh) in meshes.iter().filter(|(entity, ..)| *entity != own) {
        let its = seen_box(light_from_body, body, placement, mesh.bounds);
        if is_between(its, seen) {
            let blocker = Blocker { mesh: buffers.clone(), placement: *placement, top: its.1.z };
            found.push((entity, blocker));
        }
    }
    found.sort_by_key(|(entity, _)| *entity);
    found.into_iter().map(|(_, blocker)| blocker).collect()
}

/// Whether one box may stand between the light, which is where z is greatest, and another.
fn is_between((its_low, its_high): (DVec3, DVec3), (low, high): (DVec3, DVec3)) -> bool {
    let is_beside =
        its_low.truncate().cmpgt(high.truncate()).any() || its_high.truncate().cmplt(low.truncate()).any();
    !is_beside && its_high.z > low.z
}

fn draw(
    gpu: &Gpu,
    gbuffer: &mut Gbuffer,
    mesh: &LoadedMesh,
    recipe: &Recipe,
    former: Option<Target>,
    timing: Option<wgpu::RenderPassTimestampWrites>,
    report: &mut Report,
) -> Result<(OrthographicView, Target), GpuError> {
    let Recipe { to_light, texels, body, mesh: buffers, blockers, .. } = recipe;
    let view = OrthographicView::fitted(body, mesh, *to_light, Fit::Longer(*texels));
    let target = Target::again(former, gpu, "light_gbuffer", view.size, FORMAT)?;
    let top = blockers.iter().map(|blocker| blocker.top).fold(view.high.z, f64::max);
    let mut seen = vec![(buffers, body.body_from_mesh, true)];
    let from_scene = |blocker: &Blocker| body.body_from_scene * blocker.placement.0;
    seen.extend(blockers.iter().map(|blocker| (&blocker.mesh, from_scene(blocker), false)));
    let triangles = gbuffer.draw(gpu, "light_gbuffer", &view, top, &seen, &target.view, timing, report)?;
    let work = [("texels", u64::from(view.size.element_product())), ("triangles", triangles)];
    report.ran("light_gbuffer", &work);
    Ok((view, target))
}
