//! Undo, redo, saving, and leaving with edits that are not saved.

use crate::scene::Edits;
use crate::ui::edit::{tell, with_edits};
use crate::ui::{Command, Leaving, Level, Log, OpenPanels};
use bevy_ecs::prelude::World;

/// Does what concerns edits, and says whether the window is to be closed.
pub(super) fn obey(world: &mut World, command: &Command) -> bool {
    match command {
        Command::Undo | Command::Redo => step(world, *command == Command::Undo),
        Command::Save => drop(save(world)),
        Command::SaveAndQuit => return save(world),
        Command::Quit => return may_quit(world),
        Command::Discard => return true,
        _ => {}
    }
    false
}

/// Whether nothing would be lost; else a person is asked.
pub(super) fn may_quit(world: &mut World) -> bool {
    let is_unsaved = is_unsaved(world);
    world.insert_resource(Leaving(is_unsaved));
    !is_unsaved
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
fn save(world: &mut World) -> bool {
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
