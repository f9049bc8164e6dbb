//! Volumes in files that say what they hold.
//!
//! | format | files | reader |
//! |---|---|---|
//! | NRRD | .nrrd, .nhdr with its data | own: a text header |
//! | NIfTI-1, NIfTI-2 | .nii, .nii.gz, .hdr with .img | own: a binary structure |
//! | MetaImage | .mha, .mhd with its data | own: a text header |
//! | DICOM | a folder with slices, also nested ones, DICOMDIR, a file of any name | own: a walk over the elements that matter; crates for packed pixels |
//! | legacy VTK | .vtk with structured points, or another grid that is even | own: a text header |
//! | VTK's XML | .vti | own, on `quick-xml`: arrays as text, as base64, or appended, perhaps packed by zlib |
//! | TIFF | .tif, .tiff: a stack of pages | `tiff`, given no more memory than the file lets expect |
//! | NumPy | .npy | own: a line of text |
//! | pictures | a folder of TIFF, PNG or JPEG, one a slice | `tiff`, `image` |
//!
//! Every reader takes memory by what is in the file, never by what its header says. What crates did in its place, in November
//! 2026, with the files of the data folder, and with 1000 copies of small ones that were damaged by seed, each in a process of
//! its own with 2 GB of addresses (greedy: one request of more than 64 times the file and 2 MiB):
//!
//! | crate | published | files read | panics | aborts | greedy | and |
//! |---|---|---|---|---|---|---|
//! | `nifti` 0.18.0 | 2026-09 | 18 of 18 | 68 | 0 | 36 | NIfTI-2 is refused |
//! | `medrs` 0.2.0 | 2026-07 | 18 of 18 | 0 | 0 | 0 | refuses .hdr with .img; needs C and CMake to build |
//! | `dicom-pixeldata` 0.10.1 | 2026-10 | 4 of 4 | 45 | 1 | 155 | six packages under CC0-1.0, which is not allowed here |
//! | `dicom-object` 0.10.1 | 2026-10 | 4 of 4 | 0 | 0 | 155 | the same; its stack overflows at 10000 nested sequences |
//! | `vtkio` 0.6.3 | 2021-03 | 0 of 1 | 0 | 6 | 4 | of data that are cut off it loads none, and says nothing |
//! | `vtkio` 0.7.0-rc2 | 2026-03 | 0 of 1 | 0 | 0 | 0 | a release candidate; its errors name no line |
//! | these readers | | 23 of 23 | 0 | 0 | 0 | |
//!
//! Packed pixels of DICOM, with 41 pictures by IJG's JPEG, CharLS, OpenJPEG and OpenJPH, and with 1000 damaged copies of them
//! (8000 for `openjp2`; sizes, which are compared here before a crate sees any, were not):
//!
//! | crate | what | pictures read right | panics | aborts | greedy | and |
//! |---|---|---|---|---|---|---|
//! | `jpeg-decoder` 0.3.2 | JPEG, lossless too | 16 of 17 | 0 | 0 | 3 | not 12 bits with loss; kept for its lossless form alone |
//! | `pure_jpegls` 2.0.0 | JPEG-LS | 4 of 5 | 0 | 0 | 0 | not colours |
//! | `dicom-toolkit-codec` 0.5.0 | JPEG-LS | 0 of 5 | | | | stops in streams of CharLS |
//! | `jpeg2k` 0.10.1, `openjp2` 0.6.1 | JPEG 2000 | 19 of 19 | 1 | 0 | 29 | OpenJPEG, translated: much of its code is unsafe |
//! | `hayro-jpeg2000` 0.5.0 | JPEG 2000 | 8 of 19 | | 4 | | not the high-throughput form; signed values are shifted |
//! | `dicom-toolkit-jpeg2000` 0.5.0 | JPEG 2000 | 14 of 19 | 2 | 0 | 1 | wrong with loss in more than 8 bits, with signs, in packed colours |
//!
//! For NRRD and MetaImage one crate was found, `bioformats` 0.1.8, under the GPL, which is not allowed here and was not tried.
//! These readers were given 1000 damaged files of either as well: no panic, no abort, none greedy.

mod unknown;

use std::{fs, io::Read, path::Path};

use flate2::read::MultiGzDecoder;

use super::{
    SourceError, VolumeData, dicom, file, meta_image, nifti, npy, nrrd, raw::GZIP_MAGIC, slices,
    text::without_mark, tiff, trail, vti, vtk,
};

/// Bytes that are looked at to tell formats apart.
const HEAD: u64 = 1024;

/// Which of the volumes in a file is meant, where it holds several.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Selection {
    /// The entry along a fourth axis, such as a time point, counted from 0.
    pub index: u32,
    /// The component of samples that consist of several numbers, counted from 0; `None` for all of a colour, else the first.
    pub component: Option<u32>,
    /// The series of DICOM slices, by its `SeriesInstanceUID`, number or description; `None` for the largest.
    pub series: Option<String>,
}

/// Reads a volume from a file that says itself what it holds, or from a folder of slices: of DICOM, or numbered pictures.
///
/// The format is told by the content, and by the name only where the content says nothing. What a person should know about how
/// it was read is in [`VolumeData::notes`].
///
/// # Errors
///
/// If the format is none that is read, or its reader refuses the file.
pub fn read_volume(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    if fs::metadata(path).is_ok_and(|metadata| metadata.is_dir()) {
        return match slices::pictures(path) {
            Some(pictures) => slices::read(path, &pictures, selection),
            None => dicom::read_folder(path, selection),
        };
    }
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    // The header of a pair is what describes it, whichever of the two is named.
    let header = path.with_extension("hdr");
    if ending == "img" {
        // One that comes later describes it as well.
        trail::note(&header);
    }
    if ending == "img" && header.is_file() {
        return read_volume(&header, selection);
    }
    let (head, packed) = head(path)?;
    if nifti::is_nifti(&head) {
        return nifti::read(path, selection);
    }
    let text = without_mark(&head);
    let known = if text.starts_with(b"NRRD00") {
        nrrd::read
    } else if text.starts_with(vtk::MAGIC) {
        vtk::read
    } else if head.starts_with(npy::MAGIC) {
        npy::read
    } else if tiff::is_tiff(&head) {
        tiff::read
    } else if vti::is_vtk_xml(text) {
        vti::read
    } else if dicom::is_dicom(&head, ending == "dcm") {
        dicom::read_file
    } else if is_meta_image(text) {
        meta_image::read
    } else {
        return Err(unknown::unknown(path, &head, &ending));
    };
    if packed {
        let found = "gzip around a format that is not packed as a whole".to_owned();
        let mend = "unpack it with `gunzip`".to_owned();
        return Err(SourceError::Unsupported { path: path.to_owned(), found, mend });
    }
    known(path, selection)
}

/// The first bytes of a file, unpacked if it is gzipped.
fn head(path: &Path) -> Result<(Vec<u8>, bool), SourceError> {
    let (mut file, _) = file::open(path)?;
    let packed = file::begins_with(path, &mut file, &GZIP_MAGIC)?;
    let mut head = Vec::new();
    if packed {
        // A stream that breaks is the reader's to report, or no known format.
        let _ = MultiGzDecoder::new(file).take(HEAD).read_to_end(&mut head);
    } else {
        file.take(HEAD).read_to_end(&mut head).map_err(|cause| file::io_error(path, cause))?;
    }
    Ok((head, packed))
}

/// Whether a volume that begins like this says how it lies in a patient; none for what is no volume.
pub(super) fn in_patient(head: &[u8], ending: &str) -> Option<bool> {
    let text = without_mark(head);
    let lower = || String::from_utf8_lossy(text).to_lowercase();
    if nifti::is_nifti(head) {
        return Some(nifti::has_direction(head));
    }
    if text.starts_with(b"NRRD00") {
        let lower = lower();
        let space = lower.lines().find_map(|line| line.strip_prefix("space:"));
        return Some(space.is_some_and(|space| !space.contains("3d")));
    }
    let is_image = || vti::is_vtk_xml(text) && lower().contains("imagedata");
    if text.starts_with(vtk::MAGIC) || tiff::is_tiff(head) || head.starts_with(npy::MAGIC) || is_image() {
        return Some(false);
    }
    if dicom::is_dicom(head, ending == "dcm") {
        return Some(true);
    }
    is_meta_image(text)
        .then(|| lower().lines().any(|line| line.contains("orientation") && !line.contains('?')))
}

/// MetaImage has no magic: one of the fields that it must have stands at the beginning of a line.
fn is_meta_image(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    text.lines().take(32).filter_map(|line| line.split_once('=')).any(|(name, _)| {
        matches!(name.trim(), "ObjectType" | "NDims" | "DimSize" | "ElementType" | "ElementDataFile")
    })
}

#[cfg(test)]
pub(super) mod tests;
