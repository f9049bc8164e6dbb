//! Meshes: the nearest surface of each pixel; opaque ones lit locally, translucent ones by what leaves their points.
//!
//! Reads vertices, instances and [`Radiosity`]; writes [`SurfaceTarget`], rgba32float, one texel a pixel: radiance and distance along the ray. Runs
//! each frame in which a mesh is there; a driver without memory for the target fails it.

use super::body::Body;
use super::combine::Radiosity;
use super::light_volume::lookup;
use super::light_volume::through::{self, Shading, VeilCount, Veils};
use super::surface_points::SurfacePoints;
use super::upload::MeshBuffers;
use crate::components::{Phong, Placement, SceneSettings, Shading as ShadingKind, Subsurface};
use crate::failure::Failure;
use crate::gpu::{
    Draw, DrawDescriptor, Gpu, GpuError, PassTimer, Recent, Target, begin, binding, uniform_each,
};
use crate::view::{
    Comparison, CutOut, FAR, FrameBuffers, Part, Picture, View, background, in_parts, is_wanted,
    lights_module, to_eye,
};
use crate::{Stage, mirrors::mirror, report::Report};
use bevy_app::{App, Plugin, Update};
use bevy_ecs::prelude::*;
use encase::ShaderSize;
use glam::{Mat4, Vec3};
use std::ops::Range;

/// Draws meshes.
pub(crate) struct SurfacePlugin;

impl Plugin for SurfacePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Surface>().add_plugins(super::upload::MeshUploadPlugin);
        app.add_systems(Update, run.in_set(Stage::Surface).run_if(resource_exists::<Gpu>).run_if(is_wanted));
    }
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct Surface {
    /// The pipelines, by what they are made for.
    opaque: Recent<Variant, Draw>,
    translucent: Recent<Variant, Draw>,
    targets: Option<Targets>,
}

/// What a pipeline is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Variant {
    light_capacity: usize,
    veils: VeilCount,
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
        eta: f32,
    }
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Bindings of the shader in front of those of light volumes.
const FIXED_BINDINGS: usize = 3;

type Meshes<'w, 's> = Query<
    'w,
    's,
    (
        &'static MeshBuffers,
        &'static Placement,
        Option<&'static Phong>,
        Option<&'static Subsurface>,
        Option<(&'static Body, &'static SurfacePoints, &'static Radiosity)>,
    ),
>;

/// One mesh as it is drawn.
struct Drawn<'a> {
    mesh: &'a MeshBuffers,
    /// What leaves each vertex, of a translucent mesh.
    radiosity: Option<&'a wgpu::Buffer>,
    instance: MeshInstance,
    /// The columns of the picture in which it is drawn so.
    columns: Range<u32>,
}

fn run(
    (gpu, frame, view, picture, settings): (
        Res<Gpu>,
        Res<FrameBuffers>,
        Res<View>,
        Res<Picture>,
        Res<SceneSettings>,
    ),
    (comparison, cut_out): (Res<Comparison>, Res<CutOut>),
    meshes: Meshes,
    (volumes, shading): (Query<(), With<super::upload::VolumeTexture>>, Shading),
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
    let veils = Veils::all(&shading, &settings);
    let parts = in_parts(&comparison, picture.size);
    let drawn = draw(
        &gpu,
        &frame,
        &view,
        &picture,
        background(&settings, &cut_out),
        (meshes, &parts),
        &veils,
        &mut surface,
        timing,
        &mut report,
    );
    failure.keep(drawn);
}

#[expect(clippy::too_many_arguments, reason = "a system's parameters, passed on so that `?` can be used")]
fn draw(
    gpu: &Gpu,
    frame: &FrameBuffers,
    view: &View,
    picture: &Picture,
    background: Vec3,
    (meshes, parts): (Meshes, &[Part]),
    veils: &Veils,
    surface: &mut Surface,
    timing: Option<wgpu::RenderPassTimestampWrites>,
    report: &mut Report,
) -> Result<(), GpuError> {
    resize(gpu, surface, picture, report)?;
    let in_part = |part| meshes.iter().map(move |mesh| draw_of(view, mesh, part));
    let mut drawn: Vec<Drawn> = parts.iter().flat_map(in_part).collect();
    drawn.sort_by_key(|mesh| mesh.radiosity.is_some());
    let is_translucent = |mesh: &Drawn| mesh.radiosity.is_some();
    let variant = Variant { light_capacity: frame.light_capacity, veils: veils.count() };
    if drawn.iter().any(|mesh| !is_translucent(mesh)) {
        surface.opaque.get(variant, |variant| make(gpu, *variant, false, report))?;
    }
    if drawn.iter().any(is_translucent) {
        surface.translucent.get(variant, |variant| make(gpu, *variant, true, report))?;
    }
    let Some(targets) = &surface.targets else { return Ok(()) };
    let instances: Vec<MeshInstance> = drawn.iter().map(|mesh| mesh.instance.clone()).collect();
    let (instance_buffer, stride) = uniform_each(gpu, "mesh instances", &instances);
    let mut encoder =
        gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("surface") });
    let clear = clear_colour(background.extend(FAR));
    let mut pass = begin(&mut encoder, "surface", clear, &targets.colour.view, &targets.depth.view, timing);
    let one = std::num::NonZeroU64::new(MeshInstance::SHADER_SIZE.get());
    let instance = wgpu::BufferBinding { buffer: &instance_buffer, offset: 0, size: one };
    let veil_buffers = veils.buffers(gpu, view.eye_from_scene.inverse());
    let mut resources = vec![
        frame.frame.as_entire_binding(),
        frame.lights.as_entire_binding(),
        wgpu::BindingResource::Buffer(instance),
    ];
    resources.extend(veils.resources(&veil_buffers));
    let mut triangles = 0;
    for (pipeline, translucent) in [(&surface.opaque, false), (&surface.translucent, true)] {
        let mut own =
            drawn.iter().enumerate().filter(|(_, mesh)| is_translucent(mesh) == translucent).peekable();
        let (Some(draw), Some(_)) = (pipeline.last(), own.peek()) else { continue };
        let bind_group = draw.bind(gpu, &resources);
        for (index, mesh) in own {
            draw.begin(&mut pass, &bind_group, &[index as u32 * stride]);
            let columns = &mesh.columns;
            pass.set_scissor_rect(columns.start, 0, columns.end - columns.start, picture.size.y);
            if let Some(radiosity) = mesh.radiosity {
                pass.set_vertex_buffer(1, radiosity.slice(..));
            }
            mesh.mesh.draw(&mut pass);
            triangles += u64::from(mesh.mesh.index_count / 3);
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

/// Makes a pipeline.
fn make(gpu: &Gpu, variant: Variant, translucent: bool, report: &mut Report) -> Result<Draw, GpuError> {
    let vertices = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
    let radiosity = wgpu::vertex_attr_array![2 => Float32x4];
    let (entry_points, vertex_buffers): (_, &[&[wgpu::VertexAttribute]]) = match translucent {
        false => (("transform", "shade"), &[&vertices]),
        true => (("transform_translucent", "shade_translucent"), &[&vertices, &radiosity]),
    };
    let filtering = lookup::filtering(gpu);
    let [light_volumes, veils] = through::modules(variant.veils, filtering, FIXED_BINDINGS);
    let mut bindings = vec![binding::UNIFORM, binding::UNIFORM, binding::UNIFORM_EACH];
    bindings.extend(through::bindings(variant.veils, filtering));
    let descriptor = DrawDescriptor {
        name: "surface",
        generated: &[lights_module(variant.light_capacity), light_volumes, veils],
        entry_points,
        bindings: &bindings,
        vertex_buffers,
        format: FORMAT,
        depth: true,
    };
    report.pipelines.push("surface");
    Draw::new(gpu, &descriptor)
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

fn draw_of<'a>(
    view: &View,
    (mesh, placement, phong, subsurface, scattered): (
        &'a MeshBuffers,
        &Placement,
        Option<&Phong>,
        Option<&Subsurface>,
        Option<(&Body, &'a SurfacePoints, &'a Radiosity)>,
    ),
    part: &Part,
) -> Drawn<'a> {
    // The local model beside a scattering technique counts for more than a `Phong` of the entity.
    let phong = subsurface.map(|subsurface| &subsurface.local).or(phong).cloned().unwrap_or_default();
    let mut instance = instance(view, placement, &phong);
    let columns = part.columns.clone();
    let scattered = scattered.filter(|_| part.shading == ShadingKind::Scattering);
    let (Some((_, points, radiosity)), Some(subsurface)) = (scattered, subsurface) else {
        return Drawn { mesh, radiosity: None, instance, columns };
    };
    let specular = subsurface.specular.as_ref();
    instance.specular = Vec3::splat(specular.map_or(0.0, |specular| specular.strength));
    instance.shininess = specular.map_or(0.0, |specular| specular.shininess);
    instance.eta = subsurface.coefficients().map_or(1.0, |channels| channels[0].eta as f32);
    Drawn { mesh: &points.mesh, radiosity: Some(&radiosity.points), instance, columns }
}

fn instance(view: &View, placement: &Placement, phong: &Phong) -> MeshInstance {
    let (eye_from_mesh, normals) = to_eye(view, placement.0);
    let Phong { ambient, diffuse, specular, shininess } = phong.clone();
    MeshInstance {
        eye_from_mesh: glam::DMat4::from(eye_from_mesh).as_mat4(),
        eye_from_mesh_normal: normals.as_mat4(),
        ambient,
        shininess,
        diffuse,
        specular,
        eta: 1.0,
    }
}

fn clear_colour(texel: glam::Vec4) -> wgpu::Color {
    let [r, g, b, a] = texel.to_array().map(f64::from);
    wgpu::Color { r, g, b, a }
}
