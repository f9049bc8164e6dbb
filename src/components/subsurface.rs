use super::{Phong, Range, ScatteringMaps, Unit};
use crate::optics::materials::{self, Coefficients};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::Vec3;

/// A translucent mesh: light enters it, is scattered inside and leaves elsewhere.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[require(ScatteringMaps)]
pub struct Subsurface {
    /// What the mesh is filled with.
    pub material: Material,
    /// How the scattered light is computed.
    pub model: DipoleModel,
    /// The highlight on the surface.
    pub specular: Option<Specular>,
    /// What the mesh looks like while its shading is `Local`.
    pub local: Phong,
}

/// A homogeneous medium, by name or by its coefficients.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, PartialEq)]
pub enum Material {
    /// One of [`materials::MEDIA`], by name.
    Preset(String),
    /// By its coefficients: `sigma_a` and `sigma_s`, or `sigma_t` and `albedo`.
    Custom {
        /// Absorption.
        #[reflect(default, @Range::new(0.0, 1e12), @Unit("per mm"))]
        sigma_a: Option<Vec3>,
        /// Scattering, not reduced.
        #[reflect(default, @Range::new(0.0, 1e12), @Unit("per mm"))]
        sigma_s: Option<Vec3>,
        /// Extinction, which is absorption and scattering together.
        #[reflect(default, @Range::new(0.0, 1e12), @Unit("per mm"))]
        sigma_t: Option<Vec3>,
        /// The share of the extinction that is scattering.
        #[reflect(default, @Range::new(0.0, 1.0))]
        albedo: Option<Vec3>,
        /// Mean cosine of the scattering angle.
        #[reflect(default, @Range::new(-0.999, 0.999))]
        g: f32,
        /// Index of refraction relative to the outside.
        #[reflect(default = "eta", @Range::new(0.5, 3.0))]
        eta: f32,
    },
}

impl Default for Material {
    fn default() -> Self {
        Self::Preset("marble".into())
    }
}

impl Material {
    /// What red, green and blue light meets. None for a name that is not known, or where neither pair of coefficients is complete.
    pub fn coefficients(&self) -> Option<[Coefficients; 3]> {
        let (first, second, g, eta) = match self {
            Self::Preset(name) => return materials::named(name).map(|medium| medium.coefficients()),
            Self::Custom { sigma_a: Some(a), sigma_s: Some(s), g, eta, .. } => {
                (a.as_dvec3(), s.as_dvec3(), g, eta)
            }
            Self::Custom { sigma_t: Some(t), albedo: Some(albedo), g, eta, .. } => {
                let (sigma_t, albedo) = (t.as_dvec3(), albedo.as_dvec3());
                (sigma_t * (1.0 - albedo), sigma_t * albedo, g, eta)
            }
            Self::Custom { .. } => return None,
        };
        Some(std::array::from_fn(|colour| Coefficients {
            sigma_a: first[colour],
            sigma_s: second[colour],
            g: f64::from(*g),
            eta: f64::from(*eta),
        }))
    }
}

fn eta() -> f32 {
    1.3
}

/// How much light a point of light on the surface sends to another.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, PartialEq)]
pub enum DipoleModel {
    /// The directional dipole, scaled to give the right total.
    #[default]
    CalibratedDipole,
    /// The directional dipole as published.
    DirectionalDipole,
    /// The classic dipole, which knows no direction of the light.
    StandardDipole,
}

/// A highlight.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, PartialEq)]
pub struct Specular {
    /// Share of the light in the highlight at normal incidence.
    #[reflect(@Range::new(0.0, 1.0))]
    pub strength: f32,
    /// Blinn's exponent.
    #[reflect(@Range::new(0.0, 10_000.0))]
    pub shininess: f32,
}

impl Default for Specular {
    fn default() -> Self {
        Self { strength: 0.2, shininess: 60.0 }
    }
}
