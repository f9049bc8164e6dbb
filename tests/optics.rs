//! Formulas against values computed in many digits, and against what physics demands of them.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::DVec3;
use serde_json::Value;

/// The cases of a file of truth.
macro_rules! truth {
    ($name:literal) => {{
        let file: Value = serde_json::from_str(include_str!(concat!("truth/", $name, ".json"))).unwrap();
        file["cases"].as_array().unwrap().clone()
    }};
}

/// The number under a name.
fn number(case: &Value, name: &str) -> f64 {
    case[name].as_f64().unwrap_or_else(|| panic!("no number {name} in {case}"))
}

/// The numbers under a name.
fn numbers(case: &Value, name: &str) -> Vec<f64> {
    case[name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

/// The vector under a name.
fn vector(case: &Value, name: &str) -> DVec3 {
    DVec3::from_slice(&numbers(case, name))
}

/// The medium of a case.
fn medium(case: &Value) -> Medium {
    let value = |name| number(case, name);
    Medium { sigma_a: value("sigma_a"), sigma_s: value("sigma_s"), g: value("g"), eta: value("eta") }
}

/// That `found` is within `tolerance` of `expected`, relative to `scale`.
#[track_caller]
fn close(found: f64, expected: f64, scale: f64, tolerance: f64, what: &str) {
    let error = (found - expected).abs() / scale;
    assert!(error <= tolerance, "{what}: {found} is not {expected}, off by {error:e}");
}

use tyndall::optics::medium::Medium;

/// Fresnel's equations and their moments.
mod boundary {
    use super::*;
    use tyndall::optics::fresnel::{diffuse_reflectance_polynomial, reflectance};
    use tyndall::optics::moments::{Boundary, three_c2, two_c1};

    #[test]
    fn moments_are_exact_and_fits_are_as_published() {
        for case in truth!("fresnel_moments") {
            let eta = number(&case, "eta");
            let (exact, fit) = (Boundary::exact(eta), Boundary::fit(eta));
            let pairs = [
                ("twoC1_exact", two_c1(eta)),
                ("threeC2_exact", three_c2(eta)),
                ("C_phi_exact", exact.c_phi),
                ("C_E_exact", exact.c_e),
                ("A_exact", exact.a),
                ("C_phi_inv_exact", exact.c_phi_inverse),
                ("twoC1_fit", 1.0 - 4.0 * fit.c_phi),
                ("threeC2_fit", 1.0 - 2.0 * fit.c_e),
                ("A_fit", fit.a),
                ("C_phi_inv_fit", fit.c_phi_inverse),
                ("Fdr_poly_jensen", diffuse_reflectance_polynomial(eta)),
            ];
            for (name, found) in pairs {
                let expected = number(&case, name);
                // The polynomial of 3 C2 has terms of some 1600 that cancel; A divides by what is left near its pole at 2.9.
                close(found, expected, expected.abs().max(1.0), 1e-12, &format!("{name} at {eta}"));
            }
        }
    }

    #[test]
    fn reflectances_are_exact() {
        for case in truth!("fresnel_moments") {
            let eta = number(&case, "eta");
            for (name, n) in [("fresnel_R_entering", eta), ("fresnel_R_leaving", eta.recip())] {
                for (cos, expected) in numbers(&case, "fresnel_cos").into_iter().zip(numbers(&case, name)) {
                    close(reflectance(cos, n), expected, 1.0, 1e-12, &format!("{name} at {eta}, {cos}"));
                }
            }
        }
    }
}

/// The directional dipole at points.
mod directional_dipole {
    use super::*;
    use tyndall::optics::dipole::{DirectionalDipole, Entry, Exit};
    use tyndall::optics::fresnel::{refract, transmittance};
    use tyndall::optics::moments::Boundary;

    #[test]
    fn points_and_all_intermediate_values_are_exact() {
        let mut worst = [0f64; 2];
        for case in truth!("sd_points") {
            for (kind, boundary) in
                [("fit", Boundary::fit as fn(f64) -> Boundary), ("exact", Boundary::exact)]
            {
                let medium = medium(&case);
                let dipole = DirectionalDipole {
                    diffusion: medium.diffusion(),
                    boundary: boundary(medium.eta),
                    least_distance: 0.0,
                };
                let (id, wanted) = (case["id"].as_str().unwrap(), &case[kind]);
                let (normal, exit_normal) = (vector(&case, "ni"), vector(&case, "no"));
                let omega_i = vector(&case, "wi");
                let direction = refract(omega_i, normal, medium.eta).unwrap();
                let entry = Entry { position: vector(&case, "xi"), normal, direction };
                let exit = Exit { position: vector(&case, "xo"), normal: exit_normal };
                let terms = dipole.terms(&entry, &exit);
                let t12 = transmittance(omega_i.dot(normal), medium.eta);
                let t21 = transmittance(vector(&case, "wo").dot(exit_normal), medium.eta);
                let names = [
                    ("D", dipole.diffusion.d),
                    ("alpha_p", dipole.diffusion.albedo_prime),
                    ("mu_eff", dipole.diffusion.mu),
                    ("d_e", dipole.diffusion.d_e),
                    ("C_phi", dipole.boundary.c_phi),
                    ("C_phi_inv", dipole.boundary.c_phi_inverse),
                    ("C_E", dipole.boundary.c_e),
                    ("A", dipole.boundary.a),
                    ("mu0", terms.mu0),
                    ("d_r", terms.d_r),
                    ("d_v", terms.d_v),
                    ("T12", t12),
                    ("T21", t21),
                ];
                for (name, found) in names {
                    let expected = number(wanted, name);
                    close(
                        found,
                        expected,
                        expected.abs().max(1e-3),
                        1e-11,
                        &format!("{name} of {kind} {id}"),
                    );
                }
                assert!((direction - vector(wanted, "w12")).length() < 1e-11, "{id}: {direction}");
                assert!((terms.n_star - vector(wanted, "n_star")).length() < 1e-9, "{id}: {}", terms.n_star);
                assert_eq!(terms.degenerate, wanted["degenerate"].as_bool().unwrap(), "{id}");
                let s_d = dipole.s_d(&entry, &exit);
                let scale = number(wanted, "S_real").abs().max(number(wanted, "S_virtual").abs()).max(1e-30);
                let values = [
                    ("S_real", terms.s_real),
                    ("S_virtual", terms.s_virtual),
                    ("S_d", s_d),
                    ("S_d_clamped", s_d.max(0.0)),
                    ("S_full", t12 * s_d.max(0.0) * t21),
                ];
                for (i, (name, found)) in values.into_iter().enumerate() {
                    let error = (found - number(wanted, name)).abs() / scale;
                    worst[(i >= 2) as usize] = worst[(i >= 2) as usize].max(error);
                    if error > 1e-12 {
                        println!("{id} {} {name} {error:e}", case["group"]);
                    }
                    close(found, number(wanted, name), scale, 1e-11, &format!("{name} of {kind} {id}"));
                }
            }
        }
        println!("worst {worst:?}");
    }
}
