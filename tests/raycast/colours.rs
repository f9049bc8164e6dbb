//! Volumes of colours: each place shows that of the data, as opaque as its luminance and opacity say.

use super::support::{Studio, difference};
use super::{camera, middle};
use tyndall::gpu::GpuOptions;
use tyndall_needs::needs;

const SIDE: usize = 8;

/// Some colour of a slice, clear at some places.
fn sample(x: usize, y: usize) -> [u8; 4] {
    let channel = |a: usize, b: usize| ((a * x + b * y + x * y) * 37 % 256) as u8;
    let opacity = [255, 255, 0, 128, 255][(x + 2 * y) % 5];
    [channel(3, 5), channel(7, 2), channel(1, 6), opacity]
}

/// Encoded colour, 0 to 255, and opacity between voxels, by the definition.
fn between(x: f64, y: f64) -> ([f64; 3], f64) {
    let along = |at: f64| {
        let low = (at - 0.5).floor();
        let inside = |at: f64| at.clamp(0.0, SIDE as f64 - 1.0) as usize;
        [(inside(low), 1.0 - (at - 0.5 - low)), (inside(low + 1.0), at - 0.5 - low)]
    };
    let (mut sum, mut opacity) = ([0.0; 3], 0.0);
    for (y, of_y) in along(y) {
        for (x, of_x) in along(x) {
            let [red, green, blue, alpha] = sample(x, y).map(f64::from);
            let weight = of_x * of_y * alpha / 255.0;
            opacity += weight;
            for (sum, channel) in sum.iter_mut().zip([red, green, blue]) {
                *sum += weight * channel;
            }
        }
    }
    (sum.map(|channel| channel / opacity.max(1e-30)), opacity)
}

fn linear(encoded: f64) -> f64 {
    let share = encoded / 255.0;
    if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
}

fn luminance([red, green, blue]: [f64; 3]) -> f64 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

fn slice(studio: &Studio, function: &str, interpolation: &str) -> String {
    let samples = (0..SIDE * SIDE).flat_map(|index| sample(index % SIDE, index / SIDE));
    studio.file("slice.raw", &samples.collect::<Vec<u8>>());
    format!(
        "(entities: {{ {} \"v\": (
            Volume: Raw(path: \"slice.raw\", size: ({SIDE}, {SIDE}, 1), format: Rgba8, interpolation: {interpolation}),
            TransferFunction: (opacity_length: 1.0, {function}),
            RayCast: (early_termination: 1.0) ) }})",
        camera(20.0, SIDE as f32)
    )
}

#[needs(gpu)]
#[test]
fn a_place_shows_the_colour_of_the_data() {
    // Opacity grows with luminance from 0.2 to 0.8; the tint of the second is what colours of a function are for.
    let functions = [
        ("points: [(0.0, (1.0, 1.0, 1.0), 0.2), (1.0, (1.0, 1.0, 1.0), 0.8)]", [1.0; 3]),
        ("points: [(0.0, (1.0, 0.5, 0.25), 0.2), (1.0, (1.0, 0.5, 0.25), 0.8)]", [1.0, 0.5, 0.25]),
    ];
    for portable in [false, true] {
        let mut studio = Studio::with(&GpuOptions { portable });
        for (function, tint) in functions {
            for classification in ["Post", "PreIntegrated", "Pre"] {
                for interpolation in ["Auto", "Nearest"] {
                    let function = format!("{function}, classification: {classification}");
                    let scene = slice(&studio, &function, interpolation);
                    let pixels = studio.radiance(&scene, 5 * SIDE as u32, 5 * SIDE as u32);
                    let mut worst: f64 = 0.0;
                    for (index, pixel) in pixels.iter().enumerate() {
                        let [x, y] = [index % (5 * SIDE), 5 * SIDE - 1 - index / (5 * SIDE)];
                        // Classified voxels are interpolated otherwise: they are looked at in their middles.
                        if classification == "Pre" && (x % 5 != 2 || y % 5 != 2) {
                            continue;
                        }
                        let [x, y] = match interpolation {
                            "Nearest" => [x, y].map(|at| (at / 5) as f64 + 0.5),
                            _ => [x, y].map(|at| (at as f64 + 0.5) / 5.0),
                        };
                        let (encoded, alpha) = between(x, y);
                        let opacity = 0.2 + 0.6 * luminance(encoded) / 255.0;
                        let shown = 1.0 - (alpha * (1.0 - opacity).ln()).exp();
                        for c in 0..3 {
                            let expected = shown * linear(encoded[c]) * tint[c];
                            worst = worst.max((f64::from(pixel[c]) - expected).abs());
                        }
                    }
                    eprintln!("{classification}, {interpolation}, portable: {portable}: off by {worst}");
                    // The sampler's weights have 8 bits, classified voxels 11.
                    assert!(worst < 6e-3, "{classification}, {interpolation}, portable: {portable}: {worst}");
                }
            }
        }
    }
}

/// A ball of one colour that is clear around it.
fn ball(studio: &Studio, function: &str, lighting: &str, ray_cast: &str) -> String {
    let places = (0..24usize.pow(3)).map(|index| [index % 24, index / 24 % 24, index / 576]);
    let colour = |place: [usize; 3]| {
        let [x, y, z] = place.map(|at| at as f32 - 11.5);
        let opacity = if x * x + y * y + z * z < 81.0 { 255 } else { 0 };
        [230, 120, 60, opacity]
    };
    studio.file("ball.raw", &places.flat_map(colour).collect::<Vec<u8>>());
    format!(
        "(entities: {{ {}
            \"sun\": ( DirectionalLight: (direction: (-1.0, -0.5, -1.0), irradiance: (3.0, 3.0, 3.0)) ),
            \"v\": (
                Volume: Raw(path: \"ball.raw\", size: (24, 24, 24), format: Rgba8),
                TransferFunction: ({function}), VolumeLighting: {lighting}, RayCast: ({ray_cast}) ) }})",
        camera(40.0, 24.0)
    )
}

#[needs(gpu)]
#[test]
fn without_colours_that_are_written_nothing_tints_the_data() {
    let mut studio = Studio::new();
    for function in ["", "preset: \"Object\"", "preset: \"Glow\"", "domain: (0.0, 200.0)"] {
        let pixels = studio.radiance(&ball(&studio, function, "EmissionAbsorption", ""), 25, 25);
        let [red, green, blue] = middle(&pixels).map(f64::from);
        assert!(red > 0.05, "{function}: {red}");
        for (channel, encoded) in [(green, 120.0), (blue, 60.0)] {
            let expected = linear(encoded) / linear(230.0);
            assert!((channel / red - expected).abs() < 2e-3, "{function}: {channel} / {red}, {expected}");
        }
        assert_eq!(pixels[0], [0.0; 3], "what is clear shows nothing");
    }
}

#[needs(gpu)]
#[test]
fn light_is_scattered_by_the_colour_of_the_data() {
    let mut studio = Studio::new();
    let function = "points: [(0.0, (1.0, 1.0, 1.0), 0.4)], opacity_length: 1.0";
    for lighting in ["Gradient(specular: 0.0)", "SingleScattering(g: 0.3)", "LightVolume()"] {
        let [whole, skipped] = ["skip_empty: false", "skip_empty: true"]
            .map(|ray_cast| studio.radiance(&ball(&studio, function, lighting, ray_cast), 25, 25));
        assert_eq!(difference(&whole, &skipped), 0.0, "{lighting}");
        let [red, green, blue] = middle(&whole).map(f64::from);
        assert!(red > 0.02 && red.is_finite(), "{lighting}: {red}");
        for (channel, encoded) in [(green, 120.0), (blue, 60.0)] {
            let albedo = linear(encoded) / linear(230.0);
            // Light that is scattered often takes on the colour more than once.
            let is_right = match lighting {
                "LightVolume()" => channel / red < albedo && channel / red > 0.3 * albedo,
                _ => (channel / red - albedo).abs() < 2e-3,
            };
            assert!(is_right, "{lighting}: {channel} / {red}, {albedo}");
        }
    }
}
