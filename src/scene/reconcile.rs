//! The world becomes what a document says, touching only what differs.

use super::document::SceneDocument;
use bevy_ecs::component::ComponentId;
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy_reflect::{Reflect, TypeRegistry, std_traits::ReflectDefault};
use std::any::TypeId;
use std::collections::{HashMap, HashSet};

/// The entities that came from the scene, by name.
#[derive(Resource, Debug, Default)]
pub struct SceneEntities(pub HashMap<String, Entity>);

/// Which components of an entity the scene wrote, so that a later version of the scene can take them away again.
#[derive(Component, Default)]
struct FromScene(HashSet<TypeId>);

/// Makes the world's scene the one in `document`, by value: what is equal is not touched, so that only real differences count as
/// changed. Entities are identified by name.
pub fn reconcile(world: &mut World, document: &SceneDocument) {
    world.init_resource::<SceneEntities>();
    if world.get_resource() != Some(&document.settings) {
        world.insert_resource(document.settings.clone());
    }
    let registry = world.get_resource_or_init::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let names: HashSet<&str> = document.entities.iter().map(|entity| entity.name.as_str()).collect();
    let gone = world
        .resource_mut::<SceneEntities>()
        .0
        .extract_if(|name, _| !names.contains(name.as_str()))
        .collect::<Vec<_>>();
    for (_, entity) in gone {
        world.despawn(entity);
    }
    for written in &document.entities {
        let known = world
            .resource::<SceneEntities>()
            .0
            .get(&written.name)
            .copied()
            .filter(|entity| world.get_entity(*entity).is_ok());
        let entity = known
            .unwrap_or_else(|| world.spawn((Name::new(written.name.clone()), FromScene::default())).id());
        world.resource_mut::<SceneEntities>().0.insert(written.name.clone(), entity);
        for component in &written.components {
            write(&mut world.entity_mut(entity), component.type_id, component.value.as_ref(), &registry);
        }
        let now: HashSet<TypeId> = written.components.iter().map(|component| component.type_id).collect();
        remove_missing(&mut world.entity_mut(entity), &now, &registry);
    }
}

/// Inserts a value, unless an equal one is there.
fn write(entity: &mut EntityWorldMut, type_id: TypeId, value: &dyn Reflect, registry: &TypeRegistry) {
    let Some(component) = registry.get_type_data::<ReflectComponent>(type_id) else { return };
    let same = component.reflect(&*entity).and_then(|old| old.reflect_partial_eq(value.as_partial_reflect()));
    if same != Some(true) {
        component.insert(entity, value.as_partial_reflect(), registry);
    }
}

/// Takes away what an earlier version of the scene wrote and this one does not. What the rest of the entity requires goes back to its
/// default instead.
fn remove_missing(entity: &mut EntityWorldMut, now: &HashSet<TypeId>, registry: &TypeRegistry) {
    let before = entity
        .get_mut::<FromScene>()
        .map(|mut from_scene| std::mem::replace(&mut from_scene.bypass_change_detection().0, now.clone()));
    let gone: Vec<TypeId> = before.unwrap_or_default().difference(now).copied().collect();
    let came_along: Vec<TypeId> = gone.iter().flat_map(|type_id| required_by(entity, *type_id)).collect();
    for type_id in gone {
        if is_required(entity, type_id, now)
            && let Some(default) = registry.get_type_data::<ReflectDefault>(type_id)
        {
            write(entity, type_id, default.default().as_ref(), registry);
        } else if let Some(component) = registry.get_type_data::<ReflectComponent>(type_id) {
            component.remove(entity);
        }
    }
    // What was there only because something that is gone required it, of what scenes can write: a world that reads the scene anew has
    // none of it either.
    for type_id in came_along.into_iter().filter(|type_id| !now.contains(type_id)) {
        let held: HashSet<TypeId> =
            entity.archetype().iter_components().filter_map(|id| type_of(entity, id)).collect();
        if let Some(component) = registry.get_type_data::<ReflectComponent>(type_id)
            && component.contains(&*entity)
            && !is_required(entity, type_id, &held)
        {
            component.remove(entity);
        }
    }
}

fn type_of(entity: &EntityWorldMut, id: ComponentId) -> Option<TypeId> {
    entity.world().components().get_info(id)?.type_id()
}

/// The components that come along with this one.
fn required_by(entity: &EntityWorldMut, type_id: TypeId) -> Vec<TypeId> {
    let components = entity.world().components();
    let owner = components.get_id(type_id).and_then(|id| components.get_info(id));
    let required = owner.into_iter().flat_map(|owner| owner.required_components().iter_ids());
    required.filter_map(|id| components.get_info(id)?.type_id()).collect()
}

fn is_required(entity: &EntityWorldMut, type_id: TypeId, now: &HashSet<TypeId>) -> bool {
    let components = entity.world().components();
    let Some(id) = components.get_id(type_id) else { return false };
    let owners = now
        .iter()
        .filter_map(|owner| components.get_id(*owner))
        .filter_map(|owner| components.get_info(owner));
    owners.into_iter().any(|owner| owner.required_components().iter_ids().any(|required| required == id))
}
