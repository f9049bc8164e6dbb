//! Where results are written to.

use super::exit::Failure;
use crate::picture_file::{self, WriteError, is_place_at_fault};
use crate::render::Image;
use crate::whole_file::folder_of;
use std::path::Path;

/// Whether the path names an EXR file, which holds radiance, as opposed to a PNG.
pub(super) fn wants_radiance(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"))
}

/// Says before any work is done if the folder to write to is not there.
pub(super) fn check_folder(path: &Path) -> Result<(), Failure> {
    let folder = folder_of(path);
    if folder.is_dir() {
        return Ok(());
    }
    Err(Failure::Usage(format!("cannot write {}: there is no folder {}", path.display(), folder.display())))
}

/// Encodes an image by the ending of `path` and writes it.
pub(super) fn write_image(path: &Path, image: &Image) -> Result<(), Failure> {
    Ok(picture_file::write_image(path, image)?)
}

/// Writes a file that is there whole or not at all.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    Ok(picture_file::write(path, bytes)?)
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        match &error {
            WriteError::Write { source, .. } if is_place_at_fault(source) => Self::Usage(error.to_string()),
            _ => Self::Machine(error.to_string()),
        }
    }
}
