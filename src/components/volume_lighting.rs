use super::{AlsoCalled, Auto, Range, Slider, Unit};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};

/// How a volume meets the light.
///
/// | variant | field | unit | range | default |
/// |---|---|---|---|---|
/// | `EmissionAbsorption` | – | – | – | – |
/// | `Gradient` | `ambient`: share of the colour that is there without light | – | at least 0 | 0.2 |
/// | | `diffuse`: Lambert's share | – | at least 0 | 0.7 |
/// | | `specular`: strength of the white highlight | – | at least 0 | 0.3 |
/// | | `shininess`: Blinn's exponent | – | 0 to 10,000 | 16 |
/// | `SingleScattering` | `g`: mean cosine of scattering | – | -0.999 to 0.999 | 0 |
/// | | `resolution`: nodes per voxel along each axis, at which the light that arrives is kept; more along long edges of dense voxels | – | 1/8 to 1 | 1 |
/// | `LightVolume` | `cone_angle`: half angle of the cone in which scattered light travels, or `Auto` | degrees | 1 to 89 | `Auto` |
/// | | `resolution`: as above; scattered light is kept at a quarter of it | – | 1/8 to 1 | 1 |
/// | | `blend`: count all faces through which light enters a cell, not only those across its nearest axis | – | – | true |
/// | | `towards_eye`: sweep towards the viewer as well, so that forward scattering spreads what is behind | – | – | false |
/// | | `gradient_specular`: strength of the highlight on surfaces in the field | – | at least 0 | 0 |
/// | | `emission`: share of the colour that is emitted besides | – | at least 0 | 0 |
/// | | `g`: as above | – | -0.999 to 0.999 | 0 |
///
/// *Emission-absorption* (Max 1995, eq. 10): each piece of the medium emits the colour of the transfer function and absorbs what lies
/// behind it; lights play no part. *Gradient* takes the normalised gradient of the field (central differences, one voxel to either
/// side) for the normal of a surface and multiplies: radiance = colour (ambient + diffuse sum(E/pi n.l)) + specular sum(E/pi (n.h)^s), so
/// that a light of irradiance pi gives the familiar figures. Where the field is flat there is no normal and only `ambient` and
/// `diffuse` remain, as if the light came from the front.
///
/// In the other two the colour of the transfer function is the albedo, 0 to 1 in each channel (more counts as 1), and only lights give light.
/// *Single scattering* is light that was scattered once: albedo p(g, cos) E exp(-tau) from each piece of the medium, with tau the optical
/// depth towards the light and p Henyey and Greenstein's phase function. It is exact but for errors of second order in the voxel
/// and the step of the ray; where a voxel takes more than an optical depth of a half, rays look for the light in front of each of their samples for themselves. The *light volume* (after Ropinski and others 2010) adds light that was scattered more often: what does not
/// escape diffuses ([`optics::diffusion`](crate::optics::diffusion)), an approximation that gives back no more light than it receives; see
/// `docs/architecture.md` for how far off it is. `cone_angle: Auto` is 63 degrees, as far as light diffuses in the medium; a narrower cone keeps it
/// closer to where it was scattered first.
///
/// Volumes with one of these two shade the meshes of a scene and are shaded by them, unless the head of the scene says otherwise.
///
/// ```ron
/// VolumeLighting: Gradient(ambient: 0.2, diffuse: 0.7, specular: 0.3, shininess: 16.0)
/// VolumeLighting: SingleScattering(g: 0.6)
/// VolumeLighting: LightVolume(resolution: 0.5, gradient_specular: 0.3)
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[reflect(@AlsoCalled(&["VolumeShading", "VolumeLight"]))]
pub enum VolumeLighting {
    /// The colours of the transfer function as they are.
    #[default]
    #[reflect(@AlsoCalled(&["Emission", "Absorption", "Unlit"]))]
    EmissionAbsorption,
    /// Blinn-Phong with the gradient for a normal.
    #[reflect(@AlsoCalled(&["Phong", "BlinnPhong", "GradientLighting"]))]
    Gradient {
        /// Share without light.
        #[reflect(default = "ambient", @Range::non_negative(), @Slider::linear(0.0, 1.0))]
        ambient: f32,
        /// Lambert's share.
        #[reflect(default = "diffuse", @Range::non_negative(), @Slider::linear(0.0, 1.0))]
        diffuse: f32,
        /// Strength of the highlight.
        #[reflect(default = "specular", @Range::non_negative(), @Slider::linear(0.0, 1.0))]
        specular: f32,
        /// Blinn's exponent.
        #[reflect(default = "shininess", @Range::new(0.0, 10_000.0), @Slider::logarithmic(1.0, 10_000.0))]
        shininess: f32,
    },
    /// Light that was scattered once.
    #[reflect(@AlsoCalled(&["Single", "Shadows"]))]
    SingleScattering {
        /// Mean cosine of scattering.
        #[reflect(default, @Range::new(-0.999, 0.999))]
        g: f32,
        /// Nodes per voxel along each axis.
        #[reflect(default = "full", @Range::new(0.125, 1.0), @Unit("nodes per voxel"))]
        resolution: f32,
    },
    /// Light that was scattered, however often.
    #[reflect(@AlsoCalled(&["MultipleScattering", "Scattering", "GlobalIllumination"]))]
    LightVolume {
        /// Half angle of the cone of scattered light.
        #[reflect(default, @Range::new(1.0, 89.0), @Unit("degrees"))]
        cone_angle: Auto<f32>,
        /// Nodes per voxel along each axis.
        #[reflect(default = "full", @Range::new(0.125, 1.0), @Unit("nodes per voxel"))]
        resolution: f32,
        /// Whether all faces count through which light enters a cell, not only those across its nearest axis.
        #[reflect(default = "yes")]
        blend: bool,
        /// Whether light is swept towards the viewer too.
        #[reflect(default)]
        towards_eye: bool,
        /// Strength of the highlight.
        #[reflect(default, @Range::non_negative(), @Slider::linear(0.0, 1.0))]
        gradient_specular: f32,
        /// Share of the colour that is emitted.
        #[reflect(default, @Range::non_negative(), @Slider::linear(0.0, 1.0))]
        emission: f32,
        /// Mean cosine of scattering.
        #[reflect(default, @Range::new(-0.999, 0.999))]
        g: f32,
    },
}

impl VolumeLighting {
    /// The local model in place of a scattering technique where [`Shading`](super::Shading) is `Local`: `Gradient` with its defaults.
    pub fn local(&self) -> Self {
        match self {
            Self::SingleScattering { .. } | Self::LightVolume { .. } => Self::Gradient {
                ambient: ambient(),
                diffuse: diffuse(),
                specular: specular(),
                shininess: shininess(),
            },
            other => other.clone(),
        }
    }

    /// Whether surfaces in the volume have normals that it shades by.
    pub(crate) fn takes_normals(&self) -> bool {
        match self {
            Self::Gradient { .. } => true,
            Self::LightVolume { gradient_specular, .. } => *gradient_specular > 0.0,
            Self::EmissionAbsorption | Self::SingleScattering { .. } => false,
        }
    }

    /// Nodes per voxel at which the light that arrives is kept, of lightings that need it.
    pub fn light_resolution(&self) -> Option<f32> {
        match self {
            Self::SingleScattering { resolution, .. } | Self::LightVolume { resolution, .. } => {
                Some(*resolution)
            }
            _ => None,
        }
    }
}

fn full() -> f32 {
    1.0
}

fn yes() -> bool {
    true
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
