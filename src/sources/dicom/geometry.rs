//! Where the frames of a file are.

use std::path::Path;

use glam::DVec3;

use super::{SourceError, attributes::Attributes, header::Header, tags};

/// Where a frame is, as far as its file says.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Place {
    /// Of its first pixel: left, posterior, superior, mm.
    pub position: Option<DVec3>,
    /// Along the normal of the frame, mm.
    pub along: Option<f64>,
}

/// A direction within the plane closer to the world's up than this is a plane that lies: the absolute form of offsets is for
/// these only.
const LYING: f64 = 0.99;

/// The direction from one frame to the next.
pub(super) fn normal(frame: &Attributes) -> DVec3 {
    let [x, y] = frame.orientation.unwrap_or([DVec3::X, DVec3::Y]);
    x.cross(y).normalize_or(DVec3::Z)
}

/// Where each frame of a file is.
///
/// # Errors
///
/// If what says so cannot be understood.
pub(super) fn places(
    path: &Path,
    header: &Header,
    notes: &mut Vec<String>,
) -> Result<Vec<Place>, SourceError> {
    let frames = header.frames;
    if frames == 1 || header.places_each_frame() {
        return (0..frames).map(|frame| own_place(path, header, frame)).collect();
    }
    let first = header.frame(0);
    let normal = normal(&first);
    if header.offsets.len() == frames {
        return Ok(by_offsets(&header.offsets, &first, normal));
    }
    if !header.offsets.is_empty() {
        notes.push(format!(
            "{} has {} places for {frames} frames; it is left out",
            tags::called(tags::OFFSETS),
            header.offsets.len()
        ));
    }
    header.needs(path, &[tags::BETWEEN])?;
    let Some(step) = first.between.filter(|step| *step != 0.0) else {
        return Ok(vec![Place::default(); frames]);
    };
    let number = |frame: usize| match header.slice_vector.get(frame) {
        Some(slice) if header.slice_vector.len() == frames => f64::from(*slice) - 1.0,
        _ => frame as f64,
    };
    Ok((0..frames).map(|frame| at(&first, normal, step * number(frame))).collect())
}

/// The place that a frame says for itself.
fn own_place(path: &Path, header: &Header, frame: usize) -> Result<Place, SourceError> {
    let own = header.frame(frame);
    let along = own.position.map(|position| position.dot(normal(&own)));
    if along.is_none() {
        header.needs(path, &[tags::SLICE_LOCATION])?;
    }
    Ok(Place { position: own.position, along: along.or(header.location) })
}

/// Places of a dose: from the first frame where they begin with 0, otherwise heights in the patient.
fn by_offsets(offsets: &[f64], first: &Attributes, normal: DVec3) -> Vec<Place> {
    let begin = offsets.first().copied().unwrap_or(0.0);
    let is_absolute = begin != 0.0 && normal.z.abs() > LYING;
    let direction = if is_absolute { normal.z.signum() } else { 1.0 };
    offsets.iter().map(|offset| at(first, normal, (offset - begin) * direction)).collect()
}

/// The place so far from the first frame.
fn at(first: &Attributes, normal: DVec3, distance: f64) -> Place {
    let position = first.position.map(|position| position + normal * distance);
    let along = position.map_or(distance, |position| position.dot(normal));
    Place { position, along: Some(along) }
}
