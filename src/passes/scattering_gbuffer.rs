//! The scattering cameras around a mesh, what each sees, and which texels are worth evaluating.
//!
//! Reads vertices, points and [`ScatteringCamera`]s, and spawns those that a mesh's `ScatteringMaps` ask for; writes [`CameraMaps`]:
//! for each camera a layer of normals and heights, rgba32float, the list of texels that points want and that of the points that no
//! camera sees. Reruns when the mesh, its points, its cameras or the settings of its maps change; lights and media play no part.

use super::body::Body;
use super::gbuffer::{Fit, Gbuffer, OrthographicView};
use super::surface_points::SurfacePoints;
use super::upload::MeshBuffers;
use crate::components::{
    Auto, MapResolution, MapStrategy, ScatteringCamera, ScatteringCameraOf, ScatteringCameras, ScatteringMaps,
};
use crate::gpu::{
    Gpu, GpuError, Invocations, Kernel, KernelDescriptor, Layers, PassTimer, Target, binding, storage,
    storage_array, uniform_buffer,
};
use crate::loading::LoadedMesh;
use crate::optics::sampling::{halton, sphere_point};
use crate::render::Failure;
use crate::scene::{Problem, Problems};
use crate::view::{Picture, normal_matrix};
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use glam::{DMat4, DQuat, DVec3, Mat4, UVec2, Vec2};

/// A scattering camera that the program spread around a mesh, its child. Looks in a direction of the mesh's own space.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct AutomaticCamera {
    /// Unit vector.
    pub direction: DVec3,
}

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

mirror! {
    /// Mirror of `MapCamera` in `shaders/shared/maps.wgsl`.
    "gather":
    pub(crate) struct MapCameraUniform as "MapCamera" {
        view_from_mesh: Mat4,
        view_from_mesh_normal: Mat4,
        low: Vec2,
        inverse_texel: f32,
    }
}

mirror! {
    /// Mirror of `Maps` in `shaders/shared/maps.wgsl`.
    "gather":
    pub(crate) struct MapsUniform as "Maps" {
        cameras: u32,
        points: u32,
        bias: f32,
        best_only: u32,
    }
}

/// The kernels that choose texels.
#[derive(Resource, Default, Debug)]
pub(crate) struct TexelChooser {
    kernels: Option<[Kernel; 3]>,
}

/// Bytes of all maps of a mesh together, at most.
const BUDGET: u64 = 1 << 30;

/// Bytes of a texel: G-buffer and radiosity.
const TEXEL: u64 = 32;

type Spawning<'a> = (Entity, &'a ScatteringMaps, Option<&'a ScatteringCameras>, Option<&'a Children>);

/// Spawns the cameras that a mesh asks for: points of Halton's sequence on the sphere, looking at its middle.
pub(crate) fn spawn_cameras(
    mut commands: Commands,
    bodies: Query<Spawning, With<Body>>,
    former: Query<&Children, Without<Body>>,
    automatic: Query<(), With<AutomaticCamera>>,
) {
    for (mesh, maps, by_hand, children) in &bodies {
        let own: Vec<Entity> =
            children.into_iter().flatten().copied().filter(|child| automatic.contains(*child)).collect();
        let has_hand =
            by_hand.is_some_and(|cameras| cameras.iter().any(|camera| !automatic.contains(camera)));
        let wanted = if uses_maps(maps, has_hand) { maps.cameras } else { 0 };
        if own.len() == wanted as usize {
            continue;
        }
        own.into_iter().for_each(|camera| commands.entity(camera).despawn());
        for index in 1..=wanted {
            let point = halton(index);
            let direction = -sphere_point(point.x, point.y);
            commands.spawn((AutomaticCamera { direction }, ScatteringCameraOf(mesh), ChildOf(mesh)));
        }
    }
    for camera in former.iter().flatten().filter(|child| automatic.contains(**child)) {
        commands.entity(*camera).despawn();
    }
}

/// Whether the light that leaves a mesh is computed in maps, or at the points of its surface: those are fewer than the texels that maps
/// with the same detail have, so maps are made where they are asked for.
fn uses_maps(maps: &ScatteringMaps, has_cameras_by_hand: bool) -> bool {
    maps.strategy == MapStrategy::Uniform || maps.resolution != MapResolution::Auto || has_cameras_by_hand
}

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

type Cameras<'w, 's> =
    Query<'w, 's, (Entity, Option<&'static ScatteringCamera>, Option<&'static AutomaticCamera>)>;

/// Makes the maps that are missing or stale.
pub(crate) fn run(
    mut commands: Commands,
    (gpu, picture): (Res<Gpu>, Res<Picture>),
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
        let Some(own_cameras) = own_cameras else { continue };
        let (by_hand, automatic) = directions(body, own_cameras, &cameras);
        if by_hand.is_empty() && automatic.is_empty() {
            continue;
        }
        let recipe = Recipe {
            body: *body,
            mesh: buffers.clone(),
            points: points.mesh.clone(),
            count: points.count,
            by_hand,
            automatic,
            size: size(maps, points, &picture),
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
        let timing = timer.as_mut();
        match build(
            &gpu,
            &mut gbuffer,
            &mut chooser,
            mesh,
            recipe,
            0,
            timing.map(|timer| &mut **timer),
            &mut report,
        ) {
            Ok(maps) => {
                held += maps.bytes();
                commands.entity(entity).insert(maps);
            }
            Err(error) => failure.keep(Err(error)),
        }
    }
    report.hold("scattering_gbuffer", held);
}

/// Towards the cameras, in body space: those written by hand, and the automatic ones.
fn directions(body: &Body, own: &ScatteringCameras, cameras: &Cameras) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut entities: Vec<Entity> = own.iter().collect();
    entities.sort();
    let (mut by_hand, mut automatic) = (Vec::new(), Vec::new());
    for (_, written, spread) in entities.iter().filter_map(|entity| cameras.get(*entity).ok()) {
        if let Some(camera) = spread {
            automatic.push(-body.body_from_mesh.transform_vector3(camera.direction).normalize());
        } else if let Some(camera) = written {
            by_hand.push(-camera.direction.as_dvec3().normalize());
        }
    }
    (by_hand, automatic)
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

/// Turns the automatic cameras of a further set: by golden angles about an axis that turns too, so that no two sets agree.
fn turn(set: u32) -> DQuat {
    let point = halton(set);
    let axis = sphere_point(point.x, point.y);
    DQuat::from_axis_angle(axis, if set == 0 { 0.0 } else { 2.399_963_229_728_653 * f64::from(set) })
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
    let depth = Target::new(gpu, "scattering_gbuffer depth", *size, wgpu::TextureFormat::Depth32Float)?;
    let views: Vec<OrthographicView> = directions
        .iter()
        .map(|towards| OrthographicView::fitted(body, mesh, *towards, Fit::Whole(*size)))
        .collect();
    let mut triangles = 0;
    for (layer, view) in views.iter().enumerate() {
        let timing = timer.as_mut().and_then(|timer| timer.time("scattering_gbuffer"));
        let seen = [(&recipe.mesh, body.body_from_mesh, true)];
        let onto = (&layers.layer(layer as u32), &depth.view);
        triangles +=
            gbuffer.draw(gpu, "scattering_gbuffer", view, view.high.z, &seen, onto, timing, report)?;
    }
    let texels = u64::from(size.element_product()) * views.len() as u64;
    report.ran("scattering_gbuffer", &[("texels", texels), ("triangles", triangles)]);
    choose(gpu, chooser, recipe, layers, views, timer, report)
}

fn choose(
    gpu: &Gpu,
    chooser: &mut TexelChooser,
    recipe: Recipe,
    gbuffer: Layers,
    views: Vec<OrthographicView>,
    timer: Option<&mut PassTimer>,
    report: &mut Report,
) -> Result<CameraMaps, GpuError> {
    if chooser.kernels.is_none() {
        chooser.kernels = Some([kernel(gpu, "choose")?, kernel(gpu, "list")?, kernel(gpu, "plan")?]);
        report.pipelines.push("scattering_texels");
    }
    let Some([choose, list, plan]) = &chooser.kernels else { return Err(GpuError::Missing) };
    let texels = recipe.size.element_product() * views.len() as u32;
    let points = recipe.count;
    let uniform = MapsUniform {
        cameras: views.len() as u32,
        points,
        bias: recipe.bias.unwrap_or(-1.0),
        best_only: u32::from(recipe.best_only),
    };
    let cameras: Vec<_> = views.iter().map(|view| map_camera(&recipe.body, view)).collect();
    let wanted = storage(gpu, "wanted texels", u64::from(texels.div_ceil(32)) * 4);
    let radiosity = Layers::new(gpu, "scattered_texels", recipe.size, views.len() as u32);
    let maps = CameraMaps {
        uniform: uniform_buffer(gpu, "maps", &uniform),
        cameras: storage_array(gpu, "map cameras", &cameras),
        best: storage(gpu, "best cameras", u64::from(points) * 4),
        counts: storage(gpu, "counts", 16),
        texels: storage(gpu, "texels", u64::from(texels) * 4),
        unseen: storage(gpu, "unseen points", u64::from(points) * 4),
        dispatches: storage(gpu, "dispatches", 24),
        gbuffer,
        radiosity,
        views,
        recipe,
    };
    let resources = [
        maps.uniform.as_entire_binding(),
        maps.cameras.as_entire_binding(),
        wgpu::BindingResource::TextureView(&maps.gbuffer.view),
        maps.recipe.points.vertices.as_entire_binding(),
        maps.best.as_entire_binding(),
        wanted.as_entire_binding(),
        maps.counts.as_entire_binding(),
        maps.texels.as_entire_binding(),
        maps.unseen.as_entire_binding(),
        maps.dispatches.as_entire_binding(),
    ];
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let timing = timer.and_then(|timer| timer.time_compute("scattering_texels"));
    choose.run(gpu, &mut encoder, &resources, Invocations::Count(points), timing);
    list.run(gpu, &mut encoder, &resources, Invocations::Count(texels), None);
    plan.run(gpu, &mut encoder, &resources, Invocations::Count(1), None);
    gpu.queue.submit([encoder.finish()]);
    report.ran("scattering_texels", &[("points", u64::from(points)), ("texels", u64::from(texels))]);
    Ok(maps)
}

fn kernel(gpu: &Gpu, entry_point: &str) -> Result<Kernel, GpuError> {
    let mut bindings = vec![binding::UNIFORM, binding::STORAGE, binding::LAYERS, binding::STORAGE];
    bindings.extend([binding::STORAGE_OUT; 6]);
    Kernel::new(
        gpu,
        &KernelDescriptor { name: "scattering_texels", generated: &[], entry_point, bindings: &bindings },
    )
}

fn map_camera(body: &Body, view: &OrthographicView) -> MapCameraUniform {
    let view_from_mesh = view.view_from_body * body.body_from_mesh;
    MapCameraUniform {
        view_from_mesh: DMat4::from(view_from_mesh).as_mat4(),
        view_from_mesh_normal: normal_matrix(view_from_mesh).as_mat4(),
        low: view.low.truncate().as_vec2(),
        inverse_texel: view.texels_per_length() as f32,
    }
}
