//! Henyey and Greenstein's phase function.

use crate::{close, number, numbers, truth};
use std::f64::consts::PI;
use tyndall::optics::phase::{henyey_greenstein, henyey_greenstein_cdf, henyey_greenstein_cos};

const ASYMMETRIES: [f64; 13] =
    [-0.999999, -0.999, -0.9, -0.3, -1e-3, -1e-9, 0.0, 1e-17, 1e-9, 0.01, 0.5, 0.95, 0.999999];

#[test]
fn values_and_cumulative_probabilities_are_exact() {
    for case in truth!("hg", 15) {
        let g = number(&case, "g");
        let (values, probabilities) = (numbers(&case, "p"), numbers(&case, "cdf"));
        for (index, cos) in numbers(&case, "cos").into_iter().enumerate() {
            let what = format!("at {cos}, g = {g}");
            // Next to its peak the value for a cosine that is rounded is off by more than the formula is.
            close(henyey_greenstein(cos, g), values[index], values[index], 1e-11, &what);
            close(henyey_greenstein_cdf(cos, g), probabilities[index], 1.0, 1e-12, &what);
        }
        for (u, cos) in numbers(&case, "u").into_iter().zip(numbers(&case, "inverse_cdf_cos")) {
            close(henyey_greenstein_cos(u, g), cos, 1.0, 1e-13, &format!("inverse at {u}, g = {g}"));
        }
    }
}

#[test]
fn samples_have_the_moments_of_the_distribution() {
    const COUNT: u32 = 100_000;
    for case in truth!("hg", 15) {
        let g = number(&case, "g");
        let samples = (0..COUNT).map(|index| {
            let cos = henyey_greenstein_cos((f64::from(index) + 0.5) / f64::from(COUNT), g);
            [cos, cos * cos]
        });
        let [mean, square] = samples.fold([0.0, 0.0], |sum, value| [sum[0] + value[0], sum[1] + value[1]]);
        close(
            mean / f64::from(COUNT),
            number(&case, "mean_cos"),
            1.0,
            2e-6,
            &format!("mean cosine, g = {g}"),
        );
        let expected = number(&case, "mean_cos2");
        close(square / f64::from(COUNT), expected, 1.0, 2e-6, &format!("mean square, g = {g}"));
    }
}

#[test]
fn value_is_the_slope_of_the_cumulative_probability() {
    for g in [-0.9, -0.3, 0.0, 1e-9, 0.5, 0.9] {
        for step in 1..200 {
            let (cos, h) = (-1.0 + 0.01 * f64::from(step), 1e-5);
            let slope = (henyey_greenstein_cdf(cos + h, g) - henyey_greenstein_cdf(cos - h, g)) / (2.0 * h);
            let value = 2.0 * PI * henyey_greenstein(cos, g);
            close(slope, value, value, 1e-5, &format!("at {cos}, g = {g}"));
        }
    }
}

#[test]
fn probability_rises_from_0_to_1_and_is_inverted() {
    for g in ASYMMETRIES {
        assert_eq!(henyey_greenstein_cdf(-1.0, g), 0.0, "g = {g}");
        close(henyey_greenstein_cdf(1.0, g), 1.0, 1.0, 1e-15, &format!("g = {g}"));
        let (mut before, mut sample_before) = (-1.0, -1.0);
        for step in 0..=1000 {
            let u = f64::from(step) / 1000.0;
            let cos = henyey_greenstein_cos(u, g);
            assert!((-1.0..=1.0).contains(&cos) && cos >= sample_before, "g = {g}: {cos} at {u}");
            sample_before = cos;
            // Next to the peak of an extreme g the cosine has not the digits to tell probabilities apart.
            let tolerance = 4e-16 / (1.0 - f64::abs(g)).powi(2) + 1e-12;
            close(henyey_greenstein_cdf(cos, g), u, 1.0, tolerance, &format!("there and back, g = {g}"));
            let probability = henyey_greenstein_cdf(-1.0 + 2.0 * u, g);
            assert!(probability >= before, "g = {g}: {probability} at {u}");
            before = probability;
        }
    }
}

#[test]
fn light_goes_on_where_g_is_positive() {
    for g in ASYMMETRIES {
        let (forward, backward) = (henyey_greenstein(1.0, g), henyey_greenstein(-1.0, g));
        assert!(forward.is_finite() && backward.is_finite() && forward > 0.0 && backward > 0.0);
        if g.abs() > 1e-10 {
            assert_eq!(forward > backward, g > 0.0, "g = {g}");
        }
    }
    close(henyey_greenstein(0.3, 0.0), 1.0 / (4.0 * PI), 1.0, 1e-16, "isotropic");
}
