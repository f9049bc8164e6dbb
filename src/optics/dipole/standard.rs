//! The standard dipole.

use crate::optics::fresnel::diffuse_reflectance_polynomial;
use crate::optics::medium::{Diffusion, Medium};
use std::f64::consts::PI;

/// The dipole of Jensen, Marschner, Levoy and Hanrahan (2001), "A practical model for subsurface light transport": an isotropic source
/// one reduced mean free path below the entry and its negative image, whatever the direction of incidence.
///
/// Its BSSRDF is `R_d(r) / pi` between the Fresnel transmittances at entry and exit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardDipole {
    /// The medium.
    pub diffusion: Diffusion,
    /// `A = (1 + F_dr) / (1 - F_dr)` of the boundary.
    pub a: f64,
}

impl StandardDipole {
    /// As published, with the polynomial of the diffuse Fresnel reflectance; an index of exactly 1 reflects nothing.
    pub fn new(medium: &Medium) -> Self {
        let reflected = if medium.eta == 1.0 {
            0.0
        } else {
            diffuse_reflectance_polynomial(medium.eta).clamp(0.0, 0.999)
        };
        Self { diffusion: medium.diffusion(), a: (1.0 + reflected) / (1.0 - reflected) }
    }

    /// Diffuse reflectance per unit of area at the distance `r` from the entry. 0 in a medium that does not scatter.
    pub fn r_d(&self, r: f64) -> f64 {
        let Diffusion { sigma_s_prime, sigma_t_prime, albedo_prime, d, mu, .. } = self.diffusion;
        if sigma_s_prime <= 0.0 {
            return 0.0;
        }
        let z_r = sigma_t_prime.recip();
        let source = |z: f64| {
            let distance = r.hypot(z);
            z * (1.0 + mu * distance) * (-mu * distance).exp() / distance.powi(3)
        };
        albedo_prime / (4.0 * PI) * (source(z_r) + source(z_r + 4.0 * self.a * d))
    }

    /// Integral of [`Self::r_d`] over the plane (Jensen and Buhler 2002, "A rapid hierarchical rendering technique for translucent materials").
    pub fn total(&self) -> f64 {
        let Diffusion { albedo_prime, one_minus_albedo_prime, .. } = self.diffusion;
        let s = (3.0 * one_minus_albedo_prime).sqrt();
        albedo_prime / 2.0 * (1.0 + (-4.0 / 3.0 * self.a * s).exp()) * (-s).exp()
    }
}
