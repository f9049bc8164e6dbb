//! Volumes against values that are known exactly, through scene file, reader, upload and shader.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "raycast/colours.rs"]
mod colours;
#[path = "raycast/labels.rs"]
mod labels;
#[path = "raycast/masked.rs"]
mod masked;
mod support;

use support::{Studio, difference, middle};
use tyndall::gpu::GpuOptions;
use tyndall_needs::needs;

/// A camera that looks along -z onto the origin, orthographic, from `z` scene units in front.
fn camera(z: f32, height: f32) -> String {
    format!(
        "\"eye\": ( ViewCamera: (eye: (0.0, 0.0, {z:?}), projection: Orthographic(height: {height:?})) ),"
    )
}

/// A 2 x 2 x 2 volume of the constant value 0.5, 4 mm along each side, of extinction `sigma` per mm and colour 1.
fn constant(studio: &Studio, sigma: f32) -> String {
    studio.volume("constant.raw", [2, 2, 2], |_| 0.5);
    let opacity = 1.0 - (-sigma).exp();
    format!(
        "Volume: Raw(path: \"constant.raw\", size: (2, 2, 2), format: F32, spacing: (2.0, 2.0, 2.0)),
         TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 1.0, 1.0), {opacity:?})], opacity_length: 1.0),
         RayCast: (early_termination: 1.0),"
    )
}

#[needs(gpu)]
#[test]
fn a_constant_volume_absorbs_exponentially_from_every_side() {
    let mut studio = Studio::new();
    let volume = constant(&studio, 0.3);
    // Direction of the camera, and the length of the ray through the middle of a cube of side 4.
    let views = [
        ([0.0, 0.0, 10.0], 4.0),
        ([10.0, 0.0, 0.0], 4.0),
        ([0.0, -10.0, 0.001], 4.0),
        ([10.0, 10.0, 0.0], 4.0 * 2f32.sqrt()),
        ([7.0, 7.0, 7.0], 4.0 * 3f32.sqrt()),
        ([3.0, 5.0, -8.0], 4.0 / (8.0 / 98f32.sqrt())),
        ([-9.0, 2.0, 4.0], 4.0 / (9.0 / 101f32.sqrt())),
    ];
    for projection in ["Orthographic(height: 1.0)", "Perspective(vertical_fov: 5.0)"] {
        for step in ["1.0", "0.3"] {
            for ([x, y, z], length) in views {
                let scene = format!(
                    "(background: (0.25, 0.5, 0.75), entities: {{
                        \"eye\": ( ViewCamera: (eye: ({x:?}, {y:?}, {z:?}), projection: {projection}) ),
                        \"v\": ( {} ) }})",
                    volume.replace("RayCast: (", &format!("RayCast: (step: {step}, "))
                );
                let seen = middle(&studio.radiance(&scene, 3, 3));
                let transmittance = (-0.3 * length).exp();
                for (channel, background) in [0.25, 0.5, 0.75].into_iter().enumerate() {
                    let exact = 1.0 - transmittance + transmittance * background;
                    assert!(
                        (seen[channel] - exact).abs() < 1e-4,
                        "from {x} {y} {z}, step {step}: {seen:?}, expected {exact}"
                    );
                }
            }
        }
    }
}

#[needs(gpu)]
#[test]
fn the_scenes_unit_and_the_volumes_scale_count() {
    let mut studio = Studio::new();
    let volume = constant(&studio, 0.3);
    // 4 mm are 0.4 units of 10 mm; scaled by 5 they are 2 units, or 20 mm.
    let scene = format!(
        "(millimetres_per_unit: 10.0, entities: {{ {} \"v\": ( Transform: (scale: 5.0), {volume} ) }})",
        camera(10.0, 0.1)
    );
    let seen = middle(&studio.radiance(&scene, 3, 3))[0];
    assert!((seen - (1.0 - (-0.3f32 * 20.0).exp())).abs() < 1e-4, "{seen}");
}

/// The truth's segments: a field that is linear along the ray, seen from the middle of its first voxel to that of its last.
mod segments {
    use super::*;

    const VOXELS: usize = 1024;

    #[needs(gpu)]
    #[test]
    fn hold_to_a_thousandth_and_at_an_eighth_of_the_step_to_a_ten_thousandth() {
        let cases: serde_json::Value = serde_json::from_str(include_str!("truth/ea_segments.json")).unwrap();
        let mut studio = Studio::new();
        let mut worst = [(0.0, String::new()), (0.0, String::new())];
        for case in cases["cases"].as_array().unwrap() {
            for (index, step) in [1.0, 0.125].into_iter().enumerate() {
                let error = (radiance(&mut studio, case, step) - case["radiance"].as_f64().unwrap()).abs();
                if error > worst[index].0 {
                    worst[index] = (error, case["id"].to_string());
                }
            }
        }
        eprintln!("worst errors at steps of 1 and 1/8 voxel: {worst:?}");
        assert!(worst[0].0 < 1e-3 && worst[1].0 < 1e-4, "{worst:?}");
    }

    fn radiance(studio: &mut Studio, case: &serde_json::Value, step: f64) -> f64 {
        let number = |name: &str| case[name].as_f64().unwrap();
        let (front, back, length) = (number("s_front"), number("s_back"), number("length"));
        let name = format!("{}.raw", case["id"].as_str().unwrap());
        // The camera looks along -z, so the front of the ray is at the high end.
        studio.volume(&name, [1, 1, VOXELS], |[_, _, z]| {
            (back + (front - back) * z as f64 / (VOXELS - 1) as f64) as f32
        });
        let spacing = length / (VOXELS - 1) as f64;
        let half = length / 2.0;
        let scene = format!(
            "(entities: {{
                \"eye\": ( ViewCamera: (eye: (0.0, 0.0, {half:?}), projection: Orthographic(height: {height:?})) ),
                \"black\": ( Transform: (translation: (0.0, 0.0, {end:?}), rotation: (90.0, 0.0, 0.0)), Mesh: Plane(size: ({length:?}, {length:?})), Phong: (diffuse: (0.0, 0.0, 0.0)) ),
                \"v\": (
                    Volume: Raw(path: {name:?}, size: (1, 1, {VOXELS}), format: F32, spacing: ({spacing:?}, {spacing:?}, {spacing:?})),
                    {function}
                    RayCast: (step: {step:?}, early_termination: 1.0),
                ) }})",
            height = spacing * 0.1,
            end = -half,
            function = transfer_function(case),
        );
        f64::from(middle(&studio.radiance(&scene, 1, 1))[0])
    }

    /// Extinction is linear between the truth's points, opacity between ours: over a millionth of the shortest mean free path the two
    /// agree to 1e-6.
    fn transfer_function(case: &serde_json::Value) -> String {
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
            "TransferFunction: (domain: (0.0, 1.0), points: [{}], opacity_length: {length:.15}, entries: 1001),",
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

#[needs(gpu)]
#[test]
fn the_error_falls_with_the_square_of_the_step() {
    let mut studio = Studio::new();
    studio.volume("ramp.raw", [1, 1, 16], |[_, _, z]| z as f32 / 15.0);
    let mut seen = |step: f32| {
        let scene = format!(
            "(entities: {{ {} \"v\": (
                Volume: Raw(path: \"ramp.raw\", size: (1, 1, 16), format: F32),
                TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (0.0, 0.0, 0.0), 0.0), (1.0, (1.0, 1.0, 1.0), 0.6)]),
                RayCast: (step: {step:?}, early_termination: 1.0) ) }})",
            camera(20.0, 0.1)
        );
        middle(&studio.radiance(&scene, 1, 1))[0]
    };
    let exact = seen(0.02);
    let errors: Vec<f32> = [4.0, 2.0, 1.0].map(|step| (seen(step) - exact).abs()).to_vec();
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((2.5..6.5).contains(&ratio), "halving the step divides the error by {ratio}: {errors:?}");
    }
}

/// A blob in an otherwise empty volume, seen askew.
fn blob(studio: &Studio, lighting: &str, ray_cast: &str) -> String {
    studio.volume("blob.raw", [40, 33, 29], |[x, y, z]| {
        let (x, y, z) = (x as f32 - 25.0, y as f32 - 12.0, z as f32 - 14.0);
        (1.0 - (x * x + y * y + 2.0 * z * z).sqrt() / 9.0).max(0.0)
    });
    format!(
        "(background: (0.1, 0.2, 0.3), entities: {{
            \"eye\": ( ViewCamera: (eye: (30.0, 25.0, 60.0), projection: Perspective(vertical_fov: 40.0)) ),
            \"sun\": ( DirectionalLight: (direction: (-1.0, -1.0, -0.5), irradiance: (3.0, 2.0, 1.0)) ),
            \"v\": (
                Transform: (rotation: (10.0, 20.0, 30.0), scale: (1.0, 1.5, 0.7)),
                Volume: Raw(path: \"blob.raw\", size: (40, 33, 29), format: F32, spacing: (1.0, 0.8, 1.2)),
                TransferFunction: (domain: (0.0, 1.0), points: [(0.2, (0.9, 0.5, 0.1), 0.0), (1.0, (0.2, 0.6, 0.9), 0.5)]),
                VolumeLighting: {lighting},
                RayCast: ({ray_cast}) ) }})"
    )
}

#[needs(gpu)]
#[test]
fn leaping_over_empty_bricks_changes_nothing() {
    let mut studio = Studio::new();
    for lighting in ["EmissionAbsorption", "Gradient()"] {
        let skipping = blob(&studio, lighting, "skip_empty: true");
        let marching = blob(&studio, lighting, "skip_empty: false");
        let (a, b) = (studio.radiance(&skipping, 61, 47), studio.radiance(&marching, 61, 47));
        assert!(difference(&a, &b) < 1e-5, "{lighting}: {}", difference(&a, &b));
        assert!(a.iter().any(|pixel| pixel[0] > 0.3), "the blob is to be seen");
    }
}

#[needs(gpu)]
#[test]
fn the_portable_variant_draws_the_same() {
    let scene = |studio: &Studio| blob(studio, "Gradient()", "step: 0.7");
    let mut full = Studio::new();
    let text = scene(&full);
    let expected = full.radiance(&text, 33, 27);
    let mut portable = Studio::with(&GpuOptions { portable: true });
    let text = scene(&portable);
    let seen = portable.radiance(&text, 33, 27);
    assert!(difference(&seen, &expected) < 1e-4, "{}", difference(&seen, &expected));
}

#[needs(gpu)]
#[test]
fn meshes_in_front_behind_inside_and_across_a_volume_hide_the_right_part() {
    let mut studio = Studio::new();
    let volume = constant(&studio, 0.3);
    // A plane of radiance 0.5 that faces the camera at depth z; the volume fills -2..2.
    let plane = |z: f32, tilt: f32| {
        format!(
            "\"plane\": ( Transform: (translation: (0.0, 0.0, {z:?}), rotation: ({:?}, 0.0, 0.0)), Mesh: Plane(size: (20.0, 20.0)),
                Phong: (ambient: (0.5, 0.5, 0.5), diffuse: (0.0, 0.0, 0.0)) ),",
            90.0 + tilt
        )
    };
    let expected = |length: f32| 1.0 - (-0.3 * length).exp() * 0.5;
    for (z, length) in [(5.0, 0.0), (-5.0, 4.0), (0.0, 2.0), (1.5, 0.5), (-1.9, 3.9)] {
        let scene = format!("(entities: {{ {} {} \"v\": ( {volume} ) }})", camera(10.0, 0.1), plane(z, 0.0));
        let seen = middle(&studio.radiance(&scene, 3, 3))[0];
        assert!(
            (seen - expected(length)).abs() < 1e-4,
            "plane at {z}: {seen}, expected {}",
            expected(length)
        );
    }
    // Tilted by 45 degrees it cuts through: at height y the ray meets it at z = y.
    let scene = format!("(entities: {{ {} {} \"v\": ( {volume} ) }})", camera(10.0, 4.0), plane(0.0, -45.0));
    let pixels = studio.radiance(&scene, 1, 8);
    let heights: Vec<f32> = (0..8).map(|row| 2.0 - (row as f32 + 0.5) * 0.5).collect();
    let rising = pixels[0][0] < pixels[7][0];
    for (pixel, y) in pixels.iter().zip(heights) {
        let z = if rising { y } else { -y };
        assert!(
            (pixel[0] - expected(2.0 - z)).abs() < 1e-4,
            "at height {y}: {}, expected {}",
            pixel[0],
            expected(2.0 - z)
        );
    }
}

#[needs(gpu)]
#[test]
fn volumes_that_overlap_add_their_extinction_and_mix_their_light() {
    let mut studio = Studio::new();
    studio.volume("a.raw", [2, 2, 2], |_| 0.5);
    let volume = |name: &str, sigma: f32, colour: &str, z: f32, spacing: f32, step: f32| {
        let opacity = 1.0 - (-sigma).exp();
        format!(
            "{name:?}: ( Transform: (translation: (0.0, 0.0, {z:?})),
                Volume: Raw(path: \"a.raw\", size: (2, 2, 2), format: F32, spacing: ({spacing:?}, {spacing:?}, {spacing:?})),
                TransferFunction: (domain: (0.0, 1.0), points: [(0.0, {colour}, {opacity:?})], opacity_length: 1.0),
                RayCast: (step: {step:?}, early_termination: 1.0) ),"
        )
    };
    // Red fills -2..2, green -1..3: red alone for 1, both for 3, green alone for 1, seen from +z.
    let (red, green) = (0.4f32, 0.25f32);
    let scene = format!(
        "(background: (0.0, 0.0, 1.0), entities: {{ {} {} {} }})",
        camera(10.0, 0.1),
        volume("red", red, "(1.0, 0.0, 0.0)", 0.0, 2.0, 0.01),
        volume("green", green, "(0.0, 1.0, 0.0)", 1.0, 2.0, 0.013),
    );
    let seen = middle(&studio.radiance(&scene, 3, 3));
    let front = (-green).exp();
    let both = (-(red + green) * 3.0).exp();
    let exact = [
        front * (1.0 - both) * red / (red + green) + front * both * (1.0 - (-red).exp()),
        1.0 - front + front * (1.0 - both) * green / (red + green),
        front * both * (-red).exp(),
    ];
    for channel in 0..3 {
        assert!((seen[channel] - exact[channel]).abs() < 1.5e-3, "{seen:?}, expected {exact:?}");
    }
    // What they absorb together is exact whatever the steps.
    assert!((seen[2] - exact[2]).abs() < 1e-5, "{seen:?}, expected {exact:?}");
}

#[needs(gpu)]
#[test]
fn a_camera_inside_sees_only_what_is_in_front_of_it() {
    let mut studio = Studio::new();
    let volume = constant(&studio, 0.3);
    for projection in ["Orthographic(height: 0.1)", "Perspective(vertical_fov: 5.0)"] {
        let scene = format!(
            "(entities: {{ \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 0.5), target: (0.0, 0.0, -1.0), projection: {projection}) ), \"v\": ( {volume} ) }})"
        );
        let seen = middle(&studio.radiance(&scene, 3, 3))[0];
        let exact = 1.0 - (-0.3f32 * 2.5).exp();
        assert!((seen - exact).abs() < 1e-4, "{projection}: {seen}, expected {exact}");
    }
}

#[needs(gpu)]
#[test]
fn samples_that_are_not_finite_are_transparent_and_nothing_else_is() {
    let mut studio = Studio::new();
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e35];
    studio.volume("holes.raw", [8, 8, 8], |[x, y, z]| if x >= 4 { bad[(x + y + z) % 4] } else { 0.5 });
    let scene = format!(
        "(background: (0.0, 0.0, 1.0), entities: {{ {} \"v\": (
            Volume: Raw(path: \"holes.raw\", size: (8, 8, 8), format: F32),
            TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 0.0, 0.0), 0.5)], opacity_length: 1.0),
            VolumeLighting: Gradient(), RayCast: (early_termination: 1.0) ) }})",
        camera(20.0, 8.0)
    );
    let pixels = studio.radiance(&scene, 8, 8);
    assert!(pixels.iter().flatten().all(|value| value.is_finite() && *value >= 0.0));
    let row = &pixels[8 * 4..8 * 5];
    for (x, pixel) in row.iter().enumerate() {
        let clear = if x >= 4 { 1.0 } else { 0.5f32.powi(8) };
        assert!((pixel[2] - clear).abs() < 1e-4, "column {x}: {pixel:?}");
    }
}

#[needs(gpu)]
#[test]
fn every_sample_type_shows_the_same_ramp() {
    let mut studio = Studio::new();
    let ramp: Vec<f32> = (0..16).map(|z| z as f32 / 15.0).collect();
    let scaled = |low: f32, high: f32| {
        ramp.iter().map(move |value| (low + value * (high - low)).round()).collect::<Vec<f32>>()
    };
    let files: [(&str, &str, Vec<u8>); 7] = [
        ("F32", "Little", ramp.iter().flat_map(|v| (v * 255.0).to_le_bytes()).collect()),
        ("F32", "Big", ramp.iter().flat_map(|v| (v * 255.0).to_be_bytes()).collect()),
        ("U8", "Little", scaled(0.0, 255.0).iter().map(|v| *v as u8).collect()),
        ("I8", "Little", scaled(-128.0, 127.0).iter().map(|v| *v as i8 as u8).collect()),
        ("U16", "Little", scaled(0.0, 65535.0).iter().flat_map(|v| (*v as u16).to_le_bytes()).collect()),
        ("U16", "Big", scaled(0.0, 65535.0).iter().flat_map(|v| (*v as u16).to_be_bytes()).collect()),
        ("I16", "Little", scaled(-32768.0, 32767.0).iter().flat_map(|v| (*v as i16).to_le_bytes()).collect()),
    ];
    let seen: Vec<f32> = files
        .iter()
        .map(|(format, endian, bytes)| {
            studio.file("typed.raw", bytes);
            let path = format!("typed_{format}_{endian}.raw");
            studio.file(&path, bytes);
            let domain = if *format == "F32" { "domain: (0.0, 255.0)," } else { "" };
            let scene = format!(
                "(entities: {{ {} \"v\": (
                    Volume: Raw(path: {path:?}, size: (1, 1, 16), format: {format}, endian: {endian}),
                    TransferFunction: ({domain} points: [(0.0, (0.2, 0.0, 0.0), 0.1), (1.0, (1.0, 0.0, 0.0), 0.3)]),
                    RayCast: (step: 0.25) ) }})",
                camera(20.0, 0.1)
            );
            middle(&studio.radiance(&scene, 1, 1))[0]
        })
        .collect();
    for (value, file) in seen.iter().zip(&files) {
        assert!((value - seen[0]).abs() < 1e-4, "{} {}: {seen:?}", file.0, file.1);
    }
    assert!(seen[0] > 0.1);
}

#[needs(gpu)]
#[test]
fn a_gradient_lit_ball_is_shaded_as_a_ball() {
    let mut studio = Studio::new();
    let n = 64;
    studio.volume("ball.raw", [n, n, n], |cell| {
        let centred = cell.map(|i| i as f32 + 0.5 - n as f32 / 2.0);
        24.0 - centred.iter().map(|c| c * c).sum::<f32>().sqrt()
    });
    // Fully opaque inside, so what is seen is the surface of radius 24.
    let scene = format!(
        "(entities: {{ {}
            \"sun\": ( DirectionalLight: (direction: (0.0, -1.0, -1.0), irradiance: (3.14159265, 3.14159265, 3.14159265)) ),
            \"v\": (
                Volume: Raw(path: \"ball.raw\", size: (64, 64, 64), format: F32),
                TransferFunction: (domain: (-40.0, 40.0), points: [(0.5, (1.0, 1.0, 1.0), 0.0), (0.501, (1.0, 1.0, 1.0), 1.0)], entries: 8001),
                VolumeLighting: Gradient(ambient: 0.0, diffuse: 1.0, specular: 0.0),
                RayCast: (step: 0.25) ) }})",
        camera(100.0, 64.0)
    );
    let pixels = studio.radiance(&scene, 64, 64);
    for (x, y) in [(32, 32), (32, 20), (20, 30), (40, 44), (45, 25)] {
        let (px, py) = (x as f32 + 0.5 - 32.0, 32.0 - y as f32 - 0.5);
        let pz = (24.0f32 * 24.0 - px * px - py * py).sqrt();
        let expected = ((py + pz) / 24.0 / 2f32.sqrt()).max(0.0);
        let seen = pixels[y * 64 + x][0];
        assert!((seen - expected).abs() < 0.02, "at {x} {y}: {seen}, expected {expected}");
    }
}

#[needs(gpu)]
#[test]
fn a_volume_beyond_the_adapters_limit_is_refused_with_the_limit_and_a_mend() {
    let mut studio = Studio::new();
    let limit = studio.app.world().resource::<tyndall::gpu::Gpu>().device.limits().max_texture_dimension_3d;
    studio.file("long.raw", &vec![9; limit as usize + 1]);
    let scene = format!(
        "(entities: {{ \"v\": ( Volume: Raw(path: \"long.raw\", size: (1, 1, {}), format: U8) ) }})",
        limit + 1
    );
    let path = studio.file("scene.ron", scene.as_bytes());
    let document = tyndall::render::load_scene(&mut studio.app, &path, &[]);
    assert!(!document.has_errors());
    assert!(tyndall::render::render(&mut studio.app).is_err());
    let problems = tyndall::render::problems(studio.app.world(), &document);
    let told = problems.iter().find(|problem| problem.message.contains(&limit.to_string())).unwrap();
    assert!(
        told.help.as_ref().is_some_and(|help| help.contains("downsample")) && told.place.is_some(),
        "{told:?}"
    );
}
