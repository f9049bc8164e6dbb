//! A mesh with more triangles, the same surface.

use super::{MeshData, normals};
use glam::DMat3;
use std::collections::HashMap;

/// Vertices per area of a triangulation with edges about as long as 1: halving edges leaves them between a half and 1.
const VERTICES_PER_SQUARE: f64 = 2.5;

/// Lengths that are tried, each a quarter longer than the one before.
const MOST_TRIALS: usize = 24;

/// Halvings of an edge, at most: more than 32 bits can tell apart.
const MOST_ROUNDS: usize = 24;

impl MeshData {
    /// The same surface with no edge longer than `longest`, or than what a mesh of about `most_vertices` can have. `scale` takes the
    /// mesh to where `longest` is measured.
    ///
    /// Edges are halved, and a triangle is cut wherever one of its edges is, so that no gaps open between neighbours. Also answers the
    /// length that was kept to.
    pub fn refined(&self, scale: DMat3, longest: f64, most_vertices: usize) -> (Self, f64) {
        let area: f64 = self.triangles.iter().map(|triangle| self.area(scale, triangle)).sum();
        let mut kept = longest.max((area * VERTICES_PER_SQUARE / most_vertices.max(1) as f64).sqrt());
        // How many vertices a length takes depends on how even the triangles are, so it is tried.
        for _ in 0..MOST_TRIALS {
            if let Some(mesh) = self.refined_to(scale, kept, most_vertices) {
                return (mesh, kept);
            }
            kept *= 1.25;
        }
        (Self { notes: Vec::new(), ..self.clone() }, f64::INFINITY)
    }

    /// The same surface with no edge longer than `longest`; `None` if that takes too many vertices.
    fn refined_to(&self, scale: DMat3, longest: f64, most_vertices: usize) -> Option<Self> {
        let mut mesh = Self { notes: Vec::new(), ..self.clone() };
        for _ in 0..MOST_ROUNDS {
            let is_done = !mesh.halve_edges(scale, longest);
            if mesh.positions.len() > most_vertices.max(self.positions.len()) {
                return None;
            }
            if is_done {
                break;
            }
        }
        Some(mesh)
    }

    /// Halves every edge longer than `longest` once. Answers whether there was any.
    fn halve_edges(&mut self, scale: DMat3, longest: f64) -> bool {
        let mut middles: HashMap<(u32, u32), Option<u32>> = HashMap::new();
        let mut triangles = Vec::with_capacity(self.triangles.len());
        // How many triangles there are before each of the old ones: only where parts have to follow.
        let mut starts = Vec::new();
        for triangle in std::mem::take(&mut self.triangles) {
            if !self.parts.is_empty() {
                starts.push(triangles.len() as u32);
            }
            let [a, b, c] = triangle;
            let split = [(a, b), (b, c), (c, a)].map(|(from, to)| {
                let edge = (from.min(to), from.max(to));
                *middles.entry(edge).or_insert_with(|| self.middle(scale, edge, longest))
            });
            cut(triangle, split, &mut triangles);
        }
        let end = triangles.len() as u32;
        let moved = |triangle: u32| starts.get(triangle as usize).copied().unwrap_or(end);
        for part in &mut self.parts {
            part.triangles = moved(part.triangles.start)..moved(part.triangles.end);
        }
        self.triangles = triangles;
        middles.values().any(Option::is_some)
    }

    /// A new vertex in the middle of an edge, if that is too long.
    fn middle(&mut self, scale: DMat3, (from, to): (u32, u32), longest: f64) -> Option<u32> {
        let [from, to] = [from as usize, to as usize];
        let [a, b] = [from, to].map(|index| self.positions[index].as_dvec3());
        let middle = ((a + b) / 2.0).as_vec3();
        let is_new = middle != self.positions[from] && middle != self.positions[to];
        if !is_new || (scale * (b - a)).length() <= longest {
            return None;
        }
        let sum = self.normals[from].as_dvec3() + self.normals[to].as_dvec3();
        self.normals.push(normals::unit(sum).unwrap_or(self.normals[from]));
        self.positions.push(middle);
        if let (Some(a), Some(b)) = (self.colours.get(from), self.colours.get(to)) {
            self.colours.push(std::array::from_fn(|channel| (a[channel] + b[channel]) / 2.0));
        }
        if let (Some(a), Some(b)) = (self.texture_coordinates.get(from), self.texture_coordinates.get(to)) {
            self.texture_coordinates.push((*a + *b) / 2.0);
        }
        Some(self.positions.len() as u32 - 1)
    }

    fn area(&self, scale: DMat3, triangle: &[u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|index| scale * self.positions[index as usize].as_dvec3());
        (b - a).cross(c - a).length() / 2.0
    }
}

/// The pieces of a triangle of which some edges, a to b, b to c and c to a, have a new vertex in their middle.
fn cut([a, b, c]: [u32; 3], split: [Option<u32>; 3], pieces: &mut Vec<[u32; 3]>) {
    match split {
        [None, None, None] => pieces.push([a, b, c]),
        [Some(ab), None, None] => pieces.extend([[a, ab, c], [ab, b, c]]),
        [Some(ab), Some(bc), None] => pieces.extend([[ab, b, bc], [a, ab, bc], [a, bc, c]]),
        [Some(ab), Some(bc), Some(ca)] => {
            pieces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        // The same with the corners turned on.
        [ab, bc, ca] => cut([b, c, a], [bc, ca, ab], pieces),
    }
}
