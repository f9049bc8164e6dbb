//! OBJ text as found -> OBJ text as `tobj` needs it, one statement at a time, and at which line each was.
//!
//! `tobj` names no lines in its errors, rejects text that is not UTF-8, knows no continued lines, divides by w, joins normals
//! to the wrong vertices where only some corners have one, and in a debug build panics on a huge index. So it gets a statement
//! per line, absolute indices that were checked, and a normal for every corner: the first, NaN, stands for "none".

use std::{
    io::{self, BufRead, Read},
    path::Path,
};

use crate::sources::SourceError;

/// Corners a single face may have; cutting a face up takes up to the square of them.
pub(super) const MAX_FACE_CORNERS: usize = 16_384;

/// The most characters of a file an error quotes.
const MAX_QUOTED: usize = 40;

/// What the statements were that give no face, and what they lack.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub vertices: u64,
    pub normals: u64,
    pub faces: u64,
    /// `f` with fewer than three corners.
    pub short_faces: u64,
    /// Point and line elements.
    pub points_and_lines: u64,
    /// Free-form curves and surfaces.
    pub free_forms: u64,
    /// Vertices with a w other than 1.
    pub weights: u64,
    /// The last statement is a short face and its line does not end.
    pub is_cut_off: bool,
}

/// A reader of normalised statements; after an error of its own it ends, and keeps the error.
pub(super) struct Scanner<'a, R> {
    path: &'a Path,
    input: R,
    /// A `\n` that comes next belongs to the `\r` before it.
    skip_line_feed: bool,
    /// Lines read so far.
    lines_read: u64,
    /// The statement last given out, as found, and its first line.
    pub statement: String,
    pub line: u64,
    /// Whether the statement's line ended.
    pub is_terminated: bool,
    normalised: Vec<u8>,
    given: usize,
    /// Indices that exceeded all before and what was defined by then, to be checked at the end: (kind, index, line).
    ahead: Vec<(Element, u64, u64)>,
    /// The greatest vertex and normal index in `ahead`.
    farthest: [u64; 2],
    pub found: Found,
    pub error: Option<SourceError>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Element {
    Vertex,
    Normal,
}

impl<'a, R: BufRead> Scanner<'a, R> {
    pub fn new(path: &'a Path, input: R) -> Self {
        Self {
            path,
            input,
            skip_line_feed: false,
            lines_read: 0,
            statement: String::new(),
            line: 0,
            is_terminated: true,
            normalised: b"vn nan nan nan\n".to_vec(),
            given: 0,
            ahead: Vec::new(),
            farthest: [0; 2],
            found: Found::default(),
            error: None,
        }
    }

    /// The error of a statement: at its line, with a hint if the file ends in it.
    pub fn line_error(&self, problem: &str) -> SourceError {
        let cut_off = if self.is_terminated {
            ""
        } else {
            "; the file ends within this line: is it cut off?"
        };
        SourceError::Line {
            path: self.path.to_owned(),
            line: self.line,
            problem: format!("{problem}{cut_off}"),
        }
    }

    /// The error of the first index that no vertex or normal of the whole file answers to.
    pub fn index_error(&self) -> Option<SourceError> {
        let outside = self
            .ahead
            .iter()
            .find(|(element, index, _)| *index > self.defined(*element))?;
        let (element, index, line) = *outside;
        let problem = self.outside_problem(element, &index.to_string());
        Some(SourceError::Line {
            path: self.path.to_owned(),
            line,
            problem,
        })
    }

    fn defined(&self, element: Element) -> u64 {
        match element {
            Element::Vertex => self.found.vertices,
            Element::Normal => self.found.normals,
        }
    }

    fn outside_problem(&self, element: Element, index: &str) -> String {
        let name = if element == Element::Vertex {
            "vertex"
        } else {
            "normal"
        };
        let defined = self.defined(element);
        format!(
            "a face names {name} {index}, but {defined} are defined; export the mesh again, or correct the index"
        )
    }

    /// Reads statements until one is for `tobj`; nothing at the end of the file.
    fn next_statement(&mut self) -> Result<(), SourceError> {
        self.normalised.clear();
        self.given = 0;
        while self.normalised.is_empty() && self.read_statement()? {
            let statement = std::mem::take(&mut self.statement);
            let result = self.normalise(&statement);
            self.statement = statement;
            result?;
        }
        Ok(())
    }

    fn normalise(&mut self, statement: &str) -> Result<(), SourceError> {
        let mut words = statement.split_whitespace();
        match words.next().unwrap_or_default() {
            "v" => {
                self.found.vertices += 1;
                self.vector("v", words.clone())?;
                let mut rest = words.skip(3);
                // One value more is the weight of a rational curve; three are a colour.
                if let (Some(weight), None) = (rest.next(), rest.next()) {
                    self.found.weights += u64::from(weight.parse() != Ok(1.0_f32));
                }
            }
            "vn" => {
                self.found.normals += 1;
                self.vector("vn", words)?;
            }
            "f" => self.face(words)?,
            "p" | "l" => self.found.points_and_lines += 1,
            "curv" | "curv2" | "surf" => self.found.free_forms += 1,
            _ => {}
        }
        Ok(())
    }

    /// Gives out three numbers.
    fn vector<'w>(
        &mut self,
        keyword: &str,
        mut words: impl Iterator<Item = &'w str>,
    ) -> Result<(), SourceError> {
        self.normalised.extend_from_slice(keyword.as_bytes());
        for place in ["x", "y", "z"] {
            let Some(word) = words.next() else {
                return Err(self.line_error(&format!(
                    "`{keyword}` needs three numbers, {place} is missing; add it"
                )));
            };
            // How C prints what is not a number: nan(ind), -1.#IND, 1.#QNAN.
            let is_nan = word.contains('#') || word.contains("nan(");
            let word = if is_nan { "nan" } else { word };
            if word.parse::<f32>().is_err() {
                let quoted = quote(word);
                return Err(self.line_error(&format!(
                    "`{quoted}` is not a number; `{keyword}` needs three, write it like -1.5e3"
                )));
            }
            self.normalised.push(b' ');
            self.normalised.extend_from_slice(word.as_bytes());
        }
        self.normalised.push(b'\n');
        Ok(())
    }

    /// Gives out a face of at least three corners, each with a vertex and a normal.
    fn face<'w>(&mut self, words: impl Iterator<Item = &'w str>) -> Result<(), SourceError> {
        self.normalised.push(b'f');
        let mut corners = 0;
        for word in words.take_while(|word| !word.starts_with('#')) {
            let mut parts = word.split('/');
            let vertex = self.index(Element::Vertex, parts.next().unwrap_or_default(), word)?;
            // Texture coordinates are not used, so not checked either.
            let normal = match parts.nth(1) {
                None | Some("") => 1,
                Some(part) => self.index(Element::Normal, part, word)? + 1,
            };
            corners += 1;
            if corners > MAX_FACE_CORNERS {
                let problem = format!(
                    "a face of more than {MAX_FACE_CORNERS} corners; triangulate it where the mesh was made"
                );
                return Err(self.line_error(&problem));
            }
            self.normalised
                .extend_from_slice(format!(" {vertex}//{normal}").as_bytes());
        }
        self.normalised.push(b'\n');
        if corners < 3 {
            self.normalised.clear();
            self.found.short_faces += 1;
            self.found.is_cut_off = !self.is_terminated;
        } else {
            self.found.faces += 1;
        }
        Ok(())
    }

    /// An index counted from 1; a negative one counts back from what is defined so far.
    fn index(&mut self, element: Element, text: &str, corner: &str) -> Result<u64, SourceError> {
        let Ok(index) = text.parse::<i64>() else {
            let quoted = quote(corner);
            let problem =
                format!("`{quoted}` is no face corner; write indices like 7, 7/2, 7/2/5 or 7//5");
            return Err(self.line_error(&problem));
        };
        let defined = self.defined(element);
        if index < 0 {
            let resolved = defined
                .checked_sub(index.unsigned_abs())
                .map(|before| before + 1);
            return resolved.ok_or_else(|| self.line_error(&self.outside_problem(element, text)));
        }
        if index == 0 {
            return Err(self.line_error("a face names index 0, but indices start at 1; export the mesh again, or add 1 to all"));
        }
        let index = index.unsigned_abs();
        let farthest = &mut self.farthest[element as usize];
        if index > defined && index > *farthest {
            *farthest = index;
            self.ahead.push((element, index, self.line));
        }
        Ok(index)
    }

    /// Reads the next statement: a line and, if it is geometry that ends in `\`, those it continues on. False at the end.
    fn read_statement(&mut self) -> Result<bool, SourceError> {
        let mut bytes = Vec::new();
        self.line = self.lines_read + 1;
        if !self.read_line(&mut bytes)? {
            return Ok(false);
        }
        let is_geometry = matches!(
            bytes.trim_ascii_start().first(),
            Some(b'v' | b'f' | b'l' | b'p')
        );
        while is_geometry && bytes.trim_ascii_end().last() == Some(&b'\\') {
            bytes.truncate(bytes.trim_ascii_end().len() - 1);
            bytes.push(b' ');
            if !self.read_line(&mut bytes)? {
                break;
            }
        }
        self.statement.clear();
        self.statement.push_str(&String::from_utf8_lossy(&bytes));
        Ok(true)
    }

    /// Appends a line without its end, which is `\n`, `\r\n` or `\r`. False at the end of the file.
    fn read_line(&mut self, line: &mut Vec<u8>) -> Result<bool, SourceError> {
        let mut is_any = false;
        self.is_terminated = false;
        loop {
            let available = match self.input.fill_buf() {
                Ok(available) => available,
                Err(cause) if cause.kind() == io::ErrorKind::Interrupted => continue,
                Err(cause) => return Err(super::super::file::io_error(self.path, cause)),
            };
            if available.is_empty() {
                self.lines_read += u64::from(is_any);
                return Ok(is_any);
            }
            if std::mem::take(&mut self.skip_line_feed) && available[0] == b'\n' {
                self.input.consume(1);
                continue;
            }
            let end = available
                .iter()
                .position(|&byte| byte == b'\n' || byte == b'\r');
            let taken = end.unwrap_or(available.len());
            line.extend_from_slice(&available[..taken]);
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

/// The beginning of a word, fit to print.
fn quote(word: &str) -> String {
    let mut quoted: String = word
        .chars()
        .take(MAX_QUOTED)
        .flat_map(char::escape_default)
        .collect();
    if word.chars().nth(MAX_QUOTED).is_some() {
        quoted.push_str("...");
    }
    quoted
}

impl<R: BufRead> BufRead for Scanner<'_, R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.given == self.normalised.len()
            && self.error.is_none()
            && let Err(error) = self.next_statement()
        {
            self.error = Some(error);
            self.normalised.clear();
            self.given = 0;
        }
        Ok(&self.normalised[self.given..])
    }

    fn consume(&mut self, bytes: usize) {
        self.given += bytes;
    }
}

impl<R: BufRead> Read for Scanner<'_, R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(bytes)?;
        self.consume(read);
        Ok(read)
    }
}
