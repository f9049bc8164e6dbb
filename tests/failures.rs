//! What happens when the driver or a pass fails: it is told of where it belongs, the picture stays, and nothing is lost.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/files.rs"]
mod files;
#[path = "support/own_shaders.rs"]
mod own_shaders;
mod support;

use bevy_ecs::prelude::*;
use files::Live;
use glam::UVec2;
use own_shaders::with_own_shaders;
use std::path::Path;
use support::Studio;
use tyndall::Picture;
use tyndall::components::{SceneSettings, VolumeLighting};
use tyndall::gpu::{Gpu, GpuError, GpuOptions, buffer_of};
use tyndall::render::{Pixels, render_what_is_there};
use tyndall::report::Report;
use tyndall::scene::{EntityProblems, SceneEntities};
use tyndall_needs::needs;

/// Whatever is on the device, all of it is made again on the next one: every scene there is draws as it did.
#[needs(gpu)]
#[test]
fn every_scene_is_drawn_as_before_after_the_device_was_lost() {
    let mut studio = Studio::new();
    studio.app.add_plugins(tyndall_turntable::TurntablePlugin);
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut drawn = 0;
    for entry in std::fs::read_dir(scenes).unwrap().map(Result::unwrap) {
        let path = entry.path();
        if path.extension().is_none_or(|ending| ending != "ron") {
            continue;
        }
        let before = studio.encoded(&path, 48, 32);
        let gpu = studio.app.world().resource::<Gpu>().clone();
        gpu.device.destroy();
        gpu.device.poll(wgpu::PollType::Poll).unwrap();
        assert!(gpu.lost().is_some());
        assert!(before == studio.encoded(&path, 48, 32), "{}", path.display());
        assert!(studio.app.world().resource::<Gpu>().lost().is_none());
        drawn += 1;
    }
    assert!(drawn > 10);
}

#[needs(gpu)]
#[test]
fn what_the_driver_refuses_is_an_error_and_no_panic() {
    let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap();
    let too_large = || {
        _ = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("too large"),
            size: u64::MAX / 2,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        Ok(())
    };
    let error = gpu.attempt("making a buffer", too_large).unwrap_err();
    assert!(error.to_string().contains("failed while making a buffer"), "{error}");
    assert!(gpu.wait("waiting").is_ok());
    // Where nobody attempted it, the next to wait is told, once.
    too_large().unwrap();
    assert!(matches!(gpu.wait("waiting"), Err(GpuError::Driver { .. })));
    assert!(gpu.wait("waiting").is_ok());
}

/// Contents for which there is no room must not be written to a buffer that was not made.
#[needs(gpu)]
#[test]
fn contents_that_find_no_room_are_an_error_and_no_panic() {
    let gpu = pollster::block_on(Gpu::new(&GpuOptions { portable: true })).unwrap();
    let most = gpu.device.limits().max_buffer_size as usize;
    let usage = wgpu::BufferUsages::VERTEX;
    let uploaded = gpu.attempt("uploading", || Ok(buffer_of(&gpu, "vertices", &vec![0; most + 4], usage)));
    assert!(matches!(uploaded, Err(GpuError::Driver { .. })), "{uploaded:?}");
    let fits = gpu.attempt("uploading", || Ok(buffer_of(&gpu, "vertices", &[1, 2, 3, 4, 5], usage)));
    assert_eq!(fits.unwrap().size(), 8);
    assert!(gpu.wait("waiting").is_ok());
}

fn fog(lighting: &str, background: &str) -> String {
    format!(
        "(background: {background}, entities: {{
            \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 20.0)) ),
            \"sun\": ( DirectionalLight: (direction: (0.0, -1.0, -1.0)) ),
            \"fog\": (
                Volume: Raw(path: \"fog.raw\", size: (4, 4, 4)),
                TransferFunction: (domain: (0.0, 255.0), points: [(0.0, (1.0, 0.6, 0.2), 0.0), (1.0, (1.0, 0.6, 0.2), 0.5)]),
                VolumeLighting: {lighting},
            ) }})"
    )
}

const DARK: &str = "(0.0, 0.0, 0.1)";

/// How often the pass was tried, by the messages on the entity, and the picture.
fn look(live: &mut Live) -> (Vec<String>, Vec<[f32; 3]>) {
    // An error is told in the update in which it happens.
    let image = render_what_is_there(&mut live.app).or_else(|_| render_what_is_there(&mut live.app)).unwrap();
    let Pixels::Radiance(pixels) = image.pixels else { unreachable!() };
    let world = live.app.world();
    let fog = world.resource::<SceneEntities>().0["fog"];
    let messages = world.get::<EntityProblems>(fog).into_iter().flat_map(|all| all.iter());
    (messages.map(|problem| problem.message.clone()).collect(), pixels)
}

/// Updates that report the failure of a pass.
fn failures(live: &mut Live, updates: usize) -> usize {
    (0..updates).filter(|_| render_what_is_there(&mut live.app).is_err()).count()
}

#[needs(gpu)]
#[test]
fn a_pass_that_fails_marks_its_entity_and_waits_for_a_change() {
    with_own_shaders("a_pass_that_fails_marks_its_entity_and_waits_for_a_change", |shaders| {
        let mut app = bevy_app::App::new();
        app.insert_resource(pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap());
        app.insert_resource(Picture { size: UVec2::splat(9), camera: None, encoded: false });
        let fog_bytes = "d".repeat(64);
        let first = fog("EmissionAbsorption", DARK);
        let files = [("scene.ron", first.as_str()), ("fog.raw", fog_bytes.as_str())];
        let mut live = Live::open_in(app, &files, "scene.ron");
        let (messages, good) = look(&mut live);
        assert!(messages.is_empty(), "{messages:?}");
        // A shader that nothing uses yet breaks; then something uses it.
        let shader = shaders.join("light_cells.wgsl");
        let sound = std::fs::read_to_string(&shader).unwrap();
        std::fs::write(&shader, sound.replacen("let ", "lot ", 1)).unwrap();
        live.write("scene.ron", &fog("LightVolume()", DARK));
        live.until("scattering", |live| live.get::<VolumeLighting>("fog") != Some(VolumeLighting::default()));
        let (messages, kept) = look(&mut live);
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert!(messages[0].contains("light_cells"), "{messages:?}");
        assert!(kept == good, "the last picture stays");
        // While nothing changes it is not tried again; when something does, it is.
        assert_eq!(failures(&mut live, 3), 0);
        assert!(!live.app.world().resource::<Report>().passes.contains_key("scattered_light"));
        live.write("scene.ron", &fog("LightVolume()", "(0.1, 0.0, 0.1)"));
        live.until("red", |live| live.app.world().resource::<SceneSettings>().background.x > 0.0);
        assert_eq!(failures(&mut live, 3), 1);
        // Mended, all is as if nothing had been.
        std::fs::write(&shader, sound).unwrap();
        live.until("no message", |live| look(live).0.is_empty());
        let (messages, mended) = look(&mut live);
        assert!(messages.is_empty(), "{messages:?}");
        assert!(mended != good);
        assert!(live.app.world().resource::<Report>().passes.contains_key("scattered_light"));
    });
}
