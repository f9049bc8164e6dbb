//! What the elements of a DICOM file say of its frames.

use std::path::Path;

use glam::DVec3;

use super::{
    SourceError,
    elements::{Element, Elements, Syntax},
};

/// Frames of one file whose places are kept.
const MAX_FRAMES: usize = 1 << 16;

/// What a volume needs to know of a file.
#[derive(Debug, Clone)]
pub(super) struct Header {
    /// How the file is written.
    pub syntax: Syntax,
    /// Pixels along y.
    pub rows: u16,
    /// Pixels along x.
    pub columns: u16,
    /// Images in the file.
    pub frames: u64,
    /// Bits from one number to the next.
    pub bits: u16,
    /// Bits that count, and the place of the highest.
    pub stored_bits: u16,
    /// The place of the highest bit that counts.
    pub high_bit: u16,
    /// Whether it is the sign.
    pub signed: bool,
    /// Numbers a pixel.
    channels: u16,
    /// What the numbers mean.
    photometric: String,
    /// Distance of pixel centres along y and x, mm.
    pub spacing: Option<[f64; 2]>,
    /// Distance of slices by what the file says, mm.
    pub between: Option<f64>,
    /// How thick a slice is, mm.
    pub thickness: Option<f64>,
    /// The directions in which columns and rows count, in the patient: left, posterior, superior.
    pub orientation: Option<[DVec3; 2]>,
    /// Where the first pixel of each frame is, mm.
    pub positions: Vec<DVec3>,
    /// Slope of the values: one for all frames or one for each.
    pub slopes: Vec<f64>,
    /// Intercept of the values, likewise.
    pub intercepts: Vec<f64>,
    /// The series that it belongs to.
    pub series: String,
    /// What people call it.
    pub description: String,
    /// The number in the series.
    pub instance: i64,
    /// Whether pixels are 32- or 64-bit floats.
    pub is_float: bool,
}

impl Header {
    /// Reads a file up to its pixels.
    pub fn read(path: &Path) -> Result<Self, SourceError> {
        Self::read_up_to_pixels(path).map(|(header, ..)| header)
    }

    /// Also gives what is next to be read: the pixels, and the element that they are.
    pub fn read_up_to_pixels(path: &Path) -> Result<(Self, Elements, Element), SourceError> {
        let mut elements = Elements::open(path)?;
        let mut header = Self::empty(elements.syntax.clone());
        while let Some(element) = elements.next(is_wanted)? {
            if matches!(element.tag, 0x7fe0_0008..=0x7fe0_0010) {
                header.is_float = element.tag != 0x7fe0_0010;
                header.check(path)?;
                return Ok((header, elements, element));
            }
            header.element(&element, &elements);
        }
        Err(unsupported(path, "a DICOM file without pixels", "name one with an image in it"))
    }

    fn empty(syntax: Syntax) -> Self {
        Self {
            syntax,
            rows: 0,
            columns: 0,
            frames: 1,
            bits: 0,
            stored_bits: 0,
            high_bit: 0,
            signed: false,
            channels: 1,
            photometric: String::new(),
            spacing: None,
            between: None,
            thickness: None,
            orientation: None,
            positions: Vec::new(),
            slopes: Vec::new(),
            intercepts: Vec::new(),
            series: String::new(),
            description: String::new(),
            instance: 0,
            is_float: false,
        }
    }

    fn element(&mut self, element: &Element, elements: &Elements) {
        // Other sequences tell of other images.
        if !matches!(element.root, None | Some(0x5200_9229 | 0x5200_9230)) {
            return;
        }
        let value = &element.value;
        let short = || value.first_chunk::<2>().map_or(0, |bytes| elements.u16(*bytes));
        let numbers = || numbers(value);
        let first = || numbers().first().copied();
        match element.tag {
            0x0008_103e => self.description = text(value),
            0x0018_0050 => self.thickness = first(),
            0x0018_0088 => self.between = first(),
            // The distance on the detector, where that in the patient is not known.
            0x0018_1164 => self.spacing = self.spacing.or(numbers().try_into().ok()),
            0x0020_000e => self.series = text(value),
            0x0020_0013 => self.instance = text(value).parse().unwrap_or(0),
            0x0020_0032 if self.positions.len() < MAX_FRAMES => {
                self.positions.extend(<[f64; 3]>::try_from(numbers()).map(DVec3::from).ok());
            }
            0x0020_0037 if self.orientation.is_none() => {
                self.orientation = <[f64; 6]>::try_from(numbers())
                    .ok()
                    .map(|[a, b, c, d, e, f]| [DVec3::new(a, b, c), DVec3::new(d, e, f)]);
            }
            0x0028_0002 => self.channels = short(),
            0x0028_0004 => self.photometric = text(value),
            0x0028_0008 => self.frames = text(value).parse().unwrap_or(0),
            0x0028_0010 => self.rows = short(),
            0x0028_0011 => self.columns = short(),
            0x0028_0030 => self.spacing = numbers().try_into().ok().or(self.spacing),
            0x0028_0100 => self.bits = short(),
            0x0028_0101 => self.stored_bits = short(),
            0x0028_0102 => self.high_bit = short(),
            0x0028_0103 => self.signed = short() == 1,
            0x0028_1052 if self.intercepts.len() < MAX_FRAMES => self.intercepts.extend(first()),
            0x0028_1053 if self.slopes.len() < MAX_FRAMES => self.slopes.extend(first()),
            _ => {}
        }
    }

    /// Refuses what is no image of one number a pixel.
    fn check(&self, path: &Path) -> Result<(), SourceError> {
        if self.channels != 1 || self.photometric == "PALETTE COLOR" {
            let found = format!("its pixels are colours ({})", self.photometric);
            return Err(unsupported(path, &found, "only images of one number a pixel make a volume"));
        }
        let is_known =
            if self.is_float { [32, 64].contains(&self.bits) } else { [8, 16, 32].contains(&self.bits) };
        if !is_known {
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

    /// Slope and intercept of a frame.
    pub fn scale(&self, frame: usize) -> [f64; 2] {
        let of = |all: &[f64], otherwise: f64| all.get(frame).or(all.last()).copied().unwrap_or(otherwise);
        [of(&self.slopes, 1.0), of(&self.intercepts, 0.0)]
    }
}

fn is_wanted(tag: u32) -> bool {
    matches!(
        tag,
        0x0008_103e
            | 0x0018_0050
            | 0x0018_0088
            | 0x0018_1164
            | 0x0020_000e
            | 0x0020_0013
            | 0x0020_0032
            | 0x0020_0037
            | 0x0028_0002
            | 0x0028_0004
            | 0x0028_0008
            | 0x0028_0010
            | 0x0028_0011
            | 0x0028_0030
            | 0x0028_0100..=0x0028_0103 | 0x0028_1052 | 0x0028_1053
    )
}

/// A value as text, without what pads it.
pub(super) fn text(value: &[u8]) -> String {
    String::from_utf8_lossy(value).trim_matches([' ', '\0']).to_owned()
}

/// Decimal numbers between backslashes; none if one of them is not finite.
fn numbers(value: &[u8]) -> Vec<f64> {
    let numbers = text(value)
        .split('\\')
        .map(|number| number.trim().parse().ok().filter(|n: &f64| n.is_finite()))
        .collect();
    Option::<Vec<f64>>::unwrap_or_default(numbers)
}

/// The error for what is no image that makes a volume.
pub(super) fn unsupported(path: &Path, found: &str, mend: &str) -> SourceError {
    SourceError::Unsupported { path: path.to_owned(), found: found.to_owned(), mend: mend.to_owned() }
}
