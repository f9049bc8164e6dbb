//! Samples of any type a file can hold, on their way to the few types that are drawn.
//!
//! The rule: 8- and 16-bit integers and 32-bit floats stay as they are. Wider integers, and integers that a file scales,
//! become the first of U8, I8, U16 and I16 that holds every value exactly, otherwise F32. Scaled and 64-bit floats become F32.

use std::{path::Path, str::FromStr};

use bytemuck::Pod;

use super::{
    SourceError,
    volume::{SampleFormat, Samples},
};

/// What the scaling of a file does to its samples: `slope * sample + intercept`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scaling {
    /// Slope and intercept of each run of samples; the last goes on to the end.
    pub runs: Vec<[f64; 2]>,
    /// Samples in a run.
    pub run: usize,
}

impl Scaling {
    /// Samples as they are.
    pub const NONE: Self = Self { runs: Vec::new(), run: 1 };

    /// The same for all samples.
    pub fn of(slope: f64, intercept: f64) -> Self {
        Self { runs: vec![[slope, intercept]], run: usize::MAX }
    }

    fn changes_nothing(&self) -> bool {
        self.runs.iter().all(|&run| run == [1.0, 0.0])
    }

    fn apply(&self, index: usize, value: f64) -> f64 {
        match self.runs.get(index / self.run).or(self.runs.last()) {
            Some([slope, intercept]) => slope * value + intercept,
            None => value,
        }
    }
}

/// A sample type of a file.
pub(super) trait Element: Pod + FromStr {
    /// Whether it has no fractions.
    const WHOLE: bool;
    /// The sample with its bytes the other way round.
    fn swapped(self) -> Self;
    /// Its value, to 53 bits.
    fn value(self) -> f64;
    /// The sample nearest to a value; `None` if it has fractions, or is beyond the type, and the type has none.
    fn of_value(value: f64) -> Option<Self>;
    /// Whether a 32-bit float holds it; an infinity holds what is beyond all floats.
    fn fits_f32(self) -> bool;
}

macro_rules! stored {
    ($($variant:ident $element:ty, $whole:literal, $swapped:expr, $fits:expr;)*) => {
        /// How a file stores one sample.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(super) enum StoredFormat { $($variant),* }

        impl StoredFormat {
            /// Bytes of one sample.
            pub const fn bytes(self) -> u64 {
                match self { $(Self::$variant => size_of::<$element>() as u64),* }
            }

            /// No samples of this type.
            pub const fn none(self) -> Stored {
                match self { $(Self::$variant => Stored::$variant(Vec::new())),* }
            }
        }

        /// Samples as a file stores them, in the machine's byte order.
        #[derive(Debug, Clone, PartialEq)]
        pub(super) enum Stored { $(#[doc = "One variant for each type."] $variant(Vec<$element>)),* }

        $(impl Element for $element {
            const WHOLE: bool = $whole;
            fn swapped(self) -> Self { $swapped(self) }
            fn value(self) -> f64 { self as f64 }
            fn of_value(value: f64) -> Option<Self> {
                let near = value as $element;
                (!$whole || near as f64 == value).then_some(near)
            }
            fn fits_f32(self) -> bool { $fits(self) }
        })*

        /// Runs an expression on the vector of samples, whatever its type.
        macro_rules! with_samples {
            ($stored:expr, $samples:ident => $body:expr) => {
                match $stored { $($crate::sources::stored::Stored::$variant($samples) => $body),* }
            };
        }
        pub(super) use with_samples;
    };
}

stored! {
    U8 u8, true, u8::swap_bytes, |_| true;
    I8 i8, true, i8::swap_bytes, |_| true;
    U16 u16, true, u16::swap_bytes, |_| true;
    I16 i16, true, i16::swap_bytes, |_| true;
    U32 u32, true, u32::swap_bytes, |value| i128::from(value) == (value as f32) as i128;
    I32 i32, true, i32::swap_bytes, |value| i128::from(value) == (value as f32) as i128;
    U64 u64, true, u64::swap_bytes, |value| i128::from(value) == (value as f32) as i128;
    I64 i64, true, i64::swap_bytes, |value| i128::from(value) == (value as f32) as i128;
    F32 f32, false, |value: f32| f32::from_bits(value.to_bits().swap_bytes()), |_| true;
    F64 f64, false, |value: f64| f64::from_bits(value.to_bits().swap_bytes()), |value: f64| {
        let near = value as f32;
        !near.is_finite() || f64::from(near) == value
    };
}

impl StoredFormat {
    /// How the numbers of a sample are stored, and how many there are.
    pub fn of(format: SampleFormat) -> (Self, u64) {
        let single = match format {
            SampleFormat::U8 => Self::U8,
            SampleFormat::I8 => Self::I8,
            SampleFormat::U16 => Self::U16,
            SampleFormat::I16 => Self::I16,
            SampleFormat::F32 => Self::F32,
            SampleFormat::Rgba8 => return (Self::U8, 4),
        };
        (single, 1)
    }
}

impl Stored {
    /// How each is stored.
    pub fn format(&self) -> StoredFormat {
        macro_rules! format_of {
            ($($variant:ident)*) => {
                match self { $(Self::$variant(_) => StoredFormat::$variant),* }
            };
        }
        format_of!(U8 I8 U16 I16 U32 I32 U64 I64 F32 F64)
    }

    /// The samples as they lie in memory.
    pub fn as_bytes(&self) -> &[u8] {
        with_samples!(self, samples => bytemuck::cast_slice(samples))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        with_samples!(self, samples => samples.len())
    }

    /// Adds samples from their bytes, in the machine's order; `None` if there is no memory for them.
    pub fn append_bytes(&mut self, bytes: &[u8]) -> Option<()> {
        with_samples!(self, samples => append_bytes(samples, bytes))
    }

    /// What 16-bit floats that were read as words stand for; other samples as they are.
    pub fn with_halves_read(self, path: &Path) -> Result<Self, SourceError> {
        match self {
            Self::U16(words) => {
                Ok(Self::F32(collect(path, words.iter().map(|word| half::f16::from_bits(*word).to_f32()))?))
            }
            other => Ok(other),
        }
    }

    /// The value of one, to 53 bits; NaN where there is none.
    pub fn value(&self, index: usize) -> f64 {
        with_samples!(self, samples => samples.get(index).map_or(f64::NAN, |sample| sample.value()))
    }

    /// Scales the samples and brings them to a type that is drawn; see the module. What is lost is added to `notes`.
    pub fn into_samples(
        self,
        path: &Path,
        scaling: &Scaling,
        notes: &mut Vec<String>,
    ) -> Result<Samples, SourceError> {
        let scaled = !scaling.changes_nothing();
        match self {
            Self::U8(samples) if !scaled => Ok(Samples::U8(samples)),
            Self::I8(samples) if !scaled => Ok(Samples::I8(samples)),
            Self::U16(samples) if !scaled => Ok(Samples::U16(samples)),
            Self::I16(samples) if !scaled => Ok(Samples::I16(samples)),
            Self::F32(samples) if !scaled => Ok(Samples::F32(samples)),
            wide => {
                let none = Scaling::NONE;
                let scaling = if scaled { scaling } else { &none };
                with_samples!(wide, samples => convert(path, &samples, scaling, notes))
            }
        }
    }
}

fn append_bytes<T: Pod>(samples: &mut Vec<T>, bytes: &[u8]) -> Option<()> {
    let (start, more) = (samples.len(), bytes.len() / size_of::<T>());
    samples.try_reserve(more).ok()?;
    samples.resize(start + more, T::zeroed());
    bytemuck::cast_slice_mut(&mut samples[start..]).copy_from_slice(&bytes[..more * size_of::<T>()]);
    Some(())
}

fn convert<T: Element>(
    path: &Path,
    samples: &[T],
    scaling: &Scaling,
    notes: &mut Vec<String>,
) -> Result<Samples, SourceError> {
    let values = || samples.iter().enumerate().map(|(index, sample)| scaling.apply(index, sample.value()));
    let whole = T::WHOLE && values().all(|value| value.fract() == 0.0);
    if whole {
        let (least, greatest) = values()
            .fold((f64::MAX, f64::MIN), |(least, greatest), value| (least.min(value), greatest.max(value)));
        let within = |low: f64, high: f64| least >= low && greatest <= high;
        if within(0.0, 255.0) {
            return Ok(Samples::U8(collect(path, values().map(|value| value as u8))?));
        } else if within(-128.0, 127.0) {
            return Ok(Samples::I8(collect(path, values().map(|value| value as i8))?));
        } else if within(0.0, 65535.0) {
            return Ok(Samples::U16(collect(path, values().map(|value| value as u16))?));
        } else if within(-32768.0, 32767.0) {
            return Ok(Samples::I16(collect(path, values().map(|value| value as i16))?));
        }
    }
    // Scaled samples are measurements whose last digits nobody wrote.
    let rounded =
        if scaling.runs.is_empty() { samples.iter().filter(|sample| !sample.fits_f32()).count() } else { 0 };
    if rounded > 0 {
        let of = if T::WHOLE { "integers" } else { "64-bit floats" };
        notes.push(format!("{rounded} of {} {of} are rounded to 32-bit floats", samples.len()));
    }
    Ok(Samples::F32(collect(path, values().map(|value| value as f32))?))
}

/// Collects into memory that is asked for, not taken for granted.
fn collect<T>(path: &Path, values: impl ExactSizeIterator<Item = T>) -> Result<Vec<T>, SourceError> {
    let mut collected = Vec::new();
    let bytes = (values.len() * size_of::<T>()) as u64;
    collected
        .try_reserve_exact(values.len())
        .map_err(|_| SourceError::OutOfMemory { path: path.to_owned(), bytes })?;
    collected.extend(values);
    Ok(collected)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn samples(stored: Stored, scaling: &Scaling) -> (Samples, Vec<String>) {
        let mut notes = Vec::new();
        (stored.into_samples(Path::new("a"), scaling, &mut notes).unwrap(), notes)
    }

    #[test]
    fn wide_integers_become_the_narrowest_type_that_holds_them() {
        let narrow = |values: Vec<i64>| samples(Stored::I64(values), &Scaling::NONE);
        assert_eq!(narrow(vec![0, 255]).0, Samples::U8(vec![0, 255]));
        assert_eq!(narrow(vec![-128, 127]).0, Samples::I8(vec![-128, 127]));
        assert_eq!(narrow(vec![0, 256]).0, Samples::U16(vec![0, 256]));
        assert_eq!(narrow(vec![-1, 255]).0, Samples::I16(vec![-1, 255]));
        assert_eq!(narrow(vec![-1, 65535]), (Samples::F32(vec![-1.0, 65535.0]), vec![]));
        let (rounded, notes) = narrow(vec![16_777_217, 1 << 40, i64::MAX]);
        assert_eq!(rounded, Samples::F32(vec![16_777_216.0, 1_099_511_627_776.0, 9.223_372e18]));
        assert_eq!(notes, ["2 of 3 integers are rounded to 32-bit floats"]);
    }

    #[test]
    fn floats_stay_floats_and_beyond_32_bits_are_infinite() {
        let (floats, notes) = samples(Stored::F64(vec![1.0, 1e300, f64::NAN]), &Scaling::NONE);
        let Samples::F32(floats) = floats else { panic!() };
        assert_eq!((floats[0], floats[1], floats[2].is_nan(), notes.len()), (1.0, f32::INFINITY, true, 0));
        assert_eq!(samples(Stored::F64(vec![0.1]), &Scaling::NONE).1.len(), 1);
    }

    #[test]
    fn scaling_applies_run_by_run() {
        let hounsfield = samples(Stored::U16(vec![0, 4095]), &Scaling::of(1.0, -1024.0)).0;
        assert_eq!(hounsfield, Samples::I16(vec![-1024, 3071]));
        assert_eq!(samples(Stored::U8(vec![1, 2]), &Scaling::of(0.5, 0.0)).0, Samples::F32(vec![0.5, 1.0]));
        assert_eq!(samples(Stored::F32(vec![1.0]), &Scaling::of(2.0, 1.0)).0, Samples::F32(vec![3.0]));
        let runs = Scaling { runs: vec![[1.0, 0.0], [2.0, 0.0]], run: 2 };
        assert_eq!(samples(Stored::U8(vec![1, 1, 1, 1]), &runs).0, Samples::U8(vec![1, 1, 2, 2]));
        assert_eq!(samples(Stored::U8(vec![3]), &Scaling::of(1.0, 0.0)).0, Samples::U8(vec![3]));
    }
}
