//! The pixels of a DICOM file.

use std::{io::Cursor, path::Path};

use super::{
    SourceError,
    elements::{Element, Elements},
    header::{Header, unsupported},
};
use crate::sources::{
    pick::Pick,
    pieces::append,
    stored::{Stored, StoredFormat},
    stream::{Packing, SampleStream, Surplus, mend_by_header},
    volume::{Endian, checked_bytes},
};

/// The beginning and the end of a run of items.
const ITEM: u32 = 0xfffe_e000;
const ITEM_BIG: u32 = 0xe000_fffe;

/// The type of a file's pixels.
pub(super) fn format(header: &Header) -> StoredFormat {
    match (header.is_float, header.bits, header.signed) {
        (true, 32, _) => StoredFormat::F32,
        (true, ..) => StoredFormat::F64,
        (_, 8, false) => StoredFormat::U8,
        (_, 8, true) => StoredFormat::I8,
        (_, 16, false) => StoredFormat::U16,
        (_, 16, true) => StoredFormat::I16,
        (.., false) => StoredFormat::U32,
        (.., true) => StoredFormat::I32,
    }
}

/// Reads the pixels of all frames of a file.
pub(super) fn read(path: &Path, notes: &mut Vec<String>) -> Result<Stored, SourceError> {
    let (header, mut elements, element) = Header::read_up_to_pixels(path)?;
    if let Some(compression) = header.syntax.compression() {
        let found = format!("its pixels are compressed by {compression} ({})", header.syntax.uid);
        return Err(unsupported(path, &found, "unpack it with `gdcmconv --raw IN OUT` or `dcmdjpeg IN OUT`"));
    }
    let format = format(&header);
    let size = [header.columns.into(), header.rows.into(), u32::try_from(header.frames).unwrap_or(u32::MAX)];
    let layout = |problem| SourceError::Layout { path: path.to_owned(), problem };
    let bytes = checked_bytes(size, format.bytes()).map_err(layout)?;
    let stream = SampleStream {
        path,
        what: format!("{} x {} pixels of {} bytes in {} frames", size[0], size[1], format.bytes(), size[2]),
        samples: bytes / format.bytes(),
        pick: Pick::ALL,
        format,
        endian: if header.syntax.big_endian { Endian::Big } else { Endian::Little },
        packing: Packing::Unpacked,
        offset: 0,
        skip: 0,
        surplus: Surplus::Ignore,
        mend: &mend_by_header,
        hint: "",
    };
    let mut stored = match element.length {
        None => runs(&stream, &header, &mut elements)?,
        Some(length) => {
            if u64::from(length) < bytes {
                return Err(stream.length_error(length.into(), false, ""));
            }
            plain(&stream, &element, elements, notes)?
        }
    };
    keep_stored_bits(&mut stored, &header);
    Ok(stored)
}

fn plain(
    stream: &SampleStream,
    element: &Element,
    elements: Elements,
    notes: &mut Vec<String>,
) -> Result<Stored, SourceError> {
    let mut stored = stream.read_from(elements.reader, notes)?;
    // Words of two pixels: their bytes are the other way round.
    if let (Stored::U8(pixels), Endian::Big, b"OW") = (&mut stored, stream.endian, &element.vr) {
        pixels.chunks_exact_mut(2).for_each(|word| word.swap(0, 1));
    }
    Ok(stored)
}

/// Reads frames that are coded in runs of equal bytes, one item each.
fn runs(stream: &SampleStream, header: &Header, elements: &mut Elements) -> Result<Stored, SourceError> {
    if !header.syntax.is_rle() {
        return Err(elements.error("pixels in items, though nothing says that they are compressed"));
    }
    let pixels = usize::from(header.columns) * usize::from(header.rows);
    let frame = SampleStream { samples: pixels as u64, ..stream.clone() };
    let mut all = stream.format.none();
    // The first item is a table of where the others are.
    item(elements)?;
    for _ in 0..header.frames {
        let item = item(elements)?.ok_or_else(|| elements.error("fewer frames than the header says"))?;
        let bytes = decoded(&item, pixels, stream.format.bytes() as usize);
        let bytes = bytes.ok_or_else(|| elements.error("the runs of a frame do not make its pixels"))?;
        let samples = frame.read_from(Cursor::new(bytes), &mut Vec::new())?;
        append(&mut all, samples).ok_or_else(|| stream.out_of_memory())?;
    }
    Ok(all)
}

/// The bytes of the next item; `None` if there is none.
fn item(elements: &mut Elements) -> Result<Option<Vec<u8>>, SourceError> {
    let tag = elements.u32()?;
    let length = elements.u32()?;
    // Two numbers of 16 bits, seen as one of 32.
    if ![ITEM, ITEM_BIG].contains(&tag) {
        return Ok(None);
    }
    let bytes = elements.take(length.into())?;
    if bytes.len() < length as usize {
        return Err(elements.error("the file ends within a frame; it is cut off"));
    }
    Ok(Some(bytes))
}

/// The pixels of a frame, the least significant byte first, from a run for each byte, the most significant first.
fn decoded(item: &[u8], pixels: usize, bytes: usize) -> Option<Vec<u8>> {
    let number = |index: usize| {
        item.get(4 * index..4 * index + 4)?.try_into().ok().map(|bytes| u32::from_le_bytes(bytes) as usize)
    };
    if number(0)? != bytes {
        return None;
    }
    let mut frame = Vec::new();
    for run in 0..bytes {
        let end = if run + 1 < bytes { number(run + 2)? } else { item.len() };
        let plane = unpacked(item.get(number(run + 1)?..end)?, pixels)?;
        if frame.is_empty() {
            frame.try_reserve_exact(pixels * bytes).ok()?;
            frame.resize(pixels * bytes, 0);
        }
        let place = frame.iter_mut().skip(bytes - 1 - run).step_by(bytes);
        place.zip(plane).for_each(|(to, from)| *to = from);
    }
    Some(frame)
}

/// So many bytes out of runs: PackBits, as in PS3.5 annex G.
fn unpacked(mut runs: &[u8], count: usize) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    while bytes.len() < count {
        let (&control, rest) = runs.split_first()?;
        match control {
            0..128 => {
                let literal = rest.split_at_checked(usize::from(control) + 1)?;
                bytes.extend(literal.0);
                runs = literal.1;
            }
            128 => runs = rest,
            129.. => {
                let (&value, rest) = rest.split_first()?;
                bytes.resize(bytes.len() + 257 - usize::from(control), value);
                runs = rest;
            }
        }
    }
    bytes.truncate(count);
    Some(bytes)
}

/// Clears bits that are not part of a pixel, and spreads the sign over them.
fn keep_stored_bits(stored: &mut Stored, header: &Header) {
    if header.is_float || header.stored_bits == header.bits {
        return;
    }
    let up = u32::from(header.bits - 1 - header.high_bit);
    let down = u32::from(header.bits - header.stored_bits);
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
