//! A light that turns once around a volume: what it lights changes no faster where sweeps change their axes than anywhere else.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use glam::DVec3;
use support::Studio;
use tyndall_needs::needs;

/// A soft ball with an opaque core off its centre, turned, and of voxels that are not cubes.
fn volume(studio: &Studio, lighting: &str) -> String {
    const SIDE: usize = 32;
    studio.volume("ball.raw", [SIDE; 3], |[x, y, z]| {
        let at = [x, y, z].map(|cell| (cell as f32 + 0.5) / SIDE as f32 - 0.5);
        let apart = |from: [f32; 3]| (0..3).map(|axis| (at[axis] - from[axis]).powi(2)).sum::<f32>().sqrt();
        let soft = (1.0 - apart([0.0; 3]) / 0.48).clamp(0.0, 1.0);
        let core = (1.0 - apart([0.1, -0.08, 0.1]) / 0.3).clamp(0.0, 1.0);
        0.5 * soft.min(0.6) + core
    });
    format!(
        "\"ball\": (
            Transform: (rotation: (20.0, 35.0, 10.0)),
            Volume: Raw(path: \"ball.raw\", size: ({SIDE}, {SIDE}, {SIDE}), format: F32, spacing: (1.0, 0.7, 1.3)),
            TransferFunction: (domain: (0.0, 1.3), opacity_length: 1.0, points: [
                (0.0, (0.9, 0.8, 0.7), 0.0), (0.25, (0.9, 0.8, 0.7), 0.05), (0.4, (1.0, 0.9, 0.6), 0.1), (0.8, (0.3, 0.9, 0.9), 0.6)]),
            VolumeLighting: {lighting},
            RayCast: (step: 1.0),
        ),"
    )
}

/// Root mean square differences of pictures a degree apart.
fn differences(studio: &mut Studio, lighting: &str, degrees: u32) -> Vec<f64> {
    let ball = volume(studio, lighting);
    let axis = DVec3::new(0.4, 1.0, -0.3).normalize();
    let side = axis.any_orthonormal_vector();
    let mut pictures = (0..=degrees).map(|degree| {
        let angle = f64::from(degree % 360).to_radians();
        let DVec3 { x, y, z } = side * angle.cos() + axis.cross(side) * angle.sin();
        studio.radiance(
            &format!(
                "(entities: {{ \"eye\": ( ViewCamera: (eye: (20.0, 25.0, 60.0), projection: Orthographic(height: 44.0)) ),
                    \"sun\": ( DirectionalLight: (direction: ({x:?}, {y:?}, {z:?})) ), {ball} }})"
            ),
            32,
            32,
        )
    });
    let mut former = pictures.next().unwrap();
    pictures
        .map(|picture| {
            let squares =
                picture.iter().flatten().zip(former.iter().flatten()).map(|(a, b)| f64::from(a - b).powi(2));
            let mean = squares.sum::<f64>() / (3 * picture.len()) as f64;
            former = picture;
            mean.sqrt()
        })
        .collect()
}

/// The greatest difference as a multiple of the median one.
fn worst_jump(studio: &mut Studio, lighting: &str, degrees: u32) -> f64 {
    let differences = differences(studio, lighting, degrees);
    let mut sorted = differences.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let degree = (0..differences.len()).max_by(|a, b| differences[*a].total_cmp(&differences[*b])).unwrap();
    eprintln!(
        "{lighting}: worst {:.3} of the median, at {degree} degrees; least {:.3}",
        differences[degree] / median,
        sorted[0] / median
    );
    differences[degree] / median
}

/// The greatest difference as a multiple of the median one within 5 degrees of it.
fn worst_spike(studio: &mut Studio, lighting: &str) -> f64 {
    const NEAR: usize = 5;
    let differences = differences(studio, lighting, 360);
    let spike = |degree: usize| {
        let mut near: Vec<f64> =
            (0..=2 * NEAR).map(|index| differences[(degree + 360 + index - NEAR) % 360]).collect();
        near.sort_by(f64::total_cmp);
        differences[degree] / near[NEAR]
    };
    let worst = (0..360).max_by(|a, b| spike(*a).total_cmp(&spike(*b))).unwrap();
    eprintln!("{lighting}: worst {:.3} of the median near it, at {worst} degrees", spike(worst));
    spike(worst)
}

#[needs(gpu)]
#[test]
fn a_picture_changes_evenly_while_the_light_turns() {
    let mut studio = Studio::new();
    for lighting in ["LightVolume()", "SingleScattering()"] {
        let jump = worst_jump(&mut studio, lighting, 360);
        assert!(jump < 2.0, "{lighting}: {jump}");
    }
}

/// Where light is scattered more to some sides, all that is seen changes faster while the light turns through these, up to three times the
/// median for light that is scattered just once; but nowhere suddenly.
#[needs(gpu)]
#[test]
fn a_medium_that_scatters_forwards_changes_nowhere_suddenly() {
    let mut studio = Studio::new();
    for lighting in ["SingleScattering(g: 0.3)", "LightVolume(g: 0.3)", "LightVolume(g: 0.6)"] {
        let spike = worst_spike(&mut studio, lighting);
        assert!(spike < 1.5, "{lighting}: {spike}");
    }
}

/// With one axis alone it does not: the tests above can fail.
#[needs(gpu)]
#[test]
fn a_picture_jumps_where_only_the_nearest_axis_is_swept() {
    let mut studio = Studio::new();
    let jump = worst_jump(&mut studio, "LightVolume(blend: false)", 60);
    assert!(jump > 2.0, "{jump}");
    let spike = worst_spike(&mut studio, "LightVolume(g: 0.3, blend: false)");
    assert!(spike > 2.0, "{spike}");
}
