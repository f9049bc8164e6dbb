//! The lines of a legacy VTK file that say where its points lie.

use std::path::Path;

use glam::DVec3;

use super::{
    SourceError,
    arrays::{Array, Of, Scan, Table},
    even::{affine, even},
    expected, run, stream_in, unsupported,
};
use crate::sources::{
    grid::Grid,
    stored::{Element, StoredFormat},
    text::{HeaderLines, numbers},
    volume::Space,
};

/// What a data set is, in its own words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Image,
    Rectilinear,
    Structured,
}

/// Coordinates in the file.
#[derive(Debug, Clone, Copy)]
struct Coordinates {
    format: StoredFormat,
    offset: u64,
    count: u64,
}

/// Points in a grid, and the arrays of values that they have.
#[derive(Debug)]
pub(super) struct Dataset {
    kind: Kind,
    size: [u64; 3],
    spacing: [f64; 3],
    origin: Option<[f64; 3]>,
    /// Of a rectilinear grid, along x, y and z.
    along: [Option<Coordinates>; 3],
    /// Of a structured grid: three numbers a point.
    points: Option<Coordinates>,
    /// Arrays of numbers.
    pub arrays: Vec<Array>,
    /// Tables of colours.
    pub tables: Vec<Table>,
}

impl Dataset {
    /// Reads up to the end of the file, over all arrays. What is not understood behind the first one is left out, and told.
    pub fn read(
        path: &Path,
        lines: &mut HeaderLines,
        is_text: bool,
        notes: &mut Vec<String>,
    ) -> Result<Self, SourceError> {
        let mut scan = Scan { lines, is_text };
        let mut reading = Reading::default();
        loop {
            match reading.line(path, &mut scan) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) if reading.arrays.is_empty() => return Err(error),
                Err(error) => {
                    notes.push(format!("what follows its first arrays is left out: {error}"));
                    break;
                }
            }
        }
        reading.finish(path, &scan)
    }

    /// How many values an array has along each axis.
    pub fn size(&self, array: &Array) -> [u64; 3] {
        match array.of {
            Of::Points => self.size,
            Of::Cells => self.size.map(cells),
        }
    }

    /// The grid of the values of an array.
    pub fn grid(
        &self,
        path: &Path,
        array: &Array,
        bytes: u64,
        is_text: bool,
        notes: &mut Vec<String>,
    ) -> Result<Grid, SourceError> {
        let (mut origin, axes) = self.place(path, is_text, notes)?;
        if let (Of::Cells, Some(origin)) = (array.of, &mut origin) {
            let half = |(axis, points): (&DVec3, &u64)| if *points > 1 { *axis * 0.5 } else { DVec3::ZERO };
            *origin += axes.iter().zip(&self.size).map(half).sum::<DVec3>();
        }
        let grid = Grid::new(path, &self.size(array), &axes, false, bytes)?;
        origin.map_or(Ok(grid.clone()), |origin| grid.at(path, origin, Space::World))
    }

    /// The first point, if the file says where it is, and from one to the next along each axis.
    fn place(
        &self,
        path: &Path,
        is_text: bool,
        notes: &mut Vec<String>,
    ) -> Result<(Option<DVec3>, [DVec3; 3]), SourceError> {
        let units = [DVec3::X, DVec3::Y, DVec3::Z];
        let read = |coordinates: &Coordinates| {
            let Coordinates { format, offset, count } = *coordinates;
            stream_in(&run(path, format, offset, count, is_text), &mut Vec::new())
        };
        match self.kind {
            Kind::Image => {
                Ok((self.origin.map(DVec3::from), [0, 1, 2].map(|axis| units[axis] * self.spacing[axis])))
            }
            Kind::Rectilinear => {
                let (mut origin, mut axes) = (DVec3::ZERO, units);
                for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                    let Some(coordinates) = &self.along[axis] else { continue };
                    let stored = read(coordinates)?;
                    let (first, step) = even(path, name, stored.len(), |index| stored.value(index))?;
                    origin[axis] = first;
                    axes[axis] = units[axis] * step;
                }
                notes.push("its rectilinear grid is even, and read as an image".to_owned());
                Ok((Some(origin), axes))
            }
            Kind::Structured => {
                let Some(points) = &self.points else { return Ok((None, units)) };
                let stored = read(points)?;
                let point = |index: u64| {
                    let at = usize::try_from(index).unwrap_or(usize::MAX).saturating_mul(3);
                    DVec3::new(stored.value(at), stored.value(at + 1), stored.value(at + 2))
                };
                let (first, axes) = affine(path, self.size, point)?;
                notes.push("its structured grid is even, and read as an image".to_owned());
                Ok((Some(first), axes))
            }
        }
    }
}

/// How many cells lie between so many points; a single layer of points has one.
fn cells(points: u64) -> u64 {
    if points > 1 { points - 1 } else { points }
}

/// What the lines said so far.
#[derive(Default)]
struct Reading {
    kind: Option<Kind>,
    size: Option<[u64; 3]>,
    spacing: Option<[f64; 3]>,
    origin: Option<[f64; 3]>,
    along: [Option<Coordinates>; 3],
    points: Option<Coordinates>,
    of: Option<(Of, u64)>,
    arrays: Vec<Array>,
    tables: Vec<Table>,
    /// Counts of points and of cells, as written.
    counts: Vec<(Of, u64)>,
}

impl Reading {
    /// Takes in one line and the data that follow it; whether there was one.
    fn line(&mut self, path: &Path, scan: &mut Scan) -> Result<bool, SourceError> {
        let Some(line) = scan.line()? else { return Ok(false) };
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((&line, ""));
        let rest = rest.trim();
        let keyword = keyword.to_uppercase();
        match (keyword.as_str(), self.of) {
            ("DATASET", _) => self.kind = Some(kind(path, rest)?),
            ("DIMENSIONS", _) => self.size = Some(three(scan.lines, &keyword, rest)?),
            ("SPACING" | "ASPECT_RATIO", _) => self.spacing = Some(three(scan.lines, &keyword, rest)?),
            ("ORIGIN", _) => self.origin = Some(three(scan.lines, &keyword, rest)?),
            ("X_COORDINATES", _) => self.along[0] = Some(coordinates(scan, &keyword, rest, 1)?),
            ("Y_COORDINATES", _) => self.along[1] = Some(coordinates(scan, &keyword, rest, 1)?),
            ("Z_COORDINATES", _) => self.along[2] = Some(coordinates(scan, &keyword, rest, 1)?),
            ("POINTS", _) => self.points = Some(coordinates(scan, &keyword, rest, 3)?),
            ("POINT_DATA" | "CELL_DATA", _) => {
                let of = if keyword == "POINT_DATA" { Of::Points } else { Of::Cells };
                let what = if of == Of::Points { "points" } else { "cells" };
                let count = scan.count(what, rest)?;
                self.of = Some((of, count));
                self.counts.push((of, count));
                if self.size.is_none() {
                    return Err(scan.lines.error("DIMENSIONS is missing in front of the data"));
                }
            }
            ("FIELD", of) => self.arrays.extend(scan.field(rest, of)?),
            ("LOOKUP_TABLE", _) => self.tables.push(scan.table(rest)?),
            (
                "SCALARS"
                | "COLOR_SCALARS"
                | "VECTORS"
                | "NORMALS"
                | "TENSORS"
                | "TENSORS6"
                | "TEXTURE_COORDINATES"
                | "GLOBAL_IDS"
                | "PEDIGREE_IDS"
                | "EDGE_FLAGS",
                of,
            ) => {
                let Some((of, count)) = of else {
                    return Err(expected(scan.lines, "POINT_DATA in front of arrays", &keyword));
                };
                self.arrays.extend(scan.attribute(&keyword, rest, of, count)?);
            }
            _ => return Err(expected(scan.lines, "a keyword of an even grid", &keyword)),
        }
        Ok(true)
    }

    fn finish(self, path: &Path, scan: &Scan) -> Result<Dataset, SourceError> {
        let error = |problem: &str| scan.lines.error(problem);
        let kind = self.kind.ok_or_else(|| error("the file ends before its DATASET; is it cut off?"))?;
        if self.counts.is_empty() {
            return Err(error("the file ends before its point data; is it cut off?"));
        }
        let size = self.size.ok_or_else(|| error("DIMENSIONS is missing"))?;
        if self.arrays.is_empty() {
            let found = "it has no array of numbers with one value a point or cell".to_owned();
            return Err(unsupported(path, found, "save it with its SCALARS"));
        }
        for (axis, coordinates) in self.along.iter().enumerate().filter(|_| kind == Kind::Rectilinear) {
            let (name, found) = (["X", "Y", "Z"][axis], coordinates.map_or(0, |along| along.count));
            if found != size[axis] {
                return Err(error(&format!(
                    "{name}_COORDINATES are {found}; DIMENSIONS make {}",
                    size[axis]
                )));
            }
        }
        let made = size.iter().fold(3_u64, |all, &side| all.saturating_mul(side));
        let points = self.points.map_or(0, |points| points.count);
        if kind == Kind::Structured && points != made {
            return Err(error(&format!("POINTS are {}; DIMENSIONS make {}", points / 3, made / 3)));
        }
        for (of, found) in &self.counts {
            let (what, sides) = match of {
                Of::Points => ("POINT_DATA counts {} points", size),
                Of::Cells => ("CELL_DATA counts {} cells", size.map(cells)),
            };
            let made = sides.iter().fold(1_u64, |all, &side| all.saturating_mul(side));
            // Sides that are none, or too many, are told as such.
            if *found != made && made > 0 && made < u64::MAX {
                let what = what.replace("{}", &found.to_string());
                return Err(error(&format!("{what}; DIMENSIONS make {made}")));
            }
        }
        Ok(Dataset {
            kind,
            size,
            spacing: self.spacing.unwrap_or([1.0; 3]),
            origin: self.origin,
            along: self.along,
            points: self.points,
            arrays: self.arrays,
            tables: self.tables,
        })
    }
}

fn kind(path: &Path, name: &str) -> Result<Kind, SourceError> {
    match name.to_uppercase().as_str() {
        "STRUCTURED_POINTS" => Ok(Kind::Image),
        "RECTILINEAR_GRID" => Ok(Kind::Rectilinear),
        "STRUCTURED_GRID" => Ok(Kind::Structured),
        _ => {
            let name: String = name.chars().take(40).collect();
            let mend = "resample it to an image and save that as legacy VTK";
            Err(unsupported(path, format!("its dataset is {name}, no grid such as STRUCTURED_POINTS"), mend))
        }
    }
}

/// Goes over coordinates, from `count type`, of `each` numbers a point.
fn coordinates(scan: &mut Scan, keyword: &str, rest: &str, each: u64) -> Result<Coordinates, SourceError> {
    let (count, kind) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
    let count = scan.count("coordinates", count)?.saturating_mul(each);
    let (format, offset) = scan.numbers(keyword, kind.trim(), count)?;
    Ok(Coordinates { format, offset, count })
}

fn three<T: Element>(lines: &HeaderLines, keyword: &str, rest: &str) -> Result<[T; 3], SourceError> {
    let three = numbers(rest).and_then(|numbers| numbers.try_into().ok());
    three.ok_or_else(|| expected(lines, &format!("three numbers after {keyword}"), rest))
}
