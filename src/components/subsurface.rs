use super::{
    AlsoCalled, ChooseVariant, Names, Phong, Range, ReflectChooseVariant, Rgb, ScatteringMaps, Slider, Unit,
    Validate, attributes::ReflectValidate,
};
use crate::optics::{materials, medium::Medium};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::Vec3;

/// A translucent mesh: light enters it, is scattered inside and leaves elsewhere.
///
/// | field | type | range | default |
/// |---|---|---|---|
/// | `material` | a [`Material`]: `Preset(name)` or `Custom(coefficients)`, per mm | – | `Preset("marble")` |
/// | `g` | `None`, or the mean cosine of scattering of a `Preset` | -1 to 1 | `None` |
/// | `model` | `CalibratedDipole`, `DirectionalDipole` or `StandardDipole` | – | `CalibratedDipole` |
/// | `specular` | `None`, or `(strength, shininess)` of a white highlight on the surface | 0 to 1; 0 to 10,000 | `None` |
/// | `local` | [`Phong`]: the look while [`Shading`](super::Shading) is `Local` | as in `Phong` | `()` |
///
/// It belongs beside a [`Mesh`](super::Mesh), closed and with its normals outwards: what it encloses is the medium. A [`Phong`] beside
/// it plays no part. How finely the light is computed is in [`ScatteringMaps`].
///
/// The presets were measured as reduced coefficients, sigma_s (1 - g), from which nobody can tell how light is scattered in them: they count as
/// media that scatter evenly. `g` says otherwise and keeps the reduced coefficient, so sigma_s is as much greater as `g` is closer to 1 (beyond
/// 0.999999 as there). That leaves most of the picture as it is: only what depends on the extinction itself changes, the light that comes out
/// behind thin parts and beyond edges. `Custom` has a `g` of its own.
///
/// Where light enters and leaves, the surface is smooth and refracts by `eta`. The light that it reflects without entering is no part
/// of `model`: `specular` adds it as the highlight of a `Phong` whose `specular` is `strength` in all three colours.
///
/// Like every component it can be kept in a file of its own: `Subsurface: File("materials/cream.ron")`.
///
/// ```ron
/// Subsurface: (material: Preset("marble"), model: CalibratedDipole, specular: Some((strength: 0.2, shininess: 60.0)))
/// Subsurface: (material: Preset("skin"), g: Some(0.8))
/// Subsurface: (material: Custom(sigma_a: (0.002, 0.004, 0.007), sigma_s: (2.2, 2.6, 3.0), eta: 1.5))
/// Subsurface: (material: Custom(sigma_t: (3.0, 3.0, 3.0), albedo: (0.99, 0.9, 0.6), g: 0.6), local: (diffuse: (0.8, 0.7, 0.5)))
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq, Validate)]
#[reflect(@AlsoCalled(&["Material", "Translucent", "Translucency", "SubsurfaceScattering", "Bssrdf", "Sss", "Skin", "Wax", "Marble"]))]
#[require(ScatteringMaps)]
pub struct Subsurface {
    /// What the mesh is filled with.
    pub material: Material,
    /// Mean cosine of scattering in a medium by name, the reduced scattering of which stays as it is.
    #[reflect(@Range::new(-1.0, 1.0))]
    pub g: Option<f32>,
    /// How the scattered light is computed.
    pub model: DipoleModel,
    /// The highlight on the surface.
    pub specular: Option<Specular>,
    /// What the mesh looks like while its shading is `Local`.
    pub local: Phong,
}

/// The greatest mean cosine of scattering that the scattering coefficient of a medium by name is derived from: there it is a million times the
/// reduced one.
const MOST_G: f64 = 1.0 - 1e-6;

impl Subsurface {
    /// What red, green and blue light meets inside the mesh. None where the material has no meaning, see [`Material::coefficients`].
    pub fn coefficients(&self) -> Option<[Medium; 3]> {
        let media = self.material.coefficients()?;
        let (Some(g), Material::Preset(_)) = (self.g, &self.material) else { return Some(media) };
        let g = f64::from(g).min(MOST_G);
        Some(media.map(|medium| Medium {
            sigma_s: medium.sigma_s * (1.0 - medium.g) / (1.0 - g),
            g,
            ..medium
        }))
    }
}

impl Validate for Subsurface {
    fn problems(&self) -> Vec<(&'static str, String)> {
        match (self.g, &self.material) {
            (Some(g), Material::Custom { .. }) => {
                let message = format!(
                    "`g` beside `Custom` belongs into it: write `Custom(…, g: {g})`; this one is for a `Preset`"
                );
                vec![("g", message)]
            }
            _ => Vec::new(),
        }
    }
}

/// A homogeneous medium, by name or by its coefficients.
///
/// | variant | field | unit | range | default |
/// |---|---|---|---|---|
/// | `Preset(name)` | one of the names in [`materials::NAMES`], small or capital | – | – | – |
/// | `Custom` | `sigma_a`: absorption, (r, g, b) | per mm | 0 to 1e12 | – |
/// | | `sigma_s`: scattering, (r, g, b), not reduced | per mm | 0 to 1e12 | – |
/// | | `sigma_t`: extinction, (r, g, b) | per mm | 0 to 1e12 | – |
/// | | `albedo`: the share of `sigma_t` that is scattering, (r, g, b) | – | 0 to 1 | – |
/// | | `g`: mean cosine of the scattering angle | – | -1 to 1 | 0 |
/// | | `eta`: index of refraction, inside over outside | – | 0.5 to 3 | 1.3 |
///
/// A custom medium is written with `sigma_a` and `sigma_s`, or with `sigma_t` and `albedo`; both of the one pair and none of the other.
/// The millimetre is the scene's: [`SceneSettings::millimetres_per_unit`](super::SceneSettings) says how many make a unit.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, PartialEq, Validate, ChooseVariant)]
pub enum Material {
    /// One of [`materials::MEDIA`], by name.
    Preset(#[reflect(@Names { of: "medium", known: &materials::NAMES })] String),
    /// By its coefficients: `sigma_a` and `sigma_s`, or `sigma_t` and `albedo`.
    Custom {
        /// Absorption.
        #[reflect(default, @Range::new(0.0, 1e12), @Slider::logarithmic(1e-4, 1e3), @Unit("per mm"), @Rgb::Coefficients)]
        sigma_a: Option<Vec3>,
        /// Scattering, not reduced.
        #[reflect(default, @Range::new(0.0, 1e12), @Slider::logarithmic(1e-4, 1e3), @Unit("per mm"), @Rgb::Coefficients)]
        sigma_s: Option<Vec3>,
        /// Extinction, which is absorption and scattering together.
        #[reflect(default, @Range::new(0.0, 1e12), @Slider::logarithmic(1e-4, 1e3), @Unit("per mm"), @Rgb::Coefficients)]
        sigma_t: Option<Vec3>,
        /// The share of the extinction that is scattering.
        #[reflect(default, @Range::new(0.0, 1.0), @Rgb::Colour)]
        albedo: Option<Vec3>,
        /// Mean cosine of the scattering angle.
        #[reflect(default, @Range::new(-1.0, 1.0))]
        g: f32,
        /// Index of refraction relative to the outside.
        #[reflect(default = "eta", @Range::new(0.5, 3.0), @Slider::linear(1.0, 2.0))]
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
    pub fn coefficients(&self) -> Option<[Medium; 3]> {
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
        Some(std::array::from_fn(|colour| Medium {
            sigma_a: first[colour],
            sigma_s: second[colour],
            g: f64::from(*g),
            eta: f64::from(*eta),
        }))
    }
}

impl Validate for Material {
    fn problems(&self) -> Vec<(&'static str, String)> {
        let Self::Custom { sigma_a, sigma_s, sigma_t, albedo, .. } = self else { return Vec::new() };
        let written = |pair: [(&'static str, &Option<Vec3>); 2]| -> Vec<&'static str> {
            pair.into_iter().filter(|(_, value)| value.is_some()).map(|(name, _)| name).collect()
        };
        let first = written([("sigma_a", sigma_a), ("sigma_s", sigma_s)]);
        let second = written([("sigma_t", sigma_t), ("albedo", albedo)]);
        let either = "`sigma_a` and `sigma_s`, or `sigma_t` and `albedo`";
        match (&first[..], &second[..]) {
            ([_, _], []) | ([], [_, _]) => Vec::new(),
            ([], []) => vec![("", format!("a medium needs {either}; found none of them"))],
            ([one], []) | ([], [one]) => {
                let missing = match *one {
                    "sigma_a" => "sigma_s",
                    "sigma_s" => "sigma_a",
                    "sigma_t" => "albedo",
                    _ => "sigma_t",
                };
                vec![(one, format!("`{one}` needs `{missing}` beside it: a medium is {either}"))]
            }
            _ => {
                let (one, other) = (second[0], first[0]);
                vec![(one, format!("`{one}` cannot stand beside `{other}`: a medium is {either}"))]
            }
        }
    }
}

/// A medium by name becomes custom with the coefficients that it has, since a custom one without any is none.
impl ChooseVariant for Material {
    fn chosen(&self, variant: &str) -> Option<Box<dyn Reflect>> {
        let [red, green, blue] = self.coefficients().filter(|_| variant == "Custom")?;
        let each =
            |of: fn(&Medium) -> f64| Some(Vec3::from([&red, &green, &blue].map(|medium| of(medium) as f32)));
        Some(Box::new(Self::Custom {
            sigma_a: each(|medium| medium.sigma_a),
            sigma_s: each(|medium| medium.sigma_s),
            sigma_t: None,
            albedo: None,
            g: red.g as f32,
            eta: red.eta as f32,
        }))
    }
}

fn eta() -> f32 {
    1.3
}

/// How the light that enters at one point of a surface is taken to leave at others: what a model costs and gets wrong.
///
/// | model | what it is | what it gets wrong |
/// |---|---|---|
/// | `StandardDipole` | Jensen et al. 2001, eq. 4: two point sources | the direction of the light, which plays no part; the light near its entry |
/// | `DirectionalDipole` | Frisvad, Hachisuka & Kjeldsen 2014: a ray source and its image | the total: a fifth to a third too bright where little is absorbed, more where much is |
/// | `CalibratedDipole` | the same, times the number for each colour that gives a half space its exact total | not published; the surface is still taken to be flat |
///
/// Two deviations from what is published. The distance to the real ray source is at least 1/12 of a mean free path, because where a lit
/// surface meets one that faces away from the light the model shines without bound; with `eta` 1.3 and more that changes nothing on a
/// plane, with `eta` 1 it darkens light that arrives beyond 75 degrees (3 % at 80). And what the standard dipole sends out is divided by the
/// diffuse transmittance of the surface, so that R_d is what leaves a half space in all directions together. Light that crosses the body
/// without scattering once (S_dE of the directional dipole) is left out; it is negligible beyond ten mean free paths.
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

/// A white highlight, as of [`Phong`].
///
/// | field | type | range | default |
/// |---|---|---|---|
/// | `strength` | share of the light in the highlight at normal incidence | 0 to 1 | 0.2 |
/// | `shininess` | Blinn's exponent | 0 to 10,000 | 60 |
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, PartialEq)]
pub struct Specular {
    /// Share of the light in the highlight at normal incidence.
    #[reflect(@Range::new(0.0, 1.0))]
    pub strength: f32,
    /// Blinn's exponent.
    #[reflect(@Range::new(0.0, 10_000.0), @Slider::logarithmic(1.0, 10_000.0))]
    pub shininess: f32,
}

impl Default for Specular {
    fn default() -> Self {
        Self { strength: 0.2, shininess: 60.0 }
    }
}
