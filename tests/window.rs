//! The window without a window: when pictures are drawn, and of what.

#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

use bevy_app::App;
use bevy_ecs::prelude::{Mut, World};
use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, pos2, vec2};
use std::path::PathBuf;
use std::time::{Duration, Instant};
use tyndall::components::{Phong, Shading};
use tyndall::gpu::{Gpu, GpuOptions, Target, read_texture};
use tyndall::report::Report;
use tyndall::scene::{Edits, LiveScene, Override, SceneEntities, Side};
use tyndall::ui::{Command, Log, OpenPanels, Recent, Totals};
use tyndall::window::{Frame, Painter, Session, SessionOptions};
use tyndall::{Comparison, Split, TyndallPlugins, View};
use tyndall_needs::needs;

const BALL: &str = r#"(
    background: (0.1, 0.1, 0.1),
    entities: {
        "eye": ( ViewCamera: (eye: (0.0, 0.0, 4.0)) ),
        "sun": ( DirectionalLight: (direction: (0.0, 0.0, -1.0), irradiance: (3.0, 3.0, 3.0)) ),
        "ball": ( Mesh: Sphere(radius: 0.6, subdivisions: 3), Phong: (diffuse: (0.8, 0.0, 0.0)) ),
    },
)"#;

const WAX: &str = r#"(
    millimetres_per_unit: 10.0,
    entities: {
        "eye": ( ViewCamera: (eye: (0.0, 0.0, 4.0)) ),
        "sun": ( DirectionalLight: (direction: (0.0, 0.0, -1.0), irradiance: (3.0, 3.0, 3.0)) ),
        "ball": (
            Mesh: Sphere(radius: 0.9, subdivisions: 3),
            Subsurface: (material: Preset("wax"), local: (diffuse: (0.0, 0.0, 0.8))),
            ScatteringMaps: (samples: 8),
        ),
    },
)"#;

/// A file as the window system hands it over.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &std::path::Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// A session on a texture.
struct Screen {
    session: Session,
    painter: Painter,
    target: Target,
    gpu: Gpu,
    started: Instant,
    folder: tempfile::TempDir,
}

/// Has the next update of the world panic.
#[derive(bevy_ecs::prelude::Resource)]
struct Fuse;

const SIZE: glam::UVec2 = glam::UVec2::new(640, 400);

impl Screen {
    fn new(scene: &str) -> Self {
        Self::overridden(scene, &[])
    }

    fn overridden(scene: &str, overrides: &[Override]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.ron");
        std::fs::write(&path, scene).unwrap();
        let gpu =
            pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap_or_else(|error| panic!("{error}"));
        let mut app = App::new();
        app.add_plugins(TyndallPlugins).insert_resource(gpu.clone());
        app.add_systems(bevy_app::Update, |fuse: Option<bevy_ecs::prelude::Res<Fuse>>| {
            assert!(fuse.is_none(), "a bug");
        });
        let scene = LiveScene::open(&mut app, &path, overrides);
        // No room for panels: the picture is as large as the screen, but for the bars.
        let none = OpenPanels { entities: false, inspector: false, report: false, log: false, axes: false };
        app.insert_resource(none);
        let screenshots = folder.path().to_owned();
        let session = Session::new(app, SessionOptions { scene, camera: None, screenshots, tell: None });
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let target = Target::new(&gpu, "screen", SIZE, format).unwrap();
        let painter = Painter::new(&gpu, format);
        Self { session, painter, target, gpu, started: Instant::now(), folder }
    }

    /// A frame with these events, and how long until the next.
    fn frame(&mut self, events: Vec<Event>) -> Option<Duration> {
        let input = RawInput {
            screen_rect: Some(egui::Rect::from_min_size(Pos2::ZERO, vec2(SIZE.x as f32, SIZE.y as f32))),
            time: Some(self.started.elapsed().as_secs_f64()),
            focused: true,
            events,
            ..Default::default()
        };
        let Frame { mut output, next, .. } = self.session.frame(input, self.painter.picture());
        let target = (&self.target.view, SIZE.to_array());
        let (context, picture) = (self.session.context(), self.session.picture());
        self.painter.paint(&self.gpu, context, &mut output, picture, target);
        next
    }

    /// A frame on which files are dropped.
    fn drop_files(&mut self, files: &[PathBuf]) {
        let dropped =
            |path: &PathBuf| -> egui::DroppedFileHandle { std::sync::Arc::new(Dropped(path.clone())) };
        let input = RawInput {
            screen_rect: Some(egui::Rect::from_min_size(Pos2::ZERO, vec2(SIZE.x as f32, SIZE.y as f32))),
            time: Some(self.started.elapsed().as_secs_f64()),
            focused: true,
            dropped_files: files.iter().map(dropped).collect(),
            ..Default::default()
        };
        let mut frame = self.session.frame(input, self.painter.picture());
        self.painter.skip(&self.gpu, &mut frame.output);
    }

    /// Frames as long as any is due.
    fn settle(&mut self) {
        let deadline = Instant::now() + Duration::from_secs(60);
        while let Some(wait) = self.frame(Vec::new()) {
            assert!(Instant::now() < deadline, "it does not come to rest");
            std::thread::sleep(wait);
        }
    }

    /// Loses the device, and goes on with another.
    fn lose_device(&mut self) {
        self.gpu.device.destroy();
        self.gpu.device.poll(wgpu::PollType::Poll).unwrap();
        assert!(self.gpu.lost().is_some());
        self.gpu = pollster::block_on(Gpu::new(&self.gpu.options)).unwrap();
        self.target = Target::new(&self.gpu, "screen", SIZE, wgpu::TextureFormat::Rgba8Unorm).unwrap();
        self.painter = Painter::new(&self.gpu, wgpu::TextureFormat::Rgba8Unorm);
        self.session.replace_device(self.gpu.clone());
    }

    fn scene(&self) -> PathBuf {
        self.folder.path().join("scene.ron")
    }

    /// Writes the scene anew, and has it read.
    fn write(&mut self, scene: &str) {
        std::fs::write(self.scene(), scene).unwrap();
        let deadline = Instant::now() + Duration::from_secs(10);
        while !self.session.poll() {
            assert!(Instant::now() < deadline, "the scene is not read again");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// The mean of the screen over a square of 8 pixels in the middle of what the picture shows, from its middle in its half heights.
    fn colour(&self, x: f32, y: f32) -> [f32; 3] {
        let pixels = read_texture(&self.gpu, &self.target.texture).unwrap();
        let [width, height] = self.session.shown().room.map(|side| side as f32);
        // The bar above is higher than the one below by what is left.
        let (middle, below) = (width / 2.0, 22.0);
        let centre = (middle + x * height / 2.0, SIZE.y as f32 - below - height / 2.0 - y * height / 2.0);
        let mut sum = [0.0; 3];
        for dy in 0..8 {
            for dx in 0..8 {
                let at = (centre.1 as usize - 4 + dy) * SIZE.x as usize + centre.0 as usize - 4 + dx;
                for channel in 0..3 {
                    sum[channel] += f32::from(pixels[4 * at + channel]) / 64.0;
                }
            }
        }
        sum
    }

    fn text(&self) -> String {
        std::fs::read_to_string(self.scene()).unwrap()
    }

    /// Edits the scene as panels do.
    fn edit<T>(&mut self, change: impl FnOnce(&mut Edits, &mut World) -> T) -> T {
        self.session.world().resource_scope(|world, mut edits: Mut<Edits>| change(&mut edits, world))
    }

    fn set(&mut self, path: &str, value: impl bevy_reflect::Reflect) {
        self.edit(|edits, world| edits.set(world, "ball", path, value.as_partial_reflect())).unwrap();
    }

    /// Presses a key, and says whether the window is to be closed.
    fn press(&mut self, key: egui::Key, modifiers: Modifiers) -> bool {
        let event = Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
        let input = RawInput {
            screen_rect: Some(egui::Rect::from_min_size(Pos2::ZERO, vec2(SIZE.x as f32, SIZE.y as f32))),
            time: Some(self.started.elapsed().as_secs_f64()),
            focused: true,
            events: vec![event],
            ..Default::default()
        };
        let mut frame = self.session.frame(input, self.painter.picture());
        self.painter.skip(&self.gpu, &mut frame.output);
        frame.quit
    }

    fn pictures(&self) -> u64 {
        self.session.counts().1
    }

    fn drag(&mut self, by: egui::Vec2, held: impl Fn(&mut Self)) {
        let from = pos2(320.0, 200.0);
        let button = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        self.frame(vec![Event::PointerMoved(from)]);
        self.frame(vec![button(from, true)]);
        for step in 1..=4 {
            self.frame(vec![Event::PointerMoved(from + by * (step as f32 / 4.0))]);
        }
        held(self);
        self.frame(vec![button(from + by, false)]);
        self.frame(vec![Event::PointerGone]);
    }
}

fn is_red([red, green, blue]: [f32; 3]) -> bool {
    red > 100.0 && green < 60.0 && blue < 60.0
}

#[needs(gpu)]
#[test]
fn nothing_is_drawn_while_nothing_changes() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    assert!(is_red(screen.colour(0.0, 0.0)), "{:?}", screen.colour(0.0, 0.0));
    let (frames, pictures) = screen.session.counts();
    // No frame is due: nothing would ever call for one. Those that come anyway, as when the pointer crosses the window, draw no picture.
    for step in 0..20 {
        screen.frame(vec![Event::PointerMoved(pos2(20.0 * step as f32, 300.0))]);
    }
    screen.settle();
    assert!(screen.session.counts().0 > frames);
    assert_eq!(screen.pictures(), pictures);
    // Nor does a file that is written as it was.
    std::fs::write(screen.scene(), BALL).unwrap();
    std::thread::sleep(Duration::from_millis(200));
    assert!(!screen.session.poll(), "it says what it said before");
    screen.settle();
    assert_eq!(screen.pictures(), pictures);
}

#[needs(gpu)]
#[test]
fn what_changes_in_the_file_is_seen_and_what_is_broken_is_told() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    screen.write(&BALL.replace("(0.8, 0.0, 0.0)", "(0.0, 0.0, 0.8)"));
    // The very next frame shows it.
    screen.frame(Vec::new());
    let [red, _, blue] = screen.colour(0.0, 0.0);
    assert!(blue > 100.0 && red < 60.0, "{red} {blue}");
    screen.settle();

    screen.write("(entities: { \"ball\": ( Mesh: Spere() ) })");
    screen.settle();
    let [red, _, blue] = screen.colour(0.0, 0.0);
    assert!(blue > 100.0 && red < 60.0, "the last good scene stays: {red} {blue}");
    let told = screen.session.world().resource::<Log>().lines();
    assert!(
        told.iter().any(|line| line.text.contains("Spere") && line.text.contains("scene.ron:1:")),
        "{told:?}"
    );

    screen.write(BALL);
    screen.settle();
    assert!(is_red(screen.colour(0.0, 0.0)));
}

#[needs(gpu)]
#[test]
fn edits_in_the_world_are_drawn_once() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    let ball = screen.session.world().resource::<SceneEntities>().0["ball"];
    screen.session.world().get_mut::<Phong>(ball).unwrap().diffuse = glam::Vec3::new(0.0, 0.8, 0.0);
    let before = screen.pictures();
    screen.settle();
    let [red, green, _] = screen.colour(0.0, 0.0);
    assert!(green > 100.0 && red < 60.0, "{red} {green}");
    // Coarsely, and in full; on a fast machine in full at once.
    assert!((1..=2).contains(&(screen.pictures() - before)), "{}", screen.pictures() - before);
}

#[needs(gpu)]
#[test]
fn edits_are_undone_done_again_and_saved_by_keys() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    screen.set("Phong.diffuse", glam::Vec3::new(0.0, 0.0, 0.8));
    screen.settle();
    let [red, _, blue] = screen.colour(0.0, 0.0);
    assert!(blue > 100.0 && red < 60.0, "{red} {blue}");
    assert!(screen.session.is_unsaved());
    screen.press(egui::Key::Z, Modifiers::COMMAND);
    screen.settle();
    assert!(is_red(screen.colour(0.0, 0.0)));
    assert!(!screen.session.is_unsaved(), "an edit that is undone leaves nothing");
    screen.press(egui::Key::Z, Modifiers::COMMAND | Modifiers::SHIFT);
    screen.settle();
    assert!(screen.colour(0.0, 0.0)[2] > 100.0);
    assert_eq!(screen.text(), BALL, "nothing is written that was not saved");
    screen.press(egui::Key::S, Modifiers::COMMAND);
    assert_eq!(screen.text(), BALL.replace("(0.8, 0.0, 0.0)", "(0.0, 0.0, 0.8)"));
    assert!(!screen.session.is_unsaved());
    screen.press(egui::Key::Z, Modifiers::COMMAND);
    screen.press(egui::Key::S, Modifiers::COMMAND);
    assert_eq!(screen.text(), BALL);
}

#[needs(gpu)]
#[test]
fn an_edit_survives_what_others_save_beside_it_and_conflicts_wait() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    screen.set("Phong.diffuse", glam::Vec3::new(0.0, 0.0, 0.8));
    let others = BALL.replace("radius: 0.6", "radius: 0.9");
    screen.write(&others);
    screen.settle();
    let [red, _, blue] = screen.colour(0.46, 0.0);
    assert!(blue > 60.0 && red < 60.0, "the larger ball in the edited colour: {red} {blue}");
    screen.press(egui::Key::S, Modifiers::COMMAND);
    let saved = others.replace("(0.8, 0.0, 0.0)", "(0.0, 0.0, 0.8)");
    assert_eq!(screen.text(), saved);

    screen.set("Phong.diffuse", glam::Vec3::new(0.0, 0.8, 0.0));
    let theirs = saved.replace("(0.0, 0.0, 0.8)", "(0.8, 0.0, 0.0)");
    screen.write(&theirs);
    screen.settle();
    assert!(is_red(screen.colour(0.0, 0.0)), "the file is shown");
    screen.press(egui::Key::S, Modifiers::COMMAND);
    assert_eq!(screen.text(), theirs, "nothing is saved over what nobody chose against");
    let told = screen.session.world().resource::<Log>().lines();
    assert!(told.iter().any(|line| line.text.contains("choose for each")), "{told:?}");
    screen.edit(|edits, world| {
        let conflict = edits.conflicts()[0].id;
        edits.resolve(world, conflict, Side::Ours).unwrap();
    });
    screen.press(egui::Key::S, Modifiers::COMMAND);
    assert_eq!(screen.text(), saved.replace("(0.0, 0.0, 0.8)", "(0.0, 0.8, 0.0)"));
}

#[needs(gpu)]
#[test]
fn a_scene_that_is_mended_can_be_edited() {
    let mut screen = Screen::new("(entities: { \"ball\": ( Mesh: Spere() ) })");
    screen.settle();
    assert!(!screen.session.world().contains_resource::<Edits>());
    screen.write(BALL);
    screen.set("Phong.diffuse", glam::Vec3::new(0.0, 0.0, 0.8));
    screen.settle();
    assert!(screen.colour(0.0, 0.0)[2] > 100.0);
}

#[needs(gpu)]
#[test]
fn overrides_are_edits_that_can_be_saved() {
    let set = "ball.Phong.diffuse=(0.0, 0.0, 0.8)".parse().unwrap();
    let mut screen = Screen::overridden(BALL, &[set]);
    screen.settle();
    assert!(screen.session.is_unsaved());
    // What is saved beside them meanwhile does not undo them.
    let others = BALL.replace("radius: 0.6", "radius: 0.9");
    screen.write(&others);
    screen.settle();
    let [red, _, blue] = screen.colour(0.46, 0.0);
    assert!(blue > 60.0 && red < 60.0, "{red} {blue}");
    screen.press(egui::Key::S, Modifiers::COMMAND);
    assert_eq!(screen.text(), others.replace("(0.8, 0.0, 0.0)", "(0.0, 0.0, 0.8)"));
}

#[needs(gpu)]
#[test]
fn a_panic_keeps_edits_and_the_next_window_offers_them() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    screen.set("Phong.shininess", 77.0_f32);
    screen.settle();
    screen.session.world().insert_resource(Fuse);
    screen.set("Phong.shininess", 78.0_f32);
    let kept = screen.folder.path().join("scene.recovered.ron");
    assert!(!kept.exists());
    let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| screen.settle()));
    assert!(panicked.is_err() && screen.text() == BALL, "what was saved is as it was");
    let text = std::fs::read_to_string(&kept).unwrap();
    assert_eq!(text.replace(", shininess: 78.0", ""), BALL, "{text}");
    assert_ne!(text, BALL);
    // The scene is opened again.
    let mut app = App::new();
    app.add_plugins(TyndallPlugins).insert_resource(screen.gpu.clone());
    let scene = LiveScene::open(&mut app, &screen.scene(), &[]);
    let screenshots = screen.folder.path().to_owned();
    let mut session = Session::new(app, SessionOptions { scene, camera: None, screenshots, tell: None });
    let offered = session.world().resource::<tyndall::ui::Recovered>().clone();
    assert_eq!(offered.0, [(screen.scene(), kept.clone())]);
    let lines = session.world().resource::<Log>().lines();
    assert!(lines.iter().any(|line| line.text.contains(&kept.display().to_string())), "{lines:?}");
}

#[needs(gpu)]
#[test]
fn nobody_leaves_unsaved_edits_unasked() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    assert!(screen.session.may_quit() && screen.press(egui::Key::Q, Modifiers::COMMAND));
    screen.set("Phong.shininess", 3.0_f32);
    assert!(!screen.press(egui::Key::Q, Modifiers::COMMAND));
    screen.settle();
    assert!(!screen.press(egui::Key::Escape, Modifiers::NONE), "the window stays");
    assert!(!screen.session.may_quit(), "asked again");
    screen.press(egui::Key::S, Modifiers::COMMAND);
    assert!(screen.session.may_quit());
}

#[needs(gpu)]
#[test]
fn the_camera_is_turned_and_survives_reloads() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    let home = screen.session.world().resource::<View>().viewpoint;
    screen.drag(vec2(90.0, 0.0), |_| {});
    screen.settle();
    let turned = screen.session.world().resource::<View>().viewpoint;
    assert!(turned.eye.x < -0.5 && (turned.eye.length() - 4.0).abs() < 1e-9, "{turned:?}");
    // The scene's own camera is as it was, and is not what one looks through.
    screen.write(&BALL.replace("eye: (0.0, 0.0, 4.0)", "eye: (0.0, 3.0, 4.0)"));
    screen.settle();
    assert_eq!(screen.session.world().resource::<View>().viewpoint, turned);
    let key = |key| Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    screen.frame(vec![key(egui::Key::Home)]);
    screen.settle();
    let reset = screen.session.world().resource::<View>().viewpoint;
    assert_eq!((reset.eye.y, home.eye.y), (3.0, 0.0));
}

#[needs(gpu)]
#[test]
fn a_drag_draws_coarsely_where_it_must_and_in_full_when_it_ends() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    let full = screen.session.shown().clone();
    assert_eq!((full.pixels, full.is_coarse), (full.room, false));
    let is_software = screen.gpu.is_software();
    screen.drag(vec2(40.0, 10.0), |screen| {
        // It may have found that it can draw in full.
        screen.frame(Vec::new());
        let held = screen.session.shown().clone();
        // Held still, nothing is drawn, and what is shown stays coarse.
        let before = screen.pictures();
        std::thread::sleep(Duration::from_millis(300));
        screen.frame(Vec::new());
        assert_eq!((screen.pictures(), screen.session.shown().is_coarse), (before, held.is_coarse));
        assert!(held.is_coarse || !is_software || held.took < Duration::from_millis(70));
    });
    screen.settle();
    let after = screen.session.shown();
    assert_eq!((after.pixels, after.is_coarse), (after.room, false));
}

#[needs(gpu)]
#[test]
fn translucent_meshes_are_refined_until_that_is_done() {
    let mut screen = Screen::new(WAX);
    screen.settle();
    let (done, wanted) = screen.session.shown().refined.unwrap();
    assert!(done == wanted && done > 1, "{done} of {wanted}");
    // Twice as many sets each time, not a picture a set; before that, a coarse one and a full one.
    assert!(screen.pictures() <= 2 + u64::from(wanted.ilog2()), "{}", screen.pictures());
    let computed = screen.session.world().resource::<Totals>().0["scattered_radiosity"];
    screen.drag(vec2(30.0, 0.0), |_| {});
    screen.settle();
    assert_eq!(
        screen.session.world().resource::<Totals>().0["scattered_radiosity"],
        computed,
        "a new view refines nothing"
    );
}

#[needs(gpu)]
#[test]
fn a_comparison_shows_both_shadings_and_computes_nothing_twice() {
    let mut screen = Screen::new(WAX);
    screen.settle();
    let scattered = screen.colour(0.5, 0.0);
    let computed = screen.session.world().resource::<Totals>().0.clone();
    let split = Split { at: 0.5, left: Shading::Local, right: Shading::Scattering };
    screen.session.world().insert_resource(Comparison(Some(split)));
    screen.settle();
    let ([red, _, blue], right) = (screen.colour(-0.5, 0.0), screen.colour(0.5, 0.0));
    assert!(blue > 80.0 && red < 60.0, "left is local: {red} {blue}");
    assert!(
        (0..3).all(|channel| (right[channel] - scattered[channel]).abs() < 1.0),
        "{right:?} {scattered:?}"
    );
    let totals = &screen.session.world().resource::<Totals>().0;
    for pass in ["scattered_radiosity", "light_gbuffer", "combine"] {
        assert_eq!(totals[pass], computed[pass], "{pass}");
    }
}

#[needs(gpu)]
#[test]
fn screenshots_are_of_the_full_picture() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    let key = |modifiers| Event::Key {
        key: egui::Key::F12,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    };
    screen.frame(vec![key(Modifiers::NONE)]);
    screen.frame(vec![key(Modifiers::SHIFT)]);
    let room = screen.session.shown().room;
    let png = image::open(screen.folder.path().join("scene_0001.png")).unwrap().to_rgb8();
    assert_eq!([png.width(), png.height()], room);
    let [red, green, _] = png.get_pixel(room[0] / 2, room[1] / 2).0;
    assert!(red > 100 && green < 60);
    let exr = image::open(screen.folder.path().join("scene_0001.exr")).unwrap().to_rgb32f();
    let radiance = exr.get_pixel(room[0] / 2, room[1] / 2).0;
    assert!((radiance[0] - 0.8 * 3.0 / std::f32::consts::PI).abs() < 0.02, "{radiance:?}");
}

#[needs(gpu)]
#[test]
fn any_size_of_window_is_drawn() {
    let mut screen = Screen::new(WAX);
    for (width, height) in [(1.0, 1.0), (3.0, 2000.0), (640.0, 1.0), (640.0, 400.0)] {
        let input = RawInput {
            screen_rect: Some(egui::Rect::from_min_size(Pos2::ZERO, vec2(width, height))),
            time: Some(screen.started.elapsed().as_secs_f64()),
            ..Default::default()
        };
        let mut frame = screen.session.frame(input, screen.painter.picture());
        screen.painter.skip(&screen.gpu, &mut frame.output);
        assert_eq!(screen.session.shown().failure, None);
        assert!(screen.session.shown().pixels.iter().all(|side| *side > 0));
    }
    screen.settle();
    assert!(screen.colour(0.0, 0.0)[0] > 60.0, "{:?}", screen.colour(0.0, 0.0));
}

#[needs(gpu)]
#[test]
fn a_lost_device_takes_nothing_with_it() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    screen.set("Phong.diffuse", glam::Vec3::new(0.0, 0.8, 0.0));
    screen.settle();
    screen.drag(vec2(30.0, 10.0), |_| {});
    screen.settle();
    // All but the line below, which says how long the picture took.
    let shown = |screen: &Screen| {
        let mut pixels = read_texture(&screen.gpu, &screen.target.texture).unwrap();
        pixels.truncate(4 * SIZE.x as usize * (SIZE.y as usize - 24));
        pixels
    };
    let before = shown(&screen);
    for _ in 0..2 {
        screen.lose_device();
        screen.settle();
        // Panels and their text, the view, the edit that no file has.
        assert!(before == shown(&screen));
        assert!(screen.session.is_unsaved());
    }
}

#[needs(gpu)]
#[test]
fn a_hundred_edits_leave_nothing_behind() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    let mut bytes = None;
    for turn in 0..100 {
        screen.write(&BALL.replace("0.8, 0.0, 0.0", &format!("0.8, {:.3}, 0.0", 0.001 * f64::from(turn))));
        screen.frame(Vec::new());
        if turn == 10 {
            screen.settle();
            bytes = Some(screen.session.world().resource::<Report>().gpu_bytes.clone());
        }
    }
    screen.settle();
    let report = screen.session.world().resource::<Report>();
    assert_eq!(Some(&report.gpu_bytes), bytes.as_ref());
    assert!(report.timeline.len() < 10 && report.pipelines.len() < 10, "{report:?}");
}

/// A square before a camera that brings it into the picture.
const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n";

impl Screen {
    fn names(&mut self) -> Vec<String> {
        let mut names: Vec<String> =
            self.session.world().resource::<SceneEntities>().0.keys().cloned().collect();
        names.sort();
        names
    }

    fn file(&self, name: &str, bytes: &str) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn told(&mut self) -> String {
        let lines = self.session.world().resource::<Log>().lines();
        lines.iter().map(|line| format!("{}\n", line.text)).collect()
    }
}

#[needs(gpu)]
#[test]
fn dropped_data_are_shown_and_saved_as_a_scene_that_is_followed() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    let square = screen.file("meshes/square.obj", SQUARE);
    screen.drop_files(std::slice::from_ref(&square));
    screen.settle();
    assert_eq!(screen.names(), ["camera", "fill light", "key light", "square"]);
    let [red, green, _] = screen.colour(0.0, 0.0);
    assert!(red > 60.0 && green > 60.0, "a square of no colour in place of the red ball: {red} {green}");
    assert!(screen.session.is_unsaved() && screen.session.shown().is_untitled);
    assert!(!screen.session.may_quit(), "asked as for edits");

    // Beside the mesh's folder, so that the path of the mesh is another than from here.
    let scene = screen.folder.path().join("made");
    screen.session.act(Command::SaveAs(scene));
    let scene = screen.folder.path().join("made.ron");
    let text = std::fs::read_to_string(&scene).unwrap();
    assert!(text.contains("File(\"meshes/square.obj\")"), "{text}");
    assert!(!screen.session.is_unsaved() && !screen.session.shown().is_untitled);
    assert_eq!(screen.session.scene(), scene);
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let document = tyndall::render::load_scene(&mut app, &scene, &[]);
    let problems = tyndall::render::all_problems(&mut app, &document);
    assert!(problems.is_empty(), "{problems:?}");

    // From here on it is a scene like any other.
    std::fs::write(&scene, text.replace("\"square\"", "\"table\"")).unwrap();
    let deadline = Instant::now() + Duration::from_secs(10);
    while !screen.session.poll() {
        assert!(Instant::now() < deadline, "the new file is not followed");
        std::thread::sleep(Duration::from_millis(5));
    }
    screen.settle();
    assert!(screen.names().contains(&"table".to_owned()), "{:?}", screen.names());
    let recent = screen.session.world().resource::<Recent>().0.clone();
    let whole = |path: &PathBuf| path.canonicalize().unwrap();
    assert_eq!(recent, [whole(&scene), whole(&square), whole(&screen.scene())]);
}

#[needs(gpu)]
#[test]
fn a_file_that_is_there_is_replaced_when_asked_for_twice_and_data_never() {
    let mut screen = Screen::new(BALL);
    let square = screen.file("square.obj", SQUARE);
    screen.session.open(std::slice::from_ref(&square));
    screen.settle();
    let taken = screen.file("taken.ron", "()");
    screen.session.act(Command::SaveAs(taken.clone()));
    assert_eq!(std::fs::read_to_string(&taken).unwrap(), "()");
    assert!(screen.told().contains("there is a file already"), "{}", screen.told());
    screen.session.act(Command::SaveAs(taken.clone()));
    assert!(std::fs::read_to_string(&taken).unwrap().contains("square.obj"));
    for _ in 0..2 {
        screen.session.act(Command::SaveAs(square.clone()));
    }
    assert_eq!(std::fs::read_to_string(&square).unwrap(), SQUARE);

    // A scene that has a file is written elsewhere whole, with its edits.
    let other = screen.scene();
    screen.session.open(&[other]);
    screen.settle();
    screen.set("Phong.shininess", 3.0_f32);
    let copy = screen.folder.path().join("copy.ron");
    screen.session.act(Command::SaveAs(copy.clone()));
    let text = std::fs::read_to_string(&copy).unwrap();
    assert!(text.contains("shininess: 3") && text.contains("subdivisions: 3"), "{text}");
    assert_eq!((screen.text().as_str(), screen.session.is_unsaved()), (BALL, false));
}

#[needs(gpu)]
#[test]
fn several_files_lie_over_each_other_and_what_cannot_be_opened_changes_nothing() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    let square = screen.file("square.obj", SQUARE);
    let broken = screen.file("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    let gone = screen.folder.path().join("gone.ron");
    for files in [vec![broken.clone()], vec![square.clone(), broken], vec![gone]] {
        screen.drop_files(&files);
        screen.settle();
        // What was told has opened the log, which covers the lower part of the picture.
        screen.session.world().resource_mut::<OpenPanels>().log = false;
        screen.settle();
        assert!(is_red(screen.colour(0.0, 0.0)), "{files:?}");
        assert_eq!(screen.names(), ["ball", "eye", "sun"]);
        let notice = screen.session.shown().notice.clone().unwrap();
        assert!(notice.starts_with("cannot open") && notice.lines().count() == 2, "{notice}");
        assert!(notice.lines().all(|line| screen.told().contains(line)), "{notice} {}", screen.told());
    }
    // A scene and a mesh: the scene has the camera and the lights.
    let scene = screen.scene();
    screen.drop_files(&[scene, square]);
    screen.settle();
    assert_eq!(screen.session.shown().notice, None);
    assert_eq!(screen.names(), ["ball", "eye", "square", "sun"]);
}

#[needs(gpu)]
#[test]
fn nobody_opens_something_else_over_unsaved_edits_unasked() {
    let mut screen = Screen::new(BALL);
    screen.settle();
    screen.set("Phong.shininess", 3.0_f32);
    let square = screen.file("square.obj", SQUARE);
    screen.session.open(std::slice::from_ref(&square));
    assert!(screen.names().contains(&"ball".to_owned()));
    screen.session.act(Command::SaveAndOpen(vec![square.clone()]));
    assert!(screen.text().contains("shininess: 3"), "{}", screen.text());
    assert!(screen.names().contains(&"square".to_owned()));
    // A scene without a file is asked for one first, and then left.
    let scene = screen.scene();
    screen.session.act(Command::SaveAndOpen(vec![scene]));
    assert!(screen.names().contains(&"square".to_owned()));
    let made = screen.folder.path().join("made.ron");
    screen.session.act(Command::SaveAs(made.clone()));
    assert!(made.exists() && screen.names().contains(&"ball".to_owned()));
    screen.session.open(&[square]);
    assert!(screen.names().contains(&"square".to_owned()));
    assert!(screen.session.act(Command::Discard));
}
