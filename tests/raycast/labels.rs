//! Volumes whose values are labels: each voxel shows its own, and nothing lies between two.

use super::camera;
use super::support::{Studio, difference};
use tyndall::TyndallPlugins;
use tyndall::gpu::GpuOptions;
use tyndall::loading::{Contents, contents};
use tyndall::optics::labels::palette;
use tyndall::render;
use tyndall_needs::needs;

const LIGHTINGS: [&str; 5] = [
    "EmissionAbsorption",
    "Gradient()",
    "SingleScattering(g: 0.3)",
    "LightVolume()",
    "LightVolume(towards_eye: true, gradient_specular: 0.5)",
];

/// A ball of label 4 in label 0, as 8-bit integers.
fn ball(studio: &Studio) {
    let places = (0..32usize.pow(3)).map(|index| [index % 32, index / 32 % 32, index / 1024]);
    let label = |place: [usize; 3]| {
        let [x, y, z] = place.map(|at| at as f32 - 15.5);
        if x * x + y * y + z * z < 144.0 { 4 } else { 0 }
    };
    studio.file("ball.raw", &places.map(label).collect::<Vec<u8>>());
}

/// That ball in a light from the side.
fn scene(interpolation: &str, function: &str, lighting: &str) -> String {
    format!(
        "(background: (0.0, 0.0, 1.0), entities: {{ {}
            \"sun\": ( DirectionalLight: (direction: (-1.0, -0.5, -1.0), irradiance: (3.0, 3.0, 3.0)) ),
            \"v\": (
                Volume: Raw(path: \"ball.raw\", size: (32, 32, 32){interpolation}),
                TransferFunction: ({function}),
                VolumeLighting: {lighting}, RayCast: (step: 0.5) ) }})",
        camera(40.0, 32.0)
    )
}

/// Opaque at label 2, which is not in the data, and clear elsewhere.
fn only_label_2(classification: &str) -> String {
    format!(
        "domain: (0.0, 4.0), classification: {classification}, points: [(0.375, (1.0, 0.0, 0.0), 0.0),
            (0.375, (1.0, 0.0, 0.0), 1.0), (0.625, (1.0, 0.0, 0.0), 1.0), (0.625, (1.0, 0.0, 0.0), 0.0)]"
    )
}

#[needs(gpu)]
#[test]
fn no_label_is_seen_that_is_not_in_the_data() {
    for portable in [false, true] {
        let mut studio = Studio::with(&GpuOptions { portable });
        ball(&studio);
        for classification in ["Post", "Pre", "PreIntegrated"] {
            for lighting in LIGHTINGS {
                for interpolation in ["", ", interpolation: Nearest"] {
                    let scene = scene(interpolation, &only_label_2(classification), lighting);
                    let pixels = studio.radiance(&scene, 24, 24);
                    assert!(
                        pixels.iter().all(|pixel| *pixel == [0.0, 0.0, 1.0]),
                        "{classification}, {lighting}{interpolation}, portable: {portable}"
                    );
                }
            }
        }
        // Between mixed labels there is a shell of it.
        let mixed = scene(", interpolation: Linear", &only_label_2("Post"), "EmissionAbsorption");
        assert!(studio.radiance(&mixed, 24, 24).iter().any(|pixel| pixel[0] > 0.5));
    }
}

#[needs(gpu)]
#[test]
fn every_label_has_its_own_colour_to_the_last() {
    const SIDE: usize = 8;
    let label = |x: usize, y: usize| {
        [0u16, 1, 2, 255, 256, 8191, 8192, 40_000, 65_533, 65_534, 65_535][(x + 3 * y) % 11]
    };
    // What is not listed is clear.
    let listed = [1u16, 255, 256, 8191, 40_000, 65_534, 65_535];
    let colour = |label: u16| [0.1, 0.3, 0.5].map(|share| share + f32::from(label) / 65_535.0 * 0.4);
    let table: Vec<String> = listed
        .iter()
        .map(|value| {
            let [r, g, b] = colour(*value);
            format!("(value: {value}, color: ({r:?}, {g:?}, {b:?}), opacity: 0.75, name: \"number {value}\")")
        })
        .collect();
    for portable in [false, true] {
        let mut studio = Studio::with(&GpuOptions { portable });
        let samples = (0..SIDE * SIDE).flat_map(|index| label(index % SIDE, index / SIDE).to_le_bytes());
        studio.file("slice.raw", &samples.collect::<Vec<u8>>());
        for (interpolation, classification) in
            [("Auto", "Post"), ("Linear", "Post"), ("Nearest", "Pre"), ("Auto", "PreIntegrated")]
        {
            let scene = format!(
                "(entities: {{ {} \"v\": (
                    Volume: Raw(path: \"slice.raw\", size: ({SIDE}, {SIDE}, 1), format: U16, interpolation: {interpolation}),
                    TransferFunction: (labels: [{}], opacity_length: 1.0, classification: {classification}),
                    RayCast: (early_termination: 1.0) ) }})",
                camera(20.0, SIDE as f32),
                table.join(", ")
            );
            let pixels = studio.radiance(&scene, 4 * SIDE as u32, 4 * SIDE as u32);
            for (index, pixel) in pixels.iter().enumerate() {
                let [x, y] = [index % (4 * SIDE) / 4, SIDE - 1 - index / (4 * SIDE) / 4];
                let value = label(x, y);
                let expected =
                    if listed.contains(&value) { colour(value).map(|c| 0.75 * c) } else { [0.0; 3] };
                for c in 0..3 {
                    assert!(
                        (pixel[c] - expected[c]).abs() < 1e-5,
                        "label {value}, {interpolation}, {classification}, portable: {portable}: {pixel:?}, {expected:?}"
                    );
                }
            }
        }
    }
}

#[needs(gpu)]
#[test]
fn labels_are_shaded_as_smooth_surfaces() {
    let mut studio = Studio::new();
    ball(&studio);
    let lighting = "Gradient(ambient: 0.0, diffuse: 1.0, specular: 0.0)";
    let scene = scene("", "labels: [(value: 4, color: (0.8, 0.8, 0.8))]", lighting);
    let pixels = studio.radiance(&scene, 64, 64);
    let to_light = glam::DVec3::new(1.0, 0.5, 1.0).normalize();
    let (mut sum, mut flat, mut count) = (0.0, 0.0, 0.0);
    for (index, pixel) in pixels.iter().enumerate() {
        let [x, y] = [index % 64, 63 - index / 64].map(|at| (at as f64 + 0.5) / 2.0 - 16.0);
        let height = 144.0 - x * x - y * y;
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

/// The power of light that was scattered once in that ball, as `scene` shows it: of an albedo of 0.8, and an opacity of a half over a voxel.
fn scattered_once(pixels: usize) -> f64 {
    const STEP: f64 = 0.125;
    let is_ball = |place: glam::DVec3| (place.floor() + 0.5).length_squared() < 144.0;
    let sigma_t = 2f64.ln();
    let to_light = glam::DVec3::new(1.0, 0.5, 1.0).normalize();
    let pixel = 32.0 / pixels as f64;
    let mut power = 0.0;
    for index in 0..pixels * pixels {
        let [x, y] = [index % pixels, index / pixels].map(|at| (at as f64 + 0.5) * pixel - 16.0);
        let mut left = 1.0f64;
        for step in 0..192 {
            let place = glam::DVec3::new(x, y, 12.0 - (f64::from(step) + 0.5) * STEP);
            if !is_ball(place) || left < 1e-3 {
                continue;
            }
            let inside = (0..192).filter(|step| is_ball(place + (f64::from(*step) + 0.5) * STEP * to_light));
            let arrives = (-sigma_t * STEP * inside.count() as f64).exp();
            let passes = (-sigma_t * STEP).exp();
            power += left * (1.0 - passes) * arrives;
            left *= passes;
        }
    }
    power * 0.8 * 3.0 / (4.0 * std::f64::consts::PI)
}

#[needs(gpu)]
#[test]
fn light_in_labels_is_that_of_a_medium_with_their_shape() {
    let mut studio = Studio::new();
    ball(&studio);
    for lighting in ["SingleScattering()", "LightVolume(g: 0.3)"] {
        // Of labels and of points, and the same medium of interpolated values whose surface is where labels change.
        let functions = [
            ("", "labels: [(value: 4, color: (0.8, 0.8, 0.8), opacity: 0.5)], opacity_length: 1.0"),
            (
                ", interpolation: Nearest",
                "domain: (0.0, 4.0), points: [(0.0, (0.8, 0.8, 0.8), 0.0), (1.0, (0.8, 0.8, 0.8), 0.5)], opacity_length: 1.0",
            ),
            (
                ", interpolation: Linear",
                "domain: (0.0, 4.0), points: [(0.49, (0.8, 0.8, 0.8), 0.0), (0.51, (0.8, 0.8, 0.8), 0.5)], opacity_length: 1.0",
            ),
        ];
        let pictures = functions.map(|(interpolation, function)| {
            studio.radiance(&scene(interpolation, function, lighting), 48, 48)
        });
        assert!(difference(&pictures[0], &pictures[1]) < 1e-4, "{lighting}");
        let [power, interpolated] =
            [1, 2].map(|index: usize| pictures[index].iter().map(|pixel| f64::from(pixel[0])).sum::<f64>());
        if lighting == "SingleScattering()" {
            let exact = scattered_once(48);
            eprintln!("{lighting}: {power} of {exact}, and {interpolated} interpolated");
            assert!((power / exact - 1.0).abs() < 0.025, "{power}, {exact}");
        }
        // What is interpolated has a smoother surface, from which 4 % more light returns.
        let ratio = power / interpolated;
        eprintln!("{lighting}: {ratio} of interpolated values");
        assert!((ratio - 1.0).abs() < 0.08, "{lighting}: {power}, {interpolated}");
    }
}

#[needs(gpu)]
#[test]
fn labels_without_a_function_have_colours_of_their_own() {
    let mut studio = Studio::new();
    ball(&studio);
    for function in ["", "preset: \"Object\""] {
        let pixels = studio.radiance(&scene("", function, "EmissionAbsorption"), 25, 25);
        let middle = super::middle(&pixels);
        let expected = palette(4).to_array();
        for c in 0..3 {
            assert!((middle[c] - expected[c]).abs() < 0.02, "{function}: {middle:?}, {expected:?}");
        }
        assert_eq!(pixels[0], [0.0, 0.0, 1.0], "label 0 is nothing");
    }
    // What is written holds.
    let ramp = studio.radiance(&scene("", "domain: (0.0, 4.0)", "EmissionAbsorption"), 25, 25);
    let [red, green, _] = super::middle(&ramp);
    assert!(red > 0.5 && red == green, "a ramp is grey");
}

#[test]
fn contents_tell_labels_their_colours_and_voxels() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("v.raw"), [[0u8; 32], [3; 32]].concat()).unwrap();
    let path = folder.path().join("scene.ron");
    let volume = "Volume: Raw(path: \"v.raw\", size: (4, 4, 4)";
    let scene =
        format!("(entities: {{ \"a\": ( {volume}) ), \"b\": ( {volume}, interpolation: Linear) ) }})");
    std::fs::write(&path, scene).unwrap();
    let mut app = bevy_app::App::new();
    app.add_plugins(TyndallPlugins);
    let document = render::load_scene(&mut app, &path, &[]);
    app.update();
    let notes: Vec<String> =
        render::problems(app.world(), &document).iter().map(ToString::to_string).collect();
    assert_eq!(notes.iter().filter(|note| note.contains("taken for labels")).count(), 1, "{notes:?}");
    for (name, contents) in contents(app.world_mut()) {
        let Contents::Volume { labels, .. } = contents else { panic!("{name}") };
        assert_eq!(labels.len(), 1, "{name}");
        let (label, voxels) = &labels[0];
        assert_eq!((label.value, label.color, *voxels), (3, palette(3), 32), "{name}");
    }
}
