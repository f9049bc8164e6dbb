//! Slices as one volume.

use std::path::Path;

use glam::DVec3;

use super::{
    File, Selection, SourceError, VolumeData,
    geometry::normal,
    header::{Header, unsupported},
    image::Kind,
    pixels::{self, Pixels},
    segmentation,
    segments::Form,
    slices::{self, Slice, Stack},
    tags,
};
use crate::sources::{
    grid::Grid,
    stored::Scaling,
    volume::{Samples, Space},
};

/// From DICOM's left, posterior, superior to right, anterior, superior.
pub(super) const RAS: DVec3 = DVec3::new(-1.0, -1.0, 1.0);

/// The volume of slices that belong together.
pub(super) fn assemble(
    path: &Path,
    files: &[File],
    selection: &Selection,
    mut notes: Vec<String>,
) -> Result<VolumeData, SourceError> {
    let Some((first_path, first)) = files.first() else {
        return Err(unsupported(path, "no slices", "name a folder with slices in it"));
    };
    if first.frames > 1 && matches!(first.segments.form, Form::Binary | Form::Fractional) {
        return segmentation::assemble(path, first_path, first, notes);
    }
    let slices = slices::all(files, &mut notes)?;
    let slices = slices::choose(path, slices, selection.index, &mut notes)?;
    let stack = slices::stack(path, slices, first, &mut notes)?;
    let grid = grid(path, &stack, first, &mut notes)?;
    told(files, first, &mut notes);
    let pixels = gather(path, files, &stack.slices, first.image.pixels(), &mut notes)?;
    let mut volume = match pixels {
        Pixels::Values(stored) => {
            let mut runs: Vec<[f64; 2]> = stack.slices.iter().map(|slice| slice.scale).collect();
            if runs.iter().flatten().any(|number| !number.is_finite()) {
                runs = Vec::new();
            }
            grid.volume(path, stored, &Scaling { runs, run: first.image.pixels().max(1) }, notes)?
        }
        Pixels::Colours(colours) => grid.volume_of(path, Samples::Rgba8(colours), notes)?,
    };
    if first.image.kind() == Kind::Value {
        volume.window = stack.slices[stack.slices.len() / 2].is.window();
    }
    if first.segments.form == Form::Labels {
        volume.labels = Some(segmentation::labels(&first.segments));
    }
    Ok(volume)
}

/// Where the slices of a stack lie.
pub(super) fn grid(
    path: &Path,
    stack: &Stack,
    first: &Header,
    notes: &mut Vec<String>,
) -> Result<Grid, SourceError> {
    let Slice { is, place, .. } = &stack.slices[0];
    let [x, y] = is.orientation.unwrap_or([DVec3::X, DVec3::Y]);
    let [along_y, along_x] = spacing(path, is.spacing, first, notes)?;
    let axes =
        [x.normalize_or_zero() * along_x, y.normalize_or_zero() * along_y, normal(is) * stack.distance];
    let anatomical = is.orientation.is_some();
    let turned = |way: DVec3| if anatomical { way * RAS } else { way };
    let image = &first.image;
    let size = [image.columns.into(), image.rows.into(), stack.slices.len() as u64];
    let bytes = if image.kind() == Kind::Value { image.format().bytes() } else { 4 };
    let mut grid = Grid::new(path, &size, &axes.map(turned), anatomical, bytes)?;
    if let Some(step) = stack.leaning {
        grid = grid.leaning(turned(step));
    }
    // Frames of one file that are stacked by number begin where the file says.
    match place.position.or(is.position) {
        Some(position) if anatomical => grid.at(path, turned(position), Space::Patient),
        _ => Ok(grid),
    }
}

/// Distance of pixel centres along y and x, mm.
fn spacing(
    path: &Path,
    written: Option<[f64; 2]>,
    first: &Header,
    notes: &mut Vec<String>,
) -> Result<[f64; 2], SourceError> {
    if let Some(spacing) = written {
        return Ok(spacing);
    }
    first.needs(path, &[tags::IMAGER_SPACING, tags::SCANNED_SPACING])?;
    let (spacing, note) = match (first.other_spacing, first.aspect) {
        (Some((spacing, tag)), _) => (spacing, format!("{} is taken", tags::called(tag))),
        (None, Some([high, wide])) if high > 0.0 && wide > 0.0 && high != wide => (
            [high / wide, 1.0],
            format!("1 mm is taken along x, and along y what {} makes of it", tags::called(tags::ASPECT)),
        ),
        _ => ([1.0; 2], "1 mm is taken".to_owned()),
    };
    notes.push(format!("it does not say how far apart pixels are in the patient; {note}"));
    Ok(spacing)
}

/// Tells what of the files is not used, or not as one might think.
fn told(files: &[File], first: &Header, notes: &mut Vec<String>) {
    if first.image.photometric == "MONOCHROME1" {
        notes.push(
            "its low values are meant to be bright (MONOCHROME1); the values are as they are".to_owned(),
        );
    }
    if first.has_modality_table {
        notes.push(format!(
            "{} is not applied; the values are as they are stored",
            tags::called(tags::MODALITY_LUT)
        ));
    }
    if files.iter().any(|(_, header)| (0..header.frames).any(|frame| header.frame(frame).slope == Some(0.0)))
    {
        notes.push(format!("{} is 0; 1 is taken", tags::called(tags::SLOPE)));
    }
    let mut unreadable: Vec<(u32, usize, String)> = Vec::new();
    for (path, header) in files {
        for problem in &header.unreadable {
            match unreadable.iter_mut().find(|(tag, ..)| *tag == problem.tag) {
                Some((_, count, _)) => *count += 1,
                None => {
                    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
                    let told = format!("{} in {}", problem.problem, name.unwrap_or_default());
                    unreadable.push((problem.tag, 1, told));
                }
            }
        }
    }
    for (tag, count, told) in unreadable {
        let more = if count > 1 { format!(", and {} more like it", count - 1) } else { String::new() };
        notes.push(format!("{} is left out: {told}{more}", tags::called(tag)));
    }
}

/// The pixels of all slices in their order.
pub(super) fn gather(
    path: &Path,
    files: &[File],
    slices: &[Slice],
    pixels: usize,
    notes: &mut Vec<String>,
) -> Result<Pixels, SourceError> {
    // A file of its own that is in order already is taken as it is.
    let in_order = slices.iter().enumerate().all(|(number, slice)| slice.file == 0 && slice.frame == number);
    let mut all: Option<Pixels> = None;
    let mut read: Option<(usize, Pixels)> = None;
    for slice in slices {
        let frames = match read.take() {
            Some((file, frames)) if file == slice.file => frames,
            _ => pixels::read(&files[slice.file].0, notes)?,
        };
        if in_order && frames.len() == slices.len() * pixels {
            return Ok(frames);
        }
        let part = frames.slice(slice.frame.saturating_mul(pixels), pixels);
        let out_of_memory =
            || SourceError::OutOfMemory { path: path.to_owned(), bytes: (slices.len() * pixels) as u64 };
        // The file may have changed since its header was read.
        let part = part.ok_or_else(out_of_memory)?;
        match &mut all {
            None => all = Some(part),
            Some(all) => all.append(part).ok_or_else(out_of_memory)?,
        }
        read = Some((slice.file, frames));
    }
    all.ok_or_else(|| unsupported(path, "no slices", "name a folder with slices in it"))
}
