//! How often each value occurs in a volume.

use super::{MAX_SAMPLE_MAGNITUDE, Samples, luminance};

/// How often the values of a volume occur, in [`Histogram::BINS`] bins of equal width; samples that are not finite are in none.
///
/// Bin i holds the samples from `range.0 + i * width` up to the next bin's first value, and the last bin `range.1` too, where
/// `width` is a 256th of the range. Of 8-bit samples every value has a bin of its own, centred on it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Histogram {
    /// Samples in each bin, from the least value to the greatest; always [`Histogram::BINS`] of them.
    pub bins: Vec<u64>,
    /// Where the first bin begins and the last one ends, in values of the data: the volume's `core_range`, or of 8-bit formats all that
    /// they can hold and half a value around it. What lies beyond is in the first and the last bin. Both are equal where all samples are.
    pub range: (f32, f32),
    /// Samples that are in no bin, as they are not finite: in masked data, what the mask leaves out.
    pub missing: u64,
    /// Whether a bin is one value.
    one_value_a_bin: bool,
}

impl Histogram {
    /// How many bins there are.
    pub const BINS: usize = 256;

    /// Counts samples; looks at each once.
    pub(super) fn of(samples: &Samples, range: (f32, f32)) -> Self {
        let of_bytes = |bins, least: f32| Self::from_counts(bins, (least - 0.5, least + 255.5), true);
        match samples {
            Samples::U8(samples) => of_bytes(count(samples, usize::from), 0.0),
            Samples::I8(samples) => {
                of_bytes(count(samples, |sample| (i16::from(sample) + 128) as usize), -128.0)
            }
            Samples::U16(samples) => Self::of_numbers(samples, range),
            Samples::I16(samples) => Self::of_numbers(samples, range),
            Samples::F32(samples) => Self::of_numbers(samples, range),
            Samples::Rgba8(samples) => {
                let bin = |colour| match luminance(colour) {
                    value if value.is_nan() => Self::BINS,
                    value => value.round() as usize,
                };
                of_bytes(count(samples, bin), 0.0)
            }
        }
    }

    fn of_numbers<T: Copy + Into<f32>>(samples: &[T], range: (f32, f32)) -> Self {
        // In f64, where the width of a range from -1e30 to 1e30 and the least difference of two floats are both exact enough.
        let (low, width) =
            (f64::from(range.0), (f64::from(range.1) - f64::from(range.0)) / Self::BINS as f64);
        let per_value = if width > 0.0 { 1.0 / width } else { 0.0 };
        let bin = |sample: T| {
            let value: f32 = sample.into();
            if value.abs() <= MAX_SAMPLE_MAGNITUDE {
                (((f64::from(value) - low) * per_value) as usize).min(Self::BINS - 1)
            } else {
                Self::BINS
            }
        };
        Self::from_counts(count(samples, bin), range, false)
    }

    /// From how many samples are in each bin, and how many in none.
    fn from_counts(mut bins: Vec<u64>, range: (f32, f32), one_value_a_bin: bool) -> Self {
        let missing = bins.split_off(Self::BINS).iter().sum();
        Self { bins, range, missing, one_value_a_bin }
    }

    /// Whether most of the samples are missing: then the others are what the data are of, whatever their values.
    pub fn is_masked(&self) -> bool {
        self.missing > self.bins.iter().sum()
    }

    /// The value at the centre of a bin.
    pub fn centre(&self, bin: usize) -> f32 {
        self.value(bin as f64 + 0.5)
    }

    /// The value that `fraction` (0 to 1) of the finite samples lie below, to within a bin; `None` if there is no finite sample.
    pub fn percentile(&self, fraction: f64) -> Option<f32> {
        let total: u64 = self.bins.iter().sum();
        let wanted = fraction.clamp(0.0, 1.0) * total as f64;
        let mut below = 0;
        for (bin, &samples) in self.bins.iter().enumerate() {
            if samples > 0 && (below + samples) as f64 >= wanted {
                let part = ((wanted - below as f64) / samples as f64).clamp(0.0, 1.0);
                let part = if self.one_value_a_bin { 0.5 } else { part };
                return Some(self.value(bin as f64 + part));
            }
            below += samples;
        }
        None
    }

    /// The value so many bins from the beginning.
    fn value(&self, bins: f64) -> f32 {
        let (low, high) = (f64::from(self.range.0), f64::from(self.range.1));
        (low + (high - low) * bins / Self::BINS as f64) as f32
    }
}

/// Counts by bin, with one more past the last.
fn count<T: Copy>(samples: &[T], bin: impl Fn(T) -> usize) -> Vec<u64> {
    // Two tables in turn: samples next to each other are often equal, and one counter would wait for itself.
    let mut tables = [[0_u64; Histogram::BINS + 1]; 2];
    let mut pairs = samples.chunks_exact(2);
    for pair in &mut pairs {
        tables[0][bin(pair[0])] += 1;
        tables[1][bin(pair[1])] += 1;
    }
    for sample in pairs.remainder() {
        tables[0][bin(*sample)] += 1;
    }
    (0..=Histogram::BINS).map(|bin| tables[0][bin] + tables[1][bin]).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn each_value_of_8_bits_has_its_bin() {
        let bytes = Histogram::of(&Samples::U8(vec![0, 7, 7, 255, 7]), (0.0, 255.0));
        assert_eq!((bytes.bins[0], bytes.bins[7], bytes.bins[255]), (1, 3, 1));
        assert_eq!((bytes.centre(0), bytes.centre(7), bytes.centre(255)), (0.0, 7.0, 255.0));
        assert_eq!(bytes.percentile(0.5), Some(7.0));
        let signed = Histogram::of(&Samples::I8(vec![-128, -1, 127]), (-128.0, 127.0));
        assert_eq!((signed.bins[0], signed.bins[127], signed.bins[255]), (1, 1, 1));
        assert_eq!(signed.centre(127), -1.0);
    }

    #[test]
    fn others_are_counted_over_their_range_without_what_is_not_finite() {
        let samples: Vec<f32> =
            (0..=1000).map(|i| i as f32 * 0.5).chain([f32::NAN, f32::INFINITY, 1e38]).collect();
        let histogram = Histogram::of(&Samples::F32(samples), (0.0, 500.0));
        assert_eq!((histogram.bins.iter().sum::<u64>(), histogram.missing), (1001, 3));
        assert!(!histogram.is_masked());
        assert!(histogram.bins.iter().all(|&bin| (3..=5).contains(&bin)));
        assert_eq!(histogram.percentile(0.0), Some(0.0));
        assert_eq!(histogram.percentile(1.0), Some(500.0));
        assert!((histogram.percentile(0.5).unwrap() - 250.0).abs() < 2.0);
    }

    #[test]
    fn constant_missing_and_extreme_values_have_a_histogram() {
        let constant = Histogram::of(&Samples::U16(vec![9; 5]), (9.0, 9.0));
        assert_eq!((constant.bins[0], constant.percentile(0.3)), (5, Some(9.0)));
        let missing = Histogram::of(&Samples::F32(vec![f32::NAN; 3]), (0.0, 0.0));
        assert_eq!((missing.bins.iter().sum::<u64>(), missing.percentile(0.5)), (0, None));
        let wide = Histogram::of(&Samples::F32(vec![-1e30, 0.0, 1e30]), (-1e30, 1e30));
        assert_eq!((wide.bins[0], wide.bins[128], wide.bins[255]), (1, 1, 1));
        let least = f32::from_bits(1);
        let narrow = Histogram::of(&Samples::F32(vec![0.0, least]), (0.0, least));
        assert_eq!((narrow.bins[0], narrow.bins[255]), (1, 1));
    }
}
