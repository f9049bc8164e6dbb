//! `tyndall check`.

use super::arguments::CheckArguments;
use super::exit::{self, Failure};
use super::open::{Directions, Input};
use super::terminal;
use crate::render;
use crate::scene::{self, Problem, SceneDocument, Severity};
use bevy_app::App;
use bevy_ecs::prelude::*;
use std::path::Path;

pub(super) fn run(app: &mut App, arguments: &CheckArguments) -> Result<(), Failure> {
    let mut fine = true;
    let mut all = Vec::new();
    for scene in &arguments.files {
        let input = Input::of(std::slice::from_ref(scene), &Directions { up: None, front: None })?;
        let problems = check(app, &input);
        fine &= problems.iter().all(|problem| problem.severity != Severity::Error);
        if arguments.json {
            all.extend(problems.iter().map(|problem| describe(scene, problem)));
        } else {
            exit::print(&problems);
            terminal::tell(format_args!("{}: {}", scene.display(), exit::count(&problems)));
        }
    }
    if arguments.json {
        terminal::json(&all.into())?;
    }
    if fine { Ok(()) } else { Err(Failure::Input) }
}

/// Every problem of a scene, those of the files that its components name included.
fn check(app: &mut App, input: &Input) -> Vec<Problem> {
    // An earlier scene may hold an equal component with the same mistake, which would not be read, nor reported, again.
    scene::reconcile(app.world_mut(), &SceneDocument::default());
    let document = input.load(app, &[]);
    render::all_problems(app, &document)
}

fn describe(scene: &Path, problem: &Problem) -> serde_json::Value {
    let place = problem.place.as_ref().map(|place| {
        let (line, column) = place.file.line_column(place.bytes.start);
        serde_json::json!({ "file": place.file.path(), "line": line, "column": column, "bytes": [place.bytes.start, place.bytes.end] })
    });
    serde_json::json!({
        "scene": scene,
        "severity": match problem.severity { Severity::Note => "note", Severity::Error => "error" },
        "message": problem.shown_message(),
        "help": problem.shown_help(),
        "place": place,
    })
}
