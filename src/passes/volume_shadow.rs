//! What meshes keep from volumes: for each volume that scatters and each light, how high up the light meets a mesh.
//!
//! Reads vertices; writes [`VolumeShadows`], rgba32float as `gbuffer.wgsl` does, where a mesh is in the way. Reruns when the light's
//! direction, the volume's placement, or a mesh in the way changes; nothing of the volume's medium does that. A driver without memory fails it.

use super::body::Body;
use super::gbuffer::{FORMAT, Fit, Gbuffer, OrthographicView, seen_box};
use super::light_gbuffer::{Blocker, Meshes, blockers};
use super::light_volume::{lighting_in_force, scene_from_texture};
use crate::components::{DirectionalLight, Motion, Placement, SceneSettings, Shading, VolumeLighting};
use crate::failure::Failure;
use crate::gpu::{Gpu, GpuError, PassTimer, Target, binding, uniform_array};
use crate::loading::LoadedVolume;
use crate::report::Report;
use crate::view::lights_in_order;
use bevy_ecs::prelude::*;
use glam::{DAffine3, DMat4, DVec3, Mat4};
use std::fmt::Write;

/// The shadows on a volume, of the lights in which a mesh is in the way.
#[derive(Component, Debug, Default)]
pub(crate) struct VolumeShadows(pub Vec<VolumeShadow>);

/// What meshes keep from a volume in one light.
#[derive(Debug)]
pub(crate) struct VolumeShadow {
    light: Entity,
    target: Target,
    recipe: Recipe,
    /// Counts up whenever the texels change.
    pub version: u64,
}

/// Everything that the texels depend on.
#[derive(Clone, Debug, PartialEq)]
struct Recipe {
    body: Body,
    view: OrthographicView,
    blockers: Vec<Blocker>,
    /// From the texture of the volume to texels, counted from the top left, and height towards the light.
    texels_from_texture: DAffine3,
}

/// How many shadows there have been.
#[derive(Resource, Default, Debug)]
pub(crate) struct VolumeShadowVersion(u64);

/// Texels of a shadow for each voxel along the volume's longest side, and the fewest and most of them along the shadow's longer side.
const TEXELS_PER_VOXEL: u32 = 4;
const FEWEST_TEXELS: u32 = 256;
const MOST_TEXELS: u32 = 1024;

impl VolumeShadows {
    /// The shadow of a light.
    pub fn of(&self, light: Entity) -> Option<&VolumeShadow> {
        self.0.iter().find(|shadow| shadow.light == light)
    }
}

type Volumes<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static LoadedVolume,
        &'static Placement,
        (&'static VolumeLighting, Option<&'static Shading>),
        Option<&'static mut VolumeShadows>,
    ),
>;

pub(crate) fn run(
    mut commands: Commands,
    (gpu, settings): (Res<Gpu>, Res<SceneSettings>),
    (mut volumes, meshes): (Volumes, Meshes),
    former: Query<Entity, (With<VolumeShadows>, Or<(Without<LoadedVolume>, Without<VolumeLighting>)>)>,
    lights: Query<(Entity, &DirectionalLight, Option<&Motion>)>,
    (mut gbuffer, mut version): (ResMut<Gbuffer>, ResMut<VolumeShadowVersion>),
    (mut timer, mut report, mut failure): (Option<ResMut<PassTimer>>, ResMut<Report>, ResMut<Failure>),
) {
    for entity in &former {
        commands.entity(entity).remove::<VolumeShadows>();
    }
    let mut held = 0;
    for (entity, loaded, placement, (lighting, shading), mut kept) in &mut volumes {
        if failure.stands_on(entity) {
            continue;
        }
        if lighting_in_force(lighting, shading, &settings).light_resolution().is_none() {
            commands.entity(entity).remove::<VolumeShadows>();
            continue;
        }
        let mut own = VolumeShadows::default();
        let all = kept.as_mut().map_or(&mut own, |kept| kept.bypass_change_detection());
        let mut old = std::mem::take(&mut all.0);
        for (light, to_light) in lights_in_order(&lights) {
            let recipe = Recipe::of(loaded, placement, &settings, to_light, entity, &meshes);
            let Some(recipe) = recipe.filter(|_| settings.meshes_shade_volumes) else { continue };
            let found = old.iter().position(|shadow| shadow.light == light);
            let found = found.map(|index| old.swap_remove(index));
            let former = match found {
                Some(found) if found.recipe == recipe => {
                    held += found.target.bytes();
                    all.0.push(found);
                    continue;
                }
                other => other.map(|found| found.target),
            };
            let timing = timer.as_mut().and_then(|timer| timer.time("volume_shadow"));
            match gpu
                .attempt("volume_shadow", || draw(&gpu, &mut gbuffer, &recipe, former, timing, &mut report))
            {
                Ok(target) => {
                    version.0 += 1;
                    held += target.bytes();
                    all.0.push(VolumeShadow { light, target, recipe, version: version.0 });
                }
                Err(error) => failure.on(entity, "volume_shadow", "Volume", error),
            }
        }
        if kept.is_none() && !own.0.is_empty() {
            commands.entity(entity).insert(own);
        }
    }
    report.hold("volume_shadow", held);
}

impl Recipe {
    /// The shadow of a light on a volume, if there is a mesh in the way.
    fn of(
        loaded: &LoadedVolume,
        placement: &Placement,
        settings: &SceneSettings,
        to_light: DVec3,
        own: Entity,
        meshes: &Meshes,
    ) -> Option<Self> {
        let half = loaded.half_extent() / settings.millimetres_per_unit;
        let body = Body::of((-half, half), placement, settings.millimetres_per_unit);
        let view_from_body = OrthographicView::rotation(to_light);
        let seen = seen_box(view_from_body, &body, placement, (-half, half));
        let blockers = blockers(&body, to_light, seen, own, meshes);
        let longest = loaded.data.size.into_iter().max().unwrap_or(1);
        let texels = longest.saturating_mul(TEXELS_PER_VOXEL).clamp(FEWEST_TEXELS, MOST_TEXELS);
        let view = OrthographicView::around(view_from_body, seen, Fit::Longer(texels));
        let texels = view.texels_per_length();
        let corner = view.low.truncate().extend(0.0) + DVec3::Y * (f64::from(view.size.y) / texels);
        let texels_from_view =
            DAffine3::from_scale(DVec3::new(texels, -texels, 1.0)) * DAffine3::from_translation(-corner);
        let texels_from_texture = texels_from_view
            * view.view_from_body
            * body.body_from_scene
            * scene_from_texture(loaded, placement, settings);
        (!blockers.is_empty()).then_some(Self { body, view, blockers, texels_from_texture })
    }
}

fn draw(
    gpu: &Gpu,
    gbuffer: &mut Gbuffer,
    recipe: &Recipe,
    former: Option<Target>,
    timing: Option<wgpu::RenderPassTimestampWrites>,
    report: &mut Report,
) -> Result<Target, GpuError> {
    let Recipe { body, view, blockers, .. } = recipe;
    let target = Target::again(former, gpu, "volume_shadow", view.size, FORMAT)?;
    let top = blockers.iter().map(|blocker| blocker.top).fold(view.high.z, f64::max);
    let from_scene = |blocker: &Blocker| body.body_from_scene * blocker.placement.0;
    let seen: Vec<_> = blockers.iter().map(|blocker| (&blocker.mesh, from_scene(blocker), true)).collect();
    let triangles = gbuffer.draw(gpu, "volume_shadow", view, top, &seen, &target.view, timing, report)?;
    let work = [("texels", u64::from(view.size.element_product())), ("triangles", triangles)];
    report.ran("volume_shadow", &work);
    Ok(target)
}

/// The module `shadows` for light volumes of which some are shadowed: `light_seen(index, place)` is the share of a place's surroundings
/// that meshes leave in the light. Its bindings, from `first` on: where the shadows are, and one texture each; none at all for none.
pub(crate) fn module(shadowed: &[bool], first: usize) -> (&'static str, String) {
    let count = shadowed.iter().filter(|shadowed| **shadowed).count();
    let (mut text, mut cases) = (String::new(), String::new());
    if count > 0 {
        text = format!(
            "#import shadow\n@group(0) @binding({first}) var<uniform> shadow_from_texture: array<mat4x4f, {count}>;\n"
        );
    }
    for (own, index) in (0..shadowed.len()).filter(|index| shadowed[*index]).enumerate() {
        // Writing to a String cannot fail.
        let _ =
            writeln!(text, "@group(0) @binding({}) var shadow_{index}: texture_2d<f32>;", first + 1 + own);
        let at = format!("(shadow_from_texture[{own}] * vec4f(place, 1.0)).xyz");
        let corner = |corner| {
            format!(
                "textureLoad(shadow_{index}, shadow_texel(at, {corner}, textureDimensions(shadow_{index})), 0)"
            )
        };
        let [a, b, c, d] = [0, 1, 2, 3].map(corner);
        let _ = writeln!(
            cases,
            "        case {index}u: {{\n            let at = {at};\n            return shadow_share(at, {a}, {b}, {c}, {d});\n        }}"
        );
    }
    let _ = write!(
        text,
        "fn light_seen(index: u32, place: vec3f) -> f32 {{\n    switch index {{\n{cases}        default: {{ return 1.0; }}\n    }}\n}}\n"
    );
    ("shadows", text)
}

/// What is bound for that module.
pub(crate) fn bindings(shadowed: &[bool]) -> Vec<wgpu::BindingType> {
    let count = shadowed.iter().filter(|shadowed| **shadowed).count();
    match count {
        0 => Vec::new(),
        _ => std::iter::once(binding::UNIFORM).chain((0..count).map(|_| binding::TEXTURE)).collect(),
    }
}

/// Where shadows are, in the order in which they are bound.
pub(crate) fn places(gpu: &Gpu, shadows: &[&VolumeShadow]) -> wgpu::Buffer {
    let matrices: Vec<Mat4> =
        shadows.iter().map(|shadow| DMat4::from(shadow.recipe.texels_from_texture).as_mat4()).collect();
    uniform_array(gpu, "shadows", &matrices, matrices.len().max(1))
}

/// The resources of those bindings.
pub(crate) fn resources<'a>(
    shadows: &[&'a VolumeShadow],
    places: &'a wgpu::Buffer,
) -> Vec<wgpu::BindingResource<'a>> {
    if shadows.is_empty() {
        return Vec::new();
    }
    let textures = shadows.iter().map(|shadow| wgpu::BindingResource::TextureView(&shadow.target.view));
    std::iter::once(places.as_entire_binding()).chain(textures).collect()
}
