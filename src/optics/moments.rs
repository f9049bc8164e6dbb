//! What a boundary does to diffuse light: moments of Fresnel's reflectance as seen from inside, and the numbers that the dipoles
//! derive of them.

use super::fresnel::reflectance;
use super::quadrature::gauss_legendre;

/// Boundary terms of the dipoles for one relative index of refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Index of refraction inside over that outside.
    pub eta: f64,
    /// `C_phi(eta) = (1 - 2 C1) / 4`: weight of the fluence in what leaves.
    pub c_phi: f64,
    /// `C_E(eta) = (1 - 3 C2) / 2`: weight of the flux in what leaves.
    pub c_e: f64,
    /// `A = (1 - C_E) / (2 C_phi)`: how far outside the extrapolated boundary lies, in units of its distance without a mismatch.
    pub a: f64,
    /// `C_phi(1 / eta)`: four of it is the diffuse transmittance from outside.
    pub c_phi_inverse: f64,
}

impl Boundary {
    /// From exact moments, by quadrature.
    pub fn exact(eta: f64) -> Self {
        Self::of(eta, two_c1(eta), three_c2(eta), two_c1(eta.recip()))
    }

    /// From the polynomials of d'Eon and Irving (2011), "A quantized-diffusion model for rendering translucent materials", as the
    /// published directional dipole has them.
    ///
    /// Within 0.005 of the exact moments up to an index of 2.4. At 1 they are not 0 (A is 0.9975), and beyond 2.5 the quintic runs off:
    /// `c_phi` is negative from about 2.9 on. Use [`Boundary::exact`] where [`Boundary::fit_holds`] answers no.
    pub fn fit(eta: f64) -> Self {
        Self::of(eta, two_c1_fit(eta), three_c2_fit(eta), two_c1_fit(eta.recip()))
    }

    /// Whether the polynomials of [`Boundary::fit`] mean anything at an index: from 0.4 to 2.5.
    pub fn fit_holds(eta: f64) -> bool {
        (0.4..=2.5).contains(&eta)
    }

    fn of(eta: f64, two_c1: f64, three_c2: f64, two_c1_inverse: f64) -> Self {
        let (c_phi, c_e) = ((1.0 - two_c1) / 4.0, (1.0 - three_c2) / 2.0);
        Self { eta, c_phi, c_e, a: (1.0 - c_e) / (2.0 * c_phi), c_phi_inverse: (1.0 - two_c1_inverse) / 4.0 }
    }
}

/// `2 C1`: the share of diffuse light inside a medium of index `eta` that its boundary reflects, twice the integral of `F(mu) mu`.
pub fn two_c1(eta: f64) -> f64 {
    2.0 * moment(eta, 1)
}

/// `3 C2`: three times the integral of `F(mu) mu²`, light inside a medium of index `eta`.
pub fn three_c2(eta: f64) -> f64 {
    3.0 * moment(eta, 2)
}

/// Integral of `F(mu) mu^power` over the cosines `mu` from 0 to 1 inside.
///
/// With `s² = |1/eta² - 1|` the refracted cosine is a square root of `mu² ± s²`. Setting `mu = s sinh x`, or `s cosh x` beyond the
/// critical angle, leaves nothing but smooth functions of x, at any index.
fn moment(eta: f64, power: i32) -> f64 {
    if eta == 1.0 {
        return 0.0;
    }
    let n = eta.recip();
    let s = ((n - 1.0) * (n + 1.0)).abs().sqrt();
    let total = eta > 1.0;
    let end = if total { 0.5 * ((eta + 1.0) / (eta - 1.0)).ln() } else { s.recip().asinh() };
    // Within the critical angle all is reflected.
    let reflected = if total { s.powi(power + 1) / f64::from(power + 1) } else { 0.0 };
    let smooth = gauss_legendre(64, 0.0, end).into_iter().map(|(x, weight)| {
        let (sinh, cosh) = (x.sinh(), x.cosh());
        let (mu, slope) = if total { (s * cosh, s * sinh) } else { (s * sinh, s * cosh) };
        weight * slope * reflectance(mu, n) * mu.powi(power)
    });
    reflected + smooth.sum::<f64>()
}

/// d'Eon and Irving's fit of [`two_c1`].
fn two_c1_fit(eta: f64) -> f64 {
    if eta < 1.0 {
        polynomial(&[0.919317, -3.4793, 6.75335, -7.80989, 4.98554, -1.36881], eta)
    } else {
        polynomial(&[-9.23372, 22.2272, -20.9292, 10.2291, -2.54396, 0.254913], eta)
    }
}

/// d'Eon and Irving's fit of [`three_c2`].
fn three_c2_fit(eta: f64) -> f64 {
    if eta < 1.0 {
        polynomial(&[0.828421, -2.62051, 3.36231, -1.95284, 0.236494, 0.145787], eta)
    } else {
        let falling = polynomial(&[-1641.1, 1376.53, -656.175, 135.926], eta.recip());
        falling + eta * polynomial(&[1213.67, -568.556, 164.798, -27.0181, 1.91826], eta)
    }
}

/// Horner's rule, lowest power first.
fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}
