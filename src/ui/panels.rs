//! Where everything stands.

use super::{
    Command, OpenPanels, Shown, conflicts, entities, leaving, log, opening, picture, recovered, report,
    sections, shortcuts, status, toolbar,
};
use bevy_ecs::prelude::*;
use egui::{CentralPanel, Panel, Rect, Ui};

/// What came of laying out the panels.
#[derive(Clone, Debug)]
pub struct Laid {
    /// Where the picture is shown, in points.
    pub picture: Rect,
    /// What was asked for.
    pub commands: Vec<Command>,
}

/// Lays out the whole window: panels around the picture. Changes the world as a person changes it there.
pub fn panels(ui: &mut Ui, world: &mut World, shown: &Shown) -> Laid {
    let mut commands = Vec::new();
    shortcuts::take(ui.ctx(), world, &mut commands);
    Panel::top("toolbar").show(ui, |ui| toolbar::show(ui, world, shown, &mut commands));
    conflicts::show(ui, world);
    Panel::bottom("status").show(ui, |ui| status::show(ui, world, shown));
    let mut open = *world.get_resource_or_init::<OpenPanels>();
    Panel::bottom("log")
        .resizable(true)
        .default_size(120.0)
        .show_collapsible(ui, &mut open.log, |ui| log::show(ui, world));
    Panel::bottom("report").resizable(true).default_size(200.0).show_collapsible(
        ui,
        &mut open.report,
        |ui| report::show(ui, world, &mut commands),
    );
    Panel::left("entities").resizable(true).default_size(190.0).show_collapsible(
        ui,
        &mut open.entities,
        |ui| entities::show(ui, world, &mut commands),
    );
    Panel::right("inspector").resizable(true).default_size(360.0).show_collapsible(
        ui,
        &mut open.inspector,
        |ui| sections::show(ui, world),
    );
    world.get_resource_or_init::<OpenPanels>().set_if_neq(open);
    let centre =
        CentralPanel::no_frame().show(ui, |ui| picture::show(ui, world, shown, open.axes, &mut commands));
    opening::show(ui, world, &mut commands);
    recovered::show(ui, world, &mut commands);
    leaving::show(ui, world, &mut commands);
    Laid { picture: centre.inner, commands }
}
