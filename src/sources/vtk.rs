//! Legacy VTK files of structured points, as text or binary.
//!
//! `vtkio` 0.6.3 takes memory by the header's word, and of data that are cut off loads none without an error. 0.7.0-rc2 does
//! neither, and none of 11000 damaged files brought it down; but it is a release candidate, refuses the empty line that some
//! write after the title, accepts sizes that the samples do not fill, and says `Parse error: Digit` and no line. Counts are
//! in [`super::self_describing`]. A grid's few lines are read here
//! (<https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html>).

use std::path::Path;

use glam::DVec3;

use super::{
    Selection, SourceError, file,
    grid::Grid,
    pick::Pick,
    stored::{Element, Scaling, StoredFormat},
    stream::{Packing, SampleStream, Surplus, mend_by_header},
    text::{HeaderLines, numbers},
    volume::{Endian, VolumeData},
};

/// What every such file begins with.
pub(super) const MAGIC: &[u8] = b"# vtk DataFile";

/// Reads the first array of point data, of one number a point.
///
/// # Errors
///
/// If a line is wrong or missing, the dataset is of another kind, its first array are vectors or colours, or the data are not
/// there.
pub(super) fn read(path: &Path, _selection: &Selection) -> Result<VolumeData, SourceError> {
    let mut lines = HeaderLines::open(path)?;
    // The magic was looked at to find this reader; the second line is a title.
    lines.next()?;
    lines.next()?;
    let mut kind = lines.next()?;
    // Some write an empty line after the title.
    while kind.as_deref().is_some_and(|line| line.trim().is_empty()) {
        kind = lines.next()?;
    }
    let is_text = match kind.as_deref().map(str::trim) {
        Some("ASCII") => true,
        Some("BINARY") => false,
        found => return Err(expected(&lines, "`ASCII` or `BINARY`", found.unwrap_or("the end"))),
    };
    let mut header = Header { size: None, spacing: [1.0; 3], points: None };
    let array = loop {
        let line = lines
            .next()?
            .ok_or_else(|| lines.error("the file ends before its point data; is it cut off?"))?;
        if let Some(array) = header.line(path, &mut lines, &line)? {
            break array;
        }
    };
    let Some(size) = header.size else {
        return Err(lines.error("DIMENSIONS is missing in front of the point data"));
    };
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let axes = [0, 1, 2].map(|axis| axes[axis] * header.spacing[axis]);
    let bytes = array.format.bytes();
    let grid = Grid::new(path, &size, &axes, false, bytes)?;
    if header.points != Some(grid.samples()) {
        let found = header.points.unwrap_or(0);
        let problem = format!("POINT_DATA counts {found} points; DIMENSIONS make {}", grid.samples());
        return Err(lines.error(problem));
    }
    let mut notes = Vec::new();
    notes.extend(array.note);
    let stream = SampleStream {
        path,
        what: grid.what(bytes),
        samples: grid.samples(),
        pick: Pick::ALL,
        format: array.format,
        endian: Endian::Big,
        packing: if is_text { Packing::Text } else { Packing::Plain },
        offset: lines.offset,
        skip: 0,
        // More arrays, and what describes them, may follow.
        surplus: Surplus::Ignore,
        mend: &mend_by_header,
        hint: "",
    };
    let (file, file_bytes) = file::open(path)?;
    let stored = stream.read(file, file_bytes, &mut notes)?;
    grid.volume(path, stored, &Scaling::NONE, notes)
}

struct Header {
    size: Option<[u64; 3]>,
    spacing: [f64; 3],
    points: Option<u64>,
}

struct Array {
    format: StoredFormat,
    note: Option<String>,
}

impl Header {
    /// Takes in one line; the array whose samples come next, if it was the last one in front of them.
    fn line(
        &mut self,
        path: &Path,
        lines: &mut HeaderLines,
        line: &str,
    ) -> Result<Option<Array>, SourceError> {
        let (keyword, rest) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
        let rest = rest.trim();
        match keyword.to_uppercase().as_str() {
            "" | "ORIGIN" | "METADATA" => {}
            "DATASET" if rest.eq_ignore_ascii_case("STRUCTURED_POINTS") => {}
            "DATASET" => {
                let mend = "resample it to an image and save that as legacy VTK";
                return Err(unsupported(path, format!("its dataset is {rest}, no STRUCTURED_POINTS"), mend));
            }
            "DIMENSIONS" => self.size = Some(three(lines, keyword, rest)?),
            "SPACING" | "ASPECT_RATIO" => self.spacing = three(lines, keyword, rest)?,
            "CELL_DATA" => {
                return Err(unsupported(path, "it has cell data".to_owned(), "convert them to point data"));
            }
            "POINT_DATA" => {
                self.points = Some(rest.parse().map_err(|_| expected(lines, "a count of points", rest))?);
            }
            "SCALARS" if self.points.is_some() => return scalars(lines, rest).map(Some),
            "FIELD" if self.points.is_some() => return field(lines).map(Some),
            "SCALARS" | "FIELD" => return Err(expected(lines, "POINT_DATA in front of arrays", keyword)),
            "VECTORS" | "NORMALS" | "TENSORS" | "TENSORS6" | "COLOR_SCALARS" | "TEXTURE_COORDINATES" => {
                let found = format!("its first array are {}", keyword.to_uppercase());
                return Err(unsupported(path, found, "save an array of SCALARS first, or alone"));
            }
            _ => return Err(expected(lines, "a keyword of structured points", keyword)),
        }
        Ok(None)
    }
}

fn three<T: Element>(lines: &HeaderLines, keyword: &str, rest: &str) -> Result<[T; 3], SourceError> {
    let three = numbers(rest).and_then(|numbers| numbers.try_into().ok());
    three.ok_or_else(|| expected(lines, &format!("three numbers after {keyword}"), rest))
}

fn scalars(lines: &mut HeaderLines, rest: &str) -> Result<Array, SourceError> {
    let words: Vec<&str> = rest.split_whitespace().collect();
    let array = array(lines, words.get(1), words.get(2).copied().unwrap_or("1"))?;
    let table = lines.next()?.unwrap_or_default();
    if !table.trim_start().to_uppercase().starts_with("LOOKUP_TABLE") {
        return Err(expected(lines, "`LOOKUP_TABLE default`", &table));
    }
    Ok(array)
}

/// The first array of a field: `name components tuples type`.
fn field(lines: &mut HeaderLines) -> Result<Array, SourceError> {
    let line = lines.next()?.unwrap_or_default();
    let words: Vec<&str> = line.split_whitespace().collect();
    let mut array = array(lines, words.get(3), words.get(1).copied().unwrap_or(""))?;
    array.note = words.first().map(|name| format!("of its arrays the first, `{name}`, is read"));
    Ok(array)
}

fn array(lines: &HeaderLines, format: Option<&&str>, components: &str) -> Result<Array, SourceError> {
    if components != "1" {
        return Err(expected(lines, "1 number a point", components));
    }
    let format = match format.copied().unwrap_or("").to_lowercase().as_str() {
        "unsigned_char" => StoredFormat::U8,
        "char" | "signed_char" => StoredFormat::I8,
        "unsigned_short" => StoredFormat::U16,
        "short" => StoredFormat::I16,
        "unsigned_int" => StoredFormat::U32,
        "int" | "vtkidtype" => StoredFormat::I32,
        "unsigned_long" | "vtktypeuint64" => StoredFormat::U64,
        "long" | "vtktypeint64" => StoredFormat::I64,
        "float" => StoredFormat::F32,
        "double" => StoredFormat::F64,
        found => return Err(expected(lines, "a type from char to unsigned_long, float or double", found)),
    };
    Ok(Array { format, note: None })
}

fn expected(lines: &HeaderLines, expected: &str, found: &str) -> SourceError {
    let found: String = found.chars().take(40).collect();
    lines.error(format!("expected {expected}, found `{found}`"))
}

fn unsupported(path: &Path, found: String, mend: &str) -> SourceError {
    SourceError::Unsupported { path: path.to_owned(), found, mend: mend.to_owned() }
}

#[cfg(test)]
mod tests;
