//! Pictures become bytes.

use super::Format;
use super::video::in_yuv;
use crate::components::Auto;
use crate::render::{Image, Pixels};
use image::codecs::openexr::OpenExrEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::io::Cursor;

/// Why a picture does not fit its format.
#[derive(Debug, thiserror::Error)]
pub(crate) enum EncodeError {
    #[error(transparent)]
    Png(#[from] png::EncodingError),
    #[error(transparent)]
    Exr(#[from] image::ImageError),
    #[error("a {found} picture cannot be written as {wanted}", found = if *.is_encoded { "encoded" } else { "linear" }, wanted = if *.is_encoded { "EXR" } else { "what a screen shows" })]
    Pixels { is_encoded: bool },
}

/// A picture, or a frame of a sequence, in a format that holds such pixels.
pub(super) fn encode(image: &Image, format: Format) -> Result<Vec<u8>, EncodeError> {
    match (format, &image.pixels) {
        (Format::Exr, Pixels::Radiance(pixels)) => exr(image, pixels),
        (Format::Png, Pixels::Encoded(pixels)) => png(image, pixels),
        (Format::Raw, Pixels::Encoded(pixels)) => Ok(with_alpha(image, pixels)),
        (Format::Y4m, Pixels::Encoded(pixels)) => Ok(in_yuv(pixels)),
        (_, pixels) => Err(EncodeError::Pixels { is_encoded: matches!(pixels, Pixels::Encoded(_)) }),
    }
}

/// Radiance is premultiplied as it is, which is what EXR asks for.
fn exr(image: &Image, pixels: &[[f32; 3]]) -> Result<Vec<u8>, EncodeError> {
    let mut bytes = Cursor::new(Vec::new());
    let encoder = OpenExrEncoder::new(&mut bytes);
    let (width, height) = (image.width, image.height);
    match &image.coverage {
        Some(coverage) => {
            let texels: Vec<[f32; 4]> =
                pixels.iter().zip(coverage).map(|([r, g, b], a)| [*r, *g, *b, *a]).collect();
            encoder.write_image(bytemuck::cast_slice(&texels), width, height, ExtendedColorType::Rgba32F)?;
        }
        None => {
            encoder.write_image(bytemuck::cast_slice(pixels), width, height, ExtendedColorType::Rgb32F)?;
        }
    }
    Ok(bytes.into_inner())
}

/// With a word on how it is encoded: what the PNG specification (third edition, 11.3.2.5) asks for where that is sRGB, else the exponent; and the colours of
/// its primaries.
fn png(image: &Image, pixels: &[[u8; 3]]) -> Result<Vec<u8>, EncodeError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width, image.height);
    encoder.set_color(if image.coverage.is_some() { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    let gamma = match image.gamma {
        Auto::Auto => {
            encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
            png::ScaledFloat::from_scaled(45_455)
        }
        Auto::Value(gamma) => png::ScaledFloat::new(gamma.recip()),
    };
    encoder.set_source_gamma(gamma);
    let primaries = ((0.64, 0.33), (0.3, 0.6), (0.15, 0.06));
    encoder.set_source_chromaticities(png::SourceChromaticities::new(
        (0.3127, 0.329),
        primaries.0,
        primaries.1,
        primaries.2,
    ));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&with_alpha(image, pixels))?;
    writer.finish()?;
    Ok(bytes)
}

/// The bytes of all pixels, with alpha where the picture says what it hides.
fn with_alpha(image: &Image, pixels: &[[u8; 3]]) -> Vec<u8> {
    match &image.coverage {
        Some(coverage) => {
            let alpha = |coverage: f32| (255.0 * coverage.clamp(0.0, 1.0)).round() as u8;
            pixels.iter().zip(coverage).flat_map(|([r, g, b], a)| [*r, *g, *b, alpha(*a)]).collect()
        }
        None => pixels.as_flattened().to_vec(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    fn image(pixels: Pixels, coverage: Option<Vec<f32>>, gamma: Auto<f32>) -> Image {
        Image { width: 2, height: 1, pixels, coverage, gamma }
    }

    fn read(bytes: &[u8]) -> (png::Info<'static>, Vec<u8>) {
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        (reader.info().clone(), pixels)
    }

    #[test]
    fn a_png_says_how_it_is_encoded() {
        let pixels = || Pixels::Encoded(vec![[1, 2, 3], [4, 5, 6]]);
        let (info, read_back) = read(&encode(&image(pixels(), None, Auto::Auto), Format::Png).unwrap());
        assert_eq!(info.srgb, Some(png::SrgbRenderingIntent::Perceptual));
        assert_eq!(read_back, [1, 2, 3, 4, 5, 6]);
        let bytes = encode(&image(pixels(), None, Auto::Auto), Format::Png).unwrap();
        for chunk in [b"sRGB", b"gAMA", b"cHRM"] {
            assert!(bytes.windows(4).any(|window| window == chunk), "{chunk:?}");
        }
        let (info, _) = read(&encode(&image(pixels(), None, Auto::Value(2.0)), Format::Png).unwrap());
        assert_eq!((info.srgb, info.gama_chunk), (None, Some(png::ScaledFloat::new(0.5))));
        assert!(info.chrm_chunk.is_some());
    }

    #[test]
    fn alpha_is_written_as_each_format_asks_for() {
        let coverage = Some(vec![1.0, 0.5]);
        let encoded = image(Pixels::Encoded(vec![[1, 2, 3], [4, 5, 6]]), coverage.clone(), Auto::Auto);
        let straight = [1, 2, 3, 255, 4, 5, 6, 128];
        assert_eq!(read(&encode(&encoded, Format::Png).unwrap()).1, straight);
        assert_eq!(encode(&encoded, Format::Raw).unwrap(), straight);
        let linear = image(Pixels::Radiance(vec![[1.0, 2.0, 3.0], [0.5, 0.25, 8.0]]), coverage, Auto::Auto);
        let bytes = encode(&linear, Format::Exr).unwrap();
        let read = image::load_from_memory_with_format(&bytes, image::ImageFormat::OpenExr).unwrap();
        assert_eq!(read.into_rgba32f().into_raw(), [1.0, 2.0, 3.0, 1.0, 0.5, 0.25, 8.0, 0.5]);
        assert!(encode(&linear, Format::Png).is_err() && encode(&encoded, Format::Exr).is_err());
    }
}
