//! The range of the values in each slice of a volume: where it begins and ends that something can be seen, to a voxel.

use super::{MAX_SAMPLE_MAGNITUDE, Samples, luminance};

/// The least and greatest finite sample in every slice across x, y and z, `[INFINITY, NEG_INFINITY]` where there is none.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SliceRanges {
    /// Those of the slices across each axis, in order.
    pub along: [Vec<[f32; 2]>; 3],
}

/// The slice ranges of a volume whose samples fill `size`.
pub(super) fn slices_of(samples: &Samples, size: [u32; 3]) -> SliceRanges {
    match samples {
        Samples::U8(samples) => scan(samples, size, |&sample| sample.into()),
        Samples::I8(samples) => scan(samples, size, |&sample| sample.into()),
        Samples::U16(samples) => scan(samples, size, |&sample| sample.into()),
        Samples::I16(samples) => scan(samples, size, |&sample| sample.into()),
        Samples::F32(samples) => scan(samples, size, |&sample| sample),
        Samples::Rgba8(samples) => scan(samples, size, |&colour| luminance(colour)),
    }
}

fn scan<T>(samples: &[T], size: [u32; 3], value: impl Fn(&T) -> f32) -> SliceRanges {
    let [x, y, z] = size.map(|side| side as usize);
    let none = [f32::INFINITY, f32::NEG_INFINITY];
    let mut along = [vec![none; x], vec![none; y], vec![none; z]];
    for (row, samples) in samples.chunks_exact(x.max(1)).enumerate() {
        let mut of_row = none;
        for (sample, column) in samples.iter().zip(&mut along[0]) {
            let value = value(sample);
            let is_present = value.abs() <= MAX_SAMPLE_MAGNITUDE;
            let (low, high) = if is_present { (value, value) } else { (none[0], none[1]) };
            *column = [column[0].min(low), column[1].max(high)];
            of_row = [of_row[0].min(low), of_row[1].max(high)];
        }
        for (axis, slice) in [(1, row % y), (2, row / y)] {
            let [low, high] = along[axis][slice];
            along[axis][slice] = [low.min(of_row[0]), high.max(of_row[1])];
        }
    }
    SliceRanges { along }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_slice_has_the_range_of_its_samples() {
        let samples = Samples::F32(vec![0.0, 1.0, 2.0, f32::NAN, 4.0, 5.0, -6.0, 7.0, 8.0, 9.0, 1e31, 11.0]);
        let slices = slices_of(&samples, [2, 3, 2]);
        assert_eq!(slices.along[0], [[-6.0, 8.0], [1.0, 11.0]]);
        assert_eq!(slices.along[1], [[-6.0, 7.0], [2.0, 9.0], [4.0, 11.0]]);
        assert_eq!(slices.along[2], [[0.0, 5.0], [-6.0, 11.0]]);
        let nothing = slices_of(&Samples::F32(vec![f32::NAN]), [1, 1, 1]);
        assert_eq!(nothing.along[2], [[f32::INFINITY, f32::NEG_INFINITY]]);
    }
}
