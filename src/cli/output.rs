//! Files that are there whole or not at all.

use super::exit::Failure;
use crate::render::{Image, Pixels};
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::io::{self, BufWriter, Cursor, Write};
use std::path::{Path, PathBuf};

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
    write_atomically(path, bytes).map_err(|error| {
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

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.into(),
        _ => PathBuf::from("."),
    }
}
