use super::*;
use std::time::Instant;

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

    fn sigma(&mut self) -> f64 {
        if self.unit() < 0.1 { 0.0 } else { self.decades(-6.0, 6.0) }
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
        let uniform = MediumUniform::of(&channels, model, LEAST_DISTANCE, millimetres);
        longest = longest.max(start.elapsed().as_secs_f64());
        assert!(is_finite(&uniform), "{channels:?}, {millimetres} mm: {uniform:?}");
        // Straight to the virtual source.
        let special = f64::from(uniform.virtual_distance.x) / f64::from(uniform.sigma_t_prime.x);
        cases.extend((0..geometries).map(|_| random.geometry(index, special)));
        uniforms.push(uniform);
        meant.push((channels, millimetres));
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
        for channel in 0..3 {
            bright[channel] += usize::from(value[channel] > 0.0);
        }
    }
    println!("{bright:?} are above 0");
    if !standard {
        for (case, found) in cases.iter().zip(evaluate(false, UNCUT, &uniforms, &cases)) {
            assert!(found.w == 0.0 || found.is_finite(), "{found} before the cut: {}", describe(case));
        }
    }
}

#[test]
#[cfg_attr(not(tyndall_gpu), ignore = "no graphics adapter")]
fn the_directional_dipole_is_finite_whatever_it_is_given() {
    sweep(DipoleModel::DirectionalDipole, 10_240, 4);
}

#[test]
#[cfg_attr(not(tyndall_gpu), ignore = "no graphics adapter")]
fn the_standard_dipole_is_finite_whatever_it_is_given() {
    sweep(DipoleModel::StandardDipole, 10_240, 4);
}

#[test]
#[cfg_attr(not(tyndall_gpu), ignore = "no graphics adapter")]
fn the_calibrated_dipole_is_finite_whatever_it_is_given() {
    sweep(DipoleModel::CalibratedDipole, 96, 256);
}
