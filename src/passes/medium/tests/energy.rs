use super::*;
use std::f64::consts::PI;
use tyndall_needs::needs;

/// Mean of `subsurface` over an arc of radius `first` and angles from `second` to `third`, flat ground all around.
const ARC: &str = "
    const STEPS = 256u;
    var sum = vec3f(0.0);
    for (var step = 0u; step < STEPS; step += 1u) {
        let angle = mix(at.second, at.third, (f32(step) + 0.5) / f32(STEPS));
        let between = at.first * vec3f(cos(angle), sin(angle), 0.0);
        sum += subsurface(media[at.medium], between, at.n_i, at.to_light, at.n_o);
    }
    return vec4f(sum / f32(STEPS), 0.0);";

/// An arc about where light enters at an angle from the normal; azimuth 0 is where the refracted light heads.
fn arc(medium: usize, radius: f64, angles: (f64, f64), incidence: f64) -> Case {
    let (sine, cosine) = incidence.to_radians().sin_cos();
    Case {
        medium: medium as u32,
        n_i: Vec3::Z,
        n_o: Vec3::Z,
        to_light: DVec3::new(-sine, 0.0, cosine).as_vec3(),
        first: radius as f32,
        second: angles.0 as f32,
        third: angles.1 as f32,
        ..Default::default()
    }
}

/// Rings of a plane.
const RINGS: usize = 768;

/// For each of some media and angles the integral of `subsurface` over a plane, times `4 pi C_phi(1 / eta)`: what it reflects.
///
/// Over the logarithm of distance, from where the integrand is flat to where it has died out or falls as the inverse cube.
fn reflectances(standard: bool, media: &[(MediumUniform, Medium, Boundary, f64)]) -> Vec<f64> {
    let range = |medium: &Medium| {
        let diffusion = medium.diffusion();
        let far = (60.0 / (3.0 * diffusion.one_minus_albedo_prime).sqrt()).min(1e6);
        (1e-4 / diffusion.sigma_t_prime, far / diffusion.sigma_t_prime)
    };
    let uniforms: Vec<MediumUniform> = media.iter().map(|(uniform, ..)| uniform.clone()).collect();
    let radius =
        |(near, far): (f64, f64), ring: usize| near * (far / near).powf(ring as f64 / (RINGS - 1) as f64);
    let cases: Vec<Case> = media
        .iter()
        .enumerate()
        .flat_map(|(index, (_, medium, _, angle))| {
            (0..RINGS).map(move |ring| arc(index, radius(range(medium), ring), (0.0, PI), *angle))
        })
        .collect();
    let found = evaluate(standard, ARC, &uniforms, &cases);
    let total = |(rings, (_, medium, boundary, _)): (&[Vec4], &(MediumUniform, Medium, Boundary, f64))| {
        let (near, far) = range(medium);
        let step = (far / near).ln() / (RINGS - 1) as f64;
        let ring = |index: usize| 2.0 * PI * radius((near, far), index).powi(2) * f64::from(rings[index].x);
        let ends = ring(0) + ring(RINGS - 1);
        let middle: f64 = (1..RINGS - 1).map(ring).sum();
        let sum = step * (middle + 0.5 * ends) + 0.5 * ring(0) + ring(RINGS - 1);
        4.0 * PI * boundary.c_phi_inverse * sum
    };
    found.chunks_exact(RINGS).zip(media).map(total).collect()
}

#[needs(gpu)]
#[test]
fn a_plane_reflects_what_each_dipole_is_known_to() {
    let truth = truth!("rd_semi_infinite");
    let each = |model: DipoleModel, fit: bool, least_distance: f64| {
        let media = truth.iter().map(|case| {
            let medium = medium_of(case);
            let boundary = if fit { Boundary::fit(medium.eta) } else { Boundary::exact(medium.eta) };
            let calibration = match model {
                DipoleModel::CalibratedDipole => calibration(&medium),
                _ => Calibration([1.0, 0.0, 0.0]),
            };
            let uniform = Dipole { media: [medium; 3], model, boundary, calibrated: [calibration; 3] }
                .uniform(least_distance, 1.0);
            (uniform, medium, boundary, number(case, "angle_deg"))
        });
        let media: Vec<_> = media.collect();
        reflectances(model == DipoleModel::StandardDipole, &media)
    };
    let compare = |found: &[f64], column: &str, tolerance: f64, what: &str| {
        let mut worst = Worst::default();
        for (found, case) in found.iter().zip(&truth) {
            let value = number(case, column);
            let place = || format!("{} {found} {value}", case["id"]);
            worst.see((found - value).abs() / value, place);
        }
        worst.check(tolerance, what);
    };

    compare(
        &each(DipoleModel::DirectionalDipole, true, 0.0),
        "directional_clamped",
        1e-3,
        "directional, fit",
    );
    compare(
        &each(DipoleModel::DirectionalDipole, true, LEAST_DISTANCE),
        "directional_clamped",
        1e-3,
        "directional, fit, least distance",
    );
    compare(&each(DipoleModel::StandardDipole, false, LEAST_DISTANCE), "std_dipole", 1e-3, "standard");
    compare(&each(DipoleModel::CalibratedDipole, false, LEAST_DISTANCE), "exact", 0.03, "calibrated");
}

#[needs(gpu)]
#[test]
fn light_spreads_as_each_dipole_is_known_to() {
    // Rings of a bin, which spans up to ten lengths over which light dies out, by Simpson's rule.
    const INTERVALS: usize = 32;
    let weight = |place: usize| match place {
        0 | INTERVALS => 1.0 / (3.0 * INTERVALS as f64),
        place => (2 + 2 * (place % 2)) as f64 / (3.0 * INTERVALS as f64),
    };
    for (model, column) in [(DipoleModel::StandardDipole, "R_std"), (DipoleModel::DirectionalDipole, "R_dir")]
    {
        let standard = model == DipoleModel::StandardDipole;
        let (mut whole, mut parts) = (Worst::default(), Worst::default());
        for case in truth!("radial_profiles") {
            let medium = medium_of(&case);
            let boundary = if standard { Boundary::exact(medium.eta) } else { Boundary::fit(medium.eta) };
            let (edges, sectors) = (numbers(&case, "r_edges_mm"), number(&case, "n_sectors") as usize);
            let mut cases = Vec::new();
            for bin in edges.windows(2) {
                for sector in 0..sectors {
                    let angles = [sector, sector + 1].map(|edge| edge as f64 / sectors as f64 * PI);
                    cases.extend((0..=INTERVALS).map(|place| {
                        let radius = bin[0] + (bin[1] - bin[0]) * place as f64 / INTERVALS as f64;
                        arc(0, radius, (angles[0], angles[1]), number(&case, "angle_deg"))
                    }));
                }
            }
            let found = evaluate(standard, ARC, &[uncalibrated(&medium, boundary, model)], &cases);
            let mut rings = found.iter().zip(&cases);
            for (index, bin) in edges.windows(2).enumerate() {
                let area = (bin[1] * bin[1] - bin[0] * bin[0]) / 2.0;
                let means: Vec<f64> = (0..sectors)
                    .map(|_| {
                        let ring = |weight: f64, (value, case): (&Vec4, &Case)| {
                            weight * f64::from(case.first) * f64::from(value.x)
                        };
                        let sum: f64 =
                            (0..=INTERVALS).map(|place| ring(weight(place), rings.next().unwrap())).sum();
                        4.0 * PI * boundary.c_phi_inverse * sum * (bin[1] - bin[0]) / area
                    })
                    .collect();
                let place = |sector: usize| format!("{} bin {index} sector {sector}", case["id"]);
                let value = case[column][index].as_f64().unwrap();
                let mean = means.iter().sum::<f64>() / sectors as f64;
                whole.see((mean - value).abs() / value, || place(9));
                if let Some(row) = case[format!("{column}_sector")].get(index) {
                    for (sector, found) in means.iter().enumerate() {
                        let value = row[sector].as_f64().unwrap();
                        parts.see((found - value).abs() / value, || place(sector));
                    }
                }
            }
        }
        whole.check(1e-3, column);
        // Only the directional dipole knows one from the other.
        assert_eq!(standard, parts.place.is_empty());
        parts.check(1e-3, &format!("{column} by sector"));
    }
}
