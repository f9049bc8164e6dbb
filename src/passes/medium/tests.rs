//! The shared shaders of scattering in 32 bits, run on the GPU, against values of many digits and over everything that a scene may ask
//! for.
//!
//! Errors measured in 32 bits (llvmpipe), each at most:
//!
//! | what | against | error | tolerance |
//! |---|---|---|---|
//! | `S_d` and `S` at the truth's points, fit and exact moments | 50 digits, by the greater of both sources | 9.5e-7 | 1e-5 |
//! | `S_d` at random, any medium and geometry | 64 bits, by the greater of both sources | 99 %: 1e-5; all: 5e-3 | 3e-5; 2e-2 |
//! | reflectance of a plane, directional dipole | truth, relative | 1.9e-5 | 1e-3 |
//! | reflectance of a plane, standard dipole | truth, relative | 4.2e-7 | 1e-3 |
//! | reflectance of a plane, calibrated dipole | exact transport, relative | 5.2e-3 | 3e-2 |
//! | radial profiles, standard and directional | truth, relative | 7.1e-5 | 1e-3 |
//! | Fresnel's reflectance; the truth's eta of 1.0001 rounded | 64 bits; truth, absolute | 3.1e-7; 1.4e-5 | 3e-6; 2e-5 |
//! | refracted direction | 64 bits | 7.2e-8 | 1e-6 |
//! | Henyey-Greenstein, |g| up to 0.9999 | 64 bits; truth, relative | 3.4e-7; 2.9e-6 | 5e-6; 3e-5 |
//! | its sampled cosine, |g| below 0.96; up to 0.9999 | 64 bits | 1.8e-6; 5.6e-6 | 1e-5; 2e-4 |
//! | two streams: a layer, and a column of three | 64 bits, relative; streams by 1e-3 of the greatest at least | 8.7e-5 | 1e-4 |
//!
//! The 5e-3 are far from the entry or on the normal through it, where the difference of the sources is the last digits of both.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::*;
use crate::gpu::{
    Gpu, GpuOptions, Invocations, Kernel, KernelDescriptor, binding, read_buffer, storage, storage_of,
};
use encase::{ShaderType, StorageBuffer};
use glam::Vec4;
use serde_json::Value;
use std::sync::LazyLock;

mod dipoles;
mod energy;
mod fresnel;
mod phase;
mod sweep;

/// The cases of a file of truth.
macro_rules! truth {
    ($name:literal) => {{
        let text = include_str!(concat!("../../../../tests/truth/", $name, ".json"));
        let file: serde_json::Value = serde_json::from_str(text).unwrap();
        file["cases"].as_array().unwrap().clone()
    }};
}
use truth;

static GPU: LazyLock<Gpu> = LazyLock::new(|| {
    pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap_or_else(|error| panic!("{error}"))
});

/// What one invocation is given.
#[derive(ShaderType, Clone, Copy, Debug, Default)]
struct Case {
    between: Vec3,
    /// Index of the medium.
    medium: u32,
    n_i: Vec3,
    first: f32,
    to_light: Vec3,
    second: f32,
    n_o: Vec3,
    third: f32,
}

/// Around the expression under test.
const FRAME: &str = "
#import bssrdf
#import phase
#import peak

struct Case {
    between: vec3f,
    medium: u32,
    n_i: vec3f,
    first: f32,
    to_light: vec3f,
    second: f32,
    n_o: vec3f,
    third: f32,
}

@group(0) @binding(0) var<storage, read> media: array<Medium>;
@group(0) @binding(1) var<storage, read> cases: array<Case>;
@group(0) @binding(2) var<storage, read_write> results: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index < arrayLength(&cases) {
        results[index] = evaluate(cases[index]);
    }
}
";

/// What the function `evaluate(at: Case) -> vec4f` of this body says of each case.
fn evaluate(standard: bool, body: &str, media: &[MediumUniform], cases: &[Case]) -> Vec<Vec4> {
    let text = format!(
        "{FRAME}const STANDARD_DIPOLE = {standard};\nfn evaluate(at: Case) -> vec4f {{\n{body}\n}}\n"
    );
    let kernel = Kernel::new(
        &GPU,
        &KernelDescriptor {
            name: "optics",
            generated: &[("optics", text)],
            entry_point: "main",
            bindings: &[binding::STORAGE, binding::STORAGE, binding::STORAGE_OUT],
        },
    );
    let kernel = kernel.unwrap_or_else(|error| panic!("{error}"));
    let mut bytes = StorageBuffer::new(Vec::<u8>::new());
    bytes.write(&media).unwrap();
    let media = storage_of(&GPU, "media", &bytes.into_inner());
    let mut bytes = StorageBuffer::new(Vec::<u8>::new());
    bytes.write(&cases).unwrap();
    let given = storage_of(&GPU, "cases", &bytes.into_inner());
    let results = storage(&GPU, "results", 16 * cases.len() as u64);
    let mut encoder = GPU.device.create_command_encoder(&Default::default());
    let resources = [media.as_entire_binding(), given.as_entire_binding(), results.as_entire_binding()];
    kernel.run(&GPU, &mut encoder, &resources, Invocations::Count(cases.len() as u32), None);
    GPU.queue.submit([encoder.finish()]);
    bytemuck::pod_collect_to_vec(&read_buffer(&GPU, &results).unwrap())
}

/// A medium that no test looks at.
fn any_medium() -> Vec<MediumUniform> {
    vec![uncalibrated(
        &Medium { sigma_a: 0.1, sigma_s: 1.0, g: 0.0, eta: 1.3 },
        Boundary::exact(1.3),
        DipoleModel::DirectionalDipole,
    )]
}

/// A medium as published, the same in all channels.
fn uncalibrated(medium: &Medium, boundary: Boundary, model: DipoleModel) -> MediumUniform {
    Dipole { media: [*medium; 3], model, boundary, calibrated: [Calibration([1.0, 0.0, 0.0]); 3] }
        .uniform(0.0, 1.0)
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
fn medium_of(case: &Value) -> Medium {
    let value = |name| number(case, name);
    Medium { sigma_a: value("sigma_a"), sigma_s: value("sigma_s"), g: value("g"), eta: value("eta") }
}

/// The greatest of some errors, and where it is.
#[derive(Debug, Default)]
struct Worst {
    error: f64,
    place: String,
}

impl Worst {
    fn see(&mut self, error: f64, place: impl FnOnce() -> String) {
        if error > self.error || error.is_nan() {
            *self = Self { error: if error.is_nan() { f64::INFINITY } else { error }, place: place() };
        }
    }

    #[track_caller]
    fn check(&self, tolerance: f64, what: &str) {
        println!("{what}: at most {:.1e} ({})", self.error, self.place);
        assert!(self.error <= tolerance, "{what}: off by {:e} at {}", self.error, self.place);
    }
}

#[test]
fn coefficients_that_mean_nothing_make_no_medium() {
    use crate::components::Material;
    let of = |sigma_a: f32, sigma_s: f32, g: f32, eta: f32| {
        let (sigma_a, sigma_s) = (Some(Vec3::splat(sigma_a)), Some(Vec3::splat(sigma_s)));
        let material = Material::Custom { sigma_a, sigma_s, sigma_t: None, albedo: None, g, eta };
        Dipole::new(&Subsurface { material, ..Default::default() })
            .map(|dipole| dipole.uniform(LEAST_DISTANCE, 1.0))
    };
    assert!(of(0.1, 1.0, 0.0, 1.3).is_some());
    assert!(
        of(0.0, 0.0, 0.0, 1.3).is_some_and(|medium| medium.strength == Vec3::ZERO && medium.d_e.is_finite())
    );
    assert!(
        of(0.0, 1.0, 1.0, 1.3).is_some_and(|medium| medium.strength == Vec3::ZERO && medium.d_e.is_finite())
    );
    for (sigma_a, sigma_s, g, eta) in [
        (f32::NAN, 1.0, 0.0, 1.3),
        (0.1, f32::INFINITY, 0.0, 1.3),
        (-0.1, 1.0, 0.0, 1.3),
        (0.1, 1.0, f32::NAN, 1.3),
        (0.1, 1.0, 0.0, 0.0),
    ] {
        assert!(of(sigma_a, sigma_s, g, eta).is_none());
    }
}
