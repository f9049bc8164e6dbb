//! Slices as one volume.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use glam::DVec3;

use super::{SourceError, VolumeData, header::Header, pixels};
use crate::sources::{
    grid::Grid,
    pieces,
    stored::{Scaling, Stored},
};

/// From DICOM's left, posterior, superior to right, anterior, superior.
const RAS: DVec3 = DVec3::new(-1.0, -1.0, 1.0);

/// Slices closer than this are at the same place, mm.
const SAME_PLACE: f64 = 1e-3;

/// Distances of slices that differ by less than this part are equal.
const EVEN: f64 = 0.02;

/// Other series that a note names.
const MAX_NAMED: usize = 4;

/// A file and what it says.
pub(super) type File = (PathBuf, Header);

/// The series of most slices, in the order of their files; the others are told in a note.
pub(super) fn largest(files: Vec<File>, notes: &mut Vec<String>) -> Vec<File> {
    let mut series: BTreeMap<String, Vec<File>> = BTreeMap::new();
    for (path, header) in files {
        series.entry(key(&path, &header)).or_default().push((path, header));
    }
    let mut series: Vec<Vec<File>> = series.into_values().collect();
    let slices = |files: &[File]| files.iter().map(|(_, header)| header.frames).fold(0, u64::saturating_add);
    series.sort_by_key(|files| std::cmp::Reverse(slices(files)));
    if series.len() > 1 {
        let name = |files: &Vec<File>| {
            let name = files.first().map_or("", |(_, header)| &header.description);
            format!("`{}` of {}", if name.is_empty() { "no name" } else { name }, slices(files))
        };
        let others: Vec<String> = series.iter().skip(1).take(MAX_NAMED).map(name).collect();
        let more = if series.len() > MAX_NAMED + 1 { ", …" } else { "" };
        notes.push(format!(
            "of {} series only the largest is read, {} slices; left out are {}{more}",
            series.len(),
            name(&series[0]),
            others.join(", ")
        ));
    }
    series.into_iter().next().unwrap_or_default()
}

/// What slices of one volume have in common; a file of many frames is a volume by itself.
fn key(path: &Path, header: &Header) -> String {
    let alone = if header.frames > 1 { path.display().to_string() } else { String::new() };
    let rounded = |axis: DVec3| (axis * 100.0).round().as_ivec3();
    let orientation = header.orientation.map(|axes| axes.map(rounded));
    let pixels = (header.rows, header.columns, header.bits, header.signed, header.is_float);
    format!("{} {pixels:?} {orientation:?} {alone}", header.series)
}

/// One image, before it has its place.
struct Slice {
    file: usize,
    frame: usize,
    /// Along the normal of the slices, mm.
    place: Option<f64>,
    position: Option<DVec3>,
    instance: i64,
    scale: [f64; 2],
}

/// The volume of slices that belong together.
pub(super) fn assemble(
    path: &Path,
    files: &[File],
    mut notes: Vec<String>,
) -> Result<VolumeData, SourceError> {
    let Some((_, first)) = files.first() else {
        return Err(super::header::unsupported(path, "no slices", "name a folder with slices in it"));
    };
    let [x, y] = first.orientation.unwrap_or([DVec3::X, DVec3::Y]);
    let normal = x.cross(y).normalize_or(DVec3::Z);
    let mut slices = slices(files, normal, path)?;
    let distance = sorted(&mut slices, first, normal, &mut notes);
    let [along_y, along_x] = first.spacing.unwrap_or_else(|| {
        notes.push("it does not say how far apart pixels are; 1 mm is taken".to_owned());
        [1.0, 1.0]
    });
    let axes = [x.normalize_or_zero() * along_x, y.normalize_or_zero() * along_y, normal * distance];
    let format = pixels::format(first);
    let size = [first.columns.into(), first.rows.into(), slices.len() as u64];
    let anatomical = first.orientation.is_some();
    let axes = axes.map(|axis| if anatomical { axis * RAS } else { axis });
    let grid = Grid::new(path, &size, &axes, anatomical, format.bytes())?;
    let pixels = usize::from(first.columns) * usize::from(first.rows);
    let stored = gather(path, files, &slices, pixels, &mut notes)?;
    let mut runs: Vec<[f64; 2]> = slices.iter().map(|slice| slice.scale).collect();
    if runs.iter().flatten().any(|number| !number.is_finite()) {
        runs = Vec::new();
    }
    grid.volume(path, stored, &Scaling { runs, run: pixels.max(1) }, notes)
}

fn slices(files: &[File], normal: DVec3, path: &Path) -> Result<Vec<Slice>, SourceError> {
    let mut slices = Vec::new();
    for (file, (_, header)) in files.iter().enumerate() {
        let frames = usize::try_from(header.frames).ok().filter(|frames| (1..=1 << 16).contains(frames));
        let frames = frames.ok_or_else(|| SourceError::Field {
            path: path.to_owned(),
            field: "NumberOfFrames".to_owned(),
            problem: format!("{} frames; expected 1 to 65536", header.frames),
        })?;
        let has_places = header.positions.len() == frames;
        slices.extend((0..frames).map(|frame| {
            let position = header.positions.get(frame).copied().filter(|_| has_places);
            let place = position.map(|position| position.dot(normal));
            Slice { file, frame, place, position, instance: header.instance, scale: header.scale(frame) }
        }));
    }
    Ok(slices)
}

/// Sorts slices along their normal and leaves out what is twice at a place; says how far apart they are, mm.
fn sorted(slices: &mut Vec<Slice>, first: &Header, normal: DVec3, notes: &mut Vec<String>) -> f64 {
    let written = first.between.or(first.thickness).map(f64::abs).filter(|distance| *distance > 0.0);
    if slices.len() == 1 {
        return written.unwrap_or(1.0);
    }
    if slices.iter().any(|slice| slice.place.is_none()) {
        slices.sort_by_key(|slice| (slice.instance, slice.file, slice.frame));
        let distance = written.unwrap_or(1.0);
        notes.push(format!(
            "its slices do not say where they are; they are stacked by number, {distance} mm apart"
        ));
        return distance;
    }
    let place = |slice: &Slice| slice.place.unwrap_or(0.0);
    slices.sort_by(|a, b| {
        place(a).total_cmp(&place(b)).then((a.instance, a.frame).cmp(&(b.instance, b.frame)))
    });
    let all = slices.len();
    slices.dedup_by(|later, earlier| (place(later) - place(earlier)).abs() < SAME_PLACE);
    if slices.len() < all {
        notes.push(format!(
            "{} slices at the place of another (time points, echoes) are left out",
            all - slices.len()
        ));
    }
    let mut gaps: Vec<f64> = slices.windows(2).map(|pair| place(&pair[1]) - place(&pair[0])).collect();
    gaps.sort_by(f64::total_cmp);
    let (Some(least), Some(greatest)) = (gaps.first(), gaps.last()) else { return written.unwrap_or(1.0) };
    let middle = gaps[gaps.len() / 2];
    if greatest - least > EVEN * middle {
        notes.push(format!(
            "its slices are {least:.3} to {greatest:.3} mm apart (are some missing?); {middle:.3} mm is taken for all"
        ));
    }
    if let (Some(low), Some(high)) =
        (slices.first().and_then(|s| s.position), slices.last().and_then(|s| s.position))
    {
        let degrees = (high - low).normalize_or(normal).dot(normal).clamp(-1.0, 1.0).acos().to_degrees();
        if degrees > 0.5 {
            notes.push(format!(
                "its slices are stacked at {degrees:.1}° (a tilted gantry); it is drawn upright"
            ));
        }
    }
    if greatest - least > EVEN * middle { middle } else { gaps.iter().sum::<f64>() / gaps.len() as f64 }
}

/// The pixels of all slices in their order.
fn gather(
    path: &Path,
    files: &[File],
    slices: &[Slice],
    pixels: usize,
    notes: &mut Vec<String>,
) -> Result<Stored, SourceError> {
    let mut all: Option<Stored> = None;
    let mut read: Option<(usize, Stored)> = None;
    for slice in slices {
        let file_path = &files[slice.file].0;
        let frames = match read.take() {
            Some((file, frames)) if file == slice.file => frames,
            _ => pixels::read(file_path, notes)?,
        };
        let part = pieces::slice(&frames, slice.frame.saturating_mul(pixels), pixels);
        let out_of_memory =
            || SourceError::OutOfMemory { path: path.to_owned(), bytes: (slices.len() * pixels) as u64 };
        // The file may have changed since its header was read.
        let part = part.ok_or_else(out_of_memory)?;
        match &mut all {
            None => all = Some(part),
            Some(all) => pieces::append(all, part).ok_or_else(out_of_memory)?,
        }
        read = Some((slice.file, frames));
    }
    all.ok_or_else(|| super::header::unsupported(path, "no slices", "name a folder with slices in it"))
}
