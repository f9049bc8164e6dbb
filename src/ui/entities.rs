//! The entities of the scene, their components, and what is wrong with them.

use super::log::{Level, colour};
use super::{Command, SceneProblems, Selection, problems};
use crate::scene::SceneEntities;
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use egui::collapsing_header::paint_default_icon;
use egui::{RichText, ScrollArea, Sense, TextStyle, Ui};
use std::collections::HashSet;

/// What the tree keeps from frame to frame.
#[derive(Resource, Clone, Debug, Default)]
struct Tree {
    filter: String,
    expanded: HashSet<Entity>,
}

/// A line of the tree.
enum Row {
    Scene,
    Entity(Entity, String),
    Component(Entity, &'static str),
}

pub(super) fn show(ui: &mut Ui, world: &mut World, commands: &mut Vec<Command>) {
    world.init_resource::<Selection>();
    world.init_resource::<SceneProblems>();
    let mut tree = world.get_resource_or_init::<Tree>().clone();
    ui.horizontal(|ui| {
        let label = ui.strong("Entities");
        let hint = "filter by name";
        ui.add(egui::TextEdit::singleline(&mut tree.filter).hint_text(hint).desired_width(f32::INFINITY))
            .labelled_by(label.id)
            .on_hover_text("Show entities whose name contains this");
    });
    let rows = rows(world, &tree);
    let height = ui.text_style_height(&TextStyle::Body).max(ui.spacing().interact_size.y);
    ScrollArea::vertical().auto_shrink(false).show_rows(ui, height, rows.len(), |ui, range| {
        for row in &rows[range] {
            line(ui, world, row, &mut tree, commands);
        }
    });
    world.insert_resource(tree);
}

/// All lines, those that are scrolled out of view included.
fn rows(world: &World, tree: &Tree) -> Vec<Row> {
    let Some(entities) = world.get_resource::<SceneEntities>() else { return vec![Row::Scene] };
    let filter = tree.filter.to_lowercase();
    let is_wanted =
        |(name, _): &(&String, &Entity)| filter.is_empty() || name.to_lowercase().contains(&filter);
    let mut found: Vec<_> = entities.0.iter().filter(is_wanted).collect();
    found.sort();
    let mut rows = vec![Row::Scene];
    for (name, &entity) in found {
        rows.push(Row::Entity(entity, name.clone()));
        if tree.expanded.contains(&entity) {
            rows.extend(components(world, entity).into_iter().map(|name| Row::Component(entity, name)));
        }
    }
    rows
}

/// The components that scenes can write, by name.
fn components(world: &World, entity: Entity) -> Vec<&'static str> {
    let (Some(registry), Ok(entity)) = (world.get_resource::<AppTypeRegistry>(), world.get_entity(entity))
    else {
        return Vec::new();
    };
    let registry = registry.read();
    let type_of = |id| world.components().get_info(id)?.type_id();
    let of_scenes = |id| {
        let registration = registry.get(type_of(id)?)?;
        registration.data::<ReflectComponent>()?;
        Some(registration.type_info().type_path_table().short_path())
    };
    let mut names: Vec<_> = entity.archetype().components().iter().copied().filter_map(of_scenes).collect();
    names.sort_unstable();
    names
}

fn line(ui: &mut Ui, world: &mut World, row: &Row, tree: &mut Tree, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| match row {
        Row::Scene => name(ui, world, None, "Scene"),
        Row::Entity(entity, text) => {
            let is_open = tree.expanded.contains(entity);
            let (_, response) =
                ui.allocate_exact_size(egui::Vec2::splat(ui.spacing().icon_width), Sense::click());
            paint_default_icon(ui, if is_open { 1.0 } else { 0.0 }, &response);
            let response = response.on_hover_text("Show or hide the components");
            let label = format!("components of {text}");
            response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_open, &label));
            if response.clicked() && !tree.expanded.remove(entity) {
                tree.expanded.insert(*entity);
            }
            name(ui, world, Some(*entity), text);
            if world.resource::<Selection>().0 == Some(*entity)
                && ui
                    .small_button("frame")
                    .on_hover_text("Bring this entity into the picture (Shift+F)")
                    .clicked()
            {
                commands.push(Command::Frame(Some(*entity)));
            }
        }
        Row::Component(entity, text) => {
            ui.add_space(ui.spacing().indent);
            if ui.selectable_label(false, RichText::new(*text).weak()).clicked() {
                world.insert_resource(Selection(Some(*entity)));
            }
        }
    });
}

/// The name of an entity, or of the whole scene; red where something is wrong with it.
fn name(ui: &mut Ui, world: &mut World, entity: Option<Entity>, text: &str) {
    let found = world.resource::<SceneProblems>();
    let level = found.level(entity);
    let (mark, told) = match level {
        Some(Level::Error) => ("! ", ", has errors"),
        Some(_) => ("i ", ", has notes"),
        None => ("", ""),
    };
    let mut written = RichText::new(format!("{mark}{text}"));
    if let Some(level) = level {
        written = written.color(colour(ui, level));
    }
    let is_selected = world.resource::<Selection>().0 == entity;
    let response = ui.selectable_label(is_selected, written);
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::Button, true, is_selected, format!("{text}{told}"))
    });
    if response.clicked() {
        world.insert_resource(Selection(entity));
    }
    if level.is_some() {
        response.on_hover_ui(|ui| problems::list(ui, world.resource::<SceneProblems>().of(entity)));
    }
}
