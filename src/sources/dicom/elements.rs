//! A walk over the elements of a DICOM file, up to its pixels.

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Cursor, Read, Seek, SeekFrom},
    path::{Path, PathBuf},
};

use flate2::bufread::DeflateDecoder;

use super::{
    MAGIC, MAGIC_AT, SourceError, file,
    syntax::Syntax,
    tags::{self, is_pixels, is_sequence},
    values::text,
};

/// The longest value that is kept, in bytes.
const MAX_VALUE: u64 = 1 << 20;

/// How deep sequences may lie in each other.
const MAX_DEPTH: usize = 32;

/// The length of what ends with a mark of its own.
const UNDEFINED: u32 = u32::MAX;

/// The beginning of an item, and the group of all marks.
pub(super) const ITEM: u32 = 0xfffe_e000;
const MARKS: u32 = 0xfffe;

const CUT_OFF: &str = "the file ends within an element; it is cut off";

/// One element.
#[derive(Debug)]
pub(super) struct Element {
    /// Group and number: 0x7fe00010.
    pub tag: u32,
    /// Its type, as two letters; spaces where the file does not say.
    pub vr: [u8; 2],
    /// Bytes of its value; `None` if it ends with a mark.
    pub length: Option<u32>,
    /// The sequence that it is in.
    pub parent: Option<u32>,
    /// The outermost of all that it is in, and which of its items, counted from 0.
    pub root: Option<(u32, usize)>,
    /// Its value; empty for pixels, which are next to be read.
    pub value: Vec<u8>,
}

impl Element {
    #[cfg(test)]
    pub fn of(tag: u32, vr: &[u8; 2], value: &[u8]) -> Self {
        Self { tag, vr: *vr, length: None, parent: None, root: None, value: value.to_owned() }
    }
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
    /// Items of it that have begun.
    items: usize,
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
            syntax: Syntax::explicit(),
            open: Vec::new(),
        };
        let mut uid = None;
        elements.look_ahead()?;
        while elements.ahead.get(..2) == Some(&[2, 0]) {
            elements.syntax.implicit = Syntax::explicit().seen(&elements.ahead).implicit;
            let begin = elements.take(4)?;
            let (_, length) = elements.type_and_length()?;
            if begin == [2, 0, 0x10, 0] && u64::from(length) <= MAX_VALUE {
                uid = Some(text(&elements.take(length.into())?));
            } else {
                elements.skip(length.into())?;
            }
            elements.look_ahead()?;
        }
        elements.syntax = uid.map_or(Syntax::explicit(), |uid| Syntax::of(&uid)).seen(&elements.ahead);
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

    /// The next element that is read here, or the pixels; `None` at the end.
    pub fn next(&mut self) -> Result<Option<Element>, SourceError> {
        loop {
            while let Some(open) = self.open.pop_if(|open| open.end.is_some_and(|end| self.position >= end)) {
                self.syntax.implicit = open.outside_implicit;
            }
            let begin = self.take(4)?;
            let &[a, b, c, d] = begin.as_slice() else { return Ok(None) };
            let tag = u32::from(self.u16([a, b])) << 16 | u32::from(self.u16([c, d]));
            if tag >> 16 == MARKS {
                self.mark(tag)?;
                continue;
            }
            let (vr, length) = self.type_and_length()?;
            if is_pixels(tag) && self.open.is_empty() {
                let length = (length != UNDEFINED).then_some(length);
                return Ok(Some(Element { tag, vr, length, parent: None, root: None, value: Vec::new() }));
            }
            if length == UNDEFINED || is_sequence(tag) {
                let element = self.element(tag, vr, length, Vec::new());
                self.push(tag, length, matches!(&vr, b"OB" | b"OW"))?;
                // Of unknown type, but of undefined length: a sequence that lost its type, and those within with it.
                self.syntax.implicit |= &vr == b"UN";
                if matches!(tag, tags::MODALITY_LUT | tags::DIRECTORY) {
                    return Ok(Some(element));
                }
            } else if tags::name(tag).is_some() {
                if u64::from(length) > MAX_VALUE {
                    return Err(self.error(&format!("{} has {length} bytes", tags::called(tag))));
                }
                let value = self.take(length.into())?;
                if value.len() < length as usize {
                    return Err(self.error(CUT_OFF));
                }
                return Ok(Some(self.element(tag, vr, length, value)));
            } else {
                self.skip(length.into())?;
            }
        }
    }

    fn element(&self, tag: u32, vr: [u8; 2], length: u32, value: Vec<u8>) -> Element {
        let parent = self.open.iter().rev().map(|open| open.tag).find(|tag| *tag != ITEM);
        let root = self.open.first().map(|open| (open.tag, open.items.saturating_sub(1)));
        Element { tag, vr, length: Some(length), parent, root, value }
    }

    /// Follows the beginning of an item or the end of an item or a sequence.
    fn mark(&mut self, tag: u32) -> Result<(), SourceError> {
        let length = self.u32()?;
        if tag != ITEM {
            while let Some(open) = self.open.pop() {
                self.syntax.implicit = open.outside_implicit;
                if open.end.is_none() {
                    break;
                }
            }
            return Ok(());
        }
        if let Some(sequence) = self.open.last_mut() {
            sequence.items += 1;
            if sequence.is_bytes && length != UNDEFINED {
                return self.skip(length.into());
            }
        }
        self.push(tag, length, false)
    }

    fn push(&mut self, tag: u32, length: u32, is_bytes: bool) -> Result<(), SourceError> {
        if self.open.len() == MAX_DEPTH {
            return Err(self.error("sequences lie too deep in each other; the file is damaged"));
        }
        let end = (length != UNDEFINED).then(|| self.position + u64::from(length));
        self.open.push(Open { tag, end, outside_implicit: self.syntax.implicit, is_bytes, items: 0 });
        Ok(())
    }

    fn type_and_length(&mut self) -> Result<([u8; 2], u32), SourceError> {
        if self.syntax.implicit {
            return Ok((*b"  ", self.u32()?));
        }
        let &[a, b, c, d] = self.take(4)?.as_slice() else {
            return Err(self.error(CUT_OFF));
        };
        let vr = [a, b];
        if !vr.iter().all(u8::is_ascii_uppercase) {
            return Err(self.error("expected the two letters of a type; the file is damaged"));
        }
        Ok((vr, if is_long(&vr) { self.u32()? } else { self.u16([c, d]).into() }))
    }

    /// Two bytes as the file writes numbers.
    pub fn u16(&self, bytes: [u8; 2]) -> u16 {
        if self.syntax.big_endian { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) }
    }

    /// The next four bytes as a number.
    pub fn u32(&mut self) -> Result<u32, SourceError> {
        let bytes = self.take(4)?;
        let bytes = <[u8; 4]>::try_from(bytes.as_slice()).map_err(|_| self.error(CUT_OFF))?;
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
        let skipped = io::copy(&mut { rest }, &mut io::sink());
        let skipped = skipped.map_err(|cause| file::io_error(&self.path, cause))? + from_ahead as u64;
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

/// Whether elements of this type say their length in 32 bits.
pub(super) fn is_long(vr: &[u8; 2]) -> bool {
    matches!(
        vr,
        b"OB" | b"OD" | b"OF" | b"OL" | b"OV" | b"OW" | b"SQ" | b"SV" | b"UC" | b"UN" | b"UR" | b"UT" | b"UV"
    )
}
