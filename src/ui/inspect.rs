//! The components of the selected entity, to be changed.

use super::edit::{edit, tell};
use super::{
    Edited, InspectorContext, TransferFunctionData, TransferFunctionEditor, inspect, light_direction,
};
use crate::components::{DirectionalLight, TransferFunction};
use crate::loading::LoadedVolume;
use crate::view::View;
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy_reflect::{Reflect, TypeRegistry};
use egui::Ui;
use glam::Quat;
use std::collections::HashMap;
use std::path::PathBuf;

/// The folder of the scene: where paths start that have none, and beside which transfer functions to choose from are.
#[derive(Resource, Clone, Debug, Default)]
pub struct SceneFolder(pub PathBuf);

/// What the editors of transfer functions remember, for each entity.
#[derive(Resource, Debug, Default)]
struct Editors {
    of: HashMap<Entity, TransferFunctionEditor>,
    presets: Option<Vec<PathBuf>>,
}

/// What was changed, by the name of its component.
type Changes = Vec<(String, Vec<Edited>)>;

pub(super) fn show(ui: &mut Ui, world: &mut World, selected: Option<Entity>) {
    let Some(entity) = selected else {
        ui.weak("Select an entity to see its components.");
        return;
    };
    let registry = world.get_resource_or_init::<AppTypeRegistry>().clone();
    let mut editors = std::mem::take(&mut *world.get_resource_or_init::<Editors>());
    let changes = components(ui, world, entity, &registry.read(), &mut editors);
    world.insert_resource(editors);
    for (component, edits) in changes {
        apply(world, entity, &component, &edits);
    }
}

fn components(
    ui: &mut Ui,
    world: &World,
    entity: Entity,
    registry: &TypeRegistry,
    editors: &mut Editors,
) -> Changes {
    let name = world.get::<Name>(entity).map_or("entity", Name::as_str).to_owned();
    let folder = world.get_resource::<SceneFolder>().cloned().unwrap_or_default().0;
    let entities_with = |component: &str| names_with(world, registry, component);
    let turned = world.get_resource::<View>().map_or(Quat::IDENTITY, turned);
    let context = InspectorContext { entities_with: &entities_with, folder: &folder, eye_from_scene: turned };
    let mut changes = Changes::new();
    for (written, component) in of_entity(world, entity, registry) {
        if let Some(light) = component.downcast_ref::<DirectionalLight>()
            && let Some(turned) =
                light_direction(ui, &format!("direction of {name}"), light.direction, turned)
        {
            let value = Box::new(turned.direction);
            let turned = Edited { path: "direction".into(), value, finished: turned.finished };
            changes.push((written.to_owned(), vec![turned]));
        }
        let edits = match component.downcast_ref::<TransferFunction>() {
            Some(function) => transfer_function(ui, world, entity, (&name, function), registry, editors),
            None => inspect(ui, &name, component, registry, &context),
        };
        changes.push((written.to_owned(), edits));
    }
    changes
}

fn transfer_function(
    ui: &mut Ui,
    world: &World,
    entity: Entity,
    (name, function): (&str, &TransferFunction),
    registry: &TypeRegistry,
    editors: &mut Editors,
) -> Vec<Edited> {
    let folder = world.get_resource::<SceneFolder>().cloned().unwrap_or_default().0;
    let volume = world.get::<LoadedVolume>(entity);
    let presets = editors.presets.get_or_insert_with(|| files_in(folder.join("transfer_functions")));
    let data = TransferFunctionData {
        domain: volume.map_or((0.0, 1.0), |volume| volume.domain(function)),
        histogram: volume.map(|volume| &volume.data.histogram),
        registry,
        folder: &folder,
        presets,
    };
    let editor = editors.of.entry(entity).or_default();
    // What a preset makes, or labels that nobody wrote down, is shown; whoever changes it has a function of their own from then on.
    let in_force = match volume {
        Some(volume) => volume.function_in_force(function),
        None => function.in_force(None, data.domain),
    };
    if in_force == *function {
        return editor.show(ui, name, function, &data);
    }
    let edits = editor.show(ui, name, &in_force, &data);
    let Some(last) = edits.last() else { return edits };
    let (mut own, finished) = (in_force, last.finished);
    match edits.iter().try_for_each(|edited| edited.apply(&mut own)) {
        Ok(()) => vec![Edited { path: String::new(), value: Box::new(own), finished }],
        Err(_) => edits,
    }
}

/// The RON files of a folder, by name; none where there is no such folder.
fn files_in(folder: PathBuf) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    files.retain(|path| path.extension().is_some_and(|ending| ending == "ron"));
    files.sort();
    files
}

/// How the view is turned.
fn turned(view: &View) -> Quat {
    let matrix = view.eye_from_scene.matrix3;
    let scale = matrix.x_axis.length().max(f64::MIN_POSITIVE);
    glam::DQuat::from_mat3(&(matrix * scale.recip())).as_quat()
}

/// The components of an entity that scenes can write, in the order of their names.
fn of_entity<'w>(
    world: &'w World,
    entity: Entity,
    registry: &'w TypeRegistry,
) -> Vec<(&'w str, &'w dyn Reflect)> {
    let Ok(entity) = world.get_entity(entity) else { return Vec::new() };
    let mut all: Vec<(&str, &dyn Reflect)> = Vec::new();
    for registration in registry.iter() {
        let Some(component) = registration.data::<ReflectComponent>() else { continue };
        if let Some(value) = component.reflect(entity) {
            let name = registration.type_info().type_path_table().short_path();
            all.push((name, value));
        }
    }
    all.sort_by_key(|(name, _)| *name);
    all
}

/// The names of the entities that have a component.
fn names_with(world: &World, registry: &TypeRegistry, component: &str) -> Vec<String> {
    let registration = registry.get_with_short_type_path(component);
    let Some(component) = registration.and_then(|found| found.data::<ReflectComponent>()) else {
        return Vec::new();
    };
    let Some(mut names) = world.try_query::<(EntityRef, &Name)>() else { return Vec::new() };
    let having = names.iter(world).filter(|(entity, _)| component.reflect(*entity).is_some());
    let mut found: Vec<String> = having.map(|(_, name)| name.as_str().to_owned()).collect();
    found.sort();
    found
}

/// Makes what was changed edits of the scene.
fn apply(world: &mut World, entity: Entity, component: &str, edits: &[Edited]) {
    for edited in edits {
        if let Err(error) = edit(world, entity, component, edited) {
            tell(world, error);
        }
    }
}
