//! Exact multiple scattering in a half space with a smooth boundary: adding and doubling of layers.
//!
//! Only what does not depend on the azimuth is followed, which is all that the reflected power takes. The half space is cut into
//! streams, directions at the nodes of a quadrature; what it reflects comes of doubling one layer until no light gets through (van de
//! Hulst 1980, "Multiple light scattering"). The first layer is Wiscombe's diamond (1976, "On initialization, error and
//! flux conservation in the doubling method"). A diamond is Cayley's transform of the equation of transport, which keeps the directions
//! that die out with depth: so the limit is that of the streams themselves, however thick the first layer is.

mod matrix;

use super::fresnel::{reflectance, transmittance};
use super::medium::Medium;
use super::quadrature::gauss_legendre;
use matrix::{Matrix, dot};

/// Greatest magnitude of `g` that is followed; beyond, the phase function is that of this one.
pub const MAX_G: f64 = 0.999;

/// Steps of doubling after which no medium changes any more.
const MAX_DOUBLINGS: usize = 64;

/// A half space with a smooth boundary, ready to be asked what it reflects.
pub struct HalfSpace {
    eta: f64,
    scattering: Scattering,
    /// Cosines of the streams.
    mu: Vec<f64>,
    /// Weights of the quadrature over them, which sum to 1.
    weight: Vec<f64>,
    /// `dI_down / dtau = -a I_down + b I_up`, and up the same with signs turned, tau counted downwards.
    a: Matrix,
    b: Matrix,
    /// `I_up = r I_down` without the boundary.
    r: Matrix,
    /// Power that leaves through the boundary for each intensity that comes up to it for the first time.
    escape: Vec<f64>,
}

/// Scattering per extinction, split in a smooth part and a peak.
///
/// A peak straight on is no scattering at all (delta-M: Wiscombe 1977, "The delta-M method: rapid yet accurate radiative flux
/// calculations for strongly asymmetric phase functions"). A peak straight back, which a negative `g` has, is kept as what it is: light
/// that turns round.
struct Scattering {
    /// Albedo of the smooth part.
    albedo: f64,
    /// Albedo of the peak straight back.
    back: f64,
    /// What is left of 1.
    absorbed: f64,
    /// Legendre moments of the smooth part.
    moments: Vec<f64>,
}

impl Scattering {
    /// Splits Henyey and Greenstein's phase function, whose moments are powers of `g`, at `orders` of them, an even number.
    fn new(medium: &Medium, orders: usize) -> Self {
        let g = medium.g.clamp(-MAX_G, MAX_G);
        let peak = g.abs().powi(orders as i32);
        let turn: f64 = if g < 0.0 { -1.0 } else { 1.0 };
        let (smooth, back) =
            ((1.0 - peak) * medium.sigma_s, if g < 0.0 { peak * medium.sigma_s } else { 0.0 });
        let sigma_t = smooth + back + medium.sigma_a;
        let moment = |order: usize| {
            let order = order as i32;
            turn.powi(order) * (g.abs().powi(order) - peak) / (1.0 - peak)
        };
        let [albedo, back, absorbed] = [smooth, back, medium.sigma_a].map(|part| part / sigma_t);
        Self { albedo, back, absorbed, moments: (0..orders).map(moment).collect() }
    }

    /// `albedo / 2` times the phase function between two cosines, averaged over the azimuth: on the same side of the horizontal, and
    /// on opposite sides.
    fn between(&self, legendre_a: &[f64], legendre_b: &[f64]) -> (f64, f64) {
        let terms = self.moments.iter().zip(legendre_a).zip(legendre_b).enumerate();
        let (mut even, mut odd) = (0.0, 0.0);
        for (order, ((moment, a), b)) in terms {
            let term = (2 * order + 1) as f64 * moment * a * b;
            *(if order % 2 == 0 { &mut even } else { &mut odd }) += term;
        }
        (0.5 * self.albedo * (even + odd), 0.5 * self.albedo * (even - odd))
    }

    /// Legendre's polynomials at a cosine, one for each moment.
    fn legendre(&self, mu: f64) -> Vec<f64> {
        let mut values = vec![1.0, mu];
        for order in 2..self.moments.len() {
            let l = order as f64;
            values.push(((2.0 * l - 1.0) * mu * values[order - 1] - (l - 1.0) * values[order - 2]) / l);
        }
        values
    }
}

impl HalfSpace {
    /// Doubles layers of `medium`, with the light in `streams` directions downwards and as many upwards; some 20 give four digits.
    ///
    /// Coefficients are finite and not all 0; `eta` is finite and positive.
    pub fn new(medium: &Medium, streams: usize) -> Self {
        let streams = streams.max(8);
        // Found by trial: with twice as many orders as streams a narrow peak falls between the streams.
        let scattering = Scattering::new(medium, (streams * 3 / 2) & !1);
        let (mu, weight): (Vec<f64>, Vec<f64>) = quadrature(medium.eta, streams).into_iter().unzip();
        let legendre: Vec<Vec<f64>> = mu.iter().map(|mu| scattering.legendre(*mu)).collect();
        let one = |row, column| f64::from(u8::from(row == column));
        let b = Matrix::from_fn(mu.len(), |row, column| {
            let (_, against) = scattering.between(&legendre[row], &legendre[column]);
            (scattering.back * one(row, column) + against * weight[column]) / mu[row]
        });
        let into = Matrix::from_fn(mu.len(), |row, column| {
            let (along, _) = scattering.between(&legendre[row], &legendre[column]);
            along * weight[column] * (1.0 - one(row, column)) / mu[row]
        });
        // What a stream loses is what it gives to the others and what is absorbed. In bright media the common form, one less what it
        // keeps, loses the absorption to rounding.
        let a = Matrix::from_fn(mu.len(), |row, column| {
            let lost = || scattering.absorbed / mu[row] + into.row(row).iter().chain(b.row(row)).sum::<f64>();
            if row == column { lost() } else { -into.row(row)[column] }
        });
        let r = reflection(&a, &b);

        let inside: Vec<f64> = mu.iter().map(|mu| reflectance(*mu, medium.eta.recip())).collect();
        let leaving = (0..mu.len()).map(|index| mu[index] * weight[index] * (1.0 - inside[index])).collect();
        // Up and down between medium and boundary, any number of times: leaving (1 - r F)^-1.
        let rounds =
            Matrix::from_fn(mu.len(), |row, column| one(row, column) - r.row(column)[row] * inside[row]);
        let escape = rounds.solve(leaving);
        Self { eta: medium.eta, scattering, mu, weight, a, b, r, escape }
    }

    /// Share of the power of a beam at the cosine `cos` outside that leaves after having been inside.
    pub fn reflectance(&self, cos: f64) -> f64 {
        let entering = transmittance(cos, self.eta);
        if entering > 0.0 { entering * self.reflectance_of_entered(cos) } else { 0.0 }
    }

    /// The same for power that has entered, of a beam at the cosine `cos` outside.
    ///
    /// The beam is no stream. The invariance of a half space under one more layer gives the streams that come up from it (Ambartsumian
    /// 1943; as `a r + r a = b + r b r` it holds `r` itself): `(a - r b + kappa) up = r b_down + b_up`, with `kappa` the
    /// extinction along the beam and `b` what a beam of unit power scatters into the streams.
    pub(super) fn reflectance_of_entered(&self, cos: f64) -> f64 {
        if self.scattering.albedo <= 0.0 {
            return 0.0;
        }
        // At the horizon nothing is left to divide by.
        let mu0 = cosine_inside(cos, self.eta).max(1e-9);
        // A beam and its retro-reflection, which die out together.
        let back = self.scattering.back;
        let decay = ((1.0 - back) * (1.0 + back)).sqrt();
        let returned = back / (1.0 + decay);
        let kappa = decay / mu0;

        let at_beam = self.scattering.legendre(mu0);
        let streams =
            self.mu.iter().map(|mu| self.scattering.between(&self.scattering.legendre(*mu), &at_beam));
        let streams: Vec<(f64, f64)> = streams.collect();
        let given =
            streams.iter().zip(&self.weight).map(|((along, against), weight)| (along + against) * weight);
        // What is scattered out of the beam has to arrive, however coarse the quadrature.
        let share = self.scattering.albedo / (mu0 * given.sum::<f64>());
        let sources = streams.iter().zip(&self.mu).map(|((along, against), mu)| {
            let share = share / mu;
            (share * (along + returned * against), share * (against + returned * along))
        });
        let (down, up): (Vec<f64>, Vec<f64>) = sources.unzip();
        let reflected = self.r.times_column(&down);
        let right = reflected.iter().zip(&up).map(|(a, b)| a + b).collect();
        let system = self.a.zip(&self.r.times(&self.b), |a, rb| a - rb);
        let streams = system.map(|value, diagonal| if diagonal { value + kappa } else { value }).solve(right);

        // The retro-reflection meets the boundary too, and starts down again.
        let inside = reflectance(mu0, self.eta.recip());
        (dot(&self.escape, &streams) + returned * (1.0 - inside)) / (1.0 - returned * inside)
    }
}

/// Cosine of the refracted beam; 0 beyond the critical angle.
fn cosine_inside(cos: f64, eta: f64) -> f64 {
    ((eta - 1.0) * (eta + 1.0) + cos * cos).max(0.0).sqrt() / eta
}

/// Cosines and weights of the streams.
///
/// Where light is totally reflected inside, no panel reaches over the critical angle, and the one above it follows the root with which
/// the reflectance falls there. It gets the more streams per cosine.
fn quadrature(eta: f64, streams: usize) -> Vec<(f64, f64)> {
    let critical = ((eta - 1.0) * (eta + 1.0)).max(0.0).sqrt() / eta;
    if critical < 0.01 {
        return gauss_legendre(streams, 0.0, 1.0);
    }
    let (lower, width) = (((streams as f64 * 0.65 * critical) as usize).max(4), 1.0 - critical);
    let mut nodes = gauss_legendre(lower, 0.0, critical);
    let above = gauss_legendre(streams - lower, 0.0, 1.0).into_iter();
    nodes.extend(above.map(|(t, weight)| (critical + width * t * t, 2.0 * width * t * weight)));
    nodes
}

/// What a half space without a boundary reflects, from stream to stream.
fn reflection(a: &Matrix, b: &Matrix) -> Matrix {
    let steepest = a.map(|value, diagonal| if diagonal { value } else { 0.0 }).greatest();
    let half = steepest.recip();
    // Of light from both sides, alike or opposite, a diamond lets through (1 + h c)^-1 (1 - h c), c = a - b or a + b.
    let diamond = |c: Matrix| {
        let with = |sign: f64| c.map(|value, diagonal| f64::from(u8::from(diagonal)) + sign * half * value);
        with(1.0).solve_matrix(with(-1.0))
    };
    let alike = diamond(a.zip(b, |a, b| a - b));
    let opposite = diamond(a.zip(b, |a, b| a + b));
    let mut t = alike.zip(&opposite, |alike, opposite| 0.5 * (alike + opposite));
    let mut r = alike.zip(&opposite, |alike, opposite| 0.5 * (alike - opposite));
    for _ in 0..MAX_DOUBLINGS {
        let rounds = r.times(&r).map(|value, diagonal| f64::from(u8::from(diagonal)) - value);
        let between = rounds.solve_matrix(t.clone());
        let added = t.times(&r.times(&between));
        t = t.times(&between);
        r = r.zip(&added, |r, added| r + added);
        if added.greatest() <= 1e-9 * r.greatest() {
            break;
        }
    }
    r
}
