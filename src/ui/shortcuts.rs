//! What keys do wherever the focus is, except in a field of text.

use super::shading::START;
use super::{Axis, Command, PictureFile, Selection};
use crate::view::Comparison;
use bevy_ecs::prelude::*;
use egui::{Context, Key, Modifiers};

pub(super) fn take(context: &Context, world: &mut World, commands: &mut Vec<Command>) {
    if context.text_edit_focused() {
        return;
    }
    let pressed =
        |modifiers: Modifiers, key: Key| context.input_mut(|input| input.consume_key(modifiers, key));
    // Those with modifiers first: without, others may be held.
    if pressed(Modifiers::SHIFT, Key::F) {
        commands.push(Command::Frame(world.get_resource_or_init::<Selection>().0));
    }
    if pressed(Modifiers::SHIFT, Key::F12) {
        commands.push(Command::Screenshot(PictureFile::Exr));
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
