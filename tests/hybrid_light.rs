//! Meshes and volumes in each other's light, against values that are known exactly.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use support::{Studio, middle};
use tyndall_needs::needs;

/// A box of one medium, 4 x 4 x 2 mm about a place, with an extinction of 0.35 per mm.
fn fog(studio: &Studio, at: [f64; 3], more: &str) -> String {
    studio.volume("fog.raw", [16, 16, 8], |_| 0.5);
    let [x, y, z] = at;
    format!(
        "\"fog\": (
            Transform: (translation: ({x:?}, {y:?}, {z:?})),
            Volume: Raw(path: \"fog.raw\", size: (16, 16, 8), format: F32, spacing: (0.25, 0.25, 0.25)),
            TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 1.0, 1.0), {:?})], opacity_length: 1.0),
            RayCast: (step: 0.1, early_termination: 1.0),
            {more}
        ),",
        -(-0.35f64).exp_m1()
    )
}

/// A camera far above that sees a square of `height` about a place.
fn above(x: f64, height: f64) -> String {
    format!(
        "\"eye\": ( ViewCamera: (eye: ({x:?}, 0.0, 50.0), target: ({x:?}, 0.0, 0.0), up: (0.0, 1.0, 0.0), projection: Orthographic(height: {height:?})) ),"
    )
}

/// A plane that faces along z.
fn plane(name: &str, at: [f64; 3], size: [f64; 2], more: &str) -> String {
    let ([x, y, z], [width, depth]) = (at, size);
    format!(
        "\"{name}\": ( Transform: (translation: ({x:?}, {y:?}, {z:?}), rotation: (90.0, 0.0, 0.0)), Mesh: Plane(size: ({width:?}, {depth:?})), {more} ),"
    )
}

const DOWN: &str = "\"sun\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0)) ),";

#[needs(gpu)]
#[test]
fn a_volume_dims_the_light_that_reaches_a_mesh() {
    let mut studio = Studio::new();
    // The sun stands askew, so that the floor is seen beside the fog that shades it.
    let cosine = 0.8f64;
    let sun = "\"sun\": ( DirectionalLight: (direction: (0.6, 0.0, -0.8), irradiance: (3.0, 2.0, 1.0)) ),";
    let floor = plane("floor", [0.0, 0.0, -4.0], [40.0, 40.0], "Phong: (diffuse: (0.5, 0.5, 0.5)),");
    let mut seen = |head: &str, lighting: &str, x: f64| {
        let fog = fog(&studio, [0.0; 3], &format!("VolumeLighting: {lighting},"));
        let scene = format!("({head} entities: {{ {} {sun} {floor} {fog} }})", above(x, 0.01));
        middle(&studio.radiance(&scene, 1, 1))
    };
    let lit = |share: f64| {
        [3.0, 2.0, 1.0].map(|irradiance| irradiance * 0.5 / std::f64::consts::PI * cosine * share)
    };
    // The middle of the shadow is 4 * 0.75 mm aside; light came through 2 / 0.8 mm.
    let through = (-0.35f64 * 2.0 / cosine).exp();
    let cases = [
        ("", "SingleScattering()", 3.0, through),
        ("", "LightVolume(resolution: 0.3)", 3.0, through),
        ("", "SingleScattering()", 8.0, 1.0),
        ("volumes_shade_meshes: false,", "SingleScattering()", 3.0, 1.0),
        ("shading: Local,", "SingleScattering()", 3.0, 1.0),
        ("", "EmissionAbsorption", 3.0, 1.0),
        // Light that only clips the fog: it enters through its top 0.7 mm before the side at x = 2, and leaves there.
        ("", "SingleScattering()", 2.0 - 0.7 + 5.0 * 0.75, (-0.35f64 * 0.7 / 0.6).exp()),
    ];
    for (head, lighting, x, share) in cases {
        let (seen, expected) = (seen(head, lighting, x), lit(share));
        for (seen, expected) in seen.into_iter().zip(expected) {
            assert!(
                (f64::from(seen) / expected - 1.0).abs() < 1e-3,
                "{head} {lighting} at {x}: {seen}, expected {expected}"
            );
        }
    }
}

#[needs(gpu)]
#[test]
fn a_mesh_casts_its_shadow_into_a_volume() {
    let mut studio = Studio::new();
    // A roof over the half of the fog with x > 0, edge on for an eye that looks along y.
    let roof = plane("roof", [1.5, 0.0, 2.0], [3.0, 8.0], "");
    let inner = plane("roof", [1.5, 0.0, 0.0], [3.0, 8.0], "");
    let mut seen = |head: &str, roof: &str, x: f64, z: f64| {
        let fog = fog(&studio, [0.0; 3], "VolumeLighting: SingleScattering(),");
        let eye = format!(
            "\"eye\": ( ViewCamera: (eye: ({x:?}, -50.0, {z:?}), target: ({x:?}, 0.0, {z:?}), up: (0.0, 0.0, 1.0), projection: Orthographic(height: 0.01)) ),"
        );
        f64::from(
            middle(&studio.radiance(&format!("({head} entities: {{ {eye} {DOWN} {roof} {fog} }})"), 1, 1))[0],
        )
    };
    // What is lit is so along the whole way of the ray, 4 mm.
    let lit = |z: f64| -(-0.35f64 * 4.0).exp_m1() * (-0.35 * (1.0 - z)).exp() / (4.0 * std::f64::consts::PI);
    for z in [-0.7, 0.1, 0.6] {
        for (head, roof, x, share) in [
            ("", &roof, -1.0, 1.0),
            ("", &roof, 1.0, 0.0),
            ("meshes_shade_volumes: false,", &roof, 1.0, 1.0),
            // A mesh in the fog: above it is light.
            (
                "",
                &inner,
                1.0,
                if z > 0.5 {
                    1.0
                } else if z < 0.0 {
                    0.0
                } else {
                    continue;
                },
            ),
        ] {
            let (seen, expected) = (seen(head, roof, x, z), lit(z) * share);
            assert!(
                (seen - expected).abs() < 2e-3 * lit(z),
                "{head} at {x}, {z}: {seen}, expected {expected}"
            );
        }
    }
}

#[needs(gpu)]
#[test]
fn a_volume_dims_what_leaves_a_translucent_mesh() {
    let mut studio = Studio::new();
    let slab = "\"slab\": ( Transform: (translation: (0.0, 0.0, -3.0)), Mesh: Box(size: (3.0, 3.0, 1.0)), Subsurface: (material: Custom(sigma_a: (0.1, 0.1, 0.1), sigma_s: (10.0, 10.0, 10.0))), ScatteringMaps: (samples: 512) ),";
    // Seen from below, where the fog is not in the way of the eye.
    let eye = "\"eye\": ( ViewCamera: (eye: (0.1, 0.1, -50.0), target: (0.1, 0.1, 0.0), up: (0.0, 1.0, 0.0), projection: Orthographic(height: 0.5)) ),";
    let fog = fog(&studio, [0.0, 0.0, 1.0], "VolumeLighting: SingleScattering(),");
    let mut seen = |head: &str, fog: &str| {
        let pixels = studio.radiance(&format!("({head} entities: {{ {eye} {DOWN} {slab} {fog} }})"), 9, 9);
        pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / pixels.len() as f64
    };
    let clear = seen("", "");
    assert!(clear > 0.0);
    let through = (-0.35f64 * 2.0).exp();
    for (head, expected) in [("", through), ("volumes_shade_meshes: false,", 1.0)] {
        let share = seen(head, &fog) / clear;
        assert!((share / expected - 1.0).abs() < 2e-3, "{head}: {share}, expected {expected}");
    }
}
