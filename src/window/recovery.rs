//! Edits that outlive a program which ends before they are saved.
//!
//! What would be saved is known at any time as text, and kept where whoever ends the program can write it: beside each file, under its name
//! with `.recovered` in it, so that it can be compared with the file, opened, or taken back into the scene when that is opened again.

use crate::plain;
use crate::regular_file;
use crate::scene::{Edits, SourceFile};
use crate::ui::Recovered;
use crate::whole_file;
use std::collections::{BTreeMap, HashMap};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The files of each scene that is shown, as they would be saved.
static UNSAVED: Mutex<BTreeMap<u64, Vec<Arc<SourceFile>>>> = Mutex::new(BTreeMap::new());

fn unsaved() -> MutexGuard<'static, BTreeMap<u64, Vec<Arc<SourceFile>>>> {
    UNSAVED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What is not saved of a scene, for as long as that is shown.
pub(super) struct Unsaved(u64);

impl Default for Unsaved {
    /// Nothing so far.
    fn default() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

impl Unsaved {
    /// Takes what edits would save as what is to be kept; nothing where a person wants it so.
    pub fn remember(&self, edits: Option<&Edits>) {
        match edits.map(Edits::unsaved_files).filter(|files| !files.is_empty()) {
            Some(files) => _ = unsaved().insert(self.0, files),
            None => _ = unsaved().remove(&self.0),
        }
    }

    /// Does something, and keeps what is not saved if it panics.
    pub fn guard<T>(&self, run: impl FnOnce() -> T) -> T {
        catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|panic| {
            let files = unsaved().remove(&self.0);
            keep_all(files.unwrap_or_default());
            resume_unwind(panic)
        })
    }
}

impl Drop for Unsaved {
    fn drop(&mut self) {
        self.remember(None);
    }
}

/// Writes what is not saved of any scene into files of its own, and tells where; once, however often it is asked for.
pub(crate) fn keep_unsaved() {
    let all = std::mem::take(&mut *unsaved());
    keep_all(all.into_values().flatten());
}

fn keep_all(files: impl IntoIterator<Item = Arc<SourceFile>>) {
    for file in files {
        match keep(&file) {
            Ok(path) => log::error!(
                "edits that were not saved are kept in {}; `tyndall view` offers them when the scene is opened again",
                path.display()
            ),
            Err(error) => log::error!("edits of {} are lost: {error}", file.path().display()),
        }
    }
}

/// Writes a file beside the one that it is a version of, or where files are kept for a while if that cannot be done.
fn keep(file: &SourceFile) -> io::Result<PathBuf> {
    let path = std::path::absolute(file.path())?;
    let beside = free(&path);
    let written = whole_file::write(&beside, file.text().as_bytes());
    written.map(|()| beside).or_else(|error| {
        let elsewhere = free(&std::env::temp_dir().join(path.file_name().unwrap_or_default()));
        whole_file::write(&elsewhere, file.text().as_bytes()).map(|()| elsewhere).map_err(|_| error)
    })
}

/// Versions of a file that are told from each other.
const MOST_VERSIONS: usize = 100;

/// The names for versions of a file: `head.recovered.ron`, `head.recovered_2.ron`.
fn names(path: &Path) -> impl Iterator<Item = PathBuf> {
    let stem = path.file_stem().unwrap_or_default().to_owned();
    let ending = path.extension().map(ToOwned::to_owned);
    (1..=MOST_VERSIONS).map(move |number| {
        let mut name = stem.clone();
        name.push(".recovered");
        if number > 1 {
            name.push(format!("_{number}"));
        }
        if let Some(ending) = &ending {
            name.push(".");
            name.push(ending);
        }
        path.with_file_name(name)
    })
}

/// A name that is not taken.
fn free(path: &Path) -> PathBuf {
    names(path)
        .find(|name| std::fs::symlink_metadata(name).is_err())
        .unwrap_or_else(|| path.with_extension("recovered"))
}

/// The versions that were kept of files: of each the last.
pub(super) fn find<'p>(files: impl IntoIterator<Item = &'p Path>) -> Recovered {
    let last = |path: &Path| {
        let written = |name: PathBuf| Some((std::fs::metadata(&name).ok()?.modified().ok()?, name));
        let kept = names(path).take_while(|name| name.is_file()).filter_map(written).max();
        kept.map(|(_, kept)| (path.to_owned(), kept))
    };
    // A scene that is in no file has no version of its own.
    Recovered(files.into_iter().filter(|path| path.is_file()).filter_map(last).collect())
}

/// What was kept, by the file that it is a version of.
pub(super) fn read(recovered: &Recovered) -> Result<HashMap<PathBuf, String>, String> {
    let text = |(file, kept): &(PathBuf, PathBuf)| {
        let bytes = regular_file::read(kept, LONGEST).ok().and_then(|bytes| String::from_utf8(bytes).ok());
        let text =
            bytes.ok_or_else(|| format!("{} cannot be read", plain::line(&kept.display().to_string())))?;
        Ok((file.clone(), text))
    };
    recovered.0.iter().map(text).collect()
}

/// A scene's text is not longer.
const LONGEST: u64 = 64 << 20;

/// Takes away what was kept.
pub(super) fn remove(recovered: &Recovered) {
    for (_, kept) in &recovered.0 {
        if let Err(error) = std::fs::remove_file(kept) {
            log::warn!("{} stays: {error}", kept.display());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_stand_beside_their_file_and_the_last_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("head.ron");
        std::fs::write(&scene, "base").unwrap();
        assert_eq!(find([scene.as_path()]), Recovered::default());
        for (text, name) in [("one", "head.recovered.ron"), ("two", "head.recovered_2.ron")] {
            let kept = keep(&SourceFile::new(&scene, text)).unwrap();
            assert_eq!(kept, folder.path().join(name));
        }
        let found = find([scene.as_path()]);
        assert_eq!(found.0, [(scene.clone(), folder.path().join("head.recovered_2.ron"))]);
        assert_eq!(read(&found).unwrap(), HashMap::from([(scene.clone(), "two".to_owned())]));
        remove(&found);
        assert_eq!(read(&find([scene.as_path()])).unwrap()[&scene], "one");
    }
}
