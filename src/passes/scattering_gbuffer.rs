//! The scattering cameras around a mesh, what each sees, and which texels are worth evaluating.
//!
//! Reads vertices, points and [`ScatteringCamera`]s, and spawns those that a mesh's `ScatteringMaps` ask for; writes [`CameraMaps`]:
//! for each camera a layer of normals and heights, rgba32float, the list of texels that points want and that of the points that no
//! camera sees. Reruns when the mesh, its points, its cameras or the settings of its maps change; lights and media play no part.

mod cameras;
mod texels;

use super::body::Body;
use super::gbuffer::{Fit, Gbuffer, OrthographicView};
use super::surface_points::SurfacePoints;
use super::upload::MeshBuffers;
use crate::components::{Auto, MapResolution, MapStrategy, ScatteringCameras, ScatteringMaps};
use crate::failure::Failure;
use crate::gpu::{Gpu, GpuError, Layers, PassTimer};
use crate::loading::LoadedMesh;
use crate::report::Report;
use crate::scene::{Problem, Problems};
use crate::view::{Coarseness, Picture};
use bevy_ecs::prelude::*;
pub use cameras::AutomaticCamera;
pub(crate) use cameras::spawn_cameras;
use cameras::{Cameras, directions, turn};
use glam::{DVec3, UVec2};
use texels::choose;
pub(crate) use texels::{MapCameraUniform, MapsUniform, TexelChooser};

/// The maps of a mesh's scattering cameras.
#[derive(Component, Debug)]
pub(crate) struct CameraMaps {
    /// A layer a camera: normal in its view (all 0 where it sees nothing), height towards it.
    pub gbuffer: Layers,
    /// A layer a camera: the light that leaves each texel.
    pub radiosity: Layers,
    /// The cameras' views.
    pub views: Vec<OrthographicView>,
    pub uniform: wgpu::Buffer,
    pub cameras: wgpu::Buffer,
    /// Of each point the camera that sees it best.
    pub best: wgpu::Buffer,
    /// How many texels, and how many points that no camera sees.
    pub counts: wgpu::Buffer,
    pub texels: wgpu::Buffer,
    pub unseen: wgpu::Buffer,
    /// Workgroups for either.
    pub dispatches: wgpu::Buffer,
    /// What they were made from.
    pub recipe: Recipe,
}

/// Everything that the maps depend on, but the light that leaves them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Recipe {
    body: Body,
    mesh: MeshBuffers,
    points: MeshBuffers,
    count: u32,
    /// Towards the cameras, in body space: those written by hand, then the automatic ones.
    by_hand: Vec<DVec3>,
    automatic: Vec<DVec3>,
    size: UVec2,
    bias: Option<f32>,
    best_only: bool,
}

/// Bytes of all maps of a mesh together, at most.
const BUDGET: u64 = 1 << 30;

/// Bytes of a texel: G-buffer and radiosity.
const TEXEL: u64 = 32;

type Mapped<'a> = (
    Entity,
    &'a Body,
    &'a MeshBuffers,
    &'a SurfacePoints,
    &'a LoadedMesh,
    &'a ScatteringMaps,
    Option<&'a ScatteringCameras>,
    Option<&'a CameraMaps>,
);

/// Makes the maps that are missing or stale.
pub(crate) fn run(
    mut commands: Commands,
    (gpu, picture, coarseness): (Res<Gpu>, Res<Picture>, Res<Coarseness>),
    bodies: Query<Mapped>,
    (cameras, former): (Cameras, Query<Entity, (With<CameraMaps>, Without<ScatteringCameras>)>),
    (mut gbuffer, mut chooser): (ResMut<Gbuffer>, ResMut<TexelChooser>),
    (mut timer, mut report): (Option<ResMut<PassTimer>>, ResMut<Report>),
    (mut failure, mut problems): (ResMut<Failure>, ResMut<Problems>),
) {
    for entity in &former {
        commands.entity(entity).remove::<CameraMaps>();
    }
    let mut held = 0;
    for (entity, body, buffers, points, mesh, maps, own_cameras, made) in &bodies {
        if failure.stands_on(entity) {
            continue;
        }
        let Some(own_cameras) = own_cameras else { continue };
        let (by_hand, automatic) = directions(body, own_cameras, &cameras);
        if by_hand.is_empty() && automatic.is_empty() {
            continue;
        }
        let recipe = Recipe {
            body: body.without_unit(),
            mesh: buffers.clone(),
            points: points.mesh.clone(),
            count: points.count,
            by_hand,
            automatic,
            // A picture that is to follow a hand is smaller for a while; maps that are there will do.
            size: match made.filter(|_| coarseness.light < 1.0) {
                Some(made) => made.recipe.size,
                None => size(maps, points, &picture),
            },
            bias: match maps.bias {
                Auto::Auto => None,
                Auto::Value(bias) => Some(bias),
            },
            best_only: maps.strategy == MapStrategy::Adaptive,
        };
        if let Some(made) = made.filter(|made| made.recipe == recipe) {
            held += made.bytes();
            continue;
        }
        if let Some(problem) = too_many(&recipe, &gpu) {
            problems.0.push(problem.on(entity, "ScatteringMaps.resolution"));
            continue;
        }
        let timer = timer.as_deref_mut();
        let built = || build(&gpu, &mut gbuffer, &mut chooser, mesh, recipe, 0, timer, &mut report);
        match gpu.attempt("scattering_gbuffer", built) {
            Ok(maps) => {
                held += maps.bytes();
                commands.entity(entity).insert(maps);
            }
            Err(error) => failure.on(entity, "scattering_gbuffer", "ScatteringMaps", error),
        }
    }
    report.hold("scattering_gbuffer", held);
}

fn size(maps: &ScatteringMaps, points: &SurfacePoints, picture: &Picture) -> UVec2 {
    match (maps.resolution, maps.strategy) {
        (MapResolution::Texels(across, down), _) => UVec2::new(across, down),
        (MapResolution::Auto, MapStrategy::Uniform) => picture.size.min(UVec2::splat(4096)),
        // As fine as the points are.
        (MapResolution::Auto, MapStrategy::Adaptive) => {
            UVec2::splat((2.0 / points.spacing()).clamp(32.0, 1024.0) as u32)
        }
    }
}

fn too_many(recipe: &Recipe, gpu: &Gpu) -> Option<Problem> {
    let cameras = (recipe.by_hand.len() + recipe.automatic.len()) as u64;
    let most = u64::from(gpu.device.limits().max_texture_array_layers.min(256));
    let bytes = cameras * u64::from(recipe.size.element_product()) * TEXEL;
    let UVec2 { x, y } = recipe.size;
    if cameras > most {
        let message = format!("{cameras} scattering cameras look at this mesh; there can be {most}");
        return Some(Problem::error(message).help("leave some out"));
    }
    (bytes > BUDGET).then(|| {
        let message = format!(
            "{cameras} maps of {x} x {y} texels take {} MiB; the maps of a mesh may take {} MiB",
            bytes >> 20,
            BUDGET >> 20
        );
        Problem::error(message).help("use fewer `cameras`, or a smaller `resolution`")
    })
}

impl CameraMaps {
    pub fn bytes(&self) -> u64 {
        let buffers = [&self.best, &self.texels, &self.unseen];
        self.gbuffer.bytes() + self.radiosity.bytes() + buffers.map(wgpu::Buffer::size).iter().sum::<u64>()
    }
}

/// Draws what each camera sees and chooses the texels. Sets beyond the first have their automatic cameras elsewhere.
#[expect(clippy::too_many_arguments, reason = "what the pass reads and writes")]
pub(crate) fn build(
    gpu: &Gpu,
    gbuffer: &mut Gbuffer,
    chooser: &mut TexelChooser,
    mesh: &LoadedMesh,
    recipe: Recipe,
    set: u32,
    mut timer: Option<&mut PassTimer>,
    report: &mut Report,
) -> Result<CameraMaps, GpuError> {
    let turned = recipe.automatic.iter().map(|direction| turn(set) * *direction);
    let directions: Vec<DVec3> = recipe.by_hand.iter().copied().chain(turned).collect();
    let Recipe { body, size, .. } = &recipe;
    let layers = Layers::new(gpu, "scattering_gbuffer", *size, directions.len() as u32);
    let views: Vec<OrthographicView> = directions
        .iter()
        .map(|towards| OrthographicView::fitted(body, mesh, *towards, Fit::Whole(*size)))
        .collect();
    let mut triangles = 0;
    for (layer, view) in views.iter().enumerate() {
        let timing = timer.as_mut().and_then(|timer| timer.time("scattering_gbuffer"));
        let seen = [(&recipe.mesh, body.body_from_mesh, true)];
        let onto = layers.layer(layer as u32);
        triangles +=
            gbuffer.draw(gpu, "scattering_gbuffer", view, view.high.z, &seen, &onto, timing, report)?;
    }
    let texels = u64::from(size.element_product()) * views.len() as u64;
    report.ran("scattering_gbuffer", &[("texels", texels), ("triangles", triangles)]);
    choose(gpu, chooser, recipe, layers, views, timer, report)
}
