//! Scenes that nobody would write, or that someone wrote to do harm: what is said of them is short, plain and soon said.

#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

use bevy_ecs::reflect::AppTypeRegistry;
use miette::{GraphicalReportHandler, GraphicalTheme};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tyndall::prelude::*;
use tyndall::render::{all_problems, load_scene};
use tyndall::scene::{LiveScene, Problem, Reload, Severity};

/// A folder with a scene in it.
struct Place(tempfile::TempDir);

impl Place {
    fn new(scene: impl AsRef<[u8]>) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        place.write("scene.ron", scene);
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    /// What `tyndall check` finds.
    fn check(&self, scene: &str) -> Vec<Problem> {
        let mut app = App::new();
        app.add_plugins(TyndallPlugins);
        let document = load_scene(&mut app, &self.path(scene), &[]);
        all_problems(&mut app, &document)
    }

    /// The only problem of the scene.
    fn problem(&self) -> Problem {
        let mut problems = self.check("scene.ron");
        assert_eq!(problems.len(), 1, "{problems:#?}");
        problems.remove(0)
    }
}

/// A problem as it is printed.
fn printed(problem: &Problem) -> String {
    let theme = GraphicalTheme::unicode_nocolor();
    problem.render(&GraphicalReportHandler::new_themed(theme).with_width(120))
}

/// The lines of a file that a printed problem shows.
fn excerpt(printed: &str) -> Vec<&str> {
    printed
        .lines()
        .filter_map(|line| {
            let (number, text) = line.split_once(" │ ")?;
            number.trim().parse::<usize>().ok().map(|_| text)
        })
        .collect()
}

fn assert_short(printed: &str) {
    let lines = excerpt(printed);
    assert!(lines.len() <= 3, "{} lines: {printed}", lines.len());
    for line in lines {
        assert!(line.chars().count() <= 160, "{} characters: {printed}", line.chars().count());
    }
    assert!(printed.chars().count() < 3000, "{} characters", printed.chars().count());
    assert!(printed.chars().all(|c| c == '\n' || !c.is_control()), "{printed:?}");
}

/// Entities that each have something wrong, by what is written in them.
fn entities(count: usize, components: impl Fn(usize) -> String, between: &str) -> String {
    let mut text = String::from("(entities: {");
    for number in 0..count {
        write!(text, "{between}\"e{number}\": ({}),", components(number)).unwrap();
    }
    text + between + "})"
}

#[test]
fn labels_beyond_the_columns_of_the_printer_are_shown() {
    for (before, what) in
        [(" ".repeat(66_000), "spaces"), ("\t".repeat(20_000), "tabs"), ("/*ä*/".repeat(20_000), "comments")]
    {
        let place = Place::new(format!("(entities: {{{before}\"ball\": ( Mesh: Spere() ) }})"));
        let problem = place.problem();
        let printed = printed(&problem);
        assert_short(&printed);
        assert!(printed.contains("Mesh: Spere()"), "{what}: {printed}");
        let column = before.chars().count() + "(entities: {\"ball\": ( Mesh: ".len() + 1;
        assert!(printed.contains(&format!("scene.ron:1:{column}]")), "{what}: {printed}");
    }
    // A note, of a scene that is right.
    let place = Place::new(format!("(entities: {{{}\"ball\": ( Mesh: Sphere() ) }})", " ".repeat(70_000)));
    assert_eq!(place.problem().severity, Severity::Note);
    assert_short(&printed(&place.problem()));
}

#[test]
fn a_problem_shows_three_lines_at_most() {
    let long = "    // a comment that goes on\n".repeat(500);
    for text in [
        format!("(\n{long}    entities: [\n{long}],\n)"),
        format!("(entities: {{ \"ball\": ( Mesh: Box(size: [\n{long}1.0]) ) }})"),
        format!("(entities: {{ \"ball\": (),\n{long} \"ball\": () }})"),
        "(entities: { \"ball\": (),\n\n\"ball\": () })".to_string(),
        format!("(entities: {{ \"ball\": (\n{long}"),
        format!("(entities: {{ \"ball\": ( Phong: \"{long}"),
        "(\r\n\tentities: {\r\n\t\t\"ball\": ( Fong: () ),\r\n\t},\r\n)\r\n".into(),
    ] {
        for problem in Place::new(&text).check("scene.ron") {
            assert_short(&printed(&problem));
            assert!(!excerpt(&printed(&problem)).is_empty(), "{}", printed(&problem));
        }
    }
}

#[test]
fn nothing_that_a_terminal_would_obey_is_printed() {
    let evil = "\u{1b}[2J\u{1b}]0;owned\u{7}\u{9b}31m\u{202e}\u{7f}\r";
    let name = format!("{evil}{}", "n".repeat(5000));
    let place = Place::new(format!(
        "(entities: {{ // {evil}\n\"{name}\": ( Mesh: File(\"{evil}.obj\"), Fong: () ), \"{name}\": (),\n\
         \"cam\": ( ScatteringCamera: (target: \"{name}\") ), \"t\": ( Phong: File(\"{evil}\") ) }})"
    ));
    let problems = place.check("scene.ron");
    assert!(problems.len() >= 4, "{problems:#?}");
    for problem in &problems {
        assert_short(&printed(problem));
        assert!(problem.to_string().chars().all(|c| !c.is_control() && c != '\u{202e}'), "{problem}");
    }
    let all: String = problems.iter().map(printed).collect();
    assert!(all.contains("␛[2J"), "what is left out can be seen: {all}");
}

/// Seconds that this thread has computed, or that have passed where that is not told.
fn seconds() -> f64 {
    static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    let times = fs::read_to_string("/proc/thread-self/schedstat").ok();
    let computed = times.and_then(|times| times.split(' ').next()?.parse::<f64>().ok());
    computed.map_or_else(|| START.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

/// How long it may take to find and tell what is wrong; the limit for a release build is a second.
const SOON: f64 = if cfg!(debug_assertions) { 3.0 } else { 1.0 };

#[test]
fn many_mistakes_are_soon_found() {
    let target = |n: usize| format!("ScatteringCamera: (target: \"f{n}\")");
    let many = 10_000;
    let mut texts = vec![
        ("unknown components", entities(many, |n| format!("Unknown{n}: ()"), "\n"), many),
        ("unknown components on one line", entities(many, |n| format!("Unknown{n}: ()"), " "), many),
        ("names of nobody", entities(many, target, "\n"), many),
        (
            "the same name",
            entities(many, |_| "Phong: ()".into(), "\n").replace("\"e", "\"e\": (), // "),
            many - 1,
        ),
        ("a broken file", entities(many, |_| "Phong: File(\"broken.ron\")".into(), "\n"), 1),
        ("missing files", entities(many, |_| "Phong: File(\"none.ron\")".into(), "\n"), 1),
    ];
    let mut fields = String::from("(");
    (0..many).for_each(|n| writeln!(fields, "field{n}: {n},").unwrap());
    texts.push(("fields of the head", fields + ")", many));
    let points =
        (0..many).map(|n| format!("({}, (1.0, 1.0, 1.0), 9.0)", many - n)).collect::<Vec<_>>().join(",");
    texts.push((
        "points",
        format!("(entities: {{\"a\": ( TransferFunction: (points: [{points}]) )}})"),
        many,
    ));
    for (what, text, least) in texts {
        let place = Place::new(text);
        place.write("broken.ron", "(\n".repeat(100));
        let started = seconds();
        let problems = place.check("scene.ron");
        let lines: usize = problems
            .iter()
            .map(|problem| problem.place.as_ref().map_or(0, |place| place.to_string().len()))
            .sum();
        let took = seconds() - started;
        assert!(problems.len() >= least && lines > 0, "{what}: {} problems", problems.len());
        assert!(took < SOON, "{what}: {took} s");
    }
}

#[test]
fn what_is_larger_than_any_scene_is_refused() {
    let place = Place::new(format!(
        "(entities: {{\"a\": ( TransferFunction: (points: [{}]) )}})",
        "0,".repeat(1_500_000)
    ));
    let problem = place.problem();
    assert!(problem.message.contains("at most 1000000"), "{problem}");
    let endless = fs::File::create(place.path("scene.ron")).unwrap();
    endless.set_len(1 << 40).unwrap();
    let problem = place.problem();
    assert!(problem.message.contains("more than 67108864 bytes"), "{problem}");
}

#[test]
#[cfg(unix)]
fn what_is_no_file_is_named_and_not_waited_for() {
    let place = Place::new("");
    let pipe = place.path("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::os::unix::fs::symlink("pipe", place.path("link")).unwrap();
    for (scene, found) in [
        ("(include: [\"pipe\"], entities: {})", "a pipe"),
        ("(include: [\"link\"], entities: {})", "a pipe"),
        ("(include: [\"/dev/zero\"], entities: {})", "a device"),
        ("(include: [\".\"], entities: {})", "a folder"),
        ("(entities: {\"a\": (Phong: File(\"pipe\"))})", "a pipe"),
        ("(entities: {\"a\": (Phong: File(\"/dev/zero\"))})", "a device"),
        ("(entities: {\"a\": (Mesh: File(\"pipe.obj\"))})", "a pipe"),
        ("(entities: {\"a\": (Volume: File(\"pipe.nrrd\"))})", "a pipe"),
    ] {
        for name in ["pipe.obj", "pipe.nrrd"] {
            let _ = std::os::unix::fs::symlink("pipe", place.path(name));
        }
        place.write("scene.ron", scene);
        let problems = place.check("scene.ron");
        let expected = format!("expected a file, found {found}");
        assert!(problems.iter().any(|problem| problem.message.contains(&expected)), "{scene}: {problems:#?}");
    }
    let problems = place.check("pipe");
    assert!(problems[0].message.contains("expected a file, found a pipe"), "{problems:#?}");
}

/// Polls until the files have been read again.
fn reloaded(scene: &mut LiveScene, app: &mut App) -> Reload {
    let started = Instant::now();
    loop {
        match scene.poll(app) {
            Reload::Nothing if started.elapsed() < Duration::from_secs(20) => {
                std::thread::sleep(Duration::from_millis(10));
            }
            other => return other,
        }
    }
}

#[test]
#[cfg(unix)]
fn a_scene_that_is_followed_waits_for_no_pipe() {
    let place = Place::new("(include: [\"part.ron\"], entities: {})");
    place.write("part.ron", "(entities: {\"ball\": (Mesh: Sphere())})");
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let mut scene = LiveScene::open(&mut app, &place.path("scene.ron"), &[]);
    assert!(!scene.is_refused());
    let pipe = place.path("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    fs::rename(&pipe, place.path("part.ron")).unwrap();
    assert!(matches!(reloaded(&mut scene, &mut app), Reload::Refused { problems: 1.. }));
    let problems = scene.problems(app.world());
    assert!(problems[0].message.contains("found a pipe"), "{problems:#?}");
    fs::remove_file(place.path("part.ron")).unwrap();
    place.write("part.ron", "(entities: {\"cube\": (Mesh: Box())})");
    assert!(matches!(reloaded(&mut scene, &mut app), Reload::Reloaded { .. }));
}

/// Writes files that include each other in a row.
fn write_chain(place: &Place, links: usize) {
    for link in 0..links {
        place.write(&format!("c{link}.ron"), format!("(include: [\"c{}.ron\"], entities: {{}})", link + 1));
    }
    place.write(&format!("c{links}.ron"), "(entities: {\"ball\": (Mesh: Sphere())})");
}

#[test]
fn includes_within_includes_have_an_end() {
    let place = Place::new("(include: [\"c0.ron\"], entities: {})");
    write_chain(&place, 3000);
    let problems = place.check("scene.ron");
    let deep = problems.iter().find(|problem| problem.message.contains("more than 64 deep"));
    let deep = deep.unwrap_or_else(|| panic!("{problems:#?}"));
    assert!(deep.message.contains("`scene.ron` > `c0.ron` > … > `c63.ron` > `c64.ron`"), "{deep}");
    assert!(deep.to_string().contains("c63.ron:1:12: "), "{deep}");
    // As many as there may be.
    write_chain(&place, 63);
    assert_eq!(
        place.check("scene.ron").iter().filter(|problem| problem.severity == Severity::Error).count(),
        0
    );
    // While it is followed.
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let mut scene = LiveScene::open(&mut app, &place.path("scene.ron"), &[]);
    assert!(!scene.is_refused());
    place.write("c63.ron", "(include: [\"c64.ron\"], entities: {})");
    write_chain(&place, 3000);
    loop {
        match reloaded(&mut scene, &mut app) {
            // Not all had been written.
            Reload::Reloaded { .. } => {}
            Reload::Refused { .. } => break,
            Reload::Nothing => panic!("nothing was noticed"),
        }
    }
}

#[test]
fn byte_order_marks_are_passed_over() {
    let place = Place::new(
        "\u{feff}(include: [\"part.ron\"], entities: {\"ball\": (Mesh: Sphere(), Phong: File(\"phong.ron\")), \"eye\": (Fong: ())})",
    );
    place.write("part.ron", "\u{feff}(entities: {\"sun\": (DirectionalLight: ())})");
    place.write("phong.ron", "\u{feff}(shininess: 3.0)");
    let problem = place.problem();
    let text = fs::read_to_string(place.path("scene.ron")).unwrap();
    // The mark has three bytes, and no column.
    let column = text.find("Fong").unwrap() - 3 + 1;
    let place_of = format!("scene.ron:1:{column}: there is no component `Fong`");
    assert!(problem.to_string().contains(&place_of), "{problem}");
    assert_eq!(&text[problem.place.as_ref().unwrap().bytes.clone()], "Fong");
    let printed = printed(&problem);
    assert!(excerpt(&printed)[0].starts_with("(include"), "{printed}");
    // Saved again, it is there again.
    place.write("scene.ron", "\u{feff}(entities: {\"ball\": (Mesh: Sphere(radius: 2.0))})");
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let world = app.world_mut();
    let mut edits = tyndall::scene::Edits::open(world, &place.path("scene.ron"), &[]).unwrap();
    edits.set(world, "ball", "Mesh.radius", &3.0_f32).unwrap();
    edits.save(world).unwrap();
    let saved = fs::read_to_string(place.path("scene.ron")).unwrap();
    assert_eq!(saved, "\u{feff}(entities: {\"ball\": (Mesh: Sphere(radius: 3.0))})");
}

#[test]
fn text_in_other_encodings_is_told_how_to_convert() {
    let scene = "(entities: {\"ball\": (Mesh: Sphere())})\r\n";
    let wide = |mark: &[u8], order: fn(u16) -> [u8; 2]| {
        [mark.to_vec(), scene.encode_utf16().flat_map(order).collect()].concat()
    };
    for (bytes, name) in [
        (wide(&[0xff, 0xfe], u16::to_le_bytes), "UTF-16LE"),
        (wide(&[0xfe, 0xff], u16::to_be_bytes), "UTF-16BE"),
        (wide(&[], u16::to_le_bytes), "UTF-16LE"),
        (wide(&[], u16::to_be_bytes), "UTF-16BE"),
    ] {
        let problem = Place::new(bytes).problem();
        assert!(problem.message.contains(&format!("is {name} text")), "{problem}");
        assert!(
            problem.help.as_ref().unwrap().contains(&format!("iconv -f {name} -t UTF-8 scene.ron")),
            "{problem:?}"
        );
        assert_eq!(excerpt(&printed(&problem)).len(), 0);
    }
    let problem = Place::new(b"(\n  entities: {\"caf\xe9\": (Mesh: Sphere())})").problem();
    assert!(
        problem.to_string().contains("scene.ron:2:18: ") && problem.message.ends_with("is not UTF-8 text"),
        "{problem}"
    );
    assert!(problem.help.as_ref().unwrap().contains("iconv"), "{problem:?}");
    assert_eq!(excerpt(&printed(&problem)).len(), 0);
}

#[test]
fn what_is_no_scene_is_told_in_two_lines() {
    let obj = format!("# a mesh\n{}f 1 2 3\n", "v 0.0 1.0 2.0\n".repeat(2000));
    let nifti = [vec![0; 344], b"n+1\0".to_vec(), vec![0; 100]].concat();
    for (name, bytes, what) in [
        ("good.obj", obj.into_bytes(), "a mesh (OBJ)"),
        ("head.nii", nifti, "a volume (NIfTI)"),
        ("head.nrrd", [b"NRRD0004\ntype: uchar\n\n".to_vec(), vec![200; 1000]].concat(), "a volume (NRRD)"),
        ("a.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\x1b[31m".to_vec(), "a PNG picture"),
        ("a.zip", b"PK\x03\x04\x14\0\0\0".to_vec(), "a zip archive"),
        ("tyndall", b"\x7fELF\x02\x01\x01\0\0\0".to_vec(), "a program or library (ELF)"),
        ("notes.txt", b"Dear diary,\ntoday I learnt about light.\n".to_vec(), "text"),
        ("noise", vec![0, 1, 2, 3, 0, 5], "binary data"),
    ] {
        let place = Place::new("");
        place.write(name, bytes);
        let problems = place.check(name);
        assert_eq!(problems.len(), 1, "{problems:#?}");
        let expected = format!("{} is {what}, not a scene", place.path(name).display());
        assert_eq!(problems[0].message, expected);
        assert!(problems[0].help.as_ref().unwrap().contains("scene"), "{:?}", problems[0].help);
        let short = Problem {
            message: problems[0].message.replace(&place.0.path().display().to_string(), "."),
            ..problems[0].clone()
        };
        assert_eq!(printed(&short).trim().lines().count(), 2, "{}", printed(&short));
        // Named by a scene, the place is where that is done.
        place.write("scene.ron", format!("(include: [\"{name}\"], entities: {{}})"));
        let problem = place.problem();
        assert!(problem.message == expected && problem.place.is_some(), "{problem:?}");
        assert!(excerpt(&printed(&problem)).iter().all(|line| line.starts_with("(include")), "{problem}");
    }
}

#[test]
fn files_elsewhere_do_not_show_their_text() {
    let place = Place::new("");
    let secret = "s3cret";
    for (number, text) in [
        format!("{secret}:x:0:0:{secret}\n{secret}"),
        format!("(entities: {{\"{secret}\": (Mesh: {secret}())}})"),
        format!("(entities: {{\"a\": ({secret}: ())}})"),
        format!("(entities: {{{secret}: ()}})"),
        format!("({secret}: 3, entities: {{}})"),
        format!("(entities: {{\"{secret}\": (), \"{secret}\": ()}})"),
        format!("(shininess: {secret})"),
        format!("(shininess: \"{secret}\")"),
        format!("({secret}: 1.0)"),
        format!("(shininess: 1.0, shininess: {secret})"),
        format!("(shininess: 1.0 {secret})"),
        format!("{secret} = \"{secret}\"\n"),
        format!("[{secret}\n{secret}"),
        format!("\u{e9}{secret}"),
    ]
    .into_iter()
    .enumerate()
    {
        let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
        place.write("elsewhere/file", latin);
        for (scene, at) in [
            ("(include: [\"../elsewhere/file\"], entities: {})", "include"),
            ("(entities: {\"it\": (Phong: File(\"../elsewhere/file\"))})", "component"),
            ("(entities: {\"it\": (Subsurface: File(\"../elsewhere/file\"))})", "component"),
            ("(entities: {\"it\": (Phong: File(\"link\"))})", "link"),
        ] {
            place.write("home/scene.ron", scene);
            #[cfg(unix)]
            let _ = std::os::unix::fs::symlink("../elsewhere/file", place.path("home/link"));
            for problem in place.check("home/scene.ron") {
                let said = format!("{}{problem}{:?}{}", printed(&problem), problem.help, problem.label);
                assert!(!said.contains(secret), "{number} {at}: {said}");
                let is_placed = said.contains("file:1:")
                    || said.contains("file:2:")
                    || said.contains("link:")
                    || said.contains("scene.ron:1:");
                assert!(is_placed || problem.severity == Severity::Note, "{number} {at}: {said}");
            }
        }
        // Below the folder of the scene it is seen.
        place.write("own/parts/file", &text);
        place.write("own/scene.ron", "(entities: {\"it\": (Phong: File(\"parts/file\"))})");
        let all: String = place.check("own/scene.ron").iter().map(printed).collect();
        let is_text = text.starts_with('(') || text.starts_with('[');
        assert!(!is_text || all.contains(secret), "{number}: {all}");
    }
}

#[test]
fn a_broken_file_that_entities_share_is_told_of_after_the_first_of_them_is_gone() {
    let both = "(entities: {\"a\": (Phong: File(\"broken.ron\")), \"b\": (Phong: File(\"broken.ron\"))})";
    let place = Place::new(both);
    place.write("broken.ron", "(shininess: many)");
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let scene = place.path("scene.ron");
    let first = tyndall::scene::SceneDocument::load(&scene, &registry, &[]);
    assert_eq!(first.problems.len(), 1, "{:#?}", first.problems);
    place.write("scene.ron", both.replace("\"a\": (Phong: File(\"broken.ron\")), ", ""));
    let second = tyndall::scene::SceneDocument::load_after(&scene, &registry, &[], Some(&first));
    assert!(second.has_errors(), "{:#?}", second.problems);
}

#[test]
fn a_file_that_is_missing_names_the_folder_it_was_looked_for_in() {
    let here = std::env::current_dir().unwrap();
    // Relative, as one types it.
    let relative = tempfile::tempdir_in(&here).unwrap();
    let folder = Path::new(relative.path().file_name().unwrap());
    let scene = "(include: [\"no.ron\"], entities: {\"a\": (Phong: File(\"nope.ron\"), Mesh: File(\"not.obj\")), \
                 \"b\": (Volume: File(\"none.nrrd\")), \"c\": (Mesh: File(\"deep/er/none.obj\"))})";
    fs::write(relative.path().join("scene.ron"), scene).unwrap();
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let document = load_scene(&mut app, &folder.join("scene.ron"), &[]);
    let all: Vec<String> =
        all_problems(&mut app, &document).iter().map(|problem| problem.message.clone()).collect();
    for name in ["no.ron", "nope.ron", "not.obj", "none.nrrd"] {
        let place = format!("{}", here.join(folder).display());
        let told =
            all.iter().any(|message| message.contains(name) && message.contains(&format!(" in {place}")));
        assert!(told, "{name}: {all:#?}");
    }
    let missing = format!("there is no folder {}", here.join(folder).join("deep").display());
    assert!(all.iter().any(|message| message.contains(&missing)), "{all:#?}");
    let document = load_scene(&mut app, &folder.join("scenes.ron"), &[]);
    assert!(document.problems[0].message.contains(&format!(" in {}", here.join(folder).display())));
    assert!(document.problems[0].help.as_ref().unwrap().contains("scene.ron"));
}
