//! One number per wavelength that makes the directional dipole reflect what a medium really reflects.
//!
//! The shape of the directional dipole is good and its energy is not: it reflects a fifth too much of what enters a bright medium and
//! twice too much of what enters a dim one. The calibrated dipole is `max(S_d, 0)` with exact moments of the boundary, times the exact
//! reflectance of a half space over the dipole's. It is this project's and not published.

use super::dipole::{DirectionalDipole, Entry, Exit};
use super::fresnel::{refract, transmittance};
use super::medium::Medium;
use super::quadrature::gauss_legendre;
use super::transport::{HalfSpace, MAX_G};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Least and greatest index of refraction that is told apart.
const ETA: (f64, f64) = (0.3, 4.0);

/// Least cosine inside that the calibration is fitted at: close to the horizon the dipole is far from any parabola.
const LEAST_COSINE_INSIDE: f64 = 0.2;

/// Chebyshev's three nodes between -1 and 1, beside the middle.
const CHEBYSHEV: f64 = 0.866_025_403_784_438_6;

/// How finely a plane is integrated: angles in a quarter, and the length of a panel of eight in the logarithm of distance.
#[derive(Clone, Copy)]
struct Grid {
    angles: usize,
    panel: f64,
}

/// For a ratio that is worth three digits.
const COARSE: Grid = Grid { angles: 24, panel: 2.0 };

/// For five digits, next to the edges of where `S_d` is negative too.
const FINE: Grid = Grid { angles: 64, panel: 0.5 };

/// What the directional dipole is multiplied with, `c0 + c1 c + c2 c²` in the cosine `c` of incidence outside.
///
/// Finite, and not negative at any cosine from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Calibration(pub [f64; 3]);

impl Calibration {
    /// The factor at a cosine of incidence.
    pub fn at(&self, cos: f64) -> f64 {
        let [c0, c1, c2] = self.0;
        c0 + cos * (c1 + cos * c2)
    }

    /// The parabola through a value at the middle of a range and values `CHEBYSHEV` of its half width to either side.
    fn through(middle: f64, half_width: f64, [low, mid, high]: [f64; 3]) -> Self {
        let step = CHEBYSHEV * half_width;
        let (slope, bend) = ((high - low) / (2.0 * step), (high - 2.0 * mid + low) / (2.0 * step * step));
        Self([mid - middle * (slope - middle * bend), slope - 2.0 * middle * bend, bend])
    }

    /// Whether the factor is finite and not negative wherever it may be asked for.
    fn is_sound(&self) -> bool {
        let [_, c1, c2] = self.0;
        let turn = (-c1 / (2.0 * c2)).clamp(0.0, 1.0);
        let turn = if turn.is_nan() { 0.0 } else { turn };
        [0.0, turn, 1.0].iter().all(|cos| self.at(*cos) >= 0.0 && self.at(*cos).is_finite())
    }
}

/// The calibration of a medium at one wavelength: what it reflects over what its directional dipole with exact moments does.
///
/// It is a parabola through the exact ratio at three angles at which the light inside is at a cosine of at least 0.2. Where that would
/// be negative somewhere, as the range of angles that enter a medium of `eta < 1` is narrow, it is a line, or else a constant. It is 0
/// for a medium that does not scatter, or is not made of finite numbers. `eta` is taken to lie within 0.3 and 4, `g` within ± 0.999 with
/// the same reduced scattering.
pub fn calibration(medium: &Medium) -> Calibration {
    let Some(medium) = presentable(medium) else { return Calibration::default() };
    let (dipole, half_space) = (DirectionalDipole::new(&medium), HalfSpace::new(&medium, streams(&medium)));
    let lowest = cosine_outside(LEAST_COSINE_INSIDE, medium.eta);
    let (middle, half_width) = (0.5 * (1.0 + lowest), 0.5 * (1.0 - lowest));
    let ratio = |place: f64| {
        let cos = middle + place * half_width;
        // Power that enters cancels.
        half_space.reflectance_of_entered(cos) / reflectance_of_entered(&dipole, cos, COARSE)
    };
    let [low, mid, high] = [ratio(-CHEBYSHEV), ratio(0.0), ratio(CHEBYSHEV)];
    let fits = [[low, mid, high], [low, 0.5 * (low + high), high], [mid; 3]];
    let mut sound = fits.into_iter().map(|values| Calibration::through(middle, half_width, values));
    sound.find(Calibration::is_sound).unwrap_or_default()
}

/// What a half space of `medium` reflects of beams at some cosines outside, Fresnel's reflection at its surface excluded: by
/// adding and doubling, within 0.0001.
pub fn exact_reflectance(medium: &Medium, cosines: &[f64]) -> Vec<f64> {
    let Some(medium) = presentable(medium) else { return vec![0.0; cosines.len()] };
    let half_space = HalfSpace::new(&medium, 2 * streams(&medium));
    cosines.iter().map(|cos| half_space.reflectance(*cos)).collect()
}

/// What a plane reflects of a beam at a cosine outside by the directional dipole: `T12 4 pi C_phi(1 / eta)` times the integral of
/// `max(S_d, 0)` over the plane. It may be more than 1.
pub fn directional_reflectance(dipole: &DirectionalDipole, cos: f64) -> f64 {
    let entering = transmittance(cos, dipole.boundary.eta);
    if entering > 0.0 && dipole.diffusion.sigma_s_prime > 0.0 {
        entering * reflectance_of_entered(dipole, cos, FINE)
    } else {
        0.0
    }
}

/// The same for power that has entered.
///
/// The integral over distances is by their logarithm, from where the integrand is flat to where it has died out or falls as the inverse
/// cube. Only half of the plane is seen, the other is alike; each quarter apart, for `d_r` may have a kink along the ray.
fn reflectance_of_entered(dipole: &DirectionalDipole, cos: f64, grid: Grid) -> f64 {
    let incident = DVec3::new(((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt(), 0.0, cos);
    let Some(direction) = refract(incident, DVec3::Z, dipole.boundary.eta) else { return 0.0 };
    let entry = Entry { position: DVec3::ZERO, normal: DVec3::Z, direction };
    let length = dipole.diffusion.sigma_t_prime.recip();
    let quarter = gauss_legendre(grid.angles, 0.0, PI / 2.0).into_iter();
    let directions: Vec<(DVec2, f64)> = quarter
        .map(|(angle, weight)| (DVec2::from_angle(angle), weight))
        .flat_map(|(at, weight)| [(at, weight), (DVec2::new(-at.x, at.y), weight)])
        .collect();
    // r times the integral over a ring; distances are in reduced mean free paths.
    let ring = |r: f64| {
        let s_d = |at: DVec2| {
            let exit = Exit { position: (at * (r * length)).extend(0.0), normal: DVec3::Z };
            dipole.s_d(&entry, &exit).max(0.0)
        };
        2.0 * r * r * directions.iter().map(|(at, weight)| weight * s_d(*at)).sum::<f64>()
    };
    let mu = (3.0 * dipole.diffusion.one_minus_albedo_prime).sqrt();
    let (near, far) = (1e-3 * (-direction.z).max(1e-6), (60.0 / mu).min(1e7));
    let (start, end) = (near.ln(), far.ln());
    let panels = ((end - start) / grid.panel).ceil() as usize;
    let step = (end - start) / panels as f64;
    let panel = |index: usize| {
        let low = start + index as f64 * step;
        gauss_legendre(8, low, low + step)
            .into_iter()
            .map(|(at, weight)| weight * ring(at.exp()))
            .sum::<f64>()
    };
    let sum = 0.5 * ring(near) + (0..panels).map(panel).sum::<f64>() + ring(far);
    4.0 * PI * dipole.boundary.c_phi_inverse * sum * length * length
}

/// A medium in units of its reduced mean free path and within what can be told apart; nothing if it does not scatter.
fn presentable(medium: &Medium) -> Option<Medium> {
    let Medium { sigma_a, sigma_s, g, eta } = *medium;
    if ![sigma_a, sigma_s, g, eta].iter().all(|value| value.is_finite()) {
        return None;
    }
    let told_apart = g.clamp(-MAX_G, MAX_G);
    // What is reduced stays.
    let sigma_s = if told_apart == g { sigma_s } else { sigma_s * (1.0 - g) / (1.0 - told_apart) };
    let (sigma_a, sigma_s, g) = (sigma_a.max(0.0), sigma_s.max(0.0), told_apart);
    let sigma_t_prime = sigma_s * (1.0 - g) + sigma_a;
    let scaled = Medium {
        sigma_a: sigma_a / sigma_t_prime,
        sigma_s: sigma_s / sigma_t_prime,
        g,
        eta: eta.clamp(ETA.0, ETA.1),
    };
    (sigma_s > 0.0 && scaled.sigma_s > 0.0 && scaled.sigma_s.is_finite()).then_some(scaled)
}

/// Streams enough for a thousandth: a phase function that points forward takes more.
fn streams(medium: &Medium) -> usize {
    if medium.g.abs() > 0.5 { 32 } else { 20 }
}

/// Cosine outside of a ray at a cosine inside; 0 if there is none.
fn cosine_outside(inside: f64, eta: f64) -> f64 {
    (1.0 - eta * eta * (1.0 - inside * inside)).max(0.0).sqrt()
}
