//! Whether bytes are the beginning of a DICOM file, also of one without its mark.
//!
//! What scanners and archives write often lacks the 128 bytes and the mark that a file should begin with. Such a file begins
//! with its first elements. Text, and other formats, do not: their first bytes are no chain of elements in rising order, of
//! types and lengths that fit.

use super::{elements::is_long, tags};

/// Where the mark of a DICOM file stands, and what it is.
pub(super) const MAGIC_AT: usize = 128;
pub(super) const MAGIC: &[u8] = b"DICM";

/// Bytes that are needed to tell.
pub(super) const HEAD: u64 = 1024;

/// Elements in a row that no other format has by chance.
const CHAIN: usize = 3;

/// The last element that a group of the beginning has, and the longest value there that is no sequence.
const MAX_ELEMENT: u32 = 0x9fff;
const MAX_LENGTH: usize = 1 << 16;

/// Whether a file that begins with `head` is of this format; a shorter beginning will do if it is named so.
pub fn is_dicom(head: &[u8], is_named_so: bool) -> bool {
    let has_magic = head.get(MAGIC_AT..MAGIC_AT + MAGIC.len()) == Some(MAGIC);
    let named = is_named_so && matches!(head, [2 | 8, 0, 0 | 5 | 0x16 | 0x18, 0, ..]);
    has_magic
        || named
        || [(false, false), (false, true), (true, false), (true, true)]
            .into_iter()
            .any(|(big, implicit)| is_chain(head, big, implicit))
}

/// Whether these are elements of the first groups, one after the other.
fn is_chain(head: &[u8], big: bool, implicit: bool) -> bool {
    let (mut at, mut last) = (0, 0);
    for count in 0.. {
        let Some(next) = element(head, at, big, implicit) else { return false };
        let Some((tag, length)) = next else {
            // Bytes end: what is there was right.
            return count >= CHAIN;
        };
        let first = matches!(tag >> 16, 2 | 8) && tag & 0xffff <= MAX_ELEMENT;
        if count == 0 && !first || tag <= last || count > 0 && tag >> 16 > 0x7fe0 {
            return false;
        }
        if count + 1 >= CHAIN {
            return true;
        }
        last = tag;
        at = length;
    }
    false
}

/// The element at a place and where the next one is; nothing where the bytes end, and nothing at all where there is none.
#[allow(clippy::option_option, reason = "the end is neither an element nor a mistake")]
fn element(head: &[u8], at: usize, big: bool, implicit: bool) -> Option<Option<(u32, usize)>> {
    let Some(bytes) = head.get(at..at + 8) else { return Some(None) };
    let short = |at: usize| {
        let two = [bytes[at], bytes[at + 1]];
        if big { u16::from_be_bytes(two) } else { u16::from_le_bytes(two) }
    };
    let long = |bytes: &[u8]| {
        let four: [u8; 4] = bytes.try_into().ok()?;
        Some(if big { u32::from_be_bytes(four) } else { u32::from_le_bytes(four) } as usize)
    };
    let tag = u32::from(short(0)) << 16 | u32::from(short(2));
    let (length, value, vr) = if implicit {
        (long(&bytes[4..8])?, at + 8, None)
    } else {
        let vr = [bytes[4], bytes[5]];
        if !is_type(&vr) {
            return None;
        }
        if is_long(&vr) {
            let Some(length) = head.get(at + 8..at + 12) else { return Some(None) };
            (long(length)?, at + 12, Some(vr))
        } else {
            (usize::from(short(6)), at + 8, Some(vr))
        }
    };
    let is_sequence = vr.map_or_else(|| tags::is_sequence(tag), |vr| &vr == b"SQ" || &vr == b"UN");
    if is_sequence && length > MAX_LENGTH {
        return Some(None);
    }
    if length > MAX_LENGTH || !length.is_multiple_of(2) {
        return None;
    }
    let end = value + length;
    if vr.is_none() && !is_text(tag, head.get(value..end.min(head.len()))?) {
        return None;
    }
    Some(Some((tag, end)))
}

fn is_type(vr: &[u8; 2]) -> bool {
    const TYPES: &[u8] = b"AEASATCSDADSDTFLFDISLOLTOBODOFOLOVOWPNSHSLSQSSSTSVTMUCUIULUNURUSUTUV";
    TYPES.chunks_exact(2).any(|known| known == vr)
}

/// Whether a value without a type is what the first groups have: text, or the length of a group, or a sequence.
fn is_text(tag: u32, value: &[u8]) -> bool {
    let is_length = tag & 0xffff <= 1 && value.len() == 4;
    let is_sequence = matches!(value, [0xfe, 0xff, 0, 0xe0, ..] | [0xff, 0xfe, 0xe0, 0, ..]);
    let is_text =
        value.iter().all(|byte| *byte >= b' ' || matches!(byte, 0 | b'\t' | b'\n' | b'\r' | 0x1b | 0x0c));
    is_length || is_sequence || is_text && (value.is_empty() || value[0] >= b' ')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn elements(big: bool, implicit: bool, all: &[(u32, &[u8; 2], &[u8])]) -> Vec<u8> {
        let short = |number: u16| if big { number.to_be_bytes() } else { number.to_le_bytes() };
        let mut bytes = Vec::new();
        for (tag, vr, value) in all {
            bytes.extend(short((tag >> 16) as u16));
            bytes.extend(short(*tag as u16));
            let length = value.len() as u32;
            if implicit {
                bytes.extend(if big { length.to_be_bytes() } else { length.to_le_bytes() });
            } else {
                bytes.extend(*vr);
                bytes.extend(short(length as u16));
            }
            bytes.extend(*value);
        }
        bytes
    }

    #[test]
    fn elements_in_any_order_of_bytes_are_recognised_without_a_mark() {
        for (big, implicit) in [(false, false), (false, true), (true, false), (true, true)] {
            let bytes = elements(
                big,
                implicit,
                &[
                    (0x0008_0008, b"CS", b"ORIGINAL"),
                    (0x0008_0016, b"UI", b"1.2.840.10"),
                    (0x0008_0060, b"CS", b"CT"),
                ],
            );
            assert!(is_dicom(&bytes, false), "{big} {implicit}");
            // One element alone might be anything.
            assert!(!is_dicom(&bytes[..20], false), "{big} {implicit}");
        }
        let group = elements(
            false,
            false,
            &[
                (0x0002_0000, b"UL", &[90, 0, 0, 0]),
                (0x0002_0002, b"UI", b"1.2."),
                (0x0002_0010, b"UI", b"1.2."),
            ],
        );
        assert!(is_dicom(&group, false));
        let old = elements(
            false,
            true,
            &[
                (0x0008_0000, b"  ", &[90, 0, 0, 0]),
                (0x0008_0001, b"  ", &[9, 9, 9, 0]),
                (0x0008_0010, b"  ", b"ACR-NEMA 2.0"),
            ],
        );
        assert!(is_dicom(&old, false));
    }

    #[test]
    fn what_is_no_dicom_is_not_taken_for_it() {
        let falling = elements(
            false,
            false,
            &[(0x0008_0060, b"CS", b"CT"), (0x0008_0016, b"UI", b"1.2."), (0x0008_0008, b"CS", b"AB")],
        );
        let odd = elements(
            false,
            true,
            &[(0x0008_0008, b"  ", b"abc"), (0x0008_0016, b"  ", b"a"), (0x0008_0060, b"  ", b"CT")],
        );
        for bytes in [falling, odd, b"\x08\0".to_vec(), b"\x08\0\x08\0CS".to_vec(), Vec::new()] {
            assert!(!is_dicom(&bytes, false), "{bytes:?}");
        }
        assert!(!is_dicom(b"# text of any kind, in which nothing is an element\n", false));
        assert!(
            !is_dicom(&[0; 1024], false)
                && !is_dicom(&[8; 1024], false)
                && !is_dicom(&[2, 0].repeat(400), false)
        );
        // Samples of 8 and 16 bits that begin like a tag, in ramps, steps and noise.
        let mut state = 7_u64;
        for seed in 0..4000_u64 {
            let mut noise = vec![8, 0, (seed % 97) as u8, 0];
            while noise.len() < 600 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let byte = (state >> 33) as u8;
                let small = if seed % 2 == 0 { byte % 40 } else { byte };
                noise.extend(if seed % 3 == 0 { vec![small, 0] } else { vec![small] });
            }
            assert!(!is_dicom(&noise, false), "{seed}: {noise:?}");
        }
        let ramp: Vec<u8> = (8_u16..500).flat_map(u16::to_le_bytes).collect();
        assert!(!is_dicom(&ramp, false));
    }
}
