use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};

/// Whether an entity scatters light or falls back to the classic local models.
///
/// On an entity, or in the head of the scene for all entities without one. `Local` replaces every scattering technique of the entity
/// by the local model beside it, a [`Subsurface`](super::Subsurface) by its `local`; what is shaded locally anyway ([`Phong`](super::Phong),
/// [`VolumeLighting::Gradient`](super::VolumeLighting::Gradient)) looks the same either way.
///
/// ```ron
/// Shading: Local
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, PartialEq)]
pub enum Shading {
    /// The scattering technique that the entity's components ask for.
    #[default]
    Scattering,
    /// Local models only.
    Local,
}
