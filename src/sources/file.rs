//! Opening a file, with errors that name it.

use std::{
    fs::{self, File},
    io::{self, Read, Seek, SeekFrom},
    path::Path,
};

use super::{Searched, SourceError, trail};
use crate::regular_file::{self, Unopened};

/// Names less alike than this are not suggested (0 = nothing in common, 1 = equal).
const NEAR_ENOUGH: f64 = 0.6;

/// Folder entries looked at for a suggestion.
const MAX_SUGGESTIONS_SCANNED: usize = 4096;

/// An open regular file and its length in bytes.
pub(super) fn open(path: &Path) -> Result<(File, u64), SourceError> {
    // Asked before opening: opening a pipe waits for its writer.
    let metadata = fs::metadata(path);
    trail::note_metadata(path, &metadata);
    let metadata = metadata.map_err(|cause| io_error(path, cause))?;
    let opened = regular_file::open_known(path, &metadata);
    opened.map(|(file, metadata)| (file, metadata.len())).map_err(|error| match error {
        Unopened::NotAFile(found) => SourceError::NotAFile { path: path.to_owned(), found },
        Unopened::Io(cause) => io_error(path, cause),
    })
}

/// The error for `path`; a missing file gets the nearest name of its folder.
pub(super) fn io_error(path: &Path, cause: io::Error) -> SourceError {
    let path = path.to_owned();
    match cause.kind() {
        io::ErrorKind::NotFound => {
            SourceError::NotFound { near: nearest_name(&path), searched: Searched::of(&path), path }
        }
        _ => SourceError::Io { path, cause },
    }
}

fn nearest_name(path: &Path) -> Option<String> {
    let wanted = path.file_name()?.to_string_lossy().to_lowercase();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::read_dir(folder)
        .ok()?
        .take(MAX_SUGGESTIONS_SCANNED)
        .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()))
        .map(|name| (strsim::normalized_damerau_levenshtein(&wanted, &name.to_lowercase()), name))
        .filter(|(likeness, _)| *likeness >= NEAR_ENOUGH)
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(&a.1)))
        .map(|(_, name)| name)
}

/// Whether a file begins with these bytes; it is back at its beginning afterwards.
pub(super) fn begins_with(path: &Path, file: &mut File, magic: &[u8]) -> Result<bool, SourceError> {
    let mut begins = Vec::new();
    let read = (&mut *file).take(magic.len() as u64).read_to_end(&mut begins);
    read.and_then(|_| file.seek(SeekFrom::Start(0))).map_err(|cause| io_error(path, cause))?;
    Ok(begins == magic)
}
