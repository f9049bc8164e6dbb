//! The tour of the README, from an empty folder with nothing but the program.

#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tyndall_needs::needs;

/// A step of the tour.
#[derive(Debug, PartialEq)]
enum Step {
    /// A scene, or an entity to take the place of the one of its name.
    Scene(String),
    /// A line that is typed.
    Line(String),
}

/// The blocks of the README between two headings, in order.
fn steps(readme: &str, from: &str, to: &str) -> Vec<Step> {
    let tour = readme.split(from).nth(1).unwrap().split(to).next().unwrap();
    let mut steps = Vec::new();
    for block in tour.split("\n```").skip(1).step_by(2) {
        let (language, text) = block.split_once('\n').unwrap();
        match language {
            "ron" => steps.push(Step::Scene(text.to_owned())),
            "sh" => steps.extend(text.lines().map(|line| Step::Line(line.to_owned()))),
            _ => {}
        }
    }
    steps
}

/// Words as a shell sees them, up to a comment.
fn words(line: &str) -> Vec<String> {
    let line = line.split(" #").next().unwrap();
    let mut words = Vec::new();
    for (index, part) in line.split('\'').enumerate() {
        match index % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_owned)),
            _ => words.push(part.to_owned()),
        }
    }
    words
}

/// Puts the entity that a fragment writes in the place of the one of its name.
fn with_entity(scene: &str, fragment: &str) -> String {
    let name = fragment.trim_start().split(": (").next().unwrap();
    let start = scene.find(&format!("        {name}: (")).unwrap_or_else(|| panic!("no {name} in {scene}"));
    let end = start + scene[start..].find("\n        ),\n").unwrap() + "\n        ),\n".len();
    format!("{}{fragment}\n{}", &scene[..start], &scene[end..])
}

struct Tourist {
    /// Where the tourist stands.
    folder: PathBuf,
    scene: String,
    drawn: Vec<PathBuf>,
}

impl Tourist {
    fn write(&mut self, text: &str) {
        self.scene = match text.trim_start().starts_with('"') {
            true => with_entity(&self.scene, text),
            false => text.to_owned(),
        };
        fs::write(self.folder.join("first.ron"), &self.scene).unwrap();
        self.tyndall(&["check", "first.ron"]);
    }

    /// What is typed, but for windows, and with pictures that are small.
    fn type_in(&mut self, line: &str) {
        for command in line.split("&&") {
            let words = words(command);
            let mut words: Vec<&str> = words.iter().map(String::as_str).collect();
            match words.first().copied() {
                Some("cd") => self.folder.push(words[1]),
                Some("tyndall") => {
                    words.remove(0);
                    match words[0] {
                        "view" => words[0] = "check",
                        "render" if words.contains(&"--size") => {}
                        "render" => words.extend(["--size", "64x36"]),
                        _ => {}
                    }
                    self.tyndall(&words);
                    let output = words.iter().position(|word| *word == "-o");
                    let pictures =
                        output.map(|output| words[output + 1]).filter(|name| name.ends_with(".png"));
                    self.drawn.extend(pictures.map(|name| self.folder.join(name)));
                }
                // Of the checkout.
                Some("cargo") => {}
                other => panic!("{other:?} is no command of the tour: {line}"),
            }
        }
    }

    fn tyndall(&self, arguments: &[&str]) -> Output {
        let output = Command::new(env!("CARGO_BIN_EXE_tyndall"))
            .current_dir(&self.folder)
            .args(arguments)
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "tyndall {arguments:?}: {told}");
        output
    }
}

#[needs(gpu)]
#[test]
fn the_tour_works_from_an_empty_folder() {
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../README.md")).unwrap();
    let steps = steps(&readme, "## Five minutes", "## As a library");
    let scenes = steps.iter().filter(|step| matches!(step, Step::Scene(_))).count();
    assert!(scenes >= 3 && steps.len() >= 8, "{steps:#?}");
    let empty = tempfile::tempdir().unwrap();
    let mut tourist = Tourist { folder: empty.path().into(), scene: String::new(), drawn: Vec::new() };
    for step in &steps {
        match step {
            Step::Scene(text) => tourist.write(text),
            Step::Line(line) => tourist.type_in(line),
        }
    }
    assert!(tourist.drawn.len() >= 3, "{:?}", tourist.drawn);
    for path in &tourist.drawn {
        let folder = path.parent().unwrap();
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        let written = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let is_it = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with(&stem) && name.ends_with(".png")
        };
        let pictures: Vec<PathBuf> = written.filter(is_it).collect();
        assert!(!pictures.is_empty(), "{} is not there", path.display());
        for picture in pictures {
            let picture = image::open(&picture).unwrap().into_rgb8();
            let first = picture.get_pixel(0, 0);
            assert!(picture.pixels().any(|pixel| pixel != first), "nothing is in {}", path.display());
        }
    }
    // What else the tour points at.
    for scene in fs::read_dir(tourist.folder.join("scenes")).unwrap().map(|entry| entry.unwrap().path()) {
        if scene.extension().is_some_and(|ending| ending == "ron") {
            tourist.tyndall(&["check", scene.to_str().unwrap()]);
        }
    }
    // The mistakes that it makes.
    let wrong = tourist.scene.replace("ambient", "ambiant");
    assert_ne!(wrong, tourist.scene);
    fs::write(tourist.folder.join("first.ron"), wrong).unwrap();
}

#[test]
fn words_and_entities_are_found() {
    assert_eq!(
        words("tyndall render a.ron --set 'a b=(1, 2)'  # x"),
        ["tyndall", "render", "a.ron", "--set", "a b=(1, 2)"]
    );
    let scene = "(\n    entities: {\n        \"a\": (\n            X: 1,\n        ),\n        \"b\": ( Y: 1 ),\n    },\n)\n";
    let with = with_entity(scene, "        \"a\": (\n            Z: 2,\n        ),");
    assert_eq!(with, scene.replace("X: 1", "Z: 2"));
}
