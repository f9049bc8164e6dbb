#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::*;

/// The definition, voxel by voxel.
fn slow_range(volume: &VolumeData, brick: [u32; 3]) -> [f32; 2] {
    let mut range = [f32::INFINITY, f32::NEG_INFINITY];
    let reach = |axis: usize| {
        let start = brick[axis] * BrickRanges::BRICK;
        start.saturating_sub(1)..(start + BrickRanges::BRICK + 1).min(volume.size[axis])
    };
    for z in reach(2) {
        for y in reach(1) {
            for x in reach(0) {
                let sample = volume.sample([x, y, z]).unwrap();
                if sample.abs() <= MAX_SAMPLE_MAGNITUDE {
                    range = [range[0].min(sample), range[1].max(sample)];
                }
            }
        }
    }
    range
}

fn check_bricks(size: [u32; 3], samples: Samples) -> VolumeData {
    let volume = VolumeData::new(size, Vec3::ONE, samples).unwrap();
    let [x, y, z] = volume.bricks.size;
    assert_eq!(volume.bricks.size, size.map(|side| side.div_ceil(8)));
    assert_eq!(volume.bricks.ranges.len(), (x * y * z) as usize);
    for (index, range) in volume.bricks.ranges.iter().enumerate() {
        let index = index as u32;
        let brick = [index % x, index / x % y, index / (x * y)];
        assert_eq!(*range, slow_range(&volume, brick), "brick {brick:?} of {size:?}");
    }
    volume
}

/// Numerical Recipes' quick generator: its high bits pass for random.
fn noise(count: usize) -> impl Iterator<Item = u32> {
    let next = |&state: &u32| Some(state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    std::iter::successors(Some(7), next).map(|state| state >> 8).take(count)
}

#[test]
fn bricks_are_what_their_definition_says_for_every_format_and_size() {
    for size in [[1, 1, 1], [8, 8, 8], [9, 8, 7], [17, 1, 25], [16, 33, 9]] {
        let count = size.iter().product::<u32>() as usize;
        check_bricks(size, Samples::U8(noise(count).map(|n| n as u8).collect()));
        check_bricks(size, Samples::I8(noise(count).map(|n| n as i8).collect()));
        check_bricks(size, Samples::U16(noise(count).map(|n| n as u16).collect()));
        check_bricks(size, Samples::I16(noise(count).map(|n| n as i16).collect()));
        check_bricks(size, Samples::F32(noise(count).map(|n| n as f32 - 8e6).collect()));
    }
}

#[test]
fn what_is_not_finite_is_counted_once_and_left_out_of_ranges() {
    let size = [17, 9, 10];
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.1e30, -2e30];
    let samples: Vec<f32> =
        noise(17 * 9 * 10).map(|n| odd.get((n % 13) as usize).copied().unwrap_or(n as f32)).collect();
    let missing = samples.iter().filter(|sample| sample.is_nan() || sample.abs() > 1e30).count() as u64;
    assert!(missing > 100);
    let volume = check_bricks(size, Samples::F32(samples));
    assert_eq!(volume.non_finite, missing);
    assert!(volume.range.0 >= 0.0 && volume.range.1 < 1e8);
}

#[test]
fn a_volume_without_finite_samples_has_no_range() {
    let volume = VolumeData::new([9, 1, 1], Vec3::ONE, Samples::F32(vec![f32::NAN; 9])).unwrap();
    assert_eq!((volume.range, volume.non_finite), ((0.0, 0.0), 9));
    assert_eq!(volume.bricks.ranges, [[f32::INFINITY, f32::NEG_INFINITY]; 2]);
    let volume = VolumeData::new([1, 1, 1], Vec3::ONE, Samples::F32(vec![1e30])).unwrap();
    assert_eq!((volume.range, volume.non_finite), ((1e30, 1e30), 0));
}

#[test]
fn impossible_volumes_are_refused() {
    let new = |size, spacing| VolumeData::new(size, spacing, Samples::U8(vec![0; 8]));
    assert!(new([2, 2, 2], Vec3::ONE).is_ok());
    let message = |size, spacing| new(size, spacing).unwrap_err().to_string();
    assert_eq!(message([2, 2, 3], Vec3::ONE), "8 samples; 2 x 2 x 3 voxels need 12");
    assert!(message([2, 0, 2], Vec3::ONE).starts_with("size 2 x 0 x 2: every side needs"));
    assert!(message([u32::MAX; 3], Vec3::ONE).contains("exceed the limit of 8589934592 bytes"));
    for spacing in [Vec3::ZERO, Vec3::new(1.0, -1.0, 1.0), Vec3::NAN, Vec3::INFINITY] {
        assert!(message([2, 2, 2], spacing).contains("must be finite and greater than 0"), "{spacing}");
    }
}

#[test]
fn samples_are_reached_by_position() {
    let volume = VolumeData::new([2, 3, 2], Vec3::ONE, Samples::I16((-6..6).collect())).unwrap();
    assert_eq!(volume.sample([1, 2, 1]), Some(5.0));
    assert_eq!(volume.sample([1, 0, 0]), Some(-5.0));
    assert_eq!(volume.sample([0, 3, 0]), None);
    assert_eq!(volume.samples.format().integer_range(), Some((-32768.0, 32767.0)));
    assert_eq!((volume.samples.len(), volume.samples.as_bytes().len()), (12, 24));
}
