//! Text in files of samples: the lines of a header, and samples written out.

mod hex;
mod number;

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Read, Seek, SeekFrom},
    path::Path,
};

pub(super) use hex::HexReader;
pub(super) use number::{number, numbers};

use super::{
    SourceError, file,
    stored::{Stored, with_samples},
    stream::SampleStream,
};

/// The longest line and the longest header that are read, in bytes.
const MAX_LINE: u64 = 1 << 16;
const MAX_HEADER: u64 = 1 << 22;

/// What Windows' editors put in front of text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The longest number written out, in bytes.
const MAX_NUMBER: usize = 400;

/// The bytes of a text without the byte order mark that may stand in front of it.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes)
}

/// The lines of a header, with samples after it or between them.
pub(super) struct HeaderLines<'a> {
    path: &'a Path,
    reader: BufReader<File>,
    /// The line that was read last, counted from 1.
    pub line: u64,
    /// Bytes that were read.
    pub offset: u64,
    /// How many of them were lines.
    in_lines: u64,
    /// Length of the file.
    bytes: u64,
}

impl<'a> HeaderLines<'a> {
    /// Opens a file.
    pub fn open(path: &'a Path) -> Result<Self, SourceError> {
        let (file, bytes) = file::open(path)?;
        Ok(Self { path, reader: BufReader::new(file), line: 0, offset: 0, in_lines: 0, bytes })
    }

    /// The next line without its end, and without a mark in front of the first; `None` at the end of the file. Bytes that are
    /// no UTF-8 become U+FFFD.
    pub fn next(&mut self) -> Result<Option<String>, SourceError> {
        let mut bytes = Vec::new();
        let is_first = self.offset == 0;
        self.line += 1;
        let read = (&mut self.reader).take(MAX_LINE).read_until(b'\n', &mut bytes);
        let read = read.map_err(|cause| file::io_error(self.path, cause))? as u64;
        self.offset += read;
        self.in_lines += read;
        if read == MAX_LINE || self.in_lines > MAX_HEADER {
            return Err(self.error("the header goes on and on; is its end, or the file, damaged?"));
        }
        if bytes.is_empty() {
            return Ok(None);
        }
        let bytes = if is_first { without_mark(&bytes) } else { &bytes };
        let text = String::from_utf8_lossy(bytes);
        Ok(Some(text.trim_end_matches(['\n', '\r']).to_owned()))
    }

    /// Goes over so many bytes without reading them; whether the file has them.
    pub fn skip_bytes(&mut self, bytes: u64) -> Result<bool, SourceError> {
        let to = self.offset.saturating_add(bytes);
        if to > self.bytes {
            return Ok(false);
        }
        self.reader.seek(SeekFrom::Start(to)).map_err(|cause| file::io_error(self.path, cause))?;
        self.offset = to;
        Ok(true)
    }

    /// The next byte; `None` at the end of the file.
    pub fn byte(&mut self) -> Result<Option<u8>, SourceError> {
        let buffer = self.reader.fill_buf().map_err(|cause| file::io_error(self.path, cause))?;
        let byte = buffer.first().copied();
        self.reader.consume(usize::from(byte.is_some()));
        self.offset += u64::from(byte.is_some());
        Ok(byte)
    }

    /// Goes over all that is left.
    pub fn skip_to_end(&mut self) -> Result<(), SourceError> {
        self.skip_bytes(self.bytes.saturating_sub(self.offset)).map(|_| ())
    }

    /// Goes over so many numbers or words; whether the file has them. The end of the last one's line comes next.
    pub fn skip_words(&mut self, words: u64) -> Result<bool, SourceError> {
        let (mut left, mut in_word) = (words, false);
        while left > 0 {
            let buffer = self.reader.fill_buf().map_err(|cause| file::io_error(self.path, cause))?;
            if buffer.is_empty() {
                return Ok(left == 1 && in_word);
            }
            let mut used = 0;
            for byte in buffer {
                let space = byte.is_ascii_whitespace();
                if in_word && space {
                    left -= 1;
                }
                in_word = !space;
                if left == 0 {
                    break;
                }
                used += 1;
                self.line += u64::from(*byte == b'\n');
            }
            self.offset += used as u64;
            self.reader.consume(used);
        }
        Ok(true)
    }

    /// Something wrong with the last line.
    pub fn error(&self, problem: impl Into<String>) -> SourceError {
        line_error(self.path, self.line, problem)
    }
}

/// Something wrong with a line.
pub(super) fn line_error(path: &Path, line: u64, problem: impl Into<String>) -> SourceError {
    SourceError::Line { path: path.to_owned(), line, problem: problem.into() }
}

/// Reads samples written out as numbers between spaces or commas.
pub(super) fn read_samples(stream: &SampleStream, mut reader: impl BufRead) -> Result<Stored, SourceError> {
    let mut stored = stream.format.none();
    let needed = stream.pick.end(stream.samples);
    with_samples!(&mut stored, samples => {
        // The memory grows with what is there: two bytes of text at the least for a sample of at most eight.
        let mut words = 0;
        while (samples.len() as u64) < stream.samples {
            let is_read = stream.pick.run(words).0 == words;
            words += 1;
            let word = next_word(&mut reader).map_err(|cause| file::io_error(stream.path, cause))?;
            let Some(word) = word else {
                return Err(SourceError::Length {
                    path: stream.path.to_owned(),
                    found: format!("{} numbers", words - 1),
                    expected: format!("{} need {needed}", stream.what),
                    difference: format!("{} fewer than expected", needed + 1 - words),
                    mend: (stream.mend)(None),
                });
            };
            if !is_read {
                continue;
            }
            samples.try_reserve(1).map_err(|_| stream.out_of_memory())?;
            samples.push(number(&word).ok_or_else(|| SourceError::Field {
                path: stream.path.to_owned(),
                field: format!("sample {words}"),
                problem: format!("expected a number of type {:?}, found `{word}`", stream.format),
            })?);
        }
    });
    Ok(stored)
}

/// The next run of bytes without space and comma; a run that is too long for a number is cut.
fn next_word(reader: &mut impl BufRead) -> io::Result<Option<String>> {
    let is_space = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
    let mut word = Vec::new();
    loop {
        let buffer = reader.fill_buf()?;
        let spaces =
            if word.is_empty() { buffer.iter().take_while(|byte| is_space(byte)).count() } else { 0 };
        let letters = buffer[spaces..].iter().take_while(|byte| !is_space(byte)).count();
        word.extend_from_slice(&buffer[spaces..spaces + letters]);
        let (used, end) = (spaces + letters, spaces + letters < buffer.len() || buffer.is_empty());
        reader.consume(used);
        if end || word.len() > MAX_NUMBER {
            word.truncate(MAX_NUMBER);
            return Ok((!word.is_empty()).then(|| String::from_utf8_lossy(&word).into_owned()));
        }
    }
}

#[cfg(test)]
mod tests;
