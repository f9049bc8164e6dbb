//! Pictures and other results in files.

use super::exit::Failure;
use crate::render::{Image, Pixels};
use crate::whole_file::{self, folder_of};
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::io::{self, Cursor};
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
    let bytes = encode(image)
        .map_err(|error| Failure::Machine(format!("cannot encode {}: {error}", path.display())))?;
    write(path, &bytes)
}

fn encode(image: &Image) -> Result<Vec<u8>, image::ImageError> {
    let mut bytes = Cursor::new(Vec::new());
    match &image.pixels {
        Pixels::Radiance(pixels) => OpenExrEncoder::new(&mut bytes).write_image(
            bytemuck::cast_slice(pixels),
            image.width,
            image.height,
            ExtendedColorType::Rgb32F,
        )?,
        Pixels::Encoded(pixels) => {
            PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Adaptive)
                .write_image(
                    bytemuck::cast_slice(pixels),
                    image.width,
                    image.height,
                    ExtendedColorType::Rgb8,
                )?;
        }
    }
    Ok(bytes.into_inner())
}

/// Writes beside the file and renames, so that whoever reads it finds the old or the new one, never half of it.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    whole_file::write(path, bytes).map_err(|error| {
        let message = format!("cannot write {}: {error}", path.display());
        match error.kind() {
            io::ErrorKind::PermissionDenied
            | io::ErrorKind::NotFound
            | io::ErrorKind::IsADirectory
            | io::ErrorKind::ReadOnlyFilesystem => Failure::Usage(format!("{message}; choose another place")),
            io::ErrorKind::StorageFull => {
                Failure::Machine(format!("{message}; free some space and try again"))
            }
            _ => Failure::Machine(message),
        }
    })
}
