//! The bar above everything.

use super::shading::START;
use super::{Axis, Command, OpenPanels, PictureFile, Shown};
use crate::scene::Edits;
use crate::view::Comparison;
use bevy_ecs::prelude::*;
use egui::Ui;

pub(super) fn show(ui: &mut Ui, world: &mut World, shown: &Shown, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        let open = ui.button("Open…").on_hover_text(
            "Show a scene, a mesh, a volume or a folder of slices (Ctrl+O, or drop files on the window)",
        );
        if open.clicked() {
            commands.push(Command::AskOpen);
        }
        ui.separator();
        camera(ui, shown, commands);
        ui.separator();
        edits(ui, world, shown, commands);
        compare(ui, world);
        ui.separator();
        ui.menu_button("Screenshot", |ui| {
            let kinds = [
                (PictureFile::Png, "PNG", "As it is shown, exposed and encoded (F12)"),
                (PictureFile::Exr, "EXR", "Linear radiance (Shift+F12)"),
            ];
            for (kind, name, tip) in kinds {
                if ui.button(name).on_hover_text(tip).clicked() {
                    commands.push(Command::Screenshot(kind));
                    ui.close();
                }
            }
        });
        ui.separator();
        let mut open = *world.get_resource_or_init::<OpenPanels>();
        ui.toggle_value(&mut open.entities, "Entities")
            .on_hover_text("Entities of the scene, and what is wrong with them");
        ui.toggle_value(&mut open.inspector, "Inspector").on_hover_text("What concerns the selected entity");
        ui.toggle_value(&mut open.report, "Report")
            .on_hover_text("Passes, times and memory of the last picture");
        ui.toggle_value(&mut open.log, "Log").on_hover_text("What was told since the window opened");
        world.get_resource_or_init::<OpenPanels>().set_if_neq(open);
    });
}

fn camera(ui: &mut Ui, shown: &Shown, commands: &mut Vec<Command>) {
    if ui
        .button("Frame all")
        .on_hover_text("Bring everything into the picture (F, or a double click)")
        .clicked()
    {
        commands.push(Command::Frame(None));
    }
    let mut is_orthographic = shown.is_orthographic;
    let tip = "Parallel rays; what the camera turns about keeps its size (O)";
    if ui.toggle_value(&mut is_orthographic, "Orthographic").on_hover_text(tip).changed() {
        commands.push(Command::ToggleProjection);
    }
    ui.menu_button("View from", |ui| {
        for (number, (axis, name, _)) in Axis::ALL.into_iter().enumerate() {
            if ui.button(name).on_hover_text(format!("Look along this axis ({})", number + 1)).clicked() {
                commands.push(Command::LookAlong(axis));
                ui.close();
            }
        }
    });
    let reset = ui.add_enabled(shown.is_free, egui::Button::new("Scene's camera"));
    if reset.on_hover_text("Go back to the camera that the scene says (Home)").clicked() {
        commands.push(Command::ResetCamera);
    }
}

/// What can be done with edits, where the scene can be edited.
fn edits(ui: &mut Ui, world: &World, shown: &Shown, commands: &mut Vec<Command>) {
    let Some(edits) = world.get_resource::<Edits>() else { return };
    let steps = [
        ("Undo", edits.next_undo(), Command::Undo, "Take back the change of", "Ctrl+Z"),
        ("Redo", edits.next_redo(), Command::Redo, "Make again the change of", "Ctrl+Shift+Z or Ctrl+Y"),
    ];
    for (name, step, command, what, keys) in steps {
        let button = ui.add_enabled(step.is_some(), egui::Button::new(name));
        let subject = step.unwrap_or_default();
        let button = button.on_hover_text(format!("{what} {subject} ({keys})"));
        if button.on_disabled_hover_text(format!("Nothing to {} ({keys})", name.to_lowercase())).clicked() {
            commands.push(command);
        }
    }
    let is_unsaved = edits.is_unsaved() || shown.is_untitled;
    let save = ui.add_enabled(is_unsaved, egui::Button::new("Save"));
    let save = save.on_hover_text(
        "Write what was changed to the files that it came from; the rest of them stays as it is (Ctrl+S)",
    );
    if save.on_disabled_hover_text("All is saved (Ctrl+S)").clicked() {
        commands.push(Command::Save);
    }
    let save_as = ui.button("Save as…");
    if save_as
        .on_hover_text("Write the scene into another file, and go on with that (Ctrl+Shift+S)")
        .clicked()
    {
        commands.push(Command::AskSaveAs);
    }
    if is_unsaved {
        let tip = match shown.is_untitled {
            true => "The scene is in no file yet",
            false => "The scene is shown with changes that its files do not have yet",
        };
        ui.weak("not saved").on_hover_text(tip);
    }
    ui.separator();
}

fn compare(ui: &mut Ui, world: &mut World) {
    let mut comparison = world.get_resource_or_init::<Comparison>();
    let mut on = comparison.0.is_some();
    let tip = "Scattering on one side of a line that can be dragged, local models on the other (C)";
    if ui.toggle_value(&mut on, "Compare").on_hover_text(tip).changed() {
        comparison.0 = on.then_some(START);
    }
}
