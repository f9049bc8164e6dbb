//! What a directional light reaches of a mesh that scatters, seen from the light.
//!
//! Reads vertices; writes, for each such mesh and light, a [`LightView`], rgba32float: the normal in the light's space (all 0 where no
//! light arrives) and the height towards the light. Its orthographic view is fitted to the mesh, and other meshes stand in its way.
//! Reruns when the light's direction, the mesh, its placement or what stands between the two changes; a driver without memory fails it.

use super::body::Body;
use super::upload::MeshBuffers;
use crate::components::{DirectionalLight, Motion, Placement};
use crate::gpu::{Draw, DrawDescriptor, Gpu, GpuError, PassTimer, Target, binding, uniform_each};
use crate::loading::{LoadedMesh, placed_corners};
use crate::render::Failure;
use crate::view::{lights_in_order, normal_matrix};
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use encase::ShaderSize;
use glam::{DAffine3, DMat3, DMat4, DVec3, Mat4, UVec2, Vec3};

/// The G-buffers of a mesh, one for each light, in the order of the lights.
#[derive(Component, Debug, Default)]
pub(crate) struct LightViews(pub Vec<LightView>);

/// One light's view of a mesh.
#[derive(Debug)]
pub(crate) struct LightView {
    /// The light.
    pub light: Entity,
    /// Normal and height, see `light_gbuffer.wgsl`.
    pub target: Target,
    /// Where the view is.
    pub frame: LightFrame,
    /// What it was made from.
    recipe: Recipe,
    /// Counts up whenever the texels change.
    pub version: u64,
}

/// Where a light's view of a body is: x and y across the light, z towards it, lengths in radii of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightFrame {
    /// Takes body space to the light's view.
    pub light_from_body: DAffine3,
    /// Corners of what is seen of the body.
    pub low: DVec3,
    /// The other corner.
    pub high: DVec3,
    /// Texels of the view.
    pub size: UVec2,
}

impl LightFrame {
    /// Texels per unit of length.
    pub fn texels_per_length(&self) -> f64 {
        f64::from(self.size.x) / (self.high.x - self.low.x)
    }
}

/// Everything that the texels depend on.
#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    frame: LightFrame,
    mesh: (MeshBuffers, Placement),
    blockers: Vec<(MeshBuffers, Placement)>,
}

mirror! {
    /// Mirror of `LightMesh` in `shaders/light_gbuffer.wgsl`.
    "light_gbuffer":
    pub(crate) struct LightMeshUniform as "LightMesh" {
        light_from_mesh: Mat4,
        light_from_mesh_normal: Mat4,
        centre: Vec3,
        is_lit: f32,
        inverse_half: Vec3,
    }
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct LightGbuffer {
    draw: Option<Draw>,
    version: u64,
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Texels along the longer side of a view.
const TEXELS: u32 = 512;

/// Bytes of all views of a mesh together, at most; with many lights each gets fewer texels.
const BUDGET: u64 = 256 << 20;

type Seen<'a> = (&'a MeshBuffers, &'a Placement, &'a LoadedMesh);
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
    gpu: Res<Gpu>,
    mut bodies: Bodies,
    meshes: Query<(Entity, Seen)>,
    lights: Query<(Entity, &DirectionalLight, Option<&Motion>)>,
    former: Query<Entity, (With<LightViews>, Without<Body>)>,
    mut state: ResMut<LightGbuffer>,
    mut timer: Option<ResMut<PassTimer>>,
    (mut report, mut failure): (ResMut<Report>, ResMut<Failure>),
) {
    for entity in &former {
        commands.entity(entity).remove::<LightViews>();
    }
    let lights = lights_in_order(&lights);
    let mut held = 0;
    for (entity, body, buffers, placement, mesh, mut views) in &mut bodies {
        let mut own = LightViews::default();
        let kept = views.as_mut().map_or(&mut own, |views| views.bypass_change_detection());
        let mut old = std::mem::take(&mut kept.0);
        for (light, to_light) in &lights {
            let mut frame = frame(body, mesh, placement, *to_light, lights.len());
            let blockers = blockers(&mut frame, body, entity, &meshes);
            let recipe = Recipe { frame: frame.0, mesh: (buffers.clone(), *placement), blockers };
            let index = old.iter().position(|view| view.light == *light);
            let view = index.map(|index| old.swap_remove(index));
            if let Some(view) = view.filter(|view| view.recipe == recipe) {
                held += view.target.bytes();
                kept.0.push(view);
                continue;
            }
            let timing = timer.as_mut().and_then(|timer| timer.time("light_gbuffer"));
            match draw(&gpu, &mut state, body, &recipe, frame.1, timing, &mut report) {
                Ok(target) => {
                    state.version += 1;
                    held += target.bytes();
                    let (light, frame, version) = (*light, recipe.frame, state.version);
                    kept.0.push(LightView { light, target, frame, recipe, version });
                }
                Err(error) => failure.keep(Err(error)),
            }
        }
        if views.is_none() {
            commands.entity(entity).insert(own);
        }
    }
    report.hold("light_gbuffer", held);
}

/// The view of a light that shows all of a mesh and nothing beside it, and how far up things may stand in its light.
fn frame(
    body: &Body,
    mesh: &LoadedMesh,
    placement: &Placement,
    to_light: DVec3,
    lights: usize,
) -> (LightFrame, f64) {
    let (x, y) = to_light.any_orthonormal_pair();
    let light_from_body = DAffine3::from_mat3(DMat3::from_cols(x, y, to_light).transpose());
    let light_from_mesh = light_from_body * body.body_from_mesh;
    let corner = |far: f64| (DVec3::splat(far), DVec3::splat(-far));
    let extend = |(low, high): (DVec3, DVec3), point: DVec3| (low.min(point), high.max(point));
    let (low, high) = match &mesh.data {
        Some(data) => data
            .positions
            .iter()
            .map(|position| light_from_mesh.transform_point3(position.as_dvec3()))
            .fold(corner(f64::INFINITY), extend),
        None => placed_corners(placement, mesh.bounds)
            .map(|corner| light_from_body.transform_point3(body.body_from_scene.transform_point3(corner)))
            .fold(corner(f64::INFINITY), extend),
    };
    let affordable = (BUDGET / 16 / lights.max(1) as u64).isqrt() as u32;
    let longer = TEXELS.min(affordable).max(16);
    // Half a texel to spare on each side, and no view without any width.
    let texel = ((high - low).truncate().max_element() / f64::from(longer - 1)).max(1e-6);
    let size = ((high - low).truncate() / texel).ceil().as_uvec2() + 1;
    let spare = (size.as_dvec2() * texel - (high - low).truncate()) / 2.0;
    let (low, high) = (low - spare.extend(1e-3), high + spare.extend(1e-3));
    (LightFrame { light_from_body, low, high, size }, high.z)
}

/// The other meshes that stand between the light and the body, and how far up they reach.
fn blockers(
    (frame, top): &mut (LightFrame, f64),
    body: &Body,
    own: Entity,
    meshes: &Query<(Entity, Seen)>,
) -> Vec<(MeshBuffers, Placement)> {
    let light_from_scene = frame.light_from_body * body.body_from_scene;
    let mut found: Vec<(Entity, (MeshBuffers, Placement))> = Vec::new();
    for (entity, (buffers, placement, mesh)) in meshes.iter().filter(|(entity, _)| *entity != own) {
        let far = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = placed_corners(placement, mesh.bounds)
            .map(|corner| light_from_scene.transform_point3(corner))
            .fold(far, |(low, high), corner| (low.min(corner), high.max(corner)));
        let is_beside =
            low.x > frame.high.x || high.x < frame.low.x || low.y > frame.high.y || high.y < frame.low.y;
        if !is_beside && high.z > frame.low.z {
            *top = top.max(high.z);
            found.push((entity, (buffers.clone(), *placement)));
        }
    }
    found.sort_by_key(|(entity, _)| *entity);
    found.into_iter().map(|(_, blocker)| blocker).collect()
}

fn draw(
    gpu: &Gpu,
    state: &mut LightGbuffer,
    body: &Body,
    recipe: &Recipe,
    top: f64,
    timing: Option<wgpu::RenderPassTimestampWrites>,
    report: &mut Report,
) -> Result<Target, GpuError> {
    if state.draw.is_none() {
        state.draw = Some(make(gpu)?);
        report.pipelines.push("light_gbuffer");
    }
    let frame = &recipe.frame;
    let target = Target::new(gpu, "light_gbuffer", frame.size, FORMAT)?;
    let depth = Target::new(gpu, "light_gbuffer depth", frame.size, wgpu::TextureFormat::Depth32Float)?;
    let drawn: Vec<_> = std::iter::once((&recipe.mesh, true))
        .chain(recipe.blockers.iter().map(|blocker| (blocker, false)))
        .collect();
    let uniforms: Vec<_> =
        drawn.iter().map(|((_, placement), lit)| uniform(body, frame, top, placement, *lit)).collect();
    let (buffer, stride) = uniform_each(gpu, "light meshes", &uniforms);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = target.begin(&mut encoder, "light_gbuffer", wgpu::Color::TRANSPARENT, &depth, timing);
    let mut triangles = 0;
    if let Some(draw) = &state.draw {
        let size = std::num::NonZeroU64::new(LightMeshUniform::SHADER_SIZE.get());
        let binding = wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: &buffer, offset: 0, size });
        let bind_group = draw.bind(gpu, &[binding]);
        for (index, ((mesh, _), _)) in drawn.iter().enumerate() {
            draw.begin(&mut pass, &bind_group, &[index as u32 * stride]);
            mesh.draw(&mut pass);
            triangles += u64::from(mesh.index_count / 3);
        }
    }
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    report.ran(
        "light_gbuffer",
        &[("texels", u64::from(frame.size.x) * u64::from(frame.size.y)), ("triangles", triangles)],
    );
    Ok(target)
}

fn make(gpu: &Gpu) -> Result<Draw, GpuError> {
    Draw::new(
        gpu,
        &DrawDescriptor {
            name: "light_gbuffer",
            generated: &[],
            entry_points: ("transform", "record"),
            bindings: &[binding::UNIFORM_EACH],
            vertex_buffers: &[&wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3]],
            format: FORMAT,
            depth: true,
        },
    )
}

fn uniform(
    body: &Body,
    frame: &LightFrame,
    top: f64,
    placement: &Placement,
    is_lit: bool,
) -> LightMeshUniform {
    let light_from_mesh = frame.light_from_body * body.body_from_scene * placement.0;
    let (low, high) = (frame.low, frame.high.truncate().extend(top));
    LightMeshUniform {
        light_from_mesh: DMat4::from(light_from_mesh).as_mat4(),
        light_from_mesh_normal: normal_matrix(light_from_mesh).as_mat4(),
        centre: ((low + high) / 2.0).as_vec3(),
        is_lit: f32::from(u8::from(is_lit)),
        inverse_half: (2.0 / (high - low)).as_vec3(),
    }
}
