//! What was changed both here and on disk, and not to the same.

use super::EditError;
use super::draft::{DraftComponent, DraftEntity, copied};
use crate::scene::document::SceneDocument;
use crate::scene::path;
use crate::scene::write::{equal, quoted, to_ron};
use bevy_reflect::{PartialReflect, Reflect, TypeRegistry};

/// A part of a scene that was edited, and that somebody else has changed in its file since.
///
/// Until it is [resolved](super::Edits::resolve), the scene is shown as the file has it.
#[derive(Debug)]
pub struct Conflict {
    /// What [`Edits::resolve`](super::Edits::resolve) knows it by.
    pub id: u64,
    /// The entity; none for the head of the scene.
    pub entity: Option<String>,
    /// The value in it, `Subsurface.material.g`, as in [`SceneEntity::place_of`](super::super::SceneEntity::place_of); empty for the
    /// entity as a whole.
    pub path: String,
    /// The edit.
    pub ours: Version,
    /// What the file has now.
    pub theirs: Version,
    /// What it had when the edit was made.
    pub was: Version,
}

/// One side of a [`Conflict`].
#[derive(Debug, Default)]
pub struct Version(pub(super) Content);

#[derive(Debug, Default)]
pub(super) enum Content {
    #[default]
    Nothing,
    Value(Box<dyn Reflect>),
    Component(DraftComponent),
    /// With its name.
    Entity(String, DraftEntity),
}

/// Which side of a [`Conflict`] is to stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The edit.
    Ours,
    /// What the file has.
    Theirs,
}

impl Version {
    /// Whether there is nothing of it: it was removed, or not there yet.
    pub fn is_nothing(&self) -> bool {
        matches!(self.0, Content::Nothing)
    }

    /// The value, if it is one; the components of an entity are several.
    pub fn value(&self) -> Option<&dyn PartialReflect> {
        match &self.0 {
            Content::Value(value) => Some(value.as_partial_reflect()),
            Content::Component(component) => Some(component.value.as_partial_reflect()),
            Content::Nothing | Content::Entity(..) => None,
        }
    }

    /// How it is written in a scene, for people to choose by.
    pub fn text(&self, registry: &TypeRegistry) -> String {
        let text = |component: &DraftComponent| match &component.file {
            Some(file) => format!("File({})", quoted(file.written())),
            None => in_ron(component.value.as_ref(), registry),
        };
        match &self.0 {
            Content::Nothing => String::new(),
            Content::Value(value) => in_ron(value.as_ref(), registry),
            Content::Component(component) => text(component),
            Content::Entity(name, entity) => {
                let named = |component: &DraftComponent| format!("{}: {}", component.name, text(component));
                format!(
                    "{}: ( {} )",
                    quoted(name),
                    entity.components.iter().map(named).collect::<Vec<_>>().join(", ")
                )
            }
        }
    }

    /// What a document says about an entity (or the head) at a path.
    pub(super) fn of(
        document: &SceneDocument,
        entity: Option<&str>,
        at: &str,
        registry: &TypeRegistry,
    ) -> Result<Self, EditError> {
        let Some(entity) = entity else {
            let value = path::get(&document.settings, &dotted(at));
            return Ok(Self(copy_of(value, registry)?.map_or(Content::Nothing, Content::Value)));
        };
        let Some(entity) = document.entity(entity) else { return Ok(Self::default()) };
        if at.is_empty() {
            let name = entity.name.clone();
            return Ok(Self(Content::Entity(name, DraftEntity::of(entity, registry)?)));
        }
        let (name, within) = path::component_of(at);
        let Some(component) = entity.components.iter().find(|found| found.name == name) else {
            return Ok(Self::default());
        };
        if within.is_empty() {
            return Ok(Self(Content::Component(DraftComponent::of(entity, component, registry)?)));
        }
        let value = path::get(component.value.as_partial_reflect(), within);
        Ok(Self(copy_of(value, registry)?.map_or(Content::Nothing, Content::Value)))
    }

    pub(super) fn copied(&self, registry: &TypeRegistry) -> Result<Self, EditError> {
        Ok(Self(match &self.0 {
            Content::Nothing => Content::Nothing,
            Content::Value(value) => Content::Value(copied(value.as_ref(), registry)?),
            Content::Component(component) => Content::Component(component.copied(registry)?),
            Content::Entity(name, entity) => Content::Entity(name.clone(), entity.copied(registry)?),
        }))
    }

    pub(super) fn is_like(&self, other: &Self, registry: &TypeRegistry) -> bool {
        match (&self.0, &other.0) {
            (Content::Nothing, Content::Nothing) => true,
            (Content::Component(one), Content::Component(other)) => one.is_like(other, registry),
            (Content::Entity(name, one), Content::Entity(other_name, other)) => {
                name == other_name && one.is_like(other, registry)
            }
            _ => match (self.value(), other.value()) {
                (Some(one), Some(other)) => equal(one, other, registry),
                _ => false,
            },
        }
    }
}

/// A path in the head, as a step from the whole of it.
pub(super) fn dotted(path: &str) -> String {
    if path.is_empty() { String::new() } else { format!(".{path}") }
}

/// A copy of what is found, if anything is.
pub(super) fn copy_of(
    value: Option<&dyn PartialReflect>,
    registry: &TypeRegistry,
) -> Result<Option<Box<dyn Reflect>>, EditError> {
    value.and_then(PartialReflect::try_as_reflect).map(|value| copied(value, registry)).transpose()
}

fn in_ron(value: &dyn Reflect, registry: &TypeRegistry) -> String {
    to_ron(value.as_partial_reflect(), registry).unwrap_or_else(|error| error.to_string())
}
