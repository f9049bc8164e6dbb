//! Files that are files: opening a pipe waits for whoever writes to it, perhaps for ever, and opening a device may do something.

use std::fs::{File, Metadata};
use std::io::{self, Read};
use std::path::Path;

/// Why a file was not opened.
#[derive(Debug)]
pub(crate) enum Unopened {
    /// It is something else: "a folder", "a pipe".
    NotAFile(&'static str),
    /// The system refused.
    Io(io::Error),
}

impl From<io::Error> for Unopened {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// What it is that is no file; nothing where it is one.
pub(crate) fn other_kind(metadata: &Metadata) -> Option<&'static str> {
    let kind = metadata.file_type();
    if kind.is_file() {
        return None;
    }
    if kind.is_dir() {
        return Some("a folder");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return Some("a pipe");
        }
        if kind.is_socket() {
            return Some("a socket");
        }
    }
    Some("a device")
}

/// An open file, and how it is. What is something else is not opened.
pub(crate) fn open(path: &Path) -> Result<(File, Metadata), Unopened> {
    open_known(path, &std::fs::metadata(path)?)
}

/// The same of a file that was just asked how it is.
pub(crate) fn open_known(path: &Path, metadata: &Metadata) -> Result<(File, Metadata), Unopened> {
    let checked =
        |metadata: &Metadata| other_kind(metadata).map_or(Ok(()), |kind| Err(Unopened::NotAFile(kind)));
    checked(metadata)?;
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        // Should there be a pipe by now, opening it waits for nobody. Files are read as ever.
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits().cast_signed());
    }
    let file = options.open(path)?;
    let metadata = file.metadata()?;
    checked(&metadata)?;
    Ok((file, metadata))
}

/// All bytes of a file, or the first `most` and one more of a longer one.
pub(crate) fn read(path: &Path, most: u64) -> Result<Vec<u8>, Unopened> {
    let (file, _) = open(path)?;
    let mut bytes = Vec::new();
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_file_is_named_and_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let found = |path: &Path| match read(path, 9) {
            Err(Unopened::NotAFile(kind)) => kind,
            other => panic!("{path:?}: {other:?}"),
        };
        assert!(std::process::Command::new("mkfifo").arg(at("pipe")).status().unwrap().success());
        std::os::unix::fs::symlink("pipe", at("link")).unwrap();
        let _socket = std::os::unix::net::UnixListener::bind(at("socket")).unwrap();
        assert_eq!((found(&at("pipe")), found(&at("link"))), ("a pipe", "a pipe"));
        assert_eq!((found(&at("socket")), found(folder.path())), ("a socket", "a folder"));
        assert_eq!(found(Path::new("/dev/zero")), "a device");
        // It took the place of a file after that was looked at.
        std::fs::write(at("file"), "0123456789").unwrap();
        let before = std::fs::metadata(at("file")).unwrap();
        assert!(matches!(open_known(&at("pipe"), &before), Err(Unopened::NotAFile("a pipe"))));
        assert_eq!(read(&at("file"), 3).unwrap(), b"0123");
    }
}
