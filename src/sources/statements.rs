//! Text of OBJ, MTL and STL files cut into statements, and at which line each begins.

use std::borrow::Cow;
use std::io::{self, BufRead};

/// Reads one statement after the other: a line or, if it is geometry that ends in `\`, those it continues on.
///
/// Other lines are not continued: the name of a folder or group may end in `\`.
pub(super) struct Statements<R> {
    input: R,
    /// The statement last read.
    bytes: Vec<u8>,
    /// A `\n` that comes next belongs to the `\r` before it.
    skip_line_feed: bool,
    lines_read: u64,
    /// The first line of the statement last read, counted from 1.
    pub line: u64,
    /// Whether the last line of that statement has an end.
    pub is_terminated: bool,
}

impl<R: BufRead> Statements<R> {
    pub fn new(input: R) -> Self {
        Self { input, bytes: Vec::new(), skip_line_feed: false, lines_read: 0, line: 0, is_terminated: true }
    }

    /// Reads the next statement. False at the end of the file.
    pub fn advance(&mut self) -> io::Result<bool> {
        self.bytes.clear();
        if !self.read_line()? {
            return Ok(false);
        }
        self.line = self.lines_read;
        let is_geometry = matches!(self.bytes.trim_ascii_start().first(), Some(b'v' | b'f' | b'l' | b'p'));
        while is_geometry && self.bytes.trim_ascii_end().last() == Some(&b'\\') {
            self.bytes.truncate(self.bytes.trim_ascii_end().len() - 1);
            self.bytes.push(b' ');
            if !self.read_line()? {
                break;
            }
        }
        Ok(true)
    }

    /// The statement last read, with U+FFFD for what is not UTF-8.
    pub fn text(&self) -> Cow<'_, str> {
        String::from_utf8_lossy(&self.bytes)
    }

    /// Appends a line without its end, which is `\n`, `\r\n` or `\r`. False at the end of the file.
    fn read_line(&mut self) -> io::Result<bool> {
        let mut is_any = false;
        self.is_terminated = false;
        loop {
            let available = match self.input.fill_buf() {
                Ok(available) => available,
                Err(cause) if cause.kind() == io::ErrorKind::Interrupted => continue,
                Err(cause) => return Err(cause),
            };
            if available.is_empty() {
                self.lines_read += u64::from(is_any);
                return Ok(is_any);
            }
            if std::mem::take(&mut self.skip_line_feed) && available[0] == b'\n' {
                self.input.consume(1);
                continue;
            }
            let end = available.iter().position(|&byte| byte == b'\n' || byte == b'\r');
            let taken = end.unwrap_or(available.len());
            self.bytes.extend_from_slice(&available[..taken]);
            is_any |= taken > 0;
            if let Some(end) = end {
                self.skip_line_feed = available[end] == b'\r';
                self.input.consume(end + 1);
                self.lines_read += 1;
                self.is_terminated = true;
                return Ok(true);
            }
            self.input.consume(taken);
        }
    }
}
