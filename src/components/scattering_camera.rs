use super::{Direction, NameOf, Required, Subsurface, Validate, attributes::ReflectValidate};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::Vec3;
use std::collections::HashMap;

/// A view of a translucent mesh in which the light that leaves it is computed, beside the views that the program chooses.
///
/// | field | type | unit | range | default |
/// |---|---|---|---|---|
/// | `target` | name of an entity with a [`Subsurface`] | – | – | – |
/// | `direction` | vector: where the camera looks, in the scene | – | not zero | (0, -1, 0) |
///
/// The view is orthographic and fitted to the target, so it needs no place; the length of `direction` does not matter. Write one
/// where the views that [`ScatteringMaps`](super::ScatteringMaps) spreads around a mesh miss a hollow of it, as an entity of its own
/// or on the mesh itself.
///
/// ```ron
/// "from above": ( ScatteringCamera: (target: "bunny", direction: (0.0, -1.0, 0.0)) )
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq, Validate)]
pub struct ScatteringCamera {
    /// Name of the mesh.
    #[reflect(@Required, @NameOf("Subsurface"))]
    pub target: String,
    /// The direction in which the camera looks.
    #[reflect(@Direction)]
    pub direction: Vec3,
}

impl Default for ScatteringCamera {
    fn default() -> Self {
        Self { target: String::new(), direction: Vec3::NEG_Y }
    }
}

impl Validate for ScatteringCamera {
    fn problems(&self) -> Vec<(&'static str, String)> {
        if self.direction.as_dvec3().length_squared() > 0.0 {
            return Vec::new();
        }
        vec![("direction", "a camera needs a direction in which it looks, found (0, 0, 0)".into())]
    }
}

/// The translucent mesh that a [`ScatteringCamera`] looks at: its `target`, found. Derived in [`Stage::Place`](crate::Stage::Place);
/// read it, never write it. It is absent while no entity with a [`Subsurface`] has that name.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[relationship(relationship_target = ScatteringCameras, allow_self_referential)]
pub struct ScatteringCameraOf(pub Entity);

/// The [`ScatteringCamera`]s of a mesh that are written by hand. Derived; absent where there are none.
#[derive(Component, Debug)]
#[relationship_target(relationship = ScatteringCameraOf)]
pub struct ScatteringCameras(Vec<Entity>);

/// Finds the targets of cameras, when cameras or what may be a target have changed. Of several meshes with one name, which only code can
/// make, the first that was made is taken.
pub(crate) fn aim(
    mut commands: Commands,
    cameras: Query<(Entity, &ScatteringCamera, Option<&ScatteringCameraOf>)>,
    meshes: Query<(Entity, &Name), With<Subsurface>>,
    changed: Query<(), Or<(Changed<ScatteringCamera>, Added<Subsurface>, (Changed<Name>, With<Subsurface>))>>,
    mut no_camera: RemovedComponents<ScatteringCamera>,
    mut no_mesh: RemovedComponents<Subsurface>,
) {
    let mut removed = no_mesh.read().count() > 0;
    for camera in no_camera.read().filter(|camera| !cameras.contains(*camera)) {
        commands.entity(camera).try_remove::<ScatteringCameraOf>();
        removed = true;
    }
    if changed.is_empty() && !removed {
        return;
    }
    let mut targets: HashMap<&str, Entity> = HashMap::new();
    for (entity, name) in &meshes {
        targets.entry(name.as_str()).and_modify(|first| *first = entity.min(*first)).or_insert(entity);
    }
    for (camera, written, known) in &cameras {
        let found = targets.get(written.target.as_str()).copied();
        if found == known.map(|of| of.0) {
            continue;
        }
        match found {
            Some(mesh) => commands.entity(camera).insert(ScatteringCameraOf(mesh)),
            None => commands.entity(camera).remove::<ScatteringCameraOf>(),
        };
    }
}
