//! Undo, redo, and saving.

use super::recovery;
use crate::scene::Edits;
use crate::ui::edit::{tell, with_edits};
use crate::ui::{Command, Level, Log, OpenPanels, Recovered};
use bevy_ecs::prelude::{Resource, World};

/// Does what concerns edits.
pub(super) fn obey(world: &mut World, command: &Command) {
    match command {
        Command::Undo | Command::Redo => step(world, *command == Command::Undo),
        Command::Recover => take_back(world),
        Command::ForgetRecovered => {
            if let Some(recovered) = world.remove_resource::<Recovered>() {
                recovery::remove(&recovered);
            }
        }
        _ => {}
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
            forget_taken(world);
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

/// Edits of an earlier run that were taken back, until they are saved: another run may need them once more.
#[derive(Resource, Default)]
struct Taken(Recovered);

/// Shows the scene with edits that an earlier run could not save.
fn take_back(world: &mut World) {
    let Some(recovered) = world.remove_resource::<Recovered>() else { return };
    let taken = recovery::read(&recovered).and_then(|texts| {
        let taken = with_edits(world, |edits, world| edits.take_back(world, texts));
        taken.unwrap_or(Ok(())).map_err(|error| error.to_string())
    });
    match taken {
        Ok(()) => {
            let log = world.get_resource_or_init::<Log>();
            log.tell(Level::Info, "edits that were not saved are back; they are still to be saved");
            world.insert_resource(Taken(recovered));
        }
        Err(error) => tell(world, format!("the edits cannot be taken back, and their files stay: {error}")),
    }
}

/// Takes away the files of edits that are saved now, or not wanted.
pub(super) fn forget_taken(world: &mut World) {
    if let Some(Taken(recovered)) = world.remove_resource::<Taken>() {
        recovery::remove(&recovered);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TyndallPlugins;
    use bevy_app::App;

    #[test]
    fn edits_are_taken_back_and_their_files_go_when_they_are_saved() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(
            at("scene.ron"),
            "(entities: {\"a\": (Mesh: Sphere(radius: 1.0)), \"b\": (Mesh: Box(), Phong: ())})",
        )
        .unwrap();
        // Changed, renamed or added, taken away.
        let kept =
            "(entities: {\"a\": (Mesh: Sphere(radius: 2.0)), \"b\": (Mesh: Box()), \"c\": (Mesh: Plane())})";
        std::fs::write(at("scene.recovered.ron"), kept).unwrap();
        let mut app = App::new();
        app.add_plugins(TyndallPlugins);
        let world = app.world_mut();
        let edits = Edits::open(world, &at("scene.ron"), &[]).unwrap();
        world.insert_resource(edits);
        world.insert_resource(recovery::find([at("scene.ron").as_path()]));
        obey(world, &Command::Recover);
        assert!(is_unsaved(world) && at("scene.recovered.ron").exists());
        assert!(save(world), "{:?}", world.resource::<Log>().lines());
        assert!(!is_unsaved(world) && !at("scene.recovered.ron").exists());
        let saved = std::fs::read_to_string(at("scene.ron")).unwrap();
        for part in ["radius: 2.0", "\"c\": ", "Plane"] {
            assert!(saved.contains(part), "{part}: {saved}");
        }
        assert!(!saved.contains("Phong"), "{saved}");
    }

    #[test]
    fn edits_that_make_no_scene_are_told_of_and_stay() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("scene.ron"), "(entities: {\"a\": (Mesh: Sphere())})").unwrap();
        std::fs::write(at("scene.recovered.ron"), "(entities: {\"a\": (Mesh: Sphere(").unwrap();
        let mut app = App::new();
        app.add_plugins(TyndallPlugins);
        let world = app.world_mut();
        let edits = Edits::open(world, &at("scene.ron"), &[]).unwrap();
        world.insert_resource(edits);
        world.insert_resource(recovery::find([at("scene.ron").as_path()]));
        obey(world, &Command::Recover);
        assert!(!is_unsaved(world) && at("scene.recovered.ron").exists());
        assert!(world.resource::<Log>().lines()[0].text.contains("cannot be taken back"));
    }
}
