//! How the pixels of a DICOM file are stored.

use std::path::Path;

use super::{
    SourceError,
    elements::Element,
    header::unsupported,
    tags,
    values::{shorts, text},
};
use crate::sources::stored::{Stored, StoredFormat};

/// What the numbers of a pixel are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// One value.
    Value,
    /// The place of a colour in a table.
    Palette,
    /// Red, green, blue.
    Rgb,
    /// Luminance and two differences, over the whole range.
    Ybr,
    /// The same between 16 and 235 or 240, as in video.
    YbrPartial,
}

/// How pixels are stored.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Image {
    /// Pixels along y.
    pub rows: u16,
    /// Pixels along x.
    pub columns: u16,
    /// Bits from one number to the next.
    pub bits: u16,
    /// Bits that count.
    pub stored_bits: u16,
    /// The place of the highest bit that counts.
    pub high_bit: u16,
    /// Whether it is the sign.
    pub signed: bool,
    /// Numbers a pixel.
    pub channels: u16,
    /// Whether a frame is one picture for each of them.
    pub planar: bool,
    /// What the numbers mean.
    pub photometric: String,
    /// Whether they are 32- or 64-bit floats.
    pub is_float: bool,
    has_high_bit: bool,
}

impl Image {
    /// Takes an element that is about pixels.
    pub fn element(&mut self, element: &Element, big_endian: bool) {
        let short = shorts(&element.value, big_endian).first().copied().unwrap_or(0);
        match element.tag {
            tags::CHANNELS => self.channels = short,
            tags::PHOTOMETRIC => self.photometric = text(&element.value),
            tags::PLANAR => self.planar = short == 1,
            tags::ROWS => self.rows = short,
            tags::COLUMNS => self.columns = short,
            tags::BITS => self.bits = short,
            tags::STORED_BITS => self.stored_bits = short,
            tags::HIGH_BIT => (self.high_bit, self.has_high_bit) = (short, true),
            tags::SIGNED => self.signed = short == 1,
            _ => {}
        }
    }

    /// Fills in what files leave out, and refuses what is not read.
    pub fn complete(&mut self, path: &Path) -> Result<(), SourceError> {
        self.channels = self.channels.max(1);
        if self.is_float && self.bits == 0 {
            self.bits = 32;
        }
        if self.stored_bits == 0 {
            self.stored_bits = self.bits;
        }
        if !self.has_high_bit {
            self.high_bit = self.stored_bits.saturating_sub(1);
        }
        self.check_kind(path)?;
        let known: &[u16] = match (self.is_float, self.kind()) {
            (true, _) => &[32, 64],
            (_, Kind::Value) => &[1, 8, 16, 32],
            _ => &[8, 16],
        };
        if !known.contains(&self.bits) {
            let found = format!("its pixels have {} bits", self.bits);
            return Err(unsupported(path, &found, "convert them to 8, 16 or 32 bits"));
        }
        if !self.is_float
            && (self.stored_bits == 0
                || self.stored_bits > self.bits
                || self.high_bit >= self.bits
                || self.high_bit + 1 < self.stored_bits)
        {
            return Err(SourceError::Field {
                path: path.to_owned(),
                field: "BitsStored, HighBit".to_owned(),
                problem: format!(
                    "{} bits up to bit {} of {}; the header is damaged",
                    self.stored_bits, self.high_bit, self.bits
                ),
            });
        }
        Ok(())
    }

    fn check_kind(&self, path: &Path) -> Result<(), SourceError> {
        let is_known = match self.channels {
            1 => true,
            3 => matches!(
                self.photometric.as_str(),
                "RGB"
                    | "YBR_FULL"
                    | "YBR_FULL_422"
                    | "YBR_PARTIAL_422"
                    | "YBR_PARTIAL_420"
                    | "YBR_ICT"
                    | "YBR_RCT"
            ),
            _ => false,
        };
        if is_known && !(self.is_float && self.channels > 1) {
            return Ok(());
        }
        let found = format!("its pixels are {} numbers of `{}`", self.channels, self.photometric);
        Err(unsupported(path, &found, "convert them to RGB, or to one number a pixel"))
    }

    /// What the numbers of a pixel are, as the file has them.
    pub fn kind(&self) -> Kind {
        match (self.channels, self.photometric.as_str()) {
            (1, "PALETTE COLOR") => Kind::Palette,
            (1, _) => Kind::Value,
            (_, "YBR_PARTIAL_422" | "YBR_PARTIAL_420") => Kind::YbrPartial,
            (_, photometric) if photometric.starts_with("YBR") => Kind::Ybr,
            _ => Kind::Rgb,
        }
    }

    /// Whether two pixels share their differences of colour, where they are not compressed.
    pub fn is_halved(&self) -> bool {
        self.channels == 3 && self.photometric.ends_with("_422")
    }

    /// The type of its numbers, unpacked.
    pub fn format(&self) -> StoredFormat {
        match (self.is_float, self.bits, self.signed) {
            (true, 32, _) => StoredFormat::F32,
            (true, ..) => StoredFormat::F64,
            (_, 0..=8, false) => StoredFormat::U8,
            (_, 0..=8, true) => StoredFormat::I8,
            (_, 9..=16, false) => StoredFormat::U16,
            (_, 9..=16, true) => StoredFormat::I16,
            (.., false) => StoredFormat::U32,
            (.., true) => StoredFormat::I32,
        }
    }

    /// Pixels of a frame.
    pub fn pixels(&self) -> usize {
        usize::from(self.columns) * usize::from(self.rows)
    }

    /// Clears bits that are not part of a pixel, and spreads the sign over them.
    pub fn keep_stored_bits(&self, stored: &mut Stored) {
        if self.is_float || self.stored_bits == self.bits || self.bits == 1 {
            return;
        }
        let up = u32::from(self.bits - 1 - self.high_bit);
        let down = u32::from(self.bits - self.stored_bits);
        macro_rules! keep {
            ($($variant:ident)*) => {
                match stored {
                    $(Stored::$variant(pixels) => pixels.iter_mut().for_each(|pixel| *pixel = *pixel << up >> down),)*
                    _ => {}
                }
            };
        }
        keep!(U8 I8 U16 I16 U32 I32);
    }
}
