//! What a window was like when it was last closed.

use crate::regular_file::{self, Unopened};
use crate::ui::{OpenPanels, Recent};
use crate::whole_file;
use etcetera::{AppStrategy, AppStrategyArgs};
use serde::{Deserialize, Serialize};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The window as it was. Lengths are in pixels.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Remembered {
    /// Across and down, without its frame.
    pub size: Option<(u32, u32)>,
    /// Of the upper left corner of its frame, from that of the screen; Wayland tells no one.
    pub position: Option<(i32, i32)>,
    /// Whether it covered the screen.
    pub maximized: bool,
    /// Which panels were open.
    pub panels: OpenPanels,
    /// The files that were opened last.
    pub recent: Recent,
}

/// A file with more bytes than this is not one that was written here.
const LONGEST: u64 = 1 << 16;

/// Sizes that a window may be opened with.
const SIZES: std::ops::RangeInclusive<u32> = 64..=16_384;

impl Remembered {
    /// Where the user's configuration of Tyndall is kept.
    pub fn path() -> Option<PathBuf> {
        let names = AppStrategyArgs {
            top_level_domain: String::new(),
            author: String::new(),
            app_name: "tyndall".into(),
        };
        Some(etcetera::choose_app_strategy(names).ok()?.in_config_dir("window.ron"))
    }

    /// What the file says. One that is not there says nothing; why another cannot be read is told.
    pub fn load(path: &Path) -> (Self, Option<String>) {
        let text = match read(path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return (Self::default(), None),
            Err(error) => return (Self::default(), Some(complaint(path, &error))),
        };
        match ron::from_str::<Self>(&text) {
            Ok(remembered) => (remembered.sensible(), None),
            Err(error) => (Self::default(), Some(complaint(path, &error))),
        }
    }

    /// Writes the file, and its folder if need be.
    pub fn save(&self, path: &Path) -> io::Result<()> {
        let text = ron::ser::to_string_pretty(self, Default::default()).map_err(io::Error::other)?;
        let folder = path.parent().unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder)?;
        // Two windows may be closed at once: whoever reads finds one of them whole.
        whole_file::write(path, text.as_bytes())
    }

    fn sensible(mut self) -> Self {
        self.size = self.size.filter(|(width, height)| SIZES.contains(width) && SIZES.contains(height));
        self
    }
}

fn read(path: &Path) -> io::Result<String> {
    match regular_file::read(path, LONGEST) {
        Ok(bytes) if bytes.len() as u64 > LONGEST => Err(io::Error::other("it is too long to be one")),
        Ok(bytes) => String::from_utf8(bytes).map_err(io::Error::other),
        Err(Unopened::NotAFile(found)) => Err(io::Error::other(format!("it is {found}"))),
        Err(Unopened::Io(error)) => Err(error),
    }
}

fn complaint(path: &Path, error: &dyn std::fmt::Display) -> String {
    format!(
        "{}: what the window was like cannot be read, and so it opens as it first did: {error}",
        path.display()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_is_remembered() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/window.ron");
        assert_eq!(Remembered::load(&path), (Remembered::default(), None));
        let window = Remembered {
            size: Some((1234, 567)),
            position: Some((-40, 30)),
            maximized: false,
            panels: OpenPanels { log: true, ..Default::default() },
            recent: Recent(vec!["/a/b.ron".into(), "/c".into()]),
        };
        window.save(&path).unwrap();
        assert_eq!(Remembered::load(&path), (window.clone(), None));
        window.save(&path).unwrap();
        assert_eq!(folder.path().join("deep").read_dir().unwrap().count(), 1);
    }

    #[test]
    fn what_cannot_be_read_is_told_and_does_no_harm() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("window.ron");
        for bytes in
            [b"(size: ".to_vec(), vec![0xff; 10], vec![b'('; 1 << 20], b"(size: Some((-1, 2)))".to_vec()]
        {
            std::fs::write(&path, bytes).unwrap();
            let (window, told) = Remembered::load(&path);
            assert_eq!(window, Remembered::default());
            assert!(told.unwrap().contains("window.ron"));
        }
        // A folder in its place.
        let (window, told) = Remembered::load(folder.path());
        assert_eq!(window, Remembered::default());
        assert!(told.is_some());
    }

    #[test]
    fn senseless_sizes_are_not_taken_and_missing_fields_are_made_up() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("window.ron");
        for (text, size) in [
            ("(size: Some((0, 500)))", None),
            ("(size: Some((4000000000, 500)), later: 3)", None),
            ("(size: Some((800, 500)), panels: (log: true))", Some((800, 500))),
        ] {
            std::fs::write(&path, text).unwrap();
            let (window, told) = Remembered::load(&path);
            assert_eq!((window.size, told), (size, None), "{text}");
        }
    }
}
