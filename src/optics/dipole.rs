//! Dipoles: subsurface scattering between two points of a surface, as by a source inside and its negative image outside.
//!
//! The directional dipole is Frisvad, Hachisuka and Kjeldsen (2014), "Directional dipole model for subsurface scattering"; its terms
//! were checked against derivatives of the ray source's fluence. It holds no factor of albedo: a ray source has unit power, so a bright
//! medium reflects more than it receives. [`super::calibration`] mends that; the formula here is the published one.

use super::medium::{Diffusion, Medium};
use super::moments::Boundary;
use glam::DVec3;
use std::f64::consts::PI;

mod standard;

pub use standard::StandardDipole;

/// Sine of the angle between the way to the exit and the normal below which the two count as parallel.
const PARALLEL: f64 = 1e-6;

/// Where light enters a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// The point `x_i`.
    pub position: DVec3,
    /// Unit normal `n_i`, pointing out.
    pub normal: DVec3,
    /// Unit direction `omega_12` of the refracted light, into the medium.
    pub direction: DVec3,
}

/// Where light leaves a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// The point `x_o`.
    pub position: DVec3,
    /// Unit normal `n_o`, pointing out.
    pub normal: DVec3,
}

/// The directional dipole of one medium at one wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalDipole {
    /// The medium.
    pub diffusion: Diffusion,
    /// Its boundary, of exact or of fitted moments.
    pub boundary: Boundary,
    /// Lower bound of the distance `d_r` to the real source, in the unit of the medium; 0 as published. The model grows as `1 / d_r³`
    /// next to convex edges, where a lit side meets another: a bound such as `diffusion.d` keeps that finite.
    pub least_distance: f64,
}

/// What lies between the arguments and the value of the directional dipole. Distances are in the unit of the medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms {
    /// `n*`: normal of the plane that the source is mirrored in.
    pub n_star: DVec3,
    /// Whether the exit is at the entry or straight along its normal, where `n*` falls back to that normal.
    pub degenerate: bool,
    /// `mu0 = -n_o . omega_12`: positive where the exit faces the refracted light's source.
    pub mu0: f64,
    /// Distance to the real source.
    pub d_r: f64,
    /// Distance to the virtual source.
    pub d_v: f64,
    /// `S'` of the real source.
    pub s_real: f64,
    /// `S'` of the virtual source.
    pub s_virtual: f64,
}

/// Geometry of a pair of points, lengths in reduced mean free paths.
struct Pair {
    /// From the entry to the exit.
    x: DVec3,
    w: DVec3,
    n_o: DVec3,
    n_star: DVec3,
    degenerate: bool,
    mu0: f64,
    /// Twice the distance between the entry and the mirror: `2 A d_e`.
    h: f64,
    /// `d_r² - |x|²`.
    z2: f64,
    d_r: f64,
    d_v: f64,
}

/// The diffusion coefficient where lengths are in reduced mean free paths.
const D: f64 = 1.0 / 3.0;

impl DirectionalDipole {
    /// The dipole as published but for exact moments of the boundary.
    pub fn new(medium: &Medium) -> Self {
        Self { diffusion: medium.diffusion(), boundary: Boundary::exact(medium.eta), least_distance: 0.0 }
    }

    /// The diffuse part `S_d = S'(x, omega_12, d_r) - S'(x_o - x_v, omega_v, d_v)` of the BSSRDF without the Fresnel transmittances
    /// at entry and exit, per unit of area and steradian. 0 in a medium that does not scatter.
    ///
    /// It can be negative, where the model has no meaning: clamp it, per wavelength. The difference is taken term by term: real and
    /// virtual part agree in most digits far from the entry.
    pub fn s_d(&self, entry: &Entry, exit: &Exit) -> f64 {
        let Diffusion { sigma_s_prime, sigma_t_prime, .. } = self.diffusion;
        if sigma_s_prime <= 0.0 {
            return 0.0;
        }
        let pair = self.pair(entry, exit);
        let value =
            if pair.degenerate { self.s_real(&pair) - self.s_virtual(&pair) } else { self.difference(&pair) };
        value * sigma_t_prime * sigma_t_prime
    }

    /// The terms that [`Self::s_d`] is made of. In a medium that does not scatter they mean nothing.
    pub fn terms(&self, entry: &Entry, exit: &Exit) -> Terms {
        let pair = self.pair(entry, exit);
        let sigma_t_prime = self.diffusion.sigma_t_prime;
        Terms {
            n_star: pair.n_star,
            degenerate: pair.degenerate,
            mu0: pair.mu0,
            d_r: pair.d_r / sigma_t_prime,
            d_v: pair.d_v / sigma_t_prime,
            s_real: self.s_real(&pair) * sigma_t_prime * sigma_t_prime,
            s_virtual: self.s_virtual(&pair) * sigma_t_prime * sigma_t_prime,
        }
    }

    /// Places the sources: the real one along the refracted light, the virtual one mirrored in a plane along the way to the exit.
    fn pair(&self, entry: &Entry, exit: &Exit) -> Pair {
        let Diffusion { sigma_t, sigma_t_prime, d_e, .. } = self.diffusion;
        let (w, n_o) = (entry.direction, exit.normal);
        let x = (exit.position - entry.position) * sigma_t_prime;
        let r2 = x.length_squared();
        let across = entry.normal.cross(x.normalize_or_zero());
        let degenerate = across.length() < PARALLEL;
        let n_star = if degenerate {
            entry.normal
        } else {
            let x_hat = x.normalize();
            x_hat.cross(across).normalize()
        };
        let d_e = d_e * sigma_t_prime;
        let h = 2.0 * self.boundary.a * d_e;
        let mu0 = -n_o.dot(w);
        let z2 = if mu0 > 0.0 {
            let minus_cos_b = x.cross(w).length() / (r2 + d_e * d_e).sqrt();
            D * mu0 * (D * mu0 + 2.0 * d_e * minus_cos_b)
        } else {
            // Not reduced, unlike everything else: so it is published.
            (sigma_t_prime / (3.0 * sigma_t)).powi(2)
        };
        let z2 = z2.max((self.least_distance * sigma_t_prime).powi(2) - r2);
        let d_v = if degenerate { (x - n_star * h).length() } else { (r2 + h * h).sqrt() };
        Pair { x, w, n_o, n_star, degenerate, mu0, h, z2, d_r: (r2 + z2).sqrt(), d_v }
    }

    /// `S'` of the real source, per squared reduced mean free path.
    fn s_real(&self, pair: &Pair) -> f64 {
        self.ray_source(pair.x, pair.w, pair.n_o, pair.d_r)
    }

    /// `S'` of the virtual source, per squared reduced mean free path.
    fn s_virtual(&self, pair: &Pair) -> f64 {
        let w = pair.w - pair.n_star * (2.0 * pair.w.dot(pair.n_star));
        self.ray_source(pair.x - pair.n_star * pair.h, w, pair.n_o, pair.d_v)
    }

    /// `S'(x, w, rho)`: what a ray source emits through the boundary, `rho` standing in for the length of x.
    fn ray_source(&self, x: DVec3, w: DVec3, n_o: DVec3, rho: f64) -> f64 {
        let Boundary { c_phi, c_e, .. } = self.boundary;
        let mu_rho = self.mu() * rho;
        let (xw, wn, xn) = (x.dot(w), w.dot(n_o), x.dot(n_o));
        let one = 1.0 + mu_rho;
        let fluence = rho * rho / D + 3.0 * one * xw;
        let flux =
            3.0 * D * one * wn - (one + 3.0 * D * (3.0 * one + mu_rho * mu_rho) / (rho * rho) * xw) * xn;
        self.scale() * (-mu_rho).exp() / rho.powi(3) * (c_phi * fluence - c_e * flux)
    }

    /// The difference of both sources. With `f1 = e^-mu d / d`, `f3 = (1 + mu d) e^-mu d / d³` and
    /// `f5 = (3 (1 + mu d) + (mu d)²) e^-mu d / d⁵` a source is `C_phi / D f1 + G f3 + 3 D C_E H f5`; each of the five is subtracted
    /// in closed form, and `d_v - d_r` from the squares.
    fn difference(&self, pair: &Pair) -> f64 {
        let Pair { x, w, n_o, n_star, h, z2, d_r, d_v, .. } = *pair;
        let Boundary { c_phi, c_e, .. } = self.boundary;
        let mu = self.mu();
        let e = (-mu * d_r).exp();
        if e == 0.0 {
            return 0.0;
        }
        let squares = h * h - z2;
        let delta = squares / (d_v + d_r);
        let lost = (-mu * delta).exp_m1();
        let (product, sum) = (d_r * d_v, d_v * d_v + d_r * d_r);
        let (p2, one_v, mu_v) = (sum + product, 1.0 + mu * d_v, mu * d_v);
        let p4 = sum * sum - product * product + product * sum;
        let five_v = 3.0 * one_v + mu_v * mu_v;

        let f1 = e / d_v * (delta / d_r - lost);
        let f3 =
            e * (delta * p2 / product.powi(3) + mu * squares / product.powi(2) - lost * one_v / d_v.powi(3));
        let f5 = e
            * (3.0 * delta * p4 / product.powi(5)
                + 3.0 * mu * squares * sum / product.powi(4)
                + mu * mu * delta * p2 / product.powi(3)
                - lost * five_v / d_v.powi(5));
        let e_v = e * (1.0 + lost);
        let (f3_v, f5_v) = (one_v * e_v / d_v.powi(3), five_v * e_v / d_v.powi(5));

        let (xw, wn, xn) = (x.dot(w), w.dot(n_o), x.dot(n_o));
        let (ws, nn) = (w.dot(n_star), n_star.dot(n_o));
        let g = 3.0 * c_phi * xw - 3.0 * D * c_e * wn + c_e * xn;
        let g_less = -3.0 * c_phi * h * ws - 6.0 * D * c_e * ws * nn + c_e * h * nn;
        let h_less = h * nn * (xw + h * ws) - h * ws * xn;
        let source = c_phi / D * f1 + g * f3 + g_less * f3_v;
        self.scale() * (source + 3.0 * D * c_e * (xw * xn * f5 + h_less * f5_v))
    }

    /// `mu` where lengths are in reduced mean free paths.
    fn mu(&self) -> f64 {
        (3.0 * self.diffusion.one_minus_albedo_prime).sqrt()
    }

    /// What both sources share: `1 / (4 C_phi(1 / eta)) / (4 pi²)`.
    fn scale(&self) -> f64 {
        (16.0 * PI * PI * self.boundary.c_phi_inverse).recip()
    }
}
