//! Undo, redo, and saving.

use crate::scene::Edits;
use crate::ui::edit::{tell, with_edits};
use crate::ui::{Command, Level, Log, OpenPanels};
use bevy_ecs::prelude::World;

/// Does what concerns edits.
pub(super) fn obey(world: &mut World, command: &Command) {
    if matches!(command, Command::Undo | Command::Redo) {
        step(world, *command == Command::Undo);
    }
}

pub(super) fn is_unsaved(world: &World) -> bool {
    world.get_resource::<Edits>().is_some_and(Edits::is_unsaved)
}

fn step(world: &mut World, back: bool) {
    let done = with_edits(world, |edits, world| if back { edits.undo(world) } else { edits.redo(world) });
    if let Some(Err(error)) = done {
        tell(world, error.to_string());
    }
}

/// Whether all is saved.
pub(super) fn save(world: &mut World) -> bool {
    let Some(saved) = with_edits(world, |edits, world| edits.save(world)) else { return true };
    match saved {
        Ok(files) => {
            let log = world.get_resource_or_init::<Log>();
            files.iter().for_each(|file| log.tell(Level::Info, format!("saved {}", file.display())));
            true
        }
        Err(error) => {
            log::error!("{error}");
            world.get_resource_or_init::<Log>().tell(Level::Error, error.to_string());
            // It is not to be missed that something was not saved.
            world.get_resource_or_init::<OpenPanels>().log = true;
            false
        }
    }
}
