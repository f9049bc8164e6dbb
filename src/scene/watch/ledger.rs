//! Which files are watched, on what their paths depend, and what they held.

use super::{Found, Reason, paths};
use crate::regular_file;
use crate::sources::trail::FileState;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Files up to this length are looked into as soon as they are known; longer ones when nothing else is to be done.
const SHORT: u64 = 1 << 20;

#[derive(Default)]
pub(super) struct Ledger {
    files: HashMap<PathBuf, Watched>,
    /// The files that depend on each entry of a folder.
    at: HashMap<PathBuf, BTreeSet<PathBuf>>,
    /// The files that need each folder to be watched.
    folders: HashMap<PathBuf, BTreeSet<PathBuf>>,
    /// Files of which it is not known what they hold.
    unknown: BTreeSet<PathBuf>,
}

struct Watched {
    reasons: HashSet<Reason>,
    entries: Vec<PathBuf>,
    folders: Vec<PathBuf>,
    /// How the file was when it was read.
    state: FileState,
    /// What it held then, if that is known.
    content: Option<u64>,
}

impl Ledger {
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    pub fn is_known(&self, file: &Path) -> bool {
        self.files.contains_key(file)
    }

    pub fn files(&self) -> impl Iterator<Item = PathBuf> + '_ {
        self.files.keys().cloned()
    }

    /// The files that a change of this entry may concern.
    pub fn files_at(&self, entry: &Path) -> impl Iterator<Item = PathBuf> + '_ {
        let own = self.at.get(entry).into_iter().flatten();
        // A folder counts with all that is in it.
        let around = entry.parent().and_then(|folder| self.at.get(folder)).into_iter().flatten();
        own.chain(around).cloned()
    }

    /// The files that need a folder to be watched.
    pub fn files_in(&self, folder: &Path) -> impl Iterator<Item = PathBuf> + '_ {
        self.folders.get(folder).into_iter().flatten().cloned()
    }

    /// The files that look otherwise than they did.
    pub fn different_files(&self) -> HashSet<PathBuf> {
        let different = self.files.iter().filter(|(path, watched)| FileState::of(path) != watched.state);
        different.map(|(path, _)| path.clone()).collect()
    }

    pub fn add(&mut self, reason: Reason, found: &Found) {
        let watched = self.files.entry(found.path.clone()).or_insert_with(|| Watched {
            reasons: HashSet::new(),
            entries: Vec::new(),
            folders: Vec::new(),
            state: found.state,
            content: None,
        });
        watched.reasons.insert(reason);
    }

    /// Drops a reason from all files but these, and answers which now have none.
    pub fn keep(&mut self, reason: Reason, named: &HashSet<PathBuf>) -> Vec<PathBuf> {
        let mut gone = Vec::new();
        for (path, watched) in &mut self.files {
            if !named.contains(path) && watched.reasons.remove(&reason) && watched.reasons.is_empty() {
                gone.push(path.clone());
            }
        }
        gone
    }

    /// Forgets a file, and answers which folders nobody needs any more.
    pub fn remove(&mut self, file: &Path) -> Vec<PathBuf> {
        let idle = self.depend(file, Vec::new());
        self.files.remove(file);
        self.unknown.remove(file);
        idle
    }

    /// Says on which entries a file depends now, and answers which folders nobody needs any more.
    pub fn depend(&mut self, file: &Path, entries: Vec<PathBuf>) -> Vec<PathBuf> {
        let Some(watched) = self.files.get_mut(file) else { return Vec::new() };
        if watched.entries == entries && watched.folders == paths::folders(&entries) {
            return Vec::new();
        }
        let folders = paths::folders(&entries);
        let entries_before = std::mem::replace(&mut watched.entries, entries.clone());
        let folders_before = std::mem::replace(&mut watched.folders, folders.clone());
        entries_before.iter().for_each(|entry| _ = leave(&mut self.at, entry, file));
        entries.into_iter().for_each(|entry| join(&mut self.at, entry, file));
        folders.iter().for_each(|folder| join(&mut self.folders, folder.clone(), file));
        let mut idle = folders_before;
        idle.retain(|folder| !folders.contains(folder) && leave(&mut self.folders, folder, file));
        idle
    }

    /// Takes over how a reader found a file. Answers whether it is no longer so.
    pub fn adopt(&mut self, found: &Found) -> bool {
        let Some(watched) = self.files.get_mut(&found.path) else { return false };
        if watched.state != found.state || found.content.is_some() {
            (watched.state, watched.content) = (found.state, found.content);
        }
        let now = FileState::of(&found.path);
        if now != found.state {
            return self.compare(&found.path, false);
        }
        if watched.content.is_none() {
            self.unknown.insert(found.path.clone());
            if is_short(now) {
                self.learn(&found.path);
            }
        }
        false
    }

    /// Compares a file with what it held when it was last read or compared. `touched` says that something happened to it.
    pub fn compare(&mut self, file: &Path, touched: bool) -> bool {
        let Some(watched) = self.files.get_mut(file) else { return false };
        let now = FileState::of(file);
        let before = std::mem::replace(&mut watched.state, now);
        if now == before && !touched {
            return false;
        }
        if matches!(now, FileState::Missing | FileState::Other) {
            watched.content = None;
            self.unknown.remove(file);
            return now != before;
        }
        match watched.content {
            Some(known) => {
                watched.content = content_of(file);
                watched.content != Some(known)
            }
            None => {
                self.unknown.insert(file.to_owned());
                if is_short(now) {
                    self.learn(file);
                }
                true
            }
        }
    }

    pub fn has_unknown_content(&self) -> bool {
        !self.unknown.is_empty()
    }

    /// Looks into one of the files of which it is not known what they hold.
    pub fn learn_one_content(&mut self) {
        if let Some(file) = self.unknown.first().cloned() {
            self.learn(&file);
        }
    }

    fn learn(&mut self, file: &Path) {
        self.unknown.remove(file);
        let Some(watched) = self.files.get_mut(file) else { return };
        let content = content_of(file);
        // If it is another meanwhile, that is still to be noticed.
        watched.content = content.filter(|_| FileState::of(file) == watched.state);
    }
}

fn join(map: &mut HashMap<PathBuf, BTreeSet<PathBuf>>, key: PathBuf, file: &Path) {
    map.entry(key).or_default().insert(file.to_owned());
}

/// Whether the file was the last one.
fn leave(map: &mut HashMap<PathBuf, BTreeSet<PathBuf>>, key: &Path, file: &Path) -> bool {
    let Some(files) = map.get_mut(key) else { return true };
    files.remove(file);
    let is_empty = files.is_empty();
    if is_empty {
        map.remove(key);
    }
    is_empty
}

fn is_short(state: FileState) -> bool {
    !matches!(state, FileState::File { bytes, .. } if bytes > SHORT)
}

/// A number for what bytes say.
pub(in crate::scene) fn content(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}

/// The same for what a file holds; of a folder, the names in it.
fn content_of(file: &Path) -> Option<u64> {
    let mut hasher = DefaultHasher::new();
    if file.is_dir() {
        let entries = std::fs::read_dir(file).ok()?;
        let names: BTreeSet<_> = entries.flatten().map(|entry| entry.file_name()).collect();
        names.hash(&mut hasher);
        return Some(hasher.finish());
    }
    let (mut file, _) = regular_file::open(file).ok()?;
    let mut buffer = vec![0; 1 << 18];
    loop {
        match file.read(&mut buffer) {
            Ok(0) => return Some(hasher.finish()),
            Ok(length) => hasher.write(&buffer[..length]),
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(_) => return None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_is_the_same_however_it_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("long");
        let bytes: Vec<u8> = (0..(1 << 19) + 3u32).map(|byte| (byte % 251) as u8).collect();
        std::fs::write(&file, &bytes).unwrap();
        assert_eq!(content_of(&file), Some(content(&bytes)));
        std::fs::write(&file, &bytes[1..]).unwrap();
        assert_ne!(content_of(&file), Some(content(&bytes)));
        let names = content_of(folder.path());
        std::fs::write(folder.path().join("other"), "").unwrap();
        assert_ne!(content_of(folder.path()), names);
    }

    #[test]
    fn a_folder_is_needed_until_the_last_file_has_left_it() {
        let mut ledger = Ledger::default();
        let paths = ["/f/a", "/f/b"].map(PathBuf::from);
        for path in &paths {
            let found = Found { path: path.clone(), state: FileState::Missing, content: None };
            ledger.add(Reason::Text, &found);
            assert!(ledger.depend(path, vec![path.clone()]).is_empty());
        }
        assert_eq!(ledger.files_at(&paths[1]).collect::<Vec<_>>(), [paths[1].clone()]);
        assert!(ledger.depend(&paths[0], vec![PathBuf::from("/g/a")]).is_empty());
        assert_eq!(ledger.remove(&paths[1]), [PathBuf::from("/f")]);
        assert_eq!(ledger.files_in(Path::new("/g")).collect::<Vec<_>>(), [paths[0].clone()]);
    }
}
