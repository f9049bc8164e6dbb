//! Parts of the body that the frames of a file are masks of.

use super::{
    elements::Element,
    tags,
    values::{Unreadable, shorts, text, whole},
};

/// Segments of one file.
const MAX_SEGMENTS: usize = 1 << 16;

/// How the frames say what belongs to a segment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Form {
    /// They are no masks.
    #[default]
    None,
    /// Yes or no.
    Binary,
    /// How much of a pixel.
    Fractional,
    /// The number of the segment itself.
    Labels,
}

/// One part.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Segment {
    /// Its number.
    pub number: i64,
    /// What it is called.
    pub label: String,
    /// The colour that is recommended, as L*a*b* in 16 bits each.
    pub lab: Option<[u16; 3]>,
}

/// The parts of a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Segments {
    /// How frames tell them.
    pub form: Form,
    /// All of them.
    pub all: Vec<Segment>,
    /// What a whole pixel is.
    pub greatest: u16,
}

impl Segments {
    /// Takes an element of the file.
    pub fn of_file(&mut self, element: &Element, big_endian: bool) {
        if element.tag == tags::GREATEST_FRACTION {
            self.greatest = shorts(&element.value, big_endian).first().copied().unwrap_or(0);
        } else {
            self.form = match text(&element.value).as_str() {
                "BINARY" => Form::Binary,
                "FRACTIONAL" => Form::Fractional,
                "LABELMAP" => Form::Labels,
                _ => Form::None,
            };
        }
    }

    /// Takes an element of a segment.
    pub fn element(&mut self, item: usize, element: &Element, big_endian: bool) -> Result<(), Unreadable> {
        if item >= MAX_SEGMENTS {
            return Ok(());
        }
        if self.all.len() <= item {
            self.all.resize(item + 1, Segment::default());
        }
        let segment = &mut self.all[item];
        match element.tag {
            tags::SEGMENT => segment.number = whole(element, big_endian)?.unwrap_or(0),
            tags::SEGMENT_LABEL => segment.label = text(&element.value),
            tags::SEGMENT_COLOUR => segment.lab = shorts(&element.value, big_endian).try_into().ok(),
            _ => {}
        }
        Ok(())
    }
}

impl Segment {
    /// The recommended colour as sRGB: from L*a*b* under D50, as PS3.3 C.10.7.1.1 codes it, by Bradford's adaptation.
    pub fn colour(&self) -> Option<[u8; 3]> {
        let [l, a, b] = self.lab?.map(|number| f64::from(number) / 65535.0);
        let (l, a, b) = (l * 100.0, a * 255.0 - 128.0, b * 255.0 - 128.0);
        let y = (l + 16.0) / 116.0;
        let from = |f: f64| {
            if f > 6.0 / 29.0 { f.powi(3) } else { 3.0 * (6.0_f64 / 29.0).powi(2) * (f - 4.0 / 29.0) }
        };
        let [x, y, z] = [from(y + a / 500.0) * 0.9642, from(y), from(y - b / 200.0) * 0.8251];
        let linear = [
            3.133_856_1 * x - 1.616_866_7 * y - 0.490_614_6 * z,
            -0.978_768_4 * x + 1.916_141_5 * y + 0.033_454_0 * z,
            0.071_945_3 * x - 0.228_991_4 * y + 1.405_242_7 * z,
        ];
        let encoded = |value: f64| {
            let value = value.clamp(0.0, 1.0);
            if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
        };
        Some(linear.map(|value| (encoded(value) * 255.0).round() as u8))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coded(l: f64, a: f64, b: f64) -> Segment {
        let lab =
            [l / 100.0, (a + 128.0) / 255.0, (b + 128.0) / 255.0].map(|part| (part * 65535.0).round() as u16);
        Segment { lab: Some(lab), ..Segment::default() }
    }

    #[test]
    fn colours_of_segments_are_those_of_their_coordinates() {
        assert_eq!(coded(100.0, 0.0, 0.0).colour(), Some([255, 255, 255]));
        assert_eq!(coded(0.0, 0.0, 0.0).colour(), Some([0, 0, 0]));
        // sRGB red under D50.
        let [red, green, blue] = coded(54.29, 80.81, 69.89).colour().unwrap_or_default();
        assert!(red >= 254 && green <= 2 && blue <= 2, "{red} {green} {blue}");
        assert_eq!(Segment::default().colour(), None);
    }
}
