//! Which meshes scatter, where they are and how large: the space in which their light transport is computed.

use super::combine::Radiosity;
use super::light_gbuffer::LightViews;
use super::scattered_radiosity::ScatteredRadiosity;
use super::scattering_gbuffer::CameraMaps;
use super::surface_points::SurfacePoints;
use crate::components::{Placement, SceneSettings, Shading, Subsurface};
use crate::loading::{LoadedMesh, placed_corners};
use bevy_ecs::prelude::*;
use glam::{DAffine3, DVec3};

/// A mesh that scatters. *Body space* has its origin in the middle of the mesh, the directions of the scene, and the radius of the mesh
/// for its unit, so that 32 bits are enough whatever the scale of the scene is.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub(crate) struct Body {
    /// Takes the scene to body space.
    pub body_from_scene: DAffine3,
    /// Takes the mesh to body space.
    pub body_from_mesh: DAffine3,
    /// Millimetres per unit of body space.
    pub millimetres: f64,
}

impl Body {
    /// The body space of a box.
    pub fn of(bounds: (glam::Vec3, glam::Vec3), placement: &Placement, millimetres_per_unit: f32) -> Self {
        let corners: Vec<DVec3> = placed_corners(placement, bounds).collect();
        let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let radius = corners.iter().map(|corner| corner.distance(centre)).fold(0.0, f64::max);
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let body_from_scene =
            DAffine3::from_scale(DVec3::splat(radius.recip())) * DAffine3::from_translation(-centre);
        Self {
            body_from_scene,
            body_from_mesh: body_from_scene * placement.0,
            millimetres: radius * f64::from(millimetres_per_unit),
        }
    }

    /// Where it is, whatever the unit of the scene is: what geometry depends on.
    pub fn without_unit(&self) -> Self {
        Self { millimetres: 1.0, ..*self }
    }
}

type Scatters<'a> = (Entity, &'a LoadedMesh, &'a Placement, Option<&'a Shading>, Option<&'a Body>);

/// Marks the meshes that scatter with where they are, and takes the mark from those that no longer do.
pub(crate) fn measure(
    mut commands: Commands,
    meshes: Query<Scatters, With<Subsurface>>,
    former: Query<Entity, (With<Body>, Or<(Without<Subsurface>, Without<LoadedMesh>)>)>,
    settings: Res<SceneSettings>,
) {
    for (entity, mesh, placement, shading, body) in &meshes {
        if shading.unwrap_or(&settings.shading) == &Shading::Local {
            commands.entity(entity).remove::<Body>();
            continue;
        }
        let now = Body::of(mesh.bounds, placement, settings.millimetres_per_unit);
        if body != Some(&now) {
            commands.entity(entity).insert(now);
        }
    }
    for entity in &former {
        commands.entity(entity).remove::<Body>();
    }
}

/// What was computed for a mesh goes when it no longer scatters.
pub(crate) fn forget(
    mut commands: Commands,
    mut former: RemovedComponents<Body>,
    bodies: Query<(), With<Body>>,
) {
    for entity in former.read().filter(|entity| !bodies.contains(*entity)) {
        commands
            .entity(entity)
            .try_remove::<(SurfacePoints, LightViews, CameraMaps, ScatteredRadiosity, Radiosity)>();
    }
}
