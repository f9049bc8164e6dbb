//! The files of a folder, of those within it, and of what an index of them names.

use std::{
    collections::{HashMap, HashSet},
    fs,
    io::Read,
    path::{Path, PathBuf},
};

use super::{
    SourceError,
    elements::Elements,
    recognise::{self, is_dicom},
    tags,
    values::text,
};
use crate::sources::{file, trail};

/// Entries of folders that are looked at, in all.
const MAX_ENTRIES: usize = 1 << 16;

/// How deep folders may lie in each other: discs have four levels, archives twice as many.
const MAX_DEPTH: usize = 16;

/// What a folder has.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// Files that begin as DICOM does, in the order of their names.
    pub files: Vec<PathBuf>,
    /// How many others there are, and the first.
    pub others: usize,
    /// The first of them.
    pub first_other: Option<PathBuf>,
    /// Whether there was more than is looked at.
    pub is_cut: bool,
}

impl Found {
    fn other(&mut self, path: PathBuf) {
        self.others += 1;
        self.first_other.get_or_insert(path);
    }
}

/// Looks through a folder and those within it. A link that leads back is not followed twice.
///
/// # Errors
///
/// If the folder itself cannot be read.
pub(super) fn search(folder: &Path) -> Result<Found, SourceError> {
    let mut found = Found::default();
    let (mut seen, mut left) = (HashSet::new(), MAX_ENTRIES);
    let mut within = vec![(folder.to_owned(), 0)];
    while let Some((folder, depth)) = within.pop() {
        if !seen.insert(fs::canonicalize(&folder).unwrap_or_else(|_| folder.clone())) {
            continue;
        }
        let entries = match entries(&folder, &mut left) {
            Ok(entries) => entries,
            Err(cause) if depth == 0 => return Err(file::io_error(&folder, cause)),
            // A folder within that others may not read.
            Err(_) => {
                found.other(folder);
                continue;
            }
        };
        let mut folders = Vec::new();
        for entry in entries {
            match fs::metadata(&entry) {
                Ok(metadata) if metadata.is_dir() && depth < MAX_DEPTH => folders.push((entry, depth + 1)),
                Ok(metadata) if metadata.is_dir() => found.is_cut = true,
                Ok(metadata) if metadata.is_file() && begins_like_dicom(&entry) => found.files.push(entry),
                _ => found.other(entry),
            }
        }
        within.extend(folders.into_iter().rev());
    }
    found.is_cut |= left == 0;
    Ok(found)
}

fn entries(folder: &Path, left: &mut usize) -> std::io::Result<Vec<PathBuf>> {
    trail::note(folder);
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder)?.take(*left) {
        entries.push(entry?.path());
    }
    *left -= entries.len();
    entries.sort();
    Ok(entries)
}

fn begins_like_dicom(path: &Path) -> bool {
    let named = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("dcm"));
    let mut head = Vec::new();
    let read = file::open(path).map(|(file, _)| file.take(recognise::HEAD).read_to_end(&mut head));
    matches!(read, Ok(Ok(_))) && is_dicom(&head, named)
}

/// The files that an index names, those that are there; `None` if a file is no index.
///
/// # Errors
///
/// If the file is broken.
pub(super) fn index(path: &Path) -> Result<Option<Vec<PathBuf>>, SourceError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut elements = Elements::open(path)?;
    let (mut files, mut is_index, mut listings) = (Vec::new(), false, Listings::new());
    while let Some(element) = elements.next()? {
        if tags::is_pixels(element.tag) {
            return Ok(None);
        }
        is_index |= element.tag == tags::DIRECTORY;
        if element.tag == tags::REFERENCED_FILE && files.len() < MAX_ENTRIES {
            let parts = text(&element.value);
            let parts = parts.split('\\').map(|part| part.trim_matches([' ', '\0']));
            files.extend(named(folder, parts, &mut listings));
        }
    }
    Ok(is_index.then_some(files))
}

/// The entries of folders, by their names in lower case.
type Listings = HashMap<PathBuf, HashMap<String, PathBuf>>;

/// A file below a folder, whichever case its name and those of the folders have; `None` if there is none, or it is elsewhere.
fn named<'a>(
    folder: &Path,
    parts: impl Iterator<Item = &'a str>,
    listings: &mut Listings,
) -> Option<PathBuf> {
    let mut path = folder.to_owned();
    for part in parts {
        if part.is_empty() || part == "." || part == ".." || part.contains(['/', '\\']) {
            return None;
        }
        let exact = path.join(part);
        path = if exact.exists() {
            exact
        } else {
            let listing = listings.entry(path.clone()).or_insert_with(|| listing(&path));
            listing.get(&part.to_lowercase())?.clone()
        };
    }
    path.is_file().then_some(path)
}

fn listing(folder: &Path) -> HashMap<String, PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().take(MAX_ENTRIES).flatten();
    entries.map(|entry| (entry.file_name().to_string_lossy().to_lowercase(), entry.path())).collect()
}
