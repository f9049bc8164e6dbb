//! Whether the picture that is shown is still that of the scene.

use crate::components::SceneSettings;
use crate::view::{Coarseness, Comparison, FreeCamera, Picture};
use crate::{Refinement, SceneTime};
use bevy_ecs::change_detection::Tick;
use bevy_ecs::component::ComponentId;
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use std::collections::BTreeMap;

/// When the picture was drawn, and of what.
///
/// Whoever changes something need not say so: change ticks tell of components that scenes can write, those of plugins too, and of what is
/// asked of the picture; how many there are of each tells of those that are gone.
#[derive(Debug, Default)]
pub(super) struct Drawn(Option<(Tick, Inventory)>);

/// How many entities have each component.
type Inventory = BTreeMap<ComponentId, usize>;

impl Drawn {
    /// Whether anything has changed since the picture was drawn.
    pub fn is_stale(&self, world: &World) -> bool {
        let Some((drawn, inventory)) = &self.0 else { return true };
        let now = world.read_change_tick();
        resources_changed(world, *drawn, now) || {
            let (found, changed) = look(world, *drawn, now);
            changed || found != *inventory
        }
    }

    /// Takes what is there as drawn.
    pub fn take(&mut self, world: &mut World) {
        // What is written from here on has a later tick.
        let tick = world.increment_change_tick();
        self.0 = Some((tick, look(world, tick, tick).0));
    }
}

fn resources_changed(world: &World, drawn: Tick, now: Tick) -> bool {
    [
        world.get_resource_change_ticks::<SceneSettings>(),
        world.get_resource_change_ticks::<SceneTime>(),
        world.get_resource_change_ticks::<Picture>(),
        world.get_resource_change_ticks::<FreeCamera>(),
        world.get_resource_change_ticks::<Comparison>(),
        world.get_resource_change_ticks::<Coarseness>(),
        world.get_resource_change_ticks::<Refinement>(),
    ]
    .into_iter()
    .flatten()
    .any(|ticks| ticks.changed.is_newer_than(drawn, now))
}

/// Counts the components that scenes can write, and finds out whether any was written since.
fn look(world: &World, drawn: Tick, now: Tick) -> (Inventory, bool) {
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
            components.iter().filter_map(ticks).any(|ticks| ticks.changed.is_newer_than(drawn, now))
        };
        changed = changed || archetype.entities().iter().any(|entity| was_written(entity.id()));
    }
    (inventory, changed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TyndallPlugins;
    use crate::components::{Phong, Shading, Transform};
    use bevy_app::App;

    /// A world with two entities, as drawn.
    fn drawn() -> (App, Entity, Drawn) {
        let mut app = App::new();
        app.add_plugins(TyndallPlugins);
        let entity = app.world_mut().spawn((Transform::default(), Phong::default())).id();
        app.world_mut().spawn(Transform::default());
        app.update();
        let mut drawn = Drawn::default();
        assert!(drawn.is_stale(app.world()));
        drawn.take(app.world_mut());
        assert!(!drawn.is_stale(app.world()));
        (app, entity, drawn)
    }

    #[test]
    fn updates_that_find_nothing_to_do_change_nothing() {
        let (mut app, _, drawn) = drawn();
        for _ in 0..3 {
            app.update();
            assert!(!drawn.is_stale(app.world()));
        }
    }

    #[test]
    fn any_edit_is_noticed_until_it_is_drawn() {
        type Edit = fn(&mut World, Entity);
        let edits: [(&str, Edit); 8] = [
            ("field", |world, entity| world.get_mut::<Phong>(entity).unwrap().shininess = 3.0),
            ("insert", |world, entity| _ = world.entity_mut(entity).insert(Shading::Local)),
            ("remove", |world, entity| _ = world.entity_mut(entity).remove::<Phong>()),
            ("spawn", |world, _| _ = world.spawn(Transform::default())),
            ("despawn", |world, entity| _ = world.despawn(entity)),
            ("head", |world, _| world.resource_mut::<SceneSettings>().shading = Shading::Local),
            ("camera", |world, _| {
                let viewpoint = crate::view::View::default().viewpoint;
                world.insert_resource(FreeCamera(Some(viewpoint)));
            }),
            ("size", |world, _| world.resource_mut::<Picture>().size.x += 1),
        ];
        for (what, edit) in edits {
            let (mut app, entity, mut drawn) = drawn();
            edit(app.world_mut(), entity);
            assert!(drawn.is_stale(app.world()), "{what}");
            app.update();
            assert!(drawn.is_stale(app.world()), "{what}: an update alone is no picture");
            drawn.take(app.world_mut());
            assert!(!drawn.is_stale(app.world()), "{what}");
        }
    }

    #[test]
    fn what_no_scene_can_write_does_not_count() {
        #[derive(Component)]
        struct Own;
        let (mut app, entity, drawn) = drawn();
        app.world_mut().entity_mut(entity).insert(Own);
        assert!(!drawn.is_stale(app.world()));
    }
}
