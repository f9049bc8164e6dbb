//! Which positions are the same.

use glam::Vec3;
use std::collections::HashMap;

/// What tells positions apart: their bits, with -0 equal to 0.
pub(super) fn position_key(position: Vec3) -> [u32; 3] {
    (position + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// For each position the index of the first that equals it.
pub(super) fn weld(positions: &[Vec3]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    let keyed = positions.iter().enumerate();
    keyed.map(|(index, &position)| *first.entry(position_key(position)).or_insert(index as u32)).collect()
}
