//! What is seen of a mesh from one side, by its light or by one of its scattering cameras: a view and how it is drawn.

use super::body::Body;
use super::upload::MeshBuffers;
use crate::components::Placement;
use crate::gpu::{Draw, DrawDescriptor, Gpu, GpuError, Target, binding, uniform_each};
use crate::loading::{LoadedMesh, placed_corners};
use crate::view::normal_matrix;
use crate::{mirrors::mirror, report::Report};
use bevy_ecs::prelude::*;
use encase::ShaderSize;
use glam::{DAffine3, DMat3, DMat4, DVec2, DVec3, Mat4, UVec2, Vec3};

/// An orthographic view of a body: x and y across it, z towards the viewer, lengths in radii of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OrthographicView {
    /// Takes body space to the view.
    pub view_from_body: DAffine3,
    /// Corners of what is seen.
    pub low: DVec3,
    /// The other corner.
    pub high: DVec3,
    /// Texels across and down; they are square.
    pub size: UVec2,
}

/// How many texels a view has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fit {
    /// So many along the longer side; along the shorter as many as the body needs.
    Longer(u32),
    /// So many across and down.
    Whole(UVec2),
}

impl OrthographicView {
    /// The rotation that takes body space to a view from the side `towards`, a unit vector.
    pub fn rotation(towards: DVec3) -> DAffine3 {
        let (x, y) = towards.any_orthonormal_pair();
        DAffine3::from_mat3(DMat3::from_cols(x, y, towards).transpose())
    }

    /// The view from the side `towards` that shows all of a mesh, and nothing beside it.
    pub fn fitted(body: &Body, mesh: &LoadedMesh, towards: DVec3, fit: Fit) -> Self {
        let view_from_body = Self::rotation(towards);
        let view_from_mesh = view_from_body * body.body_from_mesh;
        let positions = mesh.data.iter().flat_map(|data| &data.positions);
        let seen = extent(positions.map(|p| view_from_mesh.transform_point3(p.as_dvec3())));
        Self::around(view_from_body, seen, fit)
    }

    /// The view that shows all between two corners.
    pub fn around(view_from_body: DAffine3, (low, high): (DVec3, DVec3), fit: Fit) -> Self {
        let extent = (high - low).truncate();
        // Half a texel to spare on each side, and no view without any width.
        let (texel, size) = match fit {
            Fit::Longer(texels) => {
                let texel = (extent.max_element() / f64::from(texels.max(2) - 1)).max(1e-6);
                (texel, (extent / texel).ceil().as_uvec2() + 1)
            }
            Fit::Whole(size) => {
                let inner = (size.as_dvec2() - 1.0).max(DVec2::ONE);
                ((extent / inner).max_element().max(1e-6), size)
            }
        };
        let spare = ((size.as_dvec2() * texel - extent) / 2.0).extend(1e-3);
        Self { view_from_body, low: low - spare, high: high + spare, size }
    }

    /// Texels per unit of length.
    pub fn texels_per_length(&self) -> f64 {
        f64::from(self.size.x) / (self.high.x - self.low.x)
    }
}

/// The corners of a box as seen in a view.
pub(crate) fn seen_box(
    view_from_body: DAffine3,
    body: &Body,
    placement: &Placement,
    bounds: (Vec3, Vec3),
) -> (DVec3, DVec3) {
    let view_from_scene = view_from_body * body.body_from_scene;
    extent(placed_corners(placement, bounds).map(|corner| view_from_scene.transform_point3(corner)))
}

fn extent(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = points.fold(nothing, |(low, high), point| (low.min(point), high.max(point)));
    if low.is_finite() { (low, high) } else { (DVec3::ZERO, DVec3::ZERO) }
}

mirror! {
    /// Mirror of `SeenMesh` in `shaders/gbuffer.wgsl`.
    "gbuffer":
    pub(crate) struct SeenMeshUniform as "SeenMesh" {
        view_from_mesh: Mat4,
        view_from_mesh_normal: Mat4,
        centre: Vec3,
        is_seen: f32,
        inverse_half: Vec3,
    }
}

/// Format of a G-buffer: normal in the view's space, height towards the viewer.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// The pipeline that draws them, and the depth that they were last drawn with.
#[derive(Resource, Default, Debug)]
pub(crate) struct Gbuffer {
    draw: Option<Draw>,
    depth: Option<Target>,
}

/// A mesh that is drawn: where it is in the body's space, and whether it is the body itself.
pub(crate) type Seen<'a> = (&'a MeshBuffers, DAffine3, bool);

impl Gbuffer {
    /// The pipeline, made when it is first asked for.
    fn pipeline(&mut self, gpu: &Gpu, report: &mut Report) -> Result<&Draw, GpuError> {
        let draw = match self.draw.take() {
            Some(draw) => draw,
            None => {
                report.pipelines.push("gbuffer");
                Draw::new(
                    gpu,
                    &DrawDescriptor {
                        name: "gbuffer",
                        generated: &[],
                        entry_points: ("transform", "record"),
                        bindings: &[binding::UNIFORM_EACH],
                        vertex_buffers: &[&wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3]],
                        instances: &[],
                        format: FORMAT,
                        depth: true,
                    },
                )?
            }
        };
        Ok(self.draw.insert(draw))
    }

    /// Draws meshes as a view sees them from the height `top`, and answers how many triangles that were.
    #[expect(clippy::too_many_arguments, reason = "what one draw reads and writes")]
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        label: &'static str,
        view: &OrthographicView,
        top: f64,
        meshes: &[Seen],
        colour: &wgpu::TextureView,
        timing: Option<wgpu::RenderPassTimestampWrites>,
        report: &mut Report,
    ) -> Result<u64, GpuError> {
        let format = wgpu::TextureFormat::Depth32Float;
        let depth = Target::again(self.depth.take(), gpu, "gbuffer depth", view.size, format)?;
        let draw = self.pipeline(gpu, report)?;
        let uniforms: Vec<_> = meshes.iter().map(|mesh| uniform(view, top, mesh)).collect();
        let (buffer, stride) = uniform_each(gpu, "seen meshes", &uniforms);
        let size = std::num::NonZeroU64::new(SeenMeshUniform::SHADER_SIZE.get());
        let binding = wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: &buffer, offset: 0, size });
        let bind_group = draw.bind(gpu, &[binding]);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let clear = wgpu::Color::TRANSPARENT;
        let mut pass = crate::gpu::begin(&mut encoder, label, clear, colour, &depth.view, timing);
        let mut triangles = 0;
        for (index, (mesh, ..)) in meshes.iter().enumerate() {
            draw.begin(&mut pass, &bind_group, &[index as u32 * stride]);
            mesh.draw(&mut pass);
            triangles += u64::from(mesh.index_count / 3);
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        self.depth = Some(depth);
        Ok(triangles)
    }
}

fn uniform(view: &OrthographicView, top: f64, (_, body_from_mesh, is_seen): &Seen) -> SeenMeshUniform {
    let view_from_mesh = view.view_from_body * *body_from_mesh;
    let (low, high) = (view.low, view.high.truncate().extend(top));
    SeenMeshUniform {
        view_from_mesh: DMat4::from(view_from_mesh).as_mat4(),
        view_from_mesh_normal: normal_matrix(view_from_mesh).as_mat4(),
        centre: ((low + high) / 2.0).as_vec3(),
        is_seen: f32::from(u8::from(*is_seen)),
        inverse_half: (2.0 / (high - low)).as_vec3(),
    }
}
