//! Colours of pixels as red, green and blue of 8 bits.

use std::path::Path;

use super::{
    SourceError,
    image::{Image, Kind},
    syntax::{Codec, Syntax},
};
use crate::sources::stored::{Element, Stored, with_samples};

/// The colours of pixels of three numbers, brought to 8 bits.
pub(super) fn of(
    path: &Path,
    stored: &Stored,
    image: &Image,
    syntax: &Syntax,
) -> Result<Vec<[u8; 4]>, SourceError> {
    // What unpacks JPEG and JPEG 2000 gives red, green and blue.
    let kind = if matches!(syntax.codec, Codec::Jpeg | Codec::Jpeg2000) { Kind::Rgb } else { image.kind() };
    let greatest = ((1_u32 << image.stored_bits.min(16)) - 1) as f32;
    let byte = |value: f64| (value as f32 * 255.0 / greatest).round() as u8;
    let colour = |numbers: [f64; 3]| {
        let [red, green, blue] = numbers.map(byte);
        let [red, green, blue] = match kind {
            Kind::Ybr => rgb([red, green, blue], 0.0, 1.0, 1.0),
            Kind::YbrPartial => rgb([red, green, blue], 16.0, 255.0 / 219.0, 255.0 / 224.0),
            _ => [red, green, blue],
        };
        [red, green, blue, u8::MAX]
    };
    let mut colours = Vec::new();
    with_samples!(stored, samples => {
        let count = samples.len() / 3;
        colours
            .try_reserve_exact(count)
            .map_err(|_| SourceError::OutOfMemory { path: path.to_owned(), bytes: 4 * count as u64 })?;
        colours.extend(samples.as_chunks().0.iter().map(|&[a, b, c]| colour([a.value(), b.value(), c.value()])));
    });
    Ok(colours)
}

/// Red, green and blue of luminance and differences (ITU-R BT.601), which begin at `black` and are to be widened.
fn rgb([y, blue, red]: [u8; 3], black: f32, widen_y: f32, widen_differences: f32) -> [u8; 3] {
    let y = (f32::from(y) - black) * widen_y;
    let (blue, red) =
        ((f32::from(blue) - 128.0) * widen_differences, (f32::from(red) - 128.0) * widen_differences);
    [y + 1.402 * red, y - 0.344_136 * blue - 0.714_136 * red, y + 1.772 * blue]
        .map(|value| value.round() as u8)
}

/// Pixels of three numbers out of pairs of pixels that share their differences: Y, Y, B, R.
pub(super) fn whole(stored: &Stored) -> Stored {
    macro_rules! whole {
        ($($variant:ident)*) => {
            match stored {
                $(Stored::$variant(samples) => Stored::$variant(
                    samples.as_chunks().0.iter().flat_map(|&[one, two, blue, red]| [one, blue, red, two, blue, red]).collect(),
                ),)*
            }
        };
    }
    whole!(U8 I8 U16 I16 U32 I32 U64 I64 F32 F64)
}

/// Pixels of three numbers out of frames of three pictures.
pub(super) fn interleaved(stored: &Stored, pixels: usize) -> Stored {
    macro_rules! interleaved {
        ($($variant:ident)*) => {
            match stored {
                $(Stored::$variant(samples) => Stored::$variant(
                    samples
                        .chunks_exact(3 * pixels.max(1))
                        .flat_map(|frame| (0..pixels).flat_map(move |at| [0, 1, 2].map(|channel| frame[channel * pixels + at])))
                        .collect(),
                ),)*
            }
        };
    }
    interleaved!(U8 I8 U16 I16 U32 I32 U64 I64 F32 F64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_out_of_luminance_and_out_of_planes() {
        // Red, green, blue and white of PS3.3 C.7.6.3.1.2.
        assert_eq!(rgb([76, 85, 255], 0.0, 1.0, 1.0), [254, 0, 0]);
        assert_eq!(rgb([255, 128, 128], 0.0, 1.0, 1.0), [255; 3]);
        assert_eq!(rgb([235, 128, 128], 16.0, 255.0 / 219.0, 255.0 / 224.0), [255; 3]);
        assert_eq!(whole(&Stored::U8(vec![1, 2, 3, 4])), Stored::U8(vec![1, 3, 4, 2, 3, 4]));
        let planes = Stored::U8(vec![1, 2, 3, 4, 5, 6, 11, 12, 13, 14, 15, 16]);
        assert_eq!(interleaved(&planes, 2), Stored::U8(vec![1, 3, 5, 2, 4, 6, 11, 13, 15, 12, 14, 16]));
    }
}
