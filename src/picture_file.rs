//! Pictures as files, which are there whole or not at all.

use crate::render::{Image, Pixels};
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::io::{self, BufWriter, Cursor, Write};
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
    use io::ErrorKind::{IsADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem};
    [PermissionDenied, NotFound, IsADirectory, ReadOnlyFilesystem].contains(&error.kind())
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

/// Writes beside the file and renames, so that whoever reads it finds the old or the new one, never half of it.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_atomically(path, bytes).map_err(|source| WriteError::Write { path: path.to_owned(), source })
}

fn write_atomically(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if path.exists() && !path.is_file() {
        // A device or a pipe is written to, not replaced; a folder gives its own error.
        return std::fs::OpenOptions::new().write(true).open(path)?.write_all(bytes);
    }
    // A link stays a link: what it leads to is replaced.
    let path = &path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let file = temporary(&folder_of(path))?;
    let mut writer = BufWriter::new(&file);
    writer.write_all(bytes)?;
    writer.flush()?;
    drop(writer);
    file.persist(path).map(drop).map_err(|error| error.error)
}

fn temporary(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".tyndall-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As for any new file; the default is private to the user.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// The folder that a file is in.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.into(),
        _ => PathBuf::from("."),
    }
}
