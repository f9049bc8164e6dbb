//! Frame after frame takes no more memory. Alone in its process, which is what is measured.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use glam::{UVec2, Vec3};
use std::fs;
use support::Studio;
use tyndall::Picture;
use tyndall::components::{DirectionalLight, Shading, VolumeLighting};
use tyndall::render::render;
use tyndall::scene::SceneEntities;
use tyndall_needs::needs;

/// Bytes of memory that this process has.
fn memory() -> usize {
    let text = fs::read_to_string("/proc/self/statm").unwrap();
    text.split_whitespace().nth(1).unwrap().parse::<usize>().unwrap() * 4096
}

const MOST: usize = 20 << 20;

/// A mesh that shadows a volume, one that scatters and stands behind both, and two lights.
const SCENE: &str = "(entities: {
    \"eye\": ( ViewCamera: (eye: (0.0, 1.0, 4.0)) ),
    \"sun\": ( DirectionalLight: (direction: (1.0, -1.0, -1.0)) ),
    \"fill\": ( DirectionalLight: (direction: (-1.0, -1.0, -1.0), irradiance: (0.3, 0.3, 0.3)) ),
    \"ball\": ( Mesh: Sphere(radius: 0.5, subdivisions: 2), Transform: (translation: (-0.8, 0.0, 0.0)) ),
    \"wax\": ( Mesh: Sphere(radius: 0.3, subdivisions: 2), Transform: (translation: (0.9, 0.0, 0.0)), Subsurface: (), ScatteringMaps: (samples: 4) ),
    \"v\": ( Volume: Raw(path: \"v.raw\", size: (16, 16, 16), format: F32, spacing: (0.06, 0.06, 0.06)), VolumeLighting: LightVolume() ) })";

fn turn(studio: &mut Studio, frame: usize) {
    let world = studio.app.world_mut();
    let sun = world.resource::<SceneEntities>().0["sun"];
    let angle = 0.37 * frame as f32;
    world.get_mut::<DirectionalLight>(sun).unwrap().direction = Vec3::new(angle.cos(), -0.8, angle.sin());
    render(&mut studio.app).unwrap();
}

fn change(studio: &mut Studio, step: usize) {
    let world = studio.app.world_mut();
    let volume = world.resource::<SceneEntities>().0["v"];
    *world.get_mut::<VolumeLighting>(volume).unwrap() = match step % 3 {
        0 => VolumeLighting::LightVolume {
            cone_angle: Default::default(),
            resolution: 1.0,
            blend: true,
            towards_eye: false,
            gradient_specular: 0.0,
            emission: 0.0,
            g: 0.0,
        },
        1 => VolumeLighting::SingleScattering { g: 0.0, resolution: 1.0 },
        _ => VolumeLighting::EmissionAbsorption,
    };
    let wax = world.resource::<SceneEntities>().0["wax"];
    let shading = if step.is_multiple_of(2) { Shading::Local } else { Shading::Scattering };
    world.entity_mut(wax).insert(shading);
    let size = UVec2::new(24 + 8 * (step as u32 % 5), 24);
    world.insert_resource(Picture { size, camera: None, encoded: false });
    render(&mut studio.app).unwrap();
}

#[needs(gpu)]
#[test]
fn frames_take_no_more_memory() {
    let mut studio = Studio::new();
    studio.volume("v.raw", [16, 16, 16], |[x, y, z]| ((x + y + z) % 7) as f32 / 6.0);
    studio.radiance(SCENE, 24, 24);
    (0..30).for_each(|frame| turn(&mut studio, frame));
    let before = memory();
    (30..330).for_each(|frame| turn(&mut studio, frame));
    let grown = memory().saturating_sub(before);
    eprintln!("300 frames: {grown} bytes more");
    assert!(grown < MOST, "{grown} bytes more after 300 frames in which a light turned");
    (0..30).for_each(|step| change(&mut studio, step));
    let before = memory();
    (30..150).for_each(|step| change(&mut studio, step));
    let grown = memory().saturating_sub(before);
    eprintln!("120 changes: {grown} bytes more");
    assert!(grown < MOST, "{grown} bytes more after 120 changes of lighting, shading and the picture's size");
}
