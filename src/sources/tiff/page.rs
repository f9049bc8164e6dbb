//! One page of a TIFF file: what its directory says.

use std::path::Path;

use tiff::{
    ColorType,
    decoder::ifd::{Entry, Value},
    tags::{ByteOrder, Tag, Type},
};

use super::{
    pages::{Pixels, tiff_error, unsupported},
    patched::{Patch, as_gray, longer},
};
use crate::sources::{
    SourceError,
    shape::Side,
    stored::{Stored, StoredFormat},
    volume::Endian,
};

/// The longest description that is read.
const MAX_DESCRIPTION: usize = 1 << 22;

/// Values of `Compression`.
const NOT_PACKED: u16 = 1;
const LZW: u16 = 5;
const JPEG: u16 = 7;

/// Values of `PhotometricInterpretation`.
const WHITE_IS_ZERO: u16 = 0;
const PALETTE: u16 = 3;
const YCBCR: u16 = 6;

/// A value of `SampleFormat`.
const SIGNED: u16 = 2;

/// How many slices a page holds, which few programs write and `tiff` does not know.
const IMAGE_DEPTH: Tag = Tag::Unknown(32997);

/// What is known of a page before it is decoded.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Page {
    /// Its number in the file, counted from 0.
    pub number: usize,
    /// Pixels along x and y.
    pub size: [u64; 2],
    /// Numbers of each pixel.
    pub channels: u64,
    /// Whether they are a colour.
    pub is_colour: bool,
    /// Whether each number has a plane of its own.
    is_planar: bool,
    /// Whether the colour is luminance and chrominance, as JPEG has it.
    is_ycbcr: bool,
    /// Whether its samples are packed.
    pub is_packed: bool,
    /// What its samples mean, where a person should know.
    pub note: Option<&'static str>,
    bits: u16,
    kind: u16,
    /// The order of the bytes of the file.
    pub endian: Endian,
    /// What is written about it.
    pub description: String,
    /// Pixels of a unit, along x and y.
    pub pixels_per_unit: [Option<f64>; 2],
    /// The unit: 2 for an inch, 3 for a centimetre, `None` for none.
    pub resolution_unit: Option<u16>,
    /// Where its samples begin, if they are not packed.
    pub plain_at: Option<u64>,
}

impl Page {
    /// How one number is stored.
    pub fn format(&self) -> StoredFormat {
        match (self.kind, self.bits) {
            (2, ..=8) => StoredFormat::I8,
            (2, ..=16) => StoredFormat::I16,
            (2, ..=32) => StoredFormat::I32,
            (2, _) => StoredFormat::I64,
            // 16-bit floats are made of words once they are read.
            (3, ..=16) => StoredFormat::U16,
            (3, ..=32) => StoredFormat::F32,
            (3, _) => StoredFormat::F64,
            (_, ..=8) => StoredFormat::U8,
            (_, ..=16) => StoredFormat::U16,
            (_, ..=32) => StoredFormat::U32,
            _ => StoredFormat::U64,
        }
    }

    /// The axes of its samples, the fastest first.
    pub fn sides(&self) -> Vec<Side> {
        let channels = Side::components(self.channels, "channels");
        let [x, y] = self.size.map(Side::space);
        if self.is_planar { vec![x, y, channels] } else { vec![channels, x, y] }
    }

    /// How many numbers it has.
    pub fn samples(&self) -> u64 {
        self.size[0].saturating_mul(self.size[1]).saturating_mul(self.channels)
    }

    /// Bits of so many pages like this.
    pub fn bits_of(&self, pages: u64) -> u64 {
        self.samples().saturating_mul(pages).saturating_mul(self.bits.into())
    }

    /// Makes what was read of pages like this what it stands for.
    pub fn finish(&self, path: &Path, stored: Stored) -> Result<Stored, SourceError> {
        if (self.kind, self.bits) == (3, 16) { stored.with_halves_read(path) } else { Ok(stored) }
    }

    /// Samples as they are decoded, in rows of so many bytes, brought to those of [`Self::format`].
    pub fn plain(&self, decoded: &[u8], row: Option<usize>) -> Vec<u8> {
        if self.bits < 8 {
            return unpacked(decoded, row.unwrap_or(decoded.len()), self.bits, self.size[0] as usize);
        }
        let mut bytes = decoded.to_vec();
        if self.is_ycbcr {
            bytes.as_chunks_mut::<3>().0.iter_mut().for_each(|pixel| *pixel = rgb(*pixel));
        }
        bytes
    }

    /// Whether another page can lie on this one.
    pub fn is_alike(&self, other: &Self) -> bool {
        let of =
            |page: &Self| (page.size, page.channels, page.is_planar, page.is_ycbcr, page.bits, page.kind);
        of(self) == of(other)
    }

    /// The page that a decoder is at, counted from 0; `None` if it is a smaller version of another, or a mask. What has to be read
    /// otherwise than it is written is added to `patches`.
    pub fn read(
        path: &Path,
        decoder: &mut Pixels,
        number: usize,
        patches: &mut Vec<Patch>,
    ) -> Result<Option<Self>, SourceError> {
        // Bit 0: of reduced resolution; bit 2: a mask.
        if word(decoder, Tag::NewSubfileType).unwrap_or(0) & 5 != 0 {
            return Ok(None);
        }
        if word(decoder, IMAGE_DEPTH).is_some_and(|depth| depth > 1) {
            let found = format!("its page {} is a volume by itself (ImageDepth)", number + 1);
            return Err(unsupported(path, found, "save it as a stack of pages"));
        }
        let photometric = word(decoder, Tag::PhotometricInterpretation);
        let compression = word(decoder, Tag::Compression).unwrap_or(NOT_PACKED);
        let (channels, is_colour) = if photometric == Some(PALETTE) {
            patches.extend(as_gray(path, decoder)?);
            (1, false)
        } else {
            channels(path, decoder, number, compression)?
        };
        if compression == LZW {
            patches.extend(longer(path, decoder)?);
        }
        let bits = word(decoder, Tag::BitsPerSample).unwrap_or(1);
        let kind = word(decoder, Tag::SampleFormat).unwrap_or(1);
        let is_read =
            matches!(bits, 8 | 16 | 32 | 64) || matches!(bits, 1 | 2 | 4) && channels == 1 && kind == 1;
        if !is_read || kind > 4 {
            let found =
                format!("the samples of its page {} have {bits} bits (sample format {kind})", number + 1);
            return Err(unsupported(path, found, "convert it to 8, 16 or 32 bits"));
        }
        let (width, height) = decoder.dimensions().map_err(|error| tiff_error(path, number, error))?;
        let is_planar = channels > 1 && word(decoder, Tag::PlanarConfiguration) == Some(2);
        let is_plain = compression == NOT_PACKED && bits >= 8 && !is_planar;
        let mut page = Self {
            number,
            size: [width.into(), height.into()],
            channels,
            is_colour: is_colour && matches!(bits, 8 | 16) && kind != SIGNED,
            is_planar,
            is_ycbcr: compression == JPEG && photometric == Some(YCBCR),
            is_packed: compression != NOT_PACKED,
            note: match photometric {
                Some(WHITE_IS_ZERO) => Some(
                    "the lowest of its samples are white; they are turned round, so that the highest are",
                ),
                Some(PALETTE) => Some("its samples are indices of a table of colours, which is not used"),
                _ => None,
            },
            bits,
            kind,
            endian: if decoder.byte_order() == ByteOrder::BigEndian { Endian::Big } else { Endian::Little },
            description: String::new(),
            pixels_per_unit: [None; 2],
            resolution_unit: None,
            plain_at: None,
        };
        if number == 0 {
            page.describe(decoder, is_plain);
        }
        Ok(Some(page))
    }

    /// Adds what only the first page is asked for.
    fn describe(&mut self, decoder: &mut Pixels, is_plain: bool) {
        self.description = description(decoder);
        self.pixels_per_unit =
            [Tag::XResolution, Tag::YResolution].map(|name| pixels_per_unit(tag(decoder, name)));
        // Inches unless it says otherwise.
        let unit = word(decoder, Tag::ResolutionUnit).unwrap_or(2);
        self.resolution_unit = matches!(unit, 2 | 3).then_some(unit);
        let offsets = tag(decoder, Tag::StripOffsets).filter(|_| is_plain);
        self.plain_at = offsets.and_then(first).and_then(|offset| offset.into_u64().ok());
    }
}

/// How many numbers each pixel has, and whether they are a colour.
fn channels(
    path: &Path,
    decoder: &mut Pixels,
    number: usize,
    compression: u16,
) -> Result<(u64, bool), SourceError> {
    match decoder.colortype().map_err(|error| tiff_error(path, number, error))? {
        ColorType::Gray(_) => Ok((1, false)),
        ColorType::GrayA(_) => Ok((2, false)),
        ColorType::RGB(_) => Ok((3, true)),
        ColorType::RGBA(_) => Ok((4, true)),
        // JPEG's; others take fewer samples of chrominance, and are not decoded.
        ColorType::YCbCr(8) if compression == JPEG => Ok((3, true)),
        ColorType::Multiband { num_samples, .. } => Ok((u64::from(num_samples), false)),
        other => {
            let found = format!("the colours of its page {} are {other:?}", number + 1);
            Err(unsupported(path, found, "convert it to gray or RGB"))
        }
    }
}

/// The numbers of a tag. Of text in their place the decoder takes as much memory as the file says, or prints what it thinks of it.
fn tag(decoder: &mut Pixels, name: Tag) -> Option<Value> {
    let is_text = |entry: Entry| entry.field_type() == Type::ASCII;
    let holds_numbers = decoder.image_ifd().find_entry(name).is_some_and(|entry| !is_text(entry));
    holds_numbers.then(|| decoder.find_tag(name).ok().flatten()).flatten()
}

/// The first of several values.
fn first(value: Value) -> Option<Value> {
    match value {
        Value::List(values) => values.into_iter().next(),
        value => Some(value),
    }
}

/// A small number, or the first of several.
fn word(decoder: &mut Pixels, name: Tag) -> Option<u16> {
    tag(decoder, name).and_then(first)?.into_u16().ok()
}

/// Text, whose letters beyond ASCII may be of either of two encodings.
fn description(decoder: &mut Pixels) -> String {
    let mut bytes = Vec::new();
    let mut ifd = decoder.image_ifd();
    let length = ifd.find_entry(Tag::ImageDescription).map_or(0, |entry| entry.count());
    bytes.resize(usize::try_from(length).unwrap_or(0).min(MAX_DESCRIPTION), 0);
    let read = ifd.find_tag_bytes(Tag::ImageDescription, &mut bytes, 0).ok().flatten().unwrap_or(0);
    bytes.truncate(read);
    let bytes = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

fn pixels_per_unit(value: Option<Value>) -> Option<f64> {
    let pixels = match value? {
        Value::Rational(pixels, units) => f64::from(pixels) / f64::from(units),
        Value::Float(pixels) => f64::from(pixels),
        Value::Double(pixels) => pixels,
        _ => return None,
    };
    (pixels.is_finite() && pixels > 0.0).then_some(pixels)
}

/// One byte a sample, of several samples a byte in rows that begin at a byte.
fn unpacked(bytes: &[u8], row: usize, bits: u16, width: usize) -> Vec<u8> {
    let in_byte = 8 / usize::from(bits);
    let mask = (1_u8 << bits) - 1;
    let sample = |row: &[u8], x: usize| {
        row.get(x / in_byte).map_or(0, |byte| byte >> (8 - usize::from(bits) * (x % in_byte + 1)) & mask)
    };
    bytes.chunks(row.max(1)).flat_map(|row| (0..width).map(move |x| sample(row, x))).collect()
}

/// ITU-R BT.601, as JPEG has it.
fn rgb([luma, blue, red]: [u8; 3]) -> [u8; 3] {
    let [luma, blue, red] = [f32::from(luma), f32::from(blue) - 128.0, f32::from(red) - 128.0];
    [luma + 1.402 * red, luma - 0.344_136 * blue - 0.714_136 * red, luma + 1.772 * blue]
        .map(|value| value.round() as u8)
}
