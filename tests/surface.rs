//! Opaque meshes against Lambert's and Blinn's formulas.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use support::{Studio, middle};
use tyndall_needs::needs;

const EYE: &str = "\"eye\": ( ViewCamera: (eye: (0.0, 0.0, 5.0), projection: Orthographic(height: 0.1)) ),";

/// A plane that faces the camera.
fn plane(phong: &str) -> String {
    format!(
        "\"plane\": ( Transform: (rotation: (90.0, 0.0, 0.0)), Mesh: Plane(size: (4.0, 4.0)), Phong: ({phong}) ),"
    )
}

#[needs(gpu)]
#[test]
fn lights_add_up_and_a_white_plane_facing_irradiance_pi_is_white() {
    let mut studio = Studio::new();
    let light = |name: &str, direction: &str, e: f32| {
        format!(
            "{name:?}: ( DirectionalLight: (direction: {direction}, irradiance: ({e:?}, {e:?}, {e:?})) ),"
        )
    };
    let pi = std::f32::consts::PI;
    let one = light("a", "(0.0, 0.0, -2.0)", pi);
    let askew = light("b", "(0.0, -1.0, -1.0)", pi);
    let behind = light("c", "(0.0, 0.0, 1.0)", pi);
    let mut seen = |lights: &str| {
        let scene = format!("(entities: {{ {EYE} {} {lights} }})", plane("diffuse: (1.0, 0.5, 0.0)"));
        middle(&studio.radiance(&scene, 3, 3))
    };
    for (lights, expected) in [
        (one.clone(), 1.0),
        (askew.clone(), 0.5f32.sqrt()),
        (format!("{one}{askew}{behind}"), 1.0 + 0.5f32.sqrt()),
    ] {
        let [r, g, b] = seen(&lights);
        assert!(
            (r - expected).abs() < 1e-5 && (g - expected / 2.0).abs() < 1e-5 && b == 0.0,
            "{r} {g} {b}, expected {expected}"
        );
    }
}

#[needs(gpu)]
#[test]
fn a_highlight_keeps_its_energy_whatever_the_shininess() {
    let mut studio = Studio::new();
    for shininess in [0.0f32, 8.0, 100.0] {
        let scene = format!(
            "(entities: {{ {EYE} {} \"sun\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0), irradiance: (1.0, 1.0, 1.0)) ) }})",
            plane(&format!("diffuse: (0.0, 0.0, 0.0), specular: (0.5, 0.5, 0.5), shininess: {shininess:?}"))
        );
        let seen = middle(&studio.radiance(&scene, 3, 3))[0];
        let expected = 0.5 * (shininess + 8.0) / (8.0 * std::f32::consts::PI);
        assert!((seen - expected).abs() < 1e-4 * expected, "{seen}, expected {expected}");
    }
}

#[needs(gpu)]
#[test]
fn more_lights_than_fit_at_first_make_a_new_pipeline_and_all_count() {
    let mut studio = Studio::new();
    for count in [3usize, 40] {
        let lights: String = (0..count)
            .map(|i| format!("\"light {i}\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0), irradiance: (0.1, 0.1, 0.1)) ),"))
            .collect();
        let scene = format!("(entities: {{ {EYE} {} {lights} }})", plane("diffuse: (1.0, 1.0, 1.0)"));
        let seen = middle(&studio.radiance(&scene, 3, 3))[0];
        let expected = 0.1 * count as f32 / std::f32::consts::PI;
        assert!((seen - expected).abs() < 1e-4, "{count} lights: {seen}, expected {expected}");
    }
}

#[needs(gpu)]
#[test]
fn the_nearest_surface_wins_and_both_sides_are_lit() {
    let mut studio = Studio::new();
    let glow = |name: &str, z: f32, tilt: f32, value: f32| {
        format!(
            "{name:?}: ( Transform: (translation: (0.0, 0.0, {z:?}), rotation: ({tilt:?}, 0.0, 0.0)), Mesh: Plane(size: (4.0, 4.0)),
                Phong: (ambient: ({value:?}, 0.0, 0.0), diffuse: (0.0, 1.0, 0.0)) ),"
        )
    };
    for projection in ["Orthographic(height: 0.1)", "Perspective(vertical_fov: 5.0)"] {
        let scene = format!(
            "(entities: {{ \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 5.0), projection: {projection}) ),
                \"sun\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0), irradiance: (3.14159265, 3.14159265, 3.14159265)) ),
                {} {} {} }})",
            glow("far", -1.0, 90.0, 0.3),
            glow("near", 1.0, -90.0, 0.7),
            glow("behind the eye", 6.0, 90.0, 0.9)
        );
        let seen = middle(&studio.radiance(&scene, 3, 3));
        assert!((seen[0] - 0.7).abs() < 1e-6 && (seen[1] - 1.0).abs() < 1e-4, "{projection}: {seen:?}");
    }
}

#[needs(gpu)]
#[test]
fn the_picture_is_the_same_at_every_scale() {
    let mut studio = Studio::new();
    let mut seen = |scale: f32| {
        let scene = format!(
            "(background: (0.1, 0.1, 0.1), entities: {{
                \"eye\": ( ViewCamera: (eye: ({0:?}, {1:?}, {2:?}), projection: Perspective(vertical_fov: 40.0)) ),
                \"sun\": ( DirectionalLight: (direction: (-1.0, -2.0, -1.0), irradiance: (3.0, 3.0, 3.0)) ),
                \"ball\": ( Transform: (translation: ({scale:?}, 0.0, 0.0)), Mesh: Sphere(radius: {scale:?}) ),
                \"box\": ( Mesh: Box(size: ({scale:?}, {scale:?}, {scale:?})) ) }})",
            scale,
            2.0 * scale,
            5.0 * scale
        );
        studio.radiance(&scene, 40, 30)
    };
    let expected = seen(1.0);
    for scale in [1e-6, 1e-3, 1e3, 1e6] {
        let pixels = seen(scale);
        let close = pixels.iter().zip(&expected).filter(|(a, b)| (a[0] - b[0]).abs() < 1e-3).count();
        assert!(close >= pixels.len() - 3, "scale {scale}: {close} of {} pixels agree", pixels.len());
    }
}
