//! VTK's XML images, .vti (<https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>).
//!
//! `vtkio` is no help here: see [`super::vtk`]. The XML is taken apart by `quick-xml`, base64 by `base64`; where the arrays lie
//! among them, in which of five forms, is found out here.

mod data;
mod header;
mod reading;

use std::path::Path;

use super::{
    Selection, SourceError, VolumeData,
    pick::Pick,
    shape::{self, Side},
    stored::Scaling,
    stream::{Packing, SampleStream, Surplus, mend_by_header},
    vtk::choice::{self, Described},
};
use header::{Form, Header};

/// Whether a file that begins so is one of VTK's XML files.
pub(super) fn is_vtk_xml(head: &[u8]) -> bool {
    let text = head.trim_ascii_start();
    text.starts_with(b"<VTKFile")
        || text.starts_with(b"<?xml") && text.windows(8).any(|part| part == b"<VTKFile")
}

/// Reads an array of the points or the cells of an image; which one as of a legacy file, but first the one that the file calls its
/// scalars.
///
/// # Errors
///
/// If the XML is broken, the file holds no image, its arrays are packed by another method than zlib, or the data are not there.
pub(super) fn read(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    let mut notes = Vec::new();
    let header = Header::read(path, &mut notes)?;
    let (index, selection) = choice::choose(path, &header.arrays, selection, &mut notes)?;
    let array = &header.arrays[index];
    let sides: Vec<Side> = [Side::components(array.components, "components")]
        .into_iter()
        .chain(header.size(array).map(Side::space))
        .collect();
    let chosen = shape::choose(path, &sides, &selection, array.is_colour(), &mut notes)?;
    let grid = header.grid(path, array, chosen.bytes(array.format))?;
    let is_text = array.form == Form::Ascii;
    let stream = SampleStream {
        path,
        what: chosen.what(&grid, array.format),
        samples: grid.samples() * chosen.per_voxel(),
        pick: Pick::clone(&chosen.pick),
        format: array.format,
        endian: header.endian,
        packing: if is_text { Packing::Text } else { Packing::Unpacked },
        offset: 0,
        skip: 0,
        surplus: Surplus::Ignore,
        mend: &mend_by_header,
        hint: "",
    };
    let stored = stream.read_from(data::open(path, &header, array)?, &mut notes)?;
    chosen.volume(&grid, path, stored, &Scaling::NONE, notes)
}

#[cfg(test)]
mod tests;
