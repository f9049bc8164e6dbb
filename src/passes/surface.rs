//! Opaque meshes: the nearest surface of each pixel, lit locally.
//!
//! Reads vertices and instances; writes [`SurfaceTarget`], rgba32float, one texel a pixel: radiance and distance along the ray. Runs
//! each frame in which a mesh is there; a driver without memory for the target fails it.

use super::upload::MeshBuffers;
use crate::components::{Phong, Placement, SceneSettings};
use crate::gpu::{Draw, DrawDescriptor, Gpu, GpuError, PassTimer, Target, binding, uniform_each};
use crate::render::Failure;
use crate::view::{FrameBuffers, Picture, View, far_background, lights_module, to_eye};
use crate::{Stage, mirrors::mirror, report::Report};
use bevy_app::{App, Plugin, Update};
use bevy_ecs::prelude::*;
use encase::ShaderSize;
use glam::{Mat4, Vec3};

/// Draws opaque meshes.
pub(crate) struct SurfacePlugin;

impl Plugin for SurfacePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Surface>().add_plugins(super::upload::MeshUploadPlugin);
        app.add_systems(Update, run.in_set(Stage::Surface).run_if(resource_exists::<Gpu>));
    }
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Surface {
    /// The pipeline, and the number of lights it is made for.
    draw: Option<(usize, Draw)>,
    targets: Option<Targets>,
}

#[derive(Debug)]
struct Targets {
    colour: Target,
    depth: Target,
}

impl Surface {
    /// Radiance and distance of the nearest surface.
    pub fn colour(&self) -> Option<&Target> {
        self.targets.as_ref().map(|targets| &targets.colour)
    }
}

mirror! {
    /// Mirror of `MeshInstance` in `shaders/surface.wgsl`.
    "surface":
    pub(crate) struct MeshInstance as "MeshInstance" {
        eye_from_mesh: Mat4,
        eye_from_mesh_normal: Mat4,
        ambient: Vec3,
        shininess: f32,
        diffuse: Vec3,
        specular: Vec3,
    }
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

type Meshes<'w, 's> = Query<'w, 's, (&'static MeshBuffers, &'static Placement, Option<&'static Phong>)>;

fn run(
    (gpu, frame, view, picture, settings): (
        Res<Gpu>,
        Res<FrameBuffers>,
        Res<View>,
        Res<Picture>,
        Res<SceneSettings>,
    ),
    meshes: Meshes,
    volumes: Query<(), With<super::upload::VolumeTexture>>,
    mut surface: ResMut<Surface>,
    mut timer: Option<ResMut<PassTimer>>,
    (mut report, mut failure): (ResMut<Report>, ResMut<Failure>),
) {
    if meshes.is_empty() && !volumes.is_empty() {
        // The ray caster brings its own background.
        surface.targets = None;
        report.gpu_bytes.remove("surface");
        return;
    }
    let timing = timer.as_mut().and_then(|timer| timer.time("surface"));
    let drawn = draw(&gpu, &frame, &view, &picture, &settings, meshes, &mut surface, timing, &mut report);
    failure.keep(drawn);
}

#[expect(clippy::too_many_arguments, reason = "a system's parameters, passed on so that `?` can be used")]
fn draw(
    gpu: &Gpu,
    frame: &FrameBuffers,
    view: &View,
    picture: &Picture,
    settings: &SceneSettings,
    meshes: Meshes,
    surface: &mut Surface,
    timing: Option<wgpu::RenderPassTimestampWrites>,
    report: &mut Report,
) -> Result<(), GpuError> {
    resize(gpu, surface, picture, report)?;
    let instances: Vec<MeshInstance> =
        meshes.iter().map(|(_, placement, phong)| instance(view, placement, phong)).collect();
    let capacity = frame.light_capacity;
    if surface.draw.as_ref().is_none_or(|(made_for, _)| *made_for != capacity) && !instances.is_empty() {
        surface.draw = Some((capacity, make(gpu, capacity)?));
        report.pipelines.push("surface");
    }
    let Some(targets) = &surface.targets else { return Ok(()) };
    let (instance_buffer, stride) = uniform_each(gpu, "mesh instances", &instances);
    let background = far_background(settings);
    let mut encoder =
        gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("surface") });
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("surface"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &targets.colour.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(clear_colour(background)),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &targets.depth.view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: timing,
        ..Default::default()
    });
    let mut triangles = 0;
    if let Some((_, draw)) = surface.draw.as_ref().filter(|_| !instances.is_empty()) {
        let one = std::num::NonZeroU64::new(MeshInstance::SHADER_SIZE.get());
        let instance = wgpu::BufferBinding { buffer: &instance_buffer, offset: 0, size: one };
        let resources = [
            frame.frame.as_entire_binding(),
            frame.lights.as_entire_binding(),
            wgpu::BindingResource::Buffer(instance),
        ];
        let bind_group = draw.bind(gpu, &resources);
        for (index, (mesh, ..)) in meshes.iter().enumerate() {
            draw.begin(&mut pass, &bind_group, &[index as u32 * stride]);
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.index_count, 0, 0..1);
            triangles += u64::from(mesh.index_count / 3);
        }
    }
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    report.ran(
        "surface",
        &[("pixels", u64::from(picture.size.x) * u64::from(picture.size.y)), ("triangles", triangles)],
    );
    Ok(())
}

fn make(gpu: &Gpu, light_capacity: usize) -> Result<Draw, GpuError> {
    Draw::new(
        gpu,
        &DrawDescriptor {
            name: "surface",
            generated: &[lights_module(light_capacity)],
            entry_points: ("transform", "shade"),
            bindings: &[binding::UNIFORM, binding::UNIFORM, binding::UNIFORM_EACH],
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
            format: FORMAT,
            depth: true,
        },
    )
}

fn resize(gpu: &Gpu, surface: &mut Surface, picture: &Picture, report: &mut Report) -> Result<(), GpuError> {
    let size = wgpu::Extent3d { width: picture.size.x, height: picture.size.y, depth_or_array_layers: 1 };
    if surface.colour().is_none_or(|target| target.texture.size() != size) {
        surface.targets = None;
        let colour = Target::new(gpu, "surface", picture.size, FORMAT)?;
        let depth = Target::new(gpu, "surface depth", picture.size, wgpu::TextureFormat::Depth32Float)?;
        report.gpu_bytes.insert("surface", colour.bytes() + depth.bytes());
        surface.targets = Some(Targets { colour, depth });
    }
    Ok(())
}

fn instance(view: &View, placement: &Placement, phong: Option<&Phong>) -> MeshInstance {
    let (eye_from_mesh, normals) = to_eye(view, placement.0);
    let Phong { ambient, diffuse, specular, shininess } = phong.cloned().unwrap_or_default();
    MeshInstance {
        eye_from_mesh: glam::DMat4::from(eye_from_mesh).as_mat4(),
        eye_from_mesh_normal: normals.as_mat4(),
        ambient,
        shininess,
        diffuse,
        specular,
    }
}

fn clear_colour(texel: glam::Vec4) -> wgpu::Color {
    let [r, g, b, a] = texel.to_array().map(f64::from);
    wgpu::Color { r, g, b, a }
}
