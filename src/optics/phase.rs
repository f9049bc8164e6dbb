//! Phase functions: how light spreads where it is scattered.

use std::f64::consts::PI;

/// Henyey and Greenstein's phase function (1941), per steradian: its integral over the sphere is 1 and its mean cosine `g`.
///
/// `cos` is between the directions of travel before and after: 1 is straight on. Where both directions point away from the point of
/// scattering it is the negative of their product.
pub fn henyey_greenstein(cos: f64, g: f64) -> f64 {
    (1.0 - g) * (1.0 + g) / (4.0 * PI * spread_squared(cos, g).powf(1.5))
}

/// Probability that light scatters at a cosine of no more than `cos`. Nothing is divided by `g`, unlike in the common form.
pub fn henyey_greenstein_cdf(cos: f64, g: f64) -> f64 {
    let spread = spread_squared(cos, g).sqrt();
    ((1.0 - g) * (1.0 + cos) / (spread * (1.0 + g + spread))).min(1.0)
}

/// Cosine at which light scatters with the probability `u` of no more: the inverse of [`henyey_greenstein_cdf`], for samples.
///
/// The distance of the cosine from 1 or from -1, whichever is less, is what is computed; the common form divides by `2 g`, and fails as
/// that goes to 0.
pub fn henyey_greenstein_cos(u: f64, g: f64) -> f64 {
    let split = if g < 0.0 { (1.0 + g) - 2.0 * g * (1.0 - u) } else { (1.0 - g) + 2.0 * g * u };
    let above = 2.0 * ((1.0 - g) / split).powi(2) * (1.0 - u) * (1.0 + g * u);
    let below = 2.0 * ((1.0 + g) / split).powi(2) * u * (1.0 - g + g * u);
    (if above < below { 1.0 - above } else { below - 1.0 }).clamp(-1.0, 1.0)
}

/// `1 + g² - 2 g cos` as a sum of what cannot cancel.
fn spread_squared(cos: f64, g: f64) -> f64 {
    let away = if g < 0.0 { 1.0 + cos } else { 1.0 - cos };
    (1.0 - g.abs()).powi(2) + 2.0 * g.abs() * away
}
