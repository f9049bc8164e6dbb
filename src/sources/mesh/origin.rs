//! What positions are told relative to.

use glam::DVec3;

/// A mesh whose centre is farther out than so many times its extent is moved to it: at 16, single precision has lost the last four of its
/// 24 bits there.
const FARTHEST: f64 = 16.0;

/// Meshes smaller than this have an origin that is not rounded to whole units.
const LEAST_ROUNDED: f64 = 1.0 / 16.0;

/// The centre of the positions that are used, if they lie so far out that single precision does not resolve them; else 0.
pub(super) fn origin_of(positions: &[DVec3], used: &[u32]) -> DVec3 {
    let (mut least, mut greatest) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for position in used.iter().filter_map(|&index| positions.get(index as usize)) {
        if position.is_finite() {
            (least, greatest) = (least.min(*position), greatest.max(*position));
        }
    }
    let centre = least / 2.0 + greatest / 2.0;
    let extent = (greatest - least).max_element();
    let is_far = centre.is_finite() && centre.abs().max_element() > FARTHEST * extent;
    match is_far {
        false => DVec3::ZERO,
        // Whole units, so that what is written stays recognisable; not where that would be far out again.
        true if extent > LEAST_ROUNDED => centre.round(),
        true => centre,
    }
}
