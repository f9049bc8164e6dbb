//! Rays that take more than one invocation may do: drivers that end long loops without a word must not show.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use support::{Studio, difference, middle};
use tyndall::CutOut;
use tyndall::gpu::GpuOptions;
use tyndall::render;
use tyndall_needs::needs;

/// A bar of 1,000 voxels of 0.1 mm, seen from one end. Its extinction is `sigma` per mm and its colour 1, or that given.
fn bar(studio: &Studio, sigma: f64, colour: &str, lighting: &str, step: f64) -> String {
    studio.volume("bar.raw", [1000, 2, 2], |_| 0.5);
    let opacity = -(-sigma).exp_m1();
    format!(
        "Volume: Raw(path: \"bar.raw\", size: (1000, 2, 2), format: F32, spacing: (0.1, 0.1, 0.1)),
         TransferFunction: (domain: (0.0, 1.0), points: [(0.0, {colour}, {opacity:?})], opacity_length: 1.0),
         VolumeLighting: {lighting}, RayCast: (step: {step:?}, early_termination: 1.0),"
    )
}

const CAMERA: &str =
    "\"eye\": ( ViewCamera: (eye: (80.0, 0.0, 0.0), projection: Orthographic(height: 0.1)) ),";

/// Draws in parts so far.
fn draws(studio: &Studio) -> Option<u64> {
    studio.report().passes.get("raycast")?.work.get("draws").copied()
}

#[needs(gpu)]
#[test]
fn steps_may_be_as_fine_as_they_can_be_written() {
    for portable in [false, true] {
        let mut studio = Studio::with(&GpuOptions { portable });
        for (step, in_parts) in [(1.0, false), (0.01, true)] {
            let volume = bar(&studio, 0.01, "(1.0, 0.5, 0.25)", "EmissionAbsorption", step);
            let scene =
                format!("(background: (0.0, 0.0, 0.5), entities: {{ {CAMERA} \"v\": ( {volume} ) }})");
            let seen = middle(&studio.radiance(&scene, 3, 3));
            let left = (-1.0f32).exp();
            let exact = [1.0 - left, 0.5 * (1.0 - left), 0.25 * (1.0 - left) + 0.5 * left];
            assert_eq!(draws(&studio).is_some(), in_parts, "step {step}, portable: {portable}");
            for channel in 0..3 {
                assert!((seen[channel] - exact[channel]).abs() < 1e-3, "step {step}: {seen:?}, {exact:?}");
            }
        }
    }
}

#[needs(gpu)]
#[test]
fn light_may_come_from_many_lights() {
    let mut studio = Studio::new();
    let mut seen = |lights: usize, lighting: &str, step: f64| {
        let one = 3.0 / lights as f32;
        let lights: String = (0..lights)
            .map(|index| {
                format!(
                    "\"l{index}\": ( DirectionalLight: (direction: (-1.0, -1.0, -3.0), irradiance: ({one:?}, {one:?}, {one:?})) ),"
                )
            })
            .collect();
        let volume = bar(&studio, 0.02, "(1.0, 0.8, 0.6)", lighting, step);
        let scene = format!("(entities: {{ {CAMERA} {lights} \"v\": ( {volume} ) }})");
        (studio.radiance(&scene, 3, 3), draws(&studio))
    };
    let (one, whole) = seen(1, "Gradient()", 1.0);
    assert_eq!(whole, None);
    assert!(middle(&one)[0] > 0.3, "{one:?}");
    for (lights, step) in [(64, 1.0), (1000, 1.0), (100, 0.2)] {
        let (many, draws) = seen(lights, "Gradient()", step);
        assert!(draws.is_some(), "{lights} lights");
        assert!(difference(&many, &one) < 2e-3, "{lights} lights, step {step}: {many:?}, of one {one:?}");
    }
    // More than have light volumes of their own.
    let (one, _) = seen(1, "SingleScattering()", 1.0);
    let (many, draws) = seen(8, "SingleScattering()", 0.1);
    assert!(draws.is_some());
    assert!(middle(&one)[0] > 0.03 && difference(&many, &one) < 2e-3, "{many:?}, of one {one:?}");
}

#[needs(gpu)]
#[test]
fn volumes_that_overlap_are_cast_in_parts_as_at_once() {
    let mut studio = Studio::new();
    for step in [4.0, 0.05] {
        let red = bar(&studio, 0.01, "(1.0, 0.0, 0.0)", "EmissionAbsorption", step);
        let green = bar(&studio, 0.03, "(0.0, 1.0, 0.0)", "EmissionAbsorption", 0.7 * step);
        let blue = bar(&studio, 0.002, "(0.0, 0.0, 1.0)", "EmissionAbsorption", step);
        // The third begins where the others end.
        let scene = format!(
            "(entities: {{ {CAMERA} \"a\": ( {red} ), \"b\": ( {green} ),
                \"c\": ( {blue} Transform: (translation: (-100.0, 0.0, 0.0)) ) }})"
        );
        let seen = middle(&studio.radiance(&scene, 3, 3));
        let left = (-4.0f32).exp();
        let exact = [0.25 * (1.0 - left), 0.75 * (1.0 - left), left * (1.0 - (-0.2f32).exp())];
        assert_eq!(draws(&studio).is_some(), step < 1.0, "step {step}");
        for channel in 0..3 {
            assert!((seen[channel] - exact[channel]).abs() < 1e-3, "step {step}: {seen:?}, {exact:?}");
        }
    }
}

#[needs(gpu)]
#[test]
fn what_is_seen_does_not_depend_on_parts_or_bands() {
    let mut studio = Studio::new();
    studio.volume("blob.raw", [400, 33, 29], |[x, y, z]| {
        let (x, y, z) = (x as f32 / 16.0 - 12.0, y as f32 - 16.0, z as f32 - 14.0);
        (1.0 - (x * x + y * y + z * z).sqrt() / 12.0).max(0.0)
    });
    // A volume without anything to see in it, and so long that rays could take long in it, changes no ray through the other.
    studio.volume("nothing.raw", [2000, 1, 1], |_| 0.0);
    let blob = |beside: &str| {
        format!(
            "(background: (0.1, 0.2, 0.3), entities: {{
                \"eye\": ( ViewCamera: (eye: (200.0, 25.0, 60.0), projection: Perspective(vertical_fov: 30.0)) ),
                \"sun\": ( DirectionalLight: (direction: (-1.0, -1.0, -0.5), irradiance: (3.0, 2.0, 1.0)) ),
                \"ball\": ( Mesh: Sphere(radius: 4.0), Transform: (translation: (30.0, 3.0, 2.0)) ),
                \"v\": ( Volume: Raw(path: \"blob.raw\", size: (400, 33, 29), format: F32, spacing: (0.1, 1.0, 1.0)),
                    TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 0.5, 0.2), 0.0), (0.3, (0.2, 0.5, 1.0), 0.3), (1.0, (1.0, 1.0, 0.6), 0.6)]),
                    VolumeLighting: Gradient() ),
                {beside} }})"
        )
    };
    let whole = studio.radiance(&blob(""), 64, 48);
    assert_eq!(draws(&studio), None);
    let in_parts = studio.radiance(
        &blob(
            "\"nothing\": ( Volume: Raw(path: \"nothing.raw\", size: (2000, 1, 1), format: F32, spacing: (0.1, 0.1, 0.1)),
            TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 1.0, 1.0), 0.0)]),
            RayCast: (step: 0.02, skip_empty: false) ),",
        ),
        64,
        48,
    );
    assert!(draws(&studio).is_some());
    let difference = difference(&whole, &in_parts);
    assert!(difference < 2e-3, "{difference}");
}

/// Volumes of every kind, with a long one beside or without: its rays take long, and show nothing.
#[needs(gpu)]
#[test]
fn every_kind_of_volume_is_cast_in_parts_as_at_once() {
    let mut studio = Studio::new();
    let places = || (0..12usize.pow(3)).map(|index| [index % 12, index / 12 % 12, index / 144]);
    let ball = |[x, y, z]: [usize; 3]| {
        let [x, y, z] = [x, y, z].map(|at| at as f32 - 5.5);
        x * x + y * y + z * z < 25.0
    };
    let label = |place: [usize; 3]| if ball(place) { 1 + (place[0] / 3 % 2) as u8 } else { 0 };
    studio.file("labels.raw", &places().map(label).collect::<Vec<u8>>());
    let colour = |place: [usize; 3]| {
        let [x, y, z] = place.map(|at| (at * 20) as u8);
        [x, y, z, if ball(place) { 255 } else { 0 }]
    };
    studio.file("colours.raw", &places().flat_map(colour).collect::<Vec<u8>>());
    studio.volume("nothing.raw", [2000, 1, 1], |_| 0.0);
    const LONG: &str = "\"nothing\": ( Volume: Raw(path: \"nothing.raw\", size: (2000, 1, 1), format: F32, spacing: (0.1, 0.1, 0.1)),
        TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 1.0, 1.0), 0.0)]), RayCast: (step: 0.02, skip_empty: false) ),";
    let points = "points: [(0.0, (1.0, 0.6, 0.3), 0.0), (1.0, (0.3, 0.6, 1.0), 0.6)], opacity_length: 1.0";
    let labels = "labels: [(value: 1, color: (1.0, 0.2, 0.1), opacity: 0.5), (value: 2, color: (0.1, 0.2, 1.0), opacity: 0.9)]";
    for (file, function) in [
        ("labels.raw\", size: (12, 12, 12", format!("{labels}, opacity_length: 1.0")),
        ("labels.raw\", interpolation: Nearest, size: (12, 12, 12", format!("{points}, domain: (0.0, 2.0)")),
        (
            "labels.raw\", interpolation: Linear, size: (12, 12, 12",
            format!("{points}, domain: (0.0, 2.0), classification: PreIntegrated"),
        ),
        (
            "labels.raw\", interpolation: Linear, size: (12, 12, 12",
            format!("{points}, domain: (0.0, 2.0), classification: Pre"),
        ),
        ("colours.raw\", format: Rgba8, size: (12, 12, 12", points.into()),
        (
            "colours.raw\", format: Rgba8, size: (12, 12, 12",
            format!("{points}, classification: PreIntegrated"),
        ),
    ] {
        for lighting in ["EmissionAbsorption", "Gradient()", "SingleScattering(g: 0.3)", "LightVolume()"] {
            let mut seen = |beside: &str| {
                let scene = format!(
                    "(background: (0.0, 0.1, 0.2), entities: {{
                        \"eye\": ( ViewCamera: (eye: (20.0, 9.0, 15.0)) ),
                        \"sun\": ( DirectionalLight: (direction: (-1.0, -1.0, -0.5), irradiance: (3.0, 2.0, 1.0)) ),
                        \"v\": ( Volume: Raw(path: \"{file})), TransferFunction: ({function}), VolumeLighting: {lighting} ), {beside} }})"
                );
                let before = draws(&studio);
                (studio.radiance(&scene, 24, 24), draws(&studio) != before)
            };
            let (whole, at_once) = seen("");
            let (in_parts, several) = seen(LONG);
            assert!(!at_once && several, "{file}, {lighting}: {at_once}, {several}");
            let background = vec![[0.0, 0.1, 0.2]; whole.len()];
            assert!(difference(&whole, &background) > 0.01, "{file}, {lighting}: nothing is seen");
            let difference = difference(&whole, &in_parts);
            assert!(difference < 2e-3, "{file}, {function}, {lighting}: {difference}");
        }
    }
}

/// What is cut out is as opaque in parts as at once.
#[needs(gpu)]
#[test]
fn what_is_cut_out_hides_as_much_in_parts() {
    let mut studio = Studio::new();
    for (step, in_parts) in [(1.0, false), (0.01, true)] {
        let volume = bar(&studio, 0.01, "(1.0, 0.5, 0.25)", "EmissionAbsorption", step);
        let scene = format!("(background: (0.0, 0.0, 0.5), entities: {{ {CAMERA} \"v\": ( {volume} ) }})");
        studio.app.insert_resource(CutOut(true));
        studio.radiance(&scene, 3, 3);
        let image = render::render(&mut studio.app).unwrap();
        let hidden = image.coverage.unwrap()[4];
        assert_eq!(draws(&studio).is_some(), in_parts, "step {step}");
        assert!((hidden - (1.0 - (-1.0f32).exp())).abs() < 1e-3, "step {step}: {hidden}");
    }
}

#[needs(gpu)]
#[test]
fn a_step_too_fine_for_a_ray_is_told_of() {
    let mut studio = Studio::new();
    studio.volume("flat.raw", [2, 2, 2], |_| 0.5);
    let scene = |spacing: f32| {
        format!(
            "(entities: {{ \"eye\": ( ViewCamera: (eye: (9.0, 0.0, 0.0), projection: Orthographic(height: 0.001)) ),
                \"v\": ( Volume: Raw(path: \"flat.raw\", size: (2, 2, 2), format: F32, spacing: (2.0, 2.0, {spacing:?})),
                TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 1.0, 1.0), 0.5)], opacity_length: 4.0),
                RayCast: (early_termination: 1.0) ) }})"
        )
    };
    for (spacing, is_told) in [(1e-5, false), (1e-9, true), (1e-2, false)] {
        let seen = middle(&studio.radiance(&scene(spacing), 1, 1))[0];
        assert!((seen - 0.5).abs() < 1e-3, "{spacing}: {seen}");
        let path = studio.file("again.ron", scene(spacing).as_bytes());
        let document = render::load_scene(&mut studio.app, &path, &[]);
        studio.app.update();
        let told = render::problems(studio.app.world(), &document);
        let told: Vec<&str> = told.iter().map(|problem| problem.message.as_str()).collect();
        assert_eq!(told.iter().any(|message| message.contains("1048576 segments")), is_told, "{told:?}");
    }
}
