//! The frames of a series in the order in which they lie, and how far apart they are.

use std::{
    collections::{BTreeMap, HashMap},
    path::Path,
};

use glam::{DVec3, IVec3};

use super::{
    File, SourceError,
    attributes::Attributes,
    geometry::{Place, normal, places},
    header::Header,
    tags,
};

/// Slices closer than this are at the same place, mm.
const SAME_PLACE: f64 = 1e-3;

/// Distances of slices that differ by less than this part are equal.
pub(super) const EVEN: f64 = 0.02;

/// A stack that leans less is upright: an error of rounding, degrees.
const UPRIGHT: f64 = 0.05;

/// One image, and its place.
#[derive(Debug, Clone)]
pub(super) struct Slice {
    /// Which file.
    pub file: usize,
    /// Which frame of it.
    pub frame: usize,
    /// What is said of it.
    pub is: Attributes,
    /// Where it is.
    pub place: Place,
    /// Slope and intercept of its values.
    pub scale: [f64; 2],
    /// Numbers of the acquisition and of the image.
    number: [i64; 2],
}

impl Slice {
    fn along(&self) -> f64 {
        self.place.along.unwrap_or(0.0)
    }

    fn key(&self) -> (Option<[IVec3; 2]>, Option<String>) {
        let rounded = |axis: DVec3| (axis * 100.0).round().as_ivec3();
        (self.is.orientation.map(|axes| axes.map(rounded)), self.is.stack.clone())
    }
}

/// Slices that make a volume, and the step from each to the next.
#[derive(Debug)]
pub(super) struct Stack {
    /// In their order along the normal.
    pub slices: Vec<Slice>,
    /// Their distance, mm.
    pub distance: f64,
    /// The way from one to the next in the patient, mm, where they are not stacked straight.
    pub leaning: Option<DVec3>,
}

/// All frames of all files.
///
/// # Errors
///
/// If what says where they are cannot be understood.
pub(super) fn all(files: &[File], notes: &mut Vec<String>) -> Result<Vec<Slice>, SourceError> {
    let mut slices = Vec::new();
    for (file, (path, header)) in files.iter().enumerate() {
        let places = places(path, header, notes)?;
        slices.extend(places.into_iter().enumerate().map(|(frame, place)| Slice {
            file,
            frame,
            is: header.frame(frame),
            place,
            scale: header.scale(frame),
            number: header.number,
        }));
    }
    Ok(slices)
}

/// The volume of number `index` among slices: those of one direction and stack, and of these one at each place.
///
/// # Errors
///
/// If there is no such volume.
pub(super) fn choose(
    path: &Path,
    slices: Vec<Slice>,
    index: u32,
    notes: &mut Vec<String>,
) -> Result<Vec<Slice>, SourceError> {
    let mut parts: Vec<Vec<Slice>> = Vec::new();
    let mut part_of = HashMap::new();
    for slice in slices {
        let part = *part_of.entry(slice.key()).or_insert(parts.len());
        if part == parts.len() {
            parts.push(Vec::new());
        }
        parts[part].push(slice);
    }
    parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
    let count = parts.len();
    let mut volumes: Vec<Vec<Slice>> = parts.into_iter().flat_map(at_each_place).collect();
    let total = volumes.len();
    if index as usize >= total {
        return Err(SourceError::Field {
            path: path.to_owned(),
            field: "index".to_owned(),
            problem: format!(
                "{index} is beyond the last of its {total} volumes; they count from 0 to {}",
                total - 1
            ),
        });
    }
    let left_out: usize = volumes.iter().map(Vec::len).sum();
    let chosen = volumes.swap_remove(index as usize);
    let left_out = left_out - chosen.len();
    if left_out > 0 {
        let others = if count > 1 {
            format!("{left_out} slices of other directions or stacks, or at the place of another,")
        } else {
            format!("{left_out} slices at the place of another (time points, echoes)")
        };
        notes.push(format!("{others} are left out; `index` chooses one of {total} volumes, this is {index}"));
    }
    Ok(chosen)
}

/// Volumes of one slice at each place: the first of all, the second, and so on.
fn at_each_place(mut slices: Vec<Slice>) -> Vec<Vec<Slice>> {
    if slices.iter().any(|slice| slice.place.along.is_none()) {
        slices.sort_by_key(|slice| (slice.number, slice.file, slice.frame));
        return vec![slices];
    }
    slices.sort_by(|a, b| {
        let later = |slice: &Slice| (slice.is.time, slice.number, slice.file, slice.frame);
        let apart = a.along() - b.along();
        if apart.abs() < SAME_PLACE { later(a).cmp(&later(b)) } else { apart.total_cmp(&0.0) }
    });
    let mut by_time: BTreeMap<i64, Vec<Slice>> = BTreeMap::new();
    for slice in &slices {
        by_time.entry(slice.is.time.unwrap_or(i64::MIN)).or_default().push(slice.clone());
    }
    let mut volumes: Vec<Vec<Slice>> = Vec::new();
    let (mut last, mut number) = (f64::NEG_INFINITY, 0);
    for slice in slices {
        number = if slice.along() - last < SAME_PLACE { number + 1 } else { 0 };
        last = if number == 0 { slice.along() } else { last };
        if volumes.len() <= number {
            volumes.push(Vec::new());
        }
        volumes[number].push(slice);
    }
    // Where a time is missing at some place, the others would take its turn.
    let is_even = volumes.iter().all(|volume| volume.len() == volumes[0].len());
    if !is_even && !by_time.contains_key(&i64::MIN) && by_time.len() == volumes.len() {
        return by_time.into_values().collect();
    }
    volumes
}

/// The distance of slices in their order; what is odd about it is told.
///
/// # Errors
///
/// If it depends on what cannot be understood.
pub(super) fn stack(
    path: &Path,
    slices: Vec<Slice>,
    first: &Header,
    notes: &mut Vec<String>,
) -> Result<Stack, SourceError> {
    let written = || {
        first.needs(path, &[tags::BETWEEN, tags::THICKNESS])?;
        let frame = &slices[0].is;
        Ok(frame.between.or(frame.thickness).map(f64::abs).filter(|distance| *distance > 0.0))
    };
    if slices.len() == 1 {
        let distance = written()?.unwrap_or(1.0);
        return Ok(Stack { slices, distance, leaning: None });
    }
    if slices.iter().any(|slice| slice.place.along.is_none()) {
        let distance = written()?.unwrap_or(1.0);
        notes.push(format!(
            "its slices do not say where they are; they are stacked by number, {distance} mm apart"
        ));
        return Ok(Stack { slices, distance, leaning: None });
    }
    if slices.iter().any(|slice| slice.place.position.is_none()) {
        notes.push(
            "its slices have no position in the patient; they are stacked by what else says where they are"
                .to_owned(),
        );
    }
    let mut gaps: Vec<f64> = slices.windows(2).map(|pair| pair[1].along() - pair[0].along()).collect();
    gaps.sort_by(f64::total_cmp);
    let (least, greatest, middle) = (gaps[0], gaps[gaps.len() - 1], gaps[gaps.len() / 2]);
    let is_even = greatest - least <= EVEN * middle;
    if !is_even {
        notes.push(format!(
            "its slices are {least:.3} to {greatest:.3} mm apart (are some missing?); {middle:.3} mm is taken for all"
        ));
    }
    let distance = if is_even { gaps.iter().sum::<f64>() / gaps.len() as f64 } else { middle };
    let leaning = leaning(&slices, distance, notes);
    Ok(Stack { slices, distance, leaning })
}

/// The way from slice to slice where it is not along their normal, as under a tilted gantry.
fn leaning(slices: &[Slice], distance: f64, notes: &mut Vec<String>) -> Option<DVec3> {
    let (first, last) = (slices.first()?, slices.last()?);
    let normal = normal(&first.is);
    let way = last.place.position? - first.place.position?;
    let degrees = way.normalize_or(normal).dot(normal).clamp(-1.0, 1.0).acos().to_degrees();
    if degrees > 0.5 {
        notes.push(format!(
            "its slices are stacked at {degrees:.1}° (a tilted gantry); it is drawn upright, unless in the patient"
        ));
    }
    (degrees > UPRIGHT).then(|| way * (distance / way.dot(normal)))
}
