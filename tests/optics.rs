//! Formulas against values computed in many digits, and against what physics demands of them.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "optics/boundary.rs"]
mod boundary;
#[path = "optics/diffusion.rs"]
mod diffusion;
#[path = "optics/dipoles.rs"]
mod dipoles;
#[path = "optics/energy.rs"]
mod energy;
#[path = "optics/phase.rs"]
mod phase;
#[path = "optics/profiles.rs"]
mod profiles;
#[path = "optics/sampling.rs"]
mod sampling;

use glam::DVec3;
use serde_json::Value;
use tyndall::optics::medium::Medium;

/// The cases of a file of truth, at least as many as are known to be in it.
macro_rules! truth {
    ($name:literal, $count:literal) => {{
        let text = include_str!(concat!("../truth/", $name, ".json"));
        let file: serde_json::Value = serde_json::from_str(text).unwrap();
        let cases = file["cases"].as_array().unwrap().clone();
        assert!(cases.len() >= $count, "{} holds {} cases", $name, cases.len());
        cases
    }};
}
pub(crate) use truth;

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

/// Cosine of a case's angle of incidence.
fn incidence(case: &Value) -> f64 {
    number(case, "angle_deg").to_radians().cos()
}

/// A medium of reduced extinction 1 by its reduced albedo.
fn of_albedo(albedo_prime: f64, g: f64, eta: f64) -> Medium {
    Medium { sigma_a: 1.0 - albedo_prime, sigma_s: albedo_prime / (1.0 - g), g, eta }
}

/// That `found` is within `tolerance` of `expected`, relative to `scale`.
#[track_caller]
fn close(found: f64, expected: f64, scale: f64, tolerance: f64, what: &str) {
    let error = (found - expected).abs() / scale;
    assert!(error <= tolerance, "{what}: {found} is not {expected}, off by {error:e}");
}
