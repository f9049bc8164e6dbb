//! Fresnel's equations, Snell's law and the moments of a boundary.

use crate::{close, number, numbers, truth};
use glam::DVec3;
use tyndall::optics::fresnel::{diffuse_reflectance_polynomial, reflectance, refract, transmittance};
use tyndall::optics::moments::{Boundary, three_c2, two_c1};

const INDICES: [f64; 10] = [0.4, 0.7, 0.95, 0.999999, 1.0, 1.0000001, 1.1, 1.5, 2.5, 3.0];

#[test]
fn moments_are_exact_and_fits_are_as_published() {
    for case in truth!("fresnel_moments", 22) {
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
            close(found, expected, expected.abs().max(1.0), 1e-12, &format!("{name} at {eta}"));
        }
    }
}

#[test]
fn reflectances_are_exact() {
    for case in truth!("fresnel_moments", 22) {
        let eta = number(&case, "eta");
        for (name, n) in [("fresnel_R_entering", eta), ("fresnel_R_leaving", eta.recip())] {
            for (cos, expected) in numbers(&case, "fresnel_cos").into_iter().zip(numbers(&case, name)) {
                close(reflectance(cos, n), expected, 1.0, 1e-12, &format!("{name} at {eta}, {cos}"));
            }
        }
    }
}

#[test]
fn closed_form_and_quadrature_agree_on_the_first_moment() {
    for n in [1.02f64, 1.1, 1.3, 1.5, 2.0, 2.5, 3.0] {
        let (n2, n4) = (n * n, n.powi(4));
        let rho = 0.5
            + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
            + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
            - 2.0 * n.powi(3) * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
            + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln();
        // The closed form itself loses digits next to 1.
        close(two_c1(n.recip()), rho, 1.0, 1e-10, &format!("from outside at {n}"));
        close(two_c1(n), 1.0 - (1.0 - rho) / n2, 1.0, 1e-10, &format!("from inside at {n}"));
    }
}

#[test]
fn without_a_contrast_there_is_no_boundary() {
    let none = Boundary { eta: 1.0, c_phi: 0.25, c_e: 0.5, a: 1.0, c_phi_inverse: 0.25 };
    assert_eq!(Boundary::exact(1.0), none);
    for eta in [1.0 - 1e-9, 1.0 + 1e-9] {
        let near = Boundary::exact(eta);
        for (found, expected) in
            [(near.c_phi, 0.25), (near.c_e, 0.5), (near.a, 1.0), (near.c_phi_inverse, 0.25)]
        {
            close(found, expected, 1.0, 1e-7, &format!("next to an index of {eta}"));
        }
    }
    for cos in [0.0, 1e-9, 0.5, 1.0] {
        assert_eq!(reflectance(cos, 1.0), 0.0);
    }
    let omega_i = DVec3::new(0.6, 0.0, 0.8);
    assert_eq!(refract(omega_i, DVec3::Z, 1.0), Some(-omega_i));
}

#[test]
fn fits_are_near_the_moments_where_they_hold() {
    for step in 0..=84 {
        let eta = 0.4 + 0.025 * f64::from(step);
        let (exact, fit) = (Boundary::exact(eta), Boundary::fit(eta));
        assert!(Boundary::fit_holds(eta));
        close(fit.c_phi, exact.c_phi, 1.0, 2e-3, &format!("C_phi at {eta}"));
        close(fit.c_e, exact.c_e, 1.0, 4e-3, &format!("C_E at {eta}"));
    }
    assert!(!Boundary::fit_holds(2.9) && !Boundary::fit_holds(0.39) && Boundary::fit(3.0).c_phi < 0.0);
}

#[test]
fn power_is_kept_and_paths_can_be_reversed() {
    for n in INDICES {
        for step in 0..=1000 {
            let cos = f64::from(step) / 1000.0;
            let reflected = reflectance(cos, n);
            assert!((0.0..=1.0).contains(&reflected), "{reflected} at {cos}, {n}");
            assert_eq!(reflected + transmittance(cos, n), 1.0);
            let sin_beyond = (1.0 - cos * cos).sqrt() / n;
            if sin_beyond < 1.0 {
                let back = reflectance(((1.0 - sin_beyond) * (1.0 + sin_beyond)).sqrt(), n.recip());
                close(reflected, back, 1.0, 1e-6, &format!("both ways at {cos}, {n}"));
            } else if sin_beyond > 1.0 {
                assert_eq!(reflected, 1.0, "totally at {cos}, {n}");
            }
        }
        close(reflectance(1.0, n), ((n - 1.0) / (n + 1.0)).powi(2), 1.0, 1e-15, "straight on");
        close(reflectance(0.0, n), if n == 1.0 { 0.0 } else { 1.0 }, 1.0, 1e-15, &format!("grazing at {n}"));
    }
}

#[test]
fn light_bends_by_snells_law() {
    let normal = DVec3::new(1.0, -2.0, 2.0) / 3.0;
    let tangent = DVec3::new(2.0, 2.0, 1.0) / 3.0;
    for eta in INDICES {
        for angle in [0.0, 0.3, 1.0, 1.5] {
            let (sin, cos) = f64::sin_cos(angle);
            let Some(inside) = refract(normal * cos + tangent * sin, normal, eta) else {
                assert!(sin > eta, "no way in at {angle}, {eta}");
                assert_eq!(reflectance(cos, eta), 1.0);
                continue;
            };
            close(inside.length(), 1.0, 1.0, 1e-14, "length");
            close(inside.dot(tangent) * eta, -sin, 1.0, 1e-14, "Snell's law");
            assert!(inside.dot(normal) <= 0.0 && inside.cross(normal).dot(tangent).abs() < 1e-14);
        }
    }
}
