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

/// A normal in the making.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sum {
    sum: DVec3,
    weight: f64,
}

impl Sum {
    /// Adds the normal of a triangle, by its angle at the vertex.
    pub fn add(&mut self, normal: DVec3, angle: f64) {
        self.sum += angle * normal;
        self.weight += angle;
    }

    /// The direction of what was added.
    pub fn normal(&self) -> Vec3 {
        let has_direction = self.sum.length() > MIN_RELATIVE_LENGTH * self.weight;
        if has_direction { unit(self.sum).unwrap_or(FALLBACK) } else { FALLBACK }
    }
}

/// One unit normal per vertex, over all triangles that meet there.
pub(super) fn angle_weighted(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Sum::default(); positions.len()];
    for triangle in triangles {
        let corners = triangle.map(|index| positions[index as usize]);
        let Some(normal) = facing(corners[0], corners[1], corners[2]) else {
            continue;
        };
        for (vertex, angle) in triangle.iter().zip(angles(corners)) {
            sums[*vertex as usize].add(normal, angle);
        }
    }
    sums.iter().map(Sum::normal).collect()
}

/// The angles at the corners of a triangle, in radians.
pub(super) fn angles(corners: [Vec3; 3]) -> [f64; 3] {
    let [a, b, c] = corners.map(|position| position.as_dvec3());
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let twice_the_area = ab.cross(ca).length();
    [-ab.dot(ca), -bc.dot(ab), -ca.dot(bc)].map(|cosine| twice_the_area.atan2(cosine))
}
