//! What unpacks one frame: the packed bytes go in, its numbers come out, the least significant byte first.
//!
//! Size, channels and bits that a packed picture says it has are compared with the file's before a crate gets to see it: the
//! crates take memory by them.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::image::{Image, Kind};

/// What is wrong with a frame.
type Unpacked = Result<Vec<u8>, String>;

/// Runs of equal bytes: PackBits, as in PS3.5 annex G.
///
/// There is a run for each byte of each number, the most significant first.
pub(super) fn run_length(packed: &[u8], image: &Image) -> Unpacked {
    let (pixels, bytes, channels) =
        (image.pixels(), usize::from(image.bits.div_ceil(8)), usize::from(image.channels));
    let number = |index: usize| {
        packed.get(4 * index..4 * index + 4)?.try_into().ok().map(|bytes| u32::from_le_bytes(bytes) as usize)
    };
    let decoded = || {
        if number(0)? != bytes * channels {
            return None;
        }
        let mut frame = Vec::new();
        for run in 0..bytes * channels {
            let end = if run + 1 < bytes * channels { number(run + 2)? } else { packed.len() };
            let plane = unpacked_runs(packed.get(number(run + 1)?..end)?, pixels)?;
            if frame.is_empty() {
                frame.try_reserve_exact(pixels * bytes * channels).ok()?;
                frame.resize(pixels * bytes * channels, 0);
            }
            let (channel, byte) = (run / bytes, run % bytes);
            let place = frame.iter_mut().skip(channel * bytes + bytes - 1 - byte).step_by(bytes * channels);
            place.zip(plane).for_each(|(to, from)| *to = from);
        }
        Some(frame)
    };
    decoded().ok_or_else(|| "its runs do not make its pixels; the file is damaged".to_owned())
}

/// So many bytes out of runs.
fn unpacked_runs(mut runs: &[u8], count: usize) -> Option<Vec<u8>> {
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

/// JPEG: with loss in 8 bits, without in up to 16.
pub(super) fn jpeg(packed: &[u8], image: &Image) -> Unpacked {
    let start = begin(packed)?;
    let size = size_in_jpeg(
        packed,
        |marker| matches!(marker, 0xc0..=0xcf if ![0xc4, 0xc8, 0xcc].contains(&marker)),
    )?;
    size.check(image)?;
    let is_lossless = matches!(size.marker, 0xc3 | 0xc7 | 0xcb | 0xcf);
    if !is_lossless && size.bits > 8 {
        return Err(format!(
            "JPEG of {} bits with loss is not read; unpack it with `dcmdjpeg IN OUT` or `gdcmconv --raw IN OUT`",
            size.bits
        ));
    }
    let mut decoder = jpeg_decoder::Decoder::new(&packed[start..]);
    // What the colours are, DICOM says; but a file of JFIF has these and no others.
    let is_jfif = packed.windows(5).take(64).any(|window| window == b"JFIF\0");
    if image.channels == 3 {
        let is_rgb = image.kind() == Kind::Rgb && !is_jfif;
        decoder.set_color_transform(if is_rgb {
            jpeg_decoder::ColorTransform::RGB
        } else {
            jpeg_decoder::ColorTransform::YCbCr
        });
    }
    let bytes = guarded(|| decoder.decode().map_err(|error| error.to_string()))?;
    let numbers = image.pixels() * usize::from(image.channels);
    let values: Vec<i32> = if bytes.len() == 2 * numbers {
        bytes.as_chunks().0.iter().map(|bytes| u16::from_ne_bytes(*bytes).into()).collect()
    } else {
        bytes.into_iter().map(i32::from).collect()
    };
    in_bytes(&values, image)
}

/// JPEG-LS of one number a pixel, with or without loss.
pub(super) fn jpeg_ls(packed: &[u8], image: &Image) -> Unpacked {
    let start = begin(packed)?;
    let size = size_in_jpeg(packed, |marker| marker == 0xf7)?;
    size.check(image)?;
    if image.channels != 1 {
        return Err("JPEG-LS of colours is not read; unpack it with `dcmdjpls IN OUT`".to_owned());
    }
    let [columns, rows] = [image.columns, image.rows].map(u32::from);
    let decode = || jpegls::decode(&packed[start..], columns, rows).map_err(|error| error.to_string());
    let (values, ..) = guarded(decode)?;
    in_bytes(&values.into_iter().map(i32::from).collect::<Vec<i32>>(), image)
}

/// JPEG 2000, with or without loss, in the older and in the high-throughput form.
pub(super) fn jpeg_2000(packed: &[u8], image: &Image) -> Unpacked {
    // Its own header stands in a box of the form with boxes.
    let at = packed.windows(4).position(|window| window == [0xff, 0x4f, 0xff, 0x51]);
    let codestream =
        at.map(|at| &packed[at..]).ok_or("it does not begin as JPEG 2000 does; the file is damaged")?;
    check_jpeg_2000(codestream, image)?;
    let decode = || {
        let decoded = jpeg2k::Image::from_bytes(codestream).map_err(|error| error.to_string())?;
        let components = decoded.components();
        if components.iter().any(|component| component.data().len() != image.pixels()) {
            return Err("its components differ in size".to_owned());
        }
        let mut values = Vec::new();
        values.try_reserve_exact(image.pixels() * components.len()).map_err(|error| error.to_string())?;
        for pixel in 0..image.pixels() {
            values.extend(components.iter().map(|component| component.data()[pixel]));
        }
        Ok(values)
    };
    in_bytes(&guarded(decode)?, image)
}

/// What JPEG 2000 says of itself, before anything is taken by it: PS 15444-1 annex A.5.1.
fn check_jpeg_2000(codestream: &[u8], image: &Image) -> Result<(), String> {
    let number = |at: usize| {
        let bytes = codestream.get(at..at + 4)?;
        Some(u64::from(u32::from_be_bytes(bytes.try_into().ok()?)))
    };
    let read = || {
        let [right, bottom, left, top] = [number(8)?, number(12)?, number(16)?, number(20)?];
        let [tile_columns, tile_rows] = [number(24)?, number(28)?];
        let [tile_left, tile_top] = [number(32)?, number(36)?];
        let channels = u16::from_be_bytes(codestream.get(40..42)?.try_into().ok()?);
        let components = codestream.get(42..42 + 3 * usize::from(channels))?;
        let size = Size {
            marker: 0,
            columns: right.checked_sub(left)?,
            rows: bottom.checked_sub(top)?,
            channels,
            bits: u16::from(components.first()? & 0x7f) + 1,
        };
        let tiles = right.checked_sub(tile_left)?.div_ceil(tile_columns.max(1))
            * bottom.checked_sub(tile_top)?.div_ceil(tile_rows.max(1));
        let is_whole = components.as_chunks().0.iter().all(|&[_, x, y]| x == 1 && y == 1);
        Some((size, tiles, is_whole))
    };
    let (size, tiles, is_whole) = read().ok_or("its header is cut off; the file is damaged")?;
    size.check(image)?;
    // A tile has a header of 14 bytes, even an empty one.
    if tiles > codestream.len() as u64 / 14 {
        return Err(format!("{} bytes cannot hold its {tiles} tiles; the file is damaged", codestream.len()));
    }
    if !is_whole {
        return Err("its components differ in size; unpack it with `gdcmconv --raw IN OUT`".to_owned());
    }
    Ok(())
}

/// What a packed picture says of itself.
struct Size {
    marker: u8,
    columns: u64,
    rows: u64,
    channels: u16,
    bits: u16,
}

impl Size {
    /// Compares it with what the file says.
    fn check(&self, image: &Image) -> Result<(), String> {
        let own = (self.columns, self.rows, self.channels);
        let (columns, rows, channels) = (image.columns.into(), image.rows.into(), image.channels);
        if own != (columns, rows, channels) {
            return Err(format!(
                "it has {} x {} pixels of {}, the header {columns} x {rows} of {channels}; the file is damaged",
                self.columns, self.rows, self.channels
            ));
        }
        if self.bits > image.bits {
            return Err(format!(
                "its pixels have {} bits, and {} are allocated; the file is damaged",
                self.bits, image.bits
            ));
        }
        Ok(())
    }
}

/// Where a picture of JPEG begins: some programs put a byte or two before it.
fn begin(packed: &[u8]) -> Result<usize, String> {
    let at = packed.windows(3).take(16).position(|window| window == [0xff, 0xd8, 0xff]);
    at.ok_or_else(|| "it does not begin as JPEG does; the file is damaged".to_owned())
}

/// The frame's header among the segments of JPEG.
fn size_in_jpeg(packed: &[u8], is_frame: impl Fn(u8) -> bool) -> Result<Size, String> {
    let find = || {
        let mut rest = packed.get(begin(packed).ok()? + 2..)?;
        loop {
            // Any number of these may stand before a mark.
            let marks = rest.iter().position(|byte| *byte != 0xff)?;
            if marks == 0 {
                return None;
            }
            let (marker, segment) = (*rest.get(marks)?, rest.get(marks + 1..)?);
            if marker == 0xda || marker == 0xd9 {
                return None;
            }
            let length = usize::from(u16::from_be_bytes(*segment.first_chunk()?));
            if is_frame(marker) {
                let &[bits, a, b, c, d, channels] = segment.get(2..8)? else { return None };
                let [rows, columns] = [[a, b], [c, d]].map(|side| u64::from(u16::from_be_bytes(side)));
                return Some(Size { marker, columns, rows, channels: channels.into(), bits: bits.into() });
            }
            rest = segment.get(length.max(2)..)?;
        }
    };
    find().ok_or_else(|| "it has no header of its own; the file is damaged".to_owned())
}

/// Runs a crate on bytes that anybody may have damaged: it may refuse them by a panic.
fn guarded<T>(decode: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    let problem = match decoded {
        Ok(Ok(decoded)) => return Ok(decoded),
        Ok(Err(problem)) => problem,
        Err(_) => "its bytes make no sense".to_owned(),
    };
    let problem: String = problem.chars().take(120).map(|c| if c.is_control() { ' ' } else { c }).collect();
    Err(format!("{}; the file is damaged", problem.trim()))
}

/// Numbers in the bytes that the file allots to each.
fn in_bytes(values: &[i32], image: &Image) -> Unpacked {
    if values.len() != image.pixels() * usize::from(image.channels) {
        return Err("it has another number of pixels than its header says; the file is damaged".to_owned());
    }
    let bytes = usize::from(image.bits.div_ceil(8));
    let mut out = Vec::new();
    out.try_reserve_exact(bytes * values.len()).map_err(|error| error.to_string())?;
    for value in values {
        out.extend(&value.to_le_bytes()[..bytes]);
    }
    Ok(out)
}
