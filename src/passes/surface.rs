//! Meshes: the nearest surface of each pixel; opaque ones lit locally, translucent ones by what leaves their points.
//!
//! Reads vertices, instances and [`Radiosity`]; writes [`SurfaceTarget`], rgba32float, one texel a pixel: radiance and distance along the ray. Runs
//! each frame in which a mesh is there; a driver without memory for the target fails it.

mod steps;

use super::appearance::{self, Appearance, Material};
use super::body::Body;
use super::combine::Radiosity;
use super::light_volume::lookup;
use super::light_volume::through::{self, Shading, VeilCount, Veils};
use super::surface_points::SurfacePoints;
use super::upload::MeshBuffers;
use crate::components::{Phong, Placement, SceneSettings, Shading as ShadingKind, Subsurface};
use crate::failure::Failure;
use crate::gpu::{
    Draw, DrawDescriptor, Gpu, GpuError, PassTimer, Recent, Target, binding, buffer_of, uniform_each,
};
use crate::view::{
    Comparison, CutOut, FAR, FrameBuffers, Part, Picture, View, background, in_parts, is_wanted,
    lights_module, to_eye,
};
use crate::{Stage, mirrors::mirror, report::Report};
use bevy_app::{App, Plugin, Update};
use bevy_ecs::prelude::*;
use encase::ShaderSize;
use glam::{DAffine3, Vec3};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;
use steps::Step;

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
    pipelines: Recent<Variant, Arc<Draw>>,
    targets: Option<Targets>,
}

/// What a pipeline is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Variant {
    light_capacity: usize,
    veils: VeilCount,
    kind: Kind,
}

/// What a mesh is drawn as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Kind {
    /// By the light that leaves it, and not that it reflects.
    is_translucent: bool,
    /// In the colours of its file.
    is_coloured: bool,
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
    /// Mirror of `MeshLook` in `shaders/surface.wgsl`.
    #[derive(PartialEq)]
    "surface":
    pub(crate) struct MeshLook as "MeshLook" {
        ambient: Vec3,
        shininess: f32,
        diffuse: Vec3,
        specular: Vec3,
        eta: f32,
    }
}

/// Where a mesh is, as `MeshPlace` in `shaders/surface.wgsl` has it: columns that take it to eye space, the last of which is its origin, and columns that
/// take its normals there.
type MeshPlace = [[f32; 3]; 7];

const PLACE: [wgpu::VertexAttribute; 7] = wgpu::vertex_attr_array![
    5 => Float32x3, 6 => Float32x3, 7 => Float32x3, 8 => Float32x3, 9 => Float32x3, 10 => Float32x3, 11 => Float32x3
];

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Bindings of the shader in front of those of pictures and of light volumes.
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

/// A mesh, or a part of one that looks alike, as it is drawn.
#[derive(Clone)]
struct Drawn<'a> {
    mesh: &'a MeshBuffers,
    indices: Range<u32>,
    /// Colours of the vertices and the picture, where the file has them.
    colours: Option<(&'a Appearance, &'a wgpu::TextureView)>,
    /// What leaves each vertex, of a translucent mesh.
    radiosity: Option<&'a wgpu::Buffer>,
    look: MeshLook,
    place: MeshPlace,
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
    let in_part = |part| meshes.iter().flat_map(move |mesh| draws_of(view, mesh, part));
    let mut drawn: Vec<Drawn> = parts.iter().flat_map(in_part).collect();
    let draws = one_draw_for_equal_ones(&mut drawn);
    let Surface { pipelines, targets } = surface;
    let Some(targets) = targets else { return Ok(()) };
    let looks: Vec<MeshLook> = draws.iter().map(|equal| equal[0].look.clone()).collect();
    let (look_buffer, stride) = uniform_each(gpu, "looks of meshes", &looks);
    let places: Vec<MeshPlace> = draws.iter().copied().flatten().map(|mesh| mesh.place).collect();
    let places =
        buffer_of(gpu, "places of meshes", bytemuck::cast_slice(&places), wgpu::BufferUsages::VERTEX);
    let one = std::num::NonZeroU64::new(MeshLook::SHADER_SIZE.get());
    let look = wgpu::BufferBinding { buffer: &look_buffer, offset: 0, size: one };
    let veil_buffers = veils.buffers(gpu, view.eye_from_scene.inverse());
    let mut resources = vec![
        frame.frame.as_entire_binding(),
        frame.lights.as_entire_binding(),
        wgpu::BindingResource::Buffer(look),
    ];
    resources.extend(veils.resources(&veil_buffers));
    let mut steps = Vec::new();
    let is_coloured = |equal: &&[Drawn]| equal[0].colours.is_some();
    let sampler = draws.iter().any(is_coloured).then(|| appearance::sampler(gpu));
    let (mut index, mut first) = (0, 0);
    for alike in draws.chunk_by(|a, b| a[0].kind() == b[0].kind()) {
        let kind = alike[0][0].kind();
        let variant = Variant { light_capacity: frame.light_capacity, veils: veils.count(), kind };
        let pipeline =
            Arc::clone(pipelines.get(variant, |variant| make(gpu, *variant, report).map(Arc::new))?);
        for same in alike.chunk_by(|a, b| a[0].picture() == b[0].picture()) {
            let mut resources = resources.clone();
            if let (Some(picture), Some(sampler)) = (same[0][0].picture(), &sampler) {
                let own =
                    [wgpu::BindingResource::TextureView(picture), wgpu::BindingResource::Sampler(sampler)];
                resources.splice(FIXED_BINDINGS..FIXED_BINDINGS, own);
            }
            let bind_group = pipeline.bind(gpu, &resources);
            for equal in same {
                steps.push(Step {
                    pipeline: Arc::clone(&pipeline),
                    bind_group: bind_group.clone(),
                    look: index * stride,
                    mesh: &equal[0],
                    indices: equal[0].indices.clone(),
                    instances: first..first + equal.len() as u32,
                });
                (index, first) = (index + 1, first + equal.len() as u32);
            }
        }
    }
    let clear = clear_colour(background.extend(FAR));
    let triangles = steps::submit(gpu, steps, targets, (clear, picture.size.y), &places, timing)?;
    report.ran(
        "surface",
        &[("pixels", u64::from(picture.size.x) * u64::from(picture.size.y)), ("triangles", triangles)],
    );
    Ok(())
}

/// Makes a pipeline.
fn make(gpu: &Gpu, variant: Variant, report: &mut Report) -> Result<Draw, GpuError> {
    let vertices = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
    let radiosity = wgpu::vertex_attr_array![2 => Float32x4];
    let colours = appearance::VERTEX;
    let (entry_points, vertex_buffers): (_, &[&[wgpu::VertexAttribute]]) = match variant.kind {
        Kind { is_translucent: false, is_coloured: false } => (("transform", "shade"), &[&vertices]),
        Kind { is_translucent: false, is_coloured: true } => {
            (("transform_coloured", "shade_coloured"), &[&vertices, &colours])
        }
        Kind { is_translucent: true, is_coloured: false } => {
            (("transform_translucent", "shade_translucent"), &[&vertices, &radiosity])
        }
        Kind { is_translucent: true, is_coloured: true } => (
            ("transform_coloured_translucent", "shade_coloured_translucent"),
            &[&vertices, &radiosity, &colours],
        ),
    };
    let filtering = lookup::filtering(gpu);
    let mut bindings = vec![binding::UNIFORM, binding::UNIFORM, binding::UNIFORM_EACH];
    let of_pictures = variant.kind.is_coloured.then_some(bindings.len());
    if variant.kind.is_coloured {
        bindings.extend(appearance::BINDINGS);
    }
    let [light_volumes, veils] = through::modules(variant.veils, filtering, bindings.len());
    bindings.extend(through::bindings(variant.veils, filtering));
    let descriptor = DrawDescriptor {
        name: "surface",
        generated: &[
            lights_module(variant.light_capacity),
            appearance::module(of_pictures),
            light_volumes,
            veils,
        ],
        entry_points,
        bindings: &bindings,
        vertex_buffers,
        instances: &PLACE,
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

impl<'a> Drawn<'a> {
    fn kind(&self) -> Kind {
        Kind { is_translucent: self.radiosity.is_some(), is_coloured: self.colours.is_some() }
    }

    fn picture(&self) -> Option<&'a wgpu::TextureView> {
        self.colours.map(|(_, picture)| picture)
    }

    /// Whether both can be drawn at once, but for where they are.
    fn equals(&self, other: &Self) -> bool {
        // What leaves a translucent mesh is its own.
        let is_opaque = self.radiosity.is_none() && other.radiosity.is_none();
        is_opaque
            && self.colours.is_some() == other.colours.is_some()
            && self.picture() == other.picture()
            && (&self.mesh.vertices, &self.indices, &self.columns)
                == (&other.mesh.vertices, &other.indices, &other.columns)
            && self.look == other.look
    }

    fn draw(&self, pass: &mut wgpu::RenderPass, height: u32, places: &wgpu::Buffer, step: &Step) {
        pass.set_scissor_rect(self.columns.start, 0, self.columns.len() as u32, height);
        let colours = self.colours.map(|(appearance, _)| &appearance.vertices);
        for (slot, buffer) in self.radiosity.into_iter().chain(colours).chain([places]).enumerate() {
            pass.set_vertex_buffer(slot as u32 + 1, buffer.slice(..));
        }
        self.mesh.draw_some(pass, step.indices.clone(), step.instances.clone());
    }

    /// One for each part of the mesh that looks alike.
    fn in_parts(self, with_material: impl Fn(&Material, &mut MeshLook)) -> Vec<Self> {
        let Some(appearance) = self.mesh.appearance.as_deref() else { return vec![self] };
        let of_part = |part: &'a appearance::Part| {
            let mut own = self.clone();
            own.indices = part.indices.clone();
            own.colours = Some((appearance, &part.texture));
            if let Some(material) = &part.material {
                with_material(material, &mut own.look);
            }
            own
        };
        appearance.parts.iter().map(of_part).collect()
    }
}

/// How a mesh is drawn in a part of the picture.
fn draws_of<'a>(
    view: &View,
    (mesh, placement, phong, subsurface, scattered): (
        &'a MeshBuffers,
        &Placement,
        Option<&Phong>,
        Option<&Subsurface>,
        Option<(&Body, &'a SurfacePoints, &'a Radiosity)>,
    ),
    part: &Part,
) -> Vec<Drawn<'a>> {
    let (columns, all) = (part.columns.clone(), |mesh: &MeshBuffers| 0..mesh.index_count);
    // The local model beside a scattering technique counts for more than a `Phong` of the entity.
    let written = subsurface.map(|subsurface| &subsurface.local).or(phong);
    let mut look = look(&written.cloned().unwrap_or_default());
    let place = place(view, placement);
    let scattered = scattered.filter(|_| part.shading == ShadingKind::Scattering);
    let (Some((_, points, radiosity)), Some(subsurface)) = (scattered, subsurface) else {
        let drawn = Drawn { mesh, indices: all(mesh), colours: None, radiosity: None, look, place, columns };
        return drawn.in_parts(|material, look| match written {
            // What the scene says holds, in the colours of the file.
            Some(phong) => look.diffuse = phong.diffuse * material.diffuse,
            None => {
                (look.diffuse, look.specular) = (material.diffuse, material.specular);
                look.shininess = material.shininess;
            }
        });
    };
    let specular = subsurface.specular.as_ref();
    look.specular = Vec3::splat(specular.map_or(0.0, |specular| specular.strength));
    look.shininess = specular.map_or(0.0, |specular| specular.shininess);
    look.eta = subsurface.coefficients().map_or(1.0, |channels| channels[0].eta as f32);
    let (mesh, radiosity) = (&points.mesh, Some(&radiosity.points));
    // The medium says what colour leaves on the whole; vertices and pictures say where how much of it.
    Drawn { mesh, indices: all(mesh), colours: None, radiosity, look, place, columns }.in_parts(|_, _| {})
}

/// What is equal but for its place stands together afterwards, and is drawn at once.
fn one_draw_for_equal_ones<'d, 'a>(drawn: &'d mut [Drawn<'a>]) -> Vec<&'d [Drawn<'a>]> {
    let mut first = HashMap::new();
    for (index, mesh) in drawn.iter().enumerate() {
        first.entry(mesh.mesh.vertices.clone()).or_insert(index);
    }
    drawn.sort_by_key(|mesh| (mesh.kind(), first.get(&mesh.mesh.vertices).copied(), mesh.indices.start));
    drawn.chunk_by(Drawn::equals).collect()
}

fn look(phong: &Phong) -> MeshLook {
    let Phong { ambient, diffuse, specular, shininess } = phong.clone();
    MeshLook { ambient, shininess, diffuse, specular, eta: 1.0 }
}

fn place(view: &View, placement: &Placement) -> MeshPlace {
    let (eye_from_mesh, normals) = to_eye(view, placement.0);
    let DAffine3 { matrix3, translation } = eye_from_mesh;
    let [x, y, z] = [matrix3.x_axis, matrix3.y_axis, matrix3.z_axis];
    let [a, b, c] = [normals.x_axis, normals.y_axis, normals.z_axis].map(glam::DVec4::truncate);
    [x, y, z, translation, a, b, c].map(|column| column.as_vec3().to_array())
}

fn clear_colour(texel: glam::Vec4) -> wgpu::Color {
    let [r, g, b, a] = texel.to_array().map(f64::from);
    wgpu::Color { r, g, b, a }
}
