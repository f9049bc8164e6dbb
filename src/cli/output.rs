//! Where results are written to.

use super::arguments::RenderArguments;
use super::exit::Failure;
use crate::picture_file::{self, Format, Frames, WriteError, is_place_at_fault};
use crate::plain;
use crate::render::Image;
use crate::whole_file::folder_of;
use std::io::{ErrorKind, IsTerminal};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Where pictures go, and as what.
pub(super) struct Output {
    pub format: Format,
    to: To,
    /// Frames a second.
    rate: f64,
    /// What all pictures go into, from the first on.
    stream: Option<Frames>,
}

enum To {
    /// A file for each.
    Files {
        path: PathBuf,
        is_numbered: bool,
    },
    /// One file for all.
    File(PathBuf),
    Standard,
}

impl Output {
    /// What is asked for, or why that cannot be.
    pub fn of(arguments: &RenderArguments) -> Result<Self, Failure> {
        let path = arguments.output.clone();
        let is_standard = path == Path::new("-");
        let format = arguments.format.or_else(|| Format::of(&path)).or(is_standard.then_some(Format::Png));
        let format = format.ok_or_else(|| {
            Failure::Usage(plain::message(&format!(
                "cannot tell what to write to {}: a picture is written as .png or .exr, a video as .y4m or .rgb; else say --format",
                path.display()
            )))
        })?;
        if arguments.transparent && !format.has_alpha() {
            return Err(Failure::Usage(
                "a y4m video cannot leave the background out; write --format raw, which has alpha then"
                    .into(),
            ));
        }
        if is_standard && std::io::stdout().is_terminal() {
            return Err(Failure::Usage(
                "standard output is a terminal, which shows no pictures; pipe it, or name a file".into(),
            ));
        }
        let to = match format.is_sequence() {
            _ if is_standard => To::Standard,
            true => To::File(path),
            false => To::Files { path, is_numbered: arguments.frames.is_some() },
        };
        Ok(Self { format, to, rate: arguments.fps, stream: None })
    }

    /// The files that pictures are written to.
    pub fn files(&self, frames: Range<u64>) -> Vec<PathBuf> {
        match &self.to {
            To::Standard => Vec::new(),
            To::File(path) | To::Files { path, is_numbered: false } => vec![path.clone()],
            To::Files { path, is_numbered: true } => frames.map(|frame| frame_path(path, frame)).collect(),
        }
    }

    /// Encodes a picture and writes it.
    pub fn write(&mut self, frame: u64, image: &Image) -> Result<(), Failure> {
        let stream = match (&mut self.stream, &self.to) {
            (None, To::Files { path, is_numbered }) => {
                let path = if *is_numbered { frame_path(path, frame) } else { path.clone() };
                return write(&path, &picture_file::encode(&path, image, self.format)?);
            }
            (Some(stream), _) => stream,
            (stream, To::File(path)) => stream.insert(Frames::to_file(path, self.format, self.rate)?),
            (stream, To::Standard) => stream.insert(Frames::to_standard_output(self.format, self.rate)),
        };
        Ok(stream.write(image)?)
    }

    /// To be called once all is written.
    pub fn finish(self) -> Result<(), Failure> {
        Ok(self.stream.map_or(Ok(()), Frames::finish)?)
    }
}

/// `out_0007.png`.
fn frame_path(output: &Path, frame: u64) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    match output.extension() {
        Some(ending) => output.with_file_name(format!("{stem}_{frame:04}.{}", ending.to_string_lossy())),
        None => output.with_file_name(format!("{stem}_{frame:04}")),
    }
}

/// Says before any work is done if the folder to write to is not there.
pub(super) fn check_folder(path: &Path) -> Result<(), Failure> {
    let folder = folder_of(path);
    if folder.is_dir() {
        return Ok(());
    }
    Err(Failure::Usage(format!("cannot write {}: there is no folder {}", path.display(), folder.display())))
}

/// Writes a file that is there whole or not at all.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    Ok(picture_file::write(path, bytes)?)
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        match &error {
            WriteError::Write { source, .. } if source.kind() == ErrorKind::BrokenPipe => Self::Unread,
            WriteError::Write { source, .. } if is_place_at_fault(source) => Self::Usage(error.to_string()),
            _ => Self::Machine(error.to_string()),
        }
    }
}
