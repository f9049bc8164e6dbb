use super::{AlsoCalled, Range, Rgb, Slider};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::Vec3;

/// An opaque surface: Lambert's diffuse and Blinn's specular reflection, both normalised.
///
/// | field | type | range | default |
/// |---|---|---|---|
/// | `ambient` | RGB radiance that is there without any light | at least 0 | (0, 0, 0) |
/// | `diffuse` | RGB albedo | 0 to 1 | (0.8, 0.8, 0.8) |
/// | `specular` | RGB, share of the light in the highlight at normal incidence | 0 to 1 | (0, 0, 0) |
/// | `shininess` | Blinn's exponent s | 0 to 10,000 | 32 |
///
/// For each light of irradiance E the radiance is `(diffuse/pi + specular (s+8)/(8 pi) (n.h)^s) E (n.l)`, with n turned towards the
/// viewer, l towards the light and h halfway between l and the viewer (Blinn 1977; the normalisation is Akenine-Möller et al.,
/// Real-Time Rendering, 3rd ed., eq. 7.49). A larger `shininess` makes a highlight smaller and brighter, not dimmer.
///
/// ```ron
/// Phong: (diffuse: (0.7, 0.1, 0.1), specular: (0.04, 0.04, 0.04), shininess: 200.0)
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[reflect(@AlsoCalled(&["Material", "Color", "Colour", "Lambert", "BlinnPhong", "Diffuse", "Albedo", "Shader", "Pbr"]))]
pub struct Phong {
    /// Radiance without any light.
    #[reflect(@Range::non_negative(), @Rgb::Colour)]
    pub ambient: Vec3,
    /// Albedo of the diffuse part.
    #[reflect(@Range::new(0.0, 1.0), @Rgb::Colour)]
    #[reflect(@AlsoCalled(&["color", "colour", "albedo", "kd", "base_color"]))]
    pub diffuse: Vec3,
    /// Strength of the specular part.
    #[reflect(@Range::new(0.0, 1.0), @Rgb::Colour)]
    #[reflect(@AlsoCalled(&["reflectance", "ks"]))]
    pub specular: Vec3,
    /// Blinn's exponent.
    #[reflect(@Range::new(0.0, 10_000.0), @Slider::logarithmic(1.0, 10_000.0))]
    #[reflect(@AlsoCalled(&["exponent", "glossiness", "ns"]))]
    pub shininess: f32,
}

impl Default for Phong {
    fn default() -> Self {
        Self { ambient: Vec3::ZERO, diffuse: Vec3::splat(0.8), specular: Vec3::ZERO, shininess: 32.0 }
    }
}
