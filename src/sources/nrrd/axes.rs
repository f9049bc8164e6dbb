//! Which axes of an NRRD file are space, which numbers of a voxel, which whole volumes, and where they lie.

use std::path::Path;

use glam::DVec3;

use super::{SourceError, header::Header};
use crate::sources::{
    grid::Grid,
    shape::{Role, Side},
    volume::Space,
};

/// More numbers than this are not guessed to be those of a voxel.
const FEW: u64 = 4;

/// One axis of the samples, the fastest first.
#[derive(Debug, Clone, Default)]
pub(super) struct Axis {
    /// Counted from 1.
    pub number: usize,
    /// How many samples it has.
    pub size: u64,
    /// What is written of its direction in the world of the file.
    pub direction: Direction,
    /// From one sample to the next, where no direction is written.
    pub spacing: Option<f64>,
    /// Where it begins and ends.
    pub ends: [Option<f64>; 2],
    /// Whether its first sample lies at its beginning, not half a step behind it.
    pub is_node_centred: bool,
    /// What the file calls it; empty where it does not.
    pub kind: String,
}

/// What is written of the direction of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) enum Direction {
    /// Nothing.
    #[default]
    Unwritten,
    /// That it is no axis of space.
    None,
    /// From one sample to the next.
    Along(DVec3),
}

impl Axis {
    /// What its kind, or its direction, makes of it; `None` where nothing does.
    fn role(&self) -> Option<Role> {
        let name = || self.name();
        match (&*self.kind.to_lowercase(), self.direction) {
            (_, Direction::Along(_)) => Some(Role::Space),
            ("domain" | "space", Direction::Unwritten) => Some(Role::Space),
            ("", Direction::Unwritten) => None,
            ("" | "list" | "time" | "domain" | "space", _) => Some(Role::Entries(name())),
            _ => Some(Role::Components(name())),
        }
    }

    fn name(&self) -> String {
        format!("axis {}, {}", self.number, if self.kind.is_empty() { "of no kind" } else { &self.kind })
    }

    /// Whether its entries are the channels of a colour.
    fn is_colour(&self) -> bool {
        let kind = self.kind.to_lowercase();
        matches!(&*kind, "3-color" | "rgb-color" | "4-color" | "rgba-color") && matches!(self.size, 3 | 4)
    }

    /// How far one sample is from the next, and where the first one lies, if that is written.
    fn step(&self, notes: &mut Vec<String>) -> (f64, Option<f64>) {
        let written = |number: Option<f64>| number.filter(|number| number.is_finite());
        let [low, high] = self.ends.map(written);
        let gaps = if self.is_node_centred { self.size.saturating_sub(1).max(1) } else { self.size.max(1) };
        let between = low.zip(high).map(|(low, high)| (high - low) / gaps as f64).filter(|step| *step != 0.0);
        if self.spacing.is_some_and(f64::is_nan) && between.is_none() {
            notes.push(format!("its spacing along axis {} is unknown (nan); 1 is taken", self.number));
        }
        let step = self.spacing.filter(|step| !step.is_nan()).or(between).unwrap_or(1.0);
        (step, low.map(|low| if self.is_node_centred { low } else { low + step / 2.0 }))
    }
}

/// What each axis is; no more than three are space.
pub(super) fn sides(axes: &[Axis]) -> Vec<Side> {
    let mut roles: Vec<Option<Role>> = axes.iter().map(Axis::role).collect();
    let is_space = |role: &Option<Role>| matches!(role, None | Some(Role::Space));
    let mut spare = roles.iter().filter(|role| is_space(role)).count().saturating_sub(3);
    let mut drop = |roles: &mut Vec<Option<Role>>, index: usize, role: Role| {
        if spare > 0 && is_space(&roles[index]) {
            roles[index] = Some(role);
            spare -= 1;
        }
    };
    for (index, axis) in axes.iter().enumerate().filter(|(_, axis)| axis.size == 1) {
        drop(&mut roles, index, Role::Entries(axis.name()));
    }
    // Where nothing is written, a few numbers that alternate are those of a voxel: three voxels across are rare.
    if let ([first, .., last], Some(None)) = (axes, roles.first())
        && first.size <= FEW
        && last.size > FEW
    {
        drop(&mut roles, 0, Role::Components(first.name()));
    }
    for (index, axis) in axes.iter().enumerate().rev() {
        drop(&mut roles, index, Role::Entries(axis.name()));
    }
    if !roles.iter().any(is_space) {
        roles.iter_mut().take(3).for_each(|role| *role = Some(Role::Space));
    }
    let side =
        |(axis, role): (&Axis, Option<Role>)| Side { samples: axis.size, role: role.unwrap_or(Role::Space) };
    axes.iter().zip(roles).map(side).collect()
}

/// Whether the numbers of a voxel are the channels of a colour.
pub(super) fn is_colour(axes: &[Axis], sides: &[Side]) -> bool {
    let mut components = axes.iter().zip(sides).filter(|(_, side)| matches!(side.role, Role::Components(_)));
    components.next().is_some_and(|(axis, _)| axis.is_colour()) && components.next().is_none()
}

/// The axes of space as a grid, where the file has them, of voxels of `bytes` bytes.
pub(super) fn grid(
    path: &Path,
    header: &Header,
    sides: &[Side],
    bytes: u64,
    notes: &mut Vec<String>,
) -> Result<Grid, SourceError> {
    let axes: Vec<&Axis> = header
        .axes
        .iter()
        .zip(sides)
        .filter(|(_, side)| side.role == Role::Space)
        .map(|(axis, _)| axis)
        .collect();
    let size: Vec<u64> = axes.iter().map(|axis| axis.size).collect();
    let (to_mm, to_ras) = (header.millimetres, header.space.to_ras());
    let along = |axis: &&Axis| match axis.direction {
        Direction::Along(direction) => Some(direction * to_ras * to_mm),
        _ => None,
    };
    if let Some(directions) = axes.iter().map(along).collect::<Option<Vec<DVec3>>>() {
        let anatomical = matches!(header.space, WorldOf::Patient(_));
        let grid = Grid::new(path, &size, &directions, anatomical, bytes)?;
        if header.space == WorldOf::LeftHanded {
            notes.push("its space is left-handed; it is shown mirrored".to_owned());
        }
        let space = if anatomical { Space::Patient } else { Space::World };
        // As ITK and Slicer take one that is not written.
        let origin = header.origin.unwrap_or(DVec3::ZERO);
        return if origin.is_nan() { Ok(grid) } else { grid.at(path, origin * to_ras * to_mm, space) };
    }
    let steps: Vec<(f64, Option<f64>)> = axes.iter().map(|axis| axis.step(notes)).collect();
    let along = |(axis, (step, _)): (usize, &(f64, Option<f64>))| {
        let mut direction = DVec3::ZERO;
        direction[axis] = step * to_mm;
        direction
    };
    let directions: Vec<DVec3> = steps.iter().enumerate().map(along).collect();
    let grid = Grid::new(path, &size, &directions, false, bytes)?;
    if steps.iter().all(|(_, first)| first.is_none()) {
        return Ok(grid);
    }
    let mut first = DVec3::ZERO;
    steps.iter().enumerate().for_each(|(axis, (_, at))| first[axis] = at.unwrap_or(0.0));
    grid.at(path, first * to_mm, Space::World)
}

/// The world that a file lies in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum WorldOf {
    /// A patient, with factors to right, anterior, superior.
    Patient(DVec3),
    /// Any other.
    Other,
    /// Any other, whose z points the other way.
    LeftHanded,
}

impl WorldOf {
    fn to_ras(self) -> DVec3 {
        match self {
            Self::Patient(factors) => factors,
            Self::Other | Self::LeftHanded => DVec3::ONE,
        }
    }
}
