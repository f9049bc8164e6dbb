//! What a window tells of the scene that it follows.

use crate::scene::{LiveScene, Problem, SceneEntities, Severity};
use crate::ui::SceneProblems;
use bevy_ecs::prelude::*;
use std::collections::HashSet;

/// The problems of a scene: by the entities whose text or files they are about, and in the order in which they were found.
pub(super) fn problems(scene: &LiveScene, world: &World) -> (SceneProblems, Vec<Problem>) {
    let mut seen = HashSet::new();
    // Passes that find the same thing wrong in every picture say so in every picture.
    let mut all = scene.problems(world);
    all.retain(|problem| seen.insert(told(problem).1));
    let about = |problem: &Problem| {
        let subject = problem.subject.as_ref().map(|(entity, _)| *entity);
        subject.or_else(|| entity_around(scene, world, problem))
    };
    (SceneProblems::new(all.iter().map(|problem| (about(problem), problem.clone()))), all)
}

/// The entity in whose text a problem is.
fn entity_around(scene: &LiveScene, world: &World, problem: &Problem) -> Option<Entity> {
    let place = problem.place.as_ref()?;
    let is_around = |around: &crate::scene::Place| {
        around.file.path() == place.file.path()
            && around.bytes.start <= place.bytes.start
            && place.bytes.end <= around.bytes.end
    };
    let written = scene.document().entities.iter().find(|entity| is_around(&entity.place_of("")))?;
    world.resource::<SceneEntities>().0.get(&written.name).copied()
}

/// A problem as one line of a log.
pub(super) fn told(problem: &Problem) -> (crate::ui::Level, String) {
    let level = match problem.severity {
        Severity::Error => crate::ui::Level::Error,
        Severity::Note => crate::ui::Level::Warning,
    };
    let place = problem.place.as_ref().map_or(String::new(), |place| format!("{place}: "));
    let help = problem.help.as_ref().map_or(String::new(), |help| format!("; {help}"));
    (level, format!("{place}{}{help}", problem.message))
}
