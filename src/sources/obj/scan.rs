//! OBJ text -> a draft of the mesh, statement by statement.
//!
//! The crate `tobj` parses in single precision, names no lines in its errors, rejects text that is not UTF-8, knows no continued lines and
//! no smoothing groups, divides by w, and joins normals to the wrong vertices where only some corners have one.

use std::{collections::HashMap, io::BufRead, path::Path};

use glam::{DVec3, Vec2, Vec3};

use crate::sources::mesh::draft::{Corner, Draft, NONE};
use crate::sources::mesh::quoted;
use crate::sources::statements::Statements;
use crate::sources::{SourceError, file};

/// Corners a single face may have: some hundred bytes each while it is cut up.
pub(super) const MAX_FACE_CORNERS: usize = 1 << 22;

/// What the statements were that give no face, and what they lack.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub faces: u64,
    /// `f` with fewer than three corners.
    pub short_faces: u64,
    /// Point and line elements.
    pub points_and_lines: u64,
    /// Free-form curves and surfaces.
    pub free_forms: u64,
    /// Vertices with a w other than 1.
    pub weights: u64,
    /// Corners whose texture coordinates are not there.
    pub odd_textures: u64,
    /// The last statement is a short face and its line does not end.
    pub is_cut_off: bool,
}

/// A face's index that exceeded all before, and what was defined by then: to be checked at the end.
struct Ahead {
    element: Element,
    index: u64,
    line: u64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Element {
    Vertex,
    Normal,
}

/// What was read so far, and what holds for the faces that follow.
pub(super) struct Scanner<'a> {
    path: &'a Path,
    /// The line of the statement being read, and whether it has an end.
    line: u64,
    is_terminated: bool,
    ahead: Vec<Ahead>,
    /// The greatest vertex and normal index in `ahead`.
    farthest: [u64; 2],
    group: u32,
    /// An index into `names`.
    material: u32,
    known_names: HashMap<String, u32>,
    /// The corners of the face being read.
    corners: Vec<Corner>,
    /// The names of materials that `usemtl` asks for.
    pub names: Vec<String>,
    /// What follows each `mtllib`.
    pub libraries: Vec<String>,
    /// Its colours are as the file writes them, its materials are still missing.
    pub draft: Draft,
    pub found: Found,
}

/// Reads all statements.
///
/// # Errors
///
/// At the line of the first statement that cannot be understood, or of a face that names what the file does not have.
pub(super) fn scan(path: &Path, input: impl BufRead) -> Result<Scanner<'_>, SourceError> {
    let mut statements = Statements::new(input);
    let mut scanner = Scanner {
        path,
        line: 0,
        is_terminated: true,
        ahead: Vec::new(),
        farthest: [0; 2],
        group: NONE,
        material: NONE,
        known_names: HashMap::new(),
        corners: Vec::new(),
        names: Vec::new(),
        libraries: Vec::new(),
        draft: Draft::default(),
        found: Found::default(),
    };
    while statements.advance().map_err(|cause| file::io_error(path, cause))? {
        scanner.line = statements.line;
        scanner.is_terminated = statements.is_terminated;
        scanner.statement(&statements.text())?;
    }
    scanner.check_ahead()?;
    Ok(scanner)
}

impl Scanner<'_> {
    /// The error of a statement: at its line, with a hint if the file ends in it.
    fn line_error(&self, problem: &str) -> SourceError {
        let cut_off =
            if self.is_terminated { "" } else { "; the file ends within this line: is it cut off?" };
        let problem = format!("{problem}{cut_off}");
        SourceError::Line { path: self.path.to_owned(), line: self.line, problem }
    }

    /// Refuses the first index that no vertex or normal of the whole file answers to.
    fn check_ahead(&self) -> Result<(), SourceError> {
        match self.ahead.iter().find(|ahead| ahead.index > self.defined(ahead.element)) {
            Some(&Ahead { element, index, line }) => {
                let problem = self.outside_problem(element, &index.to_string());
                Err(SourceError::Line { path: self.path.to_owned(), line, problem })
            }
            None => Ok(()),
        }
    }

    fn defined(&self, element: Element) -> u64 {
        match element {
            Element::Vertex => self.draft.positions.len() as u64,
            Element::Normal => self.draft.normals.len() as u64,
        }
    }

    fn outside_problem(&self, element: Element, index: &str) -> String {
        let name = if element == Element::Vertex { "vertex" } else { "normal" };
        let defined = self.defined(element);
        format!(
            "a face names {name} {index}, but {defined} are defined; export the mesh again, or correct the index"
        )
    }

    fn statement(&mut self, statement: &str) -> Result<(), SourceError> {
        let statement = statement.trim();
        let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
        match keyword {
            "v" => self.vertex(rest)?,
            "vn" => {
                let [x, y, z] = self.three("vn", &mut rest.split_whitespace())?;
                self.draft.normals.push(Vec3::new(x as f32, y as f32, z as f32));
            }
            "vt" => {
                let mut words = rest.split_whitespace();
                let mut next = || words.next().map_or(0.0, |word| word.parse().unwrap_or(f32::NAN));
                self.draft.texture_coordinates.push(Vec2::new(next(), next()));
            }
            "f" => self.face(rest)?,
            "s" => self.group = group(rest),
            "usemtl" => self.material = self.named(without_comment(rest)),
            "mtllib" => self.libraries.push(without_comment(rest).to_owned()),
            "p" | "l" => self.found.points_and_lines += 1,
            "curv" | "curv2" | "surf" => self.found.free_forms += 1,
            _ => {}
        }
        Ok(())
    }

    /// A position with what may follow it: one value more is the weight of a rational curve; three are a colour.
    fn vertex(&mut self, rest: &str) -> Result<(), SourceError> {
        let mut words = rest.split_whitespace();
        let position = DVec3::from_array(self.three("v", &mut words)?);
        let mut words = words.take_while(|word| !word.starts_with('#'));
        let more = [words.next(), words.next(), words.next()];
        match more {
            [Some(weight), None, _] => self.found.weights += u64::from(weight.parse() != Ok(1.0_f32)),
            [Some(red), Some(green), Some(blue)] => {
                let [red, green, blue] = [red, green, blue].map(|word| word.parse().unwrap_or(f32::NAN));
                self.draft.colours.resize(self.draft.positions.len(), [f32::NAN; 4]);
                self.draft.colours.push([red, green, blue, 1.0]);
            }
            _ => {}
        }
        self.draft.positions.push(position);
        Ok(())
    }

    fn three<'w>(
        &self,
        keyword: &str,
        words: &mut impl Iterator<Item = &'w str>,
    ) -> Result<[f64; 3], SourceError> {
        let mut numbers = [0.0; 3];
        for (number, place) in numbers.iter_mut().zip(["x", "y", "z"]) {
            let Some(word) = words.next() else {
                let problem = format!("`{keyword}` needs three numbers, {place} is missing; add it");
                return Err(self.line_error(&problem));
            };
            // How C prints what is not a number: nan(ind), -1.#IND, 1.#QNAN.
            let is_nan = word.contains('#') || word.contains("nan(");
            *number = if is_nan { Ok(f64::NAN) } else { word.parse() }.map_err(|_| {
                let quoted = quoted(word);
                self.line_error(&format!(
                    "`{quoted}` is not a number; `{keyword}` needs three, write it like -1.5e3"
                ))
            })?;
        }
        Ok(numbers)
    }

    fn face(&mut self, rest: &str) -> Result<(), SourceError> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for word in rest.split_whitespace().take_while(|word| !word.starts_with('#')) {
            if corners.len() == MAX_FACE_CORNERS {
                let problem = format!(
                    "a face of more than {MAX_FACE_CORNERS} corners; triangulate it where the mesh was made"
                );
                return Err(self.line_error(&problem));
            }
            corners.push(self.corner(word)?);
        }
        if corners.len() < 3 {
            self.found.short_faces += 1;
            self.found.is_cut_off = !self.is_terminated;
        } else {
            self.found.faces += 1;
            self.draft.push_face(&corners, self.group, self.material);
        }
        self.corners = corners;
        Ok(())
    }

    fn corner(&mut self, word: &str) -> Result<Corner, SourceError> {
        let mut parts = word.split('/');
        let position = self.index(Element::Vertex, parts.next().unwrap_or_default(), word)?;
        let texture = match parts.next() {
            None | Some("") => NONE,
            Some(part) => self.texture(part),
        };
        let normal = match parts.next() {
            None | Some("") => NONE,
            Some(part) => self.index(Element::Normal, part, word)?,
        };
        Ok(Corner { position, normal, texture })
    }

    /// The place of texture coordinates; if it cannot be understood that does little harm.
    fn texture(&mut self, text: &str) -> u32 {
        let defined = self.draft.texture_coordinates.len() as i64;
        let place = match text.parse::<i64>() {
            Ok(index) if index > 0 => u32::try_from(index - 1).ok(),
            Ok(index) if index < 0 => u32::try_from(defined + index).ok(),
            _ => None,
        };
        self.found.odd_textures += u64::from(place.is_none());
        place.unwrap_or(NONE)
    }

    /// The place of what an index names, counted from 1; a negative one counts back from what is defined so far.
    fn index(&mut self, element: Element, text: &str, corner: &str) -> Result<u32, SourceError> {
        let Ok(index) = text.parse::<i64>() else {
            let quoted = quoted(corner);
            let problem = format!("`{quoted}` is no face corner; write indices like 7, 7/2, 7/2/5 or 7//5");
            return Err(self.line_error(&problem));
        };
        let defined = self.defined(element);
        let place = match index {
            0 => {
                let problem =
                    "a face names index 0, but indices start at 1; export the mesh again, or add 1 to all";
                return Err(self.line_error(problem));
            }
            1.. => index.unsigned_abs() - 1,
            _ => {
                let place = defined.checked_sub(index.unsigned_abs());
                place.ok_or_else(|| self.line_error(&self.outside_problem(element, text)))?
            }
        };
        let farthest = &mut self.farthest[element as usize];
        if place >= defined && place >= *farthest {
            *farthest = place + 1;
            self.ahead.push(Ahead { element, index: place + 1, line: self.line });
        }
        // What does not fit is beyond all that a file may define, hence in `ahead`.
        Ok(u32::try_from(place).unwrap_or(NONE))
    }

    /// The number of a material's name.
    fn named(&mut self, name: &str) -> u32 {
        if let Some(&known) = self.known_names.get(name) {
            return known;
        }
        let number = self.names.len() as u32;
        self.known_names.insert(name.to_owned(), number);
        self.names.push(name.to_owned());
        number
    }
}

/// The smoothing group of `s`: `off` is 0.
fn group(rest: &str) -> u32 {
    let word = rest.split_whitespace().next().unwrap_or("off");
    word.parse().map_or(0, |group: u32| group.min(NONE - 1))
}

/// A name up to a comment that a space stands before.
pub(super) fn without_comment(rest: &str) -> &str {
    rest.find(" #").map_or(rest, |comment| &rest[..comment]).trim()
}
