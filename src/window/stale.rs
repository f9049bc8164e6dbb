//! Whether the picture that is shown is still that of the scene.

use crate::changes::Seen;
use crate::view::{Coarseness, Comparison, FreeCamera, Picture};
use crate::{Refinement, SceneTime};
use bevy_ecs::prelude::*;

/// The scene of which the picture was drawn, and when.
///
/// Whoever changes something need not say so, be it of the scene or of what is asked of the picture.
#[derive(Debug, Default)]
pub(super) struct Drawn(Seen);

impl Drawn {
    /// Whether anything has changed since the picture was drawn.
    pub fn is_stale(&self, world: &World) -> bool {
        let asked = [
            Seen::has_other::<SceneTime>,
            Seen::has_other::<Picture>,
            Seen::has_other::<FreeCamera>,
            Seen::has_other::<Comparison>,
            Seen::has_other::<Coarseness>,
            Seen::has_other::<Refinement>,
        ];
        asked.iter().any(|has_other| has_other(&self.0, world)) || self.0.has_changed(world)
    }

    /// Takes what is there as drawn.
    pub fn take(&mut self, world: &mut World) {
        self.0.take(world);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TyndallPlugins;
    use crate::components::{Phong, SceneSettings, Shading, Transform};
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
