//! How the program ends when something around it is not as it should be: nobody reads, the disk is full, it is interrupted, or it is at
//! fault itself.

#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, ExitCode, Output, Stdio};
use tyndall::prelude::*;
use tyndall_needs::needs;

/// A folder to run in.
struct Place(tempfile::TempDir);

impl Place {
    fn new(scene: &str) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        fs::write(place.path("scene.ron"), scene).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        command.current_dir(self.0.path()).args(arguments).env_remove("RUST_BACKTRACE");
        command
    }

    /// Runs the program on a machine that has nothing to draw with: what is refused is refused without.
    fn run(&self, code: i32, arguments: &[&str]) -> Output {
        let foreign = if cfg!(target_os = "macos") { "dx12" } else { "metal" };
        let output = self.command(arguments).env("WGPU_BACKEND", foreign).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "tyndall {arguments:?} said:\n{}", person(&output));
        output
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<_> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

fn person(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What was said, without the breaks of lines.
fn flat(output: &Output) -> String {
    person(output).replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

const BALL: &str = "(entities: {
    \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 5.0)) ),
    \"sun\": ( DirectionalLight: (direction: (1.0, -2.0, -1.0), irradiance: (3.0, 3.0, 3.0)) ),
    \"ball\": ( Mesh: Sphere() ),
})";

/// A scene in which each entity has a component that is none.
fn many_mistakes(count: usize, between: &str) -> String {
    let mut text = String::from("(entities: {");
    (0..count).for_each(|number| write!(text, "{between}\"e{number}\": (Unknown: ()),").unwrap());
    text + "})"
}

#[test]
#[cfg(unix)]
fn a_program_that_nobody_reads_ends_like_a_filter() {
    let place = Place::new(&many_mistakes(3000, "\n"));
    fs::write(place.path("fine.ron"), BALL).unwrap();
    for arguments in [
        &["check", "scene.ron", "--json"][..],
        &["info", "fine.ron", "--json"],
        &["info", "fine.ron"],
        &["--help"],
        &["--version"],
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut child = place.command(arguments).stdout(writer).stderr(Stdio::piped()).spawn().unwrap();
        let status = child.wait().unwrap();
        let mut said = String::new();
        std::io::Read::read_to_string(child.stderr.as_mut().unwrap(), &mut said).unwrap();
        assert_eq!((status.code(), said.as_str()), (Some(141), ""), "{arguments:?}");
    }
    // Nobody reads what is for a person: the work is done all the same.
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let status = place.command(&["check", "scene.ron"]).stderr(writer).status().unwrap();
    assert_eq!(status.code(), Some(1));
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_the_machines_fault() {
    let place = Place::new(BALL);
    let full = || fs::File::options().write(true).open("/dev/full").unwrap();
    for arguments in [
        &["check", "scene.ron", "--json"][..],
        &["info", "scene.ron", "--json"],
        &["info", "scene.ron"],
        &["--help"],
    ] {
        let output = place.command(arguments).stdout(full()).output().unwrap();
        assert_eq!(output.status.code(), Some(3), "{arguments:?}: {}", person(&output));
        assert!(!person(&output).contains("panicked"), "{}", person(&output));
    }
    let status = |arguments: &[&str]| place.command(arguments).stderr(full()).status().unwrap().code();
    assert_eq!(status(&["check", "scene.ron"]), Some(3), "that there is no problem was not said");
    assert_eq!(status(&["check", "scene.ron", "none.ron"]), Some(1));
    assert_eq!(status(&["new", "mine"]), Some(3));
    place.run(0, &["check", "mine/scene.ron"]);
    assert!(place.path("mine/scene.raw").is_file());
}

#[test]
#[cfg(unix)]
fn a_folder_that_cannot_be_made_whole_is_not_made() {
    let place = Place::new(BALL);
    // A file that is in the way of a folder that is needed.
    fs::create_dir(place.path("mine")).unwrap();
    std::os::unix::fs::symlink("/dev/null/nowhere", place.path("other")).unwrap();
    let output = place.run(2, &["new", "other/deep"]);
    assert!(flat(&output).contains("cannot make the folder"), "{}", person(&output));
    assert_eq!(place.names(), ["mine", "other", "scene.ron"]);
}

#[test]
fn many_mistakes_are_counted() {
    let place = Place::new(&many_mistakes(10_000, "\n"));
    let output = place.run(1, &["check", "scene.ron"]);
    let said = person(&output);
    assert_eq!(said.matches("unknown component").count(), 50);
    assert!(said.contains("and 9,950 more\n") && said.contains("scene.ron: 10,000 errors"), "{said}");
    let all: Value = serde_json::from_slice(&place.run(1, &["check", "scene.ron", "--json"]).stdout).unwrap();
    assert_eq!(all.as_array().unwrap().len(), 10_000);
    assert_eq!(all[9_999]["place"]["line"], 10_001);
    // On one line, which each of them would repeat.
    fs::write(place.path("line.ron"), many_mistakes(500, " ")).unwrap();
    let said = person(&place.run(1, &["check", "line.ron"]));
    assert!(said.len() < 60_000, "{} bytes", said.len());
    assert!(said.lines().all(|line| line.chars().count() < 180), "{said}");
}

#[test]
#[cfg(unix)]
fn nothing_that_a_terminal_would_obey_is_printed() {
    let evil = "\u{1b}[2J\u{9b}31m\u{7}";
    let place = Place::new(&BALL.replace("\"ball\"", &format!("\"{evil}\"")));
    let scene = format!("{evil}.ron");
    fs::copy(place.path("scene.ron"), place.path(&scene)).unwrap();
    fs::write(place.path("broken.ron"), format!("(entities: {{ \"{evil}\": ( Mesh: File(\"{evil}\") ) }})"))
        .unwrap();
    let is_plain = |text: &str| text.chars().all(|c| c == '\n' || !c.is_control());
    for (code, arguments) in [
        (0, &["check", scene.as_str()][..]),
        (1, &["check", "broken.ron"]),
        (1, &["check", "--json", "broken.ron"]),
        (0, &["info", scene.as_str()]),
        (0, &["info", "--json", scene.as_str()]),
        (2, &["render", scene.as_str(), "--set", &format!("{evil}.a=1")]),
        (2, &["render", scene.as_str(), "--camera", evil]),
        (2, &["render", scene.as_str(), "-o", &format!("{evil}/a.png")]),
        (3, &["render", scene.as_str()]),
    ] {
        let output = place.run(code, arguments);
        let text = String::from_utf8(output.stdout.clone()).unwrap() + &person(&output);
        assert!(is_plain(&text), "{arguments:?}: {text:?}");
    }
    let facts: Value = serde_json::from_slice(&place.run(0, &["info", "--json", &scene]).stdout).unwrap();
    assert!(facts[evil]["triangles"].is_u64(), "for programs names are as they are: {facts}");
}

#[test]
fn what_a_scene_is_read_from_is_not_overwritten() {
    let place = Place::new(
        "(include: [\"part.ron\"], entities: { \"a\": ( Mesh: File(\"a.obj\"), Phong: File(\"phong.ron\") ), \
         \"b\": ( Volume: Raw(path: \"b.png\", size: (1, 1, 1), format: U8) ) })",
    );
    for (name, text) in [
        ("part.ron", "(entities: {\"sun\": (DirectionalLight: ())})"),
        ("phong.ron", "()"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("b.png", "x"),
    ] {
        fs::write(place.path(name), text).unwrap();
    }
    fs::hard_link(place.path("a.obj"), place.path("same.exr")).unwrap();
    let before = place.names();
    for arguments in [
        &["--stats", "scene.ron"][..],
        &["--stats", "part.ron"],
        &["--stats", "./phong.ron"],
        &["--stats", "a.obj"],
        &["--stats", "b.png"],
        &["-o", "b.png"],
        &["-o", "same.exr"],
    ] {
        let output = place.run(2, &[&["render", "scene.ron"], arguments].concat());
        assert!(flat(&output).contains("is read for the scene"), "{arguments:?}: {}", person(&output));
    }
    for arguments in [
        &["-o", "c.png", "--stats", "c.png"][..],
        &["-o", "c.png", "--stats", "./c.png"],
        &["-o", "c.png", "--frames", "0..3", "--stats", "c_0002.png"],
    ] {
        let output = place.run(2, &[&["render", "scene.ron"], arguments].concat());
        assert!(flat(&output).contains("would be written twice"), "{arguments:?}: {}", person(&output));
    }
    assert_eq!(place.names(), before);
}

#[test]
fn what_cannot_be_written_is_found_out_before_the_work() {
    let place = Place::new(BALL);
    fs::write(place.path("kept.png"), "kept").unwrap();
    let mut permissions = fs::metadata(place.path("kept.png")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(place.path("kept.png"), permissions).unwrap();
    fs::create_dir(place.path("folder.png")).unwrap();
    fs::create_dir(place.path("f_0001.png")).unwrap();
    let long = format!("{}.png", "x".repeat(300));
    for arguments in [
        &["-o", "kept.png"][..],
        &["--stats", "kept.png"],
        &["-o", "folder.png"],
        &["--stats", "folder.png"],
        &["-o", "f.png", "--frames", "0..3"],
        &["-o", &long],
    ] {
        // The machine has no adapter, which would be found out next.
        let output = place.run(2, &[&["render", "scene.ron"], arguments].concat());
        assert!(flat(&output).contains("cannot write"), "{arguments:?}: {}", person(&output));
    }
    place.run(3, &["render", "scene.ron", "-o", "fine.png"]);
    assert_eq!(place.names(), ["f_0001.png", "folder.png", "kept.png", "scene.ron"]);
}

#[cfg(unix)]
#[needs(gpu)]
#[test]
fn a_dangling_link_is_followed() {
    let place = Place::new(BALL);
    fs::create_dir(place.path("deep")).unwrap();
    std::os::unix::fs::symlink("deep/second", place.path("first.png")).unwrap();
    std::os::unix::fs::symlink("real.png", place.path("deep/second")).unwrap();
    let output =
        place.command(&["render", "scene.ron", "--size", "16x16", "-o", "first.png"]).output().unwrap();
    assert!(output.status.success(), "{}", person(&output));
    assert!(place.path("first.png").is_symlink() && place.path("deep/second").is_symlink());
    assert!(image::open(place.path("deep/real.png")).is_ok());
}

#[cfg(target_os = "linux")]
#[needs(gpu)]
#[test]
fn an_interrupted_run_leaves_whole_pictures_only() {
    use std::os::unix::process::ExitStatusExt;
    let place = Place::new(BALL);
    for (name, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        let arguments = ["render", "scene.ron", "--size", "256x256", "-o", "f.exr", "--frames", "0..1000000"];
        let mut child = place.command(&arguments).stderr(Stdio::null()).spawn().unwrap();
        let started = std::time::Instant::now();
        while place.names().len() < 5 {
            assert!(started.elapsed().as_secs() < 60 && child.try_wait().unwrap().is_none());
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        let sent = Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        assert_eq!(child.wait().unwrap().signal(), Some(number), "who waits learns of the signal");
        for name in place.names() {
            assert!(name == "scene.ron" || name.starts_with("f_"), "{name} is left");
            if name != "scene.ron" {
                assert!(image::open(place.path(&name)).is_ok(), "{name} is not whole");
                fs::remove_file(place.path(&name)).unwrap();
            }
        }
    }
}

#[cfg(target_os = "linux")]
#[needs(gpu)]
#[test]
fn a_pipe_in_place_of_a_shader_is_named_and_not_waited_for() {
    let place = Place::new(BALL);
    fs::create_dir(place.path("shaders")).unwrap();
    assert!(Command::new("mkfifo").arg(place.path("shaders/surface.wgsl")).status().unwrap().success());
    let arguments = ["render", "scene.ron", "--size", "16x16"];
    let output = place.command(&arguments).env("TYNDALL_SHADERS", place.path("shaders")).output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{}", person(&output));
    let said = flat(&output);
    assert!(said.contains("surface.wgsl: expected a file, found a pipe"), "{said}");
}

/// Says to a test that it is the one run again.
const AGAIN: &str = "TYNDALL_TEST_AGAIN";

/// Runs a test of this program again in a process of its own.
fn again(test: &str) -> Output {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args(["--exact", test, "--nocapture"])
        .env(AGAIN, "yes")
        .env_remove("RUST_BACKTRACE")
        .output()
        .unwrap()
}

#[test]
fn a_bug_is_told_as_one() {
    if std::env::var_os(AGAIN).is_some() {
        let words = ["tyndall", "check", "a scene.ron"];
        let code = tyndall::cli::run_from(words, |_: &mut App| panic!("the plugin\u{1b}[31m broke"));
        assert_eq!(code, ExitCode::from(101));
        return;
    }
    let output = again("a_bug_is_told_as_one");
    assert!(output.status.success(), "{}", person(&output));
    let said = person(&output);
    for part in [
        "this is a bug in Tyndall",
        "the plugin␛[31m broke",
        "endings.rs:",
        "0.1.0",
        "tyndall check 'a scene.ron'",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    for leak in ["registry", "panicked at", env!("CARGO_MANIFEST_DIR")] {
        assert!(!said.contains(leak), "{leak}: {said}");
    }
}
