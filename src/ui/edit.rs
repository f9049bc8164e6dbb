//! What a person changes in panels goes into the scene: by its edits, where it has them, so that it can be undone and saved.

use super::{Edited, Level, Log};
use crate::components::Shading;
use crate::scene::{EditError, Edits, SceneEntities};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy_reflect::Reflect;

/// Changes a component of an entity, which is called as scenes call it. While the change is not finished, those of the same value are one step
/// to undo. An entity that is not of the scene, or whose world has no edits, is changed in the world alone.
pub(crate) fn edit(
    world: &mut World,
    entity: Entity,
    component: &str,
    edited: &Edited,
) -> Result<(), String> {
    let Some(name) = name_in_scene(world, entity) else { return in_world(world, entity, component, edited) };
    let done = with_edits(world, |edits, world| {
        if !edits.is_dragging() && !edited.finished {
            edits.begin_drag();
        }
        let done = in_scene(edits, world, (entity, &name), component, edited);
        if edited.finished {
            edits.end_drag();
        }
        done
    });
    done.unwrap_or(Ok(()))
}

/// Gives an entity a shading of its own, or takes it away.
pub(super) fn shade(world: &mut World, entity: Entity, shading: Option<Shading>) -> Result<(), String> {
    let Some(name) = name_in_scene(world, entity) else {
        match shading {
            Some(shading) => drop(world.entity_mut(entity).insert(shading)),
            None => drop(world.entity_mut(entity).remove::<Shading>()),
        }
        return Ok(());
    };
    let done = with_edits(world, |edits, world| match shading {
        Some(shading) if has(edits, &name, "Shading") => edits.set(world, &name, "Shading", &shading),
        Some(shading) => edits.add_component(world, &name, &shading),
        None => edits.remove_component(world, &name, "Shading"),
    });
    done.unwrap_or(Ok(())).map_err(|error| error.to_string())
}

/// Lets `change` work on the edits of the world's scene, if it has any.
pub(crate) fn with_edits<T>(
    world: &mut World,
    change: impl FnOnce(&mut Edits, &mut World) -> T,
) -> Option<T> {
    let has_edits = world.contains_resource::<Edits>();
    has_edits.then(|| world.resource_scope(|world, mut edits: Mut<Edits>| change(&mut edits, world)))
}

/// Tells that something could not be done.
pub(crate) fn tell(world: &mut World, error: impl Into<String>) {
    world.get_resource_or_init::<Log>().tell(Level::Warning, error);
}

/// What the scene calls an entity, if it is one that can be edited.
fn name_in_scene(world: &World, entity: Entity) -> Option<String> {
    let edits = world.get_resource::<Edits>()?;
    let name = world.get::<Name>(entity)?.as_str();
    let known = world.get_resource::<SceneEntities>()?.0.get(name)?;
    (*known == entity && edits.document().entity(name).is_some()).then(|| name.to_owned())
}

fn has(edits: &Edits, entity: &str, component: &str) -> bool {
    let written = edits.document().entity(entity);
    written.is_some_and(|written| written.components.iter().any(|found| found.name == component))
}

fn in_scene(
    edits: &mut Edits,
    world: &mut World,
    (entity, name): (Entity, &str),
    component: &str,
    edited: &Edited,
) -> Result<(), String> {
    let told = |error: EditError| error.to_string();
    if !has(edits, name, component) {
        // One that came along with another is written from now on.
        return match changed(world, entity, component, edited)? {
            Some(value) => edits.add_component(world, name, value.as_ref()).map_err(told),
            None => Ok(()),
        };
    }
    let path = match edited.path.as_str() {
        "" => component.to_owned(),
        path if path.starts_with('[') => format!("{component}{path}"),
        path => format!("{component}.{path}"),
    };
    edits.set(world, name, &path, edited.value.as_partial_reflect()).map_err(told)
}

fn in_world(world: &mut World, entity: Entity, component: &str, edited: &Edited) -> Result<(), String> {
    let Some(value) = changed(world, entity, component, edited)? else { return Ok(()) };
    let registry = world.get_resource_or_init::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let known =
        registry.get_with_short_type_path(component).and_then(|known| known.data::<ReflectComponent>());
    if let (Some(known), Ok(mut entity)) = (known, world.get_entity_mut(entity)) {
        known.insert(&mut entity, value.as_partial_reflect(), &registry);
    }
    Ok(())
}

/// A component of the world with the change made; none where it changes nothing.
fn changed(
    world: &mut World,
    entity: Entity,
    component: &str,
    edited: &Edited,
) -> Result<Option<Box<dyn Reflect>>, String> {
    let registry = world.get_resource_or_init::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let known =
        registry.get_with_short_type_path(component).and_then(|known| known.data::<ReflectComponent>());
    let known = known.ok_or_else(|| format!("there is no component `{component}`"))?;
    let entity = world.get_entity(entity).map_err(|error| error.to_string())?;
    let old = known.reflect(entity).ok_or_else(|| format!("the entity has no `{component}` any more"))?;
    let mut value = old.reflect_clone().map_err(|error| error.to_string())?;
    edited.apply(value.as_partial_reflect_mut()).map_err(|error| error.to_string())?;
    Ok((old.reflect_partial_eq(value.as_partial_reflect()) != Some(true)).then_some(value))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::TyndallPlugins;
    use crate::components::{Phong, Transform};
    use bevy_app::App;
    use glam::Vec3;

    const SCENE: &str = "(entities: { \"ball\": ( Mesh: Sphere(), Phong: (shininess: 5.0) ) })";

    /// An app with a scene that can be edited, its ball, and the scene's folder.
    fn editable() -> (App, Entity, tempfile::TempDir) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.ron");
        std::fs::write(&path, SCENE).unwrap();
        let mut app = App::new();
        app.add_plugins(TyndallPlugins);
        let edits = Edits::open(app.world_mut(), &path, &[]).unwrap();
        app.insert_resource(edits);
        let ball = app.world().resource::<SceneEntities>().0["ball"];
        (app, ball, folder)
    }

    fn edited(path: &str, value: impl Reflect, finished: bool) -> Edited {
        Edited { path: path.into(), value: Box::new(value), finished }
    }

    fn text(world: &mut World) -> String {
        let texts = with_edits(world, |edits, world| edits.preview(world)).unwrap().unwrap();
        texts.into_values().next().unwrap_or_else(|| SCENE.into())
    }

    #[test]
    fn a_gesture_is_one_step() {
        let (mut app, ball, _folder) = editable();
        let world = app.world_mut();
        edit(world, ball, "Phong", &edited("shininess", 6.0_f32, true)).unwrap();
        for value in [7.0_f32, 8.0, 9.0] {
            edit(world, ball, "Phong", &edited("shininess", value, false)).unwrap();
        }
        edit(world, ball, "Phong", &edited("shininess", 9.0_f32, true)).unwrap();
        assert_eq!(world.get::<Phong>(ball).unwrap().shininess, 9.0);
        edit(world, ball, "Phong", &edited("shininess", 10.0_f32, true)).unwrap();
        for before in [9.0, 6.0, 5.0] {
            with_edits(world, |edits, world| edits.undo(world)).unwrap().unwrap();
            assert_eq!(world.get::<Phong>(ball).unwrap().shininess, before);
        }
        assert!(!world.resource::<Edits>().is_unsaved());
    }

    #[test]
    fn what_came_along_is_written_once_it_is_changed() {
        let (mut app, ball, _folder) = editable();
        let world = app.world_mut();
        let origin = world.get::<Transform>(ball).unwrap().translation;
        edit(world, ball, "Transform", &edited("translation", origin, true)).unwrap();
        assert_eq!(text(world), SCENE, "nothing was changed");
        edit(world, ball, "Transform", &edited("translation", Vec3::X, true)).unwrap();
        assert_eq!(world.get::<Transform>(ball).unwrap().translation, Vec3::X);
        assert!(text(world).contains("Transform: (translation: (1.0, 0.0, 0.0))"), "{}", text(world));
    }

    #[test]
    fn an_edit_that_no_scene_can_have_changes_nothing() {
        let (mut app, ball, _folder) = editable();
        let world = app.world_mut();
        let error = edit(world, ball, "Phong", &edited("shininess", -1.0_f32, true)).unwrap_err();
        assert!(error.contains("-1"), "{error}");
        assert!(edit(world, ball, "Phong", &edited("hardness", 1.0_f32, true)).is_err());
        assert!(edit(world, ball, "Foam", &edited("", 1.0_f32, true)).is_err());
        assert_eq!(world.get::<Phong>(ball).unwrap().shininess, 5.0);
        assert_eq!(text(world), SCENE);
    }

    #[test]
    fn what_is_not_of_the_scene_is_changed_in_the_world() {
        let (mut app, ball, _folder) = editable();
        let world = app.world_mut();
        let own = world.spawn((Name::new("ball"), Phong::default())).id();
        edit(world, own, "Phong", &edited("shininess", 3.0_f32, true)).unwrap();
        assert_eq!(world.get::<Phong>(own).unwrap().shininess, 3.0);
        assert_eq!(world.get::<Phong>(ball).unwrap().shininess, 5.0);
        world.remove_resource::<Edits>();
        edit(world, ball, "Phong", &edited("shininess", 4.0_f32, false)).unwrap();
        assert_eq!(world.get::<Phong>(ball).unwrap().shininess, 4.0);
    }
}
