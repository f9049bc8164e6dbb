//! A scene and the panels around it, without a window.

mod draw;
mod files;

use super::edits;
use super::files::{problems, told};
use super::orbit::Orbit;
use super::pace::Pace;
use super::recovery::{self, Unsaved};
use super::stale::Drawn;
use crate::gpu::Gpu;
use crate::passes::tonemap::Tonemap;
use crate::plain;
use crate::render::replace_device;
use crate::report::Report;
use crate::scene::{Edits, LiveScene, MOST_TOLD, Problem, Reload, Wake, more};
use crate::ui::{self, Command, Laid, Leaving, Level, Log, PictureFile, Shown};
use crate::view::{FreeCamera, Picture, SceneBounds, View, bounds_of};
use bevy_app::App;
use bevy_ecs::prelude::*;
use egui::{FullOutput, RawInput, TextureId, ViewportId};
use glam::UVec2;
use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// What a session shows.
pub struct SessionOptions {
    /// The scene, as it has been read into the app.
    pub scene: LiveScene,
    /// The camera to begin with; the first by name where none is said.
    pub camera: Option<String>,
    /// Where screenshots go.
    pub screenshots: PathBuf,
    /// Told of every problem that is found, besides the panels.
    pub tell: Option<fn(&[Problem])>,
}

/// A scene and the panels around it.
pub struct Session {
    app: App,
    context: egui::Context,
    scene: LiveScene,
    /// The problems that have been told, and to whom besides the panels.
    told: HashSet<String>,
    tell: Option<fn(&[Problem])>,
    log: Log,
    screenshots: PathBuf,
    /// The camera, once it has been moved.
    orbit: Option<Orbit>,
    pace: Pace,
    drawn: Drawn,
    shown: Shown,
    /// Pixels of the picture when it is drawn in full.
    room: UVec2,
    /// When what moved will be taken to rest.
    settles: Instant,
    /// Whether another set of samples came to nothing.
    is_stuck: bool,
    wanted: Vec<PictureFile>,
    pictures: u64,
    frames: u64,
    /// Whether files have been read since the picture was drawn.
    has_reloaded: bool,
    /// Devices that were lost.
    lost: usize,
    /// Whom to wake when files have changed, of whatever scene is shown.
    wake: Option<Arc<Mutex<Wake>>>,
    /// What waits for the scene to get a file.
    then: Leaving,
    /// The file that is replaced if it is asked for once more.
    replaceable: Option<PathBuf>,
    unsaved: Arc<Unsaved>,
}

/// What came of a frame.
pub struct Frame {
    /// What is to be painted, and done by the window.
    pub output: FullOutput,
    /// How long until the next frame is wanted, if nothing happens before; never where there is none.
    pub next: Option<Duration>,
    /// Whether the window is to be closed.
    pub quit: bool,
}

impl Session {
    /// Takes over an app into which the scene has been read and which has a [`Gpu`].
    pub fn new(mut app: App, options: SessionOptions) -> Self {
        let SessionOptions { mut scene, camera, screenshots, tell } = options;
        ui::init(app.world_mut());
        scene.allow_edits(&mut app);
        app.insert_resource(Picture { camera, ..Default::default() });
        let gpu = app.world().resource::<Gpu>();
        let pace = Pace::new(gpu.is_software());
        let shown = Shown { adapter: gpu.info.name.clone(), ..Default::default() };
        let log = app.world().resource::<Log>().clone();
        let context = egui::Context::default();
        let mut session = Self {
            app,
            context,
            scene,
            told: HashSet::new(),
            tell,
            log,
            screenshots,
            orbit: None,
            pace,
            drawn: Drawn::default(),
            shown,
            room: UVec2::ZERO,
            settles: Instant::now(),
            is_stuck: false,
            wanted: Vec::new(),
            pictures: 0,
            frames: 0,
            has_reloaded: false,
            lost: 0,
            wake: None,
            then: Leaving::No,
            replaceable: None,
            unsaved: Arc::default(),
        };
        session.follow_scene();
        session.tell_problems();
        session.offer_recovered();
        session
    }

    /// Offers edits that an earlier run could not save.
    fn offer_recovered(&mut self) {
        let recovered = recovery::find(self.scene.document().files.iter().map(PathBuf::as_path));
        for (_, kept) in &recovered.0 {
            let message =
                format!("edits of an earlier run that were not saved are kept in {}", kept.display());
            log::warn!("{message}");
            self.log.tell(Level::Warning, plain::line(&message));
        }
        self.app.insert_resource(recovered);
    }

    /// The world that is shown.
    pub fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// Where the scene is.
    pub fn scene(&self) -> &std::path::Path {
        self.scene.path()
    }

    /// What lays out the panels.
    pub fn context(&self) -> &egui::Context {
        &self.context
    }

    /// The picture that was drawn last.
    pub fn picture(&self) -> Option<&wgpu::Texture> {
        self.app.world().resource::<Tonemap>().encoded.as_ref().map(|target| &target.texture)
    }

    /// Frames laid out, and pictures drawn, since the session began.
    pub fn counts(&self) -> (u64, u64) {
        (self.frames, self.pictures)
    }

    /// What the panels are told.
    pub fn shown(&self) -> &Shown {
        &self.shown
    }

    /// Reads the scene again if its files have changed, and says whether it did. Asks for no picture itself: [`Self::frame`] does if one is due.
    pub fn poll(&mut self) -> bool {
        self.unsaved.clone().guard(|| self.poll_unguarded())
    }

    fn poll_unguarded(&mut self) -> bool {
        if !self.has_reloaded {
            self.app.world_mut().resource_mut::<Report>().timeline.clear();
        }
        match self.scene.poll(&mut self.app) {
            Reload::Nothing => return false,
            Reload::Refused { .. } => {
                self.log.tell(Level::Error, "the scene has errors; the last good one is shown");
            }
            Reload::Reloaded { .. } => self.log.tell(Level::Info, "the scene was read again"),
        }
        self.has_reloaded = true;
        // Files and shaders leave no mark on components.
        self.drawn = Drawn::default();
        self.told.clear();
        self.tell_problems();
        true
    }

    /// Goes on with another device than the one that is gone. The scene stays as it is, edits and all; the next frame draws it anew, and is
    /// to be painted by a [`Painter`](super::Painter) of the new device.
    pub fn replace_device(&mut self, gpu: Gpu) {
        let lost = self.app.world().resource::<Gpu>().lost().unwrap_or("another was asked for").to_owned();
        self.log.tell(Level::Warning, format!("the graphics device was lost ({lost}); another took over"));
        self.shown.adapter = gpu.info.name.clone();
        replace_device(self.app.world_mut(), gpu);
        self.drawn = Drawn::default();
        self.lost += 1;
    }

    /// Whether the window may be closed. Where edits would be lost, the panels ask what is to become of them, and answer by [`Frame::quit`].
    pub fn may_quit(&mut self) -> bool {
        self.may_leave(Leaving::ToClose)
    }

    /// Whether the scene is shown with edits that its files do not have yet.
    pub fn is_unsaved(&self) -> bool {
        self.scene.is_untitled() || edits::is_unsaved(self.app.world())
    }

    /// Has `wake` called whenever [`Self::poll`] has something to do.
    pub fn on_change(&mut self, wake: Box<dyn Fn() + Send>) {
        self.wake = Some(Arc::new(Mutex::new(wake)));
        self.follow_changes();
    }

    /// Lays out the panels, does what a person asks for in them, and draws the picture if it is not that of the scene any more. `texture`
    /// stands for the picture.
    ///
    /// Should it panic, edits that are not saved are kept in files beside those of the scene first.
    pub fn frame(&mut self, input: RawInput, texture: TextureId) -> Frame {
        self.unsaved.clone().guard(|| self.frame_unguarded(input, texture))
    }

    fn frame_unguarded(&mut self, input: RawInput, texture: TextureId) -> Frame {
        self.frames += 1;
        self.shown.texture = Some(texture);
        let dropped = self.take_dropped(&input);
        let (output, laid) = self.lay_out(input);
        let size = self.size_of(&laid, output.pixels_per_point);
        let is_editing = laid.commands.iter().any(Command::concerns_edits);
        let (of_files, commands): (Vec<_>, Vec<_>) =
            laid.commands.into_iter().partition(Command::concerns_files);
        self.obey(commands, size);
        let mut quit = false;
        for command in of_files {
            quit |= self.obey_files(command);
        }
        if quit {
            // What is not saved by now is not wanted.
            self.unsaved.remember(None);
        } else {
            self.unsaved.remember(self.app.world().get_resource::<Edits>());
        }
        let before = (self.shown.pixels, self.shown.took, self.shown.is_coarse, self.shown.refined);
        let next = self.draw_if_due(size);
        let after = (self.shown.pixels, self.shown.took, self.shown.is_coarse, self.shown.refined);
        // What the panels say of the picture is to be that of this one.
        let next = if before == after && !is_editing && !dropped { next } else { Some(Duration::ZERO) };
        let animation =
            output.viewport_output.get(&ViewportId::ROOT).map_or(Duration::MAX, |root| root.repaint_delay);
        let animation = (animation < Duration::from_secs(3600)).then_some(animation);
        Frame { next: [next, animation].into_iter().flatten().min(), output, quit }
    }

    /// Tells of the problems that have been found since the last time.
    fn tell_problems(&mut self) {
        let (sorted, all) = problems(&self.scene, self.app.world());
        let new: Vec<Problem> =
            all.iter().filter(|problem| !self.told.contains(&told(problem).1)).cloned().collect();
        for problem in new.iter().take(MOST_TOLD) {
            let (level, text) = told(problem);
            self.log.tell(level, text);
        }
        if let Some(more) = more(new.len()) {
            self.log.tell(Level::Warning, more);
        }
        if let Some(tell) = self.tell.filter(|_| !new.is_empty()) {
            tell(&new);
        }
        self.told = all.iter().map(|problem| told(problem).1).collect();
        self.app.insert_resource(sorted);
    }

    fn lay_out(&mut self, mut input: RawInput) -> (FullOutput, Laid) {
        // Glyphs are handed over once, unless the size of their texture changes; another device has to be given them again.
        let most = self.app.world().resource::<Gpu>().device.limits().max_texture_dimension_2d as usize;
        input.max_texture_side = Some(most - self.lost % 2);
        let mut laid: Option<Laid> = None;
        let (context, world) = (self.context.clone(), self.app.world_mut());
        let output = context.run_ui(input, |ui| {
            let mut now = ui::panels(ui, world, &self.shown);
            // Laid out once more where sizes were not known before; what was asked for the first time holds.
            if let Some(before) = laid.take() {
                now.commands.splice(0..0, before.commands);
            }
            laid = Some(now);
        });
        let laid = laid.unwrap_or(Laid { picture: egui::Rect::ZERO, commands: Vec::new() });
        (output, laid)
    }

    /// Pixels of the picture when it is drawn in full.
    fn size_of(&self, laid: &Laid, pixels_per_point: f32) -> UVec2 {
        let most = self.app.world().resource::<Gpu>().device.limits().max_texture_dimension_2d;
        let pixels = |points: f32| ((points * pixels_per_point).round() as u32).clamp(1, most);
        UVec2::new(pixels(laid.picture.width()), pixels(laid.picture.height()))
    }

    /// Does what was asked for of the picture and the edits.
    fn obey(&mut self, commands: Vec<Command>, size: UVec2) {
        let world = self.app.world_mut();
        let bounds = world.resource::<SceneBounds>().0;
        let viewpoint = world.resource::<View>().viewpoint;
        let aspect = f64::from(size.x) / f64::from(size.y);
        for command in commands {
            // The first movement takes over the camera as it is.
            let mut orbit = self.orbit.unwrap_or_else(|| Orbit::of(&viewpoint));
            match command {
                Command::Orbit(by) => orbit.orbit(by),
                Command::Pan(by) => orbit.pan(by),
                Command::Zoom { factor, cursor } => orbit.zoom(factor, cursor, bounds),
                Command::ToggleProjection => orbit.toggle_projection(),
                Command::LookAlong(axis) => orbit.look_along(axis),
                Command::Frame(entity) => {
                    let own = entity.and_then(|entity| bounds_of(world, entity));
                    if let Some(bounds) = own.or(bounds) {
                        orbit.frame(bounds, aspect);
                    }
                }
                Command::ResetCamera => {
                    self.orbit = None;
                    continue;
                }
                Command::ReopenDevice => {
                    let gpu = world.resource::<Gpu>();
                    gpu.device.destroy();
                    // What becomes of it is told to those who ask.
                    _ = gpu.device.poll(wgpu::PollType::Poll);
                    continue;
                }
                Command::Screenshot(kind) => {
                    self.wanted.push(kind);
                    continue;
                }
                _ => {
                    edits::obey(world, &command);
                    continue;
                }
            }
            self.orbit = Some(orbit);
        }
        let free = FreeCamera(self.orbit.map(|orbit| orbit.viewpoint(bounds)));
        world.resource_mut::<FreeCamera>().set_if_neq(free);
        self.shown.is_free = self.orbit.is_some();
        self.shown.is_orthographic = self.orbit.unwrap_or(Orbit::of(&viewpoint)).is_orthographic();
    }
}
