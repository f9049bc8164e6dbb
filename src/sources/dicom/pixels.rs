//! The pixels of a DICOM file.

use std::{io::Cursor, path::Path};

use super::{
    SourceError, colour,
    elements::{Element, Elements},
    encapsulated,
    header::{Header, unsupported},
    image::{Image, Kind},
    syntax::Codec,
};
use crate::sources::{
    pick::Pick,
    pieces,
    stored::{Stored, StoredFormat},
    stream::{Packing, SampleStream, Surplus, mend_by_header},
    volume::{Endian, checked_bytes},
};

/// Frames one after the other.
#[derive(Debug)]
pub(super) enum Pixels {
    /// One value a pixel.
    Values(Stored),
    /// Red, green, blue and opacity, as sRGB.
    Colours(Vec<[u8; 4]>),
}

impl Pixels {
    /// Some pixels of all; `None` if there are fewer.
    pub fn slice(&self, start: usize, count: usize) -> Option<Self> {
        match self {
            Self::Values(values) => pieces::slice(values, start, count).map(Self::Values),
            Self::Colours(colours) => {
                Some(Self::Colours(colours.get(start..start.checked_add(count)?)?.to_vec()))
            }
        }
    }

    /// Adds pixels of the same kind; `None` if there is no memory for them.
    pub fn append(&mut self, more: Self) -> Option<()> {
        match (self, more) {
            (Self::Values(all), Self::Values(more)) => pieces::append(all, more),
            (Self::Colours(all), Self::Colours(more)) => {
                all.try_reserve(more.len()).ok()?;
                all.extend(more);
                Some(())
            }
            _ => None,
        }
    }

    /// How many pixels there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Values(values) => crate::sources::stored::with_samples!(values, samples => samples.len()),
            Self::Colours(colours) => colours.len(),
        }
    }
}

/// Reads the pixels of all frames of a file.
pub(super) fn read(path: &Path, notes: &mut Vec<String>) -> Result<Pixels, SourceError> {
    let (header, mut elements, element) = Header::read_up_to_pixels(path)?;
    if let Codec::Other(mend) = header.syntax.codec {
        let found = format!("its pixels are packed by {} ({})", header.syntax.name, header.syntax.uid);
        return Err(unsupported(path, &found, mend));
    }
    let stream = stream(path, &header)?;
    let mut stored = match element.length {
        None => encapsulated::read(path, &stream, &header, &mut elements)?,
        Some(length) => {
            let mut needed = stream.samples * stream.format.bytes();
            if header.image.bits == 1 {
                needed = needed.div_ceil(8);
            } else if header.image.is_halved() {
                needed = needed / 3 * 2;
            }
            if header.syntax.codec != Codec::Plain {
                return Err(elements.error("packed pixels that are not in items; the file is damaged"));
            }
            if u64::from(length) < needed {
                let plain = SampleStream { samples: needed / stream.format.bytes(), ..stream };
                return Err(plain.length_error(length.into(), false, ""));
            }
            plain(stream, &element, elements, &header, notes)?
        }
    };
    header.image.keep_stored_bits(&mut stored);
    match header.image.kind() {
        Kind::Value => Ok(Pixels::Values(stored)),
        Kind::Palette => header.palette.colours(path, &stored, header.image.signed).map(Pixels::Colours),
        _ => colour::of(path, &stored, &header.image, &header.syntax).map(Pixels::Colours),
    }
}

/// The numbers of all frames, each pixel's next to each other, and how they are stored.
fn stream<'a>(path: &'a Path, header: &Header) -> Result<SampleStream<'a>, SourceError> {
    let Image { columns, rows, channels, .. } = header.image;
    let format = header.image.format();
    let size = [columns.into(), rows.into(), u32::try_from(header.frames).unwrap_or(u32::MAX)];
    let layout = |problem| SourceError::Layout { path: path.to_owned(), problem };
    let bytes = checked_bytes(size, format.bytes() * u64::from(channels)).map_err(layout)?;
    let colours = if channels == 1 { String::new() } else { format!("{channels} x ") };
    Ok(SampleStream {
        path,
        what: if header.image.bits == 1 {
            format!("{} x {} pixels of 1 bit in {} frames", size[0], size[1], size[2])
        } else {
            format!(
                "{} x {} pixels of {colours}{} bytes in {} frames",
                size[0],
                size[1],
                format.bytes(),
                size[2]
            )
        },
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
    })
}

fn plain(
    stream: SampleStream,
    element: &Element,
    elements: Elements,
    header: &Header,
    notes: &mut Vec<String>,
) -> Result<Stored, SourceError> {
    let wanted = stream.samples as usize;
    let mut stream = stream;
    if header.image.bits == 1 {
        stream = SampleStream { samples: stream.samples.div_ceil(8), format: StoredFormat::U8, ..stream };
    } else if header.image.is_halved() {
        stream.samples = stream.samples / 3 * 2;
    }
    let mut stored = stream.read_from(elements.reader, notes)?;
    // Words of two pixels: their bytes are the other way round.
    let in_words = &element.vr == b"OW" && stream.endian == Endian::Big;
    if let (true, Stored::U8(pixels)) = (in_words, &mut stored) {
        pixels.chunks_exact_mut(2).for_each(|word| word.swap(0, 1));
    }
    match stored {
        Stored::U8(bytes) if header.image.bits == 1 => bits(&bytes, wanted)
            .map(Stored::U8)
            .ok_or_else(|| SourceError::OutOfMemory { path: stream.path.to_owned(), bytes: wanted as u64 }),
        stored if header.image.is_halved() => Ok(colour::whole(&stored)),
        stored if header.image.planar && header.image.channels > 1 => {
            Ok(colour::interleaved(&stored, header.image.pixels()))
        }
        stored => Ok(stored),
    }
}

/// Pixels of one bit, the lowest of a byte first, across the borders of frames.
fn bits(bytes: &[u8], count: usize) -> Option<Vec<u8>> {
    let mut pixels = Vec::new();
    pixels.try_reserve_exact(count).ok()?;
    pixels.extend((0..count).map(|pixel| bytes[pixel / 8] >> (pixel % 8) & 1));
    Some(pixels)
}

/// Samples of one frame out of bytes, the least significant first.
pub(super) fn of_bytes(frame: &SampleStream, bytes: Vec<u8>) -> Result<Stored, SourceError> {
    frame.read_from(Cursor::new(bytes), &mut Vec::new())
}
