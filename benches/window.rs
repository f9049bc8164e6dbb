//! What a picture costs while the scene is dragged, with the panels' painting, in a room of 960 x 540 pixels. `cargo bench --bench window`.
//!
//! The very frames of the window, only not shown: events in, panels laid out, picture drawn as coarsely as it must be, all of it painted.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

use bevy_app::App;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, pos2, vec2};
use std::time::Instant;
use tyndall::TyndallPlugins;
use tyndall::gpu::{Gpu, GpuOptions, Target};
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

    fn frame(&mut self, events: Vec<Event>) -> Option<std::time::Duration> {
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

criterion_group!(benches, drag);
criterion_main!(benches);
