//! Radiance becomes what a screen shows.
//!
//! Reads the radiance of the last pass that drew; writes [`Tonemap::encoded`], rgba8unorm. Runs when an encoded picture is asked for.

use super::raycast::RayCaster;
use super::surface::Surface;
use crate::components::Auto;
use crate::failure::Failure;
use crate::gpu::{Draw, DrawDescriptor, Gpu, GpuError, PassTimer, Target, binding, uniform_buffer};
use crate::view::{CutOut, Picture, View, is_wanted};
use crate::{Stage, mirrors::mirror, report::Report};
use bevy_app::{App, Plugin, Update};
use bevy_ecs::prelude::*;

/// Encodes pictures.
pub(crate) struct TonemapPlugin;

impl Plugin for TonemapPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Tonemap>()
            .add_systems(Update, run.in_set(Stage::Tonemap).run_if(resource_exists::<Gpu>).run_if(is_wanted));
    }
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Tonemap {
    draw: Option<Draw>,
    /// The encoded picture.
    pub encoded: Option<Target>,
    /// How it is encoded.
    pub gamma: Auto<f32>,
}

mirror! {
    /// Mirror of `Display` in `shaders/tonemap.wgsl`.
    "tonemap":
    pub(crate) struct DisplayUniform as "Display" {
        gain: f32,
        exponent: f32,
        last: u32,
    }
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

fn run(
    (gpu, view, picture, cut_out): (Res<Gpu>, Res<View>, Res<Picture>, Res<CutOut>),
    (surface, caster): (Res<Surface>, Res<RayCaster>),
    mut tonemap: ResMut<Tonemap>,
    mut timer: Option<ResMut<PassTimer>>,
    (mut report, mut failure): (ResMut<Report>, ResMut<Failure>),
) {
    let Some(radiance) = caster.radiance().or(surface.colour()).filter(|_| picture.encoded) else { return };
    let last = match (cut_out.0, caster.radiance()) {
        (false, _) => 0,
        (true, Some(_)) => 1,
        (true, None) => 2,
    };
    let display = DisplayUniform {
        gain: view.exposure.exp2(),
        exponent: match view.gamma {
            Auto::Auto => 0.0,
            Auto::Value(gamma) => gamma.recip(),
        },
        last,
    };
    tonemap.gamma = view.gamma;
    let timing = timer.as_mut().and_then(|timer| timer.time("tonemap"));
    failure.keep(draw(&gpu, &display, &picture, radiance, &mut tonemap, timing, &mut report));
}

fn draw(
    gpu: &Gpu,
    display: &DisplayUniform,
    picture: &Picture,
    radiance: &Target,
    tonemap: &mut Tonemap,
    timing: Option<wgpu::RenderPassTimestampWrites>,
    report: &mut Report,
) -> Result<(), GpuError> {
    if tonemap.draw.is_none() {
        tonemap.draw = Some(Draw::new(
            gpu,
            &DrawDescriptor {
                name: "tonemap",
                generated: &[],
                entry_points: ("cover", "encode"),
                bindings: &[binding::UNIFORM, binding::TEXTURE],
                vertex_buffers: &[],
                instances: &[],
                format: FORMAT,
                depth: false,
            },
        )?);
        report.pipelines.push("tonemap");
    }
    if tonemap.encoded.as_ref().is_none_or(|target| target.texture.size() != radiance.texture.size()) {
        tonemap.encoded = None;
        let target = Target::new(gpu, "tonemap", picture.size, FORMAT)?;
        report.gpu_bytes.insert("tonemap", target.bytes());
        tonemap.encoded = Some(target);
    }
    let (Some(draw), Some(target)) = (&tonemap.draw, &tonemap.encoded) else { return Ok(()) };
    let display = uniform_buffer(gpu, "display", display);
    let resources = [display.as_entire_binding(), wgpu::BindingResource::TextureView(&radiance.view)];
    draw.cover(gpu, &resources, &target.view, timing);
    report.ran("tonemap", &[("pixels", u64::from(picture.size.x) * u64::from(picture.size.y))]);
    Ok(())
}
