//! The data of an array of a .vti file: as text, as base64, or as they are, and in either case perhaps packed in blocks.

use std::{
    io::{self, BufRead, BufReader, Read, Seek, SeekFrom},
    path::Path,
};

use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::read::ZlibDecoder;

use super::header::{Array, Form, Header};
use crate::sources::{SourceError, file, volume::Endian};

/// Letters of base64 that are taken together: groups of four.
const GROUP: usize = 1 << 12;

/// A reader of an array's numbers.
pub(super) fn open(path: &Path, header: &Header, array: &Array) -> Result<Box<dyn BufRead>, SourceError> {
    let (mut file, _) = file::open(path)?;
    let (start, length, is_base64) = match (array.form, header.appended) {
        (Form::Appended, Some((appended, is_base64))) => {
            (appended.saturating_add(array.span.0), u64::MAX, is_base64)
        }
        (Form::Appended, None) => {
            return Err(SourceError::Field {
                path: path.to_owned(),
                field: "AppendedData".to_owned(),
                problem: "it is missing, but an array lies in it; the file is cut off".to_owned(),
            });
        }
        (form, _) => (array.span.0, array.span.1.saturating_sub(array.span.0), form == Form::Binary),
    };
    let io_error = |cause: io::Error| match cause.kind() {
        io::ErrorKind::InvalidData => SourceError::Packed {
            path: path.to_owned(),
            unpacked: 0,
            problem: format!("the base64 text of an array is corrupt ({cause})"),
            mend: "fetch or export it again",
        },
        _ => file::io_error(path, cause),
    };
    // A place beyond all files is beyond the end of this one.
    file.seek(SeekFrom::Start(start.min(i64::MAX as u64))).map_err(io_error)?;
    let reader = BufReader::new(file).take(length);
    if array.form == Form::Ascii {
        return Ok(Box::new(reader));
    }
    let mut reader: Box<dyn Read> = if is_base64 { Box::new(Base64::new(reader)) } else { Box::new(reader) };
    let lengths = Lengths { is_long: header.long_lengths, endian: header.endian };
    if header.is_packed {
        return Ok(Box::new(BufReader::new(Blocks::new(reader, lengths).map_err(io_error)?)));
    }
    let bytes = lengths.next(&mut reader).map_err(io_error)?;
    Ok(Box::new(BufReader::new(reader.take(bytes))))
}

/// How numbers in front of the data are written.
#[derive(Debug, Clone, Copy)]
struct Lengths {
    is_long: bool,
    endian: Endian,
}

impl Lengths {
    /// The next one; 0 where the data end.
    fn next(self, reader: &mut impl Read) -> io::Result<u64> {
        let mut bytes = Vec::with_capacity(8);
        let length = if self.is_long { 8 } else { 4 };
        reader.take(length as u64).read_to_end(&mut bytes)?;
        bytes.resize(length, 0);
        if self.endian == Endian::Big {
            bytes.reverse();
        }
        Ok(bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }
}

/// Blocks that are packed each for itself, one after the other.
struct Blocks<R> {
    reader: R,
    /// Lengths of the packed blocks, the last one first.
    lengths: Vec<u64>,
    block: Option<ZlibDecoder<io::Cursor<Vec<u8>>>>,
}

impl<R: Read> Blocks<R> {
    fn new(mut reader: R, lengths: Lengths) -> io::Result<Self> {
        let blocks = lengths.next(&mut reader)?;
        // Unpacked, each has the same length but for the last.
        lengths.next(&mut reader)?;
        lengths.next(&mut reader)?;
        let mut all = Vec::new();
        for _ in 0..blocks {
            match lengths.next(&mut reader)? {
                // The table of a damaged file goes on beyond its end.
                0 => break,
                length => all.push(length),
            }
        }
        all.reverse();
        Ok(Self { reader, lengths: all, block: None })
    }
}

impl<R: Read> Read for Blocks<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        loop {
            if let Some(block) = &mut self.block {
                let read = block.read(to)?;
                if read > 0 || to.is_empty() {
                    return Ok(read);
                }
            }
            let Some(length) = self.lengths.pop() else { return Ok(0) };
            let mut packed = Vec::new();
            (&mut self.reader).take(length).read_to_end(&mut packed)?;
            self.block = Some(ZlibDecoder::new(io::Cursor::new(packed)));
        }
    }
}

/// The bytes of base64. Where it is padded, another run may follow: lengths and data are often encoded each for itself. Anything
/// else than its letters ends it.
struct Base64<R> {
    reader: R,
    bytes: Vec<u8>,
    /// How many of the bytes were read.
    used: usize,
}

impl<R: BufRead> Base64<R> {
    fn new(reader: R) -> Self {
        Self { reader, bytes: Vec::new(), used: 0 }
    }

    /// Decodes the next letters, up to padding; none are left at the end.
    fn more(&mut self) -> io::Result<()> {
        let mut letters = Vec::with_capacity(GROUP);
        while letters.len() < GROUP {
            let Some(&letter) = self.reader.fill_buf()?.first() else { break };
            let is_padded = letters.last() == Some(&b'=');
            match letter {
                b'=' => {}
                b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'+' | b'/' if !is_padded => {}
                letter if letter.is_ascii_whitespace() => {
                    self.reader.consume(1);
                    continue;
                }
                _ => break,
            }
            letters.push(letter);
            self.reader.consume(1);
            if letter == b'=' && letters.len().is_multiple_of(4) {
                break;
            }
        }
        (self.bytes, self.used) = (vec![0; letters.len().div_ceil(4) * 3], 0);
        let decoded = STANDARD.decode_slice(&letters, &mut self.bytes);
        let decoded =
            decoded.map_err(|cause| io::Error::new(io::ErrorKind::InvalidData, cause.to_string()))?;
        self.bytes.truncate(decoded);
        Ok(())
    }
}

impl<R: BufRead> Read for Base64<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.used == self.bytes.len() {
            self.more()?;
        }
        let left = &self.bytes[self.used..];
        let copied = left.len().min(to.len());
        to[..copied].copy_from_slice(&left[..copied]);
        self.used += copied;
        Ok(copied)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn base64_goes_on_behind_padding() {
        let read = |text: &str| {
            let mut bytes = Vec::new();
            Base64::new(text.as_bytes()).read_to_end(&mut bytes).map(|_| bytes)
        };
        assert_eq!(read("AQI=\n Aw==BAUG</DataArray>").unwrap(), [1, 2, 3, 4, 5, 6]);
        assert_eq!(read(&STANDARD.encode([7; 10_000])).unwrap(), [7; 10_000]);
        assert!(read("").unwrap().is_empty());
        assert!(read("AQ").is_err() && read("A=I=").is_err());
    }
}
