//! On which entries of which folders a path depends.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

/// Links that are followed; more are a circle.
const MAX_LINKS: usize = 40;

/// The entries of folders that decide what a path leads to: each link on the way, and where it ends; that is the first part that does not
/// exist, or else the file itself. Folders among what lies above are taken as they are. No folder of an entry is a link.
pub(super) fn entries(path: &Path) -> Vec<PathBuf> {
    let Ok(path) = std::path::absolute(path) else { return vec![path.to_owned()] };
    let mut entries = Vec::new();
    let mut at = PathBuf::new();
    let mut ahead: VecDeque<OsString> = path.components().map(owned).collect();
    while let Some(part) = ahead.pop_front() {
        match Path::new(&part).components().next() {
            Some(Component::Normal(name)) => {
                let next = at.join(name);
                match std::fs::symlink_metadata(&next) {
                    Err(_) => {
                        entries.push(next);
                        return entries;
                    }
                    Ok(metadata) if metadata.is_symlink() => {
                        let target = std::fs::read_link(&next);
                        entries.push(next);
                        let (Ok(target), true) = (target, entries.len() <= MAX_LINKS) else { return entries };
                        for part in target.components().rev() {
                            ahead.push_front(owned(part));
                        }
                    }
                    Ok(_) => at = next,
                }
            }
            // Nothing above is a link any more, so that up is up.
            Some(Component::ParentDir) => {
                at.pop();
            }
            Some(Component::CurDir) | None => {}
            // Pushing the beginning of a path replaces what is there.
            Some(Component::RootDir | Component::Prefix(_)) => at.push(part),
        }
    }
    entries.push(at);
    entries
}

fn owned(part: Component) -> OsString {
    part.as_os_str().to_owned()
}

/// The folders to watch for these entries: those that they are in, and the last one itself if it is a folder, all of whose entries count.
pub(super) fn folders(entries: &[PathBuf]) -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> =
        entries.iter().filter_map(|entry| entry.parent()).map(Path::to_owned).collect();
    folders.extend(entries.last().filter(|last| last.is_dir()).cloned());
    folders.sort_unstable();
    folders.dedup();
    folders
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn links_missing_parts_and_circles() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        let at = |name: &str| root.join(name);
        std::fs::create_dir_all(at("real/deep")).unwrap();
        std::fs::write(at("real/deep/file"), "").unwrap();
        assert_eq!(entries(&at("real/./deep/../deep/file")), [at("real/deep/file")]);
        assert_eq!(entries(&at("real/none/file")), [at("real/none")]);
        symlink("real/deep", at("link")).unwrap();
        symlink(at("link/file"), at("real/other")).unwrap();
        assert_eq!(entries(&at("link/file")), [at("link"), at("real/deep/file")]);
        assert_eq!(entries(&at("real/other")), [at("real/other"), at("link"), at("real/deep/file")]);
        assert_eq!(folders(&entries(&at("link"))), [root.clone(), at("real"), at("real/deep")]);
        symlink("b", at("a")).unwrap();
        symlink("a", at("b")).unwrap();
        assert!(entries(&at("a")).len() > MAX_LINKS);
        std::fs::remove_file(at("real/deep/file")).unwrap();
        assert_eq!(entries(&at("link/file")), [at("link"), at("real/deep/file")]);
    }
}
