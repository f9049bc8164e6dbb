use super::{Placement, Required};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::Vec3;

/// A view of a translucent mesh in which the light that leaves it is computed, beside the views chosen by the program.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(Placement)]
pub struct ScatteringCamera {
    /// Name of the mesh.
    #[reflect(@Required)]
    pub target: String,
    /// The direction in which the camera looks.
    pub direction: Vec3,
}

impl Default for ScatteringCamera {
    fn default() -> Self {
        Self { target: String::new(), direction: Vec3::NEG_Y }
    }
}

/// The translucent mesh that a [`ScatteringCamera`] looks at: its `target`, found. Derived in [`Stage::Place`](crate::Stage::Place);
/// read it, never write it. It is absent while no entity with a [`Subsurface`](super::Subsurface) has that name.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[relationship(relationship_target = ScatteringCameras)]
pub struct ScatteringCameraOf(pub Entity);

/// The [`ScatteringCamera`]s of a mesh that are written by hand. Derived; absent where there are none.
#[derive(Component, Debug)]
#[relationship_target(relationship = ScatteringCameraOf)]
pub struct ScatteringCameras(Vec<Entity>);
