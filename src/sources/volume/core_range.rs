//! The values of a volume without those that only stretch its range.

use super::{MAX_SAMPLE_MAGNITUDE, Samples};

/// The share of all samples that may be left out at either end.
const TAIL: f64 = 1.0 / 2000.0;

/// How much narrower the range must become for values to be left out.
const STRETCH: f32 = 2.0;

/// The fewest different values among which one that is far away stands out.
const FEWEST_VALUES: usize = 8;

/// Floating-point samples that are looked at.
const MOST_LOOKED_AT: usize = 1 << 18;

/// The range of the samples without fill values and a few extreme ones, where those would stretch it to more than twice its length;
/// `range`, that of all finite samples, where they do not.
///
/// A fill value is the least or greatest of at least nine values, if the gap between it and the others is longer than their range. What is
/// extreme is less than one sample in 2,000 at either end.
pub(super) fn core_range(samples: &Samples, range: (f32, f32)) -> (f32, f32) {
    let counted = match samples {
        Samples::U8(_) | Samples::I8(_) | Samples::Rgba8(_) => return range_of_bytes(samples, range),
        Samples::U16(samples) => count(samples.iter().map(|&sample| usize::from(sample)), 0.0),
        Samples::I16(samples) => {
            count(samples.iter().map(|&sample| (i32::from(sample) + 32768) as usize), -32768.0)
        }
        Samples::F32(samples) => sorted(samples),
    };
    core(&counted, range)
}

/// Colours and samples of 8 bits, whose 256 values are soon counted.
fn range_of_bytes(samples: &Samples, range: (f32, f32)) -> (f32, f32) {
    let counted = match samples {
        Samples::U8(samples) => count(samples.iter().map(|&sample| usize::from(sample)), 0.0),
        Samples::I8(samples) => {
            count(samples.iter().map(|&sample| (i16::from(sample) + 128) as usize), -128.0)
        }
        // Colours have a scale of their own.
        _ => return (0.0, 255.0),
    };
    core(&counted, range)
}

/// Each value that occurs, from the least to the greatest, and how often.
fn count(places: impl Iterator<Item = usize>, least: f32) -> Vec<(f32, u64)> {
    let mut counts = vec![0_u64; 1 << 16];
    places.for_each(|place| counts[place] += 1);
    let occurring = counts.into_iter().enumerate().filter(|(_, count)| *count > 0);
    occurring.map(|(place, count)| (place as f32 + least, count)).collect()
}

/// The same of every so many finite samples.
fn sorted(samples: &[f32]) -> Vec<(f32, u64)> {
    // An odd stride meets all columns of grids whose sides are powers of 2.
    let stride = samples.len().div_ceil(MOST_LOOKED_AT) | 1;
    let mut values: Vec<f32> = samples
        .iter()
        .step_by(stride)
        .copied()
        .filter(|sample| sample.abs() <= MAX_SAMPLE_MAGNITUDE)
        .collect();
    values.sort_unstable_by(f32::total_cmp);
    values.chunk_by(|a, b| a == b).map(|equal| (equal[0], equal.len() as u64)).collect()
}

fn core(counted: &[(f32, u64)], range: (f32, f32)) -> (f32, f32) {
    let core = without_tails(without_fill(counted));
    match (core.first(), core.last()) {
        (Some((low, _)), Some((high, _))) if low < high && STRETCH * (high - low) < range.1 - range.0 => {
            (*low, *high)
        }
        _ => range,
    }
}

/// The values without a least and a greatest one that stand far from all others.
fn without_fill(values: &[(f32, u64)]) -> &[(f32, u64)] {
    // A greatest one can hide a least one.
    without_least_fill(without_greatest_fill(without_least_fill(values)))
}

fn without_least_fill(values: &[(f32, u64)]) -> &[(f32, u64)] {
    match values {
        [(fill, _), rest @ ..]
            if rest.len() >= FEWEST_VALUES && rest[0].0 - fill > rest[rest.len() - 1].0 - rest[0].0 =>
        {
            rest
        }
        _ => values,
    }
}

fn without_greatest_fill(values: &[(f32, u64)]) -> &[(f32, u64)] {
    match values {
        [rest @ .., (fill, _)]
            if rest.len() >= FEWEST_VALUES
                && fill - rest[rest.len() - 1].0 > rest[rest.len() - 1].0 - rest[0].0 =>
        {
            rest
        }
        _ => values,
    }
}

/// The values without those that few samples at the ends have.
fn without_tails(values: &[(f32, u64)]) -> &[(f32, u64)] {
    let total: u64 = values.iter().map(|(_, count)| count).sum();
    let most = (total as f64 * TAIL) as u64;
    let kept = |counts: &mut dyn Iterator<Item = u64>| {
        let mut passed = 0;
        counts
            .take_while(|count| {
                passed += count;
                passed <= most
            })
            .count()
    };
    let before = kept(&mut values.iter().map(|(_, count)| *count));
    let behind = kept(&mut values.iter().rev().map(|(_, count)| *count));
    values.get(before..values.len().saturating_sub(behind)).unwrap_or(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn core_of(samples: Samples) -> (f32, f32) {
        let values =
            (0..samples.len()).filter_map(|index| samples.get(index)).filter(|value| value.is_finite());
        let range =
            values.fold((f32::MAX, f32::MIN), |range, value| (range.0.min(value), range.1.max(value)));
        core_range(&samples, range)
    }

    #[test]
    fn fill_values_and_single_samples_do_not_stretch_the_range() {
        let body = |index: i16| index % 400 - 100;
        let plain: Vec<i16> = (0..10_000).map(body).collect();
        assert_eq!(core_of(Samples::I16(plain.clone())), (-100.0, 299.0));
        let padded: Vec<i16> = plain.iter().copied().chain([-32768; 9000]).collect();
        assert_eq!(core_of(Samples::I16(padded)), (-100.0, 299.0));
        let hot: Vec<i16> = plain.iter().copied().chain([32767, 30_000]).collect();
        assert_eq!(core_of(Samples::I16(hot)), (-100.0, 299.0));
        let floats = || (0..10_000).map(|index| (index % 400) as f32);
        let filled: Vec<f32> = floats().chain([1e20; 5000]).chain([f32::NAN; 3]).collect();
        assert_eq!(core_of(Samples::F32(filled)), (0.0, 399.0));
        let both: Vec<f32> = floats().chain([-9999.0; 5000]).chain([9e9; 10]).collect();
        assert_eq!(core_of(Samples::F32(both)), (0.0, 399.0));
    }

    #[test]
    fn masks_and_ordinary_data_keep_their_range() {
        assert_eq!(core_of(Samples::U8(vec![0, 0, 0, 255])), (0.0, 255.0));
        assert_eq!(core_of(Samples::U16(vec![0, 1, 2, 3, 4000])), (0.0, 4000.0));
        assert_eq!(core_of(Samples::F32(vec![5.0; 9])), (5.0, 5.0));
        let sparse: Vec<u8> = [0; 100_000].into_iter().chain(10..=250).collect();
        assert_eq!(core_of(Samples::U8(sparse)), (0.0, 250.0));
    }
}
