//! TIFF: a stack of pages, of microscopes and of ImageJ, or a single one.
//!
//! `tiff` decodes the pages. It is given no more memory than the length of the file lets expect, and since it indexes what a damaged
//! directory says, a panic inside of it counts as damage. It does not know colour tables: such pages are shown to it as gray, and
//! their indices are the samples. What ImageJ and OME write into the description of the first page is read here.

mod describe;
mod ome;
mod page;
mod pages;
mod patched;

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

use glam::DVec3;

use super::{
    Selection, SourceError, VolumeData, file,
    grid::Grid,
    shape::{self, Chosen, Role, Side},
    slices::Slice,
    stored::{Scaling, Stored},
    stream::{Packing, SampleStream, Surplus, mend_by_header},
};
use describe::Description;
use page::Page;
use pages::Pages;

/// Whether a file that begins so is of this format: of either byte order, with offsets of 32 or 64 bits. DICOM may begin with such a mark
/// as well, which leads other readers to its pixels.
pub(super) fn is_tiff(head: &[u8]) -> bool {
    let is_marked = matches!(head, [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..]);
    is_marked && head.get(128..132) != Some(b"DICM")
}

/// Reads a stack of pages that are all alike.
///
/// # Errors
///
/// If the file is broken, its pages are packed by a method that is not read or hold no numbers or colours, or it has no such volume or
/// component.
pub(super) fn read(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    guarded(path, || read_unguarded(path, selection))
}

/// A file of one page, as one slice of a folder of them.
///
/// # Errors
///
/// As of [`read`], and if the file holds several pages.
pub(super) fn read_slice(path: &Path) -> Result<Slice, SourceError> {
    guarded(path, || {
        let mut pages = Pages::open(path, &mut Vec::new())?;
        let page = pages.all[0].clone();
        let description = Description::of(&page, pages.all.len() as u64);
        if pages.all.len() > 1 || description.contiguous.is_some() {
            return Err(SourceError::Unsupported {
                path: path.to_owned(),
                found: "it holds several pages, but in a folder of pictures each is one slice".to_owned(),
                mend: "name this file in place of its folder, or take it out".to_owned(),
            });
        }
        let mut samples = page.format().none();
        pages.append(&page, &mut samples)?;
        let [x, y, _] = description.spacing;
        let samples = page.finish(path, samples)?;
        Ok(Slice { sides: page.sides(), is_colour: page.is_colour, spacing: [x, y], samples })
    })
}

/// Whether a file of this format has one page; not, if it cannot be read.
pub(super) fn is_one_page(path: &Path) -> bool {
    guarded(path, || Pages::are_several(path)).is_ok_and(|several| !several)
}

/// What a reader makes of a file, or that it is damaged where `tiff` panics.
fn guarded<T>(path: &Path, read: impl FnOnce() -> Result<T, SourceError>) -> Result<T, SourceError> {
    // Nothing that the closure touches is used after a panic.
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| {
        let problem = "it contradicts itself; the file is damaged: fetch or export it again".to_owned();
        Err(SourceError::Field { path: path.to_owned(), field: "TIFF directory".to_owned(), problem })
    })
}

fn read_unguarded(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    let mut notes = Vec::new();
    let mut pages = Pages::open(path, &mut notes)?;
    let first = pages.all[0].clone();
    let description = Description::of(&first, pages.all.len() as u64);
    notes.extend(description.notes.iter().cloned());
    let sides: Vec<Side> = first.sides().into_iter().chain(description.stack.iter().cloned()).collect();
    let chosen = shape::choose(path, &sides, selection, first.is_colour, &mut notes)?;
    let format = first.format();
    let grid = grid(path, &sides, &description, chosen.bytes(format))?;
    let stored = match &description.contiguous {
        Some(offset) => contiguous(path, &first, *offset, &grid, &chosen, &mut notes)?,
        None => pages.stack(&chosen)?,
    };
    let stored = first.finish(path, stored)?;
    let mut volume = chosen.volume(&grid, path, stored, &Scaling::NONE, notes)?;
    volume.window = description.window;
    Ok(volume)
}

/// Rows lie along y and pages along z, as they follow each other: with rows from the top and pages that go deeper that is right-handed.
fn grid(path: &Path, sides: &[Side], description: &Description, bytes: u64) -> Result<Grid, SourceError> {
    let size: Vec<u64> =
        sides.iter().filter(|side| side.role == Role::Space).map(|side| side.samples).collect();
    let [x, y, z] = description.spacing;
    let along_x = x.or(y).unwrap_or(1.0);
    let along_y = y.unwrap_or(along_x);
    let axes = [DVec3::X * along_x, DVec3::Y * along_y, DVec3::Z * z.unwrap_or(along_x)];
    Grid::new(path, &size, &axes, false, bytes)
}

/// The samples of pages that lie one behind the other where only the first has a directory, as ImageJ writes large stacks.
fn contiguous(
    path: &Path,
    page: &Page,
    offset: u64,
    grid: &Grid,
    chosen: &Chosen,
    notes: &mut Vec<String>,
) -> Result<Stored, SourceError> {
    let (file, file_bytes) = file::open(path)?;
    let stream = SampleStream {
        path,
        what: chosen.what(grid, page.format()),
        samples: grid.samples() * chosen.per_voxel(),
        pick: chosen.pick.clone(),
        format: page.format(),
        endian: page.endian,
        packing: Packing::Plain,
        offset,
        skip: 0,
        surplus: Surplus::Ignore,
        mend: &mend_by_header,
        hint: "",
    };
    stream.read(file, file_bytes, notes)
}

#[cfg(test)]
mod tests;
