//! Volumes some of whose samples are missing: what lies between samples is a mean of those that there are, and ends smoothly.

use super::camera;
use super::support::{Studio, difference};
use tyndall::gpu::GpuOptions;
use tyndall_needs::needs;

/// Samples of a slice, some of which are missing.
fn sample([x, y, _]: [usize; 3]) -> f32 {
    let missing = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -2e30];
    if (5 * x + 3 * y + x * y) % 7 < 3 { missing[(x + y) % 4] } else { ((3 * x + 5 * y) % 11) as f32 / 10.0 }
}

const SIDE: usize = 12;

/// Value and share of what there is at a place of the slice, in voxels, by the definition.
fn field(x: f64, y: f64) -> (f64, f64) {
    let along = |at: f64| {
        let low = (at - 0.5).floor();
        let inside = |at: f64| at.clamp(0.0, SIDE as f64 - 1.0) as usize;
        [(inside(low), 1.0 - (at - 0.5 - low)), (inside(low + 1.0), at - 0.5 - low)]
    };
    let (mut sum, mut share) = (0.0, 0.0);
    for (y, of_y) in along(y) {
        for (x, of_x) in along(x) {
            let value = sample([x, y, 0]);
            if value.abs() <= 1e30 {
                sum += of_x * of_y * f64::from(value);
                share += of_x * of_y;
            }
        }
    }
    (sum / share.max(1e-30), share)
}

/// The slice in a scene, seen from the front, 4 x 4 pixels a voxel.
fn slice(studio: &Studio, classification: &str) -> String {
    studio.volume("slice.raw", [SIDE, SIDE, 1], sample);
    format!(
        "(entities: {{ {} \"v\": (
            Volume: Raw(path: \"slice.raw\", size: ({SIDE}, {SIDE}, 1), format: F32),
            TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 1.0, 1.0), 0.2), (1.0, (1.0, 1.0, 1.0), 0.8)],
                opacity_length: 1.0, classification: {classification}),
            RayCast: (early_termination: 1.0) ) }})",
        camera(20.0, SIDE as f32)
    )
}

/// Radiance of a pixel where extinction holds over the one voxel of the slice's depth.
fn radiance(opacity: f64, shown: f64) -> f64 {
    1.0 - (shown * (1.0 - opacity).ln()).exp()
}

#[needs(gpu)]
#[test]
fn what_lies_between_samples_is_the_mean_of_those_that_there_are() {
    for portable in [false, true] {
        let mut studio = Studio::with(&GpuOptions { portable });
        for classification in ["Post", "PreIntegrated"] {
            let scene = slice(&studio, classification);
            let pixels = studio.radiance(&scene, 4 * SIDE as u32, 4 * SIDE as u32);
            let mut worst: f64 = 0.0;
            for (index, pixel) in pixels.iter().enumerate() {
                let [x, y] = [index % (4 * SIDE), index / (4 * SIDE)].map(|at| (at as f64 + 0.5) / 4.0);
                // Rows go down, y goes up.
                let (value, share) = field(x, SIDE as f64 - y);
                let exact = radiance(0.2 + 0.6 * value, (2.0 * share - 0.5).clamp(0.0, 1.0));
                worst = worst.max((f64::from(pixel[0]) - exact).abs());
            }
            eprintln!("{classification}, portable: {portable}: off by {worst}");
            // The sampler's weights have 8 bits.
            assert!(worst < 6e-3, "{classification}, portable: {portable}: {worst}");
        }
    }
}

#[needs(gpu)]
#[test]
fn classified_voxels_end_as_gradually_as_they_are_interpolated() {
    let mut studio = Studio::new();
    let scene = slice(&studio, "Pre");
    let pixels = studio.radiance(&scene, 4 * SIDE as u32, 4 * SIDE as u32);
    let extinction = |x: usize, y: usize| {
        let value = f64::from(sample([x, y, 0]));
        if value.abs() <= 1e30 { -(1.0 - (0.2 + 0.6 * value)).ln() } else { 0.0 }
    };
    let mut worst: f64 = 0.0;
    for (index, pixel) in pixels.iter().enumerate() {
        let [x, y] =
            [index % (4 * SIDE), 4 * SIDE - 1 - index / (4 * SIDE)].map(|at| (at as f64 + 0.5) / 4.0 - 0.5);
        let [low_x, low_y] = [x, y].map(f64::floor);
        let mut sum = 0.0;
        for (dx, of_x) in [(0.0, 1.0 - (x - low_x)), (1.0, x - low_x)] {
            for (dy, of_y) in [(0.0, 1.0 - (y - low_y)), (1.0, y - low_y)] {
                let [at_x, at_y] =
                    [low_x + dx, low_y + dy].map(|at| at.clamp(0.0, SIDE as f64 - 1.0) as usize);
                sum += of_x * of_y * extinction(at_x, at_y);
            }
        }
        worst = worst.max((f64::from(pixel[0]) - (1.0 - (-sum).exp())).abs());
    }
    eprintln!("classified voxels: off by {worst}");
    assert!(worst < 6e-3, "{worst}");
}

/// A ball of one value, without anything around it, in a light from the side.
fn ball(studio: &Studio, lighting: &str, outside: f32) -> String {
    studio.volume("ball.raw", [32, 32, 32], |place| {
        let [x, y, z] = place.map(|at| at as f32 - 15.5);
        if x * x + y * y + z * z < 144.0 { 0.7 } else { outside }
    });
    format!(
        "(entities: {{ {} \"sun\": ( DirectionalLight: (direction: (-1.0, -0.5, -1.0), irradiance: (3.0, 3.0, 3.0)) ),
            \"v\": (
                Volume: Raw(path: \"ball.raw\", size: (32, 32, 32), format: F32),
                TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (0.8, 0.8, 0.8), 0.0), (0.3, (0.8, 0.8, 0.8), 0.9), (1.0, (0.8, 0.8, 0.8), 0.9)], opacity_length: 1.0),
                VolumeLighting: {lighting}, RayCast: (step: 0.5) ) }})",
        camera(40.0, 32.0)
    )
}

#[needs(gpu)]
#[test]
fn the_end_of_what_there_is_is_shaded_as_a_surface() {
    let mut studio = Studio::new();
    let scene = ball(&studio, "Gradient(ambient: 0.0, diffuse: 1.0, specular: 0.0)", f32::NAN);
    let pixels = studio.radiance(&scene, 64, 64);
    let to_light = glam::DVec3::new(1.0, 0.5, 1.0).normalize();
    let (mut sum, mut flat, mut count) = (0.0, 0.0, 0.0);
    for (index, pixel) in pixels.iter().enumerate() {
        let [x, y] = [index % 64, 63 - index / 64].map(|at| (at as f64 + 0.5) / 2.0 - 16.0);
        let height = 144.0 - x * x - y * y;
        // Where the surface is not seen from its side.
        if height > 36.0 {
            let normal = glam::DVec3::new(x, y, height.sqrt()) / 12.0;
            let full = 0.8 * 3.0 / std::f64::consts::PI;
            let expected = full * normal.dot(to_light).max(0.0);
            sum += (f64::from(pixel[0]) - expected).powi(2);
            flat += (full - expected).powi(2);
            count += 1.0;
        }
    }
    let [error, of_no_normal] = [sum, flat].map(|sum: f64| (sum / count).sqrt());
    eprintln!("RMS error of {count} pixels: {error}; without normals it would be {of_no_normal}");
    assert!(count > 1000.0 && error < 0.1, "{error}");
}

#[needs(gpu)]
#[test]
fn light_passes_what_is_missing_as_if_nothing_were_there() {
    let mut studio = Studio::new();
    let lightings = [
        "EmissionAbsorption",
        "Gradient()",
        "SingleScattering()",
        "LightVolume(g: 0.3)",
        "LightVolume(towards_eye: true, gradient_specular: 0.3)",
    ];
    for lighting in lightings {
        // The outside of the one is missing, that of the other has a value that nothing is to be seen of.
        let masked = ball(&studio, lighting, f32::NAN);
        let masked = studio.radiance(&masked, 48, 48);
        let zeroed = ball(&studio, lighting, 0.0);
        let zeroed = studio.radiance(&zeroed, 48, 48);
        assert!(masked.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
        let [power, reference] =
            [&masked, &zeroed].map(|pixels| pixels.iter().map(|pixel| f64::from(pixel[0])).sum::<f64>());
        let rms =
            masked.iter().zip(&zeroed).map(|(a, b)| f64::from(a[0] - b[0]).powi(2)).sum::<f64>() / 2304.0;
        let brightest = zeroed.iter().map(|pixel| pixel[0]).fold(0.0, f32::max);
        eprintln!("{lighting}: {power} of {reference}, RMS {}", rms.sqrt() / f64::from(brightest));
        assert!(reference > 1.0 && (power / reference - 1.0).abs() < 0.1, "{lighting}: {power}, {reference}");
        assert!(rms.sqrt() < 0.1 * f64::from(brightest), "{lighting}: {}", rms.sqrt());
    }
}

#[needs(gpu)]
#[test]
fn volumes_of_nothing_and_of_one_voxel_are_drawn() {
    let mut studio = Studio::new();
    for classification in ["Post", "Pre", "PreIntegrated"] {
        for lighting in ["EmissionAbsorption", "Gradient(specular: 0.0)", "LightVolume()"] {
            let mut scene = |name: &str, voxels: usize| {
                studio.volume(
                    name,
                    [5, 5, 5],
                    |place| if voxels == 1 && place == [2; 3] { 0.5 } else { f32::NAN },
                );
                let scene = format!(
                    "(background: (0.0, 0.0, 1.0), entities: {{ {} \"sun\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0)) ), \"v\": (
                        Volume: Raw(path: {name:?}, size: (5, 5, 5), format: F32),
                        TransferFunction: (points: [(0.0, (1.0, 0.0, 0.0), 0.9)], opacity_length: 1.0, classification: {classification}),
                        VolumeLighting: {lighting}, RayCast: (early_termination: 1.0) ) }})",
                    camera(20.0, 5.0)
                );
                studio.radiance(&scene, 5, 5)
            };
            let nothing = scene("nothing.raw", 0);
            assert!(
                nothing.iter().all(|pixel| *pixel == [0.0, 0.0, 1.0]),
                "{classification}, {lighting}: {nothing:?}"
            );
            let one = scene("one.raw", 1);
            for (index, pixel) in one.iter().enumerate() {
                let clear = if index == 12 { 0.1 } else { 1.0 };
                assert!((pixel[2] - clear).abs() < 2e-3, "{classification}, {lighting}, {index}: {pixel:?}");
                assert!(
                    (pixel[0] > 0.0) == (index == 12),
                    "{classification}, {lighting}, {index}: {pixel:?}"
                );
            }
        }
    }
}

#[needs(gpu)]
#[test]
fn bricks_beside_what_is_missing_are_skipped_without_a_trace() {
    let mut studio = Studio::new();
    let mut pictures = Vec::new();
    for skip_empty in [true, false] {
        let scene =
            ball(&studio, "Gradient()", f32::NAN).replace("step: 0.5", &format!("skip_empty: {skip_empty}"));
        pictures.push(studio.radiance(&scene, 48, 48));
    }
    assert_eq!(difference(&pictures[0], &pictures[1]), 0.0);
    assert!(pictures[0].iter().any(|pixel| pixel[0] > 0.1));
}
