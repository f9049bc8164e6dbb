//! What a window tells of the scene that it follows.

use crate::scene::{Entities, LiveScene, Problem, SceneEntities, Severity};
use crate::ui::SceneProblems;
use bevy_ecs::prelude::*;
use std::collections::HashSet;

/// The problems of a scene: by the entities whose text or files they are about, and in the order in which they were found.
pub(super) fn problems(scene: &LiveScene, world: &World) -> (SceneProblems, Vec<Problem>) {
    let mut seen = HashSet::new();
    // Passes that find the same thing wrong in every picture say so in every picture.
    let mut all = scene.problems(world);
    all.retain(|problem| seen.insert(told(problem).1));
    let written = Entities::of(scene.document());
    let names = &world.resource::<SceneEntities>().0;
    let about = |problem: &Problem| {
        let subject = problem.subject.as_ref().map(|(entity, _)| *entity);
        let around = || names.get(&written.around(problem.place.as_ref()?)?.name).copied();
        subject.or_else(around)
    };
    (SceneProblems::new(all.iter().map(|problem| (about(problem), problem.clone()))), all)
}

/// A problem as one line of a log.
pub(super) fn told(problem: &Problem) -> (crate::ui::Level, String) {
    let level = match problem.severity {
        Severity::Error => crate::ui::Level::Error,
        Severity::Note => crate::ui::Level::Warning,
    };
    let place = problem.place.as_ref().map_or(String::new(), |place| format!("{place}: "));
    let help = problem.shown_help().map_or(String::new(), |help| format!("; {help}"));
    (level, format!("{place}{}{help}", problem.shown_message()))
}
