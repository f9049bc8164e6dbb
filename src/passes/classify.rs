//! Transfer functions become lookup tables, and bricks of volumes are found empty or not.
//!
//! Reads components and the ranges of bricks; writes [`Classified`]: a table of colour and extinction, and for each brick of 8^3
//! voxels how far the nearest one is that holds anything. Reruns for a volume when its transfer function, data, or the unit of the scene
//! changes; what depends on part of it goes by the [`Versions`] of that part.

use crate::components::{Classification, SceneSettings, TransferFunction, Volume};
use crate::gpu::VolumeFormat;
use crate::loading::LoadedVolume;
use crate::optics::transfer::{Cumulative, Held, LookupTable};
use crate::report::Report;
use crate::sources::mesh::extremes;
use crate::sources::{BrickRanges, VolumeData};
use bevy_ecs::prelude::*;
use glam::Vec3;

/// What a transfer function makes of a volume.
#[derive(Component, Debug)]
pub(crate) struct Classified {
    /// Colour and extinction per scene unit, over `domain`.
    pub table: LookupTable,
    /// The data values at both ends of the table.
    pub domain: (f32, f32),
    /// Bricks along each axis.
    pub bricks: [u32; 3],
    /// Points around what can be noticed, in voxels from the volume's corner; none where nothing can.
    pub extent: Vec<Vec3>,
    /// Distance of each brick from the nearest that holds something, in bricks, at most 255; 0 is such a brick.
    pub distances: Vec<u8>,
    /// When the function is applied; where nothing lies between voxels, `Post` is as good as any.
    pub classification: Classification,
    /// Whether a place has the value of the nearest voxel.
    pub is_nearest: bool,
    /// The table's extinction and layers added up from its lower end: the optical depth of segments of any length.
    pub cumulative: Cumulative,
    /// Which of all there have been.
    pub versions: Versions,
    /// What it was made from.
    function: TransferFunction,
}

/// What a classification is compared by: each counts up whenever its part differs from what it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Versions {
    /// Extinction by data value, and the bricks that hold any.
    pub extinction: u64,
    /// The same, and colours.
    pub table: u64,
}

impl Classified {
    /// Place in the table, from 0 to 1, of a texel = texel * scale + offset.
    pub fn lookup(&self, format: VolumeFormat) -> (f32, f32) {
        let (low, high) = self.domain;
        (format.scale / (high - low), (format.offset - low) / (high - low))
    }

    /// The greatest extinction of any value, per scene unit.
    pub fn greatest_extinction(&self) -> f64 {
        f64::from(self.table.entries.iter().map(|entry| entry.w).fold(0.0, f32::max))
    }

    /// Extinction at a data value, per scene unit.
    pub fn extinction_of(&self, value: f32) -> f64 {
        let entries = &self.table.entries;
        let at = self.table.position(self.domain, value).round().clamp(0.0, (entries.len() - 1) as f64);
        f64::from(entries[at as usize].w)
    }

    /// With the versions of what stood here before, as far as it is the same; `next` where it is not.
    fn versioned(self, former: Option<&Self>, next: u64) -> Self {
        let next = Versions { extinction: next, table: next };
        let versions = former.map_or(next, |former| {
            let same_extinction = self.cumulative == former.cumulative
                && (self.domain, self.is_nearest) == (former.domain, former.is_nearest)
                && self.distances == former.distances;
            let same_table = same_extinction && self.table == former.table;
            Versions {
                extinction: if same_extinction { former.versions.extinction } else { next.extinction },
                table: if same_table { former.versions.table } else { next.table },
            }
        });
        Self { versions, ..self }
    }
}

type Classifiable<'a> =
    (Entity, &'a TransferFunction, &'a Volume, Ref<'a, LoadedVolume>, Option<&'a Classified>);

pub(crate) fn classify(
    mut commands: Commands,
    volumes: Query<Classifiable>,
    settings: Res<SceneSettings>,
    (mut unit, mut version): (Local<f32>, Local<u64>),
    mut report: ResMut<Report>,
) {
    let has_other_unit =
        std::mem::replace(&mut *unit, settings.millimetres_per_unit) != settings.millimetres_per_unit;
    for (entity, function, component, volume, former) in &volumes {
        let is_same = former.is_some_and(|former| former.function == *function);
        if is_same && !volume.is_changed() && !has_other_unit {
            continue;
        }
        *version += 1;
        let domain = volume.domain(function);
        let in_force = volume.function_in_force(function);
        let is_nearest = volume.is_nearest(component, &in_force);
        let voxel = volume.data.spacing.min_element();
        let table = LookupTable::new(&in_force, domain, voxel, settings.millimetres_per_unit);
        let bricks = &volume.data.bricks;
        let held = table.holds_something();
        let occupied: Vec<bool> = bricks
            .ranges
            .iter()
            .map(|range| held.between(table.position(domain, range[0]), table.position(domain, range[1])))
            .collect();
        let extent = extent(&volume.data, &table.holds_noticeable(), |value| table.position(domain, value));
        let distances = distances(bricks.size, &occupied);
        report
            .ran("classify", &[("entries", table.entries.len() as u64), ("bricks", distances.len() as u64)]);
        let classified = Classified {
            cumulative: table.cumulative(),
            table,
            domain,
            bricks: bricks.size,
            extent,
            distances,
            classification: if is_nearest { Classification::Post } else { function.classification },
            is_nearest,
            versions: Versions::default(),
            function: function.clone(),
        };
        commands.entity(entity).insert(classified.versioned(former, *version));
    }
}

/// Points around what can be noticed, in voxels from the volume's corner; none where nothing can.
///
/// Where it begins and ends along the axes is known to a voxel, in between to a brick.
fn extent(data: &VolumeData, held: &Held, place: impl Fn(f32) -> f64) -> Vec<Vec3> {
    let holds = |range: &[f32; 2]| range[0] <= range[1] && held.between(place(range[0]), place(range[1]));
    let bounds = [0, 1, 2].map(|axis| {
        let slices = &data.slices.along[axis];
        let (first, last) = (slices.iter().position(holds), slices.iter().rposition(holds));
        first.zip(last).map(|(first, last)| (first as f32, (last + 1) as f32))
    });
    let [Some(x), Some(y), Some(z)] = bounds else { return Vec::new() };
    let (low, high) = (Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1));
    let [bricks, rows, _] = data.bricks.size.map(|side| side as usize);
    let mut points = Vec::new();
    for (row, ranges) in data.bricks.ranges.chunks_exact(bricks).enumerate() {
        let (Some(first), Some(last)) = (ranges.iter().position(holds), ranges.iter().rposition(holds))
        else {
            continue;
        };
        let brick = |x: usize| Vec3::new(x as f32, (row % rows) as f32, (row / rows) as f32);
        for (corner, step) in [(brick(first), 0.0), (brick(last), 1.0)] {
            for (y, z) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
                let voxel = (corner + Vec3::new(step, y, z)) * BrickRanges::BRICK as f32;
                points.push(voxel.clamp(low, high));
            }
        }
    }
    extremes(&points)
}

/// Distance of each cell from the nearest occupied one, as a king moves in three dimensions, at most 255.
fn distances(size: [u32; 3], occupied: &[bool]) -> Vec<u8> {
    let mut distances: Vec<u8> = occupied.iter().map(|occupied| if *occupied { 0 } else { 255 }).collect();
    let [x, y, z] = size.map(|side| side as usize);
    // The Chebyshev distance is separable only as a minimum over boxes: each axis in turn spreads the maximum of distance and offset.
    spread(&mut distances, x, 1, |line| line * x, y * z);
    spread(&mut distances, y, x, |line| line / x * (x * y) + line % x, x * z);
    spread(&mut distances, z, x * y, |line| line, x * y);
    distances
}

/// One axis of [`distances`]: `d[i] = min over j of max(d[j], |i - j|)` along every line.
fn spread(distances: &mut [u8], length: usize, stride: usize, start: impl Fn(usize) -> usize, lines: usize) {
    let mut line = vec![0u8; length];
    for index in 0..lines {
        let first = start(index);
        for (cell, value) in line.iter_mut().enumerate() {
            *value = distances[first + cell * stride];
        }
        for cell in 0..length {
            let mut best = line[cell];
            let mut offset = 1;
            while offset < usize::from(best) && (offset <= cell || cell + offset < length) {
                let before = if offset <= cell { line[cell - offset] } else { 255 };
                let behind = line.get(cell + offset).copied().unwrap_or(255);
                best = best.min(before.min(behind).max(offset.min(255) as u8));
                offset += 1;
            }
            distances[first + cell * stride] = best;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_a_king() {
        let size = [7, 5, 6];
        let cells: Vec<[i32; 3]> =
            (0..6).flat_map(|z| (0..5).flat_map(move |y| (0..7).map(move |x| [x, y, z]))).collect();
        let set = [[0, 0, 0], [6, 4, 3], [2, 3, 5]];
        let occupied: Vec<bool> = cells.iter().map(|cell| set.contains(cell)).collect();
        let expected: Vec<u8> = cells
            .iter()
            .map(|cell| {
                set.iter()
                    .map(|other| {
                        (0..3).map(|axis| (cell[axis] - other[axis]).unsigned_abs() as u8).max().unwrap()
                    })
                    .min()
                    .unwrap()
            })
            .collect();
        assert_eq!(distances(size, &occupied), expected);
        assert!(distances([3, 1, 1], &[false; 3]).iter().all(|distance| *distance == 255));
    }
}
