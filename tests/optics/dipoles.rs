//! The dipoles at points.

use crate::{close, medium, number, of_albedo, truth, vector};
use glam::DVec3;
use serde_json::Value;
use tyndall::optics::dipole::{DirectionalDipole, Entry, Exit, StandardDipole};
use tyndall::optics::fresnel::{refract, transmittance};
use tyndall::optics::medium::Medium;
use tyndall::optics::moments::Boundary;

/// Compares every number of a case of one kind of moments.
fn compare(case: &Value, kind: &str, boundary: Boundary) {
    let medium = medium(case);
    let dipole = DirectionalDipole { diffusion: medium.diffusion(), boundary, least_distance: 0.0 };
    let (wanted, what) = (&case[kind], format!("{kind} of {}", case["id"]));
    let (omega_i, normal) = (vector(case, "wi"), vector(case, "ni"));
    let direction = refract(omega_i, normal, medium.eta).unwrap();
    let entry = Entry { position: vector(case, "xi"), normal, direction };
    let exit = Exit { position: vector(case, "xo"), normal: vector(case, "no") };
    let terms = dipole.terms(&entry, &exit);
    let t12 = transmittance(omega_i.dot(normal), medium.eta);
    let t21 = transmittance(vector(case, "wo").dot(exit.normal), medium.eta);
    let names = [
        ("D", dipole.diffusion.d),
        ("alpha_p", dipole.diffusion.albedo_prime),
        ("mu_eff", dipole.diffusion.mu),
        ("d_e", dipole.diffusion.d_e),
        ("C_phi", boundary.c_phi),
        ("C_phi_inv", boundary.c_phi_inverse),
        ("C_E", boundary.c_e),
        ("A", boundary.a),
        ("mu0", terms.mu0),
        ("d_r", terms.d_r),
        ("d_v", terms.d_v),
        ("T12", t12),
        ("T21", t21),
    ];
    for (name, found) in names {
        let expected = number(wanted, name);
        close(found, expected, expected.abs().max(1e-3), 1e-11, &format!("{name}, {what}"));
    }
    close(direction.distance(vector(wanted, "w12")), 0.0, 1.0, 1e-11, &format!("w12, {what}"));
    // Next to where it falls back the normal is a difference of vectors that nearly agree.
    close(terms.n_star.distance(vector(wanted, "n_star")), 0.0, 1.0, 1e-9, &format!("n_star, {what}"));
    assert_eq!(terms.degenerate, wanted["degenerate"].as_bool().unwrap(), "{what}");

    let s_d = dipole.s_d(&entry, &exit);
    let scale = number(wanted, "S_real").abs().max(number(wanted, "S_virtual").abs()).max(1e-30);
    let values = [
        ("S_real", terms.s_real),
        ("S_virtual", terms.s_virtual),
        ("S_d", s_d),
        ("S_d_clamped", s_d.max(0.0)),
        ("S_full", t12 * s_d.max(0.0) * t21),
    ];
    for (name, found) in values {
        close(found, number(wanted, name), scale, 1e-11, &format!("{name}, {what}"));
    }
}

#[test]
fn points_and_all_between_are_exact() {
    for case in truth!("sd_points", 139) {
        let eta = number(&case, "eta");
        compare(&case, "fit", Boundary::fit(eta));
        compare(&case, "exact", Boundary::exact(eta));
    }
}

#[test]
fn standard_dipole_reflects_what_was_published() {
    for case in truth!("materials", 11) {
        let channels = |name: &str| crate::numbers(&case, name);
        let totals = channels("std_dipole_total");
        for (channel, expected) in totals.into_iter().enumerate() {
            let sigma_s = channels("sigma_s_prime_per_mm")[channel];
            let sigma_a = channels("sigma_a_per_mm")[channel];
            let medium = Medium { sigma_a, sigma_s, g: 0.0, eta: number(&case, "eta") };
            close(StandardDipole::new(&medium).total(), expected, expected, 1e-12, &case["name"].to_string());
        }
    }
}

/// A pair of points on a plane, light arriving at 45 degrees outside.
fn flat(distance: f64, eta: f64) -> (Entry, Exit) {
    let omega_i = DVec3::new(0.5, 0.5, 0.5f64.sqrt());
    let direction = refract(omega_i, DVec3::Z, eta).unwrap();
    let entry = Entry { position: DVec3::ZERO, normal: DVec3::Z, direction };
    (entry, Exit { position: DVec3::X * distance, normal: DVec3::Z })
}

#[test]
fn the_unit_of_length_does_not_matter() {
    let (entry, exit) = flat(0.7, 1.3);
    let plain = DirectionalDipole::new(&of_albedo(0.9, 0.3, 1.3)).s_d(&entry, &exit);
    for exponent in -15..=15 {
        let unit = 10f64.powi(exponent);
        let Medium { sigma_a, sigma_s, g, eta } = of_albedo(0.9, 0.3, 1.3);
        let medium = Medium { sigma_a: sigma_a * unit, sigma_s: sigma_s * unit, g, eta };
        let exit = Exit { position: exit.position / unit, ..exit };
        let found = DirectionalDipole::new(&medium).s_d(&entry, &exit);
        close(found / (unit * unit), plain, plain, 1e-11, &format!("10^{exponent}"));
    }
}

#[test]
fn nothing_leaves_a_medium_that_does_not_scatter() {
    for sigma_a in [0.0, 1.0] {
        let medium = Medium { sigma_a, sigma_s: 0.0, g: 0.5, eta: 1.3 };
        let (entry, exit) = flat(1.0, 1.3);
        assert_eq!(DirectionalDipole::new(&medium).s_d(&entry, &exit), 0.0);
        assert_eq!(StandardDipole::new(&medium).r_d(1.0), 0.0);
        assert_eq!(StandardDipole::new(&medium).total(), 0.0);
    }
}

#[test]
fn values_are_finite_at_any_distance_on_a_plane() {
    for albedo_prime in [1e-12, 0.01, 0.5, 0.99, 1.0 - 1e-12, 1.0] {
        for eta in [0.8, 1.0, 1.3, 2.5] {
            let dipole = DirectionalDipole::new(&of_albedo(albedo_prime, 0.0, eta));
            for exponent in -30..=30 {
                let (entry, exit) = flat(10f64.powi(exponent), eta);
                let s_d = dipole.s_d(&entry, &exit);
                assert!(s_d.is_finite(), "{s_d} at 10^{exponent}, {albedo_prime}, {eta}");
            }
        }
    }
}

/// The model jumps where the exit turns away from the light, and grows without bound next to an edge: both are as published.
#[test]
fn a_least_distance_bounds_the_growth_at_edges() {
    let medium = Medium { sigma_a: 0.0025, sigma_s: 1.22, g: 0.0, eta: 1.3 };
    let entry = Entry { position: DVec3::ZERO, normal: DVec3::Z, direction: -DVec3::Z };
    // A wall below the lit edge, turned a little to the light or away from it.
    let wall = |distance: f64, mu0: f64| Exit {
        position: -DVec3::Z * distance + DVec3::X * 1e-3 * distance,
        normal: DVec3::new((1.0 - mu0 * mu0).sqrt(), 0.0, mu0),
    };
    let published = DirectionalDipole::new(&medium);
    let bounded = DirectionalDipole { least_distance: published.diffusion.d, ..published };
    let jump = |dipole: &DirectionalDipole, distance| {
        (dipole.s_d(&entry, &wall(distance, 1e-6)), dipole.s_d(&entry, &wall(distance, -1e-6)))
    };
    let (lit, unlit) = jump(&published, 1e-3);
    assert!(lit > 1e4 && unlit < 1.0, "{lit}, {unlit}");
    let (lit, unlit) = jump(&bounded, 1e-3);
    assert!(lit.abs() < 1.0 && unlit.abs() < 1.0, "{lit}, {unlit}");
    // Away from the edge the bound changes nothing.
    assert_eq!(jump(&published, 1.0), jump(&bounded, 1.0));
}
