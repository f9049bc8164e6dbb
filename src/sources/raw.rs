//! RAW volumes: nothing but samples, x fastest; what they mean comes from the scene.

use std::path::Path;

use glam::Vec3;

use super::{
    LayoutError, SourceError, file,
    pick::Pick,
    stored::{Scaling, Stored, StoredFormat},
    stream::{Packing, SampleStream, Surplus},
    volume::{Endian, SampleFormat, Samples, VolumeData, check_spacing, checked_bytes},
};

/// What every gzip file begins with.
pub(super) const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// The most bytes in front of the first sample: more than any file system holds.
const MAX_SKIP_BYTES: u64 = 1 << 60;

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
    /// Bytes in front of the first sample, in the unpacked file. Those of a plain file are never read, however many they are.
    pub skip_bytes: u64,
}

impl RawLayout {
    /// Bytes of the samples, without what is skipped.
    ///
    /// # Errors
    ///
    /// If no file can have this layout: an empty side, a spacing that is not finite and positive, more than
    /// [`MAX_VOLUME_BYTES`](super::volume::MAX_VOLUME_BYTES) of samples, or more skipped bytes than a file can have.
    pub fn bytes(&self) -> Result<u64, LayoutError> {
        check_spacing(self.spacing)?;
        if self.skip_bytes > MAX_SKIP_BYTES {
            return Err(LayoutError::Skip { skip_bytes: self.skip_bytes, limit: MAX_SKIP_BYTES });
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
    let begins_like_gzip = file::begins_with(path, &mut file, &GZIP_MAGIC)?;
    let named_gzip = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
    let hint = match (begins_like_gzip, named_gzip) {
        (true, false) => "; it begins like a gzip file: if it is one, name it .gz",
        (false, true) => "; it is named .gz but does not begin like a gzip file",
        _ => "",
    };
    let RawLayout { size: [x, y, z], format, endian, skip_bytes, .. } = *layout;
    let (stored_format, numbers) = StoredFormat::of(format);
    let stream = SampleStream {
        path,
        what: format!("{x} x {y} x {z} {format} voxels"),
        samples: bytes / format.bytes() * numbers,
        pick: Pick::ALL,
        format: stored_format,
        endian,
        packing: if begins_like_gzip && named_gzip { Packing::Gzip } else { Packing::Plain },
        offset: 0,
        skip: skip_bytes,
        surplus: Surplus::Refuse,
        mend: &|surplus| mend(skip_bytes, surplus),
        hint,
    };
    let mut notes = Vec::new();
    let stored = stream.read(file, file_bytes, &mut notes)?;
    let samples = match (format, stored) {
        (SampleFormat::Rgba8, Stored::U8(bytes)) => Samples::Rgba8(bytemuck::cast_slice(&bytes).to_vec()),
        (_, stored) => stored.into_samples(path, &Scaling::NONE, &mut notes)?,
    };
    VolumeData::new(layout.size, layout.spacing, samples).map_err(as_error)
}

/// What to try for a length that the scene did not say; the bytes too many may be a header.
fn mend(skip_bytes: u64, surplus: Option<u64>) -> String {
    match surplus {
        None => "is the size, format or skip_bytes wrong?".to_owned(),
        Some(surplus) => format!(
            "if that is a header in front, set skip_bytes to {}; otherwise is the size or format wrong?",
            skip_bytes + surplus
        ),
    }
}

#[cfg(test)]
mod tests;
