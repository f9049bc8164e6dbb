//! Files that a header names, on whichever machine it was written.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::trail;

/// Entries of a folder that are looked at for a name in other letters.
const MAX_ENTRIES: usize = 1 << 16;

/// The longest name that is told of as it is, in bytes; no file has a longer one, but for its folders.
const LONGEST_TOLD: usize = 255;

/// The files that a header names. Where there is no such file, a `\` counts as a `/`, and of a path of another machine only its
/// last part, beside the header; on Windows, names in other letters are the same. A note tells of it.
pub(super) fn beside(header: &Path, names: &[String], notes: &mut Vec<String>) -> Vec<PathBuf> {
    let folder = header.parent().unwrap_or(Path::new(""));
    let (mut paths, mut replaced) = (Vec::with_capacity(names.len()), Vec::new());
    for name in names {
        let named = folder.join(name);
        if is_file(&named) {
            paths.push(named);
            continue;
        }
        let other = in_place_of(folder, name);
        if let Some(other) = other.as_deref().filter(|other| is_file(other)) {
            replaced.push((name, other.to_owned()));
        }
        // One that is missing is reported where it would have been found.
        paths.push(match name.len() > LONGEST_TOLD && !other.as_deref().is_some_and(is_file) {
            true => folder.join(name.chars().take(80).chain(['…']).collect::<String>()),
            false => other.unwrap_or(named),
        });
    }
    if let Some((name, path)) = replaced.first() {
        let read = path.strip_prefix(folder).unwrap_or(path);
        let more =
            if replaced.len() > 1 { format!(" (and {} more)", replaced.len() - 1) } else { String::new() };
        notes.push(format!(
            "its header names `{}`, which is no file here; `{}` beside it is read{more}",
            name.chars().take(80).collect::<String>(),
            read.display()
        ));
    }
    paths
}

/// Where a file is that is not where its name says; `None` if the name leaves nothing to try.
pub(super) fn in_place_of(folder: &Path, name: &str) -> Option<PathBuf> {
    let name = name.trim_matches('"');
    let slashed = name.replace('\\', "/");
    let has_drive = slashed.as_bytes().get(1) == Some(&b':') && slashed.as_bytes()[0].is_ascii_alphabetic();
    let foreign = has_drive || slashed.starts_with('/') || slashed.starts_with("file:");
    let relative = if foreign { slashed.rsplit('/').next()? } else { &slashed };
    // A drive's current folder: `C:vol.raw`.
    let relative = if has_drive { relative.rsplit(':').next()? } else { relative };
    if relative.is_empty() {
        return None;
    }
    let path = folder.join(relative);
    if is_file(&path) {
        return Some(path);
    }
    in_other_letters(&path).or_else(|| (relative != name).then_some(path))
}

/// The only file of its folder with the name of this one, but for capital letters.
fn in_other_letters(path: &Path) -> Option<PathBuf> {
    let wanted = path.file_name()?.to_string_lossy().to_lowercase();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = fs::read_dir(folder).ok()?.take(MAX_ENTRIES).filter_map(Result::ok);
    let mut alike = entries.filter(|entry| entry.file_name().to_string_lossy().to_lowercase() == wanted);
    let found = alike.next()?;
    alike.next().is_none().then(|| path.with_file_name(found.file_name()))
}

/// Whether there is one; a file that comes later counts.
fn is_file(path: &Path) -> bool {
    trail::note(path);
    path.is_file()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn paths_of_other_machines_are_found_beside_the_header() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("my data")).unwrap();
        for name in ["vol.raw", "my data/vol 1.raw", "odd\\name.raw", "Mixed.RAW"] {
            fs::write(at(name), "").unwrap();
        }
        let found = |name: &str| {
            let mut notes = Vec::new();
            let paths = beside(&at("a.mhd"), &[name.to_owned()], &mut notes);
            (paths[0].strip_prefix(folder.path()).unwrap().display().to_string(), notes)
        };
        assert_eq!(found("vol.raw"), ("vol.raw".to_owned(), vec![]));
        // On systems where a backslash is a letter, it is.
        assert_eq!(found("odd\\name.raw"), ("odd\\name.raw".to_owned(), vec![]));
        for (name, path) in [
            ("my data\\vol 1.raw", "my data/vol 1.raw"),
            (".\\vol.raw", "vol.raw"),
            ("C:\\scans\\2019\\vol.raw", "vol.raw"),
            ("d:vol.raw", "vol.raw"),
            ("\\\\server\\share\\vol.raw", "vol.raw"),
            ("/home/other/vol.raw", "vol.raw"),
            ("\"vol.raw\"", "vol.raw"),
            ("mixed.raw", "Mixed.RAW"),
            ("C:\\MIXED.raw", "Mixed.RAW"),
        ] {
            let (found, notes) = found(name);
            assert_eq!(found, path, "{name}");
            assert!(notes.len() == 1 && notes[0].contains("which is no file here"), "{notes:?}");
        }
        assert_eq!(found("X:\\none.raw"), ("none.raw".to_owned(), vec![]));
        assert_eq!(found("none\\none.raw"), ("none/none.raw".to_owned(), vec![]));
        assert_eq!(found("none.raw"), ("none.raw".to_owned(), vec![]));
        let (long, _) = found(&"n".repeat(5000));
        assert_eq!(long, format!("{}…", "n".repeat(80)));
        let mut notes = Vec::new();
        beside(&at("a.mhd"), &["x:\\vol.raw".to_owned(), "x:\\mixed.raw".to_owned()], &mut notes);
        assert!(notes.len() == 1 && notes[0].ends_with("(and 1 more)"), "{notes:?}");
    }
}
