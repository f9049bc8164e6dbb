//! The ball is dragged, turned by keys, and told in numbers.

use crate::panel::{centre, drag, set};
use egui::{Key, vec2};
use egui_kittest::{Harness, kittest::Queryable};
use glam::{Quat, Vec3};
use tyndall::ui::light_direction;

struct Light {
    direction: Vec3,
    eye_from_scene: Quat,
    log: Vec<bool>,
}

fn light(direction: Vec3, eye_from_scene: Quat) -> Harness<'static, Light> {
    let state = Light { direction, eye_from_scene, log: Vec::new() };
    Harness::builder().with_size(vec2(260.0, 140.0)).build_ui_state(
        |ui, state: &mut Light| {
            if let Some(new) = light_direction(ui, "sun", state.direction, state.eye_from_scene) {
                state.direction = new.direction;
                state.log.push(new.finished);
            }
        },
        state,
    )
}

/// Radius of the ball.
const RADIUS: f32 = 44.0;

#[test]
fn the_handle_follows_the_pointer() {
    // The light comes from the viewer; then from the right.
    let mut harness = light(Vec3::NEG_Z, Quat::IDENTITY);
    let from = centre(&harness.get_by_label("sun"));
    drag(&mut harness, from, vec2(0.6 * RADIUS, 0.0));
    let state = harness.state();
    assert!(state.direction.distance(Vec3::new(-0.6, 0.0, -0.8)) < 0.03, "{}", state.direction);
    assert!((state.direction.length() - 1.0).abs() < 1e-3);
    assert_eq!(state.log.iter().filter(|finished| **finished).count(), 1, "{:?}", state.log);
    assert!(state.log.len() > 1 && *state.log.last().unwrap());
}

#[test]
fn beyond_the_rim_the_light_comes_from_behind() {
    let mut harness = light(Vec3::NEG_Z, Quat::IDENTITY);
    let from = centre(&harness.get_by_label("sun"));
    drag(&mut harness, from, vec2(0.0, -1.4 * RADIUS));
    let direction = harness.state().direction;
    assert!(direction.distance(Vec3::new(0.0, -0.6, 0.8)) < 0.03, "{direction}");
    // Taken hold of there, it stays there.
    let handle = centre(&harness.get_by_label("sun")) + vec2(0.0, -0.6 * RADIUS);
    drag(&mut harness, handle, vec2(0.0, 0.3 * RADIUS));
    let direction = harness.state().direction;
    assert!(direction.z > 0.9 && direction.y > -0.4, "{direction}");
}

#[test]
fn the_view_turns_the_ball() {
    // The viewer looks from the right, along -x.
    let eye_from_scene = Quat::from_rotation_y(-std::f32::consts::FRAC_PI_2);
    let mut harness = light(Vec3::NEG_X, eye_from_scene);
    let from = centre(&harness.get_by_label("sun"));
    drag(&mut harness, from, vec2(0.6 * RADIUS, 0.0));
    let towards_light = -harness.state().direction;
    let right = eye_from_scene.inverse() * Vec3::X;
    assert!(towards_light.dot(right) > 0.55, "{towards_light}");
}

#[test]
fn keys_and_numbers_turn_it_too() {
    let mut harness = light(Vec3::NEG_Z, Quat::IDENTITY);
    set(&mut harness, "sun azimuth", 90.0);
    assert!(harness.state().direction.distance(Vec3::NEG_X) < 1e-3);
    set(&mut harness, "sun elevation", 90.0);
    assert!(harness.state().direction.distance(Vec3::NEG_Y) < 1e-3);
    // At the pole the azimuth is not forgotten.
    set(&mut harness, "sun elevation", 0.0);
    assert!(harness.state().direction.distance(Vec3::NEG_X) < 1e-3, "{}", harness.state().direction);
    set(&mut harness, "sun azimuth", 0.0);
    harness.get_by_label("sun").focus();
    harness.run();
    harness.key_press(Key::ArrowRight);
    harness.run();
    let turned = (-harness.state().direction).angle_between(Vec3::Z).to_degrees();
    assert!((turned - 5.0).abs() < 0.1, "{turned}");
    harness.key_press(Key::ArrowUp);
    harness.run();
    assert!(harness.state().direction.y < -0.05);
}

#[test]
fn directions_that_are_none_do_no_harm() {
    for direction in [Vec3::ZERO, Vec3::NAN, Vec3::splat(f32::INFINITY)] {
        for view in
            [Quat::IDENTITY, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)]
        {
            let mut harness = light(direction, view);
            let from = centre(&harness.get_by_label("sun"));
            drag(&mut harness, from, vec2(20.0, 10.0));
            assert!((harness.state().direction.length() - 1.0).abs() < 1e-3);
        }
    }
}
