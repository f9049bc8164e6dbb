//! Which cameras look at a mesh: those written by hand, and those that the program spreads around it.

use super::Body;
use crate::components::{
    MapResolution, MapStrategy, ScatteringCamera, ScatteringCameraOf, ScatteringCameras, ScatteringMaps,
};
use crate::optics::sampling::{halton, sphere_point};
use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3};

/// A scattering camera that the program spread around a mesh, its child. Looks in a direction of the mesh's own space.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct AutomaticCamera {
    /// Unit vector.
    pub direction: DVec3,
}

type Spawning<'a> = (Entity, &'a ScatteringMaps, Option<&'a ScatteringCameras>, Option<&'a Children>);

/// Spawns the cameras that a mesh asks for: points of Halton's sequence on the sphere, looking at its middle.
pub(crate) fn spawn_cameras(
    mut commands: Commands,
    bodies: Query<Spawning, With<Body>>,
    former: Query<&Children, Without<Body>>,
    automatic: Query<(), With<AutomaticCamera>>,
) {
    for (mesh, maps, by_hand, children) in &bodies {
        let own: Vec<Entity> =
            children.into_iter().flatten().copied().filter(|child| automatic.contains(*child)).collect();
        let has_hand =
            by_hand.is_some_and(|cameras| cameras.iter().any(|camera| !automatic.contains(camera)));
        let wanted = if uses_maps(maps, has_hand) { maps.cameras } else { 0 };
        if own.len() == wanted as usize {
            continue;
        }
        own.into_iter().for_each(|camera| commands.entity(camera).despawn());
        for index in 1..=wanted {
            let point = halton(index);
            let direction = -sphere_point(point.x, point.y);
            commands.spawn((AutomaticCamera { direction }, ScatteringCameraOf(mesh), ChildOf(mesh)));
        }
    }
    for camera in former.iter().flatten().filter(|child| automatic.contains(**child)) {
        commands.entity(*camera).despawn();
    }
}

/// Whether the light that leaves a mesh is computed in maps, or at the points of its surface: those are fewer than the texels that maps
/// with the same detail have, so maps are made where they are asked for.
fn uses_maps(maps: &ScatteringMaps, has_cameras_by_hand: bool) -> bool {
    maps.strategy == MapStrategy::Uniform || maps.resolution != MapResolution::Auto || has_cameras_by_hand
}

pub(super) type Cameras<'w, 's> =
    Query<'w, 's, (Entity, Option<&'static ScatteringCamera>, Option<&'static AutomaticCamera>)>;

/// Towards the cameras, in body space: those written by hand, and the automatic ones.
pub(super) fn directions(
    body: &Body,
    own: &ScatteringCameras,
    cameras: &Cameras,
) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut entities: Vec<Entity> = own.iter().collect();
    entities.sort();
    let (mut by_hand, mut automatic) = (Vec::new(), Vec::new());
    for (_, written, spread) in entities.iter().filter_map(|entity| cameras.get(*entity).ok()) {
        if let Some(camera) = spread {
            automatic.push(-body.body_from_mesh.transform_vector3(camera.direction).normalize());
        } else if let Some(camera) = written {
            by_hand.push(-camera.direction.as_dvec3().normalize());
        }
    }
    (by_hand, automatic)
}

/// Turns the automatic cameras of a further set: by golden angles about an axis that turns too, so that no two sets agree.
pub(super) fn turn(set: u32) -> DQuat {
    let point = halton(set);
    let axis = sphere_point(point.x, point.y);
    DQuat::from_axis_angle(axis, if set == 0 { 0.0 } else { 2.399_963_229_728_653 * f64::from(set) })
}
