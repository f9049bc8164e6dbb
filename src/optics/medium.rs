//! A scattering medium at one wavelength, and what diffusion theory makes of it.

/// Least reduced albedo that `d_e` is derived from. Below it the dipoles are far too bright and mean nothing, but stay finite.
pub const MIN_ALBEDO_PRIME: f64 = 1e-4;

/// A homogeneous medium at one wavelength. Coefficients are per unit of length, of any unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Absorption coefficient.
    pub sigma_a: f64,
    /// Scattering coefficient, not reduced.
    pub sigma_s: f64,
    /// Mean cosine of scattering: 1 straight on, -1 straight back.
    pub g: f64,
    /// Index of refraction inside over that outside.
    pub eta: f64,
}

/// Coefficients of diffusion theory, in the unit of their [`Medium`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffusion {
    /// Absorption coefficient.
    pub sigma_a: f64,
    /// Extinction coefficient `sigma_s + sigma_a`, not reduced.
    pub sigma_t: f64,
    /// Reduced scattering coefficient `sigma_s (1 - g)`.
    pub sigma_s_prime: f64,
    /// Reduced extinction coefficient `sigma_s_prime + sigma_a`.
    pub sigma_t_prime: f64,
    /// Reduced albedo `sigma_s_prime / sigma_t_prime`; 0 in a vacuum.
    pub albedo_prime: f64,
    /// What the reduced albedo lacks to 1, as `sigma_a / sigma_t_prime`: a difference would lose it in bright media.
    pub one_minus_albedo_prime: f64,
    /// Diffusion coefficient `D = 1 / (3 sigma_t_prime)`; infinite in a vacuum.
    pub d: f64,
    /// Effective transport coefficient `mu = sqrt(sigma_a / D)`.
    pub mu: f64,
    /// Extrapolation distance `d_e = 2.131 D / sqrt(albedo_prime)` of the directional dipole, of no less than [`MIN_ALBEDO_PRIME`].
    pub d_e: f64,
}

impl Medium {
    /// What diffusion theory needs to know, as Frisvad, Hachisuka and Kjeldsen (2014), "Directional dipole model for subsurface
    /// scattering", define it.
    pub fn diffusion(&self) -> Diffusion {
        let Self { sigma_a, sigma_s, g, .. } = *self;
        let sigma_s_prime = sigma_s * (1.0 - g);
        let sigma_t_prime = sigma_s_prime + sigma_a;
        let share =
            |part: f64, of_vacuum: f64| if sigma_t_prime > 0.0 { part / sigma_t_prime } else { of_vacuum };
        let albedo_prime = share(sigma_s_prime, 0.0);
        let d = (3.0 * sigma_t_prime).recip();
        Diffusion {
            sigma_a,
            sigma_t: sigma_s + sigma_a,
            sigma_s_prime,
            sigma_t_prime,
            albedo_prime,
            one_minus_albedo_prime: share(sigma_a, 1.0),
            d,
            mu: (3.0 * sigma_a).sqrt() * sigma_t_prime.sqrt(),
            d_e: 2.131 * d / albedo_prime.max(MIN_ALBEDO_PRIME).sqrt(),
        }
    }
}
