//! Samples of several channels as colours.

use std::path::Path;

use super::{
    SourceError,
    stored::{Stored, StoredFormat},
    volume::Samples,
};

/// How samples make colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Channels {
    /// 3 for red, green and blue, 4 with opacity.
    pub count: u64,
    /// Samples from one channel of a voxel to the next.
    pub stride: u64,
}

/// Whether samples of this type can be channels of a colour.
pub(super) fn can_be(format: StoredFormat) -> bool {
    matches!(format, StoredFormat::U8 | StoredFormat::U16 | StoredFormat::F32 | StoredFormat::F64)
}

/// The colours that these samples make: 8 bits as they are, 16 bits rounded to 8, floats from 0 to 1.
pub(super) fn samples(
    path: &Path,
    stored: &Stored,
    channels: Channels,
    notes: &mut Vec<String>,
) -> Result<Samples, SourceError> {
    let colours = match stored {
        Stored::U8(samples) => gather(path, samples, channels, |sample| sample)?,
        Stored::U16(samples) => {
            notes.push("its colours of 16 bits a channel are rounded to 8".to_owned());
            gather(path, samples, channels, |sample| ((u32::from(sample) * 255 + 32767) / 65535) as u8)?
        }
        Stored::F32(samples) => floats(path, samples, channels, notes)?,
        Stored::F64(samples) => floats(path, samples, channels, notes)?,
        _ => {
            return Err(SourceError::Unsupported {
                path: path.to_owned(),
                found: "colours whose channels are neither bytes, 16-bit words nor floats".to_owned(),
                mend: "choose one channel: `component: 0`".to_owned(),
            });
        }
    };
    Ok(Samples::Rgba8(colours))
}

fn floats<T: Copy + Into<f64>>(
    path: &Path,
    samples: &[T],
    channels: Channels,
    notes: &mut Vec<String>,
) -> Result<Vec<[u8; 4]>, SourceError> {
    let beyond = samples.iter().filter(|sample| !(0.0..=1.0).contains(&(**sample).into())).count();
    let clipped = if beyond > 0 { format!("; {beyond} are beyond it, and clipped") } else { String::new() };
    notes.push(format!("its colours are floats, taken from 0 to 1 and rounded to 8 bits{clipped}"));
    gather(path, samples, channels, |sample| (sample.into().clamp(0.0, 1.0) * 255.0).round() as u8)
}

fn gather<T: Copy>(
    path: &Path,
    samples: &[T],
    Channels { count, stride }: Channels,
    byte: impl Fn(T) -> u8,
) -> Result<Vec<[u8; 4]>, SourceError> {
    let (count, stride) = (count.clamp(3, 4) as usize, usize::try_from(stride).unwrap_or(usize::MAX).max(1));
    let voxels = samples.len() / count;
    let mut colours = Vec::new();
    let bytes = voxels as u64 * 4;
    let no_memory = |_| SourceError::OutOfMemory { path: path.to_owned(), bytes };
    colours.try_reserve_exact(voxels).map_err(no_memory)?;
    for plane in samples.chunks_exact(stride.saturating_mul(count)) {
        for voxel in 0..stride {
            let channel = |channel: usize| byte(plane[voxel + channel * stride]);
            let opacity = if count == 4 { channel(3) } else { 255 };
            colours.push([channel(0), channel(1), channel(2), opacity]);
        }
    }
    Ok(colours)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn colours(stored: Stored, count: u64, stride: u64) -> (Vec<[u8; 4]>, Vec<String>) {
        let mut notes = Vec::new();
        let samples = samples(Path::new("a"), &stored, Channels { count, stride }, &mut notes).unwrap();
        let Samples::Rgba8(colours) = samples else { panic!("{samples:?}") };
        (colours, notes)
    }

    #[test]
    fn channels_may_alternate_or_follow_each_other() {
        let expected = vec![[1, 2, 3, 255], [4, 5, 6, 255]];
        assert_eq!(colours(Stored::U8(vec![1, 2, 3, 4, 5, 6]), 3, 1), (expected.clone(), vec![]));
        assert_eq!(colours(Stored::U8(vec![1, 4, 2, 5, 3, 6]), 3, 2).0, expected);
        assert_eq!(colours(Stored::U8(vec![1, 2, 3, 9]), 4, 1).0, [[1, 2, 3, 9]]);
    }

    #[test]
    fn wider_channels_are_rounded_and_that_is_told() {
        let (words, notes) = colours(Stored::U16(vec![0, 65535, 32768]), 3, 1);
        assert_eq!((words, notes.len()), (vec![[0, 255, 128, 255]], 1));
        let (floats, notes) = colours(Stored::F64(vec![0.0, 0.5, 7.0]), 3, 1);
        assert_eq!(floats, [[0, 128, 255, 255]]);
        assert!(notes[0].contains("1 are beyond it"), "{notes:?}");
        let nan = colours(Stored::F32(vec![f32::NAN, 1.0, -1.0]), 3, 1);
        assert_eq!(nan.0, [[0, 255, 0, 255]]);
        assert!(
            samples(
                Path::new("a"),
                &Stored::I8(vec![1; 3]),
                Channels { count: 3, stride: 1 },
                &mut Vec::new()
            )
            .is_err()
        );
    }
}
