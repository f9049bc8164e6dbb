//! NumPy's .npy: a Python dictionary as text, then samples (<https://numpy.org/neps/nep-0001-npy-format.html>).
//!
//! The axes of an array are taken as scikit-image and napari take them, whichever of them is fastest in the file: the last three are
//! z, y and x. A first one in front of them counts volumes (`index`); a last one of two to four behind three others, or of three or
//! four bytes behind two, counts the numbers of a voxel (`component`), which are colours if they are three or four bytes.
//!
//! `npyz` 0.8 brings a parser of Python and integers of any length for a line of three keys; the line is taken apart here.

use std::{io::Read, path::Path};

use glam::DVec3;

use super::{
    Selection, SourceError, VolumeData, file,
    grid::Grid,
    shape::{Role, Side, choose},
    stored::{Scaling, StoredFormat},
    stream::{Packing, SampleStream, Surplus, mend_by_header},
    volume::Endian,
};

/// What every such file begins with.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// The longest dictionary that is read.
const MAX_HEADER: u64 = 1 << 16;

/// More numbers than this behind an axis of space are none of a voxel.
const FEW: u64 = 4;

/// Reads an array of numbers.
///
/// # Errors
///
/// If the header is broken, its elements are no real numbers, it has no such volume or component, or samples are missing.
pub(super) fn read(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    let header = Header::read(path)?;
    let mut notes = Vec::new();
    let (axes, is_colour) = header.axes();
    let mut order: Vec<usize> = (0..axes.len()).collect();
    if !header.is_fortran {
        order.reverse();
    }
    let sides: Vec<Side> = order.iter().map(|axis| axes[*axis].0.clone()).collect();
    let chosen = choose(path, &sides, selection, is_colour, &mut notes)?;
    if is_colour && axes.len() == 3 {
        notes.push(format!(
            "the last of its three axes, {} long, is taken for the channels of a colour",
            header.shape[2]
        ));
    }
    let spatial = || order.iter().map(|axis| &axes[*axis]).filter(|(side, _)| side.role == Role::Space);
    let size: Vec<u64> = spatial().map(|(side, _)| side.samples).collect();
    let directions: Vec<DVec3> = spatial().map(|(_, direction)| *direction).collect();
    let grid = Grid::new(path, &size, &directions, false, chosen.bytes(header.format))?;
    let (file, file_bytes) = file::open(path)?;
    let stream = SampleStream {
        path,
        what: chosen.what(&grid, header.format),
        samples: grid.samples() * chosen.per_voxel(),
        pick: chosen.pick.clone(),
        format: header.format,
        endian: header.endian,
        packing: Packing::Plain,
        offset: header.data_offset,
        skip: 0,
        surplus: Surplus::Note,
        mend: &mend_by_header,
        hint: "",
    };
    let mut stored = stream.read(file, file_bytes, &mut notes)?;
    if header.is_half {
        stored = stored.with_halves_read(path)?;
    }
    notes.push("it does not say how far apart voxels are; 1 mm is taken".to_owned());
    chosen.volume(&grid, path, stored, &Scaling::NONE, notes)
}

struct Header {
    format: StoredFormat,
    /// Whether the words are 16-bit floats.
    is_half: bool,
    endian: Endian,
    is_fortran: bool,
    /// The axes as NumPy counts them.
    shape: Vec<u64>,
    data_offset: u64,
}

impl Header {
    fn read(path: &Path) -> Result<Self, SourceError> {
        let error = |field: &str, problem: String| SourceError::Field {
            path: path.to_owned(),
            field: field.to_owned(),
            problem,
        };
        let (file, _) = file::open(path)?;
        let mut bytes = Vec::new();
        file.take(MAX_HEADER).read_to_end(&mut bytes).map_err(|cause| file::io_error(path, cause))?;
        let (length, begins) = match bytes.get(6) {
            Some(1) => {
                (bytes.get(8..10).map(|length| u64::from(u16::from_le_bytes([length[0], length[1]]))), 10)
            }
            Some(2 | 3) => {
                let length = bytes.get(8..12).and_then(|length| length.try_into().ok());
                (length.map(|length| u64::from(u32::from_le_bytes(length))), 12)
            }
            version => {
                let found = version.map_or("the end".to_owned(), u8::to_string);
                return Err(error("version", format!("expected 1, 2 or 3, found {found}")));
            }
        };
        let end = length.and_then(|length| usize::try_from(length.checked_add(begins)?).ok());
        let text = end.and_then(|end| bytes.get(begins as usize..end));
        let text = text.ok_or_else(|| error("header", "it is cut off, or too long".to_owned()))?;
        let text = String::from_utf8_lossy(text);
        let value = |key: &str| {
            let shown: String = text.chars().take(80).collect();
            value_of(&text, key)
                .ok_or_else(|| error(key, format!("it is missing from the header `{}`", shown.trim())))
        };
        let kind = value("descr")?;
        let (format, is_half, endian) = element(kind).ok_or_else(|| SourceError::Unsupported {
            path: path.to_owned(),
            found: format!(
                "its elements are of type {}, no real numbers",
                kind.chars().take(40).collect::<String>()
            ),
            mend: "save an array of integers or floats: `np.save(name, array.astype(np.float32))`".to_owned(),
        })?;
        let shape = value("shape")?;
        let sizes = shape.trim_matches(['(', ')']).split(',').map(str::trim).filter(|side| !side.is_empty());
        // Python 2 wrote long integers with an L.
        let sizes: Option<Vec<u64>> = sizes.map(|side| side.trim_end_matches('L').parse().ok()).collect();
        let shape = sizes
            .filter(|sizes| sizes.len() <= 16)
            .ok_or_else(|| error("shape", format!("expected sizes such as (4, 3, 2), found {shape}")))?;
        let is_fortran = value("fortran_order")?.starts_with("True");
        let data_offset = end.map_or(0, |end| end as u64);
        Ok(Self { format, is_half, endian, is_fortran, shape, data_offset })
    }

    /// What each axis is, as NumPy counts them, and where it goes; and whether the numbers of a voxel are a colour.
    fn axes(&self) -> (Vec<(Side, DVec3)>, bool) {
        let axes = self.shape.len();
        let last = self.shape.last().copied().unwrap_or(1);
        let is_byte = self.format == StoredFormat::U8;
        let has_components = match axes {
            0..3 => false,
            3 => is_byte && matches!(last, 3 | 4),
            _ => (2..=FEW).contains(&last),
        };
        let space = axes - usize::from(has_components);
        let named = |axis: usize| format!("axis {axis}");
        let axis = |(axis, &samples): (usize, &u64)| {
            if has_components && axis + 1 == axes {
                return (Side::components(samples, &named(axis)), DVec3::ZERO);
            }
            match space - axis {
                behind @ 1..=3 => (Side::space(samples), [DVec3::X, DVec3::Y, DVec3::Z][behind - 1]),
                _ => (Side::entries(samples, &named(axis)), DVec3::ZERO),
            }
        };
        (self.shape.iter().enumerate().map(axis).collect(), has_components && is_byte)
    }
}

/// The value of a key in a dictionary, up to the comma or brace behind it.
fn value_of<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    let at = ['\'', '"'].iter().find_map(|quote| {
        let key = format!("{quote}{key}{quote}");
        text.find(&key).map(|at| at + key.len())
    })?;
    let value = text[at..].trim_start().strip_prefix(':')?.trim_start();
    let mut depth = 0_usize;
    let end = value.find(|letter| match letter {
        '(' | '[' => {
            depth += 1;
            false
        }
        ')' | ']' => {
            depth = depth.saturating_sub(1);
            false
        }
        ',' | '}' => depth == 0,
        _ => false,
    });
    Some(value[..end?].trim())
}

/// The type `'<f4'` stands for, and whether it is read as words; `None` if it is not a real number.
fn element(kind: &str) -> Option<(StoredFormat, bool, Endian)> {
    let name = kind.strip_prefix(['\'', '"'])?.strip_suffix(['\'', '"'])?;
    let (endian, name) = match name.as_bytes().first()? {
        b'<' | b'|' => (Endian::Little, &name[1..]),
        b'>' => (Endian::Big, &name[1..]),
        b'=' if cfg!(target_endian = "big") => (Endian::Big, &name[1..]),
        b'=' => (Endian::Little, &name[1..]),
        _ => (Endian::Little, name),
    };
    let format = match name {
        "u1" | "b1" | "?" => StoredFormat::U8,
        "i1" => StoredFormat::I8,
        "u2" => StoredFormat::U16,
        "i2" => StoredFormat::I16,
        "u4" => StoredFormat::U32,
        "i4" => StoredFormat::I32,
        "u8" => StoredFormat::U64,
        "i8" => StoredFormat::I64,
        "f2" => return Some((StoredFormat::U16, true, endian)),
        "f4" => StoredFormat::F32,
        "f8" => StoredFormat::F64,
        _ => return None,
    };
    Some((format, false, endian))
}

#[cfg(test)]
mod tests;
