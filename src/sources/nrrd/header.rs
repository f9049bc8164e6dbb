//! The lines of an NRRD header.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::{
    Endian, Packing, SourceError,
    axes::{Axis, Direction, WorldOf},
    segments::Segments,
    unsupported,
    words::{millimetres, packing, sample_format, vectors, world_of},
};
use crate::sources::{
    pieces::{self, MAX_FILES},
    stored::StoredFormat,
    text::{HeaderLines, line_error, numbers},
};

/// Where the samples are.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum DataFile {
    /// Behind the header.
    Attached,
    /// In files of these names, one after the other.
    Files(Vec<String>),
}

/// What the header says.
#[derive(Debug)]
pub(super) struct Header {
    path: PathBuf,
    /// The axes.
    pub axes: Vec<Axis>,
    /// Type of a sample.
    pub format: StoredFormat,
    /// The order of its bytes.
    pub endian: Option<Endian>,
    /// How samples are packed.
    pub packing: Packing,
    /// Where they are.
    pub data: DataFile,
    /// Where they begin, if they are attached.
    pub data_offset: u64,
    /// Lines in front of them.
    pub line_skip: u64,
    /// Then bytes in front of them; -1 for all but the last.
    pub byte_skip: i64,
    /// The world of the file.
    pub space: WorldOf,
    /// The centre of the first sample in it.
    pub origin: Option<DVec3>,
    /// Millimetres of the unit of length.
    pub millimetres: f64,
    /// What the values mean.
    pub segments: Segments,
}

impl Header {
    /// Reads the header up to its samples.
    pub fn read(path: &Path) -> Result<Self, SourceError> {
        let mut lines = HeaderLines::open(path)?;
        // The magic was looked at to find this reader.
        lines.next()?;
        let (mut fields, mut segments) = (Fields::default(), Segments::default());
        while let Some(line) = lines.next()?.filter(|line| !line.is_empty()) {
            if line.starts_with('#') {
                continue;
            }
            if let Some((key, value)) = line.split_once(":=") {
                segments.line(key, value);
                continue;
            }
            let (name, value) = line.split_once(':').ok_or_else(|| {
                lines.error(format!("expected `field: value`, found `{}`; is a line broken?", clipped(&line)))
            })?;
            let (name, value) = (name.trim().to_lowercase(), value.trim().to_owned());
            let is_list = name.replace(' ', "") == "datafile" && value.starts_with("LIST");
            fields.0.push(Field { name, value, line: lines.line });
            if is_list {
                while let Some(name) = lines.next()?.filter(|_| fields.0.len() < MAX_FILES) {
                    fields.0.push(Field {
                        name: String::new(),
                        value: name.trim().to_owned(),
                        line: lines.line,
                    });
                }
                break;
            }
        }
        let mut header = fields.header(path)?;
        (header.data_offset, header.segments) = (lines.offset, segments);
        Ok(header)
    }

    /// The error for a line that is not there.
    pub fn missing(&self, field: &str, example: &str) -> SourceError {
        missing(&self.path, field, example)
    }
}

fn missing(path: &Path, field: &str, example: &str) -> SourceError {
    SourceError::Field {
        path: path.to_owned(),
        field: field.to_owned(),
        problem: format!("it is missing from the header; add a line {example}"),
    }
}

fn clipped(text: &str) -> String {
    text.chars().take(40).collect()
}

/// One line.
pub(super) struct Field {
    name: String,
    /// What stands behind the colon.
    pub value: String,
    line: u64,
}

/// All lines of a header; names of data files have no name themselves.
#[derive(Default)]
struct Fields(Vec<Field>);

impl Fields {
    fn get(&self, name: &str) -> Option<&Field> {
        self.0
            .iter()
            .find(|field| field.name.replace(' ', "") == name.replace(' ', "") && !field.name.is_empty())
    }

    fn needed(&self, path: &Path, name: &str, example: &str) -> Result<&Field, SourceError> {
        self.get(name).ok_or_else(|| missing(path, name, example))
    }

    fn number(&self, path: &Path, name: &str) -> Result<i64, SourceError> {
        let Some(field) = self.get(name) else { return Ok(0) };
        field.value.parse().map_err(|_| field.error(path, "expected a whole number"))
    }

    fn header(&self, path: &Path) -> Result<Header, SourceError> {
        let format = self.needed(path, "type", "such as `type: uchar`")?;
        let encoding = self.needed(path, "encoding", "such as `encoding: raw`")?;
        let endian = match self.get("endian") {
            None => None,
            Some(field) => Some(match field.value.to_lowercase().as_str() {
                "little" => Endian::Little,
                "big" => Endian::Big,
                _ => return Err(field.error(path, "expected `little` or `big`")),
            }),
        };
        let byte_skip = self.number(path, "byte skip")?;
        let line_skip = self.number(path, "line skip")?;
        let (Ok(line_skip), -1..) = (u64::try_from(line_skip), byte_skip) else {
            let problem = "skips count lines and bytes from 0; only `byte skip` may be -1".to_owned();
            return Err(SourceError::Field { path: path.to_owned(), field: "skip".to_owned(), problem });
        };
        let packing = packing(path, encoding)?;
        if byte_skip == -1 && packing != Packing::Plain {
            return Err(encoding.error(path, "`byte skip: -1` needs `encoding: raw`"));
        }
        let axes = self.axes(path)?;
        Ok(Header {
            path: path.to_owned(),
            format: sample_format(path, format)?,
            endian,
            packing,
            data: self.data(path, axes.len())?,
            axes,
            data_offset: 0,
            line_skip,
            byte_skip,
            space: self.get("space").map_or(WorldOf::Other, |field| world_of(&field.value)),
            origin: self.origin(path)?,
            millimetres: self.millimetres(),
            segments: Segments::default(),
        })
    }

    fn axes(&self, path: &Path) -> Result<Vec<Axis>, SourceError> {
        let sizes = self.needed(path, "sizes", "such as `sizes: 64 64 64`")?;
        let sizes: Vec<u64> =
            numbers(&sizes.value).ok_or_else(|| sizes.error(path, "expected whole numbers above 0"))?;
        let dimension = self.needed(path, "dimension", "such as `dimension: 3`")?;
        if dimension.value.parse() != Ok(sizes.len()) || !(1..=16).contains(&sizes.len()) {
            return Err(
                dimension.error(path, &format!("expected the count of `sizes`, {}, at most 16", sizes.len()))
            );
        }
        let spacings = self.of_axes(path, "spacings", sizes.len())?;
        let mins = self.of_axes(path, "axis mins", sizes.len())?;
        let maxs = self.of_axes(path, "axis maxs", sizes.len())?;
        let directions: Option<Vec<Direction>> = match self.get("space directions") {
            None => None,
            Some(field) => {
                Some(vectors(&field.value).filter(|vectors| vectors.len() == sizes.len()).ok_or_else(
                    || field.error(path, "expected a vector such as (1,0,0), or none, for each axis"),
                )?)
            }
        };
        let words = |name: &str| -> Vec<String> {
            let words = |field: &Field| {
                field.value.split_whitespace().map(|word| word.trim_matches('"').to_owned()).collect()
            };
            self.get(name).map_or(Vec::new(), words)
        };
        let (kinds, centerings) =
            (words("kinds"), words(if self.get("centerings").is_some() { "centerings" } else { "centers" }));
        let axis = |index: usize| Axis {
            number: index + 1,
            size: sizes[index],
            direction: directions.as_ref().map_or(Direction::Unwritten, |directions| directions[index]),
            spacing: spacings[index],
            ends: [mins[index], maxs[index]],
            is_node_centred: centerings.get(index).is_some_and(|word| word.eq_ignore_ascii_case("node")),
            kind: kinds
                .get(index)
                .filter(|kind| !matches!(&***kind, "???" | "none"))
                .cloned()
                .unwrap_or_default(),
        };
        Ok((0..sizes.len()).map(axis).collect())
    }

    /// A number for each axis, if they are written.
    fn of_axes(&self, path: &Path, name: &str, axes: usize) -> Result<Vec<Option<f64>>, SourceError> {
        let Some(field) = self.get(name) else { return Ok(vec![None; axes]) };
        let written = numbers::<f64>(&field.value).filter(|numbers| numbers.len() == axes);
        let written = written.ok_or_else(|| field.error(path, "expected a number for each axis"))?;
        Ok(written.into_iter().map(Some).collect())
    }

    /// The centre of the first sample.
    fn origin(&self, path: &Path) -> Result<Option<DVec3>, SourceError> {
        let Some(field) = self.get("space origin") else { return Ok(None) };
        match vectors(&field.value).as_deref() {
            Some([Direction::Along(origin)]) => Ok(Some(*origin)),
            Some([Direction::None]) => Ok(Some(DVec3::NAN)),
            _ => Err(field.error(path, "expected a vector such as (0,0,0)")),
        }
    }

    fn data(&self, path: &Path, dimension: usize) -> Result<DataFile, SourceError> {
        let Some(field) = self.get("data file") else { return Ok(DataFile::Attached) };
        let mut words = field.value.split_whitespace();
        let (names, sub): (Vec<String>, _) = if words.next() == Some("LIST") {
            let names = self.0.iter().filter(|field| field.name.is_empty() && !field.value.is_empty());
            (names.map(|field| field.value.clone()).collect(), words.next())
        } else if let Some((names, sub)) = pieces::numbered(&field.value) {
            (names, sub)
        } else {
            (vec![field.value.clone()], None)
        };
        if names.is_empty() || names.len() >= MAX_FILES {
            return Err(field.error(path, &format!("expected 1 to {MAX_FILES} data files")));
        }
        // By default each file is one slice along the last axis; slabs of it are read one after the other as well.
        if sub
            .is_some_and(|sub| !sub.parse().is_ok_and(|sub: usize| sub == dimension || sub + 1 == dimension))
        {
            let found = format!("line {}: files of fewer axes than a slice", field.line);
            return Err(unsupported(path, found, "join them with `unu join` or `unu save`"));
        }
        Ok(DataFile::Files(names))
    }

    /// Millimetres of the unit that is written; nothing else than a length is one.
    fn millimetres(&self) -> f64 {
        let units = self.get("space units").or(self.get("units"));
        let unit = units.and_then(|field| field.value.split('"').find(|unit| !unit.trim().is_empty()));
        unit.and_then(|unit| millimetres(unit.trim())).unwrap_or(1.0)
    }
}

impl Field {
    /// Something wrong with it.
    pub fn error(&self, path: &Path, problem: &str) -> SourceError {
        let problem = format!("{}: {problem}, found `{}`", self.name, clipped(&self.value));
        line_error(path, self.line, problem)
    }
}
