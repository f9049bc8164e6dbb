//! The window itself: events in, frames out.

use super::memory::Remembered;
use super::recovery;
use super::surface::{Next, WindowSurface};
use super::{Painter, Session, SessionOptions, WindowError};
use crate::gpu::{Gpu, GpuOptions};
use crate::ui::{Level, Log, OpenPanels, Recent};
use bevy_app::App;
use egui_winit::accesskit_winit;
use glam::UVec2;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::{PhysicalPosition, PhysicalSize};
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

/// How a window is opened.
pub struct WindowOptions {
    /// Pixels across and down; else as large as when it was last closed.
    pub size: Option<UVec2>,
    /// How to choose the device.
    pub gpu: GpuOptions,
    /// What is shown in it.
    pub session: SessionOptions,
}

/// Opens a window on a scene that has been read into `app`, and returns when it is closed.
///
/// # Errors
///
/// If there is no display, no window on it, or no adapter that can draw in the window. What goes wrong later is told in the window.
pub fn run(app: App, options: WindowOptions) -> Result<(), WindowError> {
    let events = event_loop()?;
    let mut program =
        Program { proxy: events.create_proxy(), start: Some((app, options)), open: None, failure: None };
    let ended = events.run_app(&mut program);
    let ended = match program.failure {
        Some(failure) => Err(failure),
        None => ended.map_err(|error| WindowError::NoDisplay(error.to_string())),
    };
    if ended.is_err() {
        recovery::keep_unsaved();
    }
    ended
}

/// The event loop, which a library that is missing makes panic instead of fail.
fn event_loop() -> Result<EventLoop<Wake>, WindowError> {
    let built = std::panic::catch_unwind(|| EventLoop::with_user_event().build());
    let missing = "the libraries of the window system are not all there (on Debian: libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon0 libxkbcommon-x11-0)";
    let built = built.map_err(|_| WindowError::NoDisplay(missing.into()))?;
    built.map_err(|error| WindowError::NoDisplay(error.to_string()))
}

/// What wakes the loop besides events of the window.
enum Wake {
    AccessKit(accesskit_winit::Event),
    /// Files of the scene have changed.
    Files,
}

impl From<accesskit_winit::Event> for Wake {
    fn from(event: accesskit_winit::Event) -> Self {
        Self::AccessKit(event)
    }
}

struct Program {
    proxy: EventLoopProxy<Wake>,
    start: Option<(App, WindowOptions)>,
    open: Option<Open>,
    failure: Option<WindowError>,
}

/// A window that is open.
struct Open {
    window: Arc<Window>,
    surface: WindowSurface,
    painter: Painter,
    gpu: Gpu,
    state: egui_winit::State,
    session: Session,
    /// When the next frame is due, if nothing happens before.
    due: Option<Instant>,
    /// Frames in a row that could not be shown.
    failed: u32,
    /// The title as it was set last.
    title: String,
}

impl ApplicationHandler<Wake> for Program {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        let Some((app, options)) = self.start.take() else { return };
        match Open::new(events, self.proxy.clone(), app, options) {
            Ok(open) => self.open = Some(open),
            Err(failure) => self.end(events, failure),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let response = open.state.on_window_event(&open.window, &event);
        match event {
            WindowEvent::CloseRequested if open.session.may_quit() => events.exit(),
            WindowEvent::CloseRequested => open.window.request_redraw(),
            WindowEvent::RedrawRequested => match open.redraw() {
                Ok(true) => events.exit(),
                Ok(false) => {}
                Err(failure) => self.end(events, failure),
            },
            WindowEvent::Resized(size) => {
                open.surface.resize(&open.gpu, size.width, size.height);
                open.window.request_redraw();
            }
            WindowEvent::Occluded(false) | WindowEvent::ScaleFactorChanged { .. } => {
                open.window.request_redraw();
            }
            _ if response.repaint => open.window.request_redraw(),
            _ => {}
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, wake: Wake) {
        let Some(open) = &mut self.open else { return };
        let Wake::AccessKit(event) = wake else {
            if open.session.poll() {
                open.window.request_redraw();
            }
            return;
        };
        match event.window_event {
            accesskit_winit::WindowEvent::InitialTreeRequested => open.session.context().enable_accesskit(),
            accesskit_winit::WindowEvent::ActionRequested(request) => {
                open.state.on_accesskit_action_request(request);
            }
            accesskit_winit::WindowEvent::AccessibilityDeactivated => {
                open.session.context().disable_accesskit();
            }
        }
        open.window.request_redraw();
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let Some(open) = &mut self.open else { return };
        let now = Instant::now();
        if open.due.is_some_and(|due| due <= now) {
            open.due = None;
            open.window.request_redraw();
        }
        events.set_control_flow(open.due.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        if let Some(open) = &mut self.open {
            open.remember();
        }
        // Before the display goes that its surface is on.
        self.open = None;
    }
}

impl Program {
    fn end(&mut self, events: &ActiveEventLoop, failure: WindowError) {
        self.failure = Some(failure);
        // Nobody was asked what is to become of it.
        recovery::keep_unsaved();
        events.exit();
    }
}

impl Open {
    fn new(
        events: &ActiveEventLoop,
        proxy: EventLoopProxy<Wake>,
        mut app: App,
        options: WindowOptions,
    ) -> Result<Self, WindowError> {
        let (remembered, complaint) =
            Remembered::path().map(|path| Remembered::load(&path)).unwrap_or_default();
        let attributes = attributes(events, &options, &remembered);
        let window =
            events.create_window(attributes).map_err(|error| WindowError::NoWindow(error.to_string()))?;
        let window = Arc::new(window);
        let (surface, gpu) = WindowSurface::new(window.clone(), events.owned_display_handle(), &options.gpu)?;
        app.insert_resource(gpu.clone()).insert_resource(remembered.panels);
        app.insert_resource(remembered.recent);
        let mut session = Session::new(app, options.session);
        if let Some(complaint) = complaint {
            log::warn!("{complaint}");
            session.world().resource::<Log>().tell(Level::Warning, complaint);
        }
        let mut state = egui_winit::State::new(
            session.context().clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            window.theme(),
            Some(gpu.device.limits().max_texture_dimension_2d as usize),
        );
        let files = proxy.clone();
        // An event loop that has ended wants to know of nothing.
        session.on_change(Box::new(move || _ = files.send_event(Wake::Files)));
        // Readers of screens must be there before the window is.
        state.init_accesskit(events, &window, proxy);
        window.set_visible(true);
        window.request_redraw();
        let painter = surface.painter(&gpu);
        Ok(Self { window, surface, painter, gpu, state, session, due: None, failed: 0, title: String::new() })
    }

    /// Shows a frame, and says whether it was the last.
    fn redraw(&mut self) -> Result<bool, WindowError> {
        let size = self.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return Ok(false);
        }
        if self.gpu.lost().is_some() {
            self.reopen_device()?;
        }
        let started = Instant::now();
        let input = self.state.take_egui_input(&self.window);
        let mut frame = self.session.frame(input, self.painter.picture());
        self.set_title();
        let platform = std::mem::take(&mut frame.output.platform_output);
        self.state.handle_platform_output(&self.window, platform);
        let drawn = started.elapsed();
        let next = self.surface.next(&self.gpu)?;
        let acquired = started.elapsed();
        let is_shown = match next {
            Next::Texture(texture) => {
                let view = texture.texture.create_view(&Default::default());
                let target = (&view, self.surface.size());
                let (context, picture) = (self.session.context(), self.session.picture());
                self.painter.paint(&self.gpu, context, &mut frame.output, picture, target);
                self.window.pre_present_notify();
                self.gpu.queue.present(texture);
                true
            }
            Next::Hidden => true,
            Next::Again => false,
        };
        self.painter.skip(&self.gpu, &mut frame.output);
        log::debug!(
            "frame {}: drawn after {drawn:?}, acquired {acquired:?}, shown {:?}",
            self.session.counts().0,
            started.elapsed()
        );
        self.failed = if is_shown { 0 } else { self.failed + 1 };
        self.plan(if is_shown { frame.next } else { Some(RETRY * self.failed.min(10)) });
        Ok(frame.quit)
    }

    /// Goes on with another device.
    fn reopen_device(&mut self) -> Result<(), WindowError> {
        self.gpu = self.surface.reopen(&self.gpu.options)?;
        self.painter = self.surface.painter(&self.gpu);
        self.session.replace_device(self.gpu.clone());
        Ok(())
    }

    /// Marks the title of a scene with edits that are not saved.
    fn set_title(&mut self) {
        let mark = if self.session.is_unsaved() { "* " } else { "" };
        let title = format!("{mark}{}", title(self.session.scene()));
        if title != self.title {
            self.window.set_title(&title);
            self.title = title;
        }
    }

    fn plan(&mut self, next: Option<Duration>) {
        self.due = None;
        match next {
            Some(Duration::ZERO) => self.window.request_redraw(),
            Some(wait) => self.due = Some(Instant::now() + wait),
            None => {}
        }
    }

    fn remember(&mut self) {
        let Some(path) = Remembered::path() else { return };
        let size = self.window.inner_size();
        let maximized = self.window.is_maximized();
        let window = Remembered {
            size: Some((size.width, size.height)),
            position: self.window.outer_position().ok().map(|position| (position.x, position.y)),
            maximized,
            panels: *self.session.world().resource::<OpenPanels>(),
            recent: self.session.world().resource::<Recent>().clone(),
        };
        if let Err(error) = window.save(&path) {
            log::warn!("{}: what the window was like cannot be written: {error}", path.display());
        }
    }
}

/// After a frame that could not be shown.
const RETRY: Duration = Duration::from_millis(20);

/// Where a window opens that was not open before, and how small it can be.
const SIZE: PhysicalSize<u32> = PhysicalSize::new(1440, 810);
const SMALLEST: PhysicalSize<u32> = PhysicalSize::new(320, 200);

fn attributes(
    events: &ActiveEventLoop,
    options: &WindowOptions,
    remembered: &Remembered,
) -> winit::window::WindowAttributes {
    let asked = options.size.map(|size| PhysicalSize::new(size.x, size.y));
    let before = remembered.size.map(|(width, height)| PhysicalSize::new(width, height));
    let attributes = Window::default_attributes()
        .with_title(title(options.session.scene.path()))
        .with_visible(false)
        .with_inner_size(asked.unwrap_or_else(|| within_screen(events, before.unwrap_or(SIZE))))
        .with_min_inner_size(SMALLEST)
        .with_maximized(remembered.maximized && asked.is_none());
    match remembered.position.filter(|position| is_on_screen(events, *position)) {
        Some((x, y)) => attributes.with_position(PhysicalPosition::new(x, y)),
        None => attributes,
    }
}

fn title(scene: &Path) -> String {
    format!("{} – Tyndall", scene.file_name().unwrap_or_default().to_string_lossy())
}

/// A size that fits on the screen, which may be another than the one of last time.
fn within_screen(events: &ActiveEventLoop, size: PhysicalSize<u32>) -> PhysicalSize<u32> {
    let screens = events.primary_monitor().or_else(|| events.available_monitors().next());
    let screen = screens.map(|screen| screen.size()).filter(|screen| screen.width > 0 && screen.height > 0);
    let Some(screen) = screen else { return size };
    PhysicalSize::new(size.width.min(screen.width), size.height.min(screen.height))
}

/// Whether a corner there can be seen: screens may have been taken away since.
fn is_on_screen(events: &ActiveEventLoop, (x, y): (i32, i32)) -> bool {
    let (x, y) = (i64::from(x), i64::from(y));
    events.available_monitors().any(|monitor| {
        let (at, size) = (monitor.position(), monitor.size());
        let (left, top) = (i64::from(at.x), i64::from(at.y));
        (left - 20..left + i64::from(size.width) - 20).contains(&x)
            && (top - 20..top + i64::from(size.height) - 20).contains(&y)
    })
}
