//! Files that are there whole or not at all.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file that is written, and not yet in its place.
pub(crate) struct Staged {
    file: tempfile::NamedTempFile,
    path: PathBuf,
}

impl Staged {
    /// Writes beside the file at `path`, which keeps its permissions. Through a link, what it leads to is meant.
    pub fn write(path: &Path, bytes: &[u8]) -> io::Result<Self> {
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let mut file = temporary(&folder_of(&path))?;
        file.write_all(bytes)?;
        file.flush()?;
        if let Ok(replaced) = std::fs::metadata(&path) {
            // Renaming asks for leave to write to the folder only. Whoever made the file read-only meant something by it.
            if replaced.permissions().readonly() {
                return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
            }
            file.as_file().set_permissions(replaced.permissions())?;
        }
        Ok(Self { file, path })
    }

    /// The same once it is on the disk, so that a loss of power leaves the old file or the new one.
    pub fn synced(self) -> io::Result<Self> {
        self.file.as_file().sync_all()?;
        Ok(self)
    }

    /// Puts it in its place: whoever reads the file finds the old or the new one, never half of it.
    pub fn commit(self) -> io::Result<()> {
        self.file.persist(self.path).map(drop).map_err(|error| error.error)
    }
}

/// Writes a file in one step, if it is one; a device or a pipe is written to, not replaced.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if path.exists() && !path.is_file() {
        // A folder gives its own error.
        return File::options().write(true).open(path)?.write_all(bytes);
    }
    Staged::write(path, bytes)?.commit()
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
