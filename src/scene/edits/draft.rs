//! What a person changed of a scene, beside what its files say: the values of entities, of components in files of their own, of the head.

use super::EditError;
use super::shared::{own_file, value_of_file};
use crate::components::{AssetPath, SceneSettings};
use crate::scene::document::{SceneComponent, SceneDocument, SceneEntity, identity};
use crate::scene::path;
use crate::scene::write::equal;
use bevy_reflect::{PartialReflect, Reflect, ReflectMut, TypeRegistry};
use std::any::TypeId;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The entities, files and head that were changed. What it does not mention is as the files say.
#[derive(Debug, Default)]
pub(super) struct Draft {
    pub settings: Option<SceneSettings>,
    /// By the name that they have now.
    pub entities: BTreeMap<String, DraftEntity>,
    /// Entities of the files that are gone, by their names there.
    pub removed: BTreeSet<String>,
    /// Components in files of their own, by [`identity`].
    pub files: BTreeMap<PathBuf, DraftFile>,
}

/// An entity that was changed or added.
#[derive(Debug)]
pub(super) struct DraftEntity {
    /// Its name in the files, if it stands there.
    pub origin: Option<String>,
    pub components: Vec<DraftComponent>,
}

#[derive(Debug)]
pub(super) struct DraftComponent {
    pub name: String,
    pub type_id: TypeId,
    /// The file that it is kept in, where it is written as `File("…")`; its value is then what [`Draft::files`] has for that file.
    pub file: Option<AssetPath>,
    pub value: Box<dyn Reflect>,
}

#[derive(Debug)]
pub(super) struct DraftFile {
    pub type_id: TypeId,
    pub value: Box<dyn Reflect>,
}

/// A copy of a value, or whose type it is that stands in the way.
pub(super) fn copied(value: &dyn Reflect, registry: &TypeRegistry) -> Result<Box<dyn Reflect>, EditError> {
    path::copy(value, registry)
        .ok_or_else(|| EditError::Uncopyable { type_path: value.reflect_type_path().to_owned() })
}

impl DraftComponent {
    pub fn copied(&self, registry: &TypeRegistry) -> Result<Self, EditError> {
        let value = copied(self.value.as_ref(), registry)?;
        Ok(Self { name: self.name.clone(), file: self.file.clone(), value, ..*self })
    }

    /// A component as it stands in a document.
    pub fn of(
        entity: &SceneEntity,
        component: &SceneComponent,
        registry: &TypeRegistry,
    ) -> Result<Self, EditError> {
        Ok(Self {
            name: component.name.clone(),
            type_id: component.type_id,
            file: own_file(entity, &component.name),
            value: copied(component.value.as_ref(), registry)?,
        })
    }

    /// Whether the same would be written.
    pub fn is_like(&self, other: &Self, registry: &TypeRegistry) -> bool {
        self.type_id == other.type_id
            && match (&self.file, &other.file) {
                (Some(one), Some(other)) => one == other,
                (None, None) => {
                    equal(self.value.as_partial_reflect(), other.value.as_partial_reflect(), registry)
                }
                _ => false,
            }
    }
}

impl DraftEntity {
    /// An entity as it stands in a document.
    pub fn of(entity: &SceneEntity, registry: &TypeRegistry) -> Result<Self, EditError> {
        let components =
            entity.components.iter().map(|component| DraftComponent::of(entity, component, registry));
        Ok(Self { origin: Some(entity.name.clone()), components: components.collect::<Result<_, _>>()? })
    }

    pub fn copied(&self, registry: &TypeRegistry) -> Result<Self, EditError> {
        let components = self.components.iter().map(|component| component.copied(registry));
        Ok(Self { origin: self.origin.clone(), components: components.collect::<Result<_, _>>()? })
    }

    pub fn component(&self, name: &str) -> Option<&DraftComponent> {
        self.components.iter().find(|component| component.name == name)
    }

    /// Whether the same components would be written, whatever the entity is called.
    pub fn is_like(&self, other: &Self, registry: &TypeRegistry) -> bool {
        let has = |component: &DraftComponent| {
            other.component(&component.name).is_some_and(|other| component.is_like(other, registry))
        };
        self.components.len() == other.components.len() && self.components.iter().all(has)
    }
}

impl Draft {
    pub fn is_empty(&self) -> bool {
        self.settings.is_none()
            && self.entities.is_empty()
            && self.removed.is_empty()
            && self.files.is_empty()
    }

    pub fn copied(&self, registry: &TypeRegistry) -> Result<Self, EditError> {
        let entities =
            self.entities.iter().map(|(name, entity)| Ok((name.clone(), entity.copied(registry)?)));
        let files = self.files.iter().map(|(path, file)| {
            let value = copied(file.value.as_ref(), registry)?;
            Ok((path.clone(), DraftFile { value, ..*file }))
        });
        Ok(Self {
            settings: self.settings.clone(),
            entities: entities.collect::<Result<_, EditError>>()?,
            removed: self.removed.clone(),
            files: files.collect::<Result<_, EditError>>()?,
        })
    }

    /// The name that an entity of the files has now, if it is still there.
    pub fn name_now<'d>(&'d self, base: &'d SceneDocument, origin: &str) -> Option<&'d str> {
        let touched = self.entities.iter().find(|(_, entity)| entity.origin.as_deref() == Some(origin));
        let untouched = || base.entity(origin).filter(|_| !self.removed.contains(origin));
        touched.map(|(name, _)| name.as_str()).or_else(|| Some(untouched()?.name.as_str()))
    }

    /// Whether there is an entity of this name now.
    pub fn has_entity(&self, base: &SceneDocument, name: &str) -> bool {
        self.entities.contains_key(name) || self.name_now(base, name) == Some(name)
    }

    /// The entity of this name, to be changed.
    pub fn entity_mut(
        &mut self,
        base: &SceneDocument,
        name: &str,
        registry: &TypeRegistry,
    ) -> Result<&mut DraftEntity, EditError> {
        let missing = || EditError::NoEntity { entity: name.to_owned() };
        if !self.entities.contains_key(name) {
            let written = base.entity(name).filter(|_| self.name_now(base, name) == Some(name));
            let entity = DraftEntity::of(written.ok_or_else(missing)?, registry)?;
            self.entities.insert(name.to_owned(), entity);
        }
        self.entities.get_mut(name).ok_or_else(missing)
    }

    /// A component of an entity as it is now.
    pub fn component<'d>(
        &'d self,
        base: &'d SceneDocument,
        entity: &str,
        component: &str,
    ) -> Option<Held<'d>> {
        let scene = base.files.first().map(PathBuf::as_path).unwrap_or(Path::new(""));
        let origin = match self.entities.get(entity) {
            Some(drafted) => drafted.origin.as_deref(),
            None => Some(entity).filter(|name| self.name_now(base, name) == Some(name)),
        };
        let written = origin.and_then(|origin| base.entity(origin));
        let home = written.map_or(scene, |written| written.place.file.path());
        let (type_id, value, file) = match self.entities.get(entity) {
            Some(drafted) => {
                let found = drafted.component(component)?;
                (found.type_id, found.value.as_ref(), found.file.clone())
            }
            None => {
                let written = written?;
                let found = written.components.iter().find(|found| found.name == component)?;
                (found.type_id, found.value.as_ref(), own_file(written, component))
            }
        };
        let file = file.map(|file| file.path().to_owned());
        let changed = file.as_ref().and_then(|file| self.files.get(&identity(file)));
        let changed = changed.filter(|changed| changed.type_id == type_id);
        let value = changed.map_or(value, |changed| changed.value.as_ref());
        let folder = file.as_deref().unwrap_or(home).parent().unwrap_or(Path::new("")).to_owned();
        Some(Held { type_id, value, file: file.map(|file| identity(&file)), folder })
    }

    /// Forgets what is as the files say.
    pub fn prune(&mut self, base: &SceneDocument, registry: &TypeRegistry) -> Result<(), EditError> {
        self.settings.take_if(|settings| *settings == base.settings);
        self.files.retain(|path, file| {
            value_of_file(base, path, file.type_id).is_none_or(|value| {
                !equal(value.as_partial_reflect(), file.value.as_partial_reflect(), registry)
            })
        });
        let mut same = Vec::new();
        for (name, entity) in
            self.entities.iter().filter(|(name, entity)| entity.origin.as_ref() == Some(name))
        {
            if let Some(written) = base.entity(name)
                && entity.is_like(&DraftEntity::of(written, registry)?, registry)
            {
                same.push(name.clone());
            }
        }
        same.iter().for_each(|name| drop(self.entities.remove(name)));
        Ok(())
    }
}

/// A component as it is now.
pub(super) struct Held<'d> {
    pub type_id: TypeId,
    pub value: &'d dyn Reflect,
    /// The file of its own that it is kept in, by [`identity`].
    pub file: Option<PathBuf>,
    /// Where paths in it start.
    pub folder: PathBuf,
}

/// Makes the paths in a value start at `folder`.
pub(super) fn resolve_paths(value: &mut dyn PartialReflect, folder: &Path) {
    if let Some(path) = value.try_downcast_mut::<AssetPath>() {
        return path.resolve(folder);
    }
    let mut index = 0;
    while let Some(inner) = inner_mut(value, index) {
        resolve_paths(inner, folder);
        index += 1;
    }
}

fn inner_mut(value: &mut dyn PartialReflect, index: usize) -> Option<&mut dyn PartialReflect> {
    match value.reflect_mut() {
        ReflectMut::Struct(fields) => fields.field_at_mut(index),
        ReflectMut::TupleStruct(fields) => fields.field_mut(index),
        ReflectMut::Tuple(fields) => fields.field_mut(index),
        ReflectMut::List(list) => list.get_mut(index),
        ReflectMut::Enum(fields) => fields.field_at_mut(index),
        _ => None,
    }
}
