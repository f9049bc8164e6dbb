//! The header of a NIfTI file, by where its two versions keep their fields.

use std::{
    io::Read,
    path::{Path, PathBuf},
};

use flate2::read::MultiGzDecoder;

use super::{BYTES_1, BYTES_2};
use crate::sources::{
    SourceError, VolumeData, file,
    raw::GZIP_MAGIC,
    shape::Side,
    stored::{Scaling, StoredFormat},
    trail,
    volume::{Endian, Labels, Samples},
};

/// What the file says its values mean: labels, or the channels of a colour.
const LABEL: i64 = 1002;
const RGB_VECTOR: i64 = 2003;
const RGBA_VECTOR: i64 = 2004;

/// The bytes of a header, by where the two versions keep its fields.
pub(super) struct Header<'a> {
    /// The file.
    pub path: &'a Path,
    bytes: Vec<u8>,
    /// The order of the bytes of header and samples.
    pub endian: Endian,
    /// Whether it is of version 2.
    pub is_2: bool,
}

/// A sample, and how many make a voxel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// How one is stored.
    pub format: StoredFormat,
    /// How many alternate in a voxel: 3 or 4 of a colour, else 1.
    pub channels: u64,
}

impl<'a> Header<'a> {
    /// Reads the header, of a file that is plain or gzipped.
    pub fn read(path: &'a Path) -> Result<Self, SourceError> {
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
    pub fn field<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut bytes = [0; N];
        if let Some(field) = self.bytes.get(at..at + N) {
            bytes.copy_from_slice(field);
        }
        if self.endian == Endian::Big {
            bytes.reverse();
        }
        bytes
    }

    /// A number of 16 bits.
    pub fn i16(&self, at: usize) -> i64 {
        i16::from_le_bytes(self.field(at)).into()
    }

    /// A number of 32 bits.
    pub fn i32(&self, at: usize) -> i64 {
        i32::from_le_bytes(self.field(at)).into()
    }

    /// Element `index` of the numbers at `at_1`, 32 bits in version 1, or `at_2`, 64 bits in version 2.
    pub fn float(&self, at_1: usize, at_2: usize, index: usize) -> f64 {
        if self.is_2 {
            f64::from_le_bytes(self.field(at_2 + 8 * index))
        } else {
            f32::from_le_bytes(self.field(at_1 + 4 * index)).into()
        }
    }

    /// How one sample is stored, and how many of them make a voxel.
    pub fn sample(&self) -> Result<Sample, SourceError> {
        let code = self.i16(if self.is_2 { 12 } else { 70 });
        let format = match code {
            2 => StoredFormat::U8,
            4 => StoredFormat::I16,
            8 => StoredFormat::I32,
            16 => StoredFormat::F32,
            64 => StoredFormat::F64,
            128 => return Ok(Sample { format: StoredFormat::U8, channels: 3 }),
            256 => StoredFormat::I8,
            512 => StoredFormat::U16,
            768 => StoredFormat::U32,
            1024 => StoredFormat::I64,
            1280 => StoredFormat::U64,
            2304 => return Ok(Sample { format: StoredFormat::U8, channels: 4 }),
            _ => {
                let name = match code {
                    1 => "single bits",
                    32 | 1792 | 2048 => "complex numbers",
                    1536 => "128-bit floats",
                    _ => "of a type that the format does not have",
                };
                return Err(SourceError::Unsupported {
                    path: self.path.to_owned(),
                    found: format!("its samples are {name} (datatype {code})"),
                    mend: "convert them to one integer or 32-bit float a voxel".to_owned(),
                });
            }
        };
        Ok(Sample { format, channels: 1 })
    }

    /// What each dimension is: three of space, time, the numbers of a voxel, and two more.
    pub fn sides(&self, channels: u64) -> Result<Vec<Side>, SourceError> {
        let dim = |index: usize| {
            if self.is_2 { i64::from_le_bytes(self.field(16 + 8 * index)) } else { self.i16(40 + 2 * index) }
        };
        let count = dim(0);
        if !(1..=7).contains(&count) {
            return Err(self.error("dim[0]", format!("{count} dimensions; expected 1 to 7")));
        }
        let side =
            |index: usize| if index as i64 <= count { u64::try_from(dim(index)).unwrap_or(0) } else { 1 };
        // Beyond space some write 0 for a dimension that is not used.
        let more = |index: usize| side(index).max(1);
        Ok(vec![
            Side::components(channels, "colours"),
            Side::space(side(1)),
            Side::space(side(2)),
            Side::space(side(3)),
            Side::entries(more(4), "dim[4], time"),
            Side::components(more(5), "dim[5]"),
            Side::entries(more(6), "dim[6]"),
            Side::entries(more(7), "dim[7]"),
        ])
    }

    /// Whether the numbers of a voxel are channels of a colour: by their type, or by what the file says that they mean.
    pub fn is_colour(&self, channels: u64) -> bool {
        channels > 1 || matches!(self.intent(), RGB_VECTOR | RGBA_VECTOR)
    }

    fn intent(&self) -> i64 {
        if self.is_2 { self.i32(504) } else { self.i16(68) }
    }

    /// The values to look at, if the header recommends any.
    pub fn window(&self) -> Option<(f32, f32)> {
        let (greatest, least) = (self.float(124, 192, 0), self.float(128, 200, 0));
        let is_meant = least.is_finite() && greatest.is_finite() && greatest > least;
        is_meant.then_some((least as f32, greatest as f32))
    }

    /// That the values are labels, if the file says so and they can be.
    pub fn labels(&self, volume: &VolumeData) -> Option<Labels> {
        let is_whole = match &volume.samples {
            Samples::Rgba8(_) => false,
            Samples::F32(samples) => samples.iter().all(|sample| sample.fract() == 0.0),
            _ => true,
        };
        (self.intent() == LABEL && is_whole).then(Labels::default)
    }

    /// Where in a 32-bit number its least byte is.
    pub fn last_byte(&self) -> usize {
        if self.endian == Endian::Big { 3 } else { 0 }
    }

    /// What the header does to its samples.
    pub fn scaling(&self) -> Scaling {
        let (slope, intercept) = (self.float(112, 176, 0), self.float(116, 184, 0));
        if slope == 0.0 || !slope.is_finite() || !intercept.is_finite() {
            return Scaling::NONE;
        }
        Scaling::of(slope, intercept)
    }

    fn is_alone(&self) -> bool {
        self.bytes.get(if self.is_2 { 5 } else { 345 }) == Some(&b'+')
    }

    /// Where the samples begin.
    pub fn data_offset(&self) -> Result<u64, SourceError> {
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
    pub fn data_file(&self) -> PathBuf {
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
