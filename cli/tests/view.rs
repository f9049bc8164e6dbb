//! `tyndall view` as a person meets it: a window on a real X server that is only in memory, driven by the pointer and the keyboard, and looked at.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tyndall_needs::needs;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt as _, ImageFormat, InputFocus};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// A bar, 3 wide and seen from the front.
const BAR: &str = r#"(
    background: (0.0, 0.0, 0.0),
    entities: {
        "eye": ( ViewCamera: (eye: (0.0, 0.0, 4.0)) ),
        "sun": ( DirectionalLight: (direction: (-0.5, 0.0, -1.0), irradiance: (4.0, 4.0, 4.0)) ),
        "bar": ( Mesh: Box(size: (3.0, 0.6, 0.6)), Phong: (ambient: (0.2, 0.0, 0.0), diffuse: (0.8, 0.0, 0.0)) ),
    },
)"#;

/// How long anything may take on a slow machine.
const PATIENCE: Duration = Duration::from_secs(90);

const SIZE: (u16, u16) = (900, 600);

/// Waits for something, and says what it was if that does not come.
fn wait<T>(what: &str, mut found: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + PATIENCE;
    loop {
        if let Some(found) = found() {
            return found;
        }
        assert!(Instant::now() < deadline, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// An X server whose screen is in memory.
struct Display {
    server: Child,
    name: String,
    x: RustConnection,
    root: u32,
}

impl Display {
    fn new() -> Self {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let name = format!(":{}", number.trim());
        let (x, screen) = x11rb::connect(Some(&name)).unwrap();
        let root = x.setup().roots[screen].root;
        Self { server, name, x, root }
    }

    /// Red, green and blue of a pixel.
    fn pixel(&self, x: i16, y: i16) -> [u8; 3] {
        let image =
            self.x.get_image(ImageFormat::Z_PIXMAP, self.root, x, y, 1, 1, !0).unwrap().reply().unwrap();
        [image.data[2], image.data[1], image.data[0]]
    }

    /// All of the screen, to be looked at.
    fn save(&self, name: &str) -> PathBuf {
        let (width, height) = (1280, 800);
        let reply = self.x.get_image(ImageFormat::Z_PIXMAP, self.root, 0, 0, width, height, !0);
        let data = reply.unwrap().reply().unwrap().data;
        let pixels = data.chunks_exact(4).flat_map(|pixel| [pixel[2], pixel[1], pixel[0]]).collect();
        let picture = image::RgbImage::from_raw(width.into(), height.into(), pixels).unwrap();
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        picture.save(&path).unwrap();
        path
    }

    fn fake(&self, kind: u8, detail: u8, (x, y): (i16, i16)) {
        self.x.xtest_fake_input(kind, detail, 0, self.root, x, y, 0).unwrap().check().unwrap();
    }

    fn pointer(&self, to: (i16, i16)) {
        self.fake(6, 0, to);
    }

    fn button(&self, pressed: bool) {
        self.fake(if pressed { 4 } else { 5 }, 1, (0, 0));
    }

    fn key(&self, code: u8, pressed: bool) {
        self.fake(if pressed { 2 } else { 3 }, code, (0, 0));
    }

    /// Gives the keyboard to the window, as there is no window manager to do it.
    fn focus(&self) {
        let windows = self.x.query_tree(self.root).unwrap().reply().unwrap().children;
        let is_seen = |window: &&u32| {
            let size = self.x.get_geometry(**window).unwrap().reply();
            size.is_ok_and(|size| (size.width, size.height) == SIZE)
        };
        let window = *windows.iter().find(is_seen).expect("there is no window");
        self.x.set_input_focus(InputFocus::PARENT, window, 0u32).unwrap().check().unwrap();
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// `tyndall view`, running.
struct Viewer {
    program: Child,
    said: Arc<Mutex<String>>,
}

impl Viewer {
    fn new(folder: &Path, display: &str, variables: &[(&str, &str)]) -> Self {
        Self::of(&[], folder, display, variables)
    }

    fn of(arguments: &[&str], folder: &Path, display: &str, variables: &[(&str, &str)]) -> Self {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tyndall"))
            .args(["view", "scene.ron"])
            .args(arguments)
            .current_dir(folder)
            .env("DISPLAY", display)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .env("XDG_CONFIG_HOME", folder.join("config"))
            .env("RUST_LOG", "warn,wgpu_hal=error,tyndall=debug")
            .envs(variables.iter().copied())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let said = Arc::new(Mutex::new(String::new()));
        let (mut lines, heard) = (BufReader::new(program.stderr.take().unwrap()), said.clone());
        std::thread::spawn(move || {
            let mut line = String::new();
            while lines.read_line(&mut line).is_ok_and(|read| read > 0) {
                heard.lock().unwrap().push_str(&line);
                line.clear();
            }
        });
        Self { program, said }
    }

    fn said(&self) -> String {
        self.said.lock().unwrap().clone()
    }

    /// Frames so far.
    fn frames(&self) -> usize {
        self.said().matches("] frame ").count()
    }

    /// Waits until no more frames come, and says how many there were.
    fn settle(&self) -> usize {
        let mut before = (self.frames(), Instant::now());
        wait("the window to come to rest", || {
            let now = self.frames();
            if now != before.0 {
                before = (now, Instant::now());
            }
            (now > 0 && before.1.elapsed() > Duration::from_millis(1500)).then_some(now)
        })
    }

    fn end(&mut self) -> ExitStatus {
        wait("the program to end", || self.program.try_wait().unwrap())
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// A folder with a scene, and with the window remembered as one without panels.
fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.ron"), BAR).unwrap();
    fs::create_dir_all(folder.path().join("config/tyndall")).unwrap();
    let (width, height) = SIZE;
    let window = format!(
        "(size: Some(({width}, {height})), position: Some((0, 0)), \
         panels: (entities: false, inspector: false, report: false, log: false, axes: false))"
    );
    fs::write(remembered(&folder), window).unwrap();
    folder
}

fn remembered(folder: &tempfile::TempDir) -> PathBuf {
    folder.path().join("config/tyndall/window.ron")
}

fn is_red([red, green, blue]: [u8; 3]) -> bool {
    red > 100 && green < 60 && blue < 60
}

fn is_blue([red, green, blue]: [u8; 3]) -> bool {
    blue > 100 && red < 60 && green < 60
}

fn is_black(pixel: [u8; 3]) -> bool {
    pixel.iter().all(|channel| *channel < 20)
}

const MIDDLE: (i16, i16) = (450, 300);

/// Where the bar's left end is, as long as one looks at it from the front.
const LEFT: (i16, i16) = (220, 300);

#[needs(gpu, display)]
#[test]
fn a_scene_is_opened_edited_turned_and_closed() {
    let folder = place();
    let display = Display::new();
    let mut viewer = Viewer::new(folder.path(), &display.name, &[]);
    let pixel = |(x, y)| display.pixel(x, y);
    wait("the red bar", || (is_red(pixel(MIDDLE)) && is_red(pixel(LEFT))).then_some(()));
    let at_rest = viewer.settle();
    display.save("view_1_opened.png");

    // Idle: not one frame.
    std::thread::sleep(Duration::from_secs(2));
    assert_eq!(viewer.frames(), at_rest, "{}", viewer.said());

    // Edited from outside.
    fs::write(
        folder.path().join("scene.ron"),
        BAR.replace("0.8, 0.0, 0.0", "0.0, 0.0, 0.8").replace("0.2, 0.0, 0.0", "0.0, 0.0, 0.2"),
    )
    .unwrap();
    wait("the blue bar", || (is_blue(pixel(MIDDLE)) && is_blue(pixel(LEFT))).then_some(()));
    fs::write(folder.path().join("scene.ron"), "(entities: { \"bar\": ( Mesh: Bux() ) })").unwrap();
    wait("the error", || viewer.said().contains("Bux").then_some(()));
    viewer.settle();
    assert!(is_blue(pixel(MIDDLE)), "the last good scene stays");
    display.save("view_2_broken.png");
    fs::write(folder.path().join("scene.ron"), BAR).unwrap();
    wait("the red bar again", || is_red(pixel(MIDDLE)).then_some(()));

    // Turned until it is seen from its end: half the height of the picture is a quarter of a turn.
    display.pointer(MIDDLE);
    display.button(true);
    for step in 1..=10 {
        display.pointer((MIDDLE.0 + step * 27, MIDDLE.1));
        std::thread::sleep(Duration::from_millis(20));
    }
    wait("the bar from its end", || (is_black(pixel(LEFT)) && is_red(pixel(MIDDLE))).then_some(()));
    display.button(false);
    viewer.settle();
    assert!(is_black(pixel(LEFT)) && is_red(pixel(MIDDLE)));
    display.save("view_3_turned.png");

    // By key: back to the scene's camera; a screenshot; closed.
    display.focus();
    let press = |code| {
        display.key(code, true);
        display.key(code, false);
    };
    let [home, f12, control, q] = [110, 96, 37, 24];
    press(home);
    wait("the scene's camera", || is_red(pixel(LEFT)).then_some(()));
    press(f12);
    let file = folder.path().join("scene_0001.png");
    wait("the screenshot", || file.exists().then_some(()));
    let picture = image::open(&file).unwrap().to_rgb8();
    assert_eq!(picture.width(), u32::from(SIZE.0));
    assert!(is_red(picture.get_pixel(picture.width() / 2, picture.height() / 2).0));
    display.key(control, true);
    press(q);
    display.key(control, false);
    assert!(viewer.end().success(), "{}", viewer.said());
    let window = fs::read_to_string(remembered(&folder)).unwrap();
    assert!(window.contains("900") && window.contains("entities: false"), "{window}");
}

#[needs(gpu, display)]
#[test]
fn a_window_that_is_terminated_keeps_edits() {
    let (display, folder) = (Display::new(), place());
    let set = ["--set", "bar.Phong.shininess=77.0"];
    let mut viewer = Viewer::of(&set, folder.path(), &display.name, &[]);
    viewer.settle();
    let sent = Command::new("kill").args(["-s", "TERM", &viewer.program.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let ended = viewer.end();
    assert_eq!(std::os::unix::process::ExitStatusExt::signal(&ended), Some(15), "{}", viewer.said());
    let kept = fs::read_to_string(folder.path().join("scene.recovered.ron")).unwrap();
    assert!(kept.contains("shininess: 77.0"), "{kept}");
    assert_eq!(fs::read_to_string(folder.path().join("scene.ron")).unwrap(), BAR);
    wait("where edits are kept to be said", || viewer.said().contains("scene.recovered.ron").then_some(()));
}

#[needs(gpu, display)]
#[test]
fn a_window_opens_on_what_is_wrong_and_with_what_cannot_be_remembered() {
    let folder = place();
    fs::write(folder.path().join("scene.ron"), "(entities: {").unwrap();
    fs::write(remembered(&folder), "(size: ").unwrap();
    let display = Display::new();
    let mut viewer = Viewer::new(folder.path(), &display.name, &[]);
    viewer.settle();
    let said = viewer.said();
    assert!(said.contains("never closed") && said.contains("window.ron"), "{said}");
    display.save("view_4_wrong.png");
    fs::write(folder.path().join("scene.ron"), BAR).unwrap();
    // With panels on either side the bar is in the middle of what is left.
    wait("the red bar", || (0..1280).step_by(8).any(|x| is_red(display.pixel(x, 400))).then_some(()));
    assert!(viewer.program.try_wait().unwrap().is_none());
}

#[needs(display)]
#[test]
fn without_an_adapter_the_machine_is_at_fault() {
    let folder = place();
    let display = Display::new();
    let mut viewer = Viewer::new(folder.path(), &display.name, &[("WGPU_BACKEND", "metal")]);
    let status = viewer.end();
    assert_eq!(status.code(), Some(3), "{}", viewer.said());
    wait("the advice", || viewer.said().contains("apt-get install mesa-vulkan-drivers").then_some(()));
}

#[test]
fn without_a_display_the_machine_is_at_fault_and_what_to_do_is_said() {
    let folder = place();
    for display in ["", ":987"] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tyndall"))
            .args(["view", "scene.ron"])
            .current_dir(folder.path())
            .env("DISPLAY", display)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let status = wait("the program to end", || program.try_wait().unwrap());
        let mut said = String::new();
        program.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert_eq!(status.code(), Some(3), "{said}");
        assert!(said.contains("needs a display") && said.contains("tyndall render"), "{said}");
    }
}

#[test]
fn what_only_the_command_line_can_mend_is_told_there() {
    let folder = place();
    let run = |code, arguments: &[&str], words: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_tyndall"))
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?}: {said}");
    };
    run(1, &["view", "gone.ron"], "gone.ron");
    run(2, &["view", "scene.ron", "--camera", "eyes"], "did you mean `eye`?");
    run(2, &["view", "scene.ron", "--set", "ber.Mesh=Sphere()"], "bar");
    run(2, &["view", "scene.ron", "--size", "0x100"], "WIDTHxHEIGHT");
}
