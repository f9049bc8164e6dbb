//! Whether samples look like labels, where no file says so.
//!
//! A scan must never be taken for a label map, since that would take its greys away; a label map that is not noticed is drawn as everything was
//! drawn before. So all of this must hold: samples are stored as integers, no more than [`MOST_VALUES`] of them differ, they lie close together or are
//! many, as numbers that somebody counted do, and they form pieces: most neighbours are equal, and where they are not they differ by more than one step,
//! as the steps of a smooth field do not.

use super::Samples;
use std::ops::Range;

/// The most values of a label map that is noticed.
const MOST_VALUES: usize = 256;

/// Values other than 0 are to be at least this share of the greatest, or this many.
const LEAST_DENSITY: f64 = 1.0 / 8.0;
const MANY_VALUES: usize = 24;

/// The least share of equal neighbours, of those of which not both are 0.
const LEAST_EQUAL: f64 = 0.75;

/// The same, of neighbours that are not both 0 or the most frequent other value: where most of a scan is clipped the rest tells.
const LEAST_EQUAL_OF_RARE: f64 = 0.5;

/// The least share of jumps of more than 1, of neighbours that differ, where more than two values are not 0.
const LEAST_JUMPS: f64 = 0.05;

/// About how many pairs of neighbours are looked at.
const PAIRS: usize = 1 << 20;

/// Whether these samples look like labels.
pub(super) fn looks_like_labels(samples: &Samples, size: [u32; 3]) -> bool {
    match samples {
        Samples::U8(samples) => looks_so(samples, size),
        Samples::I8(samples) => looks_so(samples, size),
        Samples::U16(samples) => looks_so(samples, size),
        Samples::I16(samples) => looks_so(samples, size),
        Samples::F32(_) | Samples::Rgba8(_) => false,
    }
}

fn looks_so<T: Copy + Into<i32>>(samples: &[T], [x, y, z]: [u32; 3]) -> bool {
    let Some(counts) = counts(samples).filter(|counts| counts.len() > 1) else { return false };
    let named: Vec<(i32, u64)> = counts.into_iter().filter(|(value, _)| *value != 0).collect();
    let Some(greatest) = named.iter().map(|(value, _)| *value).max() else { return false };
    // An "unknown" of -1 is usual.
    if named.iter().any(|(value, _)| *value < -1) {
        return false;
    }
    let is_dense = named.len() as f64 >= LEAST_DENSITY * f64::from(greatest);
    if !is_dense && named.len() < MANY_VALUES {
        return false;
    }
    let frequent = named.iter().max_by_key(|(_, count)| *count).map_or(0, |(value, _)| *value);
    let [x, y, z] = [x, y, z].map(|side| side as usize);
    let found = neighbours(samples, [x, y * z], frequent);
    found.look_like_labels(named.len())
}

/// How often each value occurs; `None` if there are too many values.
fn counts<T: Copy + Into<i32>>(samples: &[T]) -> Option<Vec<(i32, u64)>> {
    const LEAST: i32 = i16::MIN as i32;
    const ALL: Range<i32> = LEAST..u16::MAX as i32 + 1;
    let mut counts = vec![0u64; ALL.len()];
    let mut values = 0;
    for sample in samples {
        let count = &mut counts[((*sample).into() - LEAST) as usize];
        values += usize::from(*count == 0);
        *count += 1;
        if values > MOST_VALUES {
            return None;
        }
    }
    Some(ALL.zip(counts).filter(|(_, count)| *count > 0).collect())
}

/// What pairs of neighbours are like.
#[derive(Default)]
struct Neighbours {
    /// Those of which not both are 0, and how many of them are equal.
    named: [u64; 2],
    /// Those that are not both one of 0 and the most frequent other value, and how many of them are equal.
    rare: [u64; 2],
    /// Those that differ by more than 1.
    jumps: u64,
}

impl Neighbours {
    fn add(&mut self, a: i32, b: i32, frequent: i32) {
        if a == 0 && b == 0 {
            return;
        }
        let is_equal = u64::from(a == b);
        self.named = [self.named[0] + 1, self.named[1] + is_equal];
        self.jumps += u64::from((a - b).abs() > 1);
        let is_common = |value| value == 0 || value == frequent;
        if !(is_common(a) && is_common(b)) {
            self.rare = [self.rare[0] + 1, self.rare[1] + is_equal];
        }
    }

    fn look_like_labels(&self, named_values: usize) -> bool {
        let share = |of: u64, all: u64| if all == 0 { 1.0 } else { of as f64 / all as f64 };
        let differ = self.named[0] - self.named[1];
        self.named[0] > 0
            && share(self.named[1], self.named[0]) >= LEAST_EQUAL
            && share(self.rare[1], self.rare[0]) >= LEAST_EQUAL_OF_RARE
            && (named_values <= 2 || share(self.jumps, differ) >= LEAST_JUMPS)
    }
}

/// Looks at rows, evenly spread, and the rows beside them.
fn neighbours<T: Copy + Into<i32>>(samples: &[T], [length, rows]: [usize; 2], frequent: i32) -> Neighbours {
    let mut found = Neighbours::default();
    let wanted = (PAIRS / (2 * length)).clamp(1, rows);
    let row_of = |index: usize| index * length..(index + 1) * length;
    for index in (0..rows).step_by(rows.div_ceil(wanted)) {
        let row = &samples[row_of(index)];
        for pair in row.windows(2) {
            found.add(pair[0].into(), pair[1].into(), frequent);
        }
        if index + 1 < rows {
            for (one, other) in row.iter().zip(&samples[row_of(index + 1)]) {
                found.add((*one).into(), (*other).into(), frequent);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: u32 = 32;

    fn volume<T>(value: impl Fn([f32; 3]) -> T) -> Vec<T> {
        let places = (0..SIDE.pow(3)).map(|i| [i % SIDE, i / SIDE % SIDE, i / SIDE.pow(2)]);
        places.map(|place| value(place.map(|at| at as f32 - 15.5))).collect()
    }

    fn radius([x, y, z]: [f32; 3]) -> f32 {
        (x * x + y * y + z * z).sqrt()
    }

    fn noise(place: [f32; 3]) -> f32 {
        let [x, y, z] = place.map(|at| (at + 16.0) as u32);
        let hash = (x * 7919 + y * 104_729 + z * 1_299_709).wrapping_mul(2_654_435_761);
        (hash >> 16) as f32 / 65_536.0
    }

    fn looks(samples: Samples) -> bool {
        looks_like_labels(&samples, [SIDE; 3])
    }

    #[test]
    fn segmentations_look_like_labels() {
        // One label far from 0, and some beside each other.
        assert!(looks(Samples::U8(volume(|at| if radius(at) < 12.0 { 4 } else { 0 }))));
        assert!(looks(Samples::I16(volume(|at| if radius(at) < 12.0 { 1 } else { 0 }))));
        let organs = |at: [f32; 3]| match radius(at) {
            r if r > 14.0 => 0u16,
            r if r > 11.0 => 1,
            _ if at[0] > 2.0 => 4,
            _ if at[1] > 1.0 => 2,
            _ => 7,
        };
        assert!(looks(Samples::U16(volume(organs))));
        assert!(looks(Samples::I8(volume(|at| organs(at) as i8 - i8::from(radius(at) > 15.5)))));
        // Many labels of large numbers, as an atlas has.
        let atlas = |[x, y, z]: [f32; 3]| {
            let block = |at: f32| ((at + 16.0) / 8.0) as u16;
            1000 + 37 * block(x) + 211 * block(y) + 1913 * block(z)
        };
        assert!(looks(Samples::U16(volume(atlas))));
    }

    #[test]
    fn scans_do_not() {
        let head = |at: [f32; 3]| match radius(at) {
            r if r > 13.0 => 0.0,
            r if r > 11.0 => 220.0,
            _ => 90.0 + 20.0 * (at[0] * 0.4).sin(),
        };
        assert!(!looks(Samples::U8(volume(|at| head(at) as u8))), "without noise");
        assert!(!looks(Samples::U8(volume(|at| (head(at) + 6.0 * noise(at)) as u8))), "with noise");
        // A window that clips most of it.
        let clipped = |at| (2.0 * (head(at) + 6.0 * noise(at)) - 190.0).clamp(0.0, 255.0) as u8;
        assert!(!looks(Samples::U8(volume(clipped))), "clipped");
        let ct = |at| (10.0 * head(at) - 1000.0 + 15.0 * noise(at)) as i16;
        assert!(!looks(Samples::I16(volume(ct))), "CT");
        // Few counts, and few steps of a smooth field.
        let counts = |at: [f32; 3]| (3.0 * noise(at) * (12.0 - radius(at)).clamp(0.0, 1.0)) as u8;
        assert!(!looks(Samples::U8(volume(counts))), "counts");
        assert!(!looks(Samples::U8(volume(|at| (radius(at) / 4.0) as u8))), "distances");
        // Even greys far apart are materials of a phantom, or a mask for a picture.
        let phantom = |at| if radius(at) < 6.0 { 200 } else { u8::from(radius(at) < 12.0) * 70 };
        assert!(!looks(Samples::U8(volume(phantom))), "phantom");
        assert!(!looks(Samples::U8(volume(|at| if radius(at) < 12.0 { 255 } else { 0 }))), "mask");
        assert!(!looks(Samples::U8(volume(|_| 0))) && !looks(Samples::U8(volume(|_| 7))), "constant");
        assert!(!looks(Samples::F32(volume(|at| if radius(at) < 12.0 { 4.0 } else { 0.0 }))), "floats");
    }
}
