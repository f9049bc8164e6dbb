//! Edits of a scene that is shown, and their way back into its files.
//!
//! ```text
//!  files ──▶ base ──┐                      ┌──▶ world
//!                   ├──▶ texts ──▶ document┤
//!  edits ──▶ draft ─┘   (in memory)        └──▶ files, when saved
//! ```
//!
//! The draft holds what was changed, as values. From it and the texts of the files follow the texts that would be saved, and the scene is
//! read from those: what is shown is what reading the saved files would give, an edit is refused for whatever a file with it would be
//! refused for, and what the draft does not mention keeps its text, byte for byte.

mod change;
mod conflict;
mod draft;
mod error;
mod history;
mod marks;
mod merge;
mod operations;
mod rebase;
mod resolve;
mod save;
mod shared;
mod texts;

pub use conflict::{Conflict, Side, Version};
pub use error::{EditError, SaveError};

use super::document::{Override, SceneDocument};
use super::problem::{Problem, SourceFile};
use super::reconcile::{SceneEntities, reconcile, reconcile_after};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::AppTypeRegistry;
use bevy_reflect::TypeRegistry;
use change::{Change, Direction, Scene};
use draft::Draft;
use history::History;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene as its files say it, and what a person has changed of it since.
///
/// Each edit changes the world at once, by [`reconcile`]: only what differs is touched. None is written to a file before
/// [`save`](Self::save). An edit that cannot be made leaves all as it is.
///
/// ```
/// use tyndall::prelude::*;
/// use tyndall::scene::Edits;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("scene.ron");
/// std::fs::write(&path, "(entities: {\n    \"ball\": ( Mesh: Sphere(radius: 2.0) ), // round\n})")?;
/// let mut app = App::new();
/// app.add_plugins(TyndallPlugins);
/// let world = app.world_mut();
/// let mut edits = Edits::open(world, &path, &[]).map_err(|problems| problems[0].clone())?;
/// edits.set(world, "ball", "Mesh.radius", &3.5_f32)?;
/// assert!(edits.is_unsaved());
/// edits.save(world)?;
/// let text = std::fs::read_to_string(&path)?;
/// assert_eq!(text, "(entities: {\n    \"ball\": ( Mesh: Sphere(radius: 3.5) ), // round\n})");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Resource)]
pub struct Edits {
    path: PathBuf,
    /// The text of a scene that is in no file yet.
    unsaved: Option<String>,
    /// The files as they were last read.
    base: Arc<SceneDocument>,
    /// The same with the draft in it: what is shown.
    document: Arc<SceneDocument>,
    draft: Draft,
    history: History,
    conflicts: Vec<Conflict>,
    /// How many conflicts there have been.
    conflicts_ever: u64,
}

fn registry_of(world: &mut World) -> AppTypeRegistry {
    world.get_resource_or_init::<AppTypeRegistry>().clone()
}

impl Edits {
    /// Reads the scene at `path` and shows it in the world. What `overrides` change of it are edits, not saved yet.
    ///
    /// # Errors
    ///
    /// The problems of a scene that has errors; then the world stays as it is.
    pub fn open(world: &mut World, path: &Path, overrides: &[Override]) -> Result<Self, Vec<Problem>> {
        Self::open_as(world, path, None, overrides)
    }

    /// The same for a scene whose text is in no file yet, as if it stood in one at `path`.
    ///
    /// # Errors
    ///
    /// The problems of a scene that has errors; then the world stays as it is.
    pub fn of_text(
        world: &mut World,
        path: &Path,
        text: String,
        overrides: &[Override],
    ) -> Result<Self, Vec<Problem>> {
        Self::open_as(world, path, Some(text), overrides)
    }

    fn open_as(
        world: &mut World,
        path: &Path,
        unsaved: Option<String>,
        overrides: &[Override],
    ) -> Result<Self, Vec<Problem>> {
        let registry = registry_of(world);
        let registry = registry.read();
        let load = |overrides: &[Override]| match &unsaved {
            Some(text) => SceneDocument::of_text(path, text.clone(), &registry, overrides),
            None => SceneDocument::load(path, &registry, overrides),
        };
        let base = Arc::new(load(&[]));
        let mut document = base.clone();
        let mut draft = Draft::default();
        if !base.has_errors() && !overrides.is_empty() {
            document = Arc::new(load(overrides));
            draft = rebase::difference(&base, &document, &registry)
                .map_err(|error| vec![Problem::error(error.to_string())])?;
        }
        if document.has_errors() {
            return Err(document.problems.clone());
        }
        let mut edits = Self {
            path: path.to_owned(),
            unsaved: unsaved.clone(),
            document: base.clone(),
            base,
            draft: Draft::default(),
            history: History::default(),
            conflicts: Vec::new(),
            conflicts_ever: 0,
        };
        match edits.read(&registry, draft) {
            Ok((draft, document)) => (edits.draft, edits.document) = (draft, document),
            Err(EditError::Invalid(problems)) => return Err(problems),
            Err(error) => return Err(vec![Problem::error(error.to_string())]),
        }
        drop(registry);
        edits.show(world);
        Ok(edits)
    }

    /// The scene as it is shown, edits included. Places in it are those in the texts that would be saved.
    pub fn document(&self) -> &SceneDocument {
        &self.document
    }

    /// The files that edits have changed, with the texts that would be saved.
    pub(crate) fn unsaved_files(&self) -> Vec<Arc<SourceFile>> {
        let is_changed = |file: &&Arc<SourceFile>| {
            let before = self.base.sources.get(file.path());
            before.is_none_or(|before| !Arc::ptr_eq(before, file) && before.text() != file.text())
        };
        self.document.sources.values().filter(is_changed).cloned().collect()
    }

    /// Takes what texts of the scene's files say, which were to be saved once, as edits that are not saved, in the place of others.
    ///
    /// # Errors
    ///
    /// If the scene that they make has errors.
    pub(crate) fn take_back(
        &mut self,
        world: &mut World,
        texts: HashMap<PathBuf, String>,
    ) -> Result<(), EditError> {
        let registry = registry_of(world);
        let registry = registry.read();
        let document = self.base.with_texts(&registry, texts, &self.base);
        if document.has_errors() {
            return Err(EditError::Invalid(document.problems));
        }
        let draft = rebase::difference(&self.base, &document, &registry)?;
        let (draft, document) = self.read(&registry, draft)?;
        self.draft = draft;
        let last = std::mem::replace(&mut self.document, document);
        reconcile_after(world, &self.document, Some(&last));
        Ok(())
    }

    /// Makes the world's scene this one.
    pub fn show(&self, world: &mut World) {
        reconcile(world, &self.document);
    }

    /// From here to [`end_drag`](Self::end_drag), edits become one step to undo.
    pub fn begin_drag(&mut self) {
        self.history.begin_drag();
    }

    /// The next edit is a step of its own again.
    pub fn end_drag(&mut self) {
        self.history.end_drag();
    }

    /// Whether edits become one step.
    pub fn is_dragging(&self) -> bool {
        self.history.is_dragging()
    }

    /// The files as they were last read.
    pub(super) fn base(&self) -> &Arc<SceneDocument> {
        &self.base
    }

    /// Takes the last step back. Whether there was one.
    ///
    /// # Errors
    ///
    /// If what it changed has been changed otherwise since, by a reload. The step is left out then.
    pub fn undo(&mut self, world: &mut World) -> Result<bool, EditError> {
        let Some(step) = self.history.take_done() else { return Ok(false) };
        let registry = registry_of(world);
        self.perform(world, &registry.read(), &step.changes, Direction::Back)?;
        self.history.put_undone(step);
        Ok(true)
    }

    /// Takes the last undo back. Whether there was one.
    ///
    /// # Errors
    ///
    /// As [`undo`](Self::undo).
    pub fn redo(&mut self, world: &mut World) -> Result<bool, EditError> {
        let Some(step) = self.history.take_undone() else { return Ok(false) };
        let registry = registry_of(world);
        self.perform(world, &registry.read(), &step.changes, Direction::Forth)?;
        self.history.put_done(step);
        Ok(true)
    }

    /// What the next undo is about, `bunny.Subsurface.material`; none where there is nothing to undo.
    pub fn next_undo(&self) -> Option<String> {
        self.history.next(false)
    }

    /// What the next redo is about.
    pub fn next_redo(&self) -> Option<String> {
        self.history.next(true)
    }

    /// Makes changes and keeps them to be undone.
    fn make(
        &mut self,
        world: &mut World,
        registry: &TypeRegistry,
        changes: Vec<Change>,
    ) -> Result<(), EditError> {
        self.perform(world, registry, &changes, Direction::Forth)?;
        self.history.push(changes, registry);
        Ok(())
    }

    /// Makes or unmakes changes, all or none of them.
    fn perform(
        &mut self,
        world: &mut World,
        registry: &TypeRegistry,
        changes: &[Change],
        direction: Direction,
    ) -> Result<(), EditError> {
        let mut draft = self.draft.copied(registry)?;
        let mut scene = Scene { base: &self.base, draft: &mut draft, registry };
        match direction {
            Direction::Forth => changes.iter().try_for_each(|change| scene.apply(change, direction))?,
            Direction::Back => changes.iter().rev().try_for_each(|change| scene.apply(change, direction))?,
        }
        let (draft, document) = self.read(registry, draft)?;
        self.draft = draft;
        let last = std::mem::replace(&mut self.document, document);
        for change in changes {
            if let Change::Rename { from, to } = change {
                let (from, to) = if direction == Direction::Forth { (from, to) } else { (to, from) };
                rename(world, from, to);
                let named =
                    self.conflicts.iter_mut().filter(|conflict| conflict.entity.as_ref() == Some(from));
                named.for_each(|conflict| conflict.entity = Some(to.clone()));
            }
        }
        reconcile_after(world, &self.document, Some(&last));
        Ok(())
    }

    /// The scene that a draft makes of the files, if it has no errors and says what the draft says.
    fn read(
        &self,
        registry: &TypeRegistry,
        mut draft: Draft,
    ) -> Result<(Draft, Arc<SceneDocument>), EditError> {
        draft.prune(&self.base, registry)?;
        if draft.is_empty() {
            return Ok((draft, self.base.clone()));
        }
        let texts = texts::texts(&self.base, &draft, registry)?.into_iter();
        let texts = texts.map(|file| (file.before.path().to_owned(), file.text)).collect();
        let document = self.base.with_texts(registry, texts, &self.document);
        if document.has_errors() {
            return Err(EditError::Invalid(document.problems));
        }
        save::check(&draft, &document, registry)?;
        Ok((draft, Arc::new(document)))
    }
}

/// Gives an entity of the world another name. It stays the same entity, so that nothing else of it changes.
fn rename(world: &mut World, from: &str, to: &str) {
    let mut names = world.get_resource_or_init::<SceneEntities>();
    let Some(entity) = names.0.remove(from) else { return };
    names.0.insert(to.to_owned(), entity);
    if let Ok(mut entity) = world.get_entity_mut(entity) {
        entity.insert(Name::new(to.to_owned()));
    }
}
