//! Frames in items of packed bytes.

use std::path::Path;

use super::{
    SourceError, codecs,
    elements::{Elements, ITEM},
    header::Header,
    pixels::of_bytes,
    syntax::Codec,
};
use crate::sources::{file, pieces::append, stored::Stored, stream::SampleStream};

/// Bytes that one byte of a file may become: far more than any picture is packed by that shows something.
const MAX_RATIO: u64 = 1024;

/// An item: its place behind the first item, and its bytes.
type Fragment = (u64, Vec<u8>);

/// Reads the frames of a file whose pixels are in items.
pub(super) fn read(
    path: &Path,
    whole: &SampleStream,
    header: &Header,
    elements: &mut Elements,
) -> Result<Stored, SourceError> {
    let (_, file_bytes) = file::open(path)?;
    let bytes = whole.samples * whole.format.bytes();
    let fragments = fragments(elements, header)?;
    if bytes > MAX_RATIO * file_bytes.max(1 << 10) {
        return Err(elements.error(&format!(
            "{file_bytes} bytes cannot hold {}; the file is cut off, or its header is wrong",
            whole.what
        )));
    }
    let image = &header.image;
    let numbers = image.pixels() * usize::from(image.channels);
    let frame = SampleStream { samples: numbers as u64, ..whole.clone() };
    let mut all = whole.format.none();
    for (index, packed) in fragments.into_iter().enumerate() {
        let packed = packed.concat();
        let unpacked = match header.syntax.codec {
            Codec::Plain => Ok(packed),
            Codec::RunLength => codecs::run_length(&packed, image),
            Codec::Jpeg => codecs::jpeg(&packed, image),
            Codec::JpegLs => codecs::jpeg_ls(&packed, image),
            Codec::Jpeg2000 => codecs::jpeg_2000(&packed, image),
            Codec::Other(mend) => Err(mend.to_owned()),
        };
        let unpacked = unpacked.map_err(|problem| SourceError::Field {
            path: path.to_owned(),
            field: format!("frame {} of {} ({})", index + 1, header.frames, header.syntax.name),
            problem,
        })?;
        let samples = of_bytes(&frame, unpacked)?;
        append(&mut all, samples).ok_or_else(|| whole.out_of_memory())?;
    }
    Ok(all)
}

/// The fragments of each frame.
fn fragments(elements: &mut Elements, header: &Header) -> Result<Vec<Vec<Vec<u8>>>, SourceError> {
    let table = item(elements)?.unwrap_or_default();
    let mut fragments: Vec<Fragment> = Vec::new();
    let mut place = 0;
    while let Some(bytes) = item(elements)? {
        let length = bytes.len() as u64;
        fragments.push((place, bytes));
        place += 8 + length;
    }
    let frames = header.frames;
    let only = |fragments: Vec<Fragment>| fragments.into_iter().map(|(_, bytes)| vec![bytes]).collect();
    if fragments.len() == frames {
        return Ok(only(fragments));
    }
    if fragments.len() < frames {
        return Err(elements.error(&format!(
            "fewer frames than the header says: {} items for {frames}; the file is cut off",
            fragments.len()
        )));
    }
    if frames == 1 {
        return Ok(vec![fragments.into_iter().map(|(_, bytes)| bytes).collect()]);
    }
    let mut starts: Vec<u64> =
        table.as_chunks().0.iter().map(|bytes| u64::from(u32::from_le_bytes(*bytes))).collect();
    if starts.len() != frames {
        starts =
            header.extended_offsets.as_chunks().0.iter().map(|bytes| u64::from_le_bytes(*bytes)).collect();
    }
    if starts.len() != frames {
        starts =
            fragments.iter().filter(|(_, bytes)| begins_picture(bytes)).map(|(place, _)| *place).collect();
    }
    let in_order = starts.len() == frames && starts.is_sorted() && starts.first() == Some(&0);
    let mut grouped: Vec<Vec<Vec<u8>>> = Vec::new();
    for (place, bytes) in fragments {
        if grouped.is_empty() || starts.binary_search(&place).is_ok() {
            grouped.push(Vec::new());
        }
        if let Some(frame) = grouped.last_mut() {
            frame.push(bytes);
        }
    }
    if !in_order || grouped.len() != frames {
        return Err(elements.error(&format!(
            "{} items make no {frames} frames, and no table says which belong together; the file is damaged",
            grouped.iter().map(Vec::len).sum::<usize>()
        )));
    }
    Ok(grouped)
}

/// Whether bytes begin as a picture of JPEG, JPEG-LS or JPEG 2000 does.
fn begins_picture(bytes: &[u8]) -> bool {
    matches!(bytes, [0xff, 0xd8, 0xff, ..] | [0xff, 0x4f, 0xff, 0x51, ..] | [0, 0, 0, 12, b'j', b'P', ..])
}

/// The bytes of the next item; `None` if there is none.
fn item(elements: &mut Elements) -> Result<Option<Vec<u8>>, SourceError> {
    // A file may end with its last item: its mark is missing then, and all that is needed is there.
    let begin = elements.take(4)?;
    let &[a, b, c, d] = begin.as_slice() else { return Ok(None) };
    let tag = u32::from(elements.u16([a, b])) << 16 | u32::from(elements.u16([c, d]));
    if tag != ITEM {
        return Ok(None);
    }
    let length = elements.u32()?;
    let bytes = elements.take(length.into())?;
    if bytes.len() < length as usize {
        return Err(elements.error("the file ends within a frame; it is cut off"));
    }
    Ok(Some(bytes))
}
