//! Scattering on and off, for everything or for one entity, and two shadings side by side.

use super::edit::{shade, tell, with_edits};
use crate::components::{SceneSettings, Shading, Subsurface, VolumeLighting};
use crate::view::{Comparison, Split};
use bevy_ecs::prelude::*;
use egui::Ui;

pub(super) fn show(ui: &mut Ui, world: &mut World, selected: Option<Entity>) {
    of_everything(ui, world);
    if let Some(entity) = selected.filter(|entity| scatters(world, *entity)) {
        of_entity(ui, world, entity);
    }
    comparison(ui, world);
}

/// Whether an entity has a technique that can be switched off.
fn scatters(world: &World, entity: Entity) -> bool {
    world.get::<Subsurface>(entity).is_some()
        || world.get::<VolumeLighting>(entity).is_some_and(|lighting| *lighting != lighting.local())
}

/// The head of the scene.
fn of_everything(ui: &mut Ui, world: &mut World) {
    let now = world.get_resource_or_init::<SceneSettings>().shading;
    let mut on = now == Shading::Scattering;
    let text = "What entities without a `Shading` of their own do. Off, each takes the local model beside its scattering technique";
    if !ui.checkbox(&mut on, "Scattering in the scene").on_hover_text(text).changed() {
        return;
    }
    let shading = if on { Shading::Scattering } else { Shading::Local };
    match with_edits(world, |edits, world| edits.set_setting(world, "shading", &shading)) {
        Some(Ok(())) => {}
        Some(Err(error)) => tell(world, error.to_string()),
        None => world.resource_mut::<SceneSettings>().shading = shading,
    }
}

fn of_entity(ui: &mut Ui, world: &mut World, entity: Entity) {
    let now = world.get::<Shading>(entity).copied();
    let mut wanted = now;
    ui.horizontal(|ui| {
        ui.label("This entity:");
        ui.selectable_value(&mut wanted, None, "as the scene")
            .on_hover_text("Take the `Shading` of the scene's head");
        ui.selectable_value(&mut wanted, Some(Shading::Scattering), "scattering")
            .on_hover_text("`Shading: Scattering`, whatever the scene's head says");
        ui.selectable_value(&mut wanted, Some(Shading::Local), "local")
            .on_hover_text("`Shading: Local`, whatever the scene's head says");
    });
    if wanted != now
        && let Err(error) = shade(world, entity, wanted)
    {
        tell(world, error);
    }
}

/// Switches the comparison, and what it compares.
fn comparison(ui: &mut Ui, world: &mut World) {
    let mut comparison = world.get_resource_or_init::<Comparison>();
    let mut split = comparison.0;
    let mut on = split.is_some();
    let text = "Split the picture: scattering on one side of a line that can be dragged, local models on the other (C)";
    if ui.checkbox(&mut on, "Compare with local shading").on_hover_text(text).changed() {
        split = on.then_some(START);
    }
    if let Some(split) = &mut split {
        ui.horizontal(|ui| {
            ui.label(format!("{} | {}", name(split.left), name(split.right)));
            if ui.small_button("Swap").on_hover_text("Exchange the sides").clicked() {
                std::mem::swap(&mut split.left, &mut split.right);
            }
        });
    }
    comparison.set_if_neq(Comparison(split));
}

/// Scattering left and local models right of the middle.
pub(super) const START: Split = Split { at: 0.5, left: Shading::Scattering, right: Shading::Local };

/// What a side shows, for people.
pub(super) fn name(shading: Shading) -> &'static str {
    match shading {
        Shading::Scattering => "as the scene says",
        Shading::Local => "local",
    }
}
