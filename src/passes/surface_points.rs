//! The points of a translucent mesh at which the light that leaves it is computed: its vertices, and as many between them as the medium
//! and the picture call for.

use super::body::Body;
use super::upload::MeshBuffers;
use crate::components::{Projection, Subsurface};
use crate::failure::Failure;
use crate::gpu::Gpu;
use crate::loading::LoadedMesh;
use crate::report::Report;
use crate::scene::{Problem, Problems};
use crate::view::{Picture, View};
use bevy_ecs::prelude::*;
use glam::{DMat3, DVec3};
use std::collections::HashMap;

/// The refined mesh on the GPU. Between its vertices the light that leaves is interpolated.
#[derive(Component, Clone, Debug)]
pub(crate) struct SurfacePoints {
    pub mesh: MeshBuffers,
    /// How many there are.
    pub count: u32,
    /// The longest edge allowed when it was made, in body space.
    spacing: f64,
    /// What it was made from.
    source: MeshBuffers,
    /// How long the mesh's axes were in body space, and the angles between them.
    shape: DMat3,
}

/// The most points of one mesh.
const MOST_POINTS: usize = 1 << 20;

/// The most points that a mesh of so many vertices gets on an adapter that is a program, where every triangle costs as much as a dozen
/// pixels: so many that a frame costs at most half as much again as one of the mesh lit locally.
fn most_points_in_software(vertices: usize) -> usize {
    vertices + vertices / 10 + 8_000
}

/// Edges are at most this many pixels long.
const PIXELS: f64 = 4.0;

/// Edges are at least, and at most, this share of the body's radius.
const SHARES: (f64, f64) = (1.0 / 1024.0, 1.0 / 16.0);

/// Points are made anew when they are to be finer by this factor, so that a small step of the camera changes nothing.
const HYSTERESIS: f64 = 1.5;

/// Shapes closer than this are the same: turning a mesh moves the last digits of its lengths.
const SAME: f64 = 1e-6;

type Refinable<'a> =
    (Entity, Ref<'a, LoadedMesh>, &'a MeshBuffers, &'a Body, &'a Subsurface, Option<&'a SurfacePoints>);

/// Refines the meshes that scatter where that is called for.
pub(crate) fn refine(
    mut commands: Commands,
    gpu: Res<Gpu>,
    (view, picture): (Res<View>, Res<Picture>),
    meshes: Query<Refinable>,
    (mut report, mut failure, mut problems): (ResMut<Report>, ResMut<Failure>, ResMut<Problems>),
) {
    let mut held = HashMap::new();
    // Equal meshes that are to be about equally fine share their points.
    let mut made: Vec<SurfacePoints> = Vec::new();
    for (entity, mesh, buffers, body, subsurface, points) in &meshes {
        if failure.stands_on(entity) {
            continue;
        }
        let spacing = spacing(&view, &picture, body, subsurface);
        let axes = body.body_from_mesh.matrix3;
        let shape = axes.transpose() * axes;
        let is_of = |points: &&SurfacePoints| {
            points.source == *buffers && points.shape.abs_diff_eq(shape, SAME * shape.determinant().cbrt())
        };
        let is_current = |points: &&SurfacePoints| is_of(points) && spacing * HYSTERESIS >= points.spacing;
        if let Some(points) = points.filter(is_current) {
            held.extend(points.bytes());
            continue;
        }
        let is_alike = |points: &&SurfacePoints| {
            is_of(points) && (spacing / HYSTERESIS..=spacing).contains(&points.spacing)
        };
        if let Some(points) = made.iter().find(is_alike) {
            commands.entity(entity).insert(points.clone());
            continue;
        }
        let Some(data) = &mesh.data else { continue };
        let limits = gpu.device.limits();
        let most_vertices =
            limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) / MeshBuffers::VERTEX;
        if data.positions.len() as u64 > most_vertices {
            problems.0.push(too_many(data.positions.len(), most_vertices).on(entity, "Subsurface"));
            continue;
        }
        let most =
            if gpu.is_software() { most_points_in_software(data.positions.len()) } else { MOST_POINTS };
        let (refined, _) = data.refined(axes, spacing, most);
        let is_same = refined.positions.len() == data.positions.len();
        let mesh = if is_same { Ok(buffers.clone()) } else { buffers.refined(&gpu, &refined) };
        let mesh = match mesh {
            Ok(mesh) => mesh,
            Err(error) => {
                failure.on(entity, "surface_points", "Subsurface", error);
                continue;
            }
        };
        let count = refined.positions.len() as u32;
        let points = SurfacePoints { mesh, count, spacing, source: buffers.clone(), shape };
        held.extend(points.bytes());
        made.push(points.clone());
        report.ran("surface_points", &[("points", u64::from(points.count))]);
        commands.entity(entity).insert(points);
    }
    report.hold("surface points", held.values().sum());
}

fn too_many(vertices: usize, most: u64) -> Problem {
    let message = format!("{vertices} vertices are more than this adapter computes the light of: {most}");
    Problem::error(message).help("simplify the mesh, split it into several entities, or set `Shading: Local`")
}

impl SurfacePoints {
    /// The longest edge that there may be, in body space.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// What holds the points, and how many bytes that are; nothing where the mesh's own vertices do.
    fn bytes(&self) -> Option<(wgpu::Buffer, u64)> {
        (self.mesh != self.source).then(|| (self.mesh.vertices.clone(), self.mesh.bytes()))
    }
}

/// How long edges may be, in body space: half a mean free path, over which the light that leaves cannot change much, but no finer than
/// the picture shows.
fn spacing(view: &View, picture: &Picture, body: &Body, subsurface: &Subsurface) -> f64 {
    let mean_free_path = subsurface.coefficients().map_or(f64::INFINITY, |channels| {
        channels.iter().map(|channel| channel.diffusion().sigma_t_prime.recip()).fold(f64::INFINITY, f64::min)
            / body.millimetres
    });
    let pixel = PIXELS * pixel(view, picture, body);
    (mean_free_path / 2.0).max(pixel).clamp(SHARES.0, SHARES.1)
}

/// What a pixel covers where the body is nearest to the camera, in body space.
fn pixel(view: &View, picture: &Picture, body: &Body) -> f64 {
    let half_extent = view.half_extent(picture.size);
    let eye_from_body = view.eye_from_scene * body.body_from_scene.inverse();
    let radius = eye_from_body.transform_vector3(DVec3::X).length();
    let size = match view.projection {
        // In units of the distance.
        Projection::Perspective { .. } => {
            let distance = eye_from_body.translation.length() - radius;
            distance.max(0.1 * radius)
        }
        Projection::Orthographic { .. } => 1.0,
    };
    2.0 * f64::from(half_extent.y) / f64::from(picture.size.y) * size / radius
}
