//! Points that fill a square, a disc or a sphere more evenly than random ones.

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Radical inverse of `index` in `base`: its digits mirrored at the point. In 0..1.
pub fn radical_inverse(mut index: u64, base: u64) -> f64 {
    let step = (base as f64).recip();
    let (mut value, mut place) = (0.0, step);
    while index > 0 {
        value += (index % base) as f64 * place;
        index /= base;
        place *= step;
    }
    value
}

/// Van der Corput's sequence: the radical inverse in base 2, bit by bit.
pub fn van_der_corput(index: u32) -> f64 {
    f64::from(index.reverse_bits()) / 4_294_967_296.0
}

/// Halton's sequence in the unit square: radical inverses in bases 2 and 3.
pub fn halton(index: u32) -> DVec2 {
    DVec2::new(van_der_corput(index), radical_inverse(u64::from(index), 3))
}

/// Direction for a point of the unit square; even points give even directions.
pub fn sphere_point(u: f64, v: f64) -> DVec3 {
    let z = 1.0 - 2.0 * u;
    let across = 2.0 * (u * (1.0 - u)).max(0.0).sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    DVec3::new(across * cos, across * sin, z)
}

/// A distribution of points over a disc, thinning out from its centre as `e^(-sigma r)`.
///
/// It is how Dal Corso, Frisvad, Mosegaard and Bærentzen (2017), "Interactive directional subsurface scattering and transport of
/// emergent light", place the points where light may have entered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExponentialDisc {
    /// Rate of the fall, per unit of length; 0 is an even disc.
    pub sigma: f64,
    /// Radius of the disc.
    pub radius: f64,
}

/// A point of an [`ExponentialDisc`], from the centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscPoint {
    /// Where it is.
    pub position: DVec2,
    /// How probable such a point is, per unit of area.
    pub density: f64,
}

impl ExponentialDisc {
    /// Optical radius beyond which no point would fall in 64 bits.
    const REACH: f64 = 45.0;

    /// Probability per unit of area of a point at the distance `r` from the centre. Its integral over the disc is 1.
    pub fn density(&self, r: f64) -> f64 {
        if r > self.radius {
            return 0.0;
        }
        let x = self.sigma * self.radius;
        (-self.sigma * r).exp() / (TAU * self.radius * self.radius * Self::share(x))
    }

    /// `count` points and their densities: points of Halton's sequence spread over the disc, each kept with the probability
    /// `e^(-sigma r)` by a third sequence in base 5 (rejection, as in the paper).
    ///
    /// Where the disc is wide the tail of less than 2⁻⁶⁴ is not proposed, so that never more than a thousand are rejected for one kept.
    pub fn points(&self, count: usize) -> Vec<DiscPoint> {
        let reach =
            if self.sigma * self.radius > Self::REACH { Self::REACH / self.sigma } else { self.radius };
        let proposals = (1..=u32::MAX).map(|index| {
            let at = halton(index);
            let r = reach * at.x.sqrt();
            (r, DVec2::from_angle(TAU * at.y) * r, radical_inverse(u64::from(index), 5))
        });
        let kept = proposals.filter(|(r, _, chance)| *chance < (-self.sigma * r).exp());
        kept.take(count).map(|(r, position, _)| DiscPoint { position, density: self.density(r) }).collect()
    }

    /// `(1 - (1 + x) e^-x) / x²`: what is left of the disc's area over 2 pi, in squared radii.
    fn share(x: f64) -> f64 {
        if x < 0.1 {
            // The sum over k of (-x)^k / (k! (k + 2)).
            let (mut term, mut sum) = (1.0, 0.0);
            for k in 0..10 {
                sum += term / f64::from(k + 2);
                term *= -x / f64::from(k + 1);
            }
            sum
        } else {
            (-(-x).exp_m1() - x * (-x).exp()) / (x * x)
        }
    }

    /// Area of the disc.
    pub fn area(&self) -> f64 {
        PI * self.radius * self.radius
    }
}
