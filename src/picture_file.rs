//! Pictures as files, which are there whole or not at all, and as streams of frames.

mod encode;
mod format;
mod video;

pub(crate) use encode::EncodeError;
pub(crate) use format::Format;

use crate::render::{Image, Pixels};
use crate::whole_file::{self, Staged};
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum WriteError {
    /// The picture does not fit the format.
    #[error("cannot encode {}: {source}", .path.display())]
    Encode {
        /// The file that it was for.
        path: PathBuf,
        /// What the encoder says.
        source: EncodeError,
    },
    /// The system refused.
    #[error("cannot write {}: {source}{}", .path.display(), mend(source))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// Whether another place would do.
pub(crate) fn is_place_at_fault(error: &io::Error) -> bool {
    use io::ErrorKind::{
        InvalidFilename, IsADirectory, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem,
    };
    [PermissionDenied, NotFound, IsADirectory, NotADirectory, InvalidFilename, ReadOnlyFilesystem]
        .contains(&error.kind())
}

fn mend(error: &io::Error) -> &'static str {
    match error.kind() {
        _ if is_place_at_fault(error) => "; choose another place",
        io::ErrorKind::StorageFull => "; free some space and try again",
        _ => "",
    }
}

/// Encodes an image, as what it holds asks for, and writes it: as PNG or EXR.
pub(crate) fn write_image(path: &Path, image: &Image) -> Result<(), WriteError> {
    let format = match image.pixels {
        Pixels::Radiance(_) => Format::Exr,
        Pixels::Encoded(_) => Format::Png,
    };
    write(path, &encode(path, image, format)?)
}

/// Encodes an image for a file.
pub(crate) fn encode(path: &Path, image: &Image, format: Format) -> Result<Vec<u8>, WriteError> {
    encode::encode(image, format).map_err(|source| WriteError::Encode { path: path.to_owned(), source })
}

/// Writes a file that is there whole or not at all.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    whole_file::write(path, bytes).map_err(|source| WriteError::Write { path: path.to_owned(), source })
}

/// Frames behind each other: in a file, which is there whole or not at all, or on a stream.
pub(crate) struct Frames {
    path: PathBuf,
    format: Format,
    /// Frames a second.
    rate: f64,
    sink: Sink,
    is_begun: bool,
}

enum Sink {
    File(Staged),
    /// A device, a pipe.
    Device(File),
    /// Standard output.
    Standard(io::Stdout),
}

impl Frames {
    /// Frames on standard output.
    pub fn to_standard_output(format: Format, rate: f64) -> Self {
        let sink = Sink::Standard(io::stdout());
        Self { path: "standard output".into(), format, rate, sink, is_begun: false }
    }

    /// Frames in a file.
    pub fn to_file(path: &Path, format: Format, rate: f64) -> Result<Self, WriteError> {
        let opened = if path.exists() && !path.is_file() {
            File::options().write(true).open(path).map(Sink::Device)
        } else {
            Staged::begin(path).map(Sink::File)
        };
        let sink = opened.map_err(|source| WriteError::Write { path: path.to_owned(), source })?;
        Ok(Self { path: path.to_owned(), format, rate, sink, is_begun: false })
    }

    /// Appends a frame.
    pub fn write(&mut self, image: &Image) -> Result<(), WriteError> {
        let mut bytes = Vec::new();
        if !self.is_begun && self.format == Format::Y4m {
            bytes = video::head(image.width, image.height, video::ratio(self.rate)).into_bytes();
        }
        bytes.extend(encode(&self.path, image, self.format)?);
        self.is_begun = true;
        let written = match &mut self.sink {
            Sink::File(file) => file.write_all(&bytes),
            Sink::Device(file) => file.write_all(&bytes),
            Sink::Standard(stdout) => stdout.write_all(&bytes).and_then(|()| stdout.flush()),
        };
        self.told(written)
    }

    /// Puts the file in its place.
    pub fn finish(self) -> Result<(), WriteError> {
        let Self { path, sink, .. } = self;
        let done = match sink {
            Sink::File(file) => file.finish().and_then(Staged::commit),
            Sink::Device(mut file) => file.flush(),
            Sink::Standard(mut stdout) => stdout.flush(),
        };
        done.map_err(|source| WriteError::Write { path, source })
    }

    fn told(&self, written: io::Result<()>) -> Result<(), WriteError> {
        written.map_err(|source| WriteError::Write { path: self.path.clone(), source })
    }
}
