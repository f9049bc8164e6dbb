//! The lines of a MetaImage.

use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::sources::{
    SourceError,
    beside::beside,
    file,
    grid::Grid,
    pieces::{self, MAX_FILES},
    raw::GZIP_MAGIC,
    shape::Side,
    stored::{Element, StoredFormat},
    stream::{Packing, SampleStream},
    text::{HeaderLines, line_error, number, numbers},
    volume::Space,
};

/// One line.
pub(super) struct Line {
    name: String,
    /// What stands behind the equals sign.
    pub value: String,
    line: u64,
}

/// All lines up to the samples.
pub(super) struct Header<'a> {
    path: &'a Path,
    lines: Vec<Line>,
    /// Names of data files on lines of their own.
    listed: Vec<String>,
    /// Where samples begin that are in the same file.
    pub data_offset: u64,
}

impl<'a> Header<'a> {
    /// Reads the header up to its samples.
    pub fn read(path: &'a Path) -> Result<Self, SourceError> {
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

    /// The line of a name.
    pub fn get(&self, name: &str) -> Option<&Line> {
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

    fn list<T: Element>(&self, name: &str, example: &str) -> Result<Vec<T>, SourceError> {
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

    /// Whether one of these lines says so.
    pub fn is_true(&self, names: &[&str]) -> bool {
        names
            .iter()
            .filter_map(|name| self.get(name))
            .any(|line| matches!(line.value.as_bytes().first(), Some(b'T' | b't' | b'1')))
    }

    /// How one number is stored.
    pub fn format(&self) -> Result<StoredFormat, SourceError> {
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

    /// What each axis is: first the numbers of a voxel, then up to three of space, then whole volumes.
    pub fn sides(&self) -> Result<Vec<Side>, SourceError> {
        let size: Vec<u64> = self.list("DimSize", "such as `DimSize = 64 64 64`")?;
        let dimensions: Vec<u64> = self.list("NDims", "such as `NDims = 3`")?;
        if dimensions != [size.len() as u64] || !(1..=10).contains(&size.len()) {
            return Err(self.error("NDims", "expected the count of `DimSize`, at most 10"));
        }
        let channels = match self.get("ElementNumberOfChannels") {
            None => 1,
            Some(line) => number(&line.value)
                .filter(|channels| *channels > 0)
                .ok_or_else(|| self.error("ElementNumberOfChannels", "expected a number from 1"))?,
        };
        let axis = |(axis, &samples): (usize, &u64)| match axis {
            0..3 => Side::space(samples),
            _ => Side::entries(samples, &format!("axis {}", axis + 1)),
        };
        Ok([Side::components(channels, "channels")]
            .into_iter()
            .chain(size.iter().enumerate().map(axis))
            .collect())
    }

    /// The grid of voxels of `bytes` bytes. Where the file says how it lies in a patient, its world is ITK's: left, posterior,
    /// superior.
    pub fn grid(&self, sides: &[Side], bytes: u64) -> Result<Grid, SourceError> {
        // All but the channels.
        let dimensions = sides.len() - 1;
        let size: Vec<u64> = sides[1..].iter().take(3).map(|side| side.samples).collect();
        let spacing = self.numbers(&["ElementSpacing", "ElementSize"], dimensions)?;
        let spacing = spacing.unwrap_or_else(|| vec![1.0; dimensions]);
        let matrix =
            self.numbers(&["TransformMatrix", "Orientation", "Rotation"], dimensions * dimensions)?;
        let origin = self.numbers(&["Offset", "Position", "Origin"], dimensions)?;
        let unit = |row: usize, column: usize| if row == column { 1.0 } else { 0.0 };
        let anatomical = self.is_anatomical();
        let to_world =
            if anatomical { DVec3::new(-1.0, -1.0, 1.0) } else { DVec3::ONE } * self.millimetres()?;
        let direction = |axis: usize| {
            let component = |world: usize| match &matrix {
                Some(matrix) if world < dimensions => matrix[axis * dimensions + world],
                _ => unit(axis, world),
            };
            let direction = DVec3::new(component(0), component(1), component(2)).normalize_or_zero();
            direction * spacing[axis] * to_world
        };
        let axes: Vec<DVec3> = (0..size.len()).map(direction).collect();
        let grid = Grid::new(self.path, &size, &axes, anatomical, bytes)?;
        if !anatomical && origin.is_none() && matrix.is_none() {
            return Ok(grid);
        }
        let origin = origin.unwrap_or_default();
        let component = |axis: usize| origin.get(axis).copied().unwrap_or(0.0);
        let origin = DVec3::new(component(0), component(1), component(2)) * to_world;
        grid.at(self.path, origin, if anatomical { Space::Patient } else { Space::World })
    }

    /// Millimetres of the unit of length.
    fn millimetres(&self) -> Result<f64, SourceError> {
        Ok(match self.get("DistanceUnits").map(|line| line.value.to_lowercase()).as_deref() {
            None | Some("mm" | "" | "?") => 1.0,
            Some("um") => 1e-3,
            Some("cm") => 10.0,
            Some("m") => 1e3,
            Some(_) => return Err(self.error("DistanceUnits", "expected um, mm, cm or m")),
        })
    }

    /// Whether the file says how it lies in a patient, as ITK writes it.
    fn is_anatomical(&self) -> bool {
        self.get("AnatomicalOrientation").is_some_and(|line| {
            let letters = line.value.as_bytes().get(..3);
            letters.is_some_and(|letters| letters.iter().all(|letter| b"RLAPIS".contains(letter)))
        })
    }

    /// How the samples are packed.
    pub fn packing(&self) -> Packing {
        if self.is_true(&["CompressedData"]) {
            Packing::Zlib
        } else if self.get("BinaryData").is_some() && !self.is_true(&["BinaryData"]) {
            Packing::Text
        } else {
            Packing::Plain
        }
    }

    /// The files that hold the samples, and whether that is the header's own.
    pub fn files(&self, data: &str, notes: &mut Vec<String>) -> Result<(Vec<PathBuf>, bool), SourceError> {
        let names = match data {
            "LOCAL" | "Local" | "local" => return Ok((vec![self.path.to_owned()], true)),
            _ if data.starts_with("LIST") => self.listed.clone(),
            _ => pieces::numbered(data).map_or_else(|| vec![data.to_owned()], |(names, _)| names),
        };
        if names.is_empty() || names.len() >= MAX_FILES || names.iter().any(String::is_empty) {
            return Err(self.error("ElementDataFile", &format!("expected 1 to {MAX_FILES} files")));
        }
        Ok((beside(self.path, &names, notes), false))
    }

    /// Sets where in its file of so many samples a piece begins.
    pub fn place(&self, piece: &mut SampleStream, samples: u64) -> Result<(), SourceError> {
        let header_size = self.numbers(&["HeaderSize"], 1)?.map_or(0.0, |size| size[0]);
        let (mut file, file_bytes) = file::open(piece.path)?;
        if header_size == -1.0 && piece.packing == Packing::Plain {
            piece.offset = file_bytes.saturating_sub(samples.saturating_mul(piece.format.bytes()));
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
