//! The problems of the scene, by the entities that have them.

use super::log::{Level, colour};
use crate::scene::{MOST_TOLD, Problem, Severity, more};
use bevy_ecs::prelude::*;
use egui::Ui;
use std::collections::HashMap;

/// The problems of the scene, with their places, each with the entity that it concerns.
#[derive(Resource, Debug, Default)]
pub struct SceneProblems {
    of: HashMap<Entity, Vec<Problem>>,
    others: Vec<Problem>,
}

impl SceneProblems {
    /// Puts problems in the order of the entities that they concern.
    pub fn new(problems: impl IntoIterator<Item = (Option<Entity>, Problem)>) -> Self {
        let mut sorted = Self::default();
        for (entity, problem) in problems {
            match entity {
                Some(entity) => sorted.of.entry(entity).or_default().push(problem),
                None => sorted.others.push(problem),
            }
        }
        sorted
    }

    /// Those of an entity, or of none.
    pub fn of(&self, entity: Option<Entity>) -> &[Problem] {
        match entity {
            Some(entity) => self.of.get(&entity).map_or(&[], Vec::as_slice),
            None => &self.others,
        }
    }

    /// How much the worst of them matters.
    pub(super) fn level(&self, entity: Option<Entity>) -> Option<Level> {
        let problems = self.of(entity);
        let is_error = problems.iter().any(|problem| problem.severity == Severity::Error);
        (!problems.is_empty()).then_some(if is_error { Level::Error } else { Level::Warning })
    }

    /// How many there are, notes included.
    pub fn len(&self) -> usize {
        self.others.len() + self.of.values().map(Vec::len).sum::<usize>()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Problems, each with its place and what to do about it.
pub(super) fn list(ui: &mut Ui, problems: &[Problem]) {
    for problem in problems.iter().take(MOST_TOLD) {
        let level = match problem.severity {
            Severity::Error => Level::Error,
            Severity::Note => Level::Warning,
        };
        ui.colored_label(colour(ui, level), problem.shown_message());
        if let Some(place) = &problem.place {
            ui.weak(place.to_string());
        }
        if let Some(help) = problem.shown_help() {
            ui.label(help);
        }
        ui.add_space(4.0);
    }
    if let Some(more) = more(problems.len()) {
        ui.label(more);
    }
}
