//! Files have changed: edits are put into what they say now, or beside it where both have changed the same.

use super::conflict::{Conflict, Content, Version, copy_of};
use super::draft::{Draft, DraftComponent, DraftEntity, DraftFile, copied};
use super::merge::{merge, take};
use super::shared::{shared, value_of_file};
use super::{EditError, Edits, registry_of};
use crate::scene::document::{SceneDocument, SceneEntity, identity};
use crate::scene::path;
use crate::scene::problem::Problem;
use crate::scene::reconcile::{Changes, reconcile_after};
use crate::scene::write::equal;
use bevy_ecs::world::World;
use bevy_reflect::{Reflect, TypeRegistry};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A conflict before it has a number.
struct Clash {
    entity: Option<String>,
    path: String,
    ours: Version,
}

/// One part of a draft, which is taken or left as a whole.
#[derive(Clone)]
enum Piece {
    Settings,
    Entity(String),
    Removed(String),
    File(PathBuf),
}

impl Edits {
    /// Takes in what the files say now. Edits of what has not changed in the files stay; where both have changed the same, or what was
    /// edited is gone, the file is shown and the edit becomes a [`Conflict`]. Gives how many new ones there are.
    ///
    /// `document` must be read without overrides: those are edits, see [`open`](Self::open).
    ///
    /// # Errors
    ///
    /// If the document has errors, which it gives back; then everything stays as it is.
    pub fn reload(&mut self, world: &mut World, document: SceneDocument) -> Result<usize, Vec<Problem>> {
        let known = self.conflicts_ever;
        self.take_in(world, Arc::new(document))?;
        Ok((self.conflicts_ever - known) as usize)
    }

    /// The same, and gives what it changed in the world.
    pub(in crate::scene) fn take_in(
        &mut self,
        world: &mut World,
        document: Arc<SceneDocument>,
    ) -> Result<Changes, Vec<Problem>> {
        if document.has_errors() {
            return Err(document.problems.clone());
        }
        let registry = registry_of(world);
        let registry = registry.read();
        let told = |error: EditError| vec![Problem::error(error.to_string())];
        let was = std::mem::replace(&mut self.base, document);
        let rebased = self.rebased(&was, &registry);
        let (draft, shown, clashes) = rebased.map_err(|error| {
            self.base = was.clone();
            told(error)
        })?;
        self.draft = draft;
        let last = std::mem::replace(&mut self.document, shown);
        self.conflicts.retain_mut(|conflict| {
            let entity = conflict.entity.as_deref();
            if let Ok(theirs) = Version::of(&self.document, entity, &conflict.path, &registry) {
                conflict.theirs = theirs;
            }
            !conflict.ours.is_like(&conflict.theirs, &registry)
        });
        for clash in clashes {
            let at = |document: &SceneDocument| {
                Version::of(document, clash.entity.as_deref(), &clash.path, &registry).unwrap_or_default()
            };
            let (was, theirs) = (at(&was), at(&self.document));
            self.conflicts_ever += 1;
            let Clash { entity, path, ours } = clash;
            self.conflicts.retain(|known| known.entity != entity || known.path != path);
            self.conflicts.push(Conflict { id: self.conflicts_ever, entity, path, ours, theirs, was });
        }
        drop(registry);
        Ok(reconcile_after(world, &self.document, Some(&last)))
    }

    /// The draft for the files as they are now, what is shown with it, and what of it is in conflict with them.
    fn rebased(
        &self,
        was: &SceneDocument,
        registry: &TypeRegistry,
    ) -> Result<(Draft, Arc<SceneDocument>, Vec<Clash>), EditError> {
        let mut rebase =
            Rebase { was, now: &self.base, registry, draft: Draft::default(), clashes: Vec::new() };
        rebase.settings(&self.draft)?;
        for (name, entity) in &self.draft.entities {
            rebase.entity(name, entity)?;
        }
        for name in &self.draft.removed {
            rebase.removed(name)?;
        }
        for (path, file) in &self.draft.files {
            rebase.file(path, file)?;
        }
        let (mut draft, mut clashes) = (rebase.draft, rebase.clashes);
        loop {
            match self.read(registry, draft.copied(registry)?) {
                Ok((draft, shown)) => return Ok((draft, shown, clashes)),
                // Sides that are right each for itself need not be together: fields that depend on each other, names that are gone.
                Err(_) if !draft.is_empty() => {
                    for piece in self.misfits(&draft, registry)? {
                        clashes.extend(draft.take(&piece, &self.base));
                    }
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// The piece of a draft without which it can be read, if there is one; else as much as makes sure that the rest can be.
    fn misfits(&self, draft: &Draft, registry: &TypeRegistry) -> Result<Vec<Piece>, EditError> {
        let pieces = draft.pieces();
        if pieces.len() > MOST_TRIED {
            return Ok(pieces);
        }
        for piece in &pieces {
            let mut rest = draft.copied(registry)?;
            rest.take(piece, &self.base);
            if self.read(registry, rest).is_ok() {
                return Ok(vec![piece.clone()]);
            }
        }
        Ok(pieces.into_iter().next_back().into_iter().collect())
    }
}

/// How many pieces of a draft are left out one after the other, to see which does not fit.
const MOST_TRIED: usize = 64;

impl Draft {
    fn pieces(&self) -> Vec<Piece> {
        let settings = self.settings.as_ref().map(|_| Piece::Settings).into_iter();
        let entities = self.entities.keys().cloned().map(Piece::Entity);
        let removed = self.removed.iter().cloned().map(Piece::Removed);
        settings.chain(self.files.keys().cloned().map(Piece::File)).chain(entities).chain(removed).collect()
    }

    /// Takes a piece out, as our side of a conflict.
    fn take(&mut self, piece: &Piece, base: &SceneDocument) -> Option<Clash> {
        Some(match piece {
            Piece::Settings => {
                let settings: Box<dyn Reflect> = Box::new(self.settings.take()?);
                Clash { entity: None, path: String::new(), ours: Version(Content::Value(settings)) }
            }
            Piece::Entity(name) => Clash::of_entity(name, self.entities.remove(name)?),
            Piece::Removed(name) => {
                self.removed.remove(name);
                Clash { entity: Some(name.clone()), path: String::new(), ours: Version::default() }
            }
            Piece::File(path) => {
                let file = self.files.remove(path)?;
                let user = shared(base, path, file.type_id).next()?;
                let (entity, path) = (user.entity.name.clone(), user.component.name.clone());
                Clash { entity: Some(entity), path, ours: Version(Content::Value(file.value)) }
            }
        })
    }
}

impl Clash {
    fn of_entity(name: &str, ours: DraftEntity) -> Self {
        let entity = ours.origin.clone().unwrap_or_else(|| name.to_owned());
        let ours = Version(Content::Entity(name.to_owned(), ours));
        Self { entity: Some(entity), path: String::new(), ours }
    }
}

/// Puts a draft that was made of `was` onto what the files say `now`.
struct Rebase<'r> {
    was: &'r SceneDocument,
    now: &'r SceneDocument,
    registry: &'r TypeRegistry,
    draft: Draft,
    clashes: Vec<Clash>,
}

impl Rebase<'_> {
    fn clash(&mut self, entity: Option<&str>, path: impl Into<String>, ours: Content) {
        self.clashes.push(Clash {
            entity: entity.map(str::to_owned),
            path: path.into(),
            ours: Version(ours),
        });
    }

    /// The value of three sides, and the paths at which ours was left out.
    fn value(
        &mut self,
        entity: Option<&str>,
        name: &str,
        [was, ours, now]: [&dyn Reflect; 3],
    ) -> Result<Box<dyn Reflect>, EditError> {
        let mut value = copied(now, self.registry)?;
        let merge = merge(
            was.as_partial_reflect(),
            ours.as_partial_reflect(),
            now.as_partial_reflect(),
            self.registry,
        );
        if !take(&merge, ours.as_partial_reflect(), value.as_partial_reflect_mut(), self.registry) {
            value = copied(now, self.registry)?;
            self.clash(entity, name, Content::Value(copied(ours, self.registry)?));
            return Ok(value);
        }
        for path in merge.conflicts {
            if let Some(ours) = copy_of(path::get(ours.as_partial_reflect(), &path), self.registry)? {
                let path = format!("{name}{path}");
                self.clash(entity, path.trim_start_matches('.'), Content::Value(ours));
            }
        }
        Ok(value)
    }

    fn settings(&mut self, ours: &Draft) -> Result<(), EditError> {
        let Some(settings) = &ours.settings else { return Ok(()) };
        let (was, now) = (self.was, self.now);
        let value = self.value(None, "", [&was.settings, settings, &now.settings])?;
        self.draft.settings = value.take().ok();
        Ok(())
    }

    fn entity(&mut self, name: &str, ours: &DraftEntity) -> Result<(), EditError> {
        let ours = ours.copied(self.registry)?;
        let was = ours.origin.as_ref().and_then(|origin| self.was.entity(origin));
        let Some((origin, was)) = ours.origin.clone().zip(was) else {
            return self.added(name, ours);
        };
        let was = DraftEntity::of(was, self.registry)?;
        let named = Some(name).filter(|name| *name != origin).and_then(|name| self.newly_named(name));
        let (now, origin) = match (self.now.entity(&origin), named) {
            (Some(now), None) => (now, origin),
            // The file has the new name too: it was saved, or somebody else had the same idea.
            (None, Some(now)) => (now, name.to_owned()),
            (now, _) => {
                if now.is_some() || origin != name || !ours.is_like(&was, self.registry) {
                    self.clash(Some(&origin), "", Content::Entity(name.to_owned(), ours));
                }
                return Ok(());
            }
        };
        let now = DraftEntity::of(now, self.registry)?;
        let mut components = Vec::new();
        let new = ours.components.iter().filter(|component| now.component(&component.name).is_none());
        let names = now.components.iter().chain(new).map(|component| &component.name);
        for component in names {
            let sides = [was.component(component), ours.component(component), now.component(component)];
            components.extend(self.component(name, component, sides)?);
        }
        self.draft.entities.insert(name.to_owned(), DraftEntity { origin: Some(origin), components });
        Ok(())
    }

    /// The entity of this name, if none had it before.
    fn newly_named(&self, name: &str) -> Option<&SceneEntity> {
        self.now.entity(name).filter(|_| self.was.entity(name).is_none())
    }

    /// An entity that is not in the files, or was not.
    fn added(&mut self, name: &str, ours: DraftEntity) -> Result<(), EditError> {
        match self.newly_named(name) {
            None => drop(self.draft.entities.insert(name.to_owned(), DraftEntity { origin: None, ..ours })),
            Some(now) if DraftEntity::of(now, self.registry)?.is_like(&ours, self.registry) => {}
            Some(_) => self.clash(Some(name), "", Content::Entity(name.to_owned(), ours)),
        }
        Ok(())
    }

    fn component(
        &mut self,
        entity: &str,
        name: &str,
        [was, ours, now]: [Option<&DraftComponent>; 3],
    ) -> Result<Option<DraftComponent>, EditError> {
        let registry = self.registry;
        let is_like = |one: Option<&DraftComponent>, other: Option<&DraftComponent>| match (one, other) {
            (Some(one), Some(other)) => one.is_like(other, registry),
            (None, None) => true,
            _ => false,
        };
        let copy = |side: Option<&DraftComponent>| side.map(|side| side.copied(registry)).transpose();
        if is_like(ours, was) || is_like(ours, now) {
            return copy(now);
        }
        if is_like(now, was) {
            return copy(ours);
        }
        if let (Some(was), Some(ours), Some(now)) = (was, ours, now)
            && [was, ours, now].iter().all(|side| side.file.is_none())
        {
            let value = self.value(
                Some(entity),
                name,
                [was.value.as_ref(), ours.value.as_ref(), now.value.as_ref()],
            )?;
            return Ok(Some(DraftComponent { value, ..now.copied(registry)? }));
        }
        self.clash(Some(entity), name, copy(ours)?.map_or(Content::Nothing, Content::Component));
        copy(now)
    }

    fn removed(&mut self, name: &str) -> Result<(), EditError> {
        let (Some(was), Some(now)) = (self.was.entity(name), self.now.entity(name)) else { return Ok(()) };
        let was = DraftEntity::of(was, self.registry)?;
        if DraftEntity::of(now, self.registry)?.is_like(&was, self.registry) {
            self.draft.removed.insert(name.to_owned());
        } else {
            self.clash(Some(name), "", Content::Nothing);
        }
        Ok(())
    }

    fn file(&mut self, path: &Path, ours: &DraftFile) -> Result<(), EditError> {
        let ours_value = ours.value.as_ref();
        let was = value_of_file(self.was, path, ours.type_id);
        let Some(now) = value_of_file(self.now, path, ours.type_id) else {
            // Nothing uses the file any longer: what did has something else now, or is gone.
            if let Some(user) = shared(self.was, path, ours.type_id).next() {
                let ours = copied(ours_value, self.registry)?;
                self.clash(Some(&user.entity.name), &user.component.name, Content::Value(ours));
            }
            return Ok(());
        };
        let Some(user) = shared(self.now, path, ours.type_id).next() else { return Ok(()) };
        let (entity, name) = (&user.entity.name, &user.component.name);
        let value = self.value(Some(entity), name, [was.unwrap_or(now), ours_value, now])?;
        self.draft.files.insert(path.to_owned(), DraftFile { type_id: ours.type_id, value });
        Ok(())
    }
}

/// What `shown` has changed of `base`, as a draft.
pub(super) fn difference(
    base: &SceneDocument,
    shown: &SceneDocument,
    registry: &TypeRegistry,
) -> Result<Draft, EditError> {
    let settings = (shown.settings != base.settings).then(|| shown.settings.clone());
    let mut draft = Draft { settings, ..Draft::default() };
    for entity in &shown.entities {
        let Some(was) = base.entity(&entity.name) else {
            let added = DraftEntity { origin: None, ..DraftEntity::of(entity, registry)? };
            draft.entities.insert(entity.name.clone(), added);
            continue;
        };
        let mut changed = Vec::new();
        for component in entity.components.iter() {
            let now = DraftComponent::of(entity, component, registry)?;
            let before = was.components.iter().find(|before| before.type_id == component.type_id);
            let is_same = before.is_some_and(|before| {
                equal(before.value.as_partial_reflect(), now.value.as_partial_reflect(), registry)
            });
            match &now.file {
                _ if is_same => {}
                Some(file) if before.is_some() => {
                    let (type_id, value) = (now.type_id, now.value);
                    draft.files.insert(identity(file.path()), DraftFile { type_id, value });
                }
                _ => changed.push(now),
            }
        }
        let is_there = |type_id| entity.components.iter().any(|component| component.type_id == type_id);
        if changed.is_empty() && was.components.iter().all(|before| is_there(before.type_id)) {
            continue;
        }
        let drafted = draft.entity_mut(base, &entity.name, registry)?;
        for component in changed {
            drafted.components.retain(|before| before.type_id != component.type_id);
            drafted.components.push(component);
        }
        drafted.components.retain(|component| is_there(component.type_id));
    }
    let gone = base.entities.iter().filter(|entity| shown.entity(&entity.name).is_none());
    draft.removed = gone.map(|entity| entity.name.clone()).collect();
    Ok(draft)
}
