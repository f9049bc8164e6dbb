use super::Range;
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};

/// How a volume meets the light.
///
/// | variant | field | range | default |
/// |---|---|---|---|
/// | `EmissionAbsorption` | – | – | – |
/// | `Gradient` | `ambient`: share of the colour that is there without light | at least 0 | 0.2 |
/// | | `diffuse`: Lambert's share | at least 0 | 0.7 |
/// | | `specular`: strength of the white highlight | at least 0 | 0.3 |
/// | | `shininess`: Blinn's exponent | 0 to 10,000 | 16 |
///
/// *Emission-absorption* (Max 1995, eq. 10): each piece of the medium emits the colour of the transfer function and absorbs what lies
/// behind it; lights play no part. *Gradient* takes the normalised gradient of the field (central differences, one voxel to either
/// side) for the normal of a surface and multiplies: radiance = colour (ambient + diffuse sum(E/pi n.l)) + specular sum(E/pi (n.h)^s), so
/// that a light of irradiance pi gives the familiar figures. Where the field is flat there is no normal and only `ambient` and
/// `diffuse` remain, as if the light came from the front.
///
/// ```ron
/// VolumeLighting: Gradient(ambient: 0.2, diffuse: 0.7, specular: 0.3, shininess: 16.0)
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
pub enum VolumeLighting {
    /// The colours of the transfer function as they are.
    #[default]
    EmissionAbsorption,
    /// Blinn-Phong with the gradient for a normal.
    Gradient {
        /// Share without light.
        #[reflect(default = "ambient", @Range::non_negative())]
        ambient: f32,
        /// Lambert's share.
        #[reflect(default = "diffuse", @Range::non_negative())]
        diffuse: f32,
        /// Strength of the highlight.
        #[reflect(default = "specular", @Range::non_negative())]
        specular: f32,
        /// Blinn's exponent.
        #[reflect(default = "shininess", @Range::new(0.0, 10_000.0))]
        shininess: f32,
    },
}

fn ambient() -> f32 {
    0.2
}

fn diffuse() -> f32 {
    0.7
}

fn specular() -> f32 {
    0.3
}

fn shininess() -> f32 {
    16.0
}
