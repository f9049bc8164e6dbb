//! A scene on which edits are tried out, in its file and by hand.

use crate::data;
use crate::files::Live;
use crate::seen::{Ran, Shown};
use crate::signs::{Lifted, Signs};
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy_reflect::TypeRegistry;
use std::any::TypeId;
use std::fs;
use std::path::Path;
use tyndall::LightTexels;
use tyndall::prelude::*;
use tyndall::render;
use tyndall::scene::{
    Override, Problem, Reload, SceneComponent, SceneDocument, SceneEntities, SceneEntity, Severity,
};

/// A scene that is shown, and its files.
pub struct Stage {
    live: Live,
    gpu: Gpu,
}

impl Stage {
    pub fn open(scene: &str) -> Self {
        Self::open_with(scene, &[])
    }

    /// With further files.
    pub fn open_with(scene: &str, files: &[(&'static str, String)]) -> Self {
        let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap();
        let files = [data::files(), files.to_vec(), vec![("scene.ron", scene.to_owned())]].concat();
        let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
        let mut stage = Self { live: Live::open_in(app(&gpu), &files, "scene.ron"), gpu };
        let is_error = |problem: &Problem| problem.severity == Severity::Error;
        assert!(!stage.live.problems().iter().any(is_error), "{:#?}", stage.live.messages());
        stage.ran();
        stage
    }

    /// The scene as its file says it, with other values in it.
    pub fn read(&self, edits: &[(&str, &str)]) -> SceneDocument {
        read(&self.live.app, &self.live.at("scene.ron"), edits)
    }

    /// The scene as another text says it.
    pub fn read_text(&self, scene: &str) -> SceneDocument {
        let path = self.live.at("other.ron");
        fs::write(&path, scene).unwrap();
        read(&self.live.app, &path, &[])
    }

    pub fn save(&mut self, scene: &str) -> Ran {
        self.save_as("scene.ron", scene)
    }

    /// Exchanges a file for another, and follows.
    pub fn save_as(&mut self, name: &str, text: &str) -> Ran {
        self.live.write("beside", text);
        fs::rename(self.live.at("beside"), self.live.at(name)).unwrap();
        match self.live.next() {
            Reload::Reloaded { .. } => self.ran(),
            other => panic!("{other:?}: {:#?}", self.live.messages()),
        }
    }

    /// Makes of the world, which is as one version of the scene, what another says, as systems would.
    pub fn write(&mut self, from: &SceneDocument, to: &SceneDocument) -> Ran {
        let world = self.world();
        for gone in from.entities.iter().filter(|entity| to.entity(&entity.name).is_none()) {
            let entity = world.resource_mut::<SceneEntities>().0.remove(&gone.name).unwrap();
            world.despawn(entity);
        }
        for entity in &to.entities {
            write_entity(world, from.entity(&entity.name), entity);
        }
        if from.settings != to.settings {
            *world.resource_mut::<SceneSettings>() = to.settings.clone();
        }
        self.frame()
    }

    /// Marks components, and the head of the scene, as written, which are as they are.
    pub fn touch(&mut self, components: &[(String, TypeId)]) -> Ran {
        let world = self.world();
        let registry = world.resource::<AppTypeRegistry>().clone();
        for (name, component) in components {
            let entity = world.resource::<SceneEntities>().0[name];
            let registry = registry.read();
            let reflected = registry.get_type_data::<ReflectComponent>(*component).unwrap();
            reflected.reflect_mut(world.entity_mut(entity)).unwrap().set_changed();
        }
        world.resource_mut::<SceneSettings>().set_changed();
        self.frame()
    }

    /// The same with every component that the scene has.
    pub fn touch_everything(&mut self) -> Ran {
        let document = self.read(&[]);
        let of_entity = |entity: &SceneEntity| {
            let components =
                entity.components.iter().map(|component| (entity.name.clone(), component.type_id));
            components.collect::<Vec<_>>()
        };
        self.touch(&document.entities.iter().flat_map(of_entity).collect::<Vec<_>>())
    }

    pub fn world(&mut self) -> &mut World {
        self.live.app.world_mut()
    }

    /// Draws a frame.
    pub fn frame(&mut self) -> Ran {
        self.live.app.update();
        self.ran()
    }

    /// What ran since this was last asked.
    fn ran(&mut self) -> Ran {
        Ran(std::mem::take(&mut self.world().resource_mut::<Report>().passes))
    }

    /// What is seen. Looking makes nothing again.
    pub fn shown(&mut self) -> Shown {
        let shown = Shown::of(&mut self.live.app);
        assert_eq!(self.ran().to_string(), "", "for looking");
        shown
    }

    /// What a program shows that starts with the files as they are.
    pub fn afresh(&self) -> Shown {
        let mut app = app(&self.gpu);
        app.add_plugins(TyndallPlugins);
        let document = render::load_scene(&mut app, &self.live.at("scene.ron"), &[]);
        assert!(!document.has_errors(), "{:#?}", document.problems);
        Shown::of(&mut app)
    }
}

/// An app that draws small pictures, before the framework is added.
fn app(gpu: &Gpu) -> App {
    let mut app = App::new();
    app.add_plugins(Signs).insert_resource(gpu.clone());
    app.insert_resource(Picture { size: UVec2::splat(32), camera: None, encoded: false });
    app.insert_resource(LightTexels(64));
    app
}

/// Makes of an entity, which is as one version of the scene, what another says.
fn write_entity(world: &mut World, from: Option<&SceneEntity>, to: &SceneEntity) {
    let registry = world.resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let known = world.resource::<SceneEntities>().0.get(&to.name).copied();
    let entity = known.unwrap_or_else(|| world.spawn(Name::new(to.name.clone())).id());
    world.resource_mut::<SceneEntities>().0.insert(to.name.clone(), entity);
    let mut entity = world.entity_mut(entity);
    let reflected = |component| registry.get_type_data::<ReflectComponent>(component).unwrap();
    for gone in from.into_iter().flat_map(|from| from.components.iter()) {
        if to.component(gone.type_id).is_none() {
            reflected(gone.type_id).remove(&mut entity);
            // What only this required goes with it, and what the others require does not.
            if gone.type_id == TypeId::of::<Lifted>() {
                entity.remove::<Motion>();
            }
            to.components.iter().for_each(|other| require(&mut entity, other, &registry));
        }
    }
    for component in to.components.iter() {
        let value = component.value.as_ref();
        if from.and_then(|from| from.component(component.type_id)).is_some_and(|from| is_equal(from, value)) {
            continue;
        }
        match reflected(component.type_id).reflect_mut(&mut entity) {
            Some(mut there) => there.set(value.reflect_clone().unwrap()).unwrap(),
            None => reflected(component.type_id).insert(&mut entity, value.as_partial_reflect(), &registry),
        }
    }
}

/// Has an entity hold what one of its components requires.
fn require(entity: &mut EntityWorldMut, component: &SceneComponent, registry: &TypeRegistry) {
    let components = entity.world().components();
    let id = components.get_id(component.type_id).unwrap();
    let required = components.get_info(id).unwrap().required_components().iter_ids();
    let types: Vec<TypeId> = required.filter_map(|id| components.get_info(id)?.type_id()).collect();
    for type_id in types {
        let Some(reflected) = registry.get_type_data::<ReflectComponent>(type_id) else { continue };
        if !reflected.contains(&*entity) {
            let default = registry.get_type_data::<ReflectDefault>(type_id).unwrap().default();
            reflected.insert(entity, default.as_partial_reflect(), registry);
        }
    }
}

fn is_equal(a: &dyn Reflect, b: &dyn Reflect) -> bool {
    a.reflect_partial_eq(b.as_partial_reflect()) == Some(true)
}

pub fn read(app: &App, path: &Path, edits: &[(&str, &str)]) -> SceneDocument {
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let edit = |(path, value): &(&str, &str)| Override { path: (*path).into(), value: (*value).into() };
    let overrides: Vec<Override> = edits.iter().map(edit).collect();
    let document = SceneDocument::load(path, &registry, &overrides);
    assert!(!document.has_errors(), "{edits:?}: {:#?}", document.problems);
    document
}

/// The text of a scene that is one file.
pub fn text(document: &SceneDocument) -> &str {
    document.entities[0].place.file.text()
}

/// The components in which two versions of a scene differ.
pub fn changed(before: &SceneDocument, after: &SceneDocument) -> Vec<(String, TypeId)> {
    let mut changed = Vec::new();
    for entity in &before.entities {
        for component in entity.components.iter() {
            let now = after.entity(&entity.name).and_then(|entity| entity.component(component.type_id));
            if now.is_some_and(|now| !is_equal(component.value.as_ref(), now)) {
                changed.push((entity.name.clone(), component.type_id));
            }
        }
    }
    changed
}
