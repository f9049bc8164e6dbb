//! Edits as data: what was, and what came in its stead.

use super::EditError;
use super::conflict::dotted;
use super::draft::{Draft, DraftComponent, DraftEntity, DraftFile, copied, resolve_paths};
use super::merge::{merge, take};
use crate::components::SceneSettings;
use crate::scene::document::SceneDocument;
use crate::scene::path;
use crate::scene::write::equal;
use bevy_reflect::{PartialReflect, Reflect, TypeRegistry};

/// One change of a scene, which can be made and unmade.
#[derive(Debug)]
pub(super) enum Change {
    /// A value within a component, or within the head where there is no entity.
    Value { entity: Option<String>, path: String, before: Box<dyn Reflect>, after: Box<dyn Reflect> },
    /// A component that came or went.
    Component { entity: String, name: String, before: Option<DraftComponent>, after: Option<DraftComponent> },
    /// An entity that came or went, or became another.
    Entity { name: String, before: Option<DraftEntity>, after: Option<DraftEntity> },
    /// An entity that is called something else.
    Rename { from: String, to: String },
}

/// Which way a change goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Forth,
    Back,
}

impl Direction {
    fn pair<T>(self, before: T, after: T) -> (T, T) {
        match self {
            Self::Forth => (before, after),
            Self::Back => (after, before),
        }
    }
}

/// What changes are made to.
pub(super) struct Scene<'s> {
    pub base: &'s SceneDocument,
    pub draft: &'s mut Draft,
    pub registry: &'s TypeRegistry,
}

impl Change {
    /// What it changes, for people and to tell whether another one changes the same.
    pub fn subject(&self) -> (Option<&str>, &str) {
        match self {
            Self::Value { entity, path, .. } => (entity.as_deref(), path),
            Self::Component { entity, name, .. } => (Some(entity), name),
            Self::Entity { name, .. } => (Some(name), ""),
            Self::Rename { to, .. } => (Some(to), ""),
        }
    }
}

impl Scene<'_> {
    /// Makes or unmakes a change. What has changed since beside it stays; what has changed in the same place is an error.
    pub fn apply(&mut self, change: &Change, direction: Direction) -> Result<(), EditError> {
        match change {
            Change::Value { entity, path, before, after } => {
                let (from, to) = direction.pair(before, after);
                self.value(entity.as_deref(), path, from.as_ref(), to.as_ref())
            }
            Change::Component { entity, name, before, after } => {
                let (from, to) = direction.pair(before.as_ref(), after.as_ref());
                self.component(entity, name, from, to)
            }
            Change::Entity { name, before, after } => {
                let (from, to) = direction.pair(before.as_ref(), after.as_ref());
                self.entity(name, from, to)
            }
            Change::Rename { from, to } => {
                let (from, to) = direction.pair(from, to);
                self.rename(from, to)
            }
        }
    }

    fn value(
        &mut self,
        entity: Option<&str>,
        path: &str,
        from: &dyn Reflect,
        to: &dyn Reflect,
    ) -> Result<(), EditError> {
        let Some(entity) = entity else {
            let mut settings = self.settings();
            self.exchange(&mut settings, None, path, path, from, to)?;
            self.draft.settings = Some(settings);
            return Ok(());
        };
        let (component, within) = path::component_of(path);
        let overtaken = || EditError::Overtaken { entity: Some(entity.to_owned()), path: path.to_owned() };
        let held = self.draft.component(self.base, entity, component).ok_or_else(overtaken)?;
        let (type_id, file, folder) = (held.type_id, held.file, held.folder);
        let mut value = copied(held.value, self.registry)?;
        self.exchange(value.as_partial_reflect_mut(), Some(entity), path, within, from, to)?;
        resolve_paths(value.as_partial_reflect_mut(), &folder);
        if let Some(file) = file {
            self.draft.files.insert(file, DraftFile { type_id, value });
            return Ok(());
        }
        let drafted = self.draft.entity_mut(self.base, entity, self.registry)?;
        let mut components = drafted.components.iter_mut();
        components.find(|found| found.name == component).ok_or_else(overtaken)?.value = value;
        Ok(())
    }

    /// The head as it is now.
    pub fn settings(&self) -> SceneSettings {
        self.draft.settings.clone().unwrap_or_else(|| self.base.settings.clone())
    }

    /// Replaces the value at `within`, which was `from` when the change was recorded.
    fn exchange(
        &self,
        whole: &mut dyn PartialReflect,
        entity: Option<&str>,
        path: &str,
        within: &str,
        from: &dyn Reflect,
        to: &dyn Reflect,
    ) -> Result<(), EditError> {
        let overtaken = || EditError::Overtaken { entity: entity.map(str::to_owned), path: path.to_owned() };
        let within = if entity.is_none() { dotted(within) } else { within.to_owned() };
        let target = path::get_mut(whole, &within).ok_or_else(overtaken)?;
        let (from, to) = (from.as_partial_reflect(), to.as_partial_reflect());
        let merge = merge(from, to, target, self.registry);
        let fits = merge.conflicts.is_empty() && take(&merge, to, target, self.registry);
        if fits { Ok(()) } else { Err(overtaken()) }
    }

    fn component(
        &mut self,
        entity: &str,
        name: &str,
        from: Option<&DraftComponent>,
        to: Option<&DraftComponent>,
    ) -> Result<(), EditError> {
        let overtaken = || EditError::Overtaken { entity: Some(entity.to_owned()), path: name.to_owned() };
        let registry = self.registry;
        let drafted = self.draft.entity_mut(self.base, entity, registry)?;
        let at = drafted.components.iter().position(|found| found.name == name);
        let is_as_recorded = match (at.map(|at| &drafted.components[at]), from) {
            (Some(found), Some(from)) => found.is_like(from, registry),
            (None, None) => true,
            _ => false,
        };
        if !is_as_recorded {
            return Err(overtaken());
        }
        let to = to.map(|to| to.copied(registry)).transpose()?;
        match (at, to) {
            (Some(at), Some(to)) => drafted.components[at] = to,
            (Some(at), None) => drop(drafted.components.remove(at)),
            (None, to) => drafted.components.extend(to),
        }
        Ok(())
    }

    fn entity(
        &mut self,
        name: &str,
        from: Option<&DraftEntity>,
        to: Option<&DraftEntity>,
    ) -> Result<(), EditError> {
        let registry = self.registry;
        let overtaken = || EditError::Overtaken { entity: Some(name.to_owned()), path: String::new() };
        let origin = match (self.draft.has_entity(self.base, name), from) {
            (true, Some(from)) => {
                let drafted = self.draft.entity_mut(self.base, name, registry)?;
                if !drafted.is_like(from, registry) {
                    return Err(overtaken());
                }
                let origin = drafted.origin.take();
                self.draft.entities.remove(name);
                self.draft.removed.extend(origin.clone());
                origin
            }
            (false, None) => None,
            (true, None) => return Err(EditError::NameTaken { name: name.to_owned() }),
            (false, Some(_)) => return Err(overtaken()),
        };
        let Some(to) = to else { return Ok(()) };
        // One that takes the place of another in the files is written there.
        let origin = origin.or_else(|| to.origin.clone()).or_else(|| Some(name.to_owned()));
        let origin = origin.filter(|origin| self.draft.removed.remove(origin));
        let entity = DraftEntity { origin, ..to.copied(registry)? };
        self.draft.entities.insert(name.to_owned(), entity);
        Ok(())
    }

    fn rename(&mut self, from: &str, to: &str) -> Result<(), EditError> {
        if self.draft.has_entity(self.base, to) {
            return Err(EditError::NameTaken { name: to.to_owned() });
        }
        self.draft.entity_mut(self.base, from, self.registry)?;
        if let Some(entity) = self.draft.entities.remove(from) {
            self.draft.entities.insert(to.to_owned(), entity);
        }
        Ok(())
    }
}

/// Whether two changes of a value are of the same one, so that the second can go on from where the first began.
pub(super) fn continues(first: &[Change], second: &[Change]) -> bool {
    let is_value = |change: &Change| matches!(change, Change::Value { .. });
    first.len() == second.len()
        && first.iter().chain(second).all(is_value)
        && first.iter().zip(second).all(|(first, second)| first.subject() == second.subject())
}

/// The changes from the beginning of the first to the end of the second; none where that leads back.
pub(super) fn joined(first: Vec<Change>, second: Vec<Change>, registry: &TypeRegistry) -> Vec<Change> {
    let join = |(first, second)| match (first, second) {
        (Change::Value { entity, path, before, .. }, Change::Value { after, .. }) => {
            let leads_back = equal(before.as_partial_reflect(), after.as_partial_reflect(), registry);
            (!leads_back).then_some(Change::Value { entity, path, before, after })
        }
        (_, second) => Some(second),
    };
    first.into_iter().zip(second).filter_map(join).collect()
}
