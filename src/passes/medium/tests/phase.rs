use super::*;
use crate::optics::phase::{henyey_greenstein, henyey_greenstein_cos};
use tyndall_needs::needs;

/// Every g of the truth, and ones closer to 1.
fn all_g() -> Vec<f32> {
    let truth = truth!("hg").iter().map(|case| number(case, "g") as f32).collect::<Vec<_>>();
    [truth, vec![-0.999, 0.999, -0.9999, 0.9999, 1e-30]].concat()
}

/// Directions of travel at a cosine, as 32 bits hold them, askew to the axes, and their cosine less 1 and plus 1 in 64 bits.
fn directions(cos: f64) -> (Vec3, Vec3, f64, f64) {
    let before = DVec3::new(0.36, -0.48, 0.8);
    let across = DVec3::new(0.8, 0.6, 0.0);
    let after = before * cos + across * ((1.0 - cos) * (1.0 + cos)).sqrt();
    let (before, after) = (before.as_vec3(), after.as_vec3());
    let (a, b) = (before.as_dvec3().normalize(), after.as_dvec3().normalize());
    (before, after, 0.5 * (a - b).length_squared(), 0.5 * (a + b).length_squared())
}

#[needs(gpu)]
#[test]
fn values_are_those_of_the_truth() {
    let (mut cases, mut expected) = (Vec::new(), Vec::new());
    for case in truth!("hg") {
        for (cos, value) in numbers(&case, "cos").into_iter().zip(numbers(&case, "p")) {
            let (before, after, ..) = directions(cos);
            let g = number(&case, "g");
            cases.push(Case { n_i: before, n_o: after, first: g as f32, ..Default::default() });
            expected.push((format!("g {g}, cos {cos}"), value));
        }
    }
    let found = evaluate(false, VALUE, &any_medium(), &cases);
    let mut worst = Worst::default();
    for (found, (place, value)) in found.iter().zip(expected) {
        worst.see((f64::from(found.x) - value).abs() / value, || place);
    }
    // Of which most is that 32 bits do not hold the truth's g and directions.
    worst.check(3e-5, "Henyey-Greenstein against the truth, relative");
}

const VALUE: &str = "return vec4f(henyey_greenstein(at.n_i, at.n_o, at.first));";

#[needs(gpu)]
#[test]
fn values_keep_their_digits_at_every_g() {
    let cosines =
        [-1.0, -0.999_999, -0.9999, -0.99, -0.9, -0.5, 0.0, 0.1, 0.5, 0.9, 0.99, 0.9999, 0.999_999, 1.0];
    let (mut cases, mut expected) = (Vec::new(), Vec::new());
    for g in all_g() {
        for cos in cosines {
            let (before, after, above, below) = directions(cos);
            cases.push(Case { n_i: before, n_o: after, first: g, ..Default::default() });
            let cos = if above < below { 1.0 - above } else { below - 1.0 };
            expected.push((format!("g {g}, cos {cos}"), henyey_greenstein(cos, f64::from(g))));
        }
    }
    let found = evaluate(false, VALUE, &any_medium(), &cases);
    let mut worst = Worst::default();
    for (found, (place, value)) in found.iter().zip(expected) {
        worst.see((f64::from(found.x) - value).abs() / value, || place);
    }
    worst.check(5e-6, "Henyey-Greenstein, relative");
}

#[needs(gpu)]
#[test]
fn samples_are_the_inverse_of_the_distribution() {
    let (mut cases, mut expected) = (Vec::new(), Vec::new());
    for case in truth!("hg") {
        let g = number(&case, "g");
        for (u, cos) in numbers(&case, "u").into_iter().zip(numbers(&case, "inverse_cdf_cos")) {
            cases.push(Case { first: u as f32, second: g as f32, ..Default::default() });
            expected.push((format!("g {g}, u {u}"), cos));
        }
    }
    for g in all_g() {
        for step in 0..=1000 {
            let u = step as f32 / 1000.0;
            cases.push(Case { first: u, second: g, ..Default::default() });
            expected.push((format!("g {g}, u {u}"), henyey_greenstein_cos(f64::from(u), f64::from(g))));
        }
    }
    let body = "return vec4f(henyey_greenstein_angle(at.first, at.second), 0.0, 0.0);";
    let found = evaluate(false, body, &any_medium(), &cases);
    let (mut moderate, mut strong) = (Worst::default(), Worst::default());
    for ((found, (place, cos)), case) in found.iter().zip(expected).zip(&cases) {
        let worst = if case.second.abs() < 0.96 { &mut moderate } else { &mut strong };
        worst.see((f64::from(found.x) - cos).abs(), || place.clone());
        assert!((found.x * found.x + found.y * found.y - 1.0).abs() < 1e-6, "{found} at {place}");
    }
    moderate.check(1e-5, "sampled cosine, |g| below 0.96");
    strong.check(2e-4, "sampled cosine, |g| up to 0.9999");
}

#[needs(gpu)]
#[test]
fn sampled_directions_are_spread_about_the_direction_of_travel() {
    const SIDE: usize = 64;
    let befores = [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(0.36, -0.48, 0.8), Vec3::new(-0.6, 0.64, -0.48)];
    let body = "return vec4f(henyey_greenstein_sample(at.n_i, vec2f(at.first, at.second), at.third), 0.0);";
    let (mut length, mut mean, mut across) = (Worst::default(), Worst::default(), Worst::default());
    for g in [-0.99, -0.5, 0.0, 0.3, 0.85, 0.999] {
        for before in befores {
            let at = |index: usize| (index as f32 + 0.5) / SIDE as f32;
            let cases: Vec<Case> = (0..SIDE * SIDE)
                .map(|index| Case {
                    n_i: before,
                    first: at(index / SIDE),
                    second: at(index % SIDE),
                    third: g,
                    ..Default::default()
                })
                .collect();
            let found = evaluate(false, body, &any_medium(), &cases);
            let sum: DVec3 = found.iter().map(|value| value.truncate().as_dvec3()).sum();
            let average = sum / (SIDE * SIDE) as f64;
            let place = || format!("g {g}, {before}");
            for value in &found {
                length.see(f64::from((value.truncate().length() - 1.0).abs()), place);
            }
            // The mean of the cosine is g, within what so many steps in u resolve, and nothing is left across.
            let along = average.dot(before.as_dvec3());
            let inverse = |index: usize| henyey_greenstein_cos(f64::from(at(index)), f64::from(g));
            let expected = (0..SIDE).map(inverse).sum::<f64>() / SIDE as f64;
            assert!((expected - f64::from(g)).abs() < 0.02);
            mean.see((along - expected).abs(), place);
            across.see((average - along * before.as_dvec3()).length(), place);
        }
    }
    length.check(1e-6, "length of sampled directions");
    mean.check(1e-5, "mean cosine");
    across.check(1e-5, "mean across");
}
