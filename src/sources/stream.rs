//! Samples out of a file: plain, packed or as text, each byte counted and memory growing only with what arrives.

use std::{
    fs::File,
    io::{self, BufRead, BufReader, Read, Seek, SeekFrom},
    path::Path,
};

use bzip2::bufread::MultiBzDecoder;
use flate2::bufread::{MultiGzDecoder, ZlibDecoder};

use super::{
    SourceError, file,
    pick::{Pick, PickReader},
    stored::{Element, Stored, StoredFormat, with_samples},
    text,
    volume::Endian,
};

/// Samples by which the memory of an unpacked volume grows at first; later it doubles.
const FIRST_SAMPLES: usize = 1 << 16;

/// Bytes beyond the last sample that are counted to tell how much too long an unpacked file is.
const MAX_SURPLUS_COUNTED: u64 = 1 << 20;

/// How samples are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    /// As they stand in memory.
    Plain,
    /// One gzip stream or several.
    Gzip,
    /// A zlib stream.
    Zlib,
    /// One bzip2 stream or several.
    Bzip2,
    /// As they stand in memory, out of a stream of unknown length.
    Unpacked,
    /// Two hexadecimal digits a byte.
    Hex,
    /// Decimal numbers between spaces.
    Text,
}

impl Packing {
    const fn name(self) -> &'static str {
        match self {
            Self::Plain => "file",
            Self::Unpacked => "data",
            Self::Gzip => "gzip stream",
            Self::Zlib => "zlib stream",
            Self::Bzip2 => "bzip2 stream",
            Self::Hex => "hexadecimal text",
            Self::Text => "text",
        }
    }
}

/// What to make of bytes after the last sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Surplus {
    /// The layout is wrong.
    Refuse,
    /// Worth a note.
    Note,
    /// They are known to mean something else.
    Ignore,
}

/// The samples of one file: where they lie, and what its errors have to name.
#[derive(Clone)]
pub(super) struct SampleStream<'a> {
    /// The file.
    pub path: &'a Path,
    /// What the samples make: `64 x 64 x 64 U8 voxels`.
    pub what: String,
    /// How many samples are read.
    pub samples: u64,
    /// Which of those that are there.
    pub pick: Pick,
    /// How one is stored.
    pub format: StoredFormat,
    /// The order of its bytes.
    pub endian: Endian,
    /// How they are packed.
    pub packing: Packing,
    /// Where in the file they, or the packed stream, begin.
    pub offset: u64,
    /// Bytes in front of the first sample, once unpacked.
    pub skip: u64,
    /// What to make of what follows.
    pub surplus: Surplus,
    /// What a wrong length may be mended by, without and with the bytes too many.
    pub mend: &'a dyn Fn(Option<u64>) -> String,
    /// What to add to it where the file is plain.
    pub hint: &'static str,
}

impl SampleStream<'_> {
    /// Reads the samples of a file that is `file_bytes` long.
    ///
    /// # Errors
    ///
    /// If the file does not hold them. A plain file's length is compared before anything is allocated; a packed one's memory
    /// grows with what comes out.
    pub fn read(
        &self,
        mut file: File,
        file_bytes: u64,
        notes: &mut Vec<String>,
    ) -> Result<Stored, SourceError> {
        let rest = file_bytes.saturating_sub(self.offset);
        if self.packing == Packing::Plain
            && (rest < self.needed() || (rest > self.needed() && self.surplus == Surplus::Refuse))
        {
            return Err(self.length_error(rest, false, self.hint));
        }
        // What a plain file has in front of the samples that are read is never touched, however long it is.
        let passed = if self.packing == Packing::Plain { self.passed() } else { 0 };
        let start = self.offset.saturating_add(passed);
        file.seek(SeekFrom::Start(start)).map_err(|cause| self.read_error(cause, 0))?;
        let reader = BufReader::new(file);
        if self.packing == Packing::Plain {
            self.read_samples(reader, passed, notes)
        } else {
            self.read_from(reader, notes)
        }
    }

    /// Reads the samples of a stream that begins with them.
    pub fn read_from(&self, reader: impl BufRead, notes: &mut Vec<String>) -> Result<Stored, SourceError> {
        match self.packing {
            Packing::Plain | Packing::Unpacked => self.read_samples(reader, 0, notes),
            Packing::Gzip => self.read_samples(BufReader::new(MultiGzDecoder::new(reader)), 0, notes),
            Packing::Zlib => self.read_samples(BufReader::new(ZlibDecoder::new(reader)), 0, notes),
            Packing::Bzip2 => self.read_samples(BufReader::new(MultiBzDecoder::new(reader)), 0, notes),
            Packing::Hex => self.read_samples(BufReader::new(text::HexReader::new(reader)), 0, notes),
            Packing::Text => text::read_samples(self, reader),
        }
    }

    /// Bytes up to the end of the last sample that is read, with what is skipped.
    fn needed(&self) -> u64 {
        self.skip.saturating_add(self.pick.end(self.samples).saturating_mul(self.format.bytes()))
    }

    /// Bytes in front of the first sample that is read.
    fn passed(&self) -> u64 {
        self.skip.saturating_add(self.pick.run(0).0.saturating_mul(self.format.bytes()))
    }

    /// Reads the samples of a stream of unpacked bytes of which `passed` have been passed over.
    fn read_samples(
        &self,
        mut reader: impl BufRead,
        passed: u64,
        notes: &mut Vec<String>,
    ) -> Result<Stored, SourceError> {
        let skip = self.skip.saturating_sub(passed);
        let skipped = io::copy(&mut (&mut reader).take(skip), &mut io::sink());
        let skipped = skipped.map_err(|cause| self.read_error(cause, 0))?;
        if skipped < skip {
            return Err(self.length_error(skipped, false, ""));
        }
        let mut stored = self.format.none();
        if self.pick.is_all() {
            with_samples!(&mut stored, samples => self.fill_samples(&mut reader, samples)?);
            self.expect_end(reader, notes)?;
        } else {
            let at = passed.saturating_sub(self.skip);
            let mut reader = PickReader::new(reader, &self.pick, self.format.bytes(), at);
            with_samples!(&mut stored, samples => self.fill_samples(&mut reader, samples)?);
        }
        Ok(stored)
    }

    /// Reads every sample, growing as they arrive, and puts their bytes into the machine's order.
    fn fill_samples<T: Element>(
        &self,
        reader: &mut impl Read,
        samples: &mut Vec<T>,
    ) -> Result<(), SourceError> {
        let count = usize::try_from(self.samples).map_err(|_| self.out_of_memory())?;
        while samples.len() < count {
            let start = samples.len();
            // A plain file is known to hold them all.
            let step = if self.packing == Packing::Plain {
                count
            } else {
                start.max(FIRST_SAMPLES).min(count - start)
            };
            samples.try_reserve_exact(step).map_err(|_| self.out_of_memory())?;
            samples.resize(start + step, T::zeroed());
            let before = self.skip + (start * size_of::<T>()) as u64;
            let arrived = self.fill(reader, bytemuck::cast_slice_mut(&mut samples[start..]), before)?;
            if arrived < step * size_of::<T>() {
                return Err(self.length_error(self.reached(before + arrived as u64), false, ""));
            }
        }
        let file_is_native = (self.endian == Endian::Little) == cfg!(target_endian = "little");
        if !file_is_native {
            samples.iter_mut().for_each(|sample| *sample = sample.swapped());
        }
        Ok(())
    }

    /// Fills `bytes` as far as the file reaches; says how far that is. `before` bytes came out earlier.
    fn fill(&self, reader: &mut impl Read, bytes: &mut [u8], before: u64) -> Result<usize, SourceError> {
        let mut filled = 0;
        while filled < bytes.len() {
            match reader.read(&mut bytes[filled..]) {
                Ok(0) => break,
                Ok(read) => filled += read,
                Err(cause) if cause.kind() == io::ErrorKind::Interrupted => {}
                Err(cause) => return Err(self.read_error(cause, before + filled as u64)),
            }
        }
        Ok(filled)
    }

    /// How far a stream reaches that ends after so many bytes of what is read.
    fn reached(&self, read: u64) -> u64 {
        if self.pick.is_all() {
            return read;
        }
        let bytes = self.format.bytes();
        let samples = read.saturating_sub(self.skip) / bytes;
        self.skip.saturating_add(self.pick.end(samples).saturating_mul(bytes))
    }

    /// Judges bytes after the last sample; on the way a gzip stream checks its sum.
    fn expect_end(&self, reader: impl Read, notes: &mut Vec<String>) -> Result<(), SourceError> {
        if self.surplus == Surplus::Ignore {
            return Ok(());
        }
        let surplus = io::copy(&mut reader.take(MAX_SURPLUS_COUNTED), &mut io::sink());
        let surplus = surplus.map_err(|cause| self.read_error(cause, self.needed()))?;
        let or_more = surplus == MAX_SURPLUS_COUNTED;
        if surplus > 0 && self.surplus == Surplus::Refuse {
            return Err(self.length_error(self.needed() + surplus, or_more, ""));
        }
        // A line's end or two after the samples is how editors and writers of text close a file.
        if surplus > 2 {
            let at_least = if or_more { "at least " } else { "" };
            notes.push(format!("{at_least}{surplus} bytes after the last sample are left out"));
        }
        Ok(())
    }

    /// The error for memory that is not there.
    pub fn out_of_memory(&self) -> SourceError {
        SourceError::OutOfMemory { path: self.path.to_owned(), bytes: self.needed() }
    }

    /// The error for a stream that cannot be read on after so many unpacked bytes.
    pub fn read_error(&self, cause: io::Error, unpacked: u64) -> SourceError {
        let name = self.packing.name();
        if matches!(self.packing, Packing::Plain | Packing::Text) {
            return file::io_error(self.path, cause);
        }
        let (problem, mend) = match cause.kind() {
            io::ErrorKind::UnexpectedEof => {
                (format!("the {name} ends too early"), "the file is cut off: fetch or pack it again")
            }
            io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData
                if unpacked >= self.needed() && self.packing == Packing::Gzip =>
            {
                (format!("checksum or trailing bytes are wrong ({cause})"), "pack it again with gzip")
            }
            io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData => {
                (format!("the {name} is corrupt ({cause})"), "fetch or pack it again")
            }
            _ => return file::io_error(self.path, cause),
        };
        SourceError::Packed { path: self.path.to_owned(), unpacked, problem, mend }
    }

    /// The error for a stream of `bytes` bytes, or of more where they were not all counted.
    pub fn length_error(&self, bytes: u64, or_more: bool, hint: &str) -> SourceError {
        let unpacked =
            if matches!(self.packing, Packing::Plain | Packing::Unpacked) { "" } else { "unpacked " };
        let at_least = if or_more { "at least " } else { "" };
        let mut place = String::new();
        if self.skip > 0 {
            place = format!(" after {} skipped bytes", self.skip);
        }
        let needed = self.needed();
        let (difference, surplus) = match bytes.checked_sub(needed) {
            None | Some(0) => (format!("{} fewer", needed.saturating_sub(bytes)), None),
            Some(surplus) if or_more => (format!("at least {surplus} more"), None),
            Some(surplus) => (format!("{surplus} more"), Some(surplus)),
        };
        let after = if self.offset > 0 { " after its header" } else { "" };
        SourceError::Length {
            path: self.path.to_owned(),
            found: format!("{at_least}{bytes} {unpacked}bytes{after}"),
            expected: format!("{}{place} need {needed}", self.what),
            difference: format!("{difference} than expected"),
            mend: format!("{}{hint}", (self.mend)(surplus)),
        }
    }
}

/// What mends a file that is not as long as its own header says.
pub(super) fn mend_by_header(_surplus: Option<u64>) -> String {
    "the file is cut off, or its header is wrong: fetch or export it again".to_owned()
}
