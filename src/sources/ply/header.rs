//! The header of a PLY file, and the lines of text that may follow it.

use std::collections::HashSet;
use std::io::{BufRead, Cursor};
use std::path::Path;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, ElementDef, Encoding, Header};

use super::element;
use crate::sources::mesh::{listed, quoted};
use crate::sources::{SourceError, file};

/// The longest header and the longest line that are read, in bytes.
const MOST_BYTES: usize = 1 << 24;

/// Names in one note, at most.
const MOST_NAMED: usize = 12;

/// A PLY file, read by lines until its numbers begin.
pub(super) struct Lines<'a, R> {
    path: &'a Path,
    pub input: R,
    /// Lines read so far.
    line: u64,
    /// Whether the payload is text, so that lines tell a place.
    is_text: bool,
    bytes: Vec<u8>,
    text: String,
}

impl<'a, R: BufRead> Lines<'a, R> {
    pub fn new(path: &'a Path, input: R) -> Self {
        Self { path, input, line: 0, is_text: true, bytes: Vec::new(), text: String::new() }
    }

    /// An error at the line last read, or at a place among binary data.
    pub fn error(&self, place: &str, problem: &str) -> SourceError {
        let path = self.path.to_owned();
        if self.is_text {
            SourceError::Line { path, line: self.line, problem: format!("{place}: {problem}") }
        } else {
            SourceError::Field { path, field: place.to_owned(), problem: problem.to_owned() }
        }
    }

    /// Reads a line into `text`, without its end: `\n`, `\r\n` or `\r`. False at the end of the file.
    fn advance(&mut self) -> Result<bool, SourceError> {
        self.bytes.clear();
        let io_error = |cause| file::io_error(self.path, cause);
        loop {
            let available = self.input.fill_buf().map_err(io_error)?;
            if available.is_empty() {
                break;
            }
            let end = available.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            let taken = end.map_or(available.len(), |end| end + 1);
            let is_carriage_return = end.is_some_and(|end| available[end] == b'\r');
            self.bytes.extend_from_slice(&available[..taken]);
            self.input.consume(taken);
            if is_carriage_return && self.input.fill_buf().map_err(io_error)?.first() == Some(&b'\n') {
                self.input.consume(1);
            }
            if end.is_some() || self.bytes.len() > MOST_BYTES {
                break;
            }
        }
        self.line += u64::from(!self.bytes.is_empty());
        self.text.clear();
        self.text.push_str(&String::from_utf8_lossy(self.bytes.trim_ascii()));
        Ok(!self.bytes.is_empty())
    }

    /// The next line with something on it.
    pub fn next_filled(&mut self) -> Result<Option<&str>, SourceError> {
        while self.advance()? {
            if !self.text.is_empty() {
                return Ok(Some(&self.text));
            }
        }
        Ok(None)
    }

    /// Reads the header, up to the first byte behind it.
    pub fn header(&mut self) -> Result<Header, SourceError> {
        let mut header = String::new();
        let mut names = HashSet::new();
        loop {
            if !self.advance()? {
                return Err(self.error(
                    "header",
                    "the file ends within it, before `end_header`; fetch or export it again",
                ));
            }
            if header.len() > MOST_BYTES {
                return Err(
                    self.error("header", "no `end_header` in its first 16 MiB; fetch or export it again")
                );
            }
            let line = readable(self.text.trim_start_matches('\u{feff}'), &mut names);
            if !line.is_empty() {
                header.push_str(&line);
                header.push('\n');
                self.check(&line)?;
            }
            if line == "end_header" {
                break;
            }
        }
        let parser = Parser::<DefaultElement>::new();
        let parsed = parser.read_header(&mut Reader::new(Cursor::new(header)));
        let parsed = parsed.map_err(|error| {
            let text = error.to_string();
            self.error(
                "header",
                &format!("{}; export the mesh again", text.lines().next().unwrap_or_default()),
            )
        })?;
        self.is_text = parsed.encoding == Encoding::Ascii;
        Ok(parsed)
    }

    /// Refuses a line that the grammar does not know, at its place.
    fn check(&self, line: &str) -> Result<(), SourceError> {
        let known = Parser::<DefaultElement>::new().read_header_line(&format!("{line}\n"));
        match known {
            Ok(_) => Ok(()),
            Err(_) => {
                let problem = format!("`{}` is no line of a PLY header; export the mesh again", quoted(line));
                Err(self.error("header", &problem))
            }
        }
    }
}

/// A line of a header as the crate's grammar needs it: names of letters, digits, `_` and `-`, each once in its element.
fn readable(line: &str, names: &mut HashSet<String>) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    match words[..] {
        ["comment" | "obj_info", ..] => line.to_owned(),
        ["element", name, count] => {
            names.clear();
            format!("element {} {count}", plain(name))
        }
        ["property", ref types @ .., name] => {
            let mut name = plain(name);
            while !names.insert(name.clone()) {
                name.push('_');
            }
            format!("property {} {name}", types.join(" "))
        }
        _ => words.join(" "),
    }
}

fn plain(name: &str) -> String {
    let fits = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let name: String = name.chars().map(|c| if fits(c) { c } else { '_' }).collect();
    if name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') { name } else { format!("_{name}") }
}

/// What the file has and is not used, as a note.
pub(super) fn unused(header: &Header) -> Option<String> {
    let mut unused = Vec::new();
    for element in header.elements.values().filter(|element| element.count > 0) {
        match element.name.as_str() {
            "vertex" => unused.extend(unused_properties(element, element::is_vertex_property)),
            "face" | "tristrips" => unused.extend(unused_properties(element, element::is_face_property)),
            name => unused.push(format!("{} elements `{name}`", element.count)),
        }
    }
    if unused.is_empty() {
        return None;
    }
    let others = unused.len().saturating_sub(MOST_NAMED);
    unused.truncate(MOST_NAMED);
    if others > 0 {
        unused.push(format!("{others} others"));
    }
    Some(format!("not used: {}", listed(&unused)))
}

fn unused_properties(element: &ElementDef, is_used: fn(&str) -> bool) -> Option<String> {
    let names: Vec<String> =
        element.properties.keys().filter(|name| !is_used(name)).map(|name| quoted(name)).collect();
    (!names.is_empty()).then(|| format!("{} of {}", listed(&names), element.name))
}
