//! What keys do wherever the focus is; in a field of text, those that mean something there are left to it.

use super::shading::START;
use super::{Axis, Command, PictureFile, Selection};
use crate::view::Comparison;
use bevy_ecs::prelude::*;
use egui::{Context, Key, Modifiers};

pub(super) fn take(context: &Context, world: &mut World, commands: &mut Vec<Command>) {
    let pressed =
        |modifiers: Modifiers, key: Key| context.input_mut(|input| input.consume_key(modifiers, key));
    // Those with more modifiers first: without, others may be held.
    if pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::S) {
        commands.push(Command::AskSaveAs);
    }
    if pressed(Modifiers::COMMAND, Key::S) {
        commands.push(Command::Save);
    }
    if pressed(Modifiers::COMMAND, Key::O) {
        commands.push(Command::AskOpen);
    }
    if context.text_edit_focused() {
        return;
    }
    // Those with modifiers first: without, others may be held.
    if pressed(Modifiers::SHIFT, Key::F) {
        commands.push(Command::Frame(world.get_resource_or_init::<Selection>().0));
    }
    if pressed(Modifiers::SHIFT, Key::F12) {
        commands.push(Command::Screenshot(PictureFile::Exr));
    }
    let redo = [(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z), (Modifiers::COMMAND, Key::Y)];
    if redo.into_iter().any(|(modifiers, key)| pressed(modifiers, key)) {
        commands.push(Command::Redo);
    }
    if pressed(Modifiers::COMMAND, Key::Z) {
        commands.push(Command::Undo);
    }
    if pressed(Modifiers::COMMAND, Key::Q) {
        commands.push(Command::Quit);
    }
    if pressed(Modifiers::NONE, Key::F12) {
        commands.push(Command::Screenshot(PictureFile::Png));
    }
    let plain = [
        (Key::F, Command::Frame(None)),
        (Key::O, Command::ToggleProjection),
        (Key::Home, Command::ResetCamera),
    ];
    let axes = Axis::ALL.map(|(axis, _, key)| (key, Command::LookAlong(axis)));
    for (key, command) in plain.into_iter().chain(axes) {
        if pressed(Modifiers::NONE, key) {
            commands.push(command);
        }
    }
    if pressed(Modifiers::NONE, Key::C) {
        let mut comparison = world.get_resource_or_init::<Comparison>();
        comparison.0 = if comparison.0.is_some() { None } else { Some(START) };
    }
}
