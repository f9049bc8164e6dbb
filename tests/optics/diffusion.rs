//! Light that does not escape and diffuses, against adding and doubling of slabs, and at its extremes.

use crate::{number, truth};
use tyndall::optics::diffusion::{Slab, hemisphere};

fn slab(case: &serde_json::Value) -> Slab {
    let value = |name| number(case, name);
    Slab { tau: value("tau"), albedo: value("albedo"), g: value("g"), mu0: value("mu0") }
}

/// The cosines that stand for all directions in `light_escape`.
fn swept() -> Vec<(f64, f64)> {
    vec![(0.295_875_854_768_068, 2.0 / 3.0), (0.908_248_290_463_863, 1.0 / 3.0)]
}

const LAYERS: usize = 100;

/// Mean errors of reflectance and scattered transmittance, relative, over the slabs of an optical thickness between 0.5 and 10.
fn errors(least_albedo: f64, only: impl Fn(f64) -> bool) -> [f64; 2] {
    let (mut sums, mut count) = ([0.0; 2], 0);
    for case in truth!("slab", 168) {
        let slab = slab(&case);
        if slab.albedo < least_albedo || slab.tau < 0.5 || slab.tau > 10.0 || !only(slab.g) {
            continue;
        }
        let found = slab.of_radiance(LAYERS, &swept());
        for (side, name) in ["R", "T_scattered"].into_iter().enumerate() {
            sums[side] += (found[side] / number(&case, name) - 1.0).abs();
        }
        count += 1;
    }
    assert!(count >= 20, "{count} slabs");
    sums.map(|sum| sum / f64::from(count))
}

#[test]
fn slabs_reflect_and_transmit_nearly_what_they_should() {
    for (name, found, bounds) in [
        ("albedo of at least 0.5", errors(0.5, |_| true), [0.075, 0.085]),
        ("the same, g 0", errors(0.5, |g| g == 0.0), [0.02, 0.06]),
        ("albedo of at least 0.9", errors(0.9, |_| true), [0.075, 0.06]),
    ] {
        println!("{name}: mean errors {found:.4?}");
        assert!(found[0] <= bounds[0] && found[1] <= bounds[1], "{name}: {found:.4?}, {bounds:?}");
    }
}

/// The table of docs/architecture.md: mean errors in percent of reflectance and scattered transmittance, over `g` and `mu0`.
#[test]
fn errors_by_albedo_and_depth() {
    let depths = [0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 50.0];
    for albedo in [0.5, 0.9, 0.99, 1.0] {
        let mut row = format!("| {albedo} |");
        for depth in depths {
            let cases: Vec<_> = truth!("slab", 168)
                .into_iter()
                .filter(|case| number(case, "albedo") == albedo && number(case, "tau") == depth)
                .collect();
            let errors = cases.iter().map(|case| {
                let found = slab(case).of_radiance(LAYERS, &swept());
                ["R", "T_scattered"].map(|name| {
                    let side = usize::from(name != "R");
                    (found[side] / number(case, name) - 1.0).abs()
                })
            });
            let sums = errors.fold([0.0; 2], |sums, error| [sums[0] + error[0], sums[1] + error[1]]);
            let [r, t] = sums.map(|sum| 100.0 * sum / cases.len() as f64);
            assert!(r.is_finite() && t.is_finite() && r < 60.0);
            row += &format!(" {r:.0}, {t:.0} |");
        }
        println!("{row}");
    }
}

/// All that is received is returned, but for what directions that stand for all are off by.
#[test]
fn white_slabs_return_what_they_receive() {
    for tau in [1e-3, 0.1, 1.0, 4.0, 20.0, 300.0] {
        for g in [-0.5, 0.0, 0.5, 0.9] {
            for mu0 in [1.0, 0.5] {
                let slab = Slab { tau, albedo: 1.0, g, mu0 };
                let [r, t] = slab.of_radiance(400, &hemisphere());
                let total = r + t + (-tau / mu0).exp();
                // Evenly scattered light is exact to the quadrature.
                let most = if g == 0.0 { 1.005 } else { 1.03 };
                assert!((0.9..most).contains(&total), "{slab:?}: {total}");
            }
        }
    }
}

#[test]
fn layers_converge() {
    for (albedo, g, mu0, tau) in [(0.9, 0.5, 0.5, 4.0), (0.5, 0.0, 1.0, 2.0), (0.99, 0.9, 0.7, 10.0)] {
        let slab = Slab { tau, albedo, g, mu0 };
        let exact = slab.of_radiance(800, &swept());
        for side in [0, 1] {
            let error = |count| (slab.of_radiance(count, &swept())[side] - exact[side]).abs();
            let [coarse, fine] = [error(25), error(100)];
            assert!(fine < 0.3 * coarse + 1e-5, "{slab:?}: {coarse:e} {fine:e}");
        }
    }
}

#[test]
fn light_diffuses_as_it_should() {
    // Through thick slabs that absorb nothing, fluence falls by 3 (1 - g) of the flux per optical thickness.
    for g in [-0.9, 0.0, 0.8] {
        let slab = Slab { tau: 400.0, albedo: 1.0, g, mu0: 1.0 };
        let fluence = slab.fluence(1000, &hemisphere());
        let [_, net] = slab.of_radiance(1000, &hemisphere());
        let slope = (fluence[450] - fluence[550]) / 40.0;
        assert!((slope / net / (3.0 * (1.0 - g)) - 1.0).abs() < 0.02, "g {g}: {}", slope / net);
    }
}

#[test]
fn extremes_are_finite_and_not_negative() {
    for tau in [0.0, 1e-300, 1e-6, 1.0, 1e3, 1e6] {
        for albedo in [0.0, 1e-6, 0.5, 1.0 - 1e-7, 1.0] {
            for g in [-1.0, -0.999, 0.0, 1e-9, 0.999] {
                for mu0 in [1e-4, 0.5, 1.0] {
                    let slab = Slab { tau, albedo, g, mu0 };
                    let found = slab.fluence(8, &swept());
                    assert!(
                        found.iter().all(|value| value.is_finite() && *value >= 0.0),
                        "{slab:?}: {found:?}"
                    );
                }
            }
        }
    }
}
