//! The scene's files, and the world as they say.

use crate::render;
use crate::scene::{Override, Problem, Problems, SceneDocument, SceneEntities, Severity};
use crate::ui::SceneProblems;
use bevy_app::App;
use bevy_ecs::prelude::*;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// A scene that is read again when its files change.
pub(super) struct Files {
    path: PathBuf,
    overrides: Vec<Override>,
    pub document: SceneDocument,
    seen: Vec<Option<(SystemTime, u64)>>,
}

/// How often files are looked at. Until they are watched, that is what wakes the window.
pub(super) const INTERVAL: Duration = Duration::from_millis(150);

impl Files {
    /// Takes over a scene that has been read.
    pub fn new(path: PathBuf, overrides: Vec<Override>, document: SceneDocument) -> Self {
        let mut files = Self { path, overrides, document, seen: Vec::new() };
        files.seen = files.look();
        files
    }

    /// Reads the scene again if any of its files has changed, and says whether it did. Where there are errors the world stays as it was.
    pub fn poll(&mut self, app: &mut App) -> bool {
        let now = self.look();
        if now == self.seen {
            return false;
        }
        self.document = render::load_scene(app, &self.path, &self.overrides);
        self.seen = self.look();
        true
    }

    /// When each file was written, and how long it is.
    fn look(&self) -> Vec<Option<(SystemTime, u64)>> {
        let written = |path: &PathBuf| {
            let metadata = std::fs::metadata(path).ok()?;
            Some((metadata.modified().ok()?, metadata.len()))
        };
        std::iter::once(&self.path).chain(&self.document.files).map(written).collect()
    }

    /// The scene itself.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The problems found so far: by the entities whose text or files they are about, and in the order in which they were found.
    pub fn problems(&self, world: &World) -> (SceneProblems, Vec<Problem>) {
        let placed = render::problems(world, &self.document);
        let found = &world.resource::<Problems>().0;
        let sorted = SceneProblems::new(found.iter().zip(&placed).map(|(problem, placed)| {
            let subject = problem.subject.as_ref().map(|(entity, _)| *entity);
            (subject.or_else(|| self.entity_around(world, problem)), placed.clone())
        }));
        (sorted, placed)
    }

    /// The entity in whose text a problem is.
    fn entity_around(&self, world: &World, problem: &Problem) -> Option<Entity> {
        let place = problem.place.as_ref()?;
        let is_around = |around: &crate::scene::Place| {
            around.file.path() == place.file.path()
                && around.bytes.start <= place.bytes.start
                && place.bytes.end <= around.bytes.end
        };
        let written = self.document.entities.iter().find(|entity| is_around(&entity.place_of("")))?;
        world.resource::<SceneEntities>().0.get(&written.name).copied()
    }
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
