//! What a .vti file says of its image and its arrays.

use std::{
    fs::File,
    io::{BufRead, BufReader, Seek, SeekFrom},
    path::Path,
};

use glam::{DMat3, DVec3};
use quick_xml::{Reader, events::Event};

use super::reading::{Reading, attribute, pass_text};
use crate::sources::{
    SourceError, file,
    grid::Grid,
    stored::StoredFormat,
    volume::{Endian, Space},
    vtk::choice::Described,
};

/// Bytes that may stand between the appended data and their mark.
const MAX_TO_MARK: usize = 1 << 12;

/// Where the data of an array are, and how they are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// Numbers, in its element.
    Ascii,
    /// Base64, in its element.
    Binary,
    /// So many bytes or letters behind the mark of what is appended.
    Appended,
}

/// An array of numbers.
#[derive(Debug, Clone)]
pub(super) struct Array {
    /// What the file calls it.
    pub name: String,
    /// How one number is stored.
    pub format: StoredFormat,
    /// Numbers of each point or cell.
    pub components: u64,
    /// Whether its values belong to cells, not points.
    pub of_cells: bool,
    /// How its data are written.
    pub form: Form,
    /// Where its text begins and ends, or in the data that are appended.
    pub span: (u64, u64),
}

impl Described for Array {
    fn name(&self) -> &str {
        &self.name
    }

    fn components(&self) -> u64 {
        self.components
    }

    fn is_colour(&self) -> bool {
        matches!(self.components, 3 | 4) && self.format == StoredFormat::U8
    }
}

/// What a file says.
#[derive(Debug)]
pub(super) struct Header {
    /// The first and last point along x, y, z.
    pub extent: [[i64; 2]; 3],
    /// The point 0, 0, 0.
    pub origin: DVec3,
    /// From one point to the next along each axis.
    pub spacing: DVec3,
    /// Columns are the directions of the axes.
    pub direction: DMat3,
    /// The order of the bytes of numbers.
    pub endian: Endian,
    /// Whether lengths in front of the data have 64 bits.
    pub long_lengths: bool,
    /// Whether the data are packed by zlib.
    pub is_packed: bool,
    /// Where the data begin that are appended, and whether they are base64.
    pub appended: Option<(u64, bool)>,
    /// Arrays of numbers.
    pub arrays: Vec<Array>,
}

impl Header {
    /// Reads up to the end, or to what is appended.
    pub fn read(path: &Path, notes: &mut Vec<String>) -> Result<Self, SourceError> {
        let (file, _) = file::open(path)?;
        let mut reading = Reading::new(path);
        let mut xml = Reader::from_reader(BufReader::new(file));
        xml.config_mut().allow_dangling_amp = true;
        let mut buffer = Vec::new();
        loop {
            buffer.clear();
            match xml.read_event_into(&mut buffer) {
                Ok(Event::Eof) => break,
                Ok(Event::Start(element)) if element.local_name().as_ref() == b"AppendedData" => {
                    let is_base64 = attribute(&element, "encoding").as_deref() != Some("raw");
                    let at = xml.buffer_position();
                    reading.header()?.appended = Some((mark(path, at)?, is_base64));
                    break;
                }
                Ok(Event::Start(element)) => reading.begin(&element, false)?,
                Ok(Event::Empty(element)) => reading.begin(&element, true)?,
                Ok(Event::End(element)) => reading.end(element.local_name().as_ref())?,
                Ok(_) => {}
                Err(error) => {
                    let problem = format!("{error}, at byte {}; is the file cut off?", xml.buffer_position());
                    let error = reading.error("XML", problem);
                    if !reading.has_array() {
                        return Err(error);
                    }
                    notes.push(format!("what follows its first arrays is left out: {error}"));
                    break;
                }
            }
            if reading.expects_data() {
                let start = xml.buffer_position();
                let is_blank = pass_text(xml.stream()).map_err(|cause| file::io_error(path, cause))?;
                reading.data(start, xml.buffer_position(), is_blank);
            }
        }
        reading.finish()
    }

    /// How many values an array has along each axis.
    pub fn size(&self, array: &Array) -> [u64; 3] {
        self.extent.map(|[first, last]| {
            let cells = u64::try_from(last.saturating_sub(first)).unwrap_or(0);
            if array.of_cells { cells.max(1) } else { cells.saturating_add(u64::from(last >= first)) }
        })
    }

    /// The grid of the values of an array.
    pub fn grid(&self, path: &Path, array: &Array, bytes: u64) -> Result<Grid, SourceError> {
        let columns = [self.direction.x_axis, self.direction.y_axis, self.direction.z_axis];
        let axes = [0, 1, 2].map(|axis| columns[axis].normalize_or_zero() * self.spacing[axis]);
        let first = |axis: usize| {
            let [first, last] = self.extent[axis];
            first as f64 + if array.of_cells && last > first { 0.5 } else { 0.0 }
        };
        let grid = Grid::new(path, &self.size(array), &axes, false, bytes)?;
        let origin = self.origin + axes[0] * first(0) + axes[1] * first(1) + axes[2] * first(2);
        grid.at(path, origin, Space::World)
    }
}

/// Where the appended data begin: behind an underscore.
fn mark(path: &Path, from: u64) -> Result<u64, SourceError> {
    let io_error = |cause| file::io_error(path, cause);
    let (mut file, _): (File, u64) = file::open(path)?;
    file.seek(SeekFrom::Start(from)).map_err(io_error)?;
    let mut reader = BufReader::with_capacity(MAX_TO_MARK, file);
    let spaces =
        reader.fill_buf().map_err(io_error)?.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    if reader.buffer().get(spaces) == Some(&b'_') {
        return Ok(from + spaces as u64 + 1);
    }
    Err(SourceError::Field {
        path: path.to_owned(),
        field: "AppendedData".to_owned(),
        problem: "expected an underscore in front of the data; is the file damaged?".to_owned(),
    })
}
