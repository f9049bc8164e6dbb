//! What half spaces reflect, by the dipoles, exactly, and calibrated.

use crate::{close, incidence, medium, number, of_albedo, truth};
use tyndall::optics::calibration::{Calibration, calibration, directional_reflectance, exact_reflectance};
use tyndall::optics::dipole::{DirectionalDipole, StandardDipole};
use tyndall::optics::fresnel::transmittance;
use tyndall::optics::medium::Medium;
use tyndall::optics::moments::Boundary;

#[test]
fn dipoles_reflect_what_quadrature_says() {
    for case in truth!("rd_semi_infinite", 81) {
        let (medium, cos, id) = (medium(&case), incidence(&case), &case["id"]);
        let entering = transmittance(cos, medium.eta);
        close(entering, number(&case, "T12"), 1.0, 1e-12, &format!("T12 of {id}"));
        let standard = StandardDipole::new(&medium).total();
        for (name, found) in [("std_dipole", entering * standard), ("std_dipole_noT", standard)] {
            let expected = number(&case, name);
            close(found, expected, expected, 1e-4, &format!("{name} of {id}"));
        }
        let exact = DirectionalDipole::new(&medium);
        let published = DirectionalDipole { boundary: Boundary::fit(medium.eta), ..exact };
        for (name, dipole) in [("directional_clamped", published), ("directional_exactcoef", exact)] {
            let expected = number(&case, name);
            close(
                directional_reflectance(&dipole, cos),
                expected,
                expected,
                1e-4,
                &format!("{name} of {id}"),
            );
        }
    }
}

#[test]
fn doubling_is_exact() {
    for case in truth!("rd_semi_infinite", 81) {
        let (medium, cos, expected) = (medium(&case), incidence(&case), number(&case, "exact"));
        let found = exact_reflectance(&medium, &[cos])[0];
        // The truth itself is good to 1e-5.
        close(found, expected, 1.0, 2e-5f64.min(1e-3 * expected).max(1e-5), &format!("{}", case["id"]));
    }
}

#[test]
fn calibrated_dipoles_reflect_what_is_exact() {
    for case in truth!("rd_semi_infinite", 81) {
        let (medium, cos, expected) = (medium(&case), incidence(&case), number(&case, "exact"));
        let dipole = DirectionalDipole::new(&medium);
        let found = calibration(&medium).at(cos) * directional_reflectance(&dipole, cos);
        let tolerance = if medium.diffusion().albedo_prime >= 0.5 { 0.003 } else { 0.006 };
        close(found, expected, expected, tolerance, &format!("{}", case["id"]));
    }
}

#[test]
fn calibration_holds_between_the_angles_it_is_fitted_at() {
    // Without refraction light may arrive next to the horizon, where a parabola does not follow.
    for (eta, least, tolerance) in
        [(1.0, 0.2, 0.05), (1.1, 0.1, 0.02), (1.3, 0.01, 0.005), (2.0, 0.01, 0.005)]
    {
        for albedo_prime in [0.1, 0.5, 0.9, 0.99, 1.0] {
            for g in [0.0, 0.8] {
                let medium = of_albedo(albedo_prime, g, eta);
                let (factor, dipole) = (calibration(&medium), DirectionalDipole::new(&medium));
                for cos in [least, 0.5 * (1.0 + least), 1.0] {
                    let exact = exact_reflectance(&medium, &[cos])[0];
                    let found = factor.at(cos) * directional_reflectance(&dipole, cos);
                    let what = format!("albedo' {albedo_prime}, g {g}, eta {eta} at {cos}");
                    close(found, exact, exact, tolerance, &what);
                }
            }
        }
    }
}

#[test]
fn all_light_leaves_a_medium_that_does_not_absorb() {
    for eta in [0.7, 1.0, 1.3, 2.0, 3.0] {
        for g in [-0.999, -0.5, 0.0, 0.5, 0.9, 0.999] {
            let medium = Medium { sigma_a: 0.0, sigma_s: 3.0, g, eta };
            for (cos, reflected) in
                [0.75, 0.9, 1.0].into_iter().zip(exact_reflectance(&medium, &[0.75, 0.9, 1.0]))
            {
                close(reflected, transmittance(cos, eta), 1.0, 1e-4, &format!("g {g}, eta {eta} at {cos}"));
            }
        }
    }
}

#[test]
fn a_slight_contrast_makes_a_slight_difference() {
    for (albedo_prime, g) in [(0.5, 0.0), (0.9, 0.0), (0.9, 0.8), (0.99, -0.5)] {
        let reflected = |eta| exact_reflectance(&of_albedo(albedo_prime, g, eta), &[0.8])[0];
        for contrast in [1e-12, 1e-6, 3e-5, 1e-4, 1e-3, 3e-3, 1e-2] {
            let what = format!("albedo' {albedo_prime}, g {g}, a contrast of {contrast}");
            close(reflected(1.0 + contrast), reflected(1.0), 1.0, 1e-5 + 3.0 * contrast, &what);
            close(reflected(1.0 - contrast), reflected(1.0), 1.0, 1e-5 + 3.0 * contrast, &what);
        }
    }
}

#[test]
fn more_absorption_reflects_less() {
    for g in [-0.9, 0.0, 0.9] {
        let mut before = 1.0;
        for sigma_a in [1e-9, 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6, 1e12] {
            let reflected = exact_reflectance(&Medium { sigma_a, sigma_s: 1.0, g, eta: 1.3 }, &[0.8])[0];
            assert!(reflected < before && reflected > 0.0, "{reflected} at {sigma_a}, g {g}");
            before = reflected;
        }
    }
}

#[test]
fn a_dim_medium_scatters_once() {
    let (albedo, mu) = (1e-6, 0.6f64);
    let medium = |g| Medium { sigma_a: 1.0 - albedo, sigma_s: albedo, g, eta: 1.0 };
    // Light that is spread evenly: albedo / 2 times the integral of mu' / (mu + mu') (Chandrasekhar 1960, "Radiative transfer").
    let evenly = albedo / 2.0 * (1.0 - mu * (1.0 / mu).ln_1p());
    close(exact_reflectance(&medium(0.0), &[mu])[0], evenly, evenly, 1e-5, "evenly");
    // Light that turns round: half of it, after two ways through the same depth.
    close(exact_reflectance(&medium(-0.999), &[mu])[0], albedo / 2.0, albedo / 2.0, 0.01, "straight back");
}

/// Whether a calibration can be used as it is, at any angle.
fn is_sound(factor: Calibration) -> bool {
    let at = |step| factor.at(f64::from(step) / 100.0);
    (0..=100).all(|step| at(step).is_finite() && at(step) >= 0.0)
}

#[test]
fn calibration_is_sound_for_every_medium() {
    let sigmas = [0.0, 1e-12, 1e-6, 1e-3, 1.0, 1e6, 1e12];
    for sigma_a in sigmas {
        for sigma_s in sigmas {
            for (g, eta) in
                [(-0.999, 0.5), (-0.999, 1.3), (0.0, 0.8), (0.0, 1.0), (0.0, 3.0), (0.999, 0.5), (0.999, 1.0)]
            {
                let medium = Medium { sigma_a, sigma_s, g, eta };
                let factor = calibration(&medium);
                assert!(is_sound(factor), "{medium:?}: {factor:?}");
                assert_eq!(sigma_s == 0.0, factor == Calibration::default(), "{medium:?}: {factor:?}");
            }
        }
    }
}

#[test]
fn calibration_is_sound_at_every_index_and_asymmetry() {
    for eta in [0.1, 0.5, 0.6, 0.8, 0.95, 0.9999, 1.0, 1.0 + 1e-12, 1.0001, 1.05, 1.3, 2.0, 3.0, 10.0] {
        for g in [-1.0, -0.9, -0.3, 0.3, 0.9, 0.99, 1.0] {
            for albedo_prime in [0.01, 0.9] {
                let medium = of_albedo(albedo_prime, f64::clamp(g, -0.9999, 0.9999), eta);
                let medium = Medium { g, ..medium };
                assert!(is_sound(calibration(&medium)), "{medium:?}");
            }
        }
    }
    let broken = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    for value in broken {
        for medium in [
            Medium { sigma_a: value, ..of_albedo(0.9, 0.0, 1.3) },
            Medium { sigma_s: value, ..of_albedo(0.9, 0.0, 1.3) },
            of_albedo(0.9, 0.0, value),
        ] {
            assert_eq!(calibration(&medium), Calibration::default());
            assert_eq!(exact_reflectance(&medium, &[0.5]), [0.0]);
        }
    }
}

#[test]
fn nothing_enters_beyond_the_critical_angle_from_outside() {
    let medium = of_albedo(0.9, 0.0, 0.8);
    for cos in [0.0, 0.3, 0.599] {
        assert_eq!(exact_reflectance(&medium, &[cos]), [0.0]);
        assert_eq!(directional_reflectance(&DirectionalDipole::new(&medium), cos), 0.0);
    }
    assert!(exact_reflectance(&medium, &[0.61])[0] > 0.0);
}
