//! Multiply scattered light in two streams along an axis, each in a cone around it.
//!
//! `D` and `U` are fluxes along and against the axis, at the mean cosine `mu1` ([`MU1`]). With the depth `z` along the axis
//!
//! ```text
//!  dD/dz = -gamma1 D + gamma2 U + S (1 + b) / 2        gamma2 = 3/2 mu1 sigma_s (1 - g)
//! -dU/dz = -gamma1 U + gamma2 D + S (1 - b) / 2        gamma1 = gamma2 + sigma_a / mu1
//!  S = (1 - f) sigma_s E T'                            b = 3/2 g' mu0
//! ```
//!
//! (Meador and Weaver 1980, "Two-stream approximations to radiative transfer in planetary atmospheres", equations 1 to 3). Their common
//! form of `gamma2` is `sigma_s (1 - g*) / (2 mu1)`; here `g* = 1 - 3 mu1^2 (1 - g)`, with which light diffuses as deep in the medium as
//! it should, whatever the cone. `b` is that of Eddington's approximation.
//!
//! The peak of the phase function is no scattering (Joseph, Wiscombe and Weinman 1976, "The delta-Eddington approximation for radiative
//! flux transfer"): `f = g^2` of the scattered light stays in the beam, `g' = g / (1 + g)` is the mean cosine of the rest, and the beam
//! that feeds the streams is `T' = T^(1 - albedo f)`, brighter than the direct light `T`. What it has more is light scattered once or
//! more often. Light thrown back by a negative `g` has no such peak: `f = 0`. As `sigma_s (1 - g)` is the same before and after,
//! only the sources know of `f`.
//!
//! A layer is exact for diffuse light. Its source is at the mean depth where the beam loses light, an error of second order in the
//! thickness, and none where nothing is absorbed, as the share that gets out is linear in the depth there. All that a layer takes from
//! the beam and does not absorb comes out, to rounding.
//!
//! Against adding and doubling of slabs (optical thickness 0.5 to 10, albedo 0.5 and more, g -0.5 to 0.9) the mean errors of reflectance
//! and scattered transmittance are 6 and 10 %, and 6 and 8 % for [`radiance_source`] looked at from outside.

mod slab;

pub use slab::Slab;

use std::f64::consts::PI;

/// Mean cosine of each stream, of a half angle of 63 degrees: found by trial on the slabs named above, for what [`radiance_source`] shows.
pub const MU1: f64 = 0.45;

/// Greatest optical thickness of a layer that is told from thicker ones.
const MAX_TAU: f64 = 1e9;

/// Least cosine between light and axis in the thickness of a layer along the beam.
const MIN_MU0: f64 = 1e-6;

/// What the streams need to know of a phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Mean cosine of the phase function.
    pub g: f64,
    /// `f`: share of the scattered light that stays in the beam.
    pub peak: f64,
    /// `1 - f`.
    pub beside_peak: f64,
    /// `g'`: mean cosine beside the peak.
    pub g_prime: f64,
    /// `gamma2 / sigma_s`.
    pub turned: f64,
}

impl Cone {
    /// For Henyey and Greenstein's phase function of the mean cosine `g`, from -1 to 1.
    pub fn new(g: f64) -> Self {
        let ahead = g.max(0.0);
        Self {
            g,
            peak: ahead * ahead,
            beside_peak: (1.0 - ahead) * (1.0 + ahead),
            g_prime: if g > 0.0 { g / (1.0 + g) } else { g },
            turned: 1.5 * MU1 * (1.0 - g),
        }
    }

    /// `1 - albedo f`: extinction of the beam `T'` that feeds the streams by that of the direct light.
    pub fn beam(&self, albedo: f64) -> f64 {
        (1.0 - albedo) + albedo * self.beside_peak
    }
}

/// What a layer does to the streams. Fluxes are per irradiance perpendicular to the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Share of a stream that turns round.
    pub r: f64,
    /// Share that goes on.
    pub t: f64,
    /// `1 - r - t` without its rounding, so that thick layers that absorb nothing do not run out of digits.
    pub absorbed: f64,
    /// Scattered from the beam and out along the axis.
    pub s_forward: f64,
    /// Scattered from the beam and out against the axis.
    pub s_backward: f64,
}

impl Layer {
    /// A layer of the optical thickness `tau` along the axis, its light at the cosine `mu0` to it.
    ///
    /// `beam` is `T'` where the axis enters and leaves the layer. It may rise, as where the light comes from aside. Its mean is
    /// logarithmic, or what must have been lost in the layer, if `T'` is less than the numbers hold.
    pub fn new(cone: &Cone, tau: f64, albedo: f64, mu0: f64, beam: [f64; 2]) -> Self {
        let tau = tau.min(MAX_TAU);
        let scattered = albedo * tau;
        let lost = (1.0 - albedo) * tau / MU1;
        let turned = cone.turned * scattered;
        let gamma = (lost * (lost + 2.0 * turned)).sqrt();
        // (1 - exp(-2 gamma part)) / gamma
        let rise = |part: f64| 2.0 * part * lessening(2.0 * gamma * part);

        let (mean, above) = mean_and_depth(beam, cone.beam(albedo) * tau / mu0.abs().max(MIN_MU0));
        let below = 1.0 - above;
        let (e_above, e_below) = ((-gamma * above).exp(), (-gamma * below).exp());
        let e = e_above * e_below;
        let whole = rise(1.0);
        let by = (1.0 + e * e + (lost + turned) * whole).recip();

        let source = cone.beside_peak * scattered * mean;
        let bias = (1.5 * cone.g_prime * mu0).clamp(-1.0, 1.0);
        let (along, against) = (0.5 * source * (1.0 + bias), 0.5 * source * (1.0 - bias));
        let (rise_above, rise_below) = (e_below * rise(above), e_above * rise(below));
        // What leaves at one end of all that starts towards it; of light that starts away from it, the turned share.
        let forward = e_below * (1.0 + e_above * e_above) + lost * rise_above;
        let backward = e_above * (1.0 + e_below * e_below) + lost * rise_below;
        Self {
            r: turned * whole * by,
            t: 2.0 * e * by,
            absorbed: ((gamma * lessening(gamma)).powi(2) + lost * whole) * by,
            s_forward: (along * forward + source * turned * rise_above) * by,
            s_backward: (against * backward + source * turned * rise_below) * by,
        }
    }
}

/// Light in the two streams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Streams {
    /// `D`, along the axis.
    pub forward: f64,
    /// `U`, against the axis.
    pub backward: f64,
}

impl Streams {
    /// Fluence, the radiance summed over all directions.
    pub fn fluence(self) -> f64 {
        (self.forward + self.backward) / MU1
    }

    /// Light of isotropic scattering, and of what of the phase function is linear in the cosine, that goes at the cosine `cos` to the axis.
    pub fn scattered(self, g: f64, cos: f64) -> f64 {
        (self.fluence() + 3.0 * g * cos * (self.forward - self.backward)).max(0.0) / (4.0 * PI)
    }
}

/// Source of the radiance at the cosine `cos` to the axis, per extinction: `phase` is for light that goes there from the beam `T'`.
pub fn radiance_source(albedo: f64, g: f64, phase: f64, beam: f64, streams: Streams, cos: f64) -> f64 {
    albedo * (phase * beam + streams.scattered(g, cos))
}

/// All layers before a face, as seen from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stack {
    /// `1 - R`: what they do not turn round.
    pub kept: f64,
    /// What comes out of them if nothing comes in.
    pub down: f64,
}

impl Default for Stack {
    fn default() -> Self {
        Self { kept: 1.0, down: 0.0 }
    }
}

impl Stack {
    /// Sum over light that goes to and fro between stack and layer.
    fn rounds(&self, layer: &Layer) -> f64 {
        (self.kept + (1.0 - self.kept) * (layer.t + layer.absorbed)).recip()
    }

    /// With one more layer: a step of the sweep forward.
    pub fn add(&self, layer: &Layer) -> Self {
        let (r, rounds) = (1.0 - self.kept, self.rounds(layer));
        let (t, absorbed) = (layer.t, layer.absorbed);
        Self {
            kept: ((t + absorbed) * self.kept + r * absorbed * (2.0 * t + absorbed)) * rounds,
            down: layer.s_forward + t * (self.down + r * layer.s_backward) * rounds,
        }
    }

    /// The streams before `layer` from the light against the axis behind it: a step of the sweep back.
    pub fn resolve(&self, layer: &Layer, backward: f64) -> Streams {
        let up = layer.s_backward + layer.t * backward;
        let forward = (self.down + (1.0 - self.kept) * up) * self.rounds(layer);
        Streams { forward, backward: up + layer.r * forward }
    }
}

/// The streams at all faces of a column of layers, with no diffuse light from outside.
pub fn solve(layers: &[Layer]) -> Vec<Streams> {
    let mut stacks = vec![Stack::default()];
    for layer in layers {
        stacks.push(stacks[stacks.len() - 1].add(layer));
    }
    let mut streams = vec![Streams { forward: stacks[layers.len()].down, backward: 0.0 }];
    for (layer, stack) in layers.iter().zip(&stacks).rev() {
        streams.push(stack.resolve(layer, streams[streams.len() - 1].backward));
    }
    streams.reverse();
    streams
}

/// Mean of a beam between two ends and how far from the first it loses its light on average, of 1. `depth` is its optical depth between
/// them in a medium that is even aside.
fn mean_and_depth([first, second]: [f64; 2], depth: f64) -> (f64, f64) {
    let (greater, less) = (first.max(second), first.min(second));
    let fall = greater - less;
    if fall <= 0.0 {
        return (greater, 0.5);
    }
    let x = fall / greater;
    let logarithmic = -fall / if x < 0.5 { (-x).ln_1p() } else { (less / greater).ln() };
    let mean = logarithmic.max(fall / depth).min(0.5 * (greater + less));
    // Where little is lost the two ends have too few digits apart.
    let series = 0.5 - x / 12.0 - x * x / 24.0 - x * x * x * (19.0 / 720.0);
    let from_greater = if x < 0.03 { series } else { (mean - less) / fall };
    (mean, if first >= second { from_greater } else { 1.0 - from_greater })
}

/// `(1 - exp(-x)) / x`.
fn lessening(x: f64) -> f64 {
    if x > 0.0 { -(-x).exp_m1() / x } else { 1.0 }
}
