//! Two streams against adding and doubling of slabs, and at their extremes.

use crate::{close, number, truth};
use std::f64::consts::PI;
use tyndall::optics::two_stream::{Cone, Layer, Slab, Stack, Streams, solve};

fn slab(case: &serde_json::Value) -> Slab {
    let value = |name| number(case, name);
    Slab { tau: value("tau"), albedo: value("albedo"), g: value("g"), mu0: value("mu0") }
}

/// Mean and greatest of errors.
fn mean_and_worst(errors: &[f64]) -> (f64, f64) {
    (errors.iter().sum::<f64>() / errors.len() as f64, errors.iter().copied().fold(0.0, f64::max))
}

/// Errors of reflectance and transmittance, relative and absolute, over the slabs of an optical thickness between 0.5 and 10.
fn errors(least_albedo: f64, of: impl Fn(&Slab) -> [f64; 2]) -> [[(f64, f64); 2]; 2] {
    let mut errors: [[Vec<f64>; 2]; 2] = Default::default();
    for case in truth!("slab", 168) {
        let slab = slab(&case);
        if slab.albedo < least_albedo || slab.tau < 0.5 || slab.tau > 10.0 {
            continue;
        }
        for (side, name) in ["R", "T_scattered"].into_iter().enumerate() {
            let (found, expected) = (of(&slab)[side], number(&case, name));
            errors[0][side].push((found / expected - 1.0).abs());
            errors[1][side].push((found - expected).abs());
        }
    }
    assert!(errors[0][0].len() > 60, "{} slabs", errors[0][0].len());
    errors.map(|kind| kind.map(|side| mean_and_worst(&side)))
}

/// That no mean and no greatest error is above a bound.
#[track_caller]
fn check(found: [[(f64, f64); 2]; 2], bounds: [[(f64, f64); 2]; 2]) {
    println!("{found:.4?}");
    for (found, bound) in found.iter().flatten().zip(bounds.iter().flatten()) {
        assert!(found.0 <= bound.0 && found.1 <= bound.1, "{found:.4?} is above {bound:.4?}");
    }
}

#[test]
fn radiance_is_near_the_truth() {
    let of = |slab: &Slab| slab.of_radiance(100);
    check(errors(0.5, of), [[(0.065, 0.28), (0.077, 0.85)], [(0.018, 0.060), (0.011, 0.055)]]);
    check(errors(0.9, of), [[(0.071, 0.28), (0.061, 0.16)], [(0.023, 0.060), (0.014, 0.055)]]);
}

#[test]
fn fluxes_are_near_the_truth() {
    let of = |slab: &Slab| slab.of_fluxes(100);
    // The worst transmittance is of a slab that lets less than 0.00001 of the light through.
    check(errors(0.5, of), [[(0.066, 0.41), (0.102, 0.98)], [(0.008, 0.040), (0.009, 0.040)]]);
    check(errors(0.9, of), [[(0.031, 0.155), (0.048, 0.24)], [(0.008, 0.040), (0.010, 0.040)]]);
}

#[test]
fn what_is_seen_of_a_slab_that_absorbs_nothing_is_little_more_than_its_light() {
    for case in truth!("slab", 168) {
        let slab = slab(&case);
        if slab.albedo < 1.0 || slab.tau > 10.0 {
            continue;
        }
        let [r, t] = slab.of_radiance(100);
        let total = r + t + (-slab.tau / slab.mu0).exp();
        assert!((0.91..1.03).contains(&total), "{slab:?}: {total}");
    }
}

#[test]
fn streams_keep_all_light_if_nothing_absorbs() {
    for tau in [1e-6, 0.01, 1.0, 100.0, 1e6] {
        for g in [-0.999, -0.5, 0.0, 0.5, 0.9, 0.999] {
            for mu0 in [1.0, 0.5, 0.01] {
                for count in [1, 2, 7, 64] {
                    let slab = Slab { tau, albedo: 1.0, g, mu0 };
                    let (layers, streams) = slab.layers(count);
                    let what = format!("{slab:?} in {count}");
                    for layer in &layers {
                        close(layer.r + layer.t, 1.0, 1.0, 1e-14, &what);
                        assert_eq!(layer.absorbed, 0.0);
                    }
                    // All that the beam loses.
                    let beam = (-Cone::new(g).beam(1.0) * tau / mu0).exp();
                    let out = streams[0].backward + streams[count].forward;
                    close(out, mu0 * (1.0 - beam), mu0, 1e-10, &what);
                }
            }
        }
    }
}

#[test]
fn absorbed_and_emitted_is_what_the_beam_and_the_streams_lose() {
    for albedo in [0.0, 0.1, 0.9, 0.999_999] {
        for (tau, g, mu0) in [(1e-3, 0.0, 1.0), (1.0, 0.9, 0.3), (30.0, -0.5, 0.7), (3.0, 0.5, 1.0)] {
            // Absorption is the albedo's complement of the fluence, which fine layers sum well.
            let slab = Slab { tau, albedo, g, mu0 };
            let (layers, streams) = slab.layers(4000);
            let step = tau / layers.len() as f64;
            let fluence = streams.windows(2).map(|pair| 0.5 * (pair[0].fluence() + pair[1].fluence()));
            let absorbed = (1.0 - albedo) * step * fluence.sum::<f64>();
            let cone = Cone::new(g);
            let lost = mu0 * (1.0 - (-cone.beam(albedo) * tau / mu0).exp());
            let source = lost * albedo * cone.beside_peak / cone.beam(albedo);
            let out = streams[0].backward + streams[layers.len()].forward;
            close(out + absorbed, source, source.max(1e-300), 2e-5, &format!("{slab:?}"));
            for layer in layers {
                close(layer.r + layer.t + layer.absorbed, 1.0, 1.0, 1e-14, "a layer's parts");
            }
        }
    }
}

#[test]
fn layers_converge_with_the_square_of_their_number() {
    for (albedo, g, mu0, tau) in [(0.9, 0.5, 0.5, 4.0), (0.5, 0.0, 1.0, 2.0), (0.99, 0.9, 0.7, 10.0)] {
        let slab = Slab { tau, albedo, g, mu0 };
        let exact = slab.of_fluxes(4096);
        for (side, exact) in exact.into_iter().enumerate() {
            let error = |count| (slab.of_fluxes(count)[side] - exact).abs();
            let orders = [16, 32, 64].map(|count| (error(count) / error(2 * count)).log2());
            println!("{slab:?}: errors {:e} {:e}, orders {orders:.3?}", error(1), error(8));
            assert!(orders.iter().all(|order| (1.9..2.15).contains(order)), "{slab:?}: {orders:?}");
        }
    }
}

#[test]
fn light_diffuses_as_it_should() {
    // Through thick slabs that absorb nothing, fluence falls by 3 (1 - g) of the flux per optical thickness.
    for g in [-0.9, 0.0, 0.8] {
        let slab = Slab { tau: 400.0, albedo: 1.0, g, mu0: 1.0 };
        let (_, streams) = slab.layers(1000);
        let net = streams[500].forward - streams[500].backward;
        let slope = (streams[450].fluence() - streams[550].fluence()) / 40.0;
        close(slope / net, 3.0 * (1.0 - g), 3.0, 1e-6, &format!("g {g}"));
    }
}

#[test]
fn extremes_are_finite_and_not_negative() {
    let good = |value: f64| value.is_finite() && value >= 0.0;
    for tau in [0.0, 1e-300, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e12, f64::MAX] {
        for albedo in [0.0, 1e-6, 0.5, 1.0 - 1e-7, 1.0] {
            for g in [-1.0, -0.999, 0.0, 1e-9, 0.999, 1.0] {
                for mu0 in [0.0, 1e-4, 0.5, 1.0] {
                    for beam in
                        [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1e-300], [1.0, 1.0 - 1e-15]]
                    {
                        let layer = Layer::new(&Cone::new(g), tau, albedo, mu0, beam);
                        let Layer { r, t, absorbed, s_forward, s_backward } = layer;
                        let what = format!("{tau} {albedo} {g} {mu0} {beam:?}: {layer:?}");
                        assert!([r, t, absorbed, s_forward, s_backward].into_iter().all(good), "{what}");
                        close(r + t + absorbed, 1.0, 1.0, 1e-12, &what);
                        for Streams { forward, backward } in solve(&[layer; 3]) {
                            assert!(good(forward) && good(backward), "{what}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn g_of_1_leaves_the_beam_as_it_is() {
    let slab = Slab { tau: 5.0, albedo: 0.8, g: 1.0, mu0: 0.6 };
    let (_, streams) = slab.layers(8);
    assert!(streams.iter().all(|streams| *streams == Streams::default()));
    let [r, t] = slab.of_fluxes(8);
    let absorbed = (-0.2f64 * 5.0 / 0.6).exp() - (-5.0f64 / 0.6).exp();
    assert_eq!(r, 0.0);
    close(t, absorbed, 1.0, 1e-14, "all scattered light goes on");
    // And nearly so just below.
    let near = Slab { g: 1.0 - 1e-9, ..slab }.of_fluxes(8);
    close(near[0], 0.0, 1.0, 1e-7, "reflectance near 1");
    close(near[1], t, 1.0, 1e-7, "transmittance near 1");
}

#[test]
fn thick_layers_are_those_of_many_thin_ones() {
    // For diffuse light to rounding.
    let cone = Cone::new(0.3);
    let [whole, part] = [8.0, 0.5].map(|tau| Layer::new(&cone, tau, 0.97, 1.0, [0.0, 0.0]));
    let stack = (0..16).fold(Stack::default(), |stack, _| stack.add(&part));
    close(1.0 - stack.kept, whole.r, 1.0, 1e-14, "reflectance");
    close(
        Streams { forward: 1.0, backward: 0.0 }.scattered(0.0, 0.3),
        1.0 / (4.0 * PI * 0.45),
        1.0,
        1e-15,
        "isotropic",
    );
}
