//! Vertex normals where a file has none.
//!
//! Weights: Thürmer and Wüthrich, "Computing vertex normals from polygonal facets", JGT 3(1), 1998: each triangle counts by
//! its angle at the vertex, so the result does not depend on how a flat face is cut into triangles.
//!
//! Everything is in f64. The fourth power of any finite f32, which is the worst that occurs, neither overflows nor vanishes
//! there, so no coordinates need rescaling.

use glam::{DVec3, Vec3};

/// The normal where no triangle gives one a direction.
pub(super) const FALLBACK: Vec3 = Vec3::Y;

/// Sums of unit normals shorter than this, relative to the weights summed, are rounding errors of normals that cancel.
const MIN_RELATIVE_LENGTH: f64 = 1e-9;

/// The vector in single-precision unit length; `None` if it has no direction.
pub(super) fn unit(vector: DVec3) -> Option<Vec3> {
    let scale = vector.abs().max_element();
    if scale > 0.0 && vector.is_finite() { Some((vector / scale).normalize().as_vec3()) } else { None }
}

/// The unit normal of a triangle; `None` if its area is zero or not finite.
pub(super) fn facing(a: Vec3, b: Vec3, c: Vec3) -> Option<DVec3> {
    let [a, b, c] = [a, b, c].map(|position| position.as_dvec3());
    let cross = (b - a).cross(c - a);
    let scale = cross.abs().max_element();
    if scale > 0.0 && cross.is_finite() { Some((cross / scale).normalize()) } else { None }
}

/// One unit normal per position, equal where `welded` names the same position; all triangles must lie inside `positions`.
pub(super) fn angle_weighted(positions: &[Vec3], welded: &[u32], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![(DVec3::ZERO, 0.0); positions.len()];
    for triangle in triangles {
        let corners = triangle.map(|index| positions[index as usize]);
        let Some(normal) = facing(corners[0], corners[1], corners[2]) else {
            continue;
        };
        for corner in 0..3 {
            let angle = angle_at(corners[corner], corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
            let (sum, weight) = &mut sums[welded[triangle[corner] as usize] as usize];
            *sum += angle * normal;
            *weight += angle;
        }
    }
    let of_welded = |&first: &u32| {
        let (sum, weight) = sums[first as usize];
        if sum.length() > MIN_RELATIVE_LENGTH * weight { unit(sum).unwrap_or(FALLBACK) } else { FALLBACK }
    };
    welded.iter().map(of_welded).collect()
}

/// The angle at `a` between the edges to `b` and `c`, in radians.
pub(super) fn angle_at(a: Vec3, b: Vec3, c: Vec3) -> f64 {
    let [a, b, c] = [a, b, c].map(|position| position.as_dvec3());
    let (u, v) = (b - a, c - a);
    u.cross(v).length().atan2(u.dot(v))
}
