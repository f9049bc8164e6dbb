use super::{AlsoCalled, Direction, Range, Rgb, Validate, attributes::ReflectValidate};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::Vec3;

/// Light from infinitely far away: parallel rays.
///
/// | field | type | unit | range | default |
/// |---|---|---|---|---|
/// | `direction` | vector | – | not zero | (0, -1, 0) |
/// | `irradiance` | RGB | scene radiance x sr | at least 0 | (1, 1, 1) |
///
/// `direction` is the direction in which the light *travels*; its length does not matter. `irradiance` is what a surface that faces
/// the light receives, so a white Lambert surface facing a light of irradiance pi has radiance 1.
///
/// ```ron
/// DirectionalLight: (direction: (-1.0, -2.0, -0.5), irradiance: (3.0, 2.9, 2.7))
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq, Validate)]
#[reflect(@AlsoCalled(&["Light", "Sun", "SunLight", "DistantLight", "Lamp", "Spot", "PointLight", "AreaLight"]))]
pub struct DirectionalLight {
    /// The direction in which the light travels.
    #[reflect(@Direction)]
    pub direction: Vec3,
    /// Irradiance on a surface facing the light.
    #[reflect(@Range::non_negative(), @Rgb::Colour)]
    #[reflect(@AlsoCalled(&["color", "colour", "intensity", "radiance", "power", "strength", "brightness"]))]
    pub irradiance: Vec3,
}

impl Default for DirectionalLight {
    fn default() -> Self {
        Self { direction: Vec3::NEG_Y, irradiance: Vec3::ONE }
    }
}

impl Validate for DirectionalLight {
    fn problems(&self) -> Vec<(&'static str, String)> {
        if self.direction.as_dvec3().length_squared() > 0.0 {
            return Vec::new();
        }
        vec![("direction", "a light needs a direction in which it travels, found (0, 0, 0)".into())]
    }
}
