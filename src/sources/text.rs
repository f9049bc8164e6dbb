//! Text in files of samples: the lines of a header, and samples written out.

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Read},
    path::Path,
};

use super::{
    SourceError, file,
    stored::{Element, Stored, with_samples},
    stream::SampleStream,
};

/// The longest line and the longest header that are read, in bytes.
const MAX_LINE: u64 = 1 << 16;
const MAX_HEADER: u64 = 1 << 22;

/// The longest number written out, in bytes.
const MAX_NUMBER: usize = 400;

/// The lines of a header, with samples after it.
pub(super) struct HeaderLines<'a> {
    path: &'a Path,
    reader: BufReader<File>,
    /// The line that was read last, counted from 1.
    pub line: u64,
    /// Bytes that were read.
    pub offset: u64,
}

impl<'a> HeaderLines<'a> {
    /// Opens a file.
    pub fn open(path: &'a Path) -> Result<Self, SourceError> {
        let (file, _) = file::open(path)?;
        Ok(Self { path, reader: BufReader::new(file), line: 0, offset: 0 })
    }

    /// The next line without its end; `None` at the end of the file. Bytes that are no UTF-8 become U+FFFD.
    pub fn next(&mut self) -> Result<Option<String>, SourceError> {
        let mut bytes = Vec::new();
        self.line += 1;
        let read = (&mut self.reader).take(MAX_LINE).read_until(b'\n', &mut bytes);
        self.offset += read.map_err(|cause| file::io_error(self.path, cause))? as u64;
        if bytes.len() as u64 == MAX_LINE || self.offset > MAX_HEADER {
            return Err(self.error("the header goes on and on; is its end, or the file, damaged?"));
        }
        if bytes.is_empty() {
            return Ok(None);
        }
        let text = String::from_utf8_lossy(&bytes);
        Ok(Some(text.trim_end_matches(['\n', '\r']).to_owned()))
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

/// Splits into numbers, all of which must be; `None` if one is not.
pub(super) fn numbers<T: std::str::FromStr>(text: &str) -> Option<Vec<T>> {
    text.split_whitespace().map(|word| word.parse().ok()).collect()
}

/// Reads samples written out as numbers between spaces or commas.
pub(super) fn read_samples(stream: &SampleStream, mut reader: impl BufRead) -> Result<Stored, SourceError> {
    let mut stored = stream.format.none();
    with_samples!(&mut stored, samples => {
        // The memory grows with what is there: two bytes of text at the least for a sample of at most eight.
        while (samples.len() as u64) < stream.samples {
            let at = samples.len() as u64 + 1;
            let word = next_word(&mut reader).map_err(|cause| file::io_error(stream.path, cause))?;
            let Some(word) = word else {
                return Err(SourceError::Length {
                    path: stream.path.to_owned(),
                    found: format!("{} numbers", samples.len()),
                    expected: format!("{} need {}", stream.what, stream.samples),
                    difference: format!("{} fewer than expected", stream.samples - samples.len() as u64),
                    mend: (stream.mend)(None),
                });
            };
            samples.try_reserve(1).map_err(|_| stream.out_of_memory())?;
            samples.push(sample(&word).ok_or_else(|| SourceError::Field {
                path: stream.path.to_owned(),
                field: format!("sample {at}"),
                problem: format!("expected a number of type {:?}, found `{word}`", stream.format),
            })?);
        }
    });
    Ok(stored)
}

fn sample<T: Element>(word: &str) -> Option<T> {
    word.parse().ok()
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

/// Turns pairs of hexadecimal digits into bytes.
pub(super) struct HexReader<R> {
    reader: R,
}

impl<R: BufRead> HexReader<R> {
    /// Bytes of the digits that `reader` holds.
    pub fn new(reader: R) -> Self {
        Self { reader }
    }

    fn digit(&mut self) -> io::Result<Option<u8>> {
        loop {
            let Some(&byte) = self.reader.fill_buf()?.first() else { return Ok(None) };
            self.reader.consume(1);
            if !byte.is_ascii_whitespace() {
                let digit = char::from(byte).to_digit(16);
                let digit = digit.ok_or_else(|| {
                    io::Error::new(io::ErrorKind::InvalidData, "expected a hexadecimal digit")
                })?;
                return Ok(Some(digit as u8));
            }
        }
    }
}

impl<R: BufRead> Read for HexReader<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        for (filled, byte) in bytes.iter_mut().enumerate() {
            match (self.digit()?, self.digit()?) {
                (Some(high), Some(low)) => *byte = high << 4 | low,
                (None, _) => return Ok(filled),
                (Some(_), None) => return Err(io::ErrorKind::UnexpectedEof.into()),
            }
        }
        Ok(bytes.len())
    }
}
