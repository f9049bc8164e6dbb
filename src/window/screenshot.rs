//! The picture as a file.

use crate::picture_file::{WriteError, write_image};
use crate::render::read_image;
use crate::ui::{Level, Log, PictureFile};
use bevy_ecs::prelude::World;
use std::path::{Path, PathBuf};

/// Writes the picture that was drawn last beside earlier ones, and tells where.
pub(super) fn take(world: &World, folder: &Path, scene: &Path, kind: PictureFile, log: &Log) {
    let path = free_path(folder, scene, kind);
    let written = read_image(world, kind == PictureFile::Png)
        .map_err(|error| error.to_string())
        .and_then(|image| write_image(&path, &image).map_err(|error: WriteError| error.to_string()));
    match written {
        Ok(()) => {
            log::info!("wrote {}", path.display());
            log.tell(Level::Info, format!("wrote {}", path.display()));
        }
        Err(error) => {
            log::error!("{error}");
            log.tell(Level::Error, error);
        }
    }
}

/// A name that is not taken: the scene's, and a number.
fn free_path(folder: &Path, scene: &Path, kind: PictureFile) -> PathBuf {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
    let ending = match kind {
        PictureFile::Png => "png",
        PictureFile::Exr => "exr",
    };
    let named = |number: u32| folder.join(format!("{stem}_{number:04}.{ending}"));
    (1..u32::MAX).map(named).find(|path| !path.exists()).unwrap_or_else(|| named(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_picture_takes_the_place_of_another() {
        let folder = tempfile::tempdir().unwrap();
        let next = || free_path(folder.path(), "deep/head.ron".as_ref(), PictureFile::Png);
        assert_eq!(next(), folder.path().join("head_0001.png"));
        std::fs::write(next(), []).unwrap();
        assert_eq!(next(), folder.path().join("head_0002.png"));
    }
}
