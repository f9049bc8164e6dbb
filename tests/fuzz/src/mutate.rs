//! Changes to files of the kinds that are found: fields of headers, numbers, sizes, encodings and ends.

use crate::seeds::Seed;
use fastrand::Rng;
use std::ops::Range;

/// Numbers at which readers stumble.
const NUMBERS: [&str; 22] = [
    "0",
    "-1",
    "1",
    "2",
    "255",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "99999999999999999999",
    "1e30",
    "-1e39",
    "1e-45",
    "nan",
    "inf",
    "1,5",
    "0x10",
    "",
    "1 1",
];

/// Bytes that change what comes after them.
const MARKS: [&[u8]; 10] =
    [b"\xef\xbb\xbf", b"\xff\xfe", b"\x1f\x8b\x08", b"\r\n", b"\r", b"\0", b"\n\n", b"\"", b"\x1b[31m", b"("];

/// The longest file that is made: what is larger takes longer, and breaks no more.
const LONGEST: usize = 1 << 17;

/// A seed with a few changes.
pub fn mutated(rng: &mut Rng, seed: &Seed, all: &[Seed]) -> Vec<u8> {
    let mut bytes = seed.bytes.clone();
    for _ in 0..1 + rng.u32(..4).min(rng.u32(..4)) {
        change(rng, &mut bytes, all);
        bytes.truncate(LONGEST);
    }
    bytes
}

fn change(rng: &mut Rng, bytes: &mut Vec<u8>, all: &[Seed]) {
    if bytes.is_empty() {
        bytes.extend_from_slice(MARKS[rng.usize(..MARKS.len())]);
        return;
    }
    match rng.u32(..12) {
        // One bit, one byte.
        0 => *at(rng, bytes) ^= 1 << rng.u32(..8),
        1 => *at(rng, bytes) = rng.u8(..),
        // A number of 8 to 64 bits.
        2 | 3 => binary_number(rng, bytes),
        // A number in text.
        4 | 5 => {
            if let Some(number) = a_number(rng, bytes) {
                bytes.splice(number, NUMBERS[rng.usize(..NUMBERS.len())].bytes());
            }
        }
        // Lines, or records: gone, twice, elsewhere.
        6 => {
            let line = a_line(rng, bytes);
            bytes.drain(line);
        }
        7 => {
            let line = a_line(rng, bytes);
            let text = bytes[line.clone()].to_vec();
            let times = 1 + rng.usize(..20);
            bytes.splice(line.start..line.start, text.repeat(times));
        }
        8 => {
            let line = a_line(rng, bytes);
            let text: Vec<u8> = bytes.drain(line).collect();
            let place = rng.usize(..=bytes.len());
            bytes.splice(place..place, text);
        }
        // The end, of which nobody knows where it is.
        9 => bytes.truncate(rng.usize(..bytes.len())),
        // An encoding, a packing, a bracket.
        10 => {
            let place = if rng.bool() { 0 } else { rng.usize(..=bytes.len()) };
            bytes.splice(place..place, MARKS[rng.usize(..MARKS.len())].iter().copied());
        }
        // A piece of another file.
        _ => {
            let other = &all[rng.usize(..all.len())].bytes;
            let piece = a_piece(rng, other);
            let place = a_piece(rng, bytes);
            bytes.splice(place, other[piece].iter().copied());
        }
    }
}

fn at<'a>(rng: &mut Rng, bytes: &'a mut [u8]) -> &'a mut u8 {
    let index = near_the_beginning(rng, bytes.len());
    &mut bytes[index]
}

/// An index: headers are where mistakes are.
fn near_the_beginning(rng: &mut Rng, length: usize) -> usize {
    if rng.bool() { rng.usize(..length.min(400)) } else { rng.usize(..length) }
}

fn binary_number(rng: &mut Rng, bytes: &mut [u8]) {
    let size = [1, 2, 4, 8][rng.usize(..4)].min(bytes.len());
    let start = near_the_beginning(rng, bytes.len()).min(bytes.len() - size);
    let number = match rng.u32(..6) {
        0 => 0,
        1 => u64::MAX,
        2 => 1 << rng.u32(..64),
        3 => (1 << rng.u32(..64)) - 1,
        4 => u64::from(f32::NAN.to_bits()),
        _ => rng.u64(..300),
    };
    let mut encoded = number.to_le_bytes();
    if rng.bool() {
        encoded[..size].reverse();
    }
    bytes[start..start + size].copy_from_slice(&encoded[..size]);
}

/// Where a number in text stands, the first one behind some place.
fn a_number(rng: &mut Rng, bytes: &[u8]) -> Option<Range<usize>> {
    let from = near_the_beginning(rng, bytes.len());
    let is_part = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+' | b'e' | b'E');
    let start = from + bytes[from..].iter().position(u8::is_ascii_digit)?;
    let length = bytes[start..].iter().take(30).take_while(|byte| is_part(byte)).count();
    Some(start..start + length)
}

/// Where a line stands; in binary files whatever is between two bytes that would end one.
fn a_line(rng: &mut Rng, bytes: &[u8]) -> Range<usize> {
    let place = near_the_beginning(rng, bytes.len());
    let start = bytes[..place].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let end =
        bytes[place..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |end| place + end + 1);
    start..end.min(start + 4096)
}

fn a_piece(rng: &mut Rng, bytes: &[u8]) -> Range<usize> {
    if bytes.is_empty() {
        return 0..0;
    }
    let start = near_the_beginning(rng, bytes.len());
    start..(start + rng.usize(..200)).min(bytes.len())
}
