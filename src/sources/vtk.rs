//! Legacy VTK files of images and of other grids that are as even, as text or binary.
//!
//! `vtkio` 0.6.3 takes memory by the header's word, and of data that are cut off loads none without an error. 0.7.0-rc2 does
//! neither, and none of 11000 damaged files brought it down; but it is a release candidate, refuses the empty line that some
//! write after the title, accepts sizes that the samples do not fill, and says `Parse error: Digit` and no line. Counts are
//! in [`super::self_describing`]. A grid's few lines are read here
//! (<https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html>).

mod arrays;
pub(super) mod choice;
mod dataset;
pub(super) mod even;
mod table;

use std::path::Path;

use super::{
    Selection, SourceError, VolumeData, file,
    pick::Pick,
    shape::{self, Side},
    stored::{Scaling, Stored, StoredFormat},
    stream::{Packing, SampleStream, Surplus, mend_by_header},
    text::HeaderLines,
    volume::Endian,
};
use arrays::Array;
use choice::Described;
use dataset::Dataset;

/// What every such file begins with.
pub(super) const MAGIC: &[u8] = b"# vtk DataFile";

/// Reads an array of the points or the cells of a grid that is even: the first of one number a point, unless another is chosen.
///
/// # Errors
///
/// If a line is wrong or missing, the data set is of another kind or not even, or the data are not there.
pub(super) fn read(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    let mut lines = HeaderLines::open(path)?;
    let mut notes = Vec::new();
    let is_text = begin(&mut lines)?;
    let dataset = Dataset::read(path, &mut lines, is_text, &mut notes)?;
    let (index, selection) = choice::choose(path, &dataset.arrays, selection, &mut notes)?;
    let array = &dataset.arrays[index];
    let sides: Vec<Side> = [Side::components(array.components, "components")]
        .into_iter()
        .chain(dataset.size(array).map(Side::space))
        .collect();
    let chosen = shape::choose(path, &sides, &selection, array.is_colour(), &mut notes)?;
    let grid = dataset.grid(path, array, chosen.bytes(array.format), is_text, &mut notes)?;
    let stream = SampleStream {
        what: chosen.what(&grid, array.format),
        samples: grid.samples() * chosen.per_voxel(),
        pick: chosen.pick.clone(),
        ..run(path, array.format, array.offset, 0, is_text)
    };
    let stored = stream_in(&stream, &mut notes)?;
    let mut volume = chosen.volume(&grid, path, stored, &Scaling::NONE, notes)?;
    volume.labels = table::labels(path, &dataset, array, &volume, is_text)?;
    Ok(volume)
}

/// Goes over the title; whether the data are text.
fn begin(lines: &mut HeaderLines) -> Result<bool, SourceError> {
    // The magic was looked at to find this reader; the second line is a title.
    lines.next()?;
    lines.next()?;
    let mut kind = lines.next()?;
    // Some write an empty line after the title.
    while kind.as_deref().is_some_and(|line| line.trim().is_empty()) {
        kind = lines.next()?;
    }
    match kind.as_deref().map(|line| line.trim().to_uppercase()).as_deref() {
        Some("ASCII") => Ok(true),
        Some("BINARY") => Ok(false),
        found => Err(expected(lines, "`ASCII` or `BINARY`", found.unwrap_or("the end"))),
    }
}

/// A run of numbers in a file.
fn run(path: &Path, format: StoredFormat, offset: u64, samples: u64, is_text: bool) -> SampleStream<'_> {
    SampleStream {
        path,
        what: format!("{samples} numbers"),
        samples,
        pick: Pick::ALL,
        format,
        endian: Endian::Big,
        packing: if is_text { Packing::Text } else { Packing::Plain },
        offset,
        skip: 0,
        // More arrays, and what describes them, may follow.
        surplus: Surplus::Ignore,
        mend: &mend_by_header,
        hint: "",
    }
}

fn stream_in(stream: &SampleStream, notes: &mut Vec<String>) -> Result<Stored, SourceError> {
    let (file, file_bytes) = file::open(stream.path)?;
    stream.read(file, file_bytes, notes)
}

fn expected(lines: &HeaderLines, expected: &str, found: &str) -> SourceError {
    let found: String = found.chars().take(40).collect();
    lines.error(format!("expected {expected}, found `{found}`"))
}

fn unsupported(path: &Path, found: String, mend: &str) -> SourceError {
    SourceError::Unsupported { path: path.to_owned(), found, mend: mend.to_owned() }
}

#[cfg(test)]
mod tests;
