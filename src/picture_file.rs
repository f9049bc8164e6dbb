//! Pictures as files, which are there whole or not at all.

use crate::render::{Image, Pixels};
use crate::whole_file;
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::io::{self, Cursor};
use std::path::{Path, PathBuf};

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum WriteError {
    /// The picture does not fit the format.
    #[error("cannot encode {}: {source}", .path.display())]
    Encode {
        /// The file that it was for.
        path: PathBuf,
        /// What the encoder says.
        source: image::ImageError,
    },
    /// The system refused.
    #[error("cannot write {}: {source}{}", .path.display(), mend(source))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// Whether another place would do.
pub(crate) fn is_place_at_fault(error: &io::Error) -> bool {
    use io::ErrorKind::{
        InvalidFilename, IsADirectory, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem,
    };
    [PermissionDenied, NotFound, IsADirectory, NotADirectory, InvalidFilename, ReadOnlyFilesystem]
        .contains(&error.kind())
}

fn mend(error: &io::Error) -> &'static str {
    match error.kind() {
        _ if is_place_at_fault(error) => "; choose another place",
        io::ErrorKind::StorageFull => "; free some space and try again",
        _ => "",
    }
}

/// Encodes an image, as what it holds asks for, and writes it.
pub(crate) fn write_image(path: &Path, image: &Image) -> Result<(), WriteError> {
    let bytes = encode(image).map_err(|source| WriteError::Encode { path: path.to_owned(), source })?;
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

/// Writes a file that is there whole or not at all.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    whole_file::write(path, bytes).map_err(|source| WriteError::Write { path: path.to_owned(), source })
}
