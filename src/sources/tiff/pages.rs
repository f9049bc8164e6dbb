//! The pages of a TIFF file.

use std::{
    fs::File,
    io::{BufReader, Read},
    path::{Path, PathBuf},
};

use tiff::{
    TiffError,
    decoder::{Decoder, DecodingResult, Limits},
};

use super::{
    describe::Description,
    page::Page,
    patched::{Patch, Patched},
};
use crate::sources::{
    SourceError, file, pick::PickReader, shape::Chosen, stored::Stored, volume::MAX_VOLUME_BYTES,
};

/// The most pages that are looked at.
const MAX_PAGES: usize = 1 << 16;

/// More times the length of a file than this it does not unpack to: the most that LZW makes of a page of one value.
const MAX_UNPACKED: u64 = 1400;

/// More times the length of a file than this the lists of a directory do not take, each number of which has a place of its own.
const MAX_LISTED: u64 = 8;

/// What the lists of a small file may take.
const MIB: u64 = 1 << 20;

/// What decodes a file, some bytes of which read otherwise than they are written.
pub(super) type Pixels = Decoder<Patched<BufReader<File>>>;

/// The pages of a file that are alike.
pub(super) struct Pages {
    path: PathBuf,
    decoder: Pixels,
    file_bytes: u64,
    /// Those that are alike; at least one.
    pub all: Vec<Page>,
}

impl Pages {
    /// Looks at every page of a file.
    pub fn open(path: &Path, notes: &mut Vec<String>) -> Result<Self, SourceError> {
        let (_, file_bytes) = file::open(path)?;
        let mut decoder = decoder(path, listed(file_bytes), Vec::new())?;
        let (mut all, mut patches, mut left_out) = (Vec::new(), Vec::new(), 0);
        for number in 0.. {
            match Page::read(path, &mut decoder, number, &mut patches) {
                // A smaller version, or a mask, of another page.
                Ok(None) => left_out += 1,
                Ok(Some(page)) if all.first().is_some_and(|first| !page.is_alike(first)) => left_out += 1,
                Ok(Some(page)) => all.push(page),
                Err(SourceError::Unsupported { .. }) if !all.is_empty() => left_out += 1,
                Err(error) => return Err(error),
            }
            if !decoder.more_images() {
                break;
            }
            if number + 1 == MAX_PAGES {
                return Err(unsupported(path, format!("it has more than {MAX_PAGES} pages"), "split it"));
            }
            if let Err(error) = decoder.next_image() {
                // A stack that is cut off still has its first pages.
                notes.push(format!("its pages end with number {}: {error}", number + 1));
                break;
            }
        }
        if all.is_empty() {
            return Err(unsupported(
                path,
                "all its pages are smaller versions of others".to_owned(),
                "export it again",
            ));
        }
        if left_out > 0 {
            notes.push(format!(
                "{left_out} of its {} pages are of another size or kind, and left out",
                left_out + all.len()
            ));
        }
        notes.extend(all[0].note.map(str::to_owned));
        let decoder = self::decoder(path, unpacked(file_bytes), patches)?;
        Ok(Self { path: path.to_owned(), decoder, file_bytes, all })
    }

    /// Whether a file has more pages than one, by the directory of the first.
    pub fn are_several(path: &Path) -> Result<bool, SourceError> {
        let (_, file_bytes) = file::open(path)?;
        let mut decoder = decoder(path, listed(file_bytes), Vec::new())?;
        let page = Page::read(path, &mut decoder, 0, &mut Vec::new())?;
        let is_contiguous = |page: Page| Description::of(&page, 1).contiguous.is_some();
        Ok(decoder.more_images() || page.is_some_and(is_contiguous))
    }

    /// The samples of all pages that are chosen.
    pub fn stack(&mut self, chosen: &Chosen) -> Result<Stored, SourceError> {
        let pages = self.all.clone();
        let in_each = pages[0].samples();
        let is_read = |page: usize| chosen.pick.part(page as u64 * in_each).count(in_each) > 0;
        let count = (0..pages.len()).filter(|page| is_read(*page)).count() as u64;
        self.check(pages[0].bits_of(count) / 8, unpacked(self.file_bytes))?;
        let mut stored = pages[0].format().none();
        for (number, page) in pages.iter().enumerate().filter(|(number, _)| is_read(*number)) {
            if chosen.pick.is_all() {
                self.append(page, &mut stored)?;
                continue;
            }
            let bytes = self.decode(page)?;
            let (part, mut kept) = (chosen.pick.part(number as u64 * in_each), Vec::new());
            let read = PickReader::new(&bytes[..], &part, page.format().bytes(), 0).read_to_end(&mut kept);
            read.map_err(|cause| file::io_error(&self.path, cause))?;
            stored.append_bytes(&kept).ok_or_else(|| self.out_of_memory(kept.len()))?;
        }
        Ok(stored)
    }

    /// Adds the samples of a page.
    pub fn append(&mut self, page: &Page, stored: &mut Stored) -> Result<(), SourceError> {
        let bytes = self.decode(page)?;
        stored.append_bytes(&bytes).ok_or_else(|| self.out_of_memory(bytes.len()))
    }

    fn out_of_memory(&self, bytes: usize) -> SourceError {
        SourceError::OutOfMemory { path: self.path.clone(), bytes: bytes as u64 }
    }

    /// Refuses to take more memory than the length of the file lets expect.
    fn check(&self, bytes: u64, limit: u64) -> Result<(), SourceError> {
        if bytes <= limit {
            return Ok(());
        }
        Err(SourceError::Field {
            path: self.path.clone(),
            field: "ImageWidth, ImageLength".to_owned(),
            problem: format!(
                "{bytes} bytes of pixels in a file of {} are beyond the limit; the file is damaged",
                self.file_bytes
            ),
        })
    }

    /// The samples of a page as bytes in the machine's order.
    fn decode(&mut self, page: &Page) -> Result<Vec<u8>, SourceError> {
        let path = self.path.clone();
        let error = |error| tiff_error(&path, page.number, error);
        self.decoder.seek_to_image(page.number).map_err(error)?;
        let layout = self.decoder.image_buffer_layout().map_err(error)?;
        let limit = if page.is_packed { unpacked(self.file_bytes) } else { self.file_bytes };
        self.check(layout.complete_len as u64, limit)?;
        let mut result = DecodingResult::U8(Vec::new());
        self.decoder.read_image_to_buffer(&mut result).map_err(error)?;
        let row = layout.row_stride.map(std::num::NonZero::get);
        let bytes = page.plain(result.as_buffer(0).as_bytes(), row);
        let needed = page.samples().saturating_mul(page.format().bytes());
        if bytes.len() as u64 != needed {
            return Err(SourceError::Length {
                path: self.path.clone(),
                found: format!("page {} has {} bytes", page.number + 1, bytes.len()),
                expected: format!("its size needs {needed}"),
                difference: "a different number than expected".to_owned(),
                mend: "the file is damaged: fetch or export it again".to_owned(),
            });
        }
        Ok(bytes)
    }
}

/// The most bytes that the pages of a file unpack to.
fn unpacked(file_bytes: u64) -> u64 {
    file_bytes.saturating_mul(MAX_UNPACKED).min(MAX_VOLUME_BYTES)
}

/// The most bytes that the directories of a file take.
fn listed(file_bytes: u64) -> u64 {
    file_bytes.saturating_mul(MAX_LISTED).saturating_add(MIB)
}

/// What decodes a file, taking no more than so many bytes at once.
fn decoder(path: &Path, limit: u64, patches: Vec<Patch>) -> Result<Pixels, SourceError> {
    let (file, bytes) = file::open(path)?;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = usize::try_from(limit).unwrap_or(usize::MAX);
    limits.intermediate_buffer_size = limits.decoding_buffer_size;
    limits.ifd_value_size = limits.decoding_buffer_size;
    let decoder = Decoder::new(Patched::new(BufReader::new(file), bytes, patches));
    Ok(decoder.map_err(|error| tiff_error(path, 0, error))?.with_limits(limits))
}

/// What `tiff` says of a page, counted from 0.
pub(super) fn tiff_error(path: &Path, page: usize, error: TiffError) -> SourceError {
    let page = page + 1;
    match error {
        TiffError::IoError(cause) if cause.kind() != std::io::ErrorKind::UnexpectedEof => {
            file::io_error(path, cause)
        }
        TiffError::UnsupportedError(what) => unsupported(
            path,
            format!("its page {page} is not read: {what}"),
            "save it without compression, as gray or RGB",
        ),
        TiffError::LimitsExceeded => SourceError::Field {
            path: path.to_owned(),
            field: format!("page {page}"),
            problem: "its size is beyond the limit of what the file can hold; the file is damaged".to_owned(),
        },
        error => SourceError::Field {
            path: path.to_owned(),
            field: format!("page {page}"),
            problem: format!(
                "{error}; the file is damaged, or of a rare kind: export it again, as gray or RGB in one piece"
            ),
        },
    }
}

pub(super) fn unsupported(path: &Path, found: String, mend: &str) -> SourceError {
    SourceError::Unsupported { path: path.to_owned(), found, mend: mend.to_owned() }
}
