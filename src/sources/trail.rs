//! Which files a reader looked at, and how they were then: so that it can be known later whether reading again would give something else.

use std::{
    cell::RefCell,
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
    time::SystemTime,
};

/// How a file was when it was looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileState {
    /// There was none, or it could not be looked at.
    Missing,
    /// A regular file.
    File {
        /// Its length.
        bytes: u64,
        /// When it was last written, if the file system says so.
        modified: Option<SystemTime>,
    },
    /// A folder, all entries of which count.
    Folder {
        /// When an entry last came or went.
        modified: Option<SystemTime>,
    },
    /// A pipe, socket or device.
    Other,
}

impl FileState {
    /// How the file at `path` is now.
    pub fn of(path: &Path) -> Self {
        fs::metadata(path).map_or(Self::Missing, |metadata| Self::from_metadata(&metadata))
    }

    /// The same, of a file that was asked already.
    pub(super) fn from_metadata(metadata: &fs::Metadata) -> Self {
        let modified = metadata.modified().ok();
        if metadata.is_file() {
            Self::File { bytes: metadata.len(), modified }
        } else if metadata.is_dir() {
            Self::Folder { modified }
        } else {
            Self::Other
        }
    }
}

/// Files that were looked for, found or not, with how they were when that was first done.
pub type Trail = BTreeMap<PathBuf, FileState>;

thread_local! {
    /// Readers hand paths to each other and open them deep down. All do so in the thread that called them, and through
    /// [`super::file`], so this is where none can be forgotten.
    static TRAIL: RefCell<Option<Trail>> = const { RefCell::new(None) };
}

/// Runs a reader, and says which files it looked at.
pub fn follow<T>(read: impl FnOnce() -> T) -> (T, Trail) {
    let outer = TRAIL.replace(Some(Trail::new()));
    let value = read();
    let trail = TRAIL.replace(outer).unwrap_or_default();
    (value, trail)
}

/// Notes a file that is about to be looked at, for readers that open files themselves.
pub fn note(path: &Path) {
    note_state(path, || FileState::of(path));
}

/// Notes a file that was just asked how it is.
pub(super) fn note_metadata(path: &Path, metadata: &io::Result<fs::Metadata>) {
    note_state(path, || metadata.as_ref().map_or(FileState::Missing, FileState::from_metadata));
}

fn note_state(path: &Path, state: impl FnOnce() -> FileState) {
    TRAIL.with_borrow_mut(|trail| {
        // What came first is what a reader began with.
        if let Some(trail) = trail
            && !trail.contains_key(path)
        {
            trail.insert(path.to_owned(), state());
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sources::mesh::Normals;
    use crate::sources::{Selection, read_obj, read_volume};

    fn names(trail: &Trail) -> Vec<String> {
        trail.keys().map(|path| path.file_name().unwrap().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn every_file_that_a_reader_looks_at_is_noted() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 2\nencoding: raw\ndata file: LIST\na.raw\nb.raw\n";
        fs::write(at("v.nhdr"), header).unwrap();
        fs::write(at("a.raw"), [1, 2]).unwrap();
        let (read, trail) = follow(|| read_volume(&at("v.nhdr"), &Selection::default()));
        assert!(read.is_err());
        assert_eq!(names(&trail), ["a.raw", "b.raw", "v.nhdr"]);
        assert_eq!(trail[&at("b.raw")], FileState::Missing);
        assert_eq!(trail[&at("a.raw")], FileState::of(&at("a.raw")));
        fs::write(at("b.raw"), [3, 4]).unwrap();
        let (read, trail) = follow(|| read_volume(&at("v.nhdr"), &Selection::default()));
        assert_eq!((read.unwrap().size, trail.len()), ([2, 1, 2], 3));
    }

    #[test]
    fn a_folder_counts_and_so_does_what_is_in_it() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("notes.txt"), "none of these").unwrap();
        let (read, trail) = follow(|| read_volume(folder.path(), &Selection::default()));
        assert!(read.is_err());
        assert!(matches!(trail[folder.path()], FileState::Folder { .. }));
        assert!(trail.contains_key(&folder.path().join("notes.txt")));
    }

    #[test]
    fn outside_nothing_is_noted_and_inside_each_for_itself() {
        let missing = Path::new("there is no such.obj");
        let ((_, inner), outer) = follow(|| follow(|| read_obj(missing, Normals::default())));
        assert_eq!((inner.len(), outer.len()), (1, 0));
        let (_, trail) = follow(|| ());
        assert!(read_obj(missing, Normals::default()).is_err() && trail.is_empty());
    }
}
