//! DICOM: a folder of slices, or one file of one frame or many.
//!
//! `dicom-object` 0.10.1 takes memory by the length an element declares (1.9 GB for a damaged file of at most 40 kB),
//! overflows the stack at 10000 nested sequences, and brings tables of character sets under CC0-1.0; `dicom-pixeldata` panics
//! where bits stored are none or too many, and in run-length coding. Counts are in [`super::self_describing`]. No check
//! beforehand helps that does not itself walk over the elements. Of all of DICOM a volume needs twenty: those are read here,
//! from a walk over the file that keeps nothing else. Samples may be plain, in either byte order, deflated or run-length
//! coded; JPEG and its relatives are refused with what converts them.

mod elements;
mod header;
mod pixels;
mod series;

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{Selection, SourceError, VolumeData, file, trail};
use header::Header;

/// Entries of a folder that are looked at.
const MAX_ENTRIES: usize = 1 << 16;

/// Where the mark of a DICOM file stands, and what it is.
const MAGIC_AT: usize = 128;
const MAGIC: &[u8] = b"DICM";

/// Whether a file that begins with `head` is of this format; old files without its mark are, if they are named so.
pub(super) fn is_dicom(head: &[u8], is_named_so: bool) -> bool {
    let has_magic = head.get(MAGIC_AT..MAGIC_AT + MAGIC.len()) == Some(MAGIC);
    has_magic || is_named_so && matches!(head, [2 | 8, 0, 0 | 5 | 0x16 | 0x18, 0, ..])
}

/// Reads the frames of one file.
///
/// # Errors
///
/// If the file is broken, its frames are compressed by JPEG or are no images of one number a pixel.
pub(super) fn read_file(path: &Path, _selection: &Selection) -> Result<VolumeData, SourceError> {
    let header = Header::read(path)?;
    series::assemble(path, &[(path.to_owned(), header)], Vec::new())
}

/// Reads the largest series of slices in a folder; folders within are left out.
///
/// # Errors
///
/// If there is no slice in it, or the largest series cannot be read.
pub(super) fn read_folder(path: &Path, _selection: &Selection) -> Result<VolumeData, SourceError> {
    let io_error = |cause| file::io_error(path, cause);
    trail::note(path);
    let mut entries: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(path).map_err(io_error)?.take(MAX_ENTRIES) {
        entries.push(entry.map_err(io_error)?.path());
    }
    entries.sort();
    let (mut slices, mut broken) = (Vec::new(), Vec::new());
    for entry in entries {
        if !fs::metadata(&entry).is_ok_and(|metadata| metadata.is_file()) || !begins_like_dicom(&entry) {
            continue;
        }
        match Header::read(&entry) {
            Ok(header) => slices.push((entry, header)),
            // An index of the folder, a report: DICOM, but no image.
            Err(SourceError::Unsupported { .. }) => {}
            Err(error) => broken.push(error),
        }
    }
    let mut notes = Vec::new();
    if let Some(first) = broken.first() {
        if slices.is_empty() {
            return Err(broken.swap_remove(0));
        }
        notes.push(format!("{} files that cannot be read are left out, the first: {first}", broken.len()));
    }
    let slices = series::largest(slices, &mut notes);
    if slices.is_empty() {
        return Err(SourceError::Unsupported {
            path: path.to_owned(),
            found: "a folder without DICOM slices".to_owned(),
            mend: "name the folder that the slices are in, or a volume file".to_owned(),
        });
    }
    series::assemble(path, &slices, notes)
}

fn begins_like_dicom(path: &Path) -> bool {
    use std::io::Read;
    let named = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("dcm"));
    let mut head = Vec::new();
    let read = file::open(path).map(|(file, _)| file.take(256).read_to_end(&mut head));
    matches!(read, Ok(Ok(_))) && is_dicom(&head, named)
}

#[cfg(test)]
mod tests;
