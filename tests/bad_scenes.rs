//! Every scene in `bad_scenes/` has something wrong with it; what a person is told about it is kept in `snapshots/`.

use miette::{GraphicalReportHandler, GraphicalTheme};
use std::path::Path;
use tyndall::prelude::*;
use tyndall::render::{all_problems, load_scene};
use tyndall::scene::{Problem, Severity};

/// What is worth a note, but no error.
const ONLY_NOTES: [&str; 4] =
    ["include_of_itself", "no_light", "nothing_to_see", "scattering_without_effect"];

/// Reads a scene the way `tyndall check` does.
fn check(scene: &Path) -> Vec<Problem> {
    let mut app = App::new();
    app.add_plugins(TyndallPlugins).add_plugins(tyndall_turntable::TurntablePlugin);
    let document = load_scene(&mut app, scene, &[]);
    all_problems(&mut app, &document)
}

/// The same problem where the folder of this machine has a shorter name.
fn elsewhere(problem: &Problem, here: &str) -> Problem {
    let mut problem = problem.clone();
    problem.message = problem.message.replace(here, "/bad_scenes");
    problem.help = problem.help.map(|help| help.replace(here, "/bad_scenes"));
    problem
}

#[test]
fn every_mistake_is_reported_at_its_place() {
    // Paths in messages start here, so that they are the same on every machine. It is the only test of this program.
    std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bad_scenes")).unwrap();
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(120);
    let here = std::env::current_dir().unwrap().display().to_string();
    let scenes = std::fs::read_dir(".").unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<_> =
        scenes.filter(|path| path.extension().is_some_and(|ending| ending == "ron")).collect();
    scenes.sort();
    assert!(scenes.len() >= 30, "found {} scenes", scenes.len());
    for scene in scenes {
        let scene = scene.file_name().map(Path::new).unwrap();
        let name = scene.file_stem().unwrap().to_string_lossy().into_owned();
        let found = check(scene);
        let worst = found.iter().map(|problem| problem.severity).max();
        let expected = if ONLY_NOTES.contains(&name.as_str()) { Severity::Note } else { Severity::Error };
        assert_eq!(worst, Some(expected), "{name}");
        for problem in &found {
            let report = problem.to_string();
            assert!(problem.place.is_some(), "{name} has no place: {report}");
            for leak in ["ron::", "glam", "alloc::", "Option<", "bevy", "os error", "serde"] {
                assert!(!report.contains(leak), "{name} speaks of {leak}: {report}");
            }
        }
        let reports: Vec<_> = found
            .iter()
            .map(|problem| elsewhere(problem, &here).render(&handler).replace('\\', "/"))
            .collect();
        insta::assert_snapshot!(name, reports.join("\n"));
    }
}
