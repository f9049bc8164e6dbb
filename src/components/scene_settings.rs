use super::{Range, Rgb, Shading, Slider, Unit};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::Vec3;

/// The head of a scene: what holds for all of it.
///
/// | field | type | unit | range | default |
/// |---|---|---|---|---|
/// | `millimetres_per_unit` | number | mm per scene unit | 1e-9 to 1e9 | 1.0 |
/// | `background` | RGB | radiance | at least 0 | (0, 0, 0) |
/// | `shading` | `Scattering` or `Local` | – | – | `Scattering` |
/// | `meshes_shade_volumes` | whether meshes stand in the light of volumes that scatter | – | – | true |
/// | `volumes_shade_meshes` | whether volumes that scatter dim the light that reaches meshes | – | – | true |
///
/// The spacing of volumes and the coefficients of media are per millimetre, whatever the unit of the scene is.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, PartialEq)]
pub struct SceneSettings {
    /// How long a scene unit is.
    #[reflect(@Range::new(1e-9, 1e9), @Slider::logarithmic(1e-3, 1e3), @Unit("mm"))]
    pub millimetres_per_unit: f32,
    /// Radiance where a ray meets nothing.
    #[reflect(@Range::non_negative(), @Rgb::Colour)]
    pub background: Vec3,
    /// The shading of entities that say nothing of their own.
    pub shading: Shading,
    /// Whether meshes cast shadows into volumes.
    pub meshes_shade_volumes: bool,
    /// Whether volumes cast shadows onto meshes.
    pub volumes_shade_meshes: bool,
}

impl Default for SceneSettings {
    fn default() -> Self {
        Self {
            millimetres_per_unit: 1.0,
            background: Vec3::ZERO,
            shading: Shading::default(),
            meshes_shade_volumes: true,
            volumes_shade_meshes: true,
        }
    }
}
