//! The question what is to become of edits that an earlier run of the program could not save.

use super::Command;
use crate::plain;
use crate::scene::Edits;
use bevy_ecs::prelude::*;
use egui::{Id, Modal, Ui};
use std::path::PathBuf;

/// Versions of the scene's files with edits that an earlier run could not save: the file, and where the version is kept.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub struct Recovered(pub Vec<(PathBuf, PathBuf)>);

/// Versions that are named; of more, how many they are.
const NAMED: usize = 3;

pub(super) fn show(ui: &Ui, world: &mut World, commands: &mut Vec<Command>) {
    let recovered = world.get_resource_or_init::<Recovered>().clone();
    if recovered.0.is_empty() || !world.contains_resource::<Edits>() {
        return;
    }
    let modal = Modal::new(Id::unique("recovered")).show(ui.ctx(), |ui| {
        ui.heading("Take back edits that were not saved?");
        ui.label("The program ended before these could be saved:");
        for (_, kept) in recovered.0.iter().take(NAMED) {
            ui.weak(plain::line(&kept.display().to_string()));
        }
        if let Some(more @ 1..) = recovered.0.len().checked_sub(NAMED) {
            ui.weak(format!("and {more} more"));
        }
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            let answers = [
                ("Take back", Some(Command::Recover), "Show the scene with them, not saved yet"),
                ("Delete", Some(Command::ForgetRecovered), "The edits are lost for good"),
                (
                    "Later",
                    None,
                    "Leave the files; they are offered again when the scene is opened again (Escape)",
                ),
            ];
            let clicked =
                answers.into_iter().filter(|(name, _, tip)| ui.button(*name).on_hover_text(*tip).clicked());
            clicked.last().map(|(_, command, _)| command)
        })
        .inner
    });
    if modal.inner == Some(None) || modal.should_close() {
        world.insert_resource(Recovered::default());
    }
    commands.extend(modal.inner.flatten());
}
