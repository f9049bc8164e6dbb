//! Files that are there whole or not at all.
//!
//! What is written lies in a file without a name until it is whole, where the system has such files, so that nothing is left of it however
//! the program ends. Elsewhere, and for the moment in which it takes the place of another file, it has a name that [`abandon`] takes away.

use std::collections::BTreeSet;
use std::fs::{File, Metadata};
use std::io::{self, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A file that is written, and not yet in its place.
pub(crate) struct Staged {
    file: Temporary,
    path: PathBuf,
}

impl Staged {
    /// Writes beside the file at `path`, which keeps its permissions. Through a link, what it leads to is meant, be it there or not.
    pub fn write(path: &Path, bytes: &[u8]) -> io::Result<Self> {
        let mut staged = Self::begin(path)?;
        staged.write_all(bytes)?;
        staged.finish()
    }

    /// An empty one, to be written to.
    pub fn begin(path: &Path) -> io::Result<Self> {
        let path = target(path)?;
        replaced(&path)?;
        Ok(Self { file: Temporary::new(&folder_of(&path))?, path })
    }

    /// The same once all has been written.
    pub fn finish(mut self) -> io::Result<Self> {
        if let Some(replaced) = replaced(&self.path)? {
            self.file.file().set_permissions(replaced.permissions())?;
        }
        Ok(self)
    }

    /// The same once it is on the disk, so that a loss of power leaves the old file or the new one.
    pub fn synced(mut self) -> io::Result<Self> {
        self.file.file().sync_all()?;
        Ok(self)
    }

    /// Puts it in its place: whoever reads the file finds the old or the new one, never half of it.
    pub fn commit(self) -> io::Result<()> {
        self.file.named(&self.path)?.map_or(Ok(()), |named| named.rename(&self.path))
    }
}

impl Write for Staged {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.file().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.file().flush()
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

/// Finds out whether [`write`] can write the file, and leaves nothing behind.
pub(crate) fn check(path: &Path) -> io::Result<()> {
    match std::fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => return Err(ErrorKind::IsADirectory.into()),
        // Opening it may do something, or wait.
        Ok(metadata) if !metadata.is_file() => return Ok(()),
        Ok(_) => {}
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    let path = target(path)?;
    replaced(&path)?;
    Temporary::new(&folder_of(&path)).map(drop)
}

/// How the file is that is to be replaced, if there is one.
fn replaced(path: &Path) -> io::Result<Option<Metadata>> {
    let Ok(replaced) = std::fs::metadata(path) else { return Ok(None) };
    // Renaming asks for leave to write to the folder only. Whoever made the file read-only meant something by it.
    if replaced.permissions().readonly() {
        return Err(io::Error::new(ErrorKind::PermissionDenied, "the file is read-only"));
    }
    Ok(Some(replaced))
}

/// Links that are followed; more are a circle.
const MAX_LINKS: usize = 40;

/// What a path leads to through links, be there a file or not.
pub(crate) fn target(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match path.canonicalize() {
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            found => return found,
        }
        let Ok(next) = std::fs::read_link(&path) else {
            let name = path.file_name().ok_or(ErrorKind::NotFound)?.to_owned();
            return Ok(folder_of(&path).canonicalize()?.join(name));
        };
        path = folder_of(&path).join(next);
    }
    Err(io::Error::other("too many links lead to each other"))
}

/// The folder that a file is in.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.into(),
        _ => PathBuf::from("."),
    }
}

/// What has a name only for as long as it is written.
enum Temporary {
    #[cfg(target_os = "linux")]
    Unnamed(File),
    Named(File, Name),
}

impl Temporary {
    fn new(folder: &Path) -> io::Result<Self> {
        #[cfg(target_os = "linux")]
        if let Some(file) = unnamed(folder) {
            return Ok(Self::Unnamed(file));
        }
        let (file, name) = Name::make(folder, |path| new_options().create_new(true).open(path))?;
        Ok(Self::Named(file, name))
    }

    fn file(&mut self) -> &mut File {
        match self {
            #[cfg(target_os = "linux")]
            Self::Unnamed(file) => file,
            Self::Named(file, _) => file,
        }
    }

    /// Has it be in the folder of `path`: there already, where nothing was there before, or else under a name to be renamed.
    fn named(self, path: &Path) -> io::Result<Option<Name>> {
        match self {
            #[cfg(target_os = "linux")]
            Self::Unnamed(mut file) => {
                match link(&file, path) {
                    Ok(()) => return Ok(None),
                    Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                    // A system that gives no names to files that have none.
                    Err(_) => {
                        let (mut copy, name) =
                            Name::make(&folder_of(path), |path| new_options().create_new(true).open(path))?;
                        file.rewind()?;
                        io::copy(&mut file, &mut copy)?;
                        copy.set_permissions(file.metadata()?.permissions())?;
                        copy.sync_all()?;
                        return Ok(Some(name));
                    }
                }
                Name::make(&folder_of(path), |path| link(&file, path)).map(|((), name)| Some(name))
            }
            Self::Named(_, name) => Ok(Some(name)),
        }
    }
}

/// As for any new file: what the process's mask leaves of it.
fn new_options() -> std::fs::OpenOptions {
    let mut options = File::options();
    options.read(true).write(true);
    options
}

/// A file without a name, where the folder is on a system that has such.
#[cfg(target_os = "linux")]
fn unnamed(folder: &Path) -> Option<File> {
    use std::os::unix::fs::OpenOptionsExt;
    // Without this a name cannot be given to it.
    if !Path::new("/proc/self/fd").exists() {
        return None;
    }
    new_options().custom_flags(rustix::fs::OFlags::TMPFILE.bits().cast_signed()).open(folder).ok()
}

/// Gives a file without a name one that is not taken.
#[cfg(target_os = "linux")]
fn link(file: &File, path: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    use std::os::fd::AsRawFd;
    let unnamed = format!("/proc/self/fd/{}", file.as_raw_fd());
    Ok(linkat(CWD, unnamed, CWD, path, AtFlags::SYMLINK_FOLLOW)?)
}

/// The names of files that are not whole.
static NAMES: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn names() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    NAMES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes away what is not whole, for a program that is about to end at once. Nothing is written any more while the guard lives.
pub(crate) fn abandon() -> impl Drop {
    let names = names();
    for name in names.iter() {
        // It may be in its place, or gone, by now.
        let _ = std::fs::remove_file(name);
    }
    names
}

/// A name of a file that is not whole. It goes with this, unless it was renamed.
struct Name(PathBuf);

impl Name {
    /// Makes a file under a name that is not taken.
    fn make<T>(folder: &Path, mut make: impl FnMut(&Path) -> io::Result<T>) -> io::Result<(T, Self)> {
        let mut builder = tempfile::Builder::new();
        let made = builder.prefix(".tyndall-").make_in(folder, |path| {
            // Known before it is there, so that it cannot be forgotten.
            names().insert(path.to_owned());
            make(path).inspect_err(|_| _ = names().remove(path))
        })?;
        let (made, path) = made.into_parts();
        // From here on this is who takes it away.
        let path = path.keep().map_err(|error| error.error)?;
        Ok((made, Self(path)))
    }

    fn rename(self, path: &Path) -> io::Result<()> {
        std::fs::rename(&self.0, path)?;
        names().remove(&self.0);
        std::mem::forget(self);
        Ok(())
    }
}

impl Drop for Name {
    fn drop(&mut self) {
        // Whoever renamed it may have failed half-way; there is nothing else that can be done.
        let _ = std::fs::remove_file(&self.0);
        names().remove(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<_> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_made_replaced_and_not_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        for text in ["one", "two", "three"] {
            write(&path, text.as_bytes()).unwrap();
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
        drop(Staged::write(&path, b"four").unwrap().synced().unwrap());
        check(&path).unwrap();
        check(&folder.path().join("new")).unwrap();
        assert_eq!(
            (names_in(folder.path()), std::fs::read(&path).unwrap()),
            (vec!["file".to_owned()], b"three".to_vec())
        );
        assert!(!names().iter().any(|name| name.starts_with(folder.path())));
    }

    #[test]
    fn what_has_a_name_is_taken_away_when_all_is_abandoned() {
        let folder = tempfile::tempdir().unwrap();
        let (_file, name) = Name::make(folder.path(), |path| File::create_new(path)).unwrap();
        assert_eq!(names_in(folder.path()).len(), 1);
        drop(abandon());
        assert_eq!(names_in(folder.path()).len(), 0);
        drop(name);
    }

    #[test]
    fn what_cannot_be_written_is_known_before() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        assert_eq!(check(folder.path()).unwrap_err().kind(), ErrorKind::IsADirectory);
        assert_eq!(check(&path.join("below")).unwrap_err().kind(), ErrorKind::NotFound);
        std::fs::write(&path, "kept").unwrap();
        assert!(check(&path.join("below")).is_err());
        assert!(check(&folder.path().join("x".repeat(300))).is_err());
        let mut permissions = std::fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(&path, permissions).unwrap();
        assert_eq!(check(&path).unwrap_err().kind(), ErrorKind::PermissionDenied);
        assert!(write(&path, b"lost").is_err());
        assert_eq!(
            (names_in(folder.path()), std::fs::read(&path).unwrap()),
            (vec!["file".to_owned()], b"kept".to_vec())
        );
    }

    #[test]
    #[cfg(unix)]
    fn links_are_followed_to_what_is_not_there_yet() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("deep")).unwrap();
        symlink("deep/link", at("first")).unwrap();
        symlink("file", at("deep/link")).unwrap();
        check(&at("first")).unwrap();
        for text in ["one", "two"] {
            write(&at("first"), text.as_bytes()).unwrap();
            assert_eq!(std::fs::read_to_string(at("deep/file")).unwrap(), text);
        }
        assert!(at("first").is_symlink() && at("deep/link").is_symlink());
        let mode = std::fs::metadata(at("deep/file")).unwrap().permissions().mode();
        std::fs::write(at("plain"), "").unwrap();
        assert_eq!(mode, std::fs::metadata(at("plain")).unwrap().permissions().mode(), "as of any new file");
        symlink("round", at("about")).unwrap();
        symlink("about", at("round")).unwrap();
        assert!(check(&at("round")).is_err() && write(&at("round"), b"").is_err());
    }
}
