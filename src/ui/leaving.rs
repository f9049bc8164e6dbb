//! The question whether to save before the window is closed, or shows something else.

use super::Command;
use bevy_ecs::prelude::*;
use egui::{Id, Modal, Ui};
use std::path::PathBuf;

/// What a person wants to leave the scene for, and is asked what is to become of edits that are not saved.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) enum Leaving {
    /// Nothing.
    #[default]
    No,
    /// To close the window.
    ToClose,
    /// To show these files.
    ToOpen(Vec<PathBuf>),
}

impl Leaving {
    /// The end of the answers, and what they ask for: to save first, and not to.
    fn answers(self) -> Option<(&'static str, Command, Command)> {
        match self {
            Self::No => None,
            Self::ToClose => Some(("close", Command::SaveAndQuit, Command::Discard)),
            Self::ToOpen(files) => {
                Some(("open", Command::SaveAndOpen(files.clone()), Command::DiscardAndOpen(files)))
            }
        }
    }
}

pub(super) fn show(ui: &Ui, world: &mut World, commands: &mut Vec<Command>) {
    let Some((then, save, discard)) = world.get_resource_or_init::<Leaving>().clone().answers() else {
        return;
    };
    let modal = Modal::new(Id::unique("leaving")).show(ui.ctx(), |ui| {
        ui.heading("Save the changes of the scene?");
        ui.label("Its files do not have all of what is shown.");
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            let answers = [
                (format!("Save and {then}"), Some(save), "Write the changes to the files that they are of"),
                (
                    format!("Discard and {then}"),
                    Some(discard),
                    "Leave the files as they are; the changes are lost",
                ),
                ("Cancel".into(), None, "Keep the window as it is (Escape)"),
            ];
            let clicked =
                answers.into_iter().filter(|(name, _, tip)| ui.button(name).on_hover_text(*tip).clicked());
            clicked.last().map(|(_, command, _)| command)
        })
        .inner
    });
    if modal.inner.is_some() || modal.should_close() {
        world.insert_resource(Leaving::No);
    }
    commands.extend(modal.inner.flatten());
}
