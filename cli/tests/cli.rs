//! The program as it is typed: exit codes, what goes where, and files that are there whole or not at all.

#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

#[path = "cli/help.rs"]
mod help;
#[path = "cli/pictures.rs"]
mod pictures;

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tyndall_needs::needs;

/// A folder to run in.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn with_scene(text: &str) -> Self {
        let place = Self::new();
        place.write("scene.ron", text);
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.path(name), text).unwrap();
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        command.current_dir(self.0.path()).args(arguments);
        command
    }

    /// Runs the program, which must end with this exit code.
    fn run(&self, code: i32, arguments: &[&str]) -> Told {
        Told::new(self.command(arguments).output().unwrap(), code, arguments)
    }

    /// The same on a machine that has nothing to draw with.
    fn run_without_adapter(&self, code: i32, arguments: &[&str]) -> Told {
        let foreign = if cfg!(target_os = "macos") { "dx12" } else { "metal" };
        let output = self.command(arguments).env("WGPU_BACKEND", foreign).output().unwrap();
        Told::new(output, code, arguments)
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(self.0.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

/// What the program said.
struct Told {
    data: String,
    person: String,
}

impl Told {
    fn new(output: Output, code: i32, arguments: &[&str]) -> Self {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let told = Self { data: text(&output.stdout), person: text(&output.stderr) };
        let person = &told.person;
        assert_eq!(output.status.code(), Some(code), "tyndall {arguments:?} said:\n{person}");
        told
    }

    fn says(&self, words: &str) -> &Self {
        // Long messages are wrapped, with a bar in front of their further lines.
        let flat = self.person.replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(flat.contains(words), "expected `{words}` in:\n{}", self.person);
        self
    }

    fn json(&self) -> Value {
        serde_json::from_str(&self.data).unwrap_or_else(|error| panic!("{error}: {}", self.data))
    }
}

const BALL: &str = r#"(
    background: (0.25, 0.5, 4.0),
    entities: {
        "eye": ( ViewCamera: (eye: (0.0, 0.0, 5.0)) ),
        "from above": ( ViewCamera: (eye: (0.0, 5.0, 0.0), up: (0.0, 0.0, -1.0)) ),
        "sun": ( DirectionalLight: (direction: (1.0, -2.0, -1.0), irradiance: (3.0, 3.0, 3.0)) ),
        "box": ( Mesh: Box(size: (2.0, 0.5, 0.5)), Turntable: (degrees_per_second: 900.0) ),
    },
)
"#;

#[test]
fn without_a_command_help_is_shown_and_the_command_line_is_at_fault() {
    let place = Place::new();
    place.run(2, &[]).says("Usage");
    place.run(2, &["rendr"]).says("render");
    assert!(place.run(0, &["--help"]).data.contains("check"));
    assert!(place.run(0, &["--version"]).data.starts_with("tyndall "));
}

#[test]
fn a_wrong_command_line_is_refused_before_any_work() {
    let place = Place::with_scene(BALL);
    place.run(2, &["render", "scene.ron", "-o", "out.jpg"]).says(".png or .exr");
    place.run(2, &["render", "scene.ron", "--size", "0x10"]).says("such as 960x540");
    place.run(2, &["render", "scene.ron", "--frames", "2..2"]).says("A below B");
    place.run(2, &["render", "scene.ron", "--fps", "0"]).says("above 0");
    place.run(2, &["render", "scene.ron", "--set", "ball"]).says("found no `=`");
    place.run(2, &["render", "scene.ron", "-o", "nowhere/out.png"]).says("there is no folder nowhere");
    place.run(2, &["render", "scene.ron", "--stats", "nowhere/s.json"]).says("there is no folder nowhere");
    place.run(2, &["render", "scene.ron", "-o", "scene.ron/out.png"]).says("there is no folder scene.ron");
    place.run(2, &["render", "scene.ron", "--set", "bax.Mesh.size=1"]).says("did you mean `box`?");
    place.run(2, &["render", "scene.ron", "--camera", "from abov"]).says("did you mean `from above`?");
    assert_eq!(place.names(), ["scene.ron"]);
}

#[test]
fn a_scene_at_fault_is_told_from_a_command_line_at_fault() {
    let place = Place::with_scene("(entities: { \"ball\": ( Mesh: Spere() ) })");
    place
        .run(1, &["check", "scene.ron"])
        .says("scene.ron:1:30")
        .says("did you mean `Sphere`?")
        .says("1 error");
    place.run(1, &["render", "scene.ron"]).says("did you mean `Sphere`?");
    place.run(1, &["info", "scene.ron"]).says("did you mean `Sphere`?");
    place.run(1, &["check", "scen.ron"]).says("did you mean `scene.ron`?");
    place.run(1, &["check", "."]).says("a folder without DICOM slices");
    place.write("fine.ron", BALL);
    place
        .run(1, &["check", "fine.ron", "scene.ron"])
        .says("fine.ron: no problems")
        .says("scene.ron: 1 error");
    place.run(1, &["render", "fine.ron", "--set", "box.Mesh.size=big"]).says("expected three numbers");
}

#[test]
fn without_an_adapter_the_machine_is_at_fault_and_the_mend_is_told() {
    let place = Place::with_scene(BALL);
    place.run_without_adapter(3, &["render", "scene.ron"]).says("apt-get install mesa-vulkan-drivers");
    place.run_without_adapter(3, &["info"]).says("apt-get install mesa-vulkan-drivers");
    place.run_without_adapter(0, &["check", "scene.ron"]).says("no problems");
    place.run_without_adapter(0, &["info", "scene.ron"]);
    place.write("broken.ron", "(");
    place.run_without_adapter(1, &["render", "broken.ron"]).says("never closed");
    assert_eq!(place.names(), ["broken.ron", "scene.ron"]);
}

#[test]
fn check_reports_for_machines() {
    let place = Place::with_scene("(entities: { \"ball\": ( Mesh: File(\"a.obj\") ), \"ä\": ( Fong: () ) })");
    let report = place.run(1, &["check", "--json", "scene.ron"]).json();
    let problem = &report[0];
    assert_eq!(report.as_array().unwrap().len(), 2, "{report}");
    assert!(report[1]["message"].as_str().unwrap().contains("a.obj: no such file"), "{report}");
    assert_eq!((&problem["scene"], &problem["severity"]), (&"scene.ron".into(), &"error".into()));
    assert_eq!(problem["help"], "did you mean `Phong`?");
    let place_of = &problem["place"];
    assert_eq!((&place_of["line"], &place_of["column"]), (&1.into(), &54.into()), "{place_of}");
    assert_eq!(place_of["bytes"], serde_json::json!([54, 58]));

    place.write("fine.ron", BALL);
    assert_eq!(place.run(0, &["check", "--json", "fine.ron"]).json(), serde_json::json!([]));
}

#[test]
fn a_mistake_is_reported_for_every_scene_that_makes_it() {
    let place = Place::with_scene("(entities: { \"ball\": ( Mesh: File(\"a.obj\") ) })");
    let report = place.run(1, &["check", "--json", "scene.ron", "scene.ron"]).json();
    let errors = report.as_array().unwrap().iter().filter(|problem| problem["severity"] == "error").count();
    assert_eq!(errors, 2, "{report}");
}

#[test]
fn info_tells_what_a_scene_holds() {
    let place = Place::with_scene(
        r#"(entities: {
            "ball": ( Mesh: Sphere(subdivisions: 0) ),
            "sheet": ( Mesh: Plane(size: (2.0, 3.0)) ),
            "bone": ( Volume: Raw(path: "bone.raw", size: (2, 1, 2), format: F32, spacing: (0.5, 1.0, 2.0)) ),
        })"#,
    );
    let samples = [-1.5f32, f32::NAN, 7.0, f32::INFINITY];
    place.write("bone.raw", samples.map(f32::to_le_bytes).concat());
    let facts = place.run(0, &["info", "--json", "scene.ron"]).json();
    assert_eq!((&facts["ball"]["triangles"], &facts["ball"]["open edges"]), (&20.into(), &0.into()));
    assert_eq!((&facts["sheet"]["triangles"], &facts["sheet"]["open edges"]), (&2.into(), &4.into()));
    assert_eq!(facts["sheet"]["area"], 6.0);
    let bone = &facts["bone"];
    assert_eq!((&bone["range"], &bone["non-finite"]), (&serde_json::json!([-1.5, 7.0]), &2.into()));
    assert_eq!((&bone["format"], &bone["spacing mm"]), (&"F32".into(), &serde_json::json!([0.5, 1.0, 2.0])));
    let told = place.run(0, &["info", "scene.ron"]);
    told.says("2 of 4 samples are not finite");
    assert!(told.data.contains("triangles: 20"), "{}", told.data);
}

#[test]
fn a_new_scene_is_right_and_nothing_is_overwritten() {
    let place = Place::new();
    place.run(0, &["new", "mine"]).says("scene.ron");
    place.run(0, &["check", "mine/scene.ron"]).says("no problems");
    let before = fs::read(place.path("mine/scene.ron")).unwrap();
    place.run(2, &["new", "mine"]).says("not empty");
    place.run(2, &["new", "--plugin", "mine"]).says("not empty");
    assert_eq!(fs::read(place.path("mine/scene.ron")).unwrap(), before);
    fs::create_dir(place.path("empty")).unwrap();
    place.run(0, &["new", "empty"]);
    place.write("file", "");
    place.run(2, &["new", "file"]).says("file");
}

#[test]
fn a_new_plugin_has_a_name_that_cargo_takes() {
    let place = Place::new();
    let checkout = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    for (folder, name) in [("bob", "bob"), ("my plugin!", "my_plugin_"), ("3d", "plugin_3d"), ("ä", "plugin")]
    {
        place.run(0, &["new", "--plugin", folder, "--tyndall", checkout.to_str().unwrap()]);
        let manifest = fs::read_to_string(place.path(folder).join("Cargo.toml")).unwrap();
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{folder}: {manifest}");
        assert!(place.path(folder).join("src/main.rs").is_file());
    }
    place.run(2, &["new", "other", "--tyndall", "."]).says("--plugin");
    place.run(2, &["new", "--plugin", "other", "--tyndall", "nowhere"]).says("cannot find nowhere");
    // The component of a plugin is not part of the program itself.
    place.run(1, &["check", "bob/scene.ron"]).says("there is no component `Bob`");
}

#[needs(gpu)]
#[test]
fn info_tells_what_the_machine_draws_with() {
    let place = Place::new();
    let facts = place.run(0, &["info", "--json"]).json();
    assert!(facts["adapter"]["name"].as_str().is_some_and(|name| !name.is_empty()), "{facts}");
    assert!(facts["limits"]["picture"].as_u64().is_some_and(|pixels| pixels >= 2048), "{facts}");
    assert!(place.run(0, &["info"]).data.contains("backend: "));
}

#[needs(gpu)]
#[test]
fn a_new_scene_is_drawn() {
    let place = Place::new();
    place.run(0, &["new", "mine"]);
    place.run(0, &["render", "mine/scene.ron", "-o", "new.png", "--size", "64x36"]);
    let picture = image::open(place.path("new.png")).unwrap().into_rgb8();
    assert_eq!(picture.dimensions(), (64, 36));
    let colours: std::collections::HashSet<_> = picture.pixels().map(|pixel| pixel.0).collect();
    assert!(colours.len() > 50, "only {} colours", colours.len());
}

#[needs(gpu)]
#[test]
fn frames_differ_as_the_scene_moves_and_stats_say_what_ran() {
    let place = Place::with_scene(BALL);
    let arguments =
        ["render", "scene.ron", "--size", "48x32", "--frames", "0..2", "-o", "out.png", "--stats", "s.json"];
    place.run(0, &arguments);
    assert_eq!(place.names(), ["out_0000.png", "out_0001.png", "s.json", "scene.ron"]);
    let frame = |name: &str| image::open(place.path(name)).unwrap().into_rgb8();
    assert_ne!(frame("out_0000.png"), frame("out_0001.png"));
    let stats: Value = serde_json::from_slice(&fs::read(place.path("s.json")).unwrap()).unwrap();
    for key in ["adapter", "passes", "pipelines", "gpu_bytes", "timeline_ms", "total_ms"] {
        assert!(!stats[key].is_null(), "`{key}` is missing in {stats}");
    }
    assert_eq!(stats["passes"]["surface"]["runs"], 2, "{stats}");
    assert!(stats["passes"]["raycast"].is_null(), "no volume, no ray casting: {stats}");
}

#[needs(gpu)]
#[test]
fn cameras_and_overrides_change_the_picture() {
    let place = Place::with_scene(BALL);
    let draw = |more: &[&str]| {
        let arguments = [&["render", "scene.ron", "--size", "32x24", "-o", "a.png"], more].concat();
        place.run(0, &arguments);
        image::open(place.path("a.png")).unwrap().into_rgb8()
    };
    let first = draw(&[]);
    assert_eq!(first, draw(&["--camera", "eye"]));
    assert_ne!(first, draw(&["--camera", "from above"]));
    assert_ne!(first, draw(&["--set", "box.Mesh.size=(1.0, 1.0, 1.0)"]));
    assert_ne!(first, draw(&["--set", "box.Phong.diffuse=(0.1, 0.1, 0.9)"]));
    assert_eq!(first, draw(&["--portable"]), "the portable way is the same picture");
}

#[needs(gpu)]
#[test]
fn exr_is_linear_radiance_whatever_the_exposure() {
    let place = Place::with_scene(BALL);
    let draw = |name: &str, exposure: &str| {
        let set = format!("eye.ViewCamera.exposure={exposure}");
        place.run(
            0,
            &[
                "render",
                "scene.ron",
                "--size",
                "32x24",
                "-o",
                name,
                "--set",
                &set,
                "--set",
                "eye.ViewCamera.gamma=1.5",
            ],
        );
        image::open(place.path(name)).unwrap()
    };
    let (dark, bright) = (draw("dark.exr", "0.0").into_rgb32f(), draw("bright.exr", "3.0").into_rgb32f());
    assert_eq!(dark, bright);
    assert_eq!(dark.get_pixel(0, 0).0, [0.25, 0.5, 4.0], "the background, above 1 too");
    let (dark, bright) = (draw("dark.png", "0.0").into_rgb8(), draw("bright.png", "1.0").into_rgb8());
    let encoded = |radiance: f32| (255.0 * radiance.powf(1.0 / 1.5)).round() as u8;
    assert!(dark.get_pixel(0, 0).0[0].abs_diff(encoded(0.25)) <= 1, "{:?}", dark.get_pixel(0, 0));
    assert!(bright.get_pixel(0, 0).0[0].abs_diff(encoded(0.5)) <= 1, "{:?}", bright.get_pixel(0, 0));
    assert_eq!(dark.get_pixel(0, 0).0[2], 255);
}

#[needs(gpu)]
#[test]
fn a_failed_render_leaves_the_old_picture_and_nothing_else() {
    let place = Place::with_scene("(entities: { \"ball\": ( Mesh: File(\"missing.obj\") ) })");
    place.write("out.png", "old");
    place.run(1, &["render", "scene.ron", "--size", "16x16"]).says("missing.obj: no such file");
    place.run(2, &["render", "scene.ron", "--set", "bal.Mesh=Sphere()"]);
    assert_eq!(fs::read_to_string(place.path("out.png")).unwrap(), "old");
    place.write("fine.ron", BALL);
    place.run(2, &["render", "fine.ron", "--size", "4000000x16"]).says("ask for a smaller `--size`");
    assert_eq!(fs::read_to_string(place.path("out.png")).unwrap(), "old");
    fs::create_dir(place.path("folder.png")).unwrap();
    place.run(2, &["render", "fine.ron", "--size", "16x16", "-o", "folder.png"]).says("folder.png");
    place.run(0, &["render", "fine.ron", "--size", "16x16"]);
    assert!(image::open(place.path("out.png")).is_ok());
    assert_eq!(place.names(), ["fine.ron", "folder.png", "out.png", "scene.ron"]);
}

#[needs(gpu)]
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_the_machines_fault_and_a_link_stays_a_link() {
    let place = Place::with_scene(BALL);
    std::os::unix::fs::symlink("/dev/full", place.path("full.png")).unwrap();
    place.run(3, &["render", "scene.ron", "--size", "16x16", "-o", "full.png"]).says("free some space");
    fs::create_dir(place.path("elsewhere")).unwrap();
    place.write("elsewhere/real.png", "old");
    std::os::unix::fs::symlink("elsewhere/real.png", place.path("link.png")).unwrap();
    place.run(0, &["render", "scene.ron", "--size", "16x16", "-o", "link.png"]);
    assert!(place.path("link.png").is_symlink());
    assert!(image::open(place.path("elsewhere/real.png")).is_ok());
}
