//! Light that is scattered however often: what does not escape diffuses.
//!
//! Of the light that a place scatters, the share `e`, the mean over all directions of the transmittance from there to the outside, leaves the
//! medium without being scattered again. It is all that is ever seen of that place. The rest is scattered again nearby, as far away as light
//! diffuses. So the fluence `phi` of scattered light is that of
//!
//! ```text
//! -div (D grad phi) + (sigma_a + e sigma_s) phi = (1 - e_0) sigma_s E T        D = 1 / (3 sigma_t (1 - albedo g))
//! ```
//!
//! with no flux through the surface of the medium, and `e_0` as `e`, but for light that comes straight from the beam `E T`. Diffusion
//! moves light and neither makes nor loses any: what a beam loses is absorbed, or seen as light scattered once, `e_0 sigma_s E T`, or as light
//! scattered more often, `e sigma_s phi`. Whatever `D` is, nothing returns more light than it receives, in a medium of any shape; and where
//! it is thin, or `D` means little, what is seen is nearly right for that reason alone. Common diffusion has light leave by a condition at the
//! surface instead (Ishimaru 1978, "Wave Propagation and Scattering in Random Media", chapter 9), which knows none of both and wants a surface.
//!
//! A forward peak of the phase function counts as no scattering, neither of the beam nor of what is seen: [`Peak`].

use super::peak::Peak;
use super::phase::henyey_greenstein;
use super::quadrature::gauss_legendre;
use std::f64::consts::{PI, TAU};

/// By how much what escapes falls along a beam, per optical depth, as a multiple of its mean direction: twice the cosine with the normal of a
/// plane surface, just below it.
pub const FALL: f64 = 3.0;

/// A homogeneous slab, lit at the cosine `mu0` to its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// Optical thickness.
    pub tau: f64,
    /// Scattering by extinction.
    pub albedo: f64,
    /// Mean cosine of the phase function.
    pub g: f64,
    /// Cosine between light and normal, above 0.
    pub mu0: f64,
}

/// Directions of the radiance on each side, and azimuths around each.
const DIRECTIONS: usize = 24;
const AZIMUTHS: u32 = 256;

/// Cosines and weights on 0..1 that stand for all directions.
pub fn hemisphere() -> Vec<(f64, f64)> {
    gauss_legendre(DIRECTIONS, 0.0, 1.0)
}

impl Slab {
    fn peak(&self) -> Peak {
        Peak::new(self.g)
    }

    /// Optical thickness without what stays in the peak.
    fn thinned(&self) -> f64 {
        self.tau * self.peak().extinction(self.albedo)
    }

    /// Albedo of what then scatters.
    fn thinned_albedo(&self) -> f64 {
        let peak = self.peak();
        self.albedo * (1.0 - peak.share) / peak.extinction(self.albedo).max(f64::MIN_POSITIVE)
    }

    /// Fluence in layers of one thickness, for an irradiance of 1 across the light. What escapes is the mean over `cosines`.
    pub fn fluence(&self, layers: usize, cosines: &[(f64, f64)]) -> Vec<f64> {
        let (tau, albedo, peak) = (self.thinned(), self.thinned_albedo(), self.peak());
        let depth = tau / layers as f64;
        let (mut sinks, mut sources) = (Vec::new(), Vec::new());
        for layer in 0..layers {
            let above = layer as f64 * depth;
            let below = (tau - above - depth).max(0.0);
            let (mut escapes, mut towards) = (0.0, 0.0);
            for (mu, weight) in cosines {
                let [up, down] =
                    [above, below].map(|way| (-way / mu).exp() * lessening(depth / mu) * weight * 0.5);
                escapes += up + down;
                towards += mu * (down - up);
            }
            sinks.push(depth * (1.0 - albedo + albedo * escapes));
            let lost = (depth / self.mu0).min(1e6);
            let beam = (-above / self.mu0).exp() * lessening(lost);
            let leaning = escapes + 3.0 * peak.g_even * self.mu0 * towards;
            let falls = -FALL * (self.mu0 * towards / escapes.max(1e-20)).clamp(-1.0, 1.0) * lost;
            let falls = falls.max(-20.0);
            let even =
                (leaning * lessening(lost + falls) / (lessening(lost) * lessening(falls))).clamp(0.0, 1.0);
            let straight = if self.g < 0.0 {
                (-above / self.mu0).exp() * lessening(2.0 * lost) / lessening(lost)
            } else {
                ((-below / self.mu0).exp() / lessening(lost)).min(1.0)
            };
            let escaping = even + peak.lobe * (straight - even);
            // Where next to nothing arrives what escapes of it is no number.
            let escaping = if beam > 0.0 { escaping } else { 0.0 };
            sources.push(depth * albedo * beam * (1.0 - escaping));
        }
        let link = peak.extinction(self.albedo) / (3.0 * (1.0 - self.albedo * self.g)) / depth.max(1e-100);
        diffuse(&sinks, &sources, link)
    }

    /// Reflectance and scattered transmittance by the radiance that is seen from outside. The transmittance has what is left of the beam in its
    /// peak; what is not scattered at all it has not.
    pub fn of_radiance(&self, layers: usize, cosines: &[(f64, f64)]) -> [f64; 2] {
        let fluence = self.fluence(layers, cosines);
        let (tau, albedo, peak) = (self.thinned(), self.thinned_albedo(), self.peak());
        let fine = layers.max(400);
        let step = tau / fine as f64;
        let mut power = [0.0, self.mu0 * ((-tau / self.mu0).exp() - (-self.tau / self.mu0).exp())];
        for (mu, weight) in hemisphere() {
            let phases = [-mu, mu].map(|cosine| self.phase(cosine, &peak) / (1.0 - peak.share).max(1e-30));
            for index in 0..fine {
                let middle = (index as f64 + 0.5) * step;
                let beam = (-middle / self.mu0).exp();
                let found = between(&fluence, middle / tau);
                for (side, way) in [middle, tau - middle].into_iter().enumerate() {
                    let seen = (-(way - step / 2.0) / mu).exp() * lessening(step / mu) * step;
                    let source = albedo * (phases[side] * beam + found / (4.0 * PI));
                    power[side] += TAU * weight * source * seen;
                }
            }
        }
        power.map(|power| power / self.mu0)
    }

    /// Mean over the azimuth of the phase function without its peak, from the light to the cosine `mu`.
    fn phase(&self, mu: f64, peak: &Peak) -> f64 {
        let across = ((1.0 - mu * mu) * (1.0 - self.mu0 * self.mu0)).sqrt();
        let at = |index: u32| {
            let azimuth = PI * (f64::from(index) + 0.5) / f64::from(AZIMUTHS);
            let cosine = (mu * self.mu0 + across * azimuth.cos()).clamp(-1.0, 1.0);
            henyey_greenstein(cosine, self.g).min(peak.cap)
        };
        (0..AZIMUTHS).map(at).sum::<f64>() / f64::from(AZIMUTHS)
    }
}

/// What layers hold at a depth in 0..1: that in their middles, and linear between.
fn between(layers: &[f64], depth: f64) -> f64 {
    let at = (depth * layers.len() as f64 - 0.5).clamp(0.0, layers.len() as f64 - 1.0);
    let low = (at as usize).min(layers.len().saturating_sub(2));
    let high = (low + 1).min(layers.len() - 1);
    layers[low] + (at - low as f64) * (layers[high] - layers[low])
}

/// Solves for layers that exchange `link` times the difference with their neighbours (Thomas's algorithm).
fn diffuse(sinks: &[f64], sources: &[f64], link: f64) -> Vec<f64> {
    let last = sinks.len() - 1;
    let diagonal = |layer: usize| {
        let neighbours = usize::from(layer > 0) + usize::from(layer < last);
        sinks[layer] + link * neighbours as f64
    };
    let (mut ratios, mut values) = (Vec::new(), Vec::new());
    for layer in 0..=last {
        let (ratio, value) = match layer {
            0 => (0.0, 0.0),
            _ => (ratios[layer - 1], values[layer - 1]),
        };
        let pivot = (diagonal(layer) - link * ratio).max(f64::MIN_POSITIVE);
        ratios.push(link / pivot);
        values.push((sources[layer] + link * value) / pivot);
    }
    for layer in (0..last).rev() {
        values[layer] += ratios[layer] * values[layer + 1];
    }
    values
}

/// `(1 - exp(-x)) / x`, for `x` of either sign.
fn lessening(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x }
}
