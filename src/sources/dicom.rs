//! DICOM: a folder of slices, an index of one, or one file of one frame or many.
//!
//! `dicom-object` 0.10.1 takes memory by the length an element declares (1.9 GB for a damaged file of at most 40 kB),
//! overflows the stack at 10000 nested sequences, and brings tables of character sets under CC0-1.0; `dicom-pixeldata` panics
//! where bits stored are none or too many, and in run-length coding. Counts are in [`super::self_describing`]. No check
//! beforehand helps that does not itself walk over the elements. Of all of DICOM a volume needs sixty: those are read here,
//! from a walk over the file that keeps nothing else. Samples may be plain, in either byte order, deflated or run-length
//! coded; JPEG and its relatives are unpacked by crates, which are told in [`super::self_describing`] as well.

mod attributes;
mod choose;
mod codecs;
mod colour;
mod elements;
mod encapsulated;
mod folder;
mod geometry;
mod header;
mod image;
mod palette;
mod pixels;
mod recognise;
mod segmentation;
mod segments;
mod series;
mod slices;
mod syntax;
mod tags;
mod values;

use std::path::{Path, PathBuf};

use super::{Selection, SourceError, VolumeData, file};
use header::Header;
pub(super) use recognise::is_dicom;
use recognise::{MAGIC, MAGIC_AT};

/// A file and what it says.
type File = (PathBuf, Header);

/// Reads the frames of one file, or of those that it names if it is an index.
///
/// # Errors
///
/// If the file is broken, its frames are packed by what is not read, or it has no image.
pub(super) fn read_file(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    let header = match Header::read(path) {
        Ok(header) => header,
        // No pixels: perhaps an index of other files.
        Err(error @ SourceError::Unsupported { .. }) => {
            return match folder::index(path)? {
                Some(files) => read_index(path, files, selection),
                None => Err(error),
            };
        }
        Err(error) => return Err(error),
    };
    let mut notes = Vec::new();
    let files =
        choose::choose(path, vec![(path.to_owned(), header)], selection.series.as_deref(), &mut notes)?;
    series::assemble(path, &files, selection, notes)
}

/// Reads what an index names; where none of it is there, what the folder of the index has.
fn read_index(path: &Path, files: Vec<PathBuf>, selection: &Selection) -> Result<VolumeData, SourceError> {
    if files.is_empty() {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut volume = read_folder(folder, selection)?;
        volume.notes.insert(0, "the index names no file that is there; its folder is read".to_owned());
        return Ok(volume);
    }
    read_files(path, files, selection, Vec::new())
}

/// Reads a series of slices in a folder and those within it: the largest, or the one that is chosen.
///
/// # Errors
///
/// If there is no slice in it, or the series cannot be read.
pub(super) fn read_folder(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    let found = folder::search(path)?;
    let mut notes = Vec::new();
    if let Some(first) = found.first_other.filter(|_| !found.files.is_empty()) {
        let first = first.strip_prefix(path).unwrap_or(&first).display().to_string();
        let files = if found.others == 1 {
            "1 file that is no DICOM is".to_owned()
        } else {
            format!("{} files that are no DICOM are", found.others)
        };
        notes.push(format!("{files} left out, as {first}"));
    }
    if found.is_cut {
        notes.push("the folder has more files, or deeper ones, than are looked at".to_owned());
    }
    read_files(path, found.files, selection, notes)
}

fn read_files(
    path: &Path,
    files: Vec<PathBuf>,
    selection: &Selection,
    mut notes: Vec<String>,
) -> Result<VolumeData, SourceError> {
    let (mut slices, mut broken, mut no_images) = (Vec::new(), Vec::new(), 0_usize);
    for file in files {
        match Header::read(&file) {
            Ok(header) => slices.push((file, header)),
            // An index of the folder, a report: DICOM, but no image.
            Err(SourceError::Unsupported { .. }) => no_images += 1,
            Err(error) => broken.push(error),
        }
    }
    if slices.is_empty() {
        return Err(broken.into_iter().next().unwrap_or_else(|| SourceError::Unsupported {
            path: path.to_owned(),
            found: "a folder without DICOM slices".to_owned(),
            mend: "name the folder that the slices are in, or a volume file".to_owned(),
        }));
    }
    if no_images > 0 {
        notes.push(format!("{no_images} DICOM files without an image that is read are left out"));
    }
    if let Some(first) = broken.first() {
        notes.push(format!("{} files that cannot be read are left out, the first: {first}", broken.len()));
    }
    let files = choose::choose(path, slices, selection.series.as_deref(), &mut notes)?;
    series::assemble(path, &files, selection, notes)
}

#[cfg(test)]
mod tests;
