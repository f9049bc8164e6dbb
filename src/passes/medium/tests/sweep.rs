use super::*;
use crate::optics::dipole::{DirectionalDipole, Entry, Exit};
use crate::optics::fresnel::refract;
use std::time::Instant;
use tyndall_needs::needs;

/// Numbers that look random, the same on every machine (SplitMix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Even in the logarithm.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.between(low, high))
    }

    /// One of some.
    fn of<T: Copy>(&mut self, values: &[T]) -> T {
        values[((self.unit() * values.len() as f64) as usize).min(values.len() - 1)]
    }

    fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sine, cosine) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cosine, across * sine, z)
    }

    /// Per mm: what a scene may sensibly ask for, and now and then the ends of what a file may hold.
    fn sigma(&mut self) -> f64 {
        match self.unit() {
            x if x < 0.1 => 0.0,
            x if x < 0.15 => self.decades(-30.0, 12.0),
            _ => self.decades(-6.0, 6.0),
        }
    }

    fn g(&mut self) -> f64 {
        if self.unit() < 0.3 { self.of(&[0.0, 0.999, -0.999, 0.99]) } else { self.between(-0.999, 0.999) }
    }

    fn eta(&mut self) -> f64 {
        if self.unit() < 0.3 {
            self.of(&[1.0, 1.000_000_119, 0.999_999_94, 1.0001, 0.5, 3.0])
        } else {
            self.between(0.5, 3.0)
        }
    }

    fn media(&mut self) -> [Medium; 3] {
        let (g, eta) = (self.g(), self.eta());
        std::array::from_fn(|_| Medium { sigma_a: self.sigma(), sigma_s: self.sigma(), g, eta })
    }

    /// Where light enters and leaves, within two units of a body.
    fn geometry(&mut self, medium: usize, special: f64) -> Case {
        let n_i = self.direction();
        let sideways = n_i.cross(self.direction()).normalize_or(n_i.any_orthonormal_vector());
        // To the light: anywhere, grazing, along the normal, from below.
        let lean = match self.unit() {
            x if x < 0.4 => self.unit(),
            x if x < 0.5 => 1.0,
            x if x < 0.55 => 0.0,
            x if x < 0.8 => self.decades(-12.0, 0.0),
            x if x < 0.9 => -self.decades(-9.0, 0.0),
            _ => -self.unit(),
        };
        let to_light = n_i * lean + sideways * (1.0 - lean * lean).max(0.0).sqrt();
        let length = match self.unit() {
            x if x < 0.1 => 0.0,
            x if x < 0.2 => 2.0,
            x if x < 0.3 => special.min(2.0),
            x if x < 0.6 => self.decades(-30.0, 0.3),
            _ => self.decades(-6.0, 0.3),
        };
        let along = match self.unit() {
            x if x < 0.15 => n_i,
            x if x < 0.3 => -n_i,
            x if x < 0.4 => (n_i + sideways * self.decades(-9.0, -4.0)).normalize(),
            x if x < 0.6 => sideways,
            _ => self.direction(),
        };
        let n_o = match self.unit() {
            x if x < 0.2 => n_i,
            x if x < 0.3 => -n_i,
            x if x < 0.4 => to_light,
            x if x < 0.5 => sideways,
            _ => self.direction(),
        };
        Case {
            medium: medium as u32,
            between: (along * length).as_vec3(),
            n_i: n_i.as_vec3(),
            to_light: to_light.as_vec3(),
            n_o: n_o.as_vec3(),
            ..Default::default()
        }
    }
}

/// What is to be finite, and its parts.
const VALUES: &str = "
    let medium = media[at.medium];
    return vec4f(subsurface(medium, at.between, at.n_i, at.to_light, at.n_o), 0.0);";

/// The same before negative values are cut, which may hide what is no number.
const UNCUT: &str = "
    let medium = media[at.medium];
    let cosine = dot(at.to_light, at.n_i);
    let omega_12 = refract_into(at.to_light, at.n_i, cosine, medium.eta);
    return vec4f(directional_dipole(medium, at.between, at.n_i, omega_12, at.n_o), fresnel_transmittance(cosine, medium.eta));";

fn is_finite(uniform: &MediumUniform) -> bool {
    let vectors = [
        uniform.sigma_t_prime,
        uniform.mu,
        uniform.d_e,
        uniform.virtual_distance,
        uniform.behind,
        uniform.strength,
        uniform.calibration_0,
        uniform.calibration_1,
        uniform.calibration_2,
    ];
    let scalars = [uniform.eta, uniform.c_phi, uniform.c_e, uniform.least_distance];
    vectors.iter().all(|vector| vector.is_finite()) && scalars.iter().all(|scalar| scalar.is_finite())
}

fn sweep(model: DipoleModel, media: usize, geometries: usize) {
    let mut random = Random(media as u64);
    let (mut uniforms, mut cases, mut meant) = (Vec::new(), Vec::new(), Vec::new());
    let mut longest = 0f64;
    for index in 0..media {
        let channels = random.media();
        let millimetres = random.decades(-6.0, 6.0);
        let start = Instant::now();
        let uniform = Dipole::of(channels, model).uniform(LEAST_DISTANCE, millimetres);
        longest = longest.max(start.elapsed().as_secs_f64());
        assert!(is_finite(&uniform), "{channels:?}, {millimetres} mm: {uniform:?}");
        // Straight to the virtual source.
        let special = f64::from(uniform.virtual_distance.x) / f64::from(uniform.sigma_t_prime.x);
        cases.extend((0..geometries).map(|_| random.geometry(index, special)));
        uniforms.push(uniform);
        meant.push((channels, millimetres, Boundary::exact(channels[0].eta)));
    }
    println!("{model:?}: {} combinations, a medium within {:.1} ms", cases.len(), longest * 1e3);
    let standard = model == DipoleModel::StandardDipole;
    let describe = |case: &Case| {
        format!("{:?} of {:?}, {case:?}", meant[case.medium as usize], uniforms[case.medium as usize])
    };
    let mut bright = [0usize; 3];
    for (case, found) in cases.iter().zip(evaluate(standard, VALUES, &uniforms, &cases)) {
        let value = found.truncate();
        assert!(value.is_finite() && value.min_element() >= 0.0, "{value}: {}", describe(case));
        assert!(
            case.n_i.dot(case.to_light) > -1e-6 || value == Vec3::ZERO,
            "{value} from below: {}",
            describe(case)
        );
        for channel in 0..3 {
            bright[channel] += usize::from(value[channel] > 0.0);
        }
    }
    println!("{bright:?} are above 0");
    assert!(
        bright.iter().all(|bright| *bright > cases.len() / 10),
        "{bright:?} of {} are above 0",
        cases.len()
    );
    if standard {
        return;
    }
    let mut errors = Vec::new();
    for (case, found) in cases.iter().zip(evaluate(false, UNCUT, &uniforms, &cases)) {
        assert!(found.w == 0.0 || found.is_finite(), "{found} before the cut: {}", describe(case));
        let (channels, millimetres, boundary) = &meant[case.medium as usize];
        if found.w > 0.0 {
            errors.extend((0..3).filter_map(|c| {
                Some((off(&channels[c], *boundary, *millimetres, case, found[c])?, case, c))
            }));
        }
    }
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    let at = |share: f64| errors[((errors.len() - 1) as f64 * share) as usize].0;
    println!(
        "of {} values: median {:.1e}, 99 % {:.1e}, 99.9 % {:.1e}, all {:.1e}",
        errors.len(),
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    );
    for (error, case, c) in errors.iter().rev().take(1) {
        println!("{error:.1e} channel {c}: {}", describe(case));
    }
    assert!(at(0.99) < 3e-5 && at(1.0) < 2e-2, "values are off");
}

/// How far a value of `S_d` is from what 64 bits say, relative to the greater of its two terms. Nothing where 32 bits cannot be asked to
/// agree: on the edges at which the model itself jumps, and where next to nothing is left.
fn off(medium: &Medium, boundary: Boundary, millimetres: f64, case: &Case, found: f32) -> Option<f64> {
    let per_unit =
        Medium { sigma_a: medium.sigma_a * millimetres, sigma_s: medium.sigma_s * millimetres, ..*medium };
    let diffusion = per_unit.diffusion();
    let scale = diffusion.sigma_t_prime;
    if medium.sigma_s == 0.0 || !(1e-12..1e13).contains(&scale) {
        return None;
    }
    let dipole = DirectionalDipole { diffusion, boundary, least_distance: LEAST_DISTANCE / scale };
    let [between, normal, to_light, n_o] =
        [case.between, case.n_i, case.to_light, case.n_o].map(|vector| vector.as_dvec3());
    let normal = normal.normalize();
    let direction = refract(to_light.normalize(), normal, medium.eta)?;
    let entry = Entry { position: DVec3::ZERO, normal, direction };
    let exit = Exit { position: between, normal: n_o.normalize() };
    let terms = dipole.terms(&entry, &exit);
    let sine = normal.cross(between.normalize_or_zero()).length();
    let is_point = (1e-45..1e-15).contains(&between.length());
    let jumps = is_point || terms.mu0.abs() < 1e-5 || between != DVec3::ZERO && (1e-9..1e-4).contains(&sine);
    let faded = dipole.diffusion.mu * terms.d_r > 60.0 || terms.d_v * scale < 0.5;
    let whole = terms.s_real.abs().max(terms.s_virtual.abs());
    let value = dipole.s_d(&entry, &exit);
    (!jumps && !faded && whole > 1e-25 * scale * scale).then(|| (f64::from(found) - value).abs() / whole)
}

#[needs(gpu)]
#[test]
fn the_directional_dipole_is_finite_whatever_it_is_given() {
    sweep(DipoleModel::DirectionalDipole, 5_120, 8);
}

#[needs(gpu)]
#[test]
fn the_standard_dipole_is_finite_whatever_it_is_given() {
    sweep(DipoleModel::StandardDipole, 5_120, 8);
}

#[needs(gpu)]
#[test]
fn the_calibrated_dipole_is_finite_whatever_it_is_given() {
    sweep(DipoleModel::CalibratedDipole, 96, 256);
}
