//! The world becomes what a document says, touching only what differs.

use super::document::{SceneDocument, SceneEntity};
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

/// What a reconciliation changed in the world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Entities that came.
    pub spawned: usize,
    /// Entities that went.
    pub despawned: usize,
    /// Components that were written.
    pub written: usize,
    /// Components that were taken away.
    pub removed: usize,
    /// Whether the head of the scene changed.
    pub head: bool,
}

impl Changes {
    /// Whether nothing changed.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Makes the world's scene the one in `document`, by value: what is equal is not touched, so that only real differences count as
/// changed. Entities are identified by name.
pub fn reconcile(world: &mut World, document: &SceneDocument) -> Changes {
    reconcile_after(world, document, None)
}

/// The same, for a world that was made from `last`: what is the same in both documents is not looked at, and so keeps what else may
/// have been done to it since.
pub fn reconcile_after(world: &mut World, document: &SceneDocument, last: Option<&SceneDocument>) -> Changes {
    let mut changes = Changes::default();
    let is_new = last.is_none_or(|last| last.settings != document.settings);
    if is_new && world.get_resource() != Some(&document.settings) {
        world.insert_resource(document.settings.clone());
        changes.head = true;
    }
    let registry = world.get_resource_or_init::<AppTypeRegistry>().clone();
    let registry = registry.read();
    world.init_resource::<SceneEntities>();
    // Borrowed as changed only where an entity comes or goes.
    world.resource_scope(|world, mut entities: Mut<SceneEntities>| {
        let mut writer = Writer { world, registry: &registry, changes: &mut changes };
        writer.despawn_missing(&mut entities, document);
        for written in &document.entities {
            let before = last.and_then(|last| last.entity(&written.name));
            writer.entity(&mut entities, written, before);
        }
    });
    changes
}

struct Writer<'a> {
    world: &'a mut World,
    registry: &'a TypeRegistry,
    changes: &'a mut Changes,
}

impl Writer<'_> {
    fn despawn_missing(&mut self, entities: &mut Mut<SceneEntities>, document: &SceneDocument) {
        let is_gone = |name: &String| document.entity(name).is_none();
        if !entities.0.keys().any(is_gone) {
            return;
        }
        for (_, entity) in entities.0.extract_if(|name, _| is_gone(name)) {
            self.changes.despawned += usize::from(self.world.despawn(entity));
        }
    }

    fn entity(
        &mut self,
        entities: &mut Mut<SceneEntities>,
        written: &SceneEntity,
        before: Option<&SceneEntity>,
    ) {
        let known = entities.0.get(&written.name).copied();
        let known = known.filter(|entity| self.world.get_entity(*entity).is_ok());
        // One that had to be made anew has nothing of what was written before.
        let before = before.filter(|_| known.is_some());
        if before.is_some_and(|before| written.is_shared_with(before)) {
            return;
        }
        let entity = known.unwrap_or_else(|| {
            self.changes.spawned += 1;
            let entity = self.world.spawn((Name::new(written.name.clone()), FromScene::default())).id();
            entities.0.insert(written.name.clone(), entity);
            entity
        });
        for component in written.components.iter() {
            let before = before.and_then(|before| before.component(component.type_id));
            if before.is_none_or(|before| !is_equal(before, component.value.as_ref())) {
                self.write(entity, component.type_id, component.value.as_ref());
            }
        }
        self.remove_missing(entity, written.components.iter().map(|component| component.type_id).collect());
    }

    /// Inserts a value, unless an equal one is there.
    fn write(&mut self, entity: Entity, type_id: TypeId, value: &dyn Reflect) {
        let Some(component) = self.registry.get_type_data::<ReflectComponent>(type_id) else { return };
        let mut entity = self.world.entity_mut(entity);
        if !component.reflect(&entity).is_some_and(|old| is_equal(old, value)) {
            component.insert(&mut entity, value.as_partial_reflect(), self.registry);
            self.changes.written += 1;
        }
    }

    /// Takes away what an earlier version of the scene wrote and this one does not. What the rest of the entity requires goes back to
    /// its default instead.
    fn remove_missing(&mut self, entity: Entity, now: HashSet<TypeId>) {
        let mut entity_mut = self.world.entity_mut(entity);
        let Some(mut from_scene) = entity_mut.get_mut::<FromScene>() else { return };
        if from_scene.0 == now {
            return;
        }
        let before = std::mem::replace(&mut from_scene.bypass_change_detection().0, now.clone());
        let gone: Vec<TypeId> = before.difference(&now).copied().collect();
        let came_along: Vec<TypeId> = gone.iter().flat_map(|type_id| self.required_by(*type_id)).collect();
        for type_id in gone {
            if self.is_required(type_id, &now)
                && let Some(default) = self.registry.get_type_data::<ReflectDefault>(type_id)
            {
                self.write(entity, type_id, default.default().as_ref());
            } else if let Some(component) = self.registry.get_type_data::<ReflectComponent>(type_id) {
                component.remove(&mut self.world.entity_mut(entity));
                self.changes.removed += 1;
            }
        }
        self.remove_left_over(entity, came_along.into_iter().filter(|type_id| !now.contains(type_id)));
    }

    /// Takes away what was there only because something that is gone required it: a world that reads the scene anew has none of it
    /// either.
    fn remove_left_over(&mut self, entity: Entity, came_along: impl Iterator<Item = TypeId>) {
        for type_id in came_along {
            let entity_ref = self.world.entity(entity);
            let held = entity_ref.archetype().iter_components().filter_map(|id| self.type_of(id)).collect();
            if let Some(id) = self.world.components().get_id(type_id)
                && entity_ref.contains_id(id)
                && !self.is_required(type_id, &held)
            {
                self.world.entity_mut(entity).remove_by_id(id);
                self.changes.removed += 1;
            }
        }
    }

    fn type_of(&self, id: ComponentId) -> Option<TypeId> {
        self.world.components().get_info(id)?.type_id()
    }

    /// The components that come along with this one.
    fn required_by(&self, type_id: TypeId) -> Vec<TypeId> {
        let components = self.world.components();
        let owner = components.get_id(type_id).and_then(|id| components.get_info(id));
        let required = owner.into_iter().flat_map(|owner| owner.required_components().iter_ids());
        required.filter_map(|id| self.type_of(id)).collect()
    }

    fn is_required(&self, type_id: TypeId, now: &HashSet<TypeId>) -> bool {
        let components = self.world.components();
        let Some(id) = components.get_id(type_id) else { return false };
        let owners = now
            .iter()
            .filter_map(|owner| components.get_id(*owner))
            .filter_map(|owner| components.get_info(owner));
        owners.into_iter().any(|owner| owner.required_components().iter_ids().any(|required| required == id))
    }
}

fn is_equal(a: &dyn Reflect, b: &dyn Reflect) -> bool {
    a.reflect_partial_eq(b.as_partial_reflect()) == Some(true)
}
