//! A walk over the elements of a DICOM file, up to its pixels.

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Cursor, Read, Seek, SeekFrom},
    path::{Path, PathBuf},
};

use flate2::bufread::DeflateDecoder;

use super::{MAGIC, MAGIC_AT, SourceError, file};

/// The longest value that is kept, in bytes.
const MAX_VALUE: u64 = 1 << 16;

/// How deep sequences may lie in each other.
const MAX_DEPTH: usize = 32;

/// The length of what ends with a mark of its own.
const UNDEFINED: u32 = u32::MAX;

/// How the file is written, by its UID.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Syntax {
    /// What the file calls it.
    pub uid: String,
    /// Whether the most significant byte comes first.
    pub big_endian: bool,
    /// Whether elements do not say their type.
    implicit: bool,
    /// Whether all behind the first group is one deflate stream.
    pub deflated: bool,
}

impl Syntax {
    fn of(uid: &str) -> Self {
        let is = |last: &str| uid.strip_prefix("1.2.840.10008.1.2") == Some(last);
        Self { uid: uid.to_owned(), big_endian: is(".2"), implicit: is(""), deflated: is(".1.99") }
    }

    /// Whether pixels are coded in runs of equal bytes.
    pub fn is_rle(&self) -> bool {
        self.uid == "1.2.840.10008.1.2.5"
    }

    /// The compression of pixels that are not read; `None` for those that are.
    pub fn compression(&self) -> Option<&str> {
        match self.uid.strip_prefix("1.2.840.10008.1.2")? {
            "" | ".1" | ".1.99" | ".2" | ".5" => None,
            ".4.50" | ".4.51" => Some("JPEG"),
            ".4.57" | ".4.70" => Some("lossless JPEG"),
            ".4.80" | ".4.81" => Some("JPEG-LS"),
            ".4.90" | ".4.91" | ".4.92" | ".4.93" => Some("JPEG 2000"),
            ".4.201" | ".4.202" | ".4.203" => Some("high-throughput JPEG 2000"),
            ".4.110" | ".4.111" | ".4.112" => Some("JPEG XL"),
            _ => Some("a compression"),
        }
    }
}

/// One element.
#[derive(Debug)]
pub(super) struct Element {
    /// Group and number: 0x7fe00010.
    pub tag: u32,
    /// Its type, as two letters; spaces where the file does not say.
    pub vr: [u8; 2],
    /// Bytes of its value; `None` if it ends with a mark.
    pub length: Option<u32>,
    /// The outermost sequence that it is in.
    pub root: Option<u32>,
    /// Its value; empty for pixels, which are next to be read.
    pub value: Vec<u8>,
}

/// A sequence or an item that has begun.
struct Open {
    tag: u32,
    /// Where it ends; `None` if a mark says so.
    end: Option<u64>,
    /// Whether elements around it do not say their type.
    outside_implicit: bool,
    /// Whether its items are bytes, no elements.
    is_bytes: bool,
}

/// The elements of a file.
pub(super) struct Elements {
    path: PathBuf,
    /// Where the next element is.
    pub reader: Box<dyn BufRead>,
    /// Bytes that were read of it already; none once the first group is over.
    ahead: Vec<u8>,
    /// Bytes that were used of the file or, if it is deflated, of what came out.
    pub position: u64,
    /// How it is written.
    pub syntax: Syntax,
    open: Vec<Open>,
}

impl Elements {
    /// Opens a file and reads its first group, which says how the others are written.
    pub fn open(path: &Path) -> Result<Self, SourceError> {
        let (mut file, _) = file::open(path)?;
        let start = if Self::has_magic(path, &mut file)? { (MAGIC_AT + MAGIC.len()) as u64 } else { 0 };
        file.seek(SeekFrom::Start(start)).map_err(|cause| file::io_error(path, cause))?;
        let mut elements = Self {
            path: path.to_owned(),
            reader: Box::new(BufReader::new(file)),
            ahead: Vec::new(),
            position: start,
            syntax: Syntax::of("1.2.840.10008.1.2.1"),
            open: Vec::new(),
        };
        let mut uid = None;
        elements.look_ahead()?;
        while elements.ahead.get(..2) == Some(&[2, 0]) {
            let begin = elements.take(4)?;
            let (_, length) = elements.type_and_length()?;
            if begin == [2, 0, 0x10, 0] && u64::from(length) <= MAX_VALUE {
                uid = Some(super::header::text(&elements.take(length.into())?));
            } else {
                elements.skip(length.into())?;
            }
            elements.look_ahead()?;
        }
        // Files of before the first group existed write types or not: letters stand where the type would.
        let says_types = elements.ahead.get(4..6).is_some_and(|vr| vr.iter().all(u8::is_ascii_uppercase));
        let guess = if says_types { "1.2.840.10008.1.2.1" } else { "1.2.840.10008.1.2" };
        elements.syntax = Syntax::of(uid.as_deref().unwrap_or(guess));
        let ahead = Cursor::new(std::mem::take(&mut elements.ahead));
        let rest = std::mem::replace(&mut elements.reader, Box::new(io::empty()));
        elements.reader = Box::new(ahead.chain(rest));
        if elements.syntax.deflated {
            let packed = std::mem::replace(&mut elements.reader, Box::new(io::empty()));
            elements.reader = Box::new(BufReader::new(DeflateDecoder::new(packed)));
        }
        Ok(elements)
    }

    fn has_magic(path: &Path, file: &mut File) -> Result<bool, SourceError> {
        let mut head = Vec::new();
        let read = file.take((MAGIC_AT + MAGIC.len()) as u64).read_to_end(&mut head);
        read.map_err(|cause| file::io_error(path, cause))?;
        Ok(head.get(MAGIC_AT..) == Some(MAGIC))
    }

    /// The next element that is `wanted`, or the pixels; `None` at the end.
    pub fn next(&mut self, wanted: impl Fn(u32) -> bool) -> Result<Option<Element>, SourceError> {
        loop {
            while let Some(open) = self.open.pop_if(|open| open.end.is_some_and(|end| self.position >= end)) {
                self.syntax.implicit = open.outside_implicit;
            }
            let begin = self.take(4)?;
            let &[a, b, c, d] = begin.as_slice() else { return Ok(None) };
            let tag = u32::from(self.u16([a, b])) << 16 | u32::from(self.u16([c, d]));
            if tag >> 16 == 0xfffe {
                self.mark(tag)?;
                continue;
            }
            let (vr, length) = self.type_and_length()?;
            let root = self.open.first().map(|open| open.tag);
            let element = |value, length| Some(Element { tag, vr, length, root, value });
            if matches!(tag, 0x7fe0_0008..=0x7fe0_0010) && self.open.is_empty() {
                return Ok(element(Vec::new(), (length != UNDEFINED).then_some(length)));
            }
            let is_sequence = length == UNDEFINED || is_of_frames(tag);
            if is_sequence {
                self.push(tag, length, matches!(&vr, b"OB" | b"OW"))?;
                // Of unknown type, but of undefined length: a sequence that lost its type, and those within with it.
                self.syntax.implicit |= &vr == b"UN";
            } else if wanted(tag) && u64::from(length) <= MAX_VALUE {
                let value = self.take(length.into())?;
                if value.len() < length as usize {
                    return Err(self.error("the file ends within an element; it is cut off"));
                }
                return Ok(element(value, Some(length)));
            } else {
                self.skip(length.into())?;
            }
        }
    }

    /// Follows the beginning of an item or the end of an item or a sequence.
    fn mark(&mut self, tag: u32) -> Result<(), SourceError> {
        let length = self.u32()?;
        if tag != 0xfffe_e000 {
            while let Some(open) = self.open.pop() {
                self.syntax.implicit = open.outside_implicit;
                if open.end.is_none() {
                    break;
                }
            }
            return Ok(());
        }
        if self.open.last().is_some_and(|open| open.is_bytes) && length != UNDEFINED {
            return self.skip(length.into());
        }
        self.push(tag, length, false)
    }

    fn push(&mut self, tag: u32, length: u32, is_bytes: bool) -> Result<(), SourceError> {
        if self.open.len() == MAX_DEPTH {
            return Err(self.error("sequences lie too deep in each other; the file is damaged"));
        }
        let end = (length != UNDEFINED).then(|| self.position + u64::from(length));
        self.open.push(Open { tag, end, outside_implicit: self.syntax.implicit, is_bytes });
        Ok(())
    }

    fn type_and_length(&mut self) -> Result<([u8; 2], u32), SourceError> {
        if self.syntax.implicit {
            return Ok((*b"  ", self.u32()?));
        }
        let &[a, b, c, d] = self.take(4)?.as_slice() else {
            return Err(self.error("the file ends within an element; it is cut off"));
        };
        let vr = [a, b];
        if !vr.iter().all(u8::is_ascii_uppercase) {
            return Err(self.error("expected the two letters of a type; the file is damaged"));
        }
        let is_long = matches!(
            &vr,
            b"OB"
                | b"OD"
                | b"OF"
                | b"OL"
                | b"OV"
                | b"OW"
                | b"SQ"
                | b"SV"
                | b"UC"
                | b"UN"
                | b"UR"
                | b"UT"
                | b"UV"
        );
        Ok((vr, if is_long { self.u32()? } else { self.u16([c, d]).into() }))
    }

    /// Two bytes as the file writes numbers.
    pub fn u16(&self, bytes: [u8; 2]) -> u16 {
        if self.syntax.big_endian { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) }
    }

    /// The next four bytes as a number.
    pub fn u32(&mut self) -> Result<u32, SourceError> {
        let bytes = self.take(4)?;
        let bytes = <[u8; 4]>::try_from(bytes.as_slice())
            .map_err(|_| self.error("the file ends within an element; it is cut off"))?;
        Ok(if self.syntax.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// The next bytes; fewer at the end of the file. Memory grows with what is there.
    pub fn take(&mut self, bytes: u64) -> Result<Vec<u8>, SourceError> {
        let from_ahead = self.ahead.len().min(usize::try_from(bytes).unwrap_or(usize::MAX));
        let mut taken: Vec<u8> = self.ahead.drain(..from_ahead).collect();
        let rest = bytes - from_ahead as u64;
        let read = (&mut self.reader).take(rest).read_to_end(&mut taken);
        self.position += taken.len() as u64;
        read.map_err(|cause| file::io_error(&self.path, cause))?;
        Ok(taken)
    }

    /// Fills `ahead` with what the beginning of an element needs.
    fn look_ahead(&mut self) -> Result<(), SourceError> {
        let missing = 8_u64.saturating_sub(self.ahead.len() as u64);
        let read = (&mut self.reader).take(missing).read_to_end(&mut self.ahead);
        read.map(|_| ()).map_err(|cause| file::io_error(&self.path, cause))
    }

    fn skip(&mut self, bytes: u64) -> Result<(), SourceError> {
        let from_ahead = self.ahead.len().min(usize::try_from(bytes).unwrap_or(usize::MAX));
        self.ahead.drain(..from_ahead);
        let rest = (&mut self.reader).take(bytes - from_ahead as u64);
        let skipped =
            io::copy(&mut { rest }, &mut io::sink()).map_err(|cause| file::io_error(&self.path, cause))?;
        let skipped = skipped + from_ahead as u64;
        self.position += skipped;
        if skipped < bytes {
            return Err(self.error("an element is longer than the file; it is cut off"));
        }
        Ok(())
    }

    /// Something wrong at this place.
    pub fn error(&self, problem: &str) -> SourceError {
        SourceError::Field {
            path: self.path.clone(),
            field: format!("byte {}", self.position),
            problem: problem.to_owned(),
        }
    }
}

/// The sequences of a multi-frame file that say where its frames are.
fn is_of_frames(tag: u32) -> bool {
    matches!(tag, 0x5200_9229 | 0x5200_9230 | 0x0028_9110 | 0x0020_9113 | 0x0020_9116 | 0x0028_9145)
}
