//! MetaImage: lines `Name = value`, then samples, in the same file (.mha) or others (.mhd).
//!
//! No crate of the registry was found that reads it and is under a licence allowed here; see [`super::self_describing`]. The
//! format is that of <https://itk.org/Wiki/MetaIO/Documentation>.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::{
    Selection, SourceError, file,
    grid::Grid,
    pieces::{self, MAX_FILES},
    raw::GZIP_MAGIC,
    stored::{Scaling, StoredFormat},
    stream::{Packing, SampleStream, Surplus, mend_by_header},
    text::{HeaderLines, line_error, numbers},
    volume::{Endian, VolumeData},
};

/// Reads a MetaImage of one number a voxel.
///
/// # Errors
///
/// If a line is wrong or missing, an element is of several channels, or the data are not there.
pub(super) fn read(path: &Path, _selection: &Selection) -> Result<VolumeData, SourceError> {
    let header = Header::read(path)?;
    let mut notes = Vec::new();
    let mut size: Vec<u64> = header.list("DimSize", "such as `DimSize = 64 64 64`")?;
    let dimensions: Vec<usize> = header.list("NDims", "such as `NDims = 3`")?;
    if dimensions != [size.len()] || !(1..=10).contains(&size.len()) {
        return Err(header.error("NDims", "expected the count of `DimSize`, at most 10"));
    }
    let format = header.format()?;
    if header.get("ElementNumberOfChannels").is_some_and(|line| line.value != "1") {
        return Err(
            header.error("ElementNumberOfChannels", "only 1 number a voxel is read: split the channels")
        );
    }
    let axes = header.axes(size.len())?;
    let entries = size.iter().skip(3).fold(1, |all: u64, &side| all.saturating_mul(side));
    if entries != 1 {
        notes.push(format!("only the first of its {entries} volumes is read"));
    }
    size.truncate(3);
    let anatomical = header.is_anatomical();
    // ITK's world is left, posterior, superior.
    let to_ras = if anatomical { DVec3::new(-1.0, -1.0, 1.0) } else { DVec3::ONE };
    let axes: Vec<DVec3> = axes.into_iter().take(3).map(|axis| axis * to_ras).collect();
    let grid = Grid::new(path, &size, &axes, anatomical, format.bytes())?;
    let data = header.get("ElementDataFile").map(|line| line.value.clone()).unwrap_or_default();
    let (files, local) = header.files(&data)?;
    let is_part = entries != 1;
    if is_part && files.len() > 1 {
        return Err(header.error("ElementDataFile", "only the files of one volume are read: list no others"));
    }
    let stream = SampleStream {
        path,
        what: grid.what(format.bytes()),
        samples: grid.samples(),
        format,
        endian: if header.is_true(&["ElementByteOrderMSB", "BinaryDataByteOrderMSB"]) {
            Endian::Big
        } else {
            Endian::Little
        },
        packing: header.packing(),
        offset: 0,
        skip: 0,
        surplus: if is_part { Surplus::Ignore } else { Surplus::Note },
        mend: &mend_by_header,
        hint: "",
    };
    let stored = pieces::read(&stream, &files, &mut notes, |piece| {
        piece.offset = if local { header.data_offset } else { 0 };
        header.place(piece)
    })?;
    grid.volume(path, stored, &Scaling::NONE, notes)
}

struct Line {
    name: String,
    value: String,
    line: u64,
}

struct Header<'a> {
    path: &'a Path,
    lines: Vec<Line>,
    /// Names of data files on lines of their own.
    listed: Vec<String>,
    /// Where samples begin that are in the same file.
    data_offset: u64,
}

impl<'a> Header<'a> {
    fn read(path: &'a Path) -> Result<Self, SourceError> {
        let mut lines = HeaderLines::open(path)?;
        let mut header = Self { path, lines: Vec::new(), listed: Vec::new(), data_offset: 0 };
        while let Some(text) = lines.next()? {
            if text.trim().is_empty() || text.starts_with('#') {
                continue;
            }
            let (name, value) = text.split_once(['=', ':']).ok_or_else(|| {
                let text: String = text.chars().take(40).collect();
                lines.error(format!(
                    "expected `Name = value`, found `{text}`; the last line is ElementDataFile"
                ))
            })?;
            let line =
                Line { name: name.trim().to_owned(), value: value.trim().to_owned(), line: lines.line };
            let is_last = line.name.eq_ignore_ascii_case("ElementDataFile");
            let is_list = is_last && line.value.starts_with("LIST");
            header.lines.push(line);
            if is_list {
                while let Some(name) = lines.next()?.filter(|_| header.listed.len() < MAX_FILES) {
                    if !name.trim().is_empty() {
                        header.listed.push(name.trim().to_owned());
                    }
                }
            }
            if is_last {
                header.data_offset = lines.offset;
                return Ok(header);
            }
        }
        Err(header.missing("ElementDataFile", "such as `ElementDataFile = LOCAL`, at the end"))
    }

    fn get(&self, name: &str) -> Option<&Line> {
        self.lines.iter().find(|line| line.name.eq_ignore_ascii_case(name))
    }

    fn missing(&self, field: &str, example: &str) -> SourceError {
        SourceError::Field {
            path: self.path.to_owned(),
            field: field.to_owned(),
            problem: format!("it is missing from the header; add a line {example}"),
        }
    }

    fn error(&self, name: &str, problem: &str) -> SourceError {
        let (line, value) = self.get(name).map_or((1, ""), |line| (line.line, &line.value));
        let value: String = value.chars().take(40).collect();
        line_error(self.path, line, format!("{name}: {problem}, found `{value}`"))
    }

    fn list<T: std::str::FromStr>(&self, name: &str, example: &str) -> Result<Vec<T>, SourceError> {
        let line = self.get(name).ok_or_else(|| self.missing(name, example))?;
        numbers(&line.value).ok_or_else(|| self.error(name, "expected numbers"))
    }

    /// As many numbers as asked for, under the first of these names that is there.
    fn numbers(&self, names: &[&str], count: usize) -> Result<Option<Vec<f64>>, SourceError> {
        let Some(name) = names.iter().find(|name| self.get(name).is_some()) else { return Ok(None) };
        let numbers: Vec<f64> = self.list(name, "")?;
        if numbers.len() != count {
            return Err(self.error(name, &format!("expected {count} numbers")));
        }
        Ok(Some(numbers))
    }

    fn is_true(&self, names: &[&str]) -> bool {
        names
            .iter()
            .filter_map(|name| self.get(name))
            .any(|line| matches!(line.value.as_bytes().first(), Some(b'T' | b't' | b'1')))
    }

    fn format(&self) -> Result<StoredFormat, SourceError> {
        let line = self
            .get("ElementType")
            .ok_or_else(|| self.missing("ElementType", "such as `ElementType = MET_UCHAR`"))?;
        Ok(match line.value.as_str() {
            "MET_CHAR" | "MET_ASCII_CHAR" => StoredFormat::I8,
            "MET_UCHAR" => StoredFormat::U8,
            "MET_SHORT" => StoredFormat::I16,
            "MET_USHORT" => StoredFormat::U16,
            // In files MET_LONG has four bytes on every machine.
            "MET_INT" | "MET_LONG" => StoredFormat::I32,
            "MET_UINT" | "MET_ULONG" => StoredFormat::U32,
            "MET_LONG_LONG" => StoredFormat::I64,
            "MET_ULONG_LONG" => StoredFormat::U64,
            "MET_FLOAT" => StoredFormat::F32,
            "MET_DOUBLE" => StoredFormat::F64,
            _ => {
                return Err(
                    self.error("ElementType", "expected MET_CHAR to MET_ULONG_LONG, MET_FLOAT or MET_DOUBLE")
                );
            }
        })
    }

    /// From one voxel to the next along each axis.
    fn axes(&self, dimensions: usize) -> Result<Vec<DVec3>, SourceError> {
        let spacing = self.numbers(&["ElementSpacing", "ElementSize"], dimensions)?;
        let spacing = spacing.unwrap_or_else(|| vec![1.0; dimensions]);
        let matrix =
            self.numbers(&["TransformMatrix", "Orientation", "Rotation"], dimensions * dimensions)?;
        let unit = |row: usize, column: usize| if row == column { 1.0 } else { 0.0 };
        let direction = |axis: usize| {
            let component = |world: usize| {
                if world >= dimensions {
                    return unit(axis, world);
                }
                matrix.as_ref().map_or(unit(axis, world), |matrix| matrix[axis * dimensions + world])
            };
            DVec3::new(component(0), component(1), component(2)).normalize_or_zero() * spacing[axis]
        };
        Ok((0..dimensions.min(3)).map(direction).collect())
    }

    /// Whether the file says how it lies in a patient, as ITK writes it.
    fn is_anatomical(&self) -> bool {
        self.get("AnatomicalOrientation").is_some_and(|line| {
            line.value.len() == 3 && line.value.bytes().all(|letter| b"RLAPIS".contains(&letter))
        })
    }

    fn packing(&self) -> Packing {
        if self.is_true(&["CompressedData"]) {
            Packing::Zlib
        } else if self.get("BinaryData").is_some() && !self.is_true(&["BinaryData"]) {
            Packing::Text
        } else {
            Packing::Plain
        }
    }

    /// The files that hold the samples, and whether that is the header's own.
    fn files(&self, data: &str) -> Result<(Vec<PathBuf>, bool), SourceError> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let names = match data {
            "LOCAL" | "Local" | "local" => return Ok((vec![self.path.to_owned()], true)),
            _ if data.starts_with("LIST") => self.listed.clone(),
            _ => pieces::numbered(data).map_or_else(|| vec![data.to_owned()], |(names, _)| names),
        };
        if names.is_empty() || names.len() >= MAX_FILES || names.iter().any(String::is_empty) {
            return Err(self.error("ElementDataFile", &format!("expected 1 to {MAX_FILES} files")));
        }
        Ok((names.iter().map(|name| folder.join(name)).collect(), false))
    }

    /// Sets where in its file a piece begins.
    fn place(&self, piece: &mut SampleStream) -> Result<(), SourceError> {
        let header_size = self.numbers(&["HeaderSize"], 1)?.map_or(0.0, |size| size[0]);
        let (mut file, file_bytes) = file::open(piece.path)?;
        if header_size == -1.0 && piece.packing == Packing::Plain {
            piece.offset = file_bytes.saturating_sub(piece.samples * piece.format.bytes());
        } else if header_size > 0.0 {
            piece.offset = piece.offset.saturating_add(header_size as u64);
        } else if header_size != 0.0 {
            return Err(
                self.error("HeaderSize", "expected bytes from 0, or -1 for samples that are not packed")
            );
        }
        if piece.packing == Packing::Zlib
            && piece.offset == 0
            && file::begins_with(piece.path, &mut file, &GZIP_MAGIC)?
        {
            piece.packing = Packing::Gzip;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
