//! Whether results can be written, found out before there are any.

use super::arguments::RenderArguments;
use super::exit::Failure;
use super::output::Output;
use crate::loading::FilesRead;
use crate::picture_file::WriteError;
use crate::scene::SceneDocument;
use crate::whole_file;
use bevy_ecs::prelude::World;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Frames that are looked at before the first is drawn; the others are when it is their turn.
const MOST_FRAMES: u64 = 10_000;

/// Where a run writes to.
pub(super) struct Outputs {
    /// What is written, as typed, and what that leads to.
    files: Vec<(PathBuf, Identity)>,
}

/// What tells one file from another, however its path is written.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Identity {
    /// By its device and number.
    #[cfg(unix)]
    Node(u64, u64),
    Path(PathBuf),
}

impl Identity {
    fn of(path: &Path) -> Self {
        #[cfg(unix)]
        if let Ok(metadata) = std::fs::metadata(path) {
            use std::os::unix::fs::MetadataExt;
            return Self::Node(metadata.dev(), metadata.ino());
        }
        Self::Path(whole_file::target(path).unwrap_or_else(|_| path.to_owned()))
    }
}

impl Outputs {
    /// Finds out whether all can be written, each to a file of its own.
    pub fn check(arguments: &RenderArguments, output: &Output) -> Result<Self, Failure> {
        let frames = arguments.frames.clone().unwrap_or(0..1);
        let pictures = output.files(frames.start..frames.end.min(frames.start.saturating_add(MOST_FRAMES)));
        let mut files = Vec::new();
        let mut taken = HashSet::new();
        for path in pictures.into_iter().chain(arguments.stats.clone()) {
            super::output::check_folder(&path)?;
            whole_file::check(&path).map_err(|source| WriteError::Write { path: path.clone(), source })?;
            // A device takes whatever comes.
            if path.exists() && !path.is_file() {
                continue;
            }
            let identity = Identity::of(&path);
            if !taken.insert(identity.clone()) {
                let message = format!(
                    "{} would be written twice; choose another place for one of the two",
                    path.display()
                );
                return Err(Failure::Usage(message));
            }
            files.push((path, identity));
        }
        Ok(Self { files })
    }

    /// Finds out whether any of them is what a scene is read from.
    pub fn spare(&self, document: &SceneDocument) -> Result<(), Failure> {
        self.spare_all(document.files.iter().map(PathBuf::as_path).chain(document.paths()))
    }

    /// The same of what was read for the entities of a world.
    pub fn spare_read(&self, world: &World) -> Result<(), Failure> {
        let Some(mut query) = world.try_query::<&FilesRead>() else { return Ok(()) };
        self.spare_all(query.iter(world).flat_map(FilesRead::all).map(|(path, _)| path.as_path()))
    }

    fn spare_all<'a>(&self, inputs: impl Iterator<Item = &'a Path>) -> Result<(), Failure> {
        let inputs: HashSet<Identity> = inputs.filter(|path| path.is_file()).map(Identity::of).collect();
        match self.files.iter().find(|(_, identity)| inputs.contains(identity)) {
            None => Ok(()),
            Some((path, _)) => {
                let message = format!(
                    "{} is read for the scene, and would be overwritten; nothing was written",
                    path.display()
                );
                Err(Failure::Usage(message))
            }
        }
    }
}
