//! A medium, as the dipoles of `shaders/shared/bssrdf.wgsl` want it.

use crate::components::{DipoleModel, Subsurface};
use crate::mirrors::mirror;
use crate::optics::calibration::{Calibration, calibration};
use crate::optics::dipole::StandardDipole;
use crate::optics::medium::Medium;
use crate::optics::moments::Boundary;
use glam::{DVec3, Vec3};

mirror! {
    /// Mirror of `Medium` in `shaders/shared/bssrdf.wgsl`.
    #[derive(PartialEq)]
    "scattered_radiosity":
    pub(crate) struct MediumUniform as "Medium" {
        sigma_t_prime: Vec3,
        eta: f32,
        mu: Vec3,
        c_phi: f32,
        d_e: Vec3,
        c_e: f32,
        virtual_distance: Vec3,
        least_distance: f32,
        behind: Vec3,
        strength: Vec3,
        calibration_0: Vec3,
        calibration_1: Vec3,
        calibration_2: Vec3,
    }
}

/// The least distance to the real source, in mean free paths. The published model has none, and shines without bound where a lit surface
/// meets one that faces away from it (mu_0 = 0); on a plane this changes nothing up to 75 degrees of incidence.
pub(crate) const LEAST_DISTANCE: f64 = 1.0 / 12.0;

/// The fewest and the most mean free paths to a body's unit of length of which 32 bits hold the square and all that it is multiplied with.
/// With fewer a body shows nothing, and with more light leaves where it entered.
const SCALES: (f64, f64) = (1e-30, 1e15);

/// A model of a material: what it takes a while to find, and does not depend on the size of a body.
#[derive(Clone, Debug)]
pub(crate) struct Dipole {
    media: [Medium; 3],
    model: DipoleModel,
    boundary: Boundary,
    calibrated: [Calibration; 3],
}

impl Dipole {
    /// The model of a mesh. `None` where its material has no meaning.
    pub fn new(subsurface: &Subsurface) -> Option<Self> {
        let media = subsurface.coefficients()?;
        let sound = |Medium { sigma_a, sigma_s, g, eta }: &Medium| {
            [sigma_a, sigma_s, g, eta].iter().all(|value| value.is_finite())
                && sigma_a.min(*sigma_s) >= 0.0
                && *eta > 0.0
        };
        media.iter().all(sound).then(|| Self::of(media, subsurface.model))
    }

    /// The model of media whose lengths are millimetres.
    pub fn of(media: [Medium; 3], model: DipoleModel) -> Self {
        let calibrated = media.map(|medium| match model {
            DipoleModel::CalibratedDipole => calibration(&medium),
            DipoleModel::DirectionalDipole | DipoleModel::StandardDipole => Calibration([1.0, 0.0, 0.0]),
        });
        Self { media, model, boundary: Boundary::exact(media[0].eta), calibrated }
    }

    /// The same for a body whose unit of length has so many millimetres.
    pub fn uniform(&self, least_distance: f64, millimetres: f64) -> MediumUniform {
        let Self { media, model, boundary, calibrated } = self;
        let diffusion = media.map(|medium| lengthened(&medium).diffusion());
        let scale = |c: usize| (diffusion[c].sigma_t_prime * millimetres).clamp(SCALES.0, SCALES.1);
        let per_channel = |value: &dyn Fn(usize) -> f64| DVec3::from(std::array::from_fn(value)).as_vec3();
        let standard = *model == DipoleModel::StandardDipole;
        let pi = std::f64::consts::PI;
        MediumUniform {
            sigma_t_prime: per_channel(&scale),
            eta: boundary.eta as f32,
            mu: per_channel(&|c| (3.0 * diffusion[c].one_minus_albedo_prime).sqrt()),
            c_phi: boundary.c_phi as f32,
            d_e: per_channel(&|c| diffusion[c].d_e * diffusion[c].sigma_t_prime),
            c_e: boundary.c_e as f32,
            virtual_distance: per_channel(&|c| match standard {
                // z_v = z_r + 4 A D.
                true => 1.0 + 4.0 / 3.0 * StandardDipole::new(&media[c]).a,
                false => 2.0 * boundary.a * diffusion[c].d_e * diffusion[c].sigma_t_prime,
            }),
            least_distance: (least_distance * least_distance) as f32,
            behind: per_channel(&|c| (diffusion[c].sigma_t_prime / (3.0 * diffusion[c].sigma_t)).powi(2)),
            strength: per_channel(&|c| {
                let area = scale(c).powi(2);
                match (diffusion[c].sigma_s_prime > 0.0, standard) {
                    (false, _) => 0.0,
                    // Over 4 C_phi(1/eta), so that what leaves in all directions adds up to R_d.
                    (_, true) => area * diffusion[c].albedo_prime / (16.0 * pi * pi * boundary.c_phi_inverse),
                    (_, false) => area / (16.0 * pi * pi * boundary.c_phi_inverse),
                }
            }),
            calibration_0: per_channel(&|c| calibrated[c].0[0]),
            calibration_1: per_channel(&|c| calibrated[c].0[1]),
            calibration_2: per_channel(&|c| calibrated[c].0[2]),
        }
    }
}

/// The medium, or in place of a vacuum one of hardly any absorption: a vacuum has no length to measure others by.
fn lengthened(medium: &Medium) -> Medium {
    Medium {
        sigma_a: if medium.sigma_s * (1.0 - medium.g) > 0.0 {
            medium.sigma_a
        } else {
            medium.sigma_a.max(1e-30)
        },
        ..*medium
    }
}

#[cfg(test)]
mod tests;
