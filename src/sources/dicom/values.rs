//! Values of elements as numbers and text.

use super::{elements::Element, tags};

/// An element whose value cannot be understood.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Unreadable {
    /// Which.
    pub tag: u32,
    /// What was expected, what was found, how to mend it.
    pub problem: String,
}

/// Characters of a value that a message repeats.
const MAX_SHOWN: usize = 40;

/// A value as text, without what pads it.
pub(super) fn text(value: &[u8]) -> String {
    String::from_utf8_lossy(value).trim_matches([' ', '\0']).to_owned()
}

/// The numbers of an element; `None` if there are none, which a file may say of most.
///
/// A comma is no character of a number here, so one stands for the point of a program that wrote by the rules of its country.
pub(super) fn numbers(element: &Element, big_endian: bool) -> Result<Option<Vec<f64>>, Unreadable> {
    if let Some(binary) = binary(element, big_endian) {
        return if binary.iter().all(|number| number.is_finite()) {
            Ok(Some(binary).filter(|binary| !binary.is_empty()))
        } else {
            Err(unreadable(element, "has a number that is not finite"))
        };
    }
    let text = text(&element.value);
    let parts: Vec<&str> = text.split('\\').map(|part| part.trim_matches([' ', '\0'])).collect();
    if parts.iter().all(|part| part.is_empty()) {
        return Ok(None);
    }
    let number = |part: &&str| part.replace(',', ".").parse().ok().filter(|number: &f64| number.is_finite());
    let numbers: Option<Vec<f64>> = parts.iter().map(number).collect();
    numbers.map(Some).ok_or_else(|| unreadable(element, "is not of decimal numbers"))
}

/// The same, of which there must be `N`.
pub(super) fn exactly<const N: usize>(
    element: &Element,
    big_endian: bool,
) -> Result<Option<[f64; N]>, Unreadable> {
    let Some(numbers) = numbers(element, big_endian)? else { return Ok(None) };
    let found = numbers.len();
    numbers
        .try_into()
        .map(Some)
        .map_err(|_| unreadable(element, &format!("has {found} numbers, expected {N}")))
}

/// The first number.
pub(super) fn first(element: &Element, big_endian: bool) -> Result<Option<f64>, Unreadable> {
    Ok(numbers(element, big_endian)?.and_then(|numbers| numbers.first().copied()))
}

/// The first number, which must be whole.
pub(super) fn whole(element: &Element, big_endian: bool) -> Result<Option<i64>, Unreadable> {
    match first(element, big_endian)? {
        Some(number) if number.fract() != 0.0 || number.abs() > 1e15 => {
            Err(unreadable(element, "is not a whole number"))
        }
        number => Ok(number.map(|number| number as i64)),
    }
}

/// Whole numbers of 16 bits.
pub(super) fn shorts(value: &[u8], big_endian: bool) -> Vec<u16> {
    let number = if big_endian { u16::from_be_bytes } else { u16::from_le_bytes };
    value.as_chunks().0.iter().map(|bytes| number(*bytes)).collect()
}

/// Numbers of a type that is no text; `None` for text.
fn binary(element: &Element, big_endian: bool) -> Option<Vec<f64>> {
    macro_rules! numbers {
        ($type:ty) => {{
            let number = if big_endian { <$type>::from_be_bytes } else { <$type>::from_le_bytes };
            element.value.as_chunks().0.iter().map(|bytes| number(*bytes) as f64).collect()
        }};
    }
    Some(match &element.vr {
        b"FD" => numbers!(f64),
        b"FL" => numbers!(f32),
        b"US" => numbers!(u16),
        b"SS" => numbers!(i16),
        b"UL" => numbers!(u32),
        b"SL" => numbers!(i32),
        _ => return None,
    })
}

fn unreadable(element: &Element, what: &str) -> Unreadable {
    let text = text(&element.value);
    let mut shown: String =
        text.chars().take(MAX_SHOWN).map(|letter| if letter.is_control() { '?' } else { letter }).collect();
    if text.chars().nth(MAX_SHOWN).is_some() {
        shown.push('…');
    }
    let tag = element.tag;
    let (group, number) = (tag >> 16, tag & 0xffff);
    let problem =
        format!("`{shown}` {what}; correct it, as with `dcmodify -ma \"({group:04x},{number:04x})=…\" FILE`");
    Unreadable { tag, problem }
}

impl Unreadable {
    /// `PixelSpacing (0028,0030)`.
    pub fn field(&self) -> String {
        tags::called(self.tag)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn of(vr: &[u8; 2], value: &[u8]) -> Result<Option<Vec<f64>>, Unreadable> {
        numbers(&Element::of(tags::SPACING, vr, value), false)
    }

    #[test]
    fn commas_spaces_and_missing_numbers_are_understood() {
        assert_eq!(of(b"DS", b" 0,5 \\-1.5E-1\0").unwrap(), Some(vec![0.5, -0.15]));
        assert_eq!(of(b"UT", b"+2\\ 3").unwrap(), Some(vec![2.0, 3.0]));
        for nothing in [b"".as_slice(), b"  ", b"\\", b" \\ \\\0"] {
            assert_eq!(of(b"DS", nothing).unwrap(), None);
        }
        assert_eq!(of(b"FD", &1.25_f64.to_le_bytes()).unwrap(), Some(vec![1.25]));
    }

    #[test]
    fn what_is_no_number_is_told_by_name_and_value() {
        for wrong in [b"0.5,0.5".as_slice(), b"1\\\\2", b"nan", b"inf", b"1 mm"] {
            let error = of(b"DS", wrong).unwrap_err();
            assert_eq!(error.field(), "PixelSpacing (0028,0030)");
            assert!(error.problem.contains(&format!("`{}`", String::from_utf8_lossy(wrong))), "{error:?}");
        }
        let three = exactly::<2>(&Element::of(tags::SPACING, b"DS", b"1\\2\\3"), false).unwrap_err();
        assert!(three.problem.contains("has 3 numbers, expected 2"), "{three:?}");
        let long = of(b"DS", &[b'x'; 500]).unwrap_err();
        assert!(long.problem.chars().count() < 160, "{long:?}");
        assert!(whole(&Element::of(tags::FRAMES, b"IS", b"1.5"), false).is_err());
        assert_eq!(whole(&Element::of(tags::FRAMES, b"IS", b"16,0"), false).unwrap(), Some(16));
    }
}
