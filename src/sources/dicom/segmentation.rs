//! Masks of parts of the body as one volume of labels.

use std::path::Path;

use super::{
    SourceError, VolumeData,
    header::{Header, unsupported},
    pixels::{self, Pixels},
    segments::{Form, Segments},
    series::grid,
    slices::{self, Slice, Stack},
    tags,
};
use crate::sources::{
    stored::{Scaling, Stored},
    volume::{Label, Labels, checked_bytes},
};

/// Planes of a volume of masks, beside 16 times as many as there are masks: masks far apart must not take memory for what
/// lies between them without a bound.
const MAX_PLANES: usize = 1024;

/// Masks closer to a plane than this part of their distance are in it.
const IN_PLANE: f64 = 0.1;

/// The volume of all segments of a file: a label for each, or the fractions of the only one.
pub(super) fn assemble(
    path: &Path,
    file: &Path,
    header: &Header,
    mut notes: Vec<String>,
) -> Result<VolumeData, SourceError> {
    let files = [(file.to_owned(), header.clone())];
    let slices = slices::all(&files, &mut notes)?;
    let planes = planes(path, &slices, header, &mut notes)?;
    let stack = Stack { slices: planes.first_of_each(&slices), distance: planes.distance, leaning: None };
    let grid = grid(path, &stack, header, &mut notes)?;
    let Pixels::Values(Stored::U8(masks)) = pixels::read(file, &mut notes)? else {
        return Err(unsupported(path, "its masks are not of 1 or 8 bits", "export it again"));
    };
    let pixels = header.image.pixels();
    let size = [header.image.columns.into(), header.image.rows.into(), planes.count as u32];
    let layout = |problem| SourceError::Layout { path: path.to_owned(), problem };
    let bytes = checked_bytes(size, 2).map_err(layout)?;
    let out_of_memory = || SourceError::OutOfMemory { path: path.to_owned(), bytes };
    let numbers: std::collections::BTreeSet<i64> =
        slices.iter().filter_map(|slice| slice.is.segment).collect();
    let is_one_fraction = header.segments.form == Form::Fractional && numbers.len() <= 1;
    let whole = if header.segments.form == Form::Fractional { header.segments.greatest.max(1) } else { 1 };
    let mut labels: Vec<u16> = Vec::new();
    let mut fractions: Vec<u8> = Vec::new();
    let all = pixels * planes.count;
    labels.try_reserve_exact(all).map_err(|_| out_of_memory())?;
    labels.resize(all, 0);
    fractions.try_reserve_exact(all).map_err(|_| out_of_memory())?;
    fractions.resize(all, 0);
    let mut shared = 0_u64;
    for (slice, plane) in slices.iter().zip(&planes.of_slice) {
        let mask = masks.get(slice.frame * pixels..(slice.frame + 1) * pixels).ok_or_else(out_of_memory)?;
        let number = u16::try_from(slice.is.segment.unwrap_or(1)).unwrap_or(u16::MAX);
        for (at, fraction) in mask.iter().enumerate() {
            let voxel = plane * pixels + at;
            let belongs = if is_one_fraction {
                *fraction > 0
            } else {
                2 * u16::from(*fraction) >= whole && *fraction > 0
            };
            if !belongs {
                continue;
            }
            shared += u64::from(labels[voxel] != 0 && labels[voxel] != number);
            // The greater fraction counts, and of equal ones the later segment.
            if (*fraction, number) >= (fractions[voxel], labels[voxel]) {
                (fractions[voxel], labels[voxel]) = (*fraction, number);
            }
        }
    }
    if shared > 0 {
        notes.push(format!(
            "{shared} voxels belong to several segments; they show the one of the greatest fraction, or else of the highest number"
        ));
    }
    if is_one_fraction {
        notes.push(format!("its values are fractions of {whole} of one segment"));
        let mut volume = grid.volume(path, Stored::U8(fractions), &Scaling::NONE, notes)?;
        volume.window = Some((0.0, whole.into()));
        return Ok(volume);
    }
    if header.segments.form == Form::Fractional {
        notes.push("its masks are fractions; a voxel belongs to a segment from half on".to_owned());
    }
    let stored = if labels.iter().all(|label| *label < 256) {
        Stored::U8(labels.iter().map(|label| *label as u8).collect())
    } else {
        Stored::U16(labels)
    };
    let mut volume = grid.volume(path, stored, &Scaling::NONE, notes)?;
    volume.labels = Some(self::labels(&header.segments));
    Ok(volume)
}

/// What the labels mean.
pub(super) fn labels(segments: &Segments) -> Labels {
    let label = |segment: &super::segments::Segment| Label {
        value: segment.number as f32,
        name: segment.label.clone(),
        colour: segment
            .colour()
            .map(|[red, green, blue]| [red, green, blue, u8::MAX].map(|channel| f32::from(channel) / 255.0)),
    };
    Labels { entries: segments.all.iter().map(label).collect() }
}

/// Planes at equal distances, in which the masks lie.
struct Planes {
    count: usize,
    distance: f64,
    /// The plane of each mask.
    of_slice: Vec<usize>,
    /// A mask of the lowest plane.
    lowest: usize,
}

impl Planes {
    /// As many slices as there are planes, all at the lowest: only it has to have its place.
    fn first_of_each(&self, slices: &[Slice]) -> Vec<Slice> {
        vec![slices[self.lowest].clone(); self.count]
    }
}

/// Finds the planes of masks. Those in which there is nothing are often left out of a file.
fn planes(
    path: &Path,
    slices: &[Slice],
    header: &Header,
    notes: &mut Vec<String>,
) -> Result<Planes, SourceError> {
    let places: Option<Vec<f64>> = slices.iter().map(|slice| slice.place.along).collect();
    let Some(places) = places else {
        return Err(unsupported(
            path,
            "its masks do not say where they are",
            "export it again with PlanePositionSequence",
        ));
    };
    header.needs(path, &[tags::BETWEEN, tags::THICKNESS])?;
    let mut sorted = places.clone();
    sorted.sort_by(f64::total_cmp);
    let (low, high) = (sorted[0], sorted[sorted.len() - 1]);
    let least = sorted
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|gap| *gap > 1e-3)
        .fold(f64::INFINITY, f64::min);
    let written = slices[0].is.between.map(f64::abs).filter(|distance| *distance > 1e-3);
    let fits = |distance: f64| {
        places.iter().all(|place| {
            let plane = (place - low) / distance;
            (plane - plane.round()).abs() < IN_PLANE
        })
    };
    let otherwise = if least.is_finite() {
        least
    } else {
        slices[0].is.thickness.filter(|thick| *thick > 0.0).unwrap_or(1.0)
    };
    let distance = written.filter(|distance| fits(*distance)).unwrap_or(otherwise);
    if !fits(distance) {
        notes.push(format!(
            "its masks are not at equal distances; each is drawn in the nearest plane, {distance:.3} mm apart"
        ));
    }
    let count = ((high - low) / distance).round() + 1.0;
    let most = MAX_PLANES.max(16 * slices.len());
    if count > most as f64 {
        return Err(SourceError::Field {
            path: path.to_owned(),
            field: tags::called(tags::POSITION),
            problem: format!(
                "{} masks from {low} to {high} mm, {distance} mm apart, are {count} planes; at most {most} are read",
                slices.len()
            ),
        });
    }
    let of_slice = places.iter().map(|place| ((place - low) / distance).round() as usize).collect();
    let lowest = places.iter().position(|place| *place == low).unwrap_or(0);
    Ok(Planes { count: count as usize, distance, of_slice, lowest })
}
