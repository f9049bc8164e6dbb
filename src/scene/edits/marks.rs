//! What is not saved yet.

use super::conflict::dotted;
use super::{Edits, registry_of};
use crate::scene::document::SceneEntity;
use crate::scene::path;
use crate::scene::write::equal;
use bevy_ecs::world::World;
use bevy_reflect::PartialReflect;

fn component_in<'d>(entity: &'d SceneEntity, name: &str) -> Option<&'d dyn PartialReflect> {
    let component = entity.components.iter().find(|found| found.name == name)?;
    Some(component.value.as_partial_reflect())
}

impl Edits {
    /// Whether anything would be lost if the program ended now: an edit, or one that is in conflict with the files.
    pub fn is_unsaved(&self) -> bool {
        !self.draft.is_empty() || !self.conflicts.is_empty()
    }

    /// Whether what stands at `path` of an entity, or of the head where there is none, is not what its file says. An empty path is all
    /// of it. What has come is unsaved in all its parts.
    pub fn is_unsaved_at(&self, world: &mut World, entity: Option<&str>, at: &str) -> bool {
        let registry = registry_of(world);
        let registry = registry.read();
        let differs = |now: Option<&dyn PartialReflect>, was: Option<&dyn PartialReflect>| match (now, was) {
            (Some(now), Some(was)) => !equal(now, was, &registry),
            (None, None) => false,
            _ => true,
        };
        let Some(entity) = entity else {
            let at = dotted(at);
            return self
                .draft
                .settings
                .as_ref()
                .is_some_and(|now| differs(path::get(now, &at), path::get(&self.base.settings, &at)));
        };
        let (component, within) = path::component_of(at);
        let drafted = self.draft.entities.get(entity);
        let origin = drafted.map_or(Some(entity), |drafted| drafted.origin.as_deref());
        let now = self.document.entity(entity);
        let was = origin.and_then(|origin| self.base.entity(origin));
        if component.is_empty() {
            // A draft is there only while something of it differs.
            let kept_elsewhere = || {
                let names = now.into_iter().flat_map(|now| now.components.iter());
                names
                    .map(|component| component.name.as_str())
                    .any(|name| self.is_changed_in_file(entity, name))
            };
            return drafted.is_some() || now.is_none() != was.is_none() || kept_elsewhere();
        }
        let value = |entity| path::get(component_in(entity, component)?, within);
        differs(now.and_then(value), was.and_then(value))
    }

    fn is_changed_in_file(&self, entity: &str, component: &str) -> bool {
        let held = self.draft.component(&self.base, entity, component);
        held.and_then(|held| held.file).is_some_and(|file| self.draft.files.contains_key(&file))
    }

    /// The entities with unsaved edits, by the names that they have now, and those that were removed.
    pub fn unsaved_entities(&self) -> impl Iterator<Item = &str> {
        self.draft.entities.keys().chain(&self.draft.removed).map(String::as_str)
    }
}
