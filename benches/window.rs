//! What a picture costs while the scene is dragged, with the panels' painting, in a room of 960 x 540 pixels, and how long an edit of a file
//! takes until it is seen. `cargo bench --bench window`.
//!
//! The very frames of the window, only not shown: events in, panels laid out, picture drawn as coarsely as it must be, all of it painted.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

use bevy_app::App;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, pos2, vec2};
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use tyndall::TyndallPlugins;
use tyndall::gpu::{Gpu, GpuOptions, Target};
use tyndall::report::Report;
use tyndall::scene::LiveScene;
use tyndall::ui::OpenPanels;
use tyndall::window::{Painter, Session, SessionOptions};

/// Pixels of the picture when it is drawn in full.
const ROOM: [u32; 2] = [960, 540];

struct Screen {
    session: Session,
    painter: Painter,
    target: Target,
    gpu: Gpu,
    started: Instant,
}

impl Screen {
    fn new(scene: &str) -> Self {
        let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).expect("an adapter");
        let mut app = App::new();
        app.add_plugins(TyndallPlugins).insert_resource(gpu.clone());
        let scene = LiveScene::open(&mut app, scene.as_ref(), &[]);
        assert!(!scene.is_refused(), "{:#?}", scene.problems(app.world()));
        app.insert_resource(OpenPanels { entities: false, inspector: false, ..OpenPanels::default() });
        let options = SessionOptions { scene, camera: None, screenshots: ".".into(), tell: None };
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let target = Target::new(&gpu, "screen", glam::UVec2::from(ROOM), format).expect("a target");
        let painter = Painter::new(&gpu, format);
        let mut screen =
            Self { session: Session::new(app, options), painter, target, gpu, started: Instant::now() };
        // The bars above and below take some of the room: as much more is needed.
        screen.frame(Vec::new());
        let taken = ROOM[1] - screen.session.shown().room[1];
        let size = glam::UVec2::new(ROOM[0], ROOM[1] + taken);
        screen.target = Target::new(&screen.gpu, "screen", size, format).expect("a target");
        screen
    }

    fn frame(&mut self, events: Vec<Event>) -> Option<Duration> {
        let texture = &self.target.texture;
        let size = [texture.width(), texture.height()];
        let input = RawInput {
            screen_rect: Some(egui::Rect::from_min_size(Pos2::ZERO, vec2(size[0] as f32, size[1] as f32))),
            time: Some(self.started.elapsed().as_secs_f64()),
            events,
            ..Default::default()
        };
        let mut frame = self.session.frame(input, self.painter.picture());
        let (context, picture) = (self.session.context(), self.session.picture());
        self.painter.paint(&self.gpu, context, &mut frame.output, picture, (&self.target.view, size));
        self.gpu.wait("painting").expect("it is painted");
        frame.next
    }

    fn settle(&mut self) {
        while let Some(wait) = self.frame(Vec::new()) {
            std::thread::sleep(wait);
        }
    }

    fn button(&mut self, pos: Pos2, pressed: bool) {
        let button = PointerButton::Primary;
        self.frame(vec![
            Event::PointerMoved(pos),
            Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE },
        ]);
    }
}

fn drag(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("drag");
    group.sample_size(20).throughput(Throughput::Elements(1));
    for name in ["showcase", "light_volume"] {
        let mut screen = Screen::new(&format!("scenes/{name}.ron"));
        screen.settle();
        assert_eq!(screen.session.shown().room, ROOM);
        let full = screen.session.shown().took;
        let mut at = pos2(480.0, 270.0);
        screen.button(at, true);
        let mut turn = 0.0f32;
        let mut step = |screen: &mut Screen| {
            turn += 0.2;
            at += vec2(6.0 * turn.cos(), 2.0 * turn.sin());
            screen.frame(vec![Event::PointerMoved(at)]);
        };
        // Until it has found its pace.
        (0..20).for_each(|_| step(&mut screen));
        group.bench_function(name, |bench| bench.iter(|| step(&mut screen)));
        let shown = screen.session.shown();
        eprintln!(
            "{name}: {:?} pixels while it is dragged; in full {full:?}, on {}",
            shown.pixels, shown.adapter
        );
        screen.button(pos2(480.0, 270.0), false);
    }
    group.finish();
}

/// Edits of the showcase, of each kind in turn: a name, a file, and a text of it in which `{}` stands for a number from 0 to 1.
const EDITS: [(&str, &str, &str, &str); 5] = [
    ("material", "showcase.ron", "sigma_a: (0.003, 0.35,", "sigma_a: (0.003, 0.3{},"),
    ("its colour alone", "showcase.ron", "diffuse: (0.0015, 0.009,", "diffuse: (0.0015, 0.00{},"),
    ("light's colour", "showcase.ron", "irradiance: (10.0, 7.8,", "irradiance: (10.0, 7.{},"),
    ("light's direction", "showcase.ron", "direction: (-0.5, -0.5, 0.9)", "direction: (-0.5, -0.5{}, 0.9)"),
    ("transfer function", "transfer_functions/ember.ron", "(0.42, (1.00, 0.22,", "(0.42, (1.00, 0.{},"),
];

/// From the closing of a file that was edited to the picture that shows it, a hundred times.
fn edit(_: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder");
    for sub in ["scenes", "scenes/materials", "scenes/transfer_functions", "assets"] {
        copy(Path::new(sub), &folder.path().join(sub));
    }
    let scenes = folder.path().join("scenes");
    let mut screen = Screen::new(scenes.join("showcase.ron").to_str().expect("a path"));
    let (wake, woken) = channel();
    screen.session.on_change(Box::new(move || _ = wake.send(())));
    screen.settle();
    let bytes = screen.held();
    let mut all = Vec::new();
    println!("\n| edit | to the picture, ms | watch | parse | reconcile | passes | draw |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (what, file, from, to) in EDITS {
        let path = scenes.join(file);
        let text = std::fs::read_to_string(&path).expect("a file");
        assert!(text.contains(from), "{file}: {from}");
        let mut times: Vec<[f64; 6]> = Vec::new();
        for turn in 0..20 {
            let edited = text.replacen(from, &to.replace("{}", &format!("{:02}", 11 + 4 * turn)), 1);
            times.push(screen.edit(&path, &edited, &woken));
            screen.settle();
        }
        all.extend(times.iter().map(|parts| parts[0]));
        let medians = [0, 1, 2, 3, 4, 5].map(|part| median(times.iter().map(|parts| parts[part]).collect()));
        println!("| {what} | {} |", medians.map(|part| format!("{part:.0}")).join(" | "));
    }
    println!("| all of them | {:.0} | | | | | |", median(all));
    println!(
        "held on the GPU before: {bytes} bytes, after: {} bytes, on {}",
        screen.held(),
        screen.session.shown().adapter
    );
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder").map(Result::unwrap) {
        if entry.path().is_file() {
            std::fs::copy(entry.path(), to.join(entry.file_name())).expect("a copy");
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

impl Screen {
    /// Bytes held on the GPU.
    fn held(&mut self) -> u64 {
        self.session.world().resource::<Report>().gpu_bytes.values().sum()
    }

    /// Writes a file, and answers how long it takes until the picture shows it: all of it, and its parts.
    fn edit(&mut self, path: &Path, text: &str, woken: &Receiver<()>) -> [f64; 6] {
        std::fs::write(path, text).expect("it is written");
        let closed = Instant::now();
        loop {
            woken.recv_timeout(Duration::from_secs(10)).expect("the edit is noticed");
            if self.session.poll() {
                break;
            }
        }
        let before = self.session.counts().1;
        self.frame(Vec::new());
        assert!(self.session.counts().1 > before, "a picture is drawn");
        let whole = closed.elapsed().as_secs_f64() * 1e3;
        let timeline = &self.session.world().resource::<Report>().timeline;
        let part = |wanted: &str| timeline.iter().filter(|(part, _)| *part == wanted).map(|(_, ms)| ms).sum();
        [whole, part("watch"), part("parse"), part("reconcile"), part("passes"), part("draw")]
    }
}

criterion_group!(benches, drag, edit);
criterion_main!(benches);
