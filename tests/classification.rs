//! When a transfer function is applied: to samples, to voxels, or to all values between two samples.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use support::{Studio, difference, middle};
use tyndall::gpu::GpuOptions;
use tyndall_needs::needs;

/// A camera on the z axis that looks at the origin, orthographic.
fn camera(z: f64, height: f64) -> String {
    format!(
        "\"eye\": ( ViewCamera: (eye: (0.0, 0.0, {z:?}), projection: Orthographic(height: {height:?})) ),"
    )
}

/// The truth's segments: a field that is linear along the ray, seen from the middle of its first voxel to that of its last.
mod segments {
    use super::*;

    fn cases() -> Vec<serde_json::Value> {
        let truth: serde_json::Value = serde_json::from_str(include_str!("truth/ea_segments.json")).unwrap();
        truth["cases"].as_array().unwrap().clone()
    }

    #[needs(gpu)]
    #[test]
    fn of_few_steps_hold_to_a_thousandth() {
        let mut studio = Studio::new();
        let mut worst = (0.0, String::new());
        for case in cases() {
            for voxels in [2, 8, 16, 23] {
                let error = error(&mut studio, &case, voxels, "PreIntegrated");
                if error > worst.0 {
                    worst = (error, format!("{} of {}, {voxels} voxels", case["id"], case["group"]));
                }
            }
        }
        eprintln!("worst error of few steps: {worst:?}");
        assert!(worst.0 < 1e-3, "{worst:?}");
    }

    #[needs(gpu)]
    #[test]
    fn with_a_spike_are_ten_times_closer_than_classified_samples() {
        let mut studio = Studio::new();
        let mut sums = [0.0; 2];
        let mut spikes = 0;
        for case in cases().iter().filter(|case| case["group"].as_str().unwrap().contains("spike")) {
            spikes += 1;
            for voxels in [16, 24, 33] {
                for (sum, classification) in sums.iter_mut().zip(["Post", "PreIntegrated"]) {
                    *sum += error(&mut studio, case, voxels, classification).abs();
                }
            }
        }
        eprintln!("{spikes} spikes: mean error ratio {}, {sums:?}", sums[0] / sums[1]);
        assert!(spikes > 0 && sums[0] > 10.0 * sums[1], "{sums:?}");
    }

    fn error(studio: &mut Studio, case: &serde_json::Value, voxels: usize, classification: &str) -> f64 {
        (radiance(studio, case, voxels, classification) - case["radiance"].as_f64().unwrap()).abs()
    }

    fn radiance(studio: &mut Studio, case: &serde_json::Value, voxels: usize, classification: &str) -> f64 {
        let number = |name: &str| case[name].as_f64().unwrap();
        let (front, back, length) = (number("s_front"), number("s_back"), number("length"));
        let name = format!("{}_{voxels}.raw", case["id"].as_str().unwrap());
        // The camera looks along -z, so the front of the ray is at the high end.
        studio.volume(&name, [1, 1, voxels], |[_, _, z]| {
            (back + (front - back) * z as f64 / (voxels - 1) as f64) as f32
        });
        let spacing = length / (voxels - 1) as f64;
        let half = length / 2.0;
        let scene = format!(
            "(entities: {{ {eye}
                \"black\": ( Transform: (translation: (0.0, 0.0, {end:?}), rotation: (90.0, 0.0, 0.0)), Mesh: Plane(size: ({length:?}, {length:?})), Phong: (diffuse: (0.0, 0.0, 0.0)) ),
                \"v\": (
                    Volume: Raw(path: {name:?}, size: (1, 1, {voxels}), format: F32, spacing: ({spacing:?}, {spacing:?}, {spacing:?})),
                    {function}
                    RayCast: (early_termination: 1.0),
                ) }})",
            eye = camera(half, spacing * 0.1),
            end = -half,
            function = transfer_function(case, classification),
        );
        f64::from(middle(&studio.radiance(&scene, 1, 1))[0])
    }

    /// Extinction is linear between the truth's points, opacity between ours: over a millionth of the shortest mean free path the two
    /// agree to 1e-6.
    fn transfer_function(case: &serde_json::Value, classification: &str) -> String {
        let points = |name: &str| -> Vec<(f64, f64)> {
            let pairs = case[name].as_array().unwrap();
            pairs.iter().map(|pair| (pair[0].as_f64().unwrap(), pair[1].as_f64().unwrap())).collect()
        };
        let (tau, colour) = (points("tau_tf"), points("color_tf"));
        let length = 1e-6 / tau.iter().fold(0.0, |greatest: f64, point| greatest.max(point.1));
        let mut positions: Vec<f64> = tau.iter().chain(&colour).map(|point| point.0).collect();
        positions.sort_by(f64::total_cmp);
        positions.dedup();
        let written: Vec<String> = positions
            .iter()
            .map(|at| {
                let (c, opacity) = (interpolate(&colour, *at), -(-interpolate(&tau, *at) * length).exp_m1());
                format!("({at:?}, ({c:?}, {c:?}, {c:?}), {opacity:.12})")
            })
            .collect();
        // 1001 entries: every breakpoint of the truth, given in thousandths, is an entry of the table.
        format!(
            "TransferFunction: (domain: (0.0, 1.0), points: [{}], opacity_length: {length:.15}, entries: 1001, classification: {classification}),",
            written.join(", ")
        )
    }

    fn interpolate(points: &[(f64, f64)], at: f64) -> f64 {
        let after = points.iter().position(|point| point.0 >= at).unwrap_or(points.len() - 1);
        let (b, a) = (points[after], points[after.saturating_sub(1)]);
        if b.0 <= at || a.0 >= at || a.0 == b.0 {
            return if a.0 >= at { a.1 } else { b.1 };
        }
        a.1 + (b.1 - a.1) * (at - a.0) / (b.0 - a.0)
    }
}

/// A ball of distances, seen askew, with some function, light and steps.
fn ball(studio: &Studio, function: &str, lighting: &str, ray_cast: &str) -> String {
    studio.volume("ball.raw", [40, 33, 29], |[x, y, z]| {
        let (x, y, z) = (x as f32 - 22.0, y as f32 - 15.0, z as f32 - 14.0);
        (x * x + y * y + z * z).sqrt()
    });
    format!(
        "(background: (0.1, 0.2, 0.3), entities: {{
            \"eye\": ( ViewCamera: (eye: (30.0, 25.0, 60.0), projection: Perspective(vertical_fov: 30.0)) ),
            \"sun\": ( DirectionalLight: (direction: (-1.0, -1.0, -0.5), irradiance: (3.0, 2.0, 1.0)) ),
            \"v\": (
                Transform: (rotation: (10.0, 20.0, 30.0)),
                Volume: Raw(path: \"ball.raw\", size: (40, 33, 29), format: F32),
                TransferFunction: (domain: (0.0, 32.0), {function}),
                VolumeLighting: {lighting},
                RayCast: ({ray_cast}) ) }})"
    )
}

const SMOOTH: &str =
    "points: [(0.1, (0.9, 0.5, 0.1), 0.1), (0.35, (0.9, 0.5, 0.1), 0.3), (0.4, (0.2, 0.6, 0.9), 0.0)]";

/// A surface at a distance of 10 voxels from the middle of the ball.
const SURFACE: &str = "iso: [(value: 10.0, width: 0.0, color: (1.0, 0.5, 0.25), absorption: 3.0)], entries: 256, classification: PreIntegrated";

#[needs(gpu)]
#[test]
fn in_small_steps_samples_and_pairs_agree() {
    let mut studio = Studio::new();
    for lighting in ["EmissionAbsorption", "Gradient()"] {
        let mut seen = |classification: &str| {
            let function = format!("{SMOOTH}, classification: {classification}");
            let scene = ball(&studio, &function, lighting, "step: 0.05, early_termination: 1.0");
            studio.radiance(&scene, 31, 27)
        };
        let found = difference(&seen("Post"), &seen("PreIntegrated"));
        eprintln!("{lighting}: in small steps the two differ by {found}");
        assert!(found < 1e-3, "{lighting}: {found}");
    }
}

#[needs(gpu)]
#[test]
fn leaping_over_empty_bricks_misses_no_surface() {
    let mut studio = Studio::new();
    for step in ["0.7", "3.0", "11.0"] {
        for function in [
            SURFACE,
            &format!("{SMOOTH}, classification: Pre"),
            &format!("{SMOOTH}, classification: PreIntegrated"),
        ] {
            let mut seen = |skip: bool| {
                let ray_cast = format!("step: {step}, early_termination: 1.0, skip_empty: {skip}");
                let scene = ball(&studio, function, "Gradient()", &ray_cast);
                studio.radiance(&scene, 61, 47)
            };
            let found = difference(&seen(true), &seen(false));
            assert!(found < 1e-5, "step {step}, {function}: {found}");
        }
    }
}

#[needs(gpu)]
#[test]
fn the_portable_variant_draws_the_same() {
    for function in [SURFACE, &format!("{SMOOTH}, classification: Pre")] {
        let seen = |options: &GpuOptions| {
            let mut studio = Studio::with(options);
            let scene = ball(&studio, function, "Gradient()", "step: 0.7");
            studio.radiance(&scene, 33, 27)
        };
        let (full, portable) = (seen(&GpuOptions::default()), seen(&GpuOptions { portable: true }));
        assert!(difference(&full, &portable) < 1e-4, "{}", difference(&full, &portable));
    }
}

mod surfaces {
    use super::*;

    #[needs(gpu)]
    #[test]
    fn have_no_holes_and_the_same_depth_at_every_step() {
        let mut studio = Studio::new();
        let n = 48;
        studio.volume("distance.raw", [n, n, n], |cell| {
            let centred = cell.map(|i| i as f32 + 0.5 - n as f32 / 2.0);
            centred.iter().map(|c| c * c).sum::<f32>().sqrt()
        });
        for step in [0.5, 1.0, 2.0] {
            for entries in [64, 256, 1024] {
                let scene = format!(
                    "(background: (0.0, 0.0, 1.0), entities: {{ {} \"v\": (
                        Volume: Raw(path: \"distance.raw\", size: ({n}, {n}, {n}), format: F32),
                        TransferFunction: (domain: (0.0, 42.0), iso: [(value: 16.0, width: 0.0, color: (1.0, 0.0, 0.0), absorption: 0.7)],
                            entries: {entries}, classification: PreIntegrated),
                        RayCast: (step: {step:?}, early_termination: 1.0) ) }})",
                    camera(100.0, 48.0)
                );
                let pixels = studio.radiance(&scene, 96, 96);
                // A ray into the ball crosses its surface twice, one that misses it not at all; values at steps of 2 voxels cut the
                // rim off.
                for (index, pixel) in pixels.iter().enumerate() {
                    let (x, y) = ((index % 96) as f32 / 2.0 - 23.75, (index / 96) as f32 / 2.0 - 23.75);
                    let radius = (x * x + y * y).sqrt();
                    let crossings = if radius < 15.0 {
                        2
                    } else if radius > 17.0 {
                        0
                    } else {
                        continue;
                    };
                    let left = (-0.7 * crossings as f32).exp();
                    assert!(
                        (pixel[2] - left).abs() < 1e-4 && (pixel[0] - (1.0 - left)).abs() < 1e-4,
                        "step {step}, {entries} entries, at {x} {y}: {pixel:?}, expected {left}"
                    );
                }
            }
        }
    }

    /// A ramp from 0 in front to 1 behind over 8 mm from z = 4 to -4, and what is at an iso value of it.
    fn ramp(studio: &Studio, layers: &str, more: &str) -> String {
        studio.volume("ramp.raw", [1, 1, 9], |[_, _, z]| 1.0 - z as f32 / 8.0);
        format!(
            "(background: (0.0, 0.0, 1.0), entities: {{ {} {more} \"v\": (
                Volume: Raw(path: \"ramp.raw\", size: (1, 1, 9), format: F32),
                TransferFunction: (domain: (0.0, 1.0), iso: [{layers}], classification: PreIntegrated),
                RayCast: (step: 1.7, early_termination: 1.0) ) }})",
            camera(20.0, 0.1)
        )
    }

    #[needs(gpu)]
    #[test]
    fn of_any_number_hide_each_other_in_order() {
        let mut studio = Studio::new();
        let layers = "(value: 0.2, width: 0.0, color: (1.0, 0.0, 0.0), absorption: 0.5),
            (value: 0.21, width: 0.0, color: (0.0, 1.0, 0.0), absorption: 1.0),
            (value: 0.8, width: 0.0, color: (0.0, 0.0, 0.0), absorption: 2.0)";
        let seen = middle(&studio.radiance(&ramp(&studio, layers, ""), 1, 1));
        let (a, b) = (f32::exp(-0.5), f32::exp(-1.0));
        let exact = [1.0 - a, a * (1.0 - b), a * b * f32::exp(-2.0)];
        for channel in 0..3 {
            assert!((seen[channel] - exact[channel]).abs() < 2e-4, "{seen:?}, expected {exact:?}");
        }
    }

    #[needs(gpu)]
    #[test]
    fn are_whole_in_front_of_a_mesh_and_hidden_behind_it() {
        let mut studio = Studio::new();
        let layer = "(value: 0.5, width: 0.0, color: (1.0, 0.0, 0.0), absorption: 0.5)";
        // The surface is at z = 0; the last segment, which a plane in its way cuts short, may be the one that crosses it.
        for (z, crossed) in
            [(0.3, false), (0.05, false), (-0.05, true), (-0.3, true), (-1.5, true), (-6.0, true)]
        {
            let plane = format!(
                "\"plane\": ( Transform: (translation: (0.0, 0.0, {z:?}), rotation: (90.0, 0.0, 0.0)), Mesh: Plane(size: (20.0, 20.0)),
                    Phong: (ambient: (0.0, 1.0, 0.0), diffuse: (0.0, 0.0, 0.0)) ),"
            );
            let seen = middle(&studio.radiance(&ramp(&studio, layer, &plane), 1, 1));
            let left = if crossed { f32::exp(-0.5) } else { 1.0 };
            assert!((seen[1] - left).abs() < 1e-4 && (seen[0] - (1.0 - left)).abs() < 1e-4, "{z}: {seen:?}");
        }
    }

    #[needs(gpu)]
    #[test]
    fn of_overlapping_volumes_are_all_seen() {
        let mut studio = Studio::new();
        studio.volume("slope.raw", [2, 2, 8], |[_, _, z]| z as f32);
        let volume = |name: &str, value: f32, step: f32, colour: &str| {
            format!(
                "{name:?}: ( Volume: Raw(path: \"slope.raw\", size: (2, 2, 8), format: F32),
                    TransferFunction: (iso: [(value: {value:?}, width: 0.0, color: {colour}, absorption: 1.0)], entries: 128, classification: PreIntegrated),
                    RayCast: (step: {step:?}, early_termination: 1.0) ),"
            )
        };
        let scene = format!(
            "(background: (0.0, 0.0, 1.0), entities: {{ {} {} {} \"c\": (
                Volume: Raw(path: \"slope.raw\", size: (2, 2, 8), format: F32), TransferFunction: (points: [(0.0, (0.0, 0.0, 0.0), 0.0)]) ) }})",
            camera(20.0, 0.1),
            volume("a", 6.1, 0.9, "(1.0, 0.0, 0.0)"),
            volume("b", 0.7, 2.1, "(0.0, 1.0, 0.0)"),
        );
        let seen = middle(&studio.radiance(&scene, 1, 1));
        let left = f32::exp(-1.0);
        let exact = [1.0 - left, left * (1.0 - left), left * left];
        assert!((0..3).all(|c| (seen[c] - exact[c]).abs() < 1e-4), "{seen:?}, expected {exact:?}");
    }

    #[needs(gpu)]
    #[test]
    fn are_shaded_where_they_are() {
        let mut studio = Studio::new();
        let n = 64;
        studio.volume("ball.raw", [n, n, n], |cell| {
            let centred = cell.map(|i| i as f32 + 0.5 - n as f32 / 2.0);
            centred.iter().map(|c| c * c).sum::<f32>().sqrt() - 24.0
        });
        let scene = format!(
            "(entities: {{ {}
                \"sun\": ( DirectionalLight: (direction: (0.0, -1.0, -1.0), irradiance: (3.14159265, 3.14159265, 3.14159265)) ),
                \"v\": (
                    Volume: Raw(path: \"ball.raw\", size: (64, 64, 64), format: F32),
                    TransferFunction: (domain: (-40.0, 40.0), iso: [(value: 0.0, width: 0.0, color: (1.0, 1.0, 1.0), absorption: 20.0)], classification: PreIntegrated),
                    VolumeLighting: Gradient(ambient: 0.0, diffuse: 1.0, specular: 0.0),
                    RayCast: (step: 2.0) ) }})",
            camera(100.0, 64.0)
        );
        let pixels = studio.radiance(&scene, 64, 64);
        let mut worst = 0.0f32;
        for (index, pixel) in pixels.iter().enumerate() {
            let (x, y) = ((index % 64) as f32 + 0.5 - 32.0, 31.5 - (index / 64) as f32);
            let squared = x * x + y * y;
            if squared < 20.0 * 20.0 {
                let expected = ((y + (24.0f32 * 24.0 - squared).sqrt()) / 24.0 / 2f32.sqrt()).max(0.0);
                worst = worst.max((pixel[0] - expected).abs());
            }
        }
        eprintln!("a surface in steps of two voxels is shaded to within {worst}");
        assert!(worst < 0.01, "{worst}");
    }
}

mod voxels {
    use super::*;

    const N: usize = 6;

    fn sample([x, y, z]: [usize; 3]) -> f64 {
        ((x * 7 + y * 13 + z * 29) % 11) as f64 / 10.0
    }

    /// Colour and extinction between the points (0, red, clear), (0.5, green, 0.3 a voxel) and (1, (2, 0, 4), 0).
    fn classified(value: f64) -> [f64; 4] {
        let table = |entry: usize| {
            let at = entry as f64 / 10.0;
            let (low, share) = if at <= 0.5 { (0, at / 0.5) } else { (1, (at - 0.5) / 0.5) };
            let points = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.3], [2.0, 0.0, 4.0, 0.0]];
            let mut found: [f64; 4] =
                std::array::from_fn(|c| points[low][c] + (points[low + 1][c] - points[low][c]) * share);
            found[3] = -(-found[3]).ln_1p();
            found
        };
        table((value * 10.0).round() as usize)
    }

    /// A ray along -z at (x, y) in steps of one voxel, seen in their middles.
    fn ray(x: f64, y: f64) -> [f64; 3] {
        let (mut radiance, mut left) = ([0.0; 3], 1.0);
        for step in 0..N {
            let at = [x, y, N as f64 - step as f64 - 0.5];
            let mut sum = [0.0; 4];
            for corner in 0..8 {
                let mut weight = 1.0;
                let cell = std::array::from_fn(|axis| {
                    let low = (at[axis] - 0.5).floor();
                    let part = at[axis] - 0.5 - low;
                    let up = corner >> axis & 1;
                    weight *= if up == 1 { part } else { 1.0 - part };
                    (low + up as f64).clamp(0.0, N as f64 - 1.0) as usize
                });
                let found = classified(sample(cell));
                for c in 0..3 {
                    sum[c] += weight * found[c] * found[3];
                }
                sum[3] += weight * found[3];
            }
            let alpha = -(-sum[3]).exp_m1();
            for c in 0..3 {
                radiance[c] += left * alpha * sum[c] / sum[3].max(1e-30);
            }
            left *= 1.0 - alpha;
        }
        radiance
    }

    #[needs(gpu)]
    #[test]
    fn are_interpolated_with_their_colours() {
        let mut studio = Studio::new();
        studio.volume("v.raw", [N; 3], |cell| sample(cell) as f32);
        let scene = format!(
            "(entities: {{ {} \"v\": (
                Volume: Raw(path: \"v.raw\", size: ({N}, {N}, {N}), format: F32),
                TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 0.0, 0.0), 0.0), (0.5, (0.0, 1.0, 0.0), 0.3), (1.0, (2.0, 0.0, 4.0), 0.0)],
                    entries: 11, classification: Pre),
                RayCast: (early_termination: 1.0) ) }})",
            camera(20.0, N as f64)
        );
        let side = 4 * N as u32;
        let pixels = studio.radiance(&scene, side, side);
        let mut worst = 0.0f64;
        for (index, pixel) in pixels.iter().enumerate() {
            let (x, y) = (
                (index as u32 % side) as f64 / 4.0 + 0.125,
                N as f64 - (index as u32 / side) as f64 / 4.0 - 0.125,
            );
            let exact = ray(x, y);
            for c in 0..3 {
                worst = worst.max((f64::from(pixel[c]) - exact[c]).abs());
            }
        }
        eprintln!("classified voxels are off by {worst}");
        assert!(worst < 1e-3, "{worst}");
    }

    #[needs(gpu)]
    #[test]
    fn and_pairs_that_touch_what_is_not_finite_are_transparent() {
        let mut studio = Studio::new();
        studio.volume("holes.raw", [8, 8, 8], |[x, ..]| if x < 4 { 0.5 } else { f32::NAN });
        for classification in ["Pre", "PreIntegrated"] {
            for lighting in ["EmissionAbsorption", "Gradient()"] {
                let scene = format!(
                    "(background: (0.0, 0.0, 1.0), entities: {{ {} \"v\": (
                        Volume: Raw(path: \"holes.raw\", size: (8, 8, 8), format: F32),
                        TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 0.0, 0.0), 0.5)], opacity_length: 1.0, classification: {classification}),
                        VolumeLighting: {lighting}, RayCast: (early_termination: 1.0) ) }})",
                    camera(20.0, 8.0)
                );
                let pixels = studio.radiance(&scene, 8, 8);
                assert!(pixels.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
                for (x, pixel) in pixels[8 * 4..8 * 5].iter().enumerate() {
                    let clear = if x >= 4 { 1.0 } else { 0.5f32.powi(8) };
                    assert!((pixel[2] - clear).abs() < 1e-4, "{classification}, column {x}: {pixel:?}");
                }
            }
        }
    }
}

/// How often passes run, and what they hold.
mod work {
    use super::*;

    #[needs(gpu)]
    #[test]
    fn is_done_again_only_when_the_function_or_the_step_changes() {
        let mut studio = Studio::new();
        studio.volume("v.raw", [4, 4, 4], |[x, ..]| x as f32);
        let scene = "(entities: {
            \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 9.0)) ),
            \"ball\": ( Mesh: Sphere(subdivisions: 2) ),
            \"v\": ( Transform: (scale: 1.0), Volume: Raw(path: \"v.raw\", size: (4, 4, 4), format: F32),
                TransferFunction: (domain: (0.0, 3.0), points: [(0.0, (1.0, 1.0, 1.0), 0.0), (0.5, (1.0, 1.0, 1.0), 0.1), (1.0, (1.0, 1.0, 1.0), 0.2)],
                    entries: 65, classification: PreIntegrated) ) })";
        let mut pairs = |scene: &str| {
            studio.radiance(scene, 8, 8);
            studio.report().passes["preintegrate"].work["pairs"]
        };
        let all = 65 * 65;
        assert_eq!(pairs(scene), all);
        for (before, after) in [
            ("9.0)", "7.0)"),
            ("subdivisions: 2", "subdivisions: 3"),
            ("scale: 1.0", "scale: 1.0, rotation: (13.0, 7.0, 1.0)"),
            ("scale: 1.0", "translation: (0.3, 0.0, 0.0)"),
            ("scale: 1.0),", "), VolumeLighting: Gradient(),"),
        ] {
            let edited = scene.replace(before, after);
            assert_ne!(edited, scene);
            assert_eq!(pairs(&edited), all, "{after}");
        }
        // The upper half of the function, then a longer step, then another scale.
        let edited = scene.replace("0.2)", "0.3)");
        let touched = pairs(&edited) - all;
        assert!(touched > 0 && touched < all, "{touched}");
        assert_eq!(pairs(scene), all + 2 * touched);
        assert_eq!(pairs(&scene.replace(") ) })", "), RayCast: (step: 2.0) ) })")), 2 * (all + touched));
        assert_eq!(pairs(&scene.replace("scale: 1.0", "scale: 3.0")), 3 * all + 2 * touched);
        let held = |studio: &Studio| studio.report().gpu_bytes.get("pre-integrated pairs").copied();
        assert_eq!(held(&studio), Some(65 * 66 * 16));
        studio.radiance(&scene.replace("PreIntegrated", "Post"), 8, 8);
        assert_eq!(held(&studio), None);
    }

    #[needs(gpu)]
    #[test]
    fn on_a_part_of_the_pairs_shows_what_all_of_them_would() {
        let mut studio = Studio::new();
        let scene = |studio: &Studio, opacity: &str| {
            let function = SMOOTH.replace("0.3)", opacity);
            ball(studio, &format!("{function}, {SURFACE}"), "Gradient()", "")
        };
        let (before, after) = (scene(&studio, "0.3)"), scene(&studio, "0.5)"));
        let old = studio.radiance(&before, 33, 27);
        let seen = studio.radiance(&after, 33, 27);
        assert!(difference(&old, &seen) > 0.01);
        let work = &studio.report().passes["preintegrate"];
        assert!(work.runs == 2 && work.work["pairs"] < 2 * 256 * 256, "{work:?}");
        let mut fresh = Studio::new();
        let after = scene(&fresh, "0.5)");
        assert_eq!(seen, fresh.radiance(&after, 33, 27));
    }

    #[needs(gpu)]
    #[test]
    fn on_voxels_is_done_again_only_when_the_function_or_the_data_changes() {
        let mut studio = Studio::new();
        studio.volume("v.raw", [4, 4, 4], |[x, ..]| x as f32);
        studio.volume("w.raw", [4, 4, 4], |[_, y, _]| y as f32);
        let scene = "(entities: {
            \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 9.0)) ),
            \"v\": ( Volume: Raw(path: \"v.raw\", size: (4, 4, 4), format: F32), TransferFunction: (entries: 64, classification: Pre) ) })";
        let mut runs = |scene: &str| {
            studio.radiance(scene, 8, 8);
            studio.report().passes["preclassify"].runs
        };
        assert_eq!([runs(scene), runs(&scene.replace("9.0", "7.0"))], [1, 1]);
        assert_eq!(runs(&scene.replace("64", "65")), 2);
        assert_eq!(runs(&scene.replace("v.raw", "w.raw")), 3);
        assert_eq!(studio.report().gpu_bytes["classified voxels"], 64 * 8);
        assert_eq!(studio.report().passes["preclassify"].work["voxels"], 3 * 64);
        studio.radiance(&scene.replace("Pre)", "Post)"), 8, 8);
        assert!(!studio.report().gpu_bytes.contains_key("classified voxels"));
    }
}
