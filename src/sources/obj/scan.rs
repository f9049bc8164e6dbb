//! OBJ text as found -> OBJ text as `tobj` needs it, one statement at a time, and at which line each was.
//!
//! `tobj` names no lines in its errors, rejects text that is not UTF-8, knows no continued lines, divides by w, joins normals
//! to the wrong vertices where only some corners have one, and in a debug build panics on a huge index. So it gets a statement
//! per line, absolute indices that were checked, and a normal for every corner: the first, NaN, stands for "none".

use std::{
    io::{self, BufRead, Read},
    path::Path,
};

use glam::DVec3;

use super::statements::Statements;
use crate::sources::{SourceError, file};

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
    statements: Statements<R>,
    normalised: Vec<u8>,
    given: usize,
    /// Indices that exceeded all before and what was defined by then, to be checked at the end: (kind, index, line).
    ahead: Vec<(Element, u64, u64)>,
    /// The greatest vertex and normal index in `ahead`.
    farthest: [u64; 2],
    /// The vertices as the file has them. `tobj`, which knows 32 bits only, is given their numbers in their place.
    pub vertices: Vec<DVec3>,
    /// The smoothing group in force, and of each face that was given out; empty while the file names none.
    group: u32,
    pub has_groups: bool,
    pub groups: Vec<u32>,
    pub found: Found,
    pub error: Option<SourceError>,
}

/// Numbers that a 32-bit float holds exactly: a vertex's is given out in two such parts.
const PART: u64 = 1 << 16;

/// The vertex whose number was given out as these coordinates.
pub(super) fn number_of(coordinates: glam::Vec3) -> usize {
    coordinates.x as usize + PART as usize * coordinates.y as usize
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
            statements: Statements::new(input),
            normalised: b"vn nan nan nan\n".to_vec(),
            given: 0,
            ahead: Vec::new(),
            farthest: [0; 2],
            vertices: Vec::new(),
            group: 0,
            has_groups: false,
            groups: Vec::new(),
            found: Found::default(),
            error: None,
        }
    }

    /// The error of a statement: at its line, with a hint if the file ends in it.
    pub fn line_error(&self, problem: &str) -> SourceError {
        let cut_off = if self.statements.is_terminated {
            ""
        } else {
            "; the file ends within this line: is it cut off?"
        };
        SourceError::Line {
            path: self.path.to_owned(),
            line: self.statements.line,
            problem: format!("{problem}{cut_off}"),
        }
    }

    /// The error of the first index that no vertex or normal of the whole file answers to.
    pub fn index_error(&self) -> Option<SourceError> {
        let outside = self.ahead.iter().find(|(element, index, _)| *index > self.defined(*element))?;
        let (element, index, line) = *outside;
        let problem = self.outside_problem(element, &index.to_string());
        Some(SourceError::Line { path: self.path.to_owned(), line, problem })
    }

    fn defined(&self, element: Element) -> u64 {
        match element {
            Element::Vertex => self.found.vertices,
            Element::Normal => self.found.normals,
        }
    }

    fn outside_problem(&self, element: Element, index: &str) -> String {
        let name = if element == Element::Vertex { "vertex" } else { "normal" };
        let defined = self.defined(element);
        format!(
            "a face names {name} {index}, but {defined} are defined; export the mesh again, or correct the index"
        )
    }

    /// Reads statements until one is for `tobj`; nothing at the end of the file.
    fn next_statement(&mut self) -> Result<(), SourceError> {
        self.normalised.clear();
        self.given = 0;
        while self.normalised.is_empty() {
            let statement = self.statements.next().map_err(|cause| file::io_error(self.path, cause))?;
            let Some(statement) = statement else { break };
            self.normalise(&statement)?;
        }
        Ok(())
    }

    fn normalise(&mut self, statement: &str) -> Result<(), SourceError> {
        let mut words = statement.split_whitespace();
        match words.next().unwrap_or_default() {
            "v" => {
                self.found.vertices += 1;
                let vertex = self.vector("v", words.clone())?;
                self.normalised.clear();
                let number = self.vertices.len() as u64;
                self.normalised.extend(format!("v {} {} 0\n", number % PART, number / PART).into_bytes());
                self.vertices.push(vertex);
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
            "s" => self.smoothing_group(words.next().unwrap_or_default()),
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
    ) -> Result<DVec3, SourceError> {
        let mut vector = DVec3::ZERO;
        self.normalised.extend_from_slice(keyword.as_bytes());
        for (axis, place) in ["x", "y", "z"].into_iter().enumerate() {
            let Some(word) = words.next() else {
                return Err(
                    self.line_error(&format!("`{keyword}` needs three numbers, {place} is missing; add it"))
                );
            };
            // How C prints what is not a number: nan(ind), -1.#IND, 1.#QNAN.
            let is_nan = word.contains('#') || word.contains("nan(");
            let word = if is_nan { "nan" } else { word };
            let Ok(number) = word.parse() else {
                let quoted = quote(word);
                return Err(self.line_error(&format!(
                    "`{quoted}` is not a number; `{keyword}` needs three, write it like -1.5e3"
                )));
            };
            vector[axis] = number;
            self.normalised.push(b' ');
            self.normalised.extend_from_slice(word.as_bytes());
        }
        self.normalised.push(b'\n');
        Ok(vector)
    }

    /// `s 3`, `s off`: the group of the faces that follow.
    fn smoothing_group(&mut self, word: &str) {
        // Faces before the first such statement belong to no group, which is how every file without groups begins too.
        if self.groups.is_empty() {
            self.groups = vec![0; self.found.faces as usize];
        }
        self.has_groups = true;
        self.group = word.parse().unwrap_or(0);
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
            self.normalised.extend_from_slice(format!(" {vertex}//{normal}").as_bytes());
        }
        self.normalised.push(b'\n');
        if corners < 3 {
            self.normalised.clear();
            self.found.short_faces += 1;
            self.found.is_cut_off = !self.statements.is_terminated;
        } else {
            self.found.faces += 1;
            if self.has_groups {
                self.groups.push(self.group);
            }
        }
        Ok(())
    }

    /// An index counted from 1; a negative one counts back from what is defined so far.
    fn index(&mut self, element: Element, text: &str, corner: &str) -> Result<u64, SourceError> {
        let Ok(index) = text.parse::<i64>() else {
            let quoted = quote(corner);
            let problem = format!("`{quoted}` is no face corner; write indices like 7, 7/2, 7/2/5 or 7//5");
            return Err(self.line_error(&problem));
        };
        let defined = self.defined(element);
        if index < 0 {
            let resolved = defined.checked_sub(index.unsigned_abs()).map(|before| before + 1);
            return resolved.ok_or_else(|| self.line_error(&self.outside_problem(element, text)));
        }
        if index == 0 {
            return Err(self.line_error(
                "a face names index 0, but indices start at 1; export the mesh again, or add 1 to all",
            ));
        }
        let index = index.unsigned_abs();
        let farthest = &mut self.farthest[element as usize];
        if index > defined && index > *farthest {
            *farthest = index;
            self.ahead.push((element, index, self.statements.line));
        }
        Ok(index)
    }
}

/// The beginning of a word, fit to print.
fn quote(word: &str) -> String {
    let mut quoted: String = word.chars().take(MAX_QUOTED).flat_map(char::escape_default).collect();
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
