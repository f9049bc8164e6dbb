//! Regular grids of samples, the range of values in each brick of them, and how often each value occurs.

mod bricks;
mod core_range;
mod evidence;
mod frame;
mod histogram;
mod labels;
mod slices;

use std::fmt;

use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::Vec3;

pub use bricks::BrickRanges;
pub use frame::{Frame, Space};
pub use histogram::Histogram;
pub use labels::{Label, Labels};
pub use slices::SliceRanges;

use super::LayoutError;

/// The most bytes of samples a volume may have: 8 GiB.
pub const MAX_VOLUME_BYTES: u64 = 8 << 30;

/// Floating-point samples beyond this in magnitude count as non-finite, so that sums of a few of the others stay finite.
pub const MAX_SAMPLE_MAGNITUDE: f32 = 1e30;

/// Whether a floating-point sample is there, and not one that counts as missing.
pub(crate) fn is_present(sample: f32) -> bool {
    sample.abs() <= MAX_SAMPLE_MAGNITUDE
}

/// How one sample is stored.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[reflect(Default, PartialEq)]
#[non_exhaustive]
pub enum SampleFormat {
    /// Unsigned, 8 bits.
    #[default]
    U8,
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 16 bits.
    I16,
    /// IEEE 754, 32 bits.
    F32,
    /// A colour: red, green, blue and opacity, 8 bits each, the first three encoded as in sRGB. Its value is its luminance, and none where it is clear.
    Rgba8,
}

impl SampleFormat {
    /// Bytes of one sample.
    pub const fn bytes(self) -> u64 {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::F32 | Self::Rgba8 => 4,
        }
    }

    /// The least and greatest value of an integer format; `None` for floating point.
    pub const fn integer_range(self) -> Option<(f32, f32)> {
        match self {
            Self::U8 | Self::Rgba8 => Some((0.0, 255.0)),
            Self::I8 => Some((-128.0, 127.0)),
            Self::U16 => Some((0.0, 65535.0)),
            Self::I16 => Some((-32768.0, 32767.0)),
            Self::F32 => None,
        }
    }
}

impl fmt::Display for SampleFormat {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, formatter)
    }
}

/// The order of a sample's bytes in a file.
#[derive(Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[reflect(Default, PartialEq)]
pub enum Endian {
    /// Least significant byte first.
    #[default]
    Little,
    /// Most significant byte first.
    Big,
}

/// The samples of a volume, in the machine's byte order; x varies fastest, then y, then z.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Samples {
    /// Unsigned, 8 bits.
    U8(Vec<u8>),
    /// Signed, 8 bits.
    I8(Vec<i8>),
    /// Unsigned, 16 bits.
    U16(Vec<u16>),
    /// Signed, 16 bits.
    I16(Vec<i16>),
    /// IEEE 754, 32 bits; NaN and infinities are kept as they are.
    F32(Vec<f32>),
    /// Red, green, blue and opacity, 8 bits each; see [`luminance`] for what counts as its value.
    Rgba8(Vec<[u8; 4]>),
}

/// The value of a colour, 0 to 255: the luminance of its encoded primaries (ITU-R BT.709 weights); NaN of what is clear, whose colour means nothing.
pub fn luminance([red, green, blue, opacity]: [u8; 4]) -> f32 {
    if opacity == 0 {
        return f32::NAN;
    }
    let [red, green, blue] = [red, green, blue].map(u32::from);
    (2126 * red + 7152 * green + 722 * blue) as f32 / 10_000.0
}

impl Samples {
    /// How each sample is stored.
    pub fn format(&self) -> SampleFormat {
        match self {
            Self::U8(_) => SampleFormat::U8,
            Self::I8(_) => SampleFormat::I8,
            Self::U16(_) => SampleFormat::U16,
            Self::I16(_) => SampleFormat::I16,
            Self::F32(_) => SampleFormat::F32,
            Self::Rgba8(_) => SampleFormat::Rgba8,
        }
    }

    /// None of these samples, of the same format.
    pub fn emptied(&self) -> Self {
        match self {
            Self::U8(_) => Self::U8(Vec::new()),
            Self::I8(_) => Self::I8(Vec::new()),
            Self::U16(_) => Self::U16(Vec::new()),
            Self::I16(_) => Self::I16(Vec::new()),
            Self::F32(_) => Self::F32(Vec::new()),
            Self::Rgba8(_) => Self::Rgba8(Vec::new()),
        }
    }

    /// How many samples there are.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(samples) => samples.len(),
            Self::I8(samples) => samples.len(),
            Self::U16(samples) => samples.len(),
            Self::I16(samples) => samples.len(),
            Self::F32(samples) => samples.len(),
            Self::Rgba8(samples) => samples.len(),
        }
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The sample at `index`, unscaled; `None` outside.
    pub fn get(&self, index: usize) -> Option<f32> {
        match self {
            Self::U8(samples) => samples.get(index).map(|&sample| sample.into()),
            Self::I8(samples) => samples.get(index).map(|&sample| sample.into()),
            Self::U16(samples) => samples.get(index).map(|&sample| sample.into()),
            Self::I16(samples) => samples.get(index).map(|&sample| sample.into()),
            Self::F32(samples) => samples.get(index).copied(),
            Self::Rgba8(samples) => samples.get(index).map(|&colour| luminance(colour)),
        }
    }

    /// The samples as they lie in memory.
    pub fn as_bytes(&self) -> &[u8] {
        match self {
            Self::U8(samples) => samples,
            Self::I8(samples) => bytemuck::cast_slice(samples),
            Self::U16(samples) => bytemuck::cast_slice(samples),
            Self::I16(samples) => bytemuck::cast_slice(samples),
            Self::F32(samples) => bytemuck::cast_slice(samples),
            Self::Rgba8(samples) => bytemuck::cast_slice(samples),
        }
    }
}

/// A volume in memory.
///
/// Samples that are NaN, infinite or beyond ±[`MAX_SAMPLE_MAGNITUDE`] stay in `samples`, but neither `range` nor `bricks` see them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct VolumeData {
    /// Voxels along x, y, z; each at least 1.
    pub size: [u32; 3],
    /// Distance of voxel centres along x, y, z, in mm; finite, greater than 0.
    pub spacing: Vec3,
    /// One sample per voxel.
    pub samples: Samples,
    /// The least and greatest finite sample; (0, 0) if there is none.
    pub range: (f32, f32),
    /// The same without fill values and a few extreme samples, where those would stretch it to more than twice its length.
    pub core_range: (f32, f32),
    /// How many samples are not finite.
    pub non_finite: u64,
    /// The range of the finite samples in each brick.
    pub bricks: BrickRanges,
    /// The range of the finite samples in each slice.
    pub slices: SliceRanges,
    /// How often each value occurs.
    pub histogram: Histogram,
    /// Where the voxels lie in the world of the file.
    pub frame: Frame,
    /// The least and greatest value to look at, where the file recommends any (a window of DICOM, `cal_min` and `cal_max` of NIfTI).
    pub window: Option<(f32, f32)>,
    /// What the values mean, where the file says that they are labels.
    pub labels: Option<Labels>,
    /// Whether the samples themselves look like labels: few whole numbers in pieces that are constant.
    pub looks_labelled: bool,
    /// What a person should know about how the file was read; empty where there is nothing to say.
    pub notes: Vec<String>,
}

impl VolumeData {
    /// A volume of these samples; looks at each a few times, to find their ranges and to count their values.
    ///
    /// # Errors
    ///
    /// If the size has an empty side or exceeds [`MAX_VOLUME_BYTES`], the spacing is not finite and positive, or the samples
    /// do not fill the size.
    pub fn new(size: [u32; 3], spacing: Vec3, samples: Samples) -> Result<Self, LayoutError> {
        check_spacing(spacing)?;
        let bytes = checked_bytes(size, samples.format().bytes())?;
        if samples.as_bytes().len() as u64 != bytes {
            return Err(LayoutError::SampleCount { size, samples: samples.len() });
        }
        let (bricks, non_finite) = bricks::ranges_of(&samples, size);
        let range = bricks.range().unwrap_or((0.0, 0.0));
        let core_range = core_range::core_range(&samples, range);
        let slices = slices::slices_of(&samples, size);
        let histogram = Histogram::of(&samples, core_range);
        let looks_labelled = evidence::looks_like_labels(&samples, size);
        Ok(Self {
            size,
            spacing,
            samples,
            range,
            core_range,
            non_finite,
            bricks,
            slices,
            histogram,
            frame: Frame::centred(size, spacing),
            window: None,
            labels: None,
            looks_labelled,
            notes: Vec::new(),
        })
    }

    /// Whether its values name what is there, by what the file says or by what they look like.
    pub fn is_label_map(&self) -> bool {
        self.labels.is_some() || self.looks_labelled
    }

    /// The sample of voxel (x, y, z), unscaled; `None` outside.
    pub fn sample(&self, [x, y, z]: [u32; 3]) -> Option<f32> {
        let [size_x, size_y, size_z] = self.size;
        if x >= size_x || y >= size_y || z >= size_z {
            return None;
        }
        let row = z as usize * size_y as usize + y as usize;
        self.samples.get(row * size_x as usize + x as usize)
    }
}

/// Bytes of a volume of this size, or why it cannot be.
pub(super) fn checked_bytes(size: [u32; 3], bytes_per_voxel: u64) -> Result<u64, LayoutError> {
    if size.contains(&0) {
        return Err(LayoutError::EmptySide { size });
    }
    size.iter()
        .try_fold(bytes_per_voxel, |bytes, &side| bytes.checked_mul(side.into()))
        .filter(|&bytes| bytes <= MAX_VOLUME_BYTES)
        .filter(|&bytes| usize::try_from(bytes).is_ok())
        .ok_or(LayoutError::TooLarge { size, bytes_per_voxel, limit: MAX_VOLUME_BYTES })
}

/// Refuses a spacing that is not finite and positive.
pub(super) fn check_spacing(spacing: Vec3) -> Result<(), LayoutError> {
    if spacing.is_finite() && spacing.min_element() > 0.0 {
        Ok(())
    } else {
        Err(LayoutError::Spacing { spacing })
    }
}

#[cfg(test)]
mod tests;
