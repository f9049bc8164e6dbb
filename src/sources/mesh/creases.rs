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

/// An angle between triangles.
struct Angle {
    radians: f64,
    cosine: f64,
}

impl Angle {
    fn of_degrees(degrees: f32) -> Self {
        let radians = f64::from(degrees).to_radians() + 1e-6;
        Self { radians, cosine: radians.cos() }
    }

    /// Whether two unit vectors are no farther apart.
    fn holds(&self, a: DVec3, b: DVec3) -> bool {
        let cosine = a.dot(b);
        // Cosines tell most angles apart, and take a tenth of the time.
        if (cosine - self.cosine).abs() > 1e-9 {
            return cosine > self.cosine;
        }
        a.cross(b).length().atan2(cosine) <= self.radians
    }
}

impl Surface<'_> {
    /// One normal per corner: corner `i` of triangle `t` is at `3 t + i`.
    pub fn normals(&self, creases: Creases<'_>) -> Vec<Vec3> {
        let facings: Vec<DVec3> = self.triangles.iter().map(|&triangle| self.facing(triangle)).collect();
        let mut fans = Unions::new(3 * self.triangles.len());
        let (Creases::Angle(degrees) | Creases::Groups { otherwise: degrees, .. }) = creases;
        let widest = Angle::of_degrees(degrees);
        for edge in self.edges.iter() {
            for (place, &a) in edge.iter().enumerate() {
                let compared = if place < MOST_COMPARED { 0 } else { place - 1 };
                for &b in &edge[compared..place] {
                    if self.is_soft(a, b, &facings, creases, &widest) {
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

    fn is_soft(&self, a: u32, b: u32, facings: &[DVec3], creases: Creases<'_>, widest: &Angle) -> bool {
        let (t, u) = (a as usize / 3, b as usize / 3);
        // Triangles that do not agree which way the surface faces have no common normal.
        if ends_of(self.triangles, a) == ends_of(self.triangles, b) {
            return false;
        }
        match creases {
            Creases::Angle(_) => widest.holds(facings[t], facings[u]),
            Creases::Groups { groups, faces, .. } => {
                match [t, u].map(|triangle| groups.get(faces[triangle] as usize)) {
                    [NONE, NONE] => widest.holds(facings[t], facings[u]),
                    [first, second] => first == second && first != 0,
                }
            }
        }
    }

    /// The normal of each corner's fan.
    fn sum(&self, facings: &[DVec3], mut fans: Unions) -> Vec<Vec3> {
        // Fans are far fewer than corners: each has a number, in the order of their first corners.
        let mut numbers = Vec::with_capacity(3 * self.triangles.len());
        let mut sums: Vec<normals::Sum> = Vec::with_capacity(self.triangles.len());
        for (triangle, &facing) in self.triangles.iter().zip(facings) {
            for angle in normals::angles(triangle.map(|vertex| self.positions[vertex as usize])) {
                let corner = numbers.len() as u32;
                let first = fans.find(corner);
                let number = if first == corner { sums.len() as u32 } else { numbers[first as usize] };
                if first == corner {
                    sums.push(normals::Sum::default());
                }
                sums[number as usize].add(facing, angle);
                numbers.push(number);
            }
        }
        let normals: Vec<Vec3> = sums.iter().map(normals::Sum::normal).collect();
        numbers.into_iter().map(|number| normals[number as usize]).collect()
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
