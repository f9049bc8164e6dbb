//! MetaImage: lines `Name = value`, then samples, in the same file (.mha) or others (.mhd).
//!
//! No crate of the registry was found that reads it and is under a licence allowed here; see [`super::self_describing`]. The
//! format is that of <https://itk.org/Wiki/MetaIO/Documentation>.

mod header;

use std::path::Path;

use super::{
    Selection, SourceError, VolumeData, pieces,
    shape::choose,
    stored::{Scaling, StoredFormat},
    stream::{SampleStream, Surplus, mend_by_header},
    volume::Endian,
};
use header::Header;

/// Reads a volume of a MetaImage.
///
/// # Errors
///
/// If a line is wrong or missing, the file has no such volume or component, or the data are not there.
pub(super) fn read(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    let header = Header::read(path)?;
    let mut notes = Vec::new();
    let sides = header.sides()?;
    let format = header.format()?;
    let chosen = choose(path, &sides, selection, format == StoredFormat::U8, &mut notes)?;
    let grid = header.grid(&sides, chosen.bytes(format))?;
    let data = header.get("ElementDataFile").map(|line| line.value.clone()).unwrap_or_default();
    let (files, local) = header.files(&data, &mut notes)?;
    let stream = SampleStream {
        path,
        what: chosen.what(&grid, format),
        samples: grid.samples() * chosen.per_voxel(),
        pick: chosen.pick.clone(),
        format,
        endian: if header.is_true(&["ElementByteOrderMSB", "BinaryDataByteOrderMSB"]) {
            Endian::Big
        } else {
            Endian::Little
        },
        packing: header.packing(),
        offset: 0,
        skip: 0,
        surplus: Surplus::Note,
        mend: &mend_by_header,
        hint: "",
    };
    let in_each = chosen.all / files.len().max(1) as u64;
    let stored = pieces::read(&stream, chosen.all, &files, &mut notes, |piece| {
        piece.offset = if local { header.data_offset } else { 0 };
        header.place(piece, in_each)
    })?;
    chosen.volume(&grid, path, stored, &Scaling::NONE, notes)
}

#[cfg(test)]
mod tests;
