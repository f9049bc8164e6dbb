//! What volumes leave of the light that translucent meshes get.
//!
//! Reads a light G-buffer and the [`LightVolumes`](super::light_volume::LightVolumes) of its light; writes another in its stead, rgba32float, the normals of
//! which are as long as the share of light that arrives. Runs after the light G-buffer, where volumes stand in the light.

use super::gbuffer::{FORMAT, OrthographicView};
use super::light_volume::lookup;
use super::light_volume::through::{self, VeilCount, Veils};
use crate::gpu::{Draw, DrawDescriptor, Gpu, GpuError, PassTimer, Target, binding, uniform_buffer};
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::Resource;
use glam::{DAffine3, DMat4, DVec3, Mat4};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Dimmer {
    /// By what they are made for: one mesh may have more volumes in its light than another.
    draws: HashMap<VeilCount, Draw>,
}

mirror! {
    /// Mirror of `LightView` in `shaders/dimmed_gbuffer.wgsl`.
    "dimmed_gbuffer":
    pub(crate) struct LightViewUniform as "LightView" {
        view_from_texel: Mat4,
    }
}

/// Bindings of the shader in front of those of light volumes.
const FIXED_BINDINGS: usize = 2;

/// The light G-buffer with what volumes leave; itself where there are none.
#[expect(clippy::too_many_arguments, reason = "what one draw reads and writes")]
pub(crate) fn dim(
    gpu: &Gpu,
    dimmer: &mut Dimmer,
    target: Target,
    view: &OrthographicView,
    scene_from_view: DAffine3,
    veils: &Veils,
    timer: Option<&mut PassTimer>,
    report: &mut Report,
) -> Result<Target, GpuError> {
    let count = veils.count();
    if count.lights == 0 {
        return Ok(target);
    }
    let draw = match dimmer.draws.entry(count) {
        Entry::Occupied(made) => made.into_mut(),
        Entry::Vacant(place) => place.insert(make(gpu, count, report)?),
    };
    let dimmed = Target::new(gpu, "dimmed_gbuffer", view.size, FORMAT)?;
    let texel = view.texels_per_length().recip();
    let low = DVec3::new(view.low.x, view.low.y + texel * f64::from(view.size.y), 0.0);
    let view_from_texel =
        DAffine3::from_translation(low) * DAffine3::from_scale(DVec3::new(texel, -texel, 1.0));
    let uniform = LightViewUniform { view_from_texel: DMat4::from(view_from_texel).as_mat4() };
    let uniform = uniform_buffer(gpu, "light view", &uniform);
    let buffers = veils.buffers(gpu, scene_from_view);
    let mut resources = vec![uniform.as_entire_binding(), wgpu::BindingResource::TextureView(&target.view)];
    resources.extend(veils.resources(&buffers));
    draw.cover(gpu, &resources, &dimmed.view, timer.and_then(|timer| timer.time("dimmed_gbuffer")));
    report.ran("dimmed_gbuffer", &[("texels", u64::from(view.size.element_product()))]);
    Ok(dimmed)
}

fn make(gpu: &Gpu, count: VeilCount, report: &mut Report) -> Result<Draw, GpuError> {
    let filtering = lookup::filtering(gpu);
    let mut bindings = vec![binding::UNIFORM, binding::TEXTURE];
    bindings.extend(through::bindings(count, filtering));
    report.pipelines.push("dimmed_gbuffer");
    Draw::new(
        gpu,
        &DrawDescriptor {
            name: "dimmed_gbuffer",
            generated: &through::modules(count, filtering, FIXED_BINDINGS),
            entry_points: ("cover", "dim"),
            bindings: &bindings,
            vertex_buffers: &[],
            instances: &[],
            format: FORMAT,
            depth: false,
        },
    )
}
