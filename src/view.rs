//! The camera and the lights of a frame, as shaders want them.

mod asked;
mod covered;
mod framing;
mod unseen;

pub use asked::{Coarseness, Comparison, CutOut, Drawing, FreeCamera, Picture, Split, Viewpoint};
pub(crate) use asked::{Part, in_parts, is_wanted};
pub(crate) use covered::{Pixels, covered};

use crate::Stage;
use crate::components::{Auto, DirectionalLight, Motion, Placement, Projection, SceneSettings, ViewCamera};
use crate::gpu::{Gpu, uniform_array, uniform_buffer};
use crate::loading::{LoadedMesh, LoadedVolume, corners, placed_corners};
use crate::mirrors::mirror;
use crate::passes::classify::Classified;
use crate::scene::{Problem, Problems};
use bevy_app::{App, Plugin, Update};
use bevy_ecs::prelude::*;
use glam::dcamera::rh::view::look_at_affine3;
use glam::{DAffine3, DMat4, DVec3, Mat4, UVec2, Vec2, Vec3};

/// Derives the [`View`] and what shaders read of it.
pub(crate) struct ViewPlugin;

impl Plugin for ViewPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Picture>()
            .init_resource::<View>()
            .init_resource::<FreeCamera>()
            .init_resource::<SceneBounds>()
            .init_resource::<Coarseness>()
            .init_resource::<Comparison>()
            .init_resource::<CutOut>()
            .init_resource::<Drawing>()
            .add_systems(
                Update,
                (look, unseen::tell, upload_frame.run_if(resource_exists::<Gpu>)).chain().in_set(Stage::View),
            );
    }
}

/// Opposite corners of the box around everything that can be seen, derived in [`Stage::View`]; none where there is nothing.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct SceneBounds(pub Option<(DVec3, DVec3)>);

/// Where the picture is taken from, derived from the [`FreeCamera`], a [`ViewCamera`] or, without either, from what there is to see.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The same in the scene.
    pub viewpoint: Viewpoint,
    /// Takes the scene to eye space: the camera at the origin, looking along -z, y up, what it looks at one unit away. So whatever the
    /// scale of a scene is, shaders compute with numbers about 1.
    pub eye_from_scene: DAffine3,
    /// Projection.
    pub projection: Projection,
    /// Exposure value.
    pub exposure: f32,
    /// Encoding exponent, or the curve of sRGB.
    pub gamma: Auto<f32>,
    /// How far the camera is from what it looks at, scene units: the unit of eye space.
    pub reach: f64,
    /// How far away the farthest corner of anything is, in eye space.
    pub far: f64,
}

impl Default for View {
    fn default() -> Self {
        let camera = ViewCamera::default();
        Self::from_viewpoint(Viewpoint::of(&camera, DAffine3::IDENTITY), camera.exposure, camera.gamma)
    }
}

impl View {
    /// The view from a place.
    pub(crate) fn from_viewpoint(viewpoint: Viewpoint, exposure: f32, gamma: Auto<f32>) -> Self {
        let Viewpoint { eye, target, up, projection } = viewpoint;
        let reach = eye.distance(target);
        Self {
            viewpoint,
            eye_from_scene: DAffine3::from_scale(DVec3::splat(reach.recip()))
                * look_at_affine3(eye, target, up.normalize()),
            projection,
            exposure,
            gamma,
            reach,
            far: 1.0,
        }
    }

    /// Half of the picture across and up: tangents in perspective, units of eye space in an orthographic view.
    pub fn half_extent(&self, size: UVec2) -> Vec2 {
        let half_height = match self.projection {
            Projection::Perspective { vertical_fov } => (f64::from(vertical_fov).to_radians() / 2.0).tan(),
            Projection::Orthographic { height } => f64::from(height) / 2.0 / self.reach,
        };
        let aspect = f64::from(size.x) / f64::from(size.y);
        Vec2::new((half_height * aspect) as f32, half_height as f32)
    }

    /// Reversed depth: 1 at the near plane, 0 far away. In perspective far is infinite.
    fn clip_from_eye(&self, half_extent: Vec2) -> Mat4 {
        let (x, y) = (f64::from(half_extent.x).recip(), f64::from(half_extent.y).recip());
        let columns = match self.projection {
            Projection::Perspective { .. } => {
                let near = 1e-5;
                [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, 0.0, -1.0], [0.0, 0.0, near, 0.0]]
            }
            Projection::Orthographic { .. } => {
                let far = self.far * 1.01;
                [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, 1.0 / far, 0.0], [0.0, 0.0, 1.0, 1.0]]
            }
        };
        DMat4::from_cols_array_2d(&columns).as_mat4()
    }
}

mirror! {
    /// Mirror of `Frame` in `shaders/shared/frame.wgsl`.
    "surface":
    pub(crate) struct FrameUniform as "Frame" {
        clip_from_eye: Mat4,
        half_extent: Vec2,
        picture: Vec2,
        perspective: u32,
        light_count: u32,
        cut_out: u32,
    }
}

mirror! {
    /// Mirror of `Light` in `shaders/shared/frame.wgsl`.
    "surface":
    pub(crate) struct LightUniform as "Light" {
        to_light: Vec3,
        irradiance: Vec3,
    }
}

/// The frame's camera and lights on the GPU.
#[derive(Resource, Debug)]
pub(crate) struct FrameBuffers {
    pub frame: wgpu::Buffer,
    pub lights: wgpu::Buffer,
    /// How many lights fit; shaders are made for it.
    pub light_capacity: usize,
    /// How many there are.
    pub light_count: u32,
}

/// The most lights in a scene: as many as fit in a uniform buffer everywhere.
const MAX_LIGHTS: usize = 1024;

/// The WGSL module `lights`.
pub(crate) fn lights_module(capacity: usize) -> (&'static str, String) {
    ("lights", format!("const LIGHT_CAPACITY = {capacity}u;\n"))
}

type Boxes<'w, 's> = (
    Query<'w, 's, (&'static Placement, &'static LoadedMesh)>,
    Query<'w, 's, (&'static Placement, &'static LoadedVolume, Option<&'static Classified>)>,
);

fn look(
    cameras: Query<(Option<&Name>, &ViewCamera, &Placement)>,
    boxes: Boxes,
    settings: Res<SceneSettings>,
    picture: Res<Picture>,
    free: Res<FreeCamera>,
    (mut view, mut bounds): (ResMut<View>, ResMut<SceneBounds>),
) {
    let all = scene_corners(&boxes, &settings);
    bounds.set_if_neq(SceneBounds(box_around(&all)));
    let wanted =
        |name: Option<&Name>| picture.camera.is_none() || picture.camera.as_deref() == name.map(Name::as_str);
    let found = cameras
        .iter()
        .filter(|(name, ..)| wanted(*name))
        .min_by_key(|(name, ..)| name.map(|name| name.as_str().to_owned()));
    let points = || framing_points(&boxes, &settings);
    let (camera, placement) = match found {
        Some((_, camera, placement)) => (camera, placement.0),
        None => (&camera_on_all(bounds.0, picture.size), DAffine3::IDENTITY),
    };
    let framed = || {
        let framing = camera.frame.as_ref()?;
        framing::framed(camera, framing, &points(), picture.size)
    };
    let viewpoint = free.0.or_else(framed).unwrap_or_else(|| Viewpoint::of(camera, placement));
    let mut new = View::from_viewpoint(viewpoint, camera.exposure, camera.gamma);
    let depths = all.iter().map(|corner| -new.eye_from_scene.transform_point3(*corner).z);
    new.far = depths.fold(1.0, f64::max);
    view.set_if_neq(new);
}

/// The corners of everything that can be seen.
fn scene_corners((meshes, volumes): &Boxes, settings: &SceneSettings) -> Vec<DVec3> {
    let meshes = meshes.iter().flat_map(|(placement, mesh)| placed_corners(placement, mesh.bounds));
    let volumes = volumes.iter().flat_map(|(placement, volume, _)| {
        let half = volume.half_extent() / settings.millimetres_per_unit;
        placed_corners(placement, (-half, half))
    });
    meshes.chain(volumes).collect()
}

/// Points around what is really seen: vertices of meshes that stand out, and what can be noticed of volumes.
fn framing_points((meshes, volumes): &Boxes, settings: &SceneSettings) -> Vec<DVec3> {
    let meshes = meshes.iter().flat_map(|(placement, mesh)| {
        mesh.extremes.iter().map(|point| placement.0.transform_point3(point.as_dvec3()))
    });
    let volumes = volumes.iter().flat_map(|(placement, volume, classified)| {
        let half = volume.half_extent() / settings.millimetres_per_unit;
        let voxel = volume.data.spacing / settings.millimetres_per_unit;
        let own: Vec<Vec3> = match classified.map(|classified| classified.extent.as_slice()) {
            Some(extent) if !extent.is_empty() => extent.iter().map(|point| *point * voxel - half).collect(),
            _ => corners((-half, half)).map(|corner| corner.as_vec3()).collect(),
        };
        own.into_iter().map(|point| placement.0.transform_point3(point.as_dvec3()))
    });
    meshes.chain(volumes).collect()
}

/// Opposite corners of the box around an entity, if it can be seen.
pub(crate) fn bounds_of(world: &World, entity: Entity) -> Option<(DVec3, DVec3)> {
    let placement = world.get::<Placement>(entity)?;
    let own = match (world.get::<LoadedMesh>(entity), world.get::<LoadedVolume>(entity)) {
        (Some(mesh), _) => mesh.bounds,
        (None, Some(volume)) => {
            let half = volume.half_extent() / world.resource::<SceneSettings>().millimetres_per_unit;
            (-half, half)
        }
        (None, None) => return None,
    };
    box_around(&placed_corners(placement, own).collect::<Vec<_>>())
}

fn box_around(corners: &[DVec3]) -> Option<(DVec3, DVec3)> {
    let first = *corners.first()?;
    Some(corners.iter().fold((first, first), |(low, high), corner| (low.min(*corner), high.max(*corner))))
}

/// A camera in front of everything, a little above it, with all of it in the picture.
fn camera_on_all(bounds: Option<(DVec3, DVec3)>, size: UVec2) -> ViewCamera {
    let (low, high) = bounds.unwrap_or_default();
    let centre = (low + high) / 2.0;
    let radius = (high - low).length() / 2.0;
    let radius = if radius > 0.0 { radius } else { 1.0 };
    let Projection::Perspective { vertical_fov } = Projection::default() else {
        return ViewCamera::default();
    };
    let half_vertical = f64::from(vertical_fov).to_radians() / 2.0;
    let aspect = f64::from(size.x) / f64::from(size.y);
    let half = half_vertical.min((half_vertical.tan() * aspect).atan());
    let eye = centre + DVec3::new(0.35, 0.3, 1.0).normalize() * (radius / half.sin());
    ViewCamera { eye: eye.as_vec3(), target: centre.as_vec3(), ..Default::default() }
}

fn upload_frame(
    mut commands: Commands,
    gpu: Res<Gpu>,
    view: Res<View>,
    (picture, cut_out): (Res<Picture>, Res<CutOut>),
    lights: Query<(Entity, &DirectionalLight, Option<&Motion>)>,
    mut problems: ResMut<Problems>,
) {
    let half_extent = view.half_extent(picture.size);
    let light_uniforms: Vec<LightUniform> = lights_in_order(&lights)
        .into_iter()
        .filter_map(|(entity, to_light)| Some(light_uniform(&view, lights.get(entity).ok()?.1, to_light)))
        .collect();
    if let Some((entity, ..)) = lights.iter().nth(MAX_LIGHTS) {
        let message = format!("a scene has at most {MAX_LIGHTS} lights, found {}", lights.iter().count());
        problems.0.push(Problem::error(message).on(entity, "DirectionalLight"));
    }
    let light_capacity = light_uniforms.len().next_power_of_two().max(4);
    let frame = FrameUniform {
        clip_from_eye: view.clip_from_eye(half_extent),
        half_extent,
        picture: picture.size.as_vec2(),
        perspective: u32::from(matches!(view.projection, Projection::Perspective { .. })),
        light_count: light_uniforms.len() as u32,
        cut_out: u32::from(cut_out.0),
    };
    commands.insert_resource(FrameBuffers {
        frame: uniform_buffer(&gpu, "frame", &frame),
        lights: uniform_array(&gpu, "lights", &light_uniforms, light_capacity),
        light_capacity,
        light_count: light_uniforms.len() as u32,
    });
}

fn light_uniform(view: &View, light: &DirectionalLight, to_light: DVec3) -> LightUniform {
    let to_light = view.eye_from_scene.transform_vector3(to_light).normalize();
    LightUniform { to_light: to_light.as_vec3(), irradiance: light.irradiance }
}

/// The lights by entity, with the directions to them in the scene.
pub(crate) fn lights_in_order(
    lights: &Query<(Entity, &DirectionalLight, Option<&Motion>)>,
) -> Vec<(Entity, DVec3)> {
    let mut all: Vec<_> =
        lights.iter().map(|(entity, light, motion)| (entity, to_light(light, motion))).collect();
    all.sort_by_key(|(entity, _)| *entity);
    all.truncate(MAX_LIGHTS);
    all
}

/// The direction to a light in the scene, of unit length.
fn to_light(light: &DirectionalLight, motion: Option<&Motion>) -> DVec3 {
    let motion = motion.map_or(DAffine3::IDENTITY, |motion| motion.0);
    -motion.transform_vector3(light.direction.as_dvec3()).normalize()
}

/// A mesh or volume in eye space, and the matrix for its normals.
pub(crate) fn to_eye(view: &View, scene_from_entity: DAffine3) -> (DAffine3, DMat4) {
    let eye_from_entity = view.eye_from_scene * scene_from_entity;
    (eye_from_entity, normal_matrix(eye_from_entity))
}

/// The matrix that takes normals where `affine` takes positions. Its numbers are about 1, so that large and small scales alike stay
/// within 32 bits; what it gives is not of unit length.
pub(crate) fn normal_matrix(affine: DAffine3) -> DMat4 {
    let normals = affine.matrix3.inverse().transpose();
    let largest = normals.to_cols_array().into_iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    DMat4::from_mat3(normals * if largest > 0.0 { largest.recip() } else { 1.0 })
}

/// What is seen where nothing is: the scene's background, and nothing at all in pictures that leave it out.
pub(crate) fn background(settings: &SceneSettings, cut_out: &CutOut) -> Vec3 {
    if cut_out.0 { Vec3::ZERO } else { settings.background }
}

/// Distance along a ray that meets nothing: `FAR` of `shaders/shared/frame.wgsl`.
pub(crate) const FAR: f32 = 3.0e38;
