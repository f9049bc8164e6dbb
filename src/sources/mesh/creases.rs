//! Normals of surfaces that have edges.
//!
//! Around a vertex, triangles that meet at soft edges share a normal: the sum of theirs, each weighted by its angle at the vertex (see
//! [`super::normals`]). An edge is hard if its triangles meet at more than the crease angle, or if the file puts them into different
//! smoothing groups; an edge of more than two triangles is soft between those that go through it in opposite directions.

use super::draft::{NONE, Sparse};
use super::normals;
use super::topology::{Edges, Unions, ends_of};
use glam::{DVec3, Vec3};

/// Triangles of one edge that are compared with each other; what lies beyond only with the one before.
const MOST_COMPARED: usize = 8;

/// What makes an edge hard.
#[derive(Clone, Copy)]
pub(super) enum Creases<'a> {
    /// Triangles that meet at more than so many degrees.
    Angle(f32),
    /// Different smoothing groups, or group 0, of faces; where neither says a group, more than so many degrees.
    Groups {
        /// By face.
        groups: &'a Sparse,
        /// The face of each triangle.
        faces: &'a [u32],
        /// Degrees.
        otherwise: f32,
    },
}

/// Triangles of vertices, of which there is one for each position, and how they face.
pub(super) struct Surface<'a> {
    pub positions: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
    pub edges: &'a Edges,
}

impl Surface<'_> {
    /// One normal per corner: corner `i` of triangle `t` is at `3 t + i`.
    pub fn normals(&self, creases: Creases<'_>) -> Vec<Vec3> {
        let facings: Vec<DVec3> = self.triangles.iter().map(|&triangle| self.facing(triangle)).collect();
        let mut fans = Unions::new(3 * self.triangles.len());
        for edge in self.edges.iter() {
            for (place, &a) in edge.iter().enumerate() {
                let compared = if place < MOST_COMPARED { 0 } else { place - 1 };
                for &b in &edge[compared..place] {
                    if self.is_soft(a, b, &facings, creases) {
                        fans.join(a, next(b));
                        fans.join(next(a), b);
                    }
                }
            }
        }
        self.sum(&facings, fans)
    }

    /// The normal of its triangle for each corner.
    pub fn flat_normals(&self) -> Vec<Vec3> {
        self.triangles.iter().flat_map(|&triangle| [self.facing(triangle).as_vec3(); 3]).collect()
    }

    fn is_soft(&self, a: u32, b: u32, facings: &[DVec3], creases: Creases<'_>) -> bool {
        let (t, u) = (a as usize / 3, b as usize / 3);
        // Triangles that do not agree which way the surface faces have no common normal.
        if ends_of(self.triangles, a) == ends_of(self.triangles, b) {
            return false;
        }
        let meets_within = |degrees: f32| {
            let angle = facings[t].cross(facings[u]).length().atan2(facings[t].dot(facings[u]));
            angle <= f64::from(degrees).to_radians() + 1e-6
        };
        match creases {
            Creases::Angle(degrees) => meets_within(degrees),
            Creases::Groups { groups, faces, otherwise } => {
                match [t, u].map(|triangle| groups.get(faces[triangle] as usize)) {
                    [NONE, NONE] => meets_within(otherwise),
                    [first, second] => first == second && first != 0,
                }
            }
        }
    }

    /// The normal of each corner's fan.
    fn sum(&self, facings: &[DVec3], mut fans: Unions) -> Vec<Vec3> {
        let corners = 3 * self.triangles.len() as u32;
        let mut sums = vec![normals::Sum::default(); corners as usize];
        for corner in 0..corners {
            let [a, b, c] = [0, 1, 2].map(|turn| {
                let triangle = self.triangles[corner as usize / 3];
                self.positions[triangle[(corner as usize + turn) % 3] as usize]
            });
            sums[fans.find(corner) as usize].add(facings[corner as usize / 3], normals::angle_at(a, b, c));
        }
        (0..corners).map(|corner| sums[fans.find(corner) as usize].normal()).collect()
    }

    fn facing(&self, triangle: [u32; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|vertex| self.positions[vertex as usize]);
        normals::facing(a, b, c).unwrap_or_default()
    }
}

/// The corner after a corner of the same triangle; also the corner that a side goes to, if a side's number is that of the one it comes from.
fn next(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}
