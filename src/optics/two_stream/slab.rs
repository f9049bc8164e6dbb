//! A slab in two streams, to compare with what is known of slabs.

use super::super::phase::henyey_greenstein;
use super::super::quadrature::gauss_legendre;
use super::{Cone, Layer, Streams, radiance_source, solve};
use std::f64::consts::{PI, TAU};

/// Directions of the radiance, and azimuths around each.
const DIRECTIONS: usize = 24;
const AZIMUTHS: u32 = 128;

/// A homogeneous slab, lit at the cosine `mu0` to its normal. Reflectance and transmittance are without the direct light, which is exact.
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

impl Slab {
    /// `T'` at a depth in 0..1.
    fn beam(&self, depth: f64) -> f64 {
        (-Cone::new(self.g).beam(self.albedo) * self.tau * depth / self.mu0).exp()
    }

    /// The slab in layers of one thickness, and the streams at their faces.
    pub fn layers(&self, count: usize) -> (Vec<Layer>, Vec<Streams>) {
        let cone = Cone::new(self.g);
        let face = |index: usize| self.beam(index as f64 / count as f64);
        let layer = |index| {
            let beam = [face(index), face(index + 1)];
            Layer::new(&cone, self.tau / count as f64, self.albedo, self.mu0, beam)
        };
        let layers: Vec<Layer> = (0..count).map(layer).collect();
        let streams = solve(&layers);
        (layers, streams)
    }

    /// Reflectance and scattered transmittance by the fluxes of the streams, and by what is left of the beam `T'` beside the direct light.
    pub fn of_fluxes(&self, count: usize) -> [f64; 2] {
        let (_, streams) = self.layers(count);
        let straight = self.beam(1.0) - (-self.tau / self.mu0).exp();
        [streams[0].backward / self.mu0, streams[count].forward / self.mu0 + straight]
    }

    /// Reflectance and scattered transmittance by the radiance that is seen from outside, with [`radiance_source`] at all depths.
    pub fn of_radiance(&self, count: usize) -> [f64; 2] {
        let (_, streams) = self.layers(count);
        let mut power = [0.0; 2];
        for (mu, weight) in gauss_legendre(DIRECTIONS, 0.0, 1.0) {
            let phases = [self.phase(-mu), self.phase(mu)];
            let left = |depth: f64| (-self.tau * depth / mu).exp();
            for index in 0..count {
                let [near, middle, far] = [0.0, 0.5, 1.0].map(|at| (index as f64 + at) / count as f64);
                let [a, b] = [streams[index], streams[index + 1]];
                let mean = Streams {
                    forward: 0.5 * (a.forward + b.forward),
                    backward: 0.5 * (a.backward + b.backward),
                };
                let seen = [left(near) - left(far), left(1.0 - far) - left(1.0 - near)];
                for (side, cos) in [-mu, mu].into_iter().enumerate() {
                    let beam = self.beam(middle);
                    let source = radiance_source(self.albedo, self.g, phases[side], beam, mean, cos);
                    power[side] += TAU * weight * mu * source * seen[side];
                }
            }
        }
        power.map(|power| power / self.mu0)
    }

    /// Mean over the azimuth of the phase function, from the light to the cosine `mu`.
    fn phase(&self, mu: f64) -> f64 {
        let across = ((1.0 - mu * mu) * (1.0 - self.mu0 * self.mu0)).sqrt();
        let at = |index: u32| {
            let azimuth = PI * (f64::from(index) + 0.5) / f64::from(AZIMUTHS);
            henyey_greenstein((mu * self.mu0 + across * azimuth.cos()).clamp(-1.0, 1.0), self.g)
        };
        (0..AZIMUTHS).map(at).sum::<f64>() / f64::from(AZIMUTHS)
    }
}
