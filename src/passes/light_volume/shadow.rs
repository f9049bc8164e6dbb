//! What meshes keep from a volume: a map of how high up the light meets one.

use crate::components::{Placement, SceneSettings};
use crate::gpu::{Gpu, GpuError, Target, texture_of, uniform_buffer};
use crate::loading::LoadedVolume;
use crate::mirrors::mirror;
use crate::passes::body::Body;
use crate::passes::gbuffer::{FORMAT, Fit, Gbuffer, OrthographicView, seen_box};
use crate::passes::light_gbuffer::{Blocker, Meshes, blockers};
use crate::report::Report;
use bevy_ecs::prelude::Entity;
use glam::{DAffine3, DMat4, DVec3, Mat4, UVec2, Vec4};

/// The meshes in the way of a light, and the view from which they are drawn. It is drawn anew whenever it is needed, and not kept.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shadow {
    body: Body,
    view: OrthographicView,
    blockers: Vec<Blocker>,
}

mirror! {
    /// Mirror of `Shadow` in `shaders/light_volume.wgsl`.
    "light_volume":
    pub(crate) struct ShadowUniform as "Shadow" {
        view_from_texture: Mat4,
    }
}

/// Texels of a shadow map for each voxel along the volume's longest side, and the most of them.
const TEXELS_PER_VOXEL: u32 = 4;
const MOST_TEXELS: u32 = 2048;

impl Shadow {
    /// The shadow of a light on a volume, if there is a mesh in the way.
    pub fn of(
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
        let texels = longest.saturating_mul(TEXELS_PER_VOXEL).clamp(256, MOST_TEXELS);
        let view = OrthographicView::around(view_from_body, seen, Fit::Longer(texels));
        (!blockers.is_empty()).then_some(Self { body, view, blockers })
    }
}

/// Draws the map, and says where it is. Without a shadow it is one empty texel.
pub(super) fn draw(
    gpu: &Gpu,
    gbuffer: &mut Gbuffer,
    shadow: Option<&Shadow>,
    texture_from_scene: DAffine3,
    report: &mut Report,
) -> Result<(wgpu::Buffer, wgpu::TextureView), GpuError> {
    let Some(Shadow { body, view, blockers }) = shadow else {
        let uniform = ShadowUniform { view_from_texture: Mat4::ZERO };
        let nothing = texture_of(gpu, "no shadow", UVec2::ONE, FORMAT, bytemuck::bytes_of(&Vec4::ZERO));
        return Ok((uniform_buffer(gpu, "shadow", &uniform), nothing.create_view(&Default::default())));
    };
    let target = Target::new(gpu, "shadow", view.size, FORMAT)?;
    let depth = Target::new(gpu, "shadow depth", view.size, wgpu::TextureFormat::Depth32Float)?;
    let top = blockers.iter().map(|blocker| blocker.top).fold(view.high.z, f64::max);
    let from_scene = |blocker: &Blocker| body.body_from_scene * blocker.placement.0;
    let seen: Vec<_> = blockers.iter().map(|blocker| (&blocker.mesh, from_scene(blocker), true)).collect();
    let triangles =
        gbuffer.draw(gpu, "volume shadow", view, top, &seen, (&target.view, &depth.view), None, report)?;
    let work = [("texels", u64::from(view.size.element_product())), ("triangles", triangles)];
    report.ran("volume_shadow", &work);
    let texels = view.texels_per_length();
    let texels_from_view = DAffine3::from_scale(DVec3::new(texels, texels, 1.0))
        * DAffine3::from_translation(-view.low.truncate().extend(0.0));
    let view_from_texture =
        texels_from_view * view.view_from_body * body.body_from_scene * texture_from_scene.inverse();
    let uniform = ShadowUniform { view_from_texture: DMat4::from(view_from_texture).as_mat4() };
    Ok((uniform_buffer(gpu, "shadow", &uniform), target.view))
}
