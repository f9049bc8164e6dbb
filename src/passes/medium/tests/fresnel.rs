use super::*;
use crate::optics::fresnel::{reflectance, refract};
use tyndall_needs::needs;

#[needs(gpu)]
#[test]
fn reflectances_are_those_of_the_truth() {
    let (mut cases, mut expected) = (Vec::new(), Vec::new());
    for case in truth!("fresnel_moments") {
        let eta = number(&case, "eta");
        for (name, n) in [("fresnel_R_entering", eta), ("fresnel_R_leaving", eta.recip())] {
            for (cos, value) in numbers(&case, "fresnel_cos").into_iter().zip(numbers(&case, name)) {
                cases.push(Case { first: cos as f32, second: n as f32, ..Default::default() });
                expected.push((format!("{name} at {eta}, {cos}"), value));
            }
        }
    }
    let body = "return vec4f(fresnel_reflectance(at.first, at.second), fresnel_transmittance(at.first, at.second), 0.0, 0.0);";
    let found = evaluate(false, body, &any_medium(), &cases);
    let (mut given, mut rounded) = (Worst::default(), Worst::default());
    for ((found, case), (name, value)) in found.iter().zip(&cases).zip(expected) {
        given.see((f64::from(found.x) - value).abs(), || name.clone());
        given.see((f64::from(found.y) - 1.0 + value).abs(), || name.clone());
        let value = reflectance(f64::from(case.first), f64::from(case.second));
        rounded.see((f64::from(found.x) - value).abs(), || name);
    }
    // 32 bits hold n - 1 at an index of 1.0001 to three digits only.
    given.check(2e-5, "Fresnel reflectance against the truth");
    rounded.check(3e-6, "Fresnel reflectance of what 32 bits hold of the index");
}

#[needs(gpu)]
#[test]
fn reflectance_and_refraction_hold_at_every_index_and_angle() {
    let etas =
        [0.5, 2.0 / 3.0, 0.99, 0.9999, 0.999_999_9, 1.0, 1.000_000_1, 1.0001, 1.01, 1.3, 1.5, 2.0, 3.0];
    let cosines =
        [1.0, 0.9, 0.7, 0.3, 0.1, 0.01, 1e-3, 1e-4, 1e-6, 1e-12, 1e-20, 1e-30, 0.0, -1e-6, -0.5, -1.0];
    let pairs = etas.iter().flat_map(|eta| cosines.iter().map(move |cos| (*eta as f32, *cos as f32)));
    let cases: Vec<Case> = pairs
        .map(|(eta, cos)| {
            let sine = (1.0 - f64::from(cos).powi(2)).sqrt() as f32;
            Case {
                first: cos,
                second: eta,
                to_light: Vec3::new(sine, 0.0, cos),
                n_i: Vec3::Z,
                ..Default::default()
            }
        })
        .collect();
    let body = "return vec4f(fresnel_transmittance(at.first, at.second), refract_into(at.to_light, at.n_i, at.first, at.second));";
    let found = evaluate(false, body, &any_medium(), &cases);
    let (mut power, mut direction) = (Worst::default(), Worst::default());
    for (case, found) in cases.iter().zip(found) {
        let (cos, eta) = (f64::from(case.first), f64::from(case.second));
        let value = if cos > 0.0 { 1.0 - reflectance(cos, eta) } else { 0.0 };
        power.see((f64::from(found.x) - value).abs(), || format!("{eta} {cos}"));
        assert!((0.0..=1.0).contains(&found.x), "{found} at {eta} {cos}");
        if found.x > 0.0
            && let Some(wanted) = refract(case.to_light.as_dvec3(), DVec3::Z, eta)
        {
            let error = (found.truncate_first() - wanted).length();
            direction.see(error, || format!("{eta} {cos}"));
        }
    }
    power.check(1e-5, "transmittance");
    direction.check(1e-6, "refraction");
}

trait TruncateFirst {
    fn truncate_first(&self) -> DVec3;
}

impl TruncateFirst for Vec4 {
    fn truncate_first(&self) -> DVec3 {
        Vec3::new(self.y, self.z, self.w).as_dvec3()
    }
}
