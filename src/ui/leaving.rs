//! The question whether to save before the window is closed.

use super::Command;
use bevy_ecs::prelude::*;
use egui::{Id, Modal, Ui};

/// Whether a person wants to close the window, and is asked what is to become of edits that are not saved.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Leaving(pub bool);

pub(super) fn show(ui: &Ui, world: &mut World, commands: &mut Vec<Command>) {
    if !world.get_resource_or_init::<Leaving>().0 {
        return;
    }
    let modal = Modal::new(Id::unique("leaving")).show(ui.ctx(), |ui| {
        ui.heading("Save the changes of the scene?");
        ui.label("Its files do not have all of what is shown.");
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            let answers = [
                (
                    "Save and close",
                    Some(Command::SaveAndQuit),
                    "Write the changes to the files that they are of",
                ),
                (
                    "Discard and close",
                    Some(Command::Discard),
                    "Leave the files as they are; the changes are lost",
                ),
                ("Cancel", None, "Keep the window open (Escape)"),
            ];
            let clicked =
                answers.into_iter().filter(|(name, _, tip)| ui.button(*name).on_hover_text(*tip).clicked());
            clicked.last().map(|(_, command, _)| command)
        })
        .inner
    });
    if modal.inner.is_some() || modal.should_close() {
        world.insert_resource(Leaving(false));
    }
    commands.extend(modal.inner.flatten());
}
