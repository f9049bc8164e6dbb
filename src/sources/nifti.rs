//! NIfTI-1 and NIfTI-2: a binary header of 348 or 540 bytes, then samples, in the same file or in an .img beside it.
//!
//! The `nifti` crate panics where `bitpix` contradicts `datatype`, and reserves what the header says. With sizes, `bitpix`,
//! `vox_offset` and the length checked before, it did neither in 1000 damaged files; but it refuses NIfTI-2, so this structure
//! would still be read here. `medrs` held without checks, but refuses an .hdr whose samples begin at 0 in its .img, and did not
//! build without CMake. Counts are in [`super::self_describing`]; the format is that of <https://nifti.nimh.nih.gov/nifti-1/>
//! and <https://nifti.nimh.nih.gov/nifti-2/>.

use std::{
    io::Read,
    path::{Path, PathBuf},
};

use flate2::read::MultiGzDecoder;
use glam::{DMat3, DQuat, DVec3};

use super::{
    Selection, SourceError, file,
    grid::Grid,
    raw::GZIP_MAGIC,
    stored::{Scaling, StoredFormat},
    stream::{Packing, SampleStream, Surplus, mend_by_header},
    trail,
    volume::{Endian, VolumeData},
};

const BYTES_1: usize = 348;
const BYTES_2: usize = 540;

/// Whether a file that begins with `head`, unpacked, is of this format.
pub(super) fn is_nifti(head: &[u8]) -> bool {
    let at = |start: usize, text: &[u8]| head.get(start..start + text.len()) == Some(text);
    at(344, b"n+1\0") || at(344, b"ni1\0") || at(4, b"n+2\0") || at(4, b"ni2\0")
}

/// Whether a header says how its axes lie in a patient.
pub(super) fn has_direction(head: &[u8]) -> bool {
    let is_set = |place: usize, bytes: usize| {
        head.get(place..place + bytes).is_some_and(|code| code.iter().any(|byte| *byte != 0))
    };
    // `qform_code` and `sform_code`.
    match head.first_chunk::<4>().map(|size| i32::from_le_bytes(*size)) {
        Some(size) if [size, size.swap_bytes()].contains(&(BYTES_2 as i32)) => {
            is_set(344, 4) || is_set(348, 4)
        }
        _ => is_set(252, 2) || is_set(254, 2),
    }
}

/// Whether it is the header that NIfTI grew out of.
pub(super) fn is_analyze(head: &[u8]) -> bool {
    let length =
        head.first_chunk::<4>().map(|bytes| [i32::from_le_bytes(*bytes), i32::from_be_bytes(*bytes)]);
    length.is_some_and(|length| length.contains(&(BYTES_1 as i32)))
        && head.len() >= BYTES_1
        && !is_nifti(head)
}

/// Reads the first volume of a NIfTI file, plain or gzipped.
///
/// # Errors
///
/// If the header is cut off or contradicts itself, samples are colours or complex, or they are not all there.
pub(super) fn read(path: &Path, _selection: &Selection) -> Result<VolumeData, SourceError> {
    let header = Header::read(path)?;
    let mut notes = Vec::new();
    let (format, dims) = (header.format()?, header.dims()?);
    let bytes = format.bytes();
    let entries: u64 = dims[3..].iter().fold(1, |all: u64, &side| all.saturating_mul(side.max(1)));
    if entries > 1 {
        notes.push(format!("only the first of its {entries} volumes (time points or components) is read"));
    }
    let (axes, anatomical) = header.axes(&mut notes);
    let grid = Grid::new(path, &dims[..3], &axes, anatomical, bytes)?;
    let data = header.data_file();
    let (mut file, file_bytes) = file::open(&data)?;
    let packed = file::begins_with(&data, &mut file, &GZIP_MAGIC)?;
    let skip = header.data_offset()?;
    let stream = SampleStream {
        path: &data,
        what: grid.what(bytes),
        samples: grid.samples(),
        format,
        endian: header.endian,
        packing: if packed { Packing::Gzip } else { Packing::Plain },
        offset: if packed { 0 } else { skip },
        skip: if packed { skip } else { 0 },
        surplus: if entries > 1 { Surplus::Ignore } else { Surplus::Note },
        mend: &mend_by_header,
        hint: "",
    };
    let stored = stream.read(file, file_bytes, &mut notes)?;
    grid.volume(path, stored, &header.scaling(), notes)
}

/// The bytes of a header, by where the two versions keep its fields.
struct Header<'a> {
    path: &'a Path,
    bytes: Vec<u8>,
    endian: Endian,
    is_2: bool,
}

impl<'a> Header<'a> {
    fn read(path: &'a Path) -> Result<Self, SourceError> {
        let (mut file, _) = file::open(path)?;
        let packed = file::begins_with(path, &mut file, &GZIP_MAGIC)?;
        let mut bytes = Vec::new();
        let limit = BYTES_2 as u64;
        let read = if packed {
            MultiGzDecoder::new(file).take(limit).read_to_end(&mut bytes)
        } else {
            file.take(limit).read_to_end(&mut bytes)
        };
        // A stream that breaks behind the header is the concern of who reads the samples.
        if let (Err(cause), true) = (read, bytes.len() < BYTES_1) {
            return Err(file::io_error(path, cause));
        }
        let length = bytes.first_chunk::<4>().copied().unwrap_or_default();
        let endian = match (i32::from_le_bytes(length), i32::from_be_bytes(length)) {
            (348 | 540, _) => Endian::Little,
            _ => Endian::Big,
        };
        let is_2 = bytes.get(4..6) == Some(b"n+") || bytes.get(4..6) == Some(b"ni");
        let needed = if is_2 { BYTES_2 } else { BYTES_1 };
        let header = Self { path, bytes, endian, is_2 };
        if header.bytes.len() < needed {
            let problem =
                format!("{} bytes; a NIfTI header has {needed}; the file is cut off", header.bytes.len());
            return Err(header.error("header", problem));
        }
        Ok(header)
    }

    fn error(&self, field: &str, problem: String) -> SourceError {
        SourceError::Field { path: self.path.to_owned(), field: field.to_owned(), problem }
    }

    /// Bytes of a field, the least significant first; 0 beyond the header.
    fn field<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut bytes = [0; N];
        if let Some(field) = self.bytes.get(at..at + N) {
            bytes.copy_from_slice(field);
        }
        if self.endian == Endian::Big {
            bytes.reverse();
        }
        bytes
    }

    fn i16(&self, at: usize) -> i64 {
        i16::from_le_bytes(self.field(at)).into()
    }

    fn i32(&self, at: usize) -> i64 {
        i32::from_le_bytes(self.field(at)).into()
    }

    /// Element `index` of the numbers at `at_1`, 32 bits in version 1, or `at_2`, 64 bits in version 2.
    fn float(&self, at_1: usize, at_2: usize, index: usize) -> f64 {
        if self.is_2 {
            f64::from_le_bytes(self.field(at_2 + 8 * index))
        } else {
            f32::from_le_bytes(self.field(at_1 + 4 * index)).into()
        }
    }

    fn format(&self) -> Result<StoredFormat, SourceError> {
        let code = self.i16(if self.is_2 { 12 } else { 70 });
        Ok(match code {
            2 => StoredFormat::U8,
            4 => StoredFormat::I16,
            8 => StoredFormat::I32,
            16 => StoredFormat::F32,
            64 => StoredFormat::F64,
            256 => StoredFormat::I8,
            512 => StoredFormat::U16,
            768 => StoredFormat::U32,
            1024 => StoredFormat::I64,
            1280 => StoredFormat::U64,
            _ => {
                let name = match code {
                    1 => "single bits",
                    32 | 1792 | 2048 => "complex numbers",
                    128 | 2304 => "colours",
                    1536 => "128-bit floats",
                    _ => "of a type that the format does not have",
                };
                return Err(SourceError::Unsupported {
                    path: self.path.to_owned(),
                    found: format!("its samples are {name} (datatype {code})"),
                    mend: "convert them to one integer or 32-bit float a voxel".to_owned(),
                });
            }
        })
    }

    /// Sides of all seven dimensions; 1 for those that are not there.
    fn dims(&self) -> Result<[u64; 7], SourceError> {
        let dim = |index: usize| {
            if self.is_2 { i64::from_le_bytes(self.field(16 + 8 * index)) } else { self.i16(40 + 2 * index) }
        };
        let count = dim(0);
        if !(1..=7).contains(&count) {
            return Err(self.error("dim[0]", format!("{count} dimensions; expected 1 to 7")));
        }
        let side =
            |index: usize| if index as i64 <= count { u64::try_from(dim(index)).unwrap_or(0) } else { 1 };
        Ok([1, 2, 3, 4, 5, 6, 7].map(side))
    }

    /// From one voxel to the next along each axis, in mm, and whether that is right, anterior, superior: by the sform, else the
    /// qform, else the sizes alone.
    fn axes(&self, notes: &mut Vec<String>) -> ([DVec3; 3], bool) {
        let millimetres = match self.field::<1>(if self.is_2 { 500 + self.last_byte() } else { 123 })[0] & 7 {
            1 => 1e3,
            3 => 1e-3,
            _ => 1.0,
        };
        let pixdim = |index: usize| self.float(76, 104, index);
        let side = |index: usize| match pixdim(index).abs() {
            0.0 => 1.0,
            side => side,
        };
        let sides = [side(1), side(2), side(3)];
        let (qform, sform) =
            if self.is_2 { (self.i32(344), self.i32(348)) } else { (self.i16(252), self.i16(254)) };
        let usable = |axes: &[DVec3; 3]| axes.iter().all(|axis| axis.is_finite() && axis.length() > 0.0);
        let row = |axis: usize| {
            let at = |row: usize| self.float(280, 400, 4 * row + axis);
            DVec3::new(at(0), at(1), at(2))
        };
        let by_sform = (sform > 0).then(|| [row(0), row(1), row(2)]);
        let by_qform = (qform > 0).then(|| {
            let [b, c, d] = [0, 1, 2].map(|index| self.float(256, 352, index));
            let a = (1.0 - (b * b + c * c + d * d)).max(0.0).sqrt();
            let turn = DMat3::from_quat(DQuat::from_xyzw(b, c, d, a).normalize());
            let z_sign = if pixdim(0) < 0.0 { -1.0 } else { 1.0 };
            [turn.x_axis * sides[0], turn.y_axis * sides[1], turn.z_axis * sides[2] * z_sign]
        });
        let written = [by_sform, by_qform];
        match written.iter().flatten().find(|axes| usable(axes)) {
            Some(axes) => (axes.map(|axis| axis * millimetres), true),
            None => {
                if written.iter().any(Option::is_some) {
                    notes.push(
                        "its sform and qform cannot be; only the sizes of its voxels are used".to_owned(),
                    );
                }
                let units = [DVec3::X, DVec3::Y, DVec3::Z];
                ([0, 1, 2].map(|axis| units[axis] * sides[axis] * millimetres), false)
            }
        }
    }

    /// Where in a 32-bit number its least byte is.
    fn last_byte(&self) -> usize {
        if self.endian == Endian::Big { 3 } else { 0 }
    }

    fn scaling(&self) -> Scaling {
        let (slope, intercept) = (self.float(112, 176, 0), self.float(116, 184, 0));
        if slope == 0.0 || !slope.is_finite() || !intercept.is_finite() {
            return Scaling::NONE;
        }
        Scaling::of(slope, intercept)
    }

    fn is_alone(&self) -> bool {
        self.bytes.get(if self.is_2 { 5 } else { 345 }) == Some(&b'+')
    }

    fn data_offset(&self) -> Result<u64, SourceError> {
        let least = if !self.is_alone() {
            0
        } else if self.is_2 {
            544
        } else {
            352
        };
        let offset =
            if self.is_2 { i64::from_le_bytes(self.field(168)) as f64 } else { self.float(108, 0, 0) };
        if !(0.0..=9e15).contains(&offset) {
            return Err(self.error("vox_offset", format!("{offset}; expected bytes, from 0")));
        }
        Ok((offset as u64).max(least))
    }

    /// The file that the samples are in.
    fn data_file(&self) -> PathBuf {
        if self.is_alone() {
            return self.path.to_owned();
        }
        let stem = if self.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gz")) {
            self.path.with_extension("")
        } else {
            self.path.to_owned()
        };
        let data = stem.with_extension("img");
        let packed = stem.with_extension("img.gz");
        trail::note(&data);
        if !data.exists() && packed.exists() { packed } else { data }
    }
}

#[cfg(test)]
mod tests;
