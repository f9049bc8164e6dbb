//! The forward peak of Henyey and Greenstein's phase function, which counts as no scattering where light is scattered often.
//!
//! Of the light that a medium scatters with the mean cosine `g > 0` the share `f = g^2` is said to go on unscattered (Joseph, Wiscombe and
//! Weinman 1976, "The delta-Eddington approximation for radiative flux transfer"). What is left is the phase function cut off at a `cap`
//! (Potter 1970, "The delta function approximation in radiative transfer theory"), so that light that is thrown far off its way, and is all
//! that a surface reflects at first, stays as it is. Light thrown back by a negative `g` has no such peak.

use super::phase::{henyey_greenstein, henyey_greenstein_cdf};
use super::quadrature::gauss_legendre;
use std::f64::consts::PI;

/// What becomes of a phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Mean cosine of the whole.
    pub g: f64,
    /// `f`: share of the scattered light in the peak.
    pub share: f64,
    /// What the rest, which adds up to `1 - f`, is of the whole: the lesser of it and this.
    pub cap: f64,
    /// Share of the rest that goes straight on, or straight back where `g < 0`, if it is taken for such light and for light that leans evenly.
    pub lobe: f64,
    /// Mean cosine of what then leans evenly.
    pub g_even: f64,
}

/// A smaller `g` has no peak worth its name.
const LEAST_G: f64 = 1e-3;

impl Peak {
    /// For the mean cosine `g`, from -1 to 1.
    pub fn new(g: f64) -> Self {
        if g < LEAST_G {
            // The moments of the phase function are the powers of g.
            return Self { g, share: 0.0, cap: f64::INFINITY, ..Self::lobe(g, g * g) };
        }
        let g = g.min(1.0 - 1e-9);
        let rest = (1.0 - g) * (1.0 + g);
        let value = |cosine: f64| henyey_greenstein(cosine, g);
        let whole =
            |cosine: f64| 2.0 * PI * value(cosine) * (1.0 - cosine) + henyey_greenstein_cdf(cosine, g);
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if whole(middle) < rest { low = middle } else { high = middle }
        }
        let edge = 0.5 * (low + high);
        let cap = value(edge);
        let (mut first, mut second) = (0.0, 0.0);
        for (from, to) in [(-1.0, 0.5 * (edge - 1.0)), (0.5 * (edge - 1.0), edge), (edge, 1.0)] {
            for (cosine, weight) in gauss_legendre(40, from, to) {
                let power = 2.0 * PI * weight * value(cosine).min(cap) / rest;
                first += power * cosine;
                second += power * (1.5 * cosine * cosine - 0.5);
            }
        }
        Self { g, share: g * g, cap, ..Self::lobe(first, second) }
    }

    /// Delta-M of two moments of the phase function (Wiscombe 1977, "The delta-M method").
    fn lobe(first: f64, second: f64) -> Self {
        let lobe = second.clamp(0.0, 0.999);
        let straight = if first < 0.0 { -lobe } else { lobe };
        let g_even = ((first - straight) / (1.0 - lobe)).clamp(-1.0, 1.0);
        Self { g: first, share: 0.0, cap: f64::INFINITY, lobe, g_even }
    }

    /// `1 - albedo f`: extinction of what is not scattered, or into the peak, by that of light that is not scattered at all.
    pub fn extinction(&self, albedo: f64) -> f64 {
        1.0 - albedo * self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_adds_up_and_leans_as_it_says() {
        for g in [-0.7, 0.0, 5e-4, 2e-3, 0.3, 0.5, 0.9, 0.99] {
            let peak = Peak::new(g);
            let mut sum = [0.0; 3];
            for index in 0..200 {
                let edge = |index: i32| 1.0 - 2.0 * (f64::from(index) / 200.0).powi(2);
                for (cosine, weight) in gauss_legendre(20, edge(index + 1), edge(index)) {
                    let power = 2.0 * PI * weight * henyey_greenstein(cosine, g).min(peak.cap);
                    sum[0] += power;
                    sum[1] += power * cosine;
                    sum[2] += power * (1.5 * cosine * cosine - 0.5);
                }
            }
            let [whole, first, second] = [sum[0], sum[1] / sum[0], sum[2] / sum[0]];
            let straight = peak.lobe.copysign(g);
            assert!((whole - (1.0 - peak.share)).abs() < 1e-6, "{peak:?}: {sum:?}");
            assert!((first - (straight + (1.0 - peak.lobe) * peak.g_even)).abs() < 1e-4, "{peak:?}: {sum:?}");
            assert!((second - peak.lobe).abs() < 1e-4, "{peak:?}: {sum:?}");
        }
    }

    #[test]
    fn the_ends_are_finite() {
        for g in [-1.0, -0.999, 1e-3, 0.999, 1.0] {
            let peak = Peak::new(g);
            assert!(peak.g_even.is_finite() && peak.lobe.is_finite(), "{peak:?}");
            assert!(peak.cap > 0.0 && peak.share <= 1.0);
        }
    }
}
