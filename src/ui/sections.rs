//! What the window shows of the selected entity.

use super::{Selection, inspect, problems, shading};
use bevy_ecs::prelude::*;
use egui::{CollapsingHeader, ScrollArea, Ui};

/// A part of the right panel.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// What stands above it.
    pub title: &'static str,
    /// Draws it for the selected entity, or for none, and changes what a person changes.
    pub show: fn(&mut Ui, &mut World, Option<Entity>),
}

/// The parts of the right panel, from top to bottom. A plugin adds one with
/// `world.get_resource_or_init::<Sections>().0.push(…)`.
#[derive(Resource, Clone, Debug)]
pub struct Sections(pub Vec<Section>);

impl Default for Sections {
    fn default() -> Self {
        Self(vec![
            Section { title: "Components", show: inspect::show },
            Section { title: "Scattering", show: shading::show },
        ])
    }
}

pub(super) fn show(ui: &mut Ui, world: &mut World) {
    let selected =
        world.get_resource_or_init::<Selection>().0.filter(|entity| world.get_entity(*entity).is_ok());
    let sections = world.get_resource_or_init::<Sections>().0.clone();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        match selected.and_then(|entity| world.get::<Name>(entity)) {
            Some(name) => ui.heading(name.as_str()),
            None => ui.heading("Scene"),
        };
        world.init_resource::<problems::SceneProblems>();
        problems::list(ui, world.resource::<problems::SceneProblems>().of(selected));
        for section in sections {
            CollapsingHeader::new(section.title)
                .default_open(true)
                .show(ui, |ui| (section.show)(ui, world, selected));
        }
    });
}
