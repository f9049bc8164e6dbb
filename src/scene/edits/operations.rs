//! What a person can do to a scene.

use super::change::Change;
use super::conflict::dotted;
use super::draft::{DraftComponent, DraftEntity, copied, resolve_paths};
use super::{EditError, Edits, registry_of};
use crate::components::NameOf;
use crate::scene::path;
use crate::scene::write::equal;
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::{PartialReflect, Reflect, ReflectRef, TypeInfo, TypeRegistry};
use std::path::Path;

impl Edits {
    /// Sets the value at `path` (`Subsurface.material.g`, `TransferFunction.points[2]`) of an entity. For what may be absent it may be what
    /// it would hold. Paths of files are as they would be written, relative to the file that the component stands in.
    ///
    /// A component that is kept in a file of its own is changed there, and so for all entities that use it.
    ///
    /// # Errors
    ///
    /// If there is no such value, it has another type, or the scene would have errors with it.
    pub fn set(
        &mut self,
        world: &mut World,
        entity: &str,
        path: &str,
        value: &dyn PartialReflect,
    ) -> Result<(), EditError> {
        let registry = registry_of(world);
        let registry = registry.read();
        let (component, within) = path::component_of(path);
        let no_entity = || EditError::NoEntity { entity: entity.to_owned() };
        let written = self.document.entity(entity).ok_or_else(no_entity)?;
        let no_value = || EditError::NoValue { entity: entity.to_owned(), path: path.to_owned() };
        let held = self.draft.component(&self.base, entity, component).ok_or_else(no_value)?;
        let old = path::get(held.value.as_partial_reflect(), within).ok_or_else(no_value)?;
        let mut after = typed(path, old, value, &registry)?;
        resolve_paths(after.as_partial_reflect_mut(), &held.folder);
        if equal(old, after.as_partial_reflect(), &registry) {
            return Ok(());
        }
        let before = copied(old.try_as_reflect().ok_or_else(no_value)?, &registry)?;
        let entity = Some(written.name.clone());
        self.make(world, &registry, vec![Change::Value { entity, path: path.to_owned(), before, after }])
    }

    /// Sets a field of the head of the scene, `background`.
    ///
    /// # Errors
    ///
    /// As [`set`](Self::set).
    pub fn set_setting(
        &mut self,
        world: &mut World,
        path: &str,
        value: &dyn PartialReflect,
    ) -> Result<(), EditError> {
        let registry = registry_of(world);
        let registry = registry.read();
        let settings = &self.document.settings;
        let no_value =
            || EditError::NoValue { entity: "the head of the scene".into(), path: path.to_owned() };
        let old = path::get(settings, &dotted(path)).filter(|_| !path.is_empty()).ok_or_else(no_value)?;
        let after = typed(path, old, value, &registry)?;
        if equal(old, after.as_partial_reflect(), &registry) {
            return Ok(());
        }
        let before = copied(old.try_as_reflect().ok_or_else(no_value)?, &registry)?;
        let change = Change::Value { entity: None, path: path.to_owned(), before, after };
        self.make(world, &registry, vec![change])
    }

    /// Adds a component to an entity, with this value.
    ///
    /// # Errors
    ///
    /// If there is no such entity, it has one of this type, or the scene would have errors.
    pub fn add_component(
        &mut self,
        world: &mut World,
        entity: &str,
        value: &dyn Reflect,
    ) -> Result<(), EditError> {
        let registry = registry_of(world);
        let registry = registry.read();
        let written = self.document.entity(entity);
        let written = written.ok_or_else(|| EditError::NoEntity { entity: entity.to_owned() })?;
        let mut after = new_component(value, &registry)?;
        if written.components.iter().any(|found| found.type_id == after.type_id) {
            return Err(EditError::ComponentTaken { entity: entity.to_owned(), component: after.name });
        }
        let folder = written.place.file.path().parent().unwrap_or(Path::new(""));
        resolve_paths(after.value.as_partial_reflect_mut(), folder);
        let (entity, name) = (entity.to_owned(), after.name.clone());
        self.make(
            world,
            &registry,
            vec![Change::Component { entity, name, before: None, after: Some(after) }],
        )
    }

    /// Takes a component away from an entity.
    ///
    /// # Errors
    ///
    /// If there is none, or the scene would have errors without it.
    pub fn remove_component(
        &mut self,
        world: &mut World,
        entity: &str,
        component: &str,
    ) -> Result<(), EditError> {
        let registry = registry_of(world);
        let registry = registry.read();
        let no_value = || EditError::NoValue { entity: entity.to_owned(), path: component.to_owned() };
        let before = self.entity_now(entity, &registry)?;
        let before =
            before.components.into_iter().find(|found| found.name == component).ok_or_else(no_value)?;
        let (entity, name) = (entity.to_owned(), before.name.clone());
        self.make(
            world,
            &registry,
            vec![Change::Component { entity, name, before: Some(before), after: None }],
        )
    }

    /// Adds an entity with these components to the scene's own file.
    ///
    /// # Errors
    ///
    /// If the name is taken, or the scene would have errors with it.
    pub fn add_entity(
        &mut self,
        world: &mut World,
        name: &str,
        components: &[&dyn Reflect],
    ) -> Result<(), EditError> {
        let registry = registry_of(world);
        let registry = registry.read();
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let mut added = DraftEntity { origin: None, components: Vec::new() };
        for value in components {
            let mut component = new_component(*value, &registry)?;
            resolve_paths(component.value.as_partial_reflect_mut(), folder);
            if added.component(&component.name).is_some() {
                return Err(EditError::ComponentTaken { entity: name.to_owned(), component: component.name });
            }
            added.components.push(component);
        }
        self.make(
            world,
            &registry,
            vec![Change::Entity { name: name.to_owned(), before: None, after: Some(added) }],
        )
    }

    /// Takes an entity out of the scene.
    ///
    /// # Errors
    ///
    /// If there is none, or another one needs it.
    pub fn remove_entity(&mut self, world: &mut World, name: &str) -> Result<(), EditError> {
        let registry = registry_of(world);
        let registry = registry.read();
        let before = self.entity_now(name, &registry)?;
        self.make(
            world,
            &registry,
            vec![Change::Entity { name: name.to_owned(), before: Some(before), after: None }],
        )
    }

    /// Gives an entity another name. It stays the same one in the world, and components that name it follow.
    ///
    /// # Errors
    ///
    /// If there is none, or the name is taken.
    pub fn rename_entity(&mut self, world: &mut World, from: &str, to: &str) -> Result<(), EditError> {
        let registry = registry_of(world);
        let registry = registry.read();
        if self.document.entity(from).is_none() {
            return Err(EditError::NoEntity { entity: from.to_owned() });
        }
        let mut changes = vec![Change::Rename { from: from.to_owned(), to: to.to_owned() }];
        for entity in &self.document.entities {
            let owner = if entity.name == from { to } else { &entity.name };
            for component in entity.components.iter() {
                for (field, before) in naming(component.value.as_ref(), from) {
                    let mut after = copied(before, &registry)?;
                    if !path::replace(after.as_partial_reflect_mut(), &to.to_owned(), &registry) {
                        continue;
                    }
                    let before = copied(before, &registry)?;
                    let (entity, path) = (Some(owner.to_owned()), format!("{}.{field}", component.name));
                    changes.push(Change::Value { entity, path, before, after });
                }
            }
        }
        self.make(world, &registry, changes)
    }

    /// An entity as it is now, for a change that takes it away.
    fn entity_now(&self, name: &str, registry: &TypeRegistry) -> Result<DraftEntity, EditError> {
        if let Some(drafted) = self.draft.entities.get(name) {
            return drafted.copied(registry);
        }
        let missing = || EditError::NoEntity { entity: name.to_owned() };
        DraftEntity::of(self.document.entity(name).ok_or_else(missing)?, registry)
    }
}

/// `value` as what `old` is.
fn typed(
    path: &str,
    old: &dyn PartialReflect,
    value: &dyn PartialReflect,
    registry: &TypeRegistry,
) -> Result<Box<dyn Reflect>, EditError> {
    let info = old.get_represented_type_info();
    info.and_then(|info| path::as_type(info, value, registry)).ok_or_else(|| EditError::WrongType {
        path: path.to_owned(),
        expected: old.reflect_short_type_path().to_owned(),
        found: value.reflect_short_type_path().to_owned(),
    })
}

/// A component under the name that scenes have for it.
fn new_component(value: &dyn Reflect, registry: &TypeRegistry) -> Result<DraftComponent, EditError> {
    let type_id = value.as_any().type_id();
    let known = registry.get(type_id).filter(|known| known.data::<ReflectComponent>().is_some());
    let name = known.map(|known| known.type_info().type_path_table().short_path());
    let unknown = || EditError::NoComponent { name: value.reflect_type_path().to_owned() };
    let name = name.filter(|name| !registry.is_ambiguous(name)).ok_or_else(unknown)?.to_owned();
    Ok(DraftComponent { name, type_id, file: None, value: copied(value, registry)? })
}

/// The fields of a component that hold the name of this entity.
fn naming<'v>(component: &'v dyn Reflect, name: &str) -> Vec<(&'static str, &'v dyn Reflect)> {
    let Some(TypeInfo::Struct(info)) = component.get_represented_type_info() else { return Vec::new() };
    let ReflectRef::Struct(fields) = component.reflect_ref() else { return Vec::new() };
    let named = info.iter().filter(|field| field.has_attribute::<NameOf>());
    let found = named.filter_map(|field| {
        let value = fields.field(field.name())?;
        let optional = || value.try_downcast_ref::<Option<String>>().and_then(Option::as_ref);
        let held = value.try_downcast_ref::<String>().or_else(optional)?;
        Some((field.name(), value.try_as_reflect()?)).filter(|_| held == name)
    });
    found.collect()
}
