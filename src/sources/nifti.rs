//! NIfTI-1 and NIfTI-2: a binary header of 348 or 540 bytes, then samples, in the same file or in an .img beside it.
//!
//! The `nifti` crate panics where `bitpix` contradicts `datatype`, and reserves what the header says. With sizes, `bitpix`,
//! `vox_offset` and the length checked before, it did neither in 1000 damaged files; but it refuses NIfTI-2, so this structure
//! would still be read here. `medrs` held without checks, but refuses an .hdr whose samples begin at 0 in its .img, and did not
//! build without CMake. Counts are in [`super::self_describing`]; the format is that of <https://nifti.nimh.nih.gov/nifti-1/>
//! and <https://nifti.nimh.nih.gov/nifti-2/>.

mod header;
mod place;

use std::path::Path;

use super::{
    Selection, SourceError, VolumeData, file,
    raw::GZIP_MAGIC,
    shape::choose,
    stream::{Packing, SampleStream, Surplus, mend_by_header},
};
use header::{Header, Sample};

const BYTES_1: usize = 348;
const BYTES_2: usize = 540;

/// Whether a file that begins with `head`, unpacked, is of this format.
pub(super) fn is_nifti(head: &[u8]) -> bool {
    let at = |start: usize, text: &[u8]| head.get(start..start + text.len()) == Some(text);
    at(344, b"n+1\0") || at(344, b"ni1\0") || at(4, b"n+2\0") || at(4, b"ni2\0")
}

/// Whether a header says how its axes lie in a patient.
pub(super) fn has_direction(head: &[u8]) -> bool {
    let is_set = |place: usize, bytes: usize| {
        head.get(place..place + bytes).is_some_and(|code| code.iter().any(|byte| *byte != 0))
    };
    // `qform_code` and `sform_code`.
    match head.first_chunk::<4>().map(|size| i32::from_le_bytes(*size)) {
        Some(size) if [size, size.swap_bytes()].contains(&(BYTES_2 as i32)) => {
            is_set(344, 4) || is_set(348, 4)
        }
        _ => is_set(252, 2) || is_set(254, 2),
    }
}

/// Whether it is the header that NIfTI grew out of.
pub(super) fn is_analyze(head: &[u8]) -> bool {
    let length =
        head.first_chunk::<4>().map(|bytes| [i32::from_le_bytes(*bytes), i32::from_be_bytes(*bytes)]);
    length.is_some_and(|length| length.contains(&(BYTES_1 as i32)))
        && head.len() >= BYTES_1
        && !is_nifti(head)
}

/// Reads a volume of a NIfTI file, plain or gzipped.
///
/// # Errors
///
/// If the header is cut off or contradicts itself, samples are complex, the file has no such volume or component, or the samples
/// are not all there.
pub(super) fn read(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    let header = Header::read(path)?;
    let mut notes = Vec::new();
    let Sample { format, channels } = header.sample()?;
    let sides = header.sides(channels)?;
    let chosen = choose(path, &sides, selection, header.is_colour(channels), &mut notes)?;
    let grid = header.grid(&sides, chosen.bytes(format), &mut notes)?;
    let data = header.data_file();
    let (mut file, file_bytes) = file::open(&data)?;
    let packed = file::begins_with(&data, &mut file, &GZIP_MAGIC)?;
    let skip = header.data_offset()?;
    let stream = SampleStream {
        path: &data,
        what: chosen.what(&grid, format),
        samples: grid.samples() * chosen.per_voxel(),
        pick: chosen.pick.clone(),
        format,
        endian: header.endian,
        packing: if packed { Packing::Gzip } else { Packing::Plain },
        offset: if packed { 0 } else { skip },
        skip: if packed { skip } else { 0 },
        surplus: Surplus::Note,
        mend: &mend_by_header,
        hint: "",
    };
    let stored = stream.read(file, file_bytes, &mut notes)?;
    let mut volume = chosen.volume(&grid, path, stored, &header.scaling(), notes)?;
    volume.window = header.window();
    volume.labels = header.labels(&volume);
    Ok(volume)
}

#[cfg(test)]
mod tests;
