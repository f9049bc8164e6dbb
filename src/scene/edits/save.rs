//! Edits go back to the files that they came from.

use super::draft::{Draft, DraftComponent};
use super::shared::value_of_file;
use super::texts::{Changed, texts};
use super::{EditError, Edits, SaveError, registry_of};
use crate::components::{Mesh, Volume};
use crate::regular_file;
use crate::scene::document::{SceneDocument, identity};
use crate::scene::of_files::relative_to;
use crate::scene::problem::SourceFile;
use crate::scene::write::quoted;
use crate::scene::write::{WriteError, equal, to_ron};
use crate::whole_file::{Staged, folder_of};
use bevy_ecs::world::World;
use bevy_reflect::{Reflect, TypeRegistry};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

impl Edits {
    /// The texts that saving would write, each with the path that the scene has for its file.
    ///
    /// # Errors
    ///
    /// If an edit cannot be written.
    pub fn preview(&self, world: &mut World) -> Result<BTreeMap<PathBuf, String>, EditError> {
        let registry = registry_of(world);
        let texts = texts(&self.base, &self.draft, &registry.read())?.into_iter();
        Ok(texts.map(|file| (file.before.path().to_owned(), file.text)).collect())
    }

    /// The text of the scene, with its edits, as it would stand in a file at `path`: what it names by relative paths
    /// is named as seen from there.
    ///
    /// # Errors
    ///
    /// If an edit cannot be written.
    pub fn text_for(&self, world: &mut World, path: &Path) -> Result<String, EditError> {
        let as_read = || self.base.source(&self.path).map(|file| file.text().to_owned());
        let text = self.preview(world)?.remove(&self.path).or(self.unsaved.clone());
        let mut text = text.or_else(as_read).unwrap_or_default();
        let folder = folder_of(path);
        for component in self.document.entities.iter().flat_map(|entity| entity.components.iter()) {
            let value = component.value.as_any();
            let named = match (value.downcast_ref::<Mesh>(), value.downcast_ref::<Volume>()) {
                (Some(Mesh::File { path, .. }), _) => path,
                (_, Some(Volume::File { path, .. } | Volume::Raw { path, .. })) => path,
                _ => continue,
            };
            text = text.replace(&quoted(named.written()), &quoted(&relative_to(named.path(), &folder)));
        }
        // Scenes that are included, and components in files of their own.
        let before = folder_of(&self.path);
        for file in self.base.trail().keys().filter(|file| **file != self.path) {
            text = text.replace(&quoted(&relative_to(file, &before)), &quoted(&relative_to(file, &folder)));
        }
        Ok(text)
    }

    /// Writes every edit to the file that it came from, and gives the files that were written.
    ///
    /// Files that somebody else has changed since they were read are merged first, as by [`reload`](Self::reload). Each file is there
    /// whole at any time, the old or the new one; where one of several cannot be written, those before it are, and the rest stays
    /// unsaved.
    ///
    /// # Errors
    ///
    /// If edits are in conflict with what the files have now, those have errors, or cannot be written.
    pub fn save(&mut self, world: &mut World) -> Result<Vec<PathBuf>, SaveError> {
        if self.unsaved.is_some() {
            return Err(SaveError::Untitled);
        }
        let registry = registry_of(world);
        for _ in 0..MOST_ATTEMPTS {
            let theirs = SceneDocument::load(&self.path, &registry.read(), &[]);
            self.reload(world, theirs).map_err(SaveError::Broken)?;
            if !self.conflicts.is_empty() {
                return Err(SaveError::Conflicts { count: self.conflicts.len() });
            }
            // A file that the scene names in two ways is one file, and changed in one way.
            let texts = texts(&self.base, &self.draft, &registry.read())?.into_iter();
            let files: BTreeMap<PathBuf, Changed> =
                texts.map(|file| (identity(file.before.path()), file)).collect();
            let Some(written) = write_all(files.into_values()) else { continue };
            if written.is_ok() {
                self.draft = Draft::default();
                self.base = self.document.clone();
            }
            // Where not all could be written, this finds out what edits are left.
            let saved = SceneDocument::load(&self.path, &registry.read(), &[]);
            self.reload(world, saved).map_err(SaveError::Broken)?;
            return written;
        }
        Err(SaveError::Busy)
    }
}

/// How often a save begins again because somebody else saved in the meantime.
const MOST_ATTEMPTS: usize = 5;

/// Writes all files beside those that they are to replace, and only then replaces any: a full disk shows before anything is changed.
/// None if one of them is no longer as it was read.
fn write_all(files: impl Iterator<Item = Changed>) -> Option<Result<Vec<PathBuf>, SaveError>> {
    let failed = |path: &Path, source| Some(Err(SaveError::File { path: path.to_owned(), source }));
    let mut staged = Vec::new();
    for Changed { before, text } in files {
        match Staged::write(before.path(), text.as_bytes()).and_then(Staged::synced) {
            Ok(file) => staged.push((file, before)),
            Err(error) => return failed(before.path(), error),
        }
    }
    let is_as_read = |file: &SourceFile| {
        let text = file.text().as_bytes();
        regular_file::read(file.path(), text.len() as u64).is_ok_and(|now| now == text)
    };
    if !staged.iter().all(|(_, before)| is_as_read(before)) {
        return None;
    }
    let mut written = Vec::new();
    for (file, before) in staged {
        if let Err(error) = file.commit() {
            return failed(before.path(), error);
        }
        written.push(before.path().to_owned());
    }
    Some(Ok(written))
}

/// Whether a document says what the draft does, which was read from the texts that were made of it.
pub(super) fn check(
    draft: &Draft,
    document: &SceneDocument,
    registry: &TypeRegistry,
) -> Result<(), EditError> {
    for (name, entity) in &draft.entities {
        let Some(read) = document.entity(name) else {
            return Err(EditError::NoEntity { entity: name.clone() });
        };
        for component in &entity.components {
            let found = read.components.iter().find(|found| found.type_id == component.type_id);
            if component.file.is_none() {
                is_read(component, found.map(|found| found.value.as_ref()), registry)?;
            }
        }
    }
    for (path, file) in &draft.files {
        match value_of_file(document, path, file.type_id) {
            // No entity uses the file any longer.
            None => {}
            Some(read) if equal(read.as_partial_reflect(), file.value.as_partial_reflect(), registry) => {}
            Some(_) => return Err(unfaithful(file.value.as_ref(), registry)),
        }
    }
    match &draft.settings {
        Some(settings) if *settings != document.settings => Err(unfaithful(settings, registry)),
        _ => Ok(()),
    }
}

fn is_read(
    component: &DraftComponent,
    read: Option<&dyn Reflect>,
    registry: &TypeRegistry,
) -> Result<(), EditError> {
    let value = component.value.as_partial_reflect();
    let is_same = read.is_some_and(|read| equal(read.as_partial_reflect(), value, registry));
    if is_same { Ok(()) } else { Err(unfaithful(component.value.as_ref(), registry)) }
}

fn unfaithful(value: &dyn Reflect, registry: &TypeRegistry) -> EditError {
    let text = to_ron(value.as_partial_reflect(), registry).unwrap_or_default();
    EditError::Write(WriteError::Unfaithful { type_path: value.reflect_type_path().to_owned(), text })
}
