use super::*;
use std::collections::BTreeMap;
use tyndall_needs::needs;

#[needs(gpu)]
#[test]
fn points_of_the_directional_dipole_are_those_of_the_truth() {
    let (mut media, mut cases, mut expected) = (Vec::new(), Vec::new(), Vec::new());
    for case in truth!("sd_points") {
        let medium = medium_of(&case);
        for (kind, boundary) in [("fit", Boundary::fit(medium.eta)), ("exact", Boundary::exact(medium.eta))] {
            cases.push(Case {
                between: (vector(&case, "xo") - vector(&case, "xi")).as_vec3(),
                medium: media.len() as u32,
                n_i: vector(&case, "ni").as_vec3(),
                to_light: vector(&case, "wi").as_vec3(),
                n_o: vector(&case, "no").as_vec3(),
                first: vector(&case, "wo").dot(vector(&case, "no")) as f32,
                ..Default::default()
            });
            media.push(uncalibrated(&medium, boundary, DipoleModel::DirectionalDipole));
            expected.push((kind, case.clone()));
        }
    }
    let body = "
    let medium = media[at.medium];
    let omega_12 = refract_into(at.to_light, at.n_i, dot(at.to_light, at.n_i), medium.eta);
    let s_d = directional_dipole(medium, at.between, at.n_i, omega_12, at.n_o).x;
    let entered = subsurface(medium, at.between, at.n_i, at.to_light, at.n_o).x;
    return vec4f(s_d, entered * fresnel_transmittance(at.first, medium.eta), 0.0, 0.0);";
    let found = evaluate(false, body, &media, &cases);
    let mut groups: BTreeMap<String, (Worst, Worst)> = BTreeMap::new();
    for (found, (kind, case)) in found.iter().zip(expected) {
        let wanted = &case[kind];
        let (id, group) = (case["id"].as_str().unwrap(), case["group"].as_str().unwrap());
        let scale = number(wanted, "S_real").abs().max(number(wanted, "S_virtual").abs()).max(1e-30);
        let (s_d, s_full) = groups.entry(group.to_owned()).or_default();
        s_d.see((f64::from(found.x) - number(wanted, "S_d")).abs() / scale, || format!("{id} {kind}"));
        s_full.see((f64::from(found.y) - number(wanted, "S_full")).abs() / scale, || format!("{id} {kind}"));
    }
    for (group, (s_d, s_full)) in &groups {
        println!("{group}: {:.1e} {} {:.1e} {}", s_d.error, s_d.place, s_full.error, s_full.place);
    }
    for (group, (s_d, s_full)) in groups {
        s_d.check(1e-5, &format!("S_d, {group}"));
        s_full.check(1e-5, &format!("S, {group}"));
    }
}
