//! A file some bytes of which read otherwise than they are written, for what `tiff` 0.11 does not read as it is.

use std::{
    fs::File,
    io::{self, Read, Seek, SeekFrom},
    path::Path,
};

use tiff::tags::{ByteOrder, Tag};

use super::pages::Pixels;
use crate::sources::{SourceError, file};

/// Where a byte stands, and what it reads as.
pub(super) type Patch = (u64, u8);

/// Bytes that packed data get behind their own, more than a decoder of LZW looks ahead.
const MARGIN: u64 = 16;

/// The most chunks of a page that are given any.
const MAX_CHUNKS: u64 = 1 << 20;

/// A file, and bytes that stand in place of its own.
pub(super) struct Patched<R> {
    file: R,
    at: u64,
    /// Where it ends. If anything is patched, zeros follow.
    end: u64,
    /// In ascending order.
    patches: Vec<Patch>,
}

impl<R: Read + Seek> Patched<R> {
    /// The same bytes from the beginning, but for these, of a file of so many.
    pub fn new(file: R, bytes: u64, mut patches: Vec<Patch>) -> Self {
        patches.sort_unstable();
        let end = if patches.is_empty() { bytes } else { bytes.saturating_add(MARGIN) };
        Self { file, at: 0, end, patches }
    }
}

impl<R: Read> Read for Patched<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let mut read = self.file.read(to)?;
        if read == 0 && self.at < self.end && !self.patches.is_empty() {
            read = usize::try_from(self.end - self.at).unwrap_or(usize::MAX).min(to.len());
            to[..read].fill(0);
        }
        let end = self.at + read as u64;
        let first = self.patches.partition_point(|(place, _)| *place < self.at);
        for (place, byte) in self.patches[first..].iter().take_while(|(place, _)| *place < end) {
            to[(place - self.at) as usize] = *byte;
        }
        self.at = end;
        Ok(read)
    }
}

impl<R: Seek> Seek for Patched<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = self.file.seek(to)?;
        Ok(self.at)
    }
}

/// What makes the page that a decoder is at one of gray: where the meaning of its samples is written, and that they are brightness.
pub(super) fn as_gray(path: &Path, decoder: &mut Pixels) -> Result<Vec<Patch>, SourceError> {
    const BLACK_IS_ZERO: u64 = 1;
    let mut directory = Directory::open(path, decoder)?;
    let found = directory.find(&[Tag::PhotometricInterpretation])?;
    // A word in the place of the value, which comes last.
    Ok(found.map_or_else(Vec::new, |entry| directory.number(entry.value, 2, BLACK_IS_ZERO)))
}

/// What makes the packed data of the page that a decoder is at longer, by what follows them in the file: reading a tile row by row, `tiff`
/// takes it for cut off where the last rows come out of the last eight bytes (<https://github.com/image-rs/image-tiff/issues/395>).
pub(super) fn longer(path: &Path, decoder: &mut Pixels) -> Result<Vec<Patch>, SourceError> {
    const WORD: u64 = 3;
    const LONG_8: u64 = 16;
    let mut directory = Directory::open(path, decoder)?;
    let Some(entry) = directory.find(&[Tag::StripByteCounts, Tag::TileByteCounts])? else {
        return Ok(Vec::new());
    };
    let bytes = match entry.kind {
        WORD => 2,
        LONG_8 => 8,
        _ => 4,
    };
    let count = entry.count.min(MAX_CHUNKS).min(directory.file_bytes / bytes);
    let within = count * bytes <= directory.inline;
    let first = if within { entry.value } else { directory.read(entry.value, directory.inline)? };
    let mut patches = Vec::new();
    for place in (0..count).map(|chunk| first.saturating_add(chunk * bytes)) {
        let longer = directory.read(place, bytes)?.saturating_add(MARGIN);
        if longer >> (8 * bytes - 1) == 0 {
            patches.extend(directory.number(place, bytes, longer));
        }
    }
    Ok(patches)
}

/// The entries of a page, as they are written.
struct Directory {
    file: io::BufReader<File>,
    path: std::path::PathBuf,
    file_bytes: u64,
    is_big_endian: bool,
    /// Where it begins.
    at: Option<u64>,
    /// Whether its numbers are of 64 bits.
    is_big: bool,
    /// Bytes of values that stand in the entry itself.
    inline: u64,
}

/// One of them.
struct Entry {
    kind: u64,
    count: u64,
    /// Where its value stands, or where that is written.
    value: u64,
}

impl Directory {
    fn open(path: &Path, decoder: &mut Pixels) -> Result<Self, SourceError> {
        let (file, file_bytes) = file::open(path)?;
        let mut directory = Self {
            file: io::BufReader::new(file),
            path: path.to_owned(),
            file_bytes,
            is_big_endian: decoder.byte_order() == ByteOrder::BigEndian,
            at: decoder.ifd_pointer().map(|pointer| pointer.0),
            is_big: false,
            inline: 4,
        };
        if directory.read(2, 2)? == 43 {
            (directory.is_big, directory.inline) = (true, 8);
        }
        Ok(directory)
    }

    /// The first entry of one of these names.
    fn find(&mut self, tags: &[Tag]) -> Result<Option<Entry>, SourceError> {
        let Some(begin) = self.at else { return Ok(None) };
        let (count_bytes, entry_bytes) = if self.is_big { (8, 20) } else { (2, 12) };
        let entries = self.read(begin, count_bytes)?.min(self.file_bytes / entry_bytes);
        for at in (0..entries).map(|entry| begin.saturating_add(count_bytes + entry * entry_bytes)) {
            let tag = self.read(at, 2)?;
            if tags.iter().any(|wanted| u64::from(wanted.to_u16()) == tag) {
                let (kind, count) = (self.read(at + 2, 2)?, self.read(at + 4, self.inline)?);
                return Ok(Some(Entry { kind, count, value: at + 4 + self.inline }));
            }
        }
        Ok(None)
    }

    /// A number of so many bytes.
    fn read(&mut self, at: u64, bytes: u64) -> Result<u64, SourceError> {
        let mut number = vec![0; bytes as usize];
        let read = self.file.seek(SeekFrom::Start(at.min(i64::MAX as u64)));
        read.and_then(|_| self.file.read_exact(&mut number)).map_err(|cause| match cause.kind() {
            io::ErrorKind::UnexpectedEof => SourceError::Field {
                path: self.path.clone(),
                field: "TIFF directory".to_owned(),
                problem: "it goes on behind the end of the file, which is cut off: fetch or export it again"
                    .to_owned(),
            },
            _ => file::io_error(&self.path, cause),
        })?;
        if !self.is_big_endian {
            number.reverse();
        }
        Ok(number.iter().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }

    /// What makes so many bytes read as a number.
    fn number(&self, at: u64, bytes: u64, number: u64) -> Vec<Patch> {
        let byte = |place: u64| if self.is_big_endian { bytes - 1 - place } else { place };
        (0..bytes).map(|place| (at + place, (number >> (8 * byte(place))) as u8)).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn only_the_bytes_that_are_named_differ() {
        let mut file = Patched::new(io::Cursor::new([0_u8; 10]), 10, vec![(7, 70), (2, 20), (3, 30)]);
        let mut bytes = [9; 5];
        file.read_exact(&mut bytes[..3]).unwrap();
        assert_eq!(bytes, [0, 0, 20, 9, 9]);
        file.read_exact(&mut bytes).unwrap();
        assert_eq!(bytes, [30, 0, 0, 0, 70]);
        file.seek(SeekFrom::Start(7)).unwrap();
        file.read_exact(&mut bytes[..1]).unwrap();
        assert_eq!(bytes[0], 70);
        // Zeros follow, but only if something is patched.
        let mut rest = vec![5];
        file.read_to_end(&mut rest).unwrap();
        assert_eq!(rest, [[5].as_slice(), &[0; 18]].concat());
        let mut plain = Vec::new();
        Patched::new(io::Cursor::new([1_u8; 3]), 3, Vec::new()).read_to_end(&mut plain).unwrap();
        assert_eq!(plain, [1; 3]);
    }
}
