//! Whether anything of a scene has changed, whoever changed it.
//!
//! Change ticks tell of components that scenes can write, those of plugins too; how many there are of each tells of those that are gone.

use crate::components::SceneSettings;
use bevy_ecs::change_detection::Tick;
use bevy_ecs::component::ComponentId;
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use std::collections::BTreeMap;

/// A scene as it was at some time; at first as it never was.
#[derive(Debug, Default)]
pub(crate) struct Seen(Option<(Tick, Inventory)>);

/// How many entities have each component.
type Inventory = BTreeMap<ComponentId, usize>;

impl Seen {
    /// Takes the scene as it is. What is written from here on has a later tick.
    pub fn take(&mut self, world: &mut World) {
        let tick = world.increment_change_tick();
        self.0 = Some((tick, look(world, tick, tick).0));
    }

    /// Whether it is another now.
    pub fn has_changed(&self, world: &World) -> bool {
        let Some((seen, inventory)) = &self.0 else { return true };
        self.has_other::<SceneSettings>(world) || {
            let (found, changed) = look(world, *seen, world.read_change_tick());
            changed || found != *inventory
        }
    }

    /// Whether a resource has been written since.
    pub fn has_other<T: Resource>(&self, world: &World) -> bool {
        let Some((seen, _)) = &self.0 else { return true };
        let now = world.read_change_tick();
        world.get_resource_change_ticks::<T>().is_some_and(|ticks| ticks.changed.is_newer_than(*seen, now))
    }
}

/// Counts the components that scenes can write, and finds out whether any was written since.
fn look(world: &World, seen: Tick, now: Tick) -> (Inventory, bool) {
    let mut inventory = Inventory::new();
    let mut changed = false;
    let Some(registry) = world.get_resource::<AppTypeRegistry>() else { return (inventory, changed) };
    let registry = registry.read();
    let is_of_scenes = |id: &ComponentId| {
        let type_id = world.components().get_info(*id).and_then(|info| info.type_id());
        type_id.is_some_and(|id| registry.get_type_data::<ReflectComponent>(id).is_some())
    };
    for archetype in world.archetypes().iter().filter(|archetype| !archetype.is_empty()) {
        let components: Vec<ComponentId> =
            archetype.components().iter().copied().filter(is_of_scenes).collect();
        for id in &components {
            *inventory.entry(*id).or_default() += archetype.entities().len();
        }
        let was_written = |entity: Entity| {
            let Ok(entity) = world.get_entity(entity) else { return false };
            let ticks = |id: &ComponentId| entity.get_change_ticks_by_id(*id);
            components.iter().filter_map(ticks).any(|ticks| ticks.changed.is_newer_than(seen, now))
        };
        changed = changed || archetype.entities().iter().any(|entity| was_written(entity.id()));
    }
    (inventory, changed)
}
