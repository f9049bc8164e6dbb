//! RAW volumes: nothing but samples, x fastest; what they mean comes from the scene.

use std::{
    fs::File,
    io::{self, BufReader, Read, Seek, SeekFrom},
    path::Path,
};

use bytemuck::Pod;
use flate2::bufread::MultiGzDecoder;
use glam::Vec3;

use super::{
    LayoutError, SourceError, file,
    volume::{Endian, MAX_VOLUME_BYTES, SampleFormat, Samples, VolumeData, check_spacing, checked_bytes},
};

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Samples by which the memory of an unpacked volume grows at first; later it doubles.
const FIRST_SAMPLES: usize = 1 << 16;

/// Bytes beyond the last sample that are counted to tell how much too long an unpacked file is.
const MAX_SURPLUS_COUNTED: u64 = 1 << 20;

/// What the bytes of a RAW file are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawLayout {
    /// Voxels along x, y, z; each at least 1.
    pub size: [u32; 3],
    /// How one sample is stored.
    pub format: SampleFormat,
    /// The order of a sample's bytes; does not matter for 8 bits.
    pub endian: Endian,
    /// Distance of voxel centres along x, y, z, in mm; finite, greater than 0.
    pub spacing: Vec3,
    /// Bytes in front of the first sample, in the unpacked file.
    pub skip_bytes: u64,
}

impl RawLayout {
    /// Bytes of the samples, without what is skipped.
    ///
    /// # Errors
    ///
    /// If no file can have this layout: an empty side, a spacing that is not finite and positive, or more than
    /// [`MAX_VOLUME_BYTES`] of samples or of skipped bytes.
    pub fn bytes(&self) -> Result<u64, LayoutError> {
        check_spacing(self.spacing)?;
        if self.skip_bytes > MAX_VOLUME_BYTES {
            return Err(LayoutError::Skip { skip_bytes: self.skip_bytes, limit: MAX_VOLUME_BYTES });
        }
        checked_bytes(self.size, self.format.bytes())
    }
}

/// Reads a RAW volume; a file named `.gz` that begins like one is unpacked on the way.
///
/// # Errors
///
/// If the layout is impossible, the file cannot be read or unpacked, or it is not exactly as long as the layout says. A plain
/// file's length is compared before anything is allocated; a packed one's memory grows with what comes out.
pub fn read_raw(path: &Path, layout: &RawLayout) -> Result<VolumeData, SourceError> {
    let as_error = |problem| SourceError::Layout { path: path.to_owned(), problem };
    let bytes = layout.bytes().map_err(as_error)?;
    let (mut file, file_bytes) = file::open(path)?;
    let begins_like_gzip = begins_like_gzip(&mut file).map_err(|cause| file::io_error(path, cause))?;
    let named_gzip = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    let source =
        RawSource { path, layout, needed: layout.skip_bytes + bytes, packed: begins_like_gzip && named_gzip };
    let samples = if source.packed {
        source.read_samples(MultiGzDecoder::new(BufReader::new(file)))?
    } else {
        if file_bytes != source.needed {
            let hint = match (begins_like_gzip, named_gzip) {
                (true, false) => "; it begins like a gzip file: if it is one, name it .gz",
                (false, true) => "; it is named .gz but does not begin like a gzip file",
                _ => "",
            };
            return Err(source.length_error(file_bytes, false, hint));
        }
        source.read_samples(file)?
    };
    VolumeData::new(layout.size, layout.spacing, samples).map_err(as_error)
}

fn begins_like_gzip(file: &mut File) -> io::Result<bool> {
    let mut magic = Vec::new();
    file.take(2).read_to_end(&mut magic)?;
    file.seek(SeekFrom::Start(0))?;
    Ok(magic == GZIP_MAGIC)
}

/// One file on its way in: what its errors have to name.
struct RawSource<'a> {
    path: &'a Path,
    layout: &'a RawLayout,
    /// Bytes to be read, with what is skipped.
    needed: u64,
    /// Whether it comes out of a gzip stream.
    packed: bool,
}

impl RawSource<'_> {
    fn read_samples(&self, mut reader: impl Read) -> Result<Samples, SourceError> {
        let skipped = io::copy(&mut (&mut reader).take(self.layout.skip_bytes), &mut io::sink());
        let skipped = skipped.map_err(|cause| self.read_error(cause, 0))?;
        if skipped < self.layout.skip_bytes {
            return Err(self.length_error(skipped, false, ""));
        }
        let samples = match self.layout.format {
            SampleFormat::U8 => Samples::U8(self.read_vec(&mut reader, |sample| sample)?),
            SampleFormat::I8 => Samples::I8(self.read_vec(&mut reader, |sample| sample)?),
            SampleFormat::U16 => Samples::U16(self.read_vec(&mut reader, u16::swap_bytes)?),
            SampleFormat::I16 => Samples::I16(self.read_vec(&mut reader, i16::swap_bytes)?),
            SampleFormat::F32 => {
                let swap = |sample: f32| f32::from_bits(sample.to_bits().swap_bytes());
                Samples::F32(self.read_vec(&mut reader, swap)?)
            }
        };
        self.expect_end(reader)?;
        Ok(samples)
    }

    /// Reads every sample, growing as they arrive, and puts their bytes into the machine's order.
    fn read_vec<T: Pod>(&self, reader: &mut impl Read, swap: impl Fn(T) -> T) -> Result<Vec<T>, SourceError> {
        let bytes = self.needed - self.layout.skip_bytes;
        let count = bytes as usize / size_of::<T>();
        let mut samples: Vec<T> = Vec::new();
        while samples.len() < count {
            let start = samples.len();
            // A plain file is known to hold them all.
            let step = if self.packed { start.max(FIRST_SAMPLES).min(count - start) } else { count };
            samples
                .try_reserve_exact(step)
                .map_err(|_| SourceError::OutOfMemory { path: self.path.to_owned(), bytes })?;
            samples.resize(start + step, T::zeroed());
            let before = self.layout.skip_bytes + (start * size_of::<T>()) as u64;
            let arrived = self.fill(reader, bytemuck::cast_slice_mut(&mut samples[start..]), before)?;
            if arrived < step * size_of::<T>() {
                return Err(self.length_error(before + arrived as u64, false, ""));
            }
        }
        let file_is_native = (self.layout.endian == Endian::Little) == cfg!(target_endian = "little");
        if !file_is_native {
            samples.iter_mut().for_each(|sample| *sample = swap(*sample));
        }
        Ok(samples)
    }

    /// Fills `bytes` as far as the file reaches; says how far that is. `before` bytes came out earlier.
    fn fill(&self, reader: &mut impl Read, bytes: &mut [u8], before: u64) -> Result<usize, SourceError> {
        let mut filled = 0;
        while filled < bytes.len() {
            match reader.read(&mut bytes[filled..]) {
                Ok(0) => break,
                Ok(read) => filled += read,
                Err(cause) if cause.kind() == io::ErrorKind::Interrupted => {}
                Err(cause) => return Err(self.read_error(cause, before + filled as u64)),
            }
        }
        Ok(filled)
    }

    /// Refuses bytes after the last sample; on the way a gzip stream checks its sum.
    fn expect_end(&self, reader: impl Read) -> Result<(), SourceError> {
        let surplus = io::copy(&mut reader.take(MAX_SURPLUS_COUNTED), &mut io::sink());
        match surplus.map_err(|cause| self.read_error(cause, self.needed))? {
            0 => Ok(()),
            surplus => Err(self.length_error(self.needed + surplus, surplus == MAX_SURPLUS_COUNTED, "")),
        }
    }

    fn read_error(&self, cause: io::Error, unpacked: u64) -> SourceError {
        if !self.packed {
            return file::io_error(self.path, cause);
        }
        let (problem, mend) = match cause.kind() {
            io::ErrorKind::UnexpectedEof => {
                ("the gzip stream ends too early".to_owned(), "the file is cut off: fetch or pack it again")
            }
            io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData if unpacked >= self.needed => {
                (format!("checksum or trailing bytes are wrong ({cause})"), "pack it again with gzip")
            }
            io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData => {
                (format!("the gzip stream is corrupt ({cause})"), "fetch or pack it again")
            }
            _ => return file::io_error(self.path, cause),
        };
        SourceError::Gzip { path: self.path.to_owned(), unpacked, problem, mend }
    }

    /// The error for a file of `bytes` bytes, or of more where they were not all counted.
    fn length_error(&self, bytes: u64, or_more: bool, hint: &str) -> SourceError {
        let RawLayout { size: [x, y, z], format, skip_bytes, .. } = *self.layout;
        let unpacked = if self.packed { "unpacked " } else { "" };
        let at_least = if or_more { "at least " } else { "" };
        let header =
            if skip_bytes > 0 { format!(" after {skip_bytes} skipped bytes") } else { String::new() };
        let surplus = bytes.saturating_sub(self.needed);
        let (difference, mend) = if surplus == 0 {
            (format!("{} fewer", self.needed - bytes), "is the size, format or skip_bytes wrong?".to_owned())
        } else if or_more {
            (format!("at least {surplus} more"), "is the size, format or skip_bytes wrong?".to_owned())
        } else {
            let skip = skip_bytes + surplus;
            (
                format!("{surplus} more"),
                format!(
                    "if that is a header in front, set skip_bytes to {skip}; otherwise is the size or format wrong?"
                ),
            )
        };
        SourceError::Length {
            path: self.path.to_owned(),
            found: format!("{at_least}{bytes} {unpacked}bytes"),
            expected: format!("{x} x {y} x {z} {format} voxels{header} need {}", self.needed),
            difference: format!("{difference} than expected"),
            mend: format!("{mend}{hint}"),
        }
    }
}

#[cfg(test)]
mod tests;
