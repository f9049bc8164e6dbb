//! Which triangles meet at which edges.
//!
//! A *side* is one of the three edges of a triangle: side `3 t + i` goes from corner `i` of triangle `t` to the next one.

use super::draft::NONE;

/// The sides of triangles, gathered by the edge that they lie on, whichever way they go.
pub(super) struct Edges {
    /// All sides between two different vertices; those of an edge stand together, in ascending order.
    sides: Vec<u32>,
    /// Where each edge begins in `sides`, and the end.
    starts: Vec<u32>,
}

impl Edges {
    /// The edges of triangles, whose indices are below `vertices`.
    pub fn of(triangles: &[[u32; 3]], vertices: usize) -> Self {
        // Sorted by the lesser end of the edge in one pass, and by the greater one among the few sides that share it.
        let mut ends = vec![0_u32; vertices + 1];
        let all = 0..3 * triangles.len() as u32;
        for side in all.clone() {
            let (a, b) = ends_of(triangles, side);
            ends[a.min(b) as usize] += u32::from(a != b);
        }
        let mut total = 0;
        for end in &mut ends {
            total += std::mem::replace(end, total);
        }
        // The greater end and the side in one number.
        let mut keyed = vec![0_u64; total as usize];
        for side in all {
            let (a, b) = ends_of(triangles, side);
            if a != b {
                let end = &mut ends[a.min(b) as usize];
                keyed[*end as usize] = u64::from(a.max(b)) << 32 | u64::from(side);
                *end += 1;
            }
        }
        let mut starts = Vec::with_capacity(triangles.len() * 3 / 2 + 2);
        let mut start = 0;
        for &end in &ends[..vertices] {
            let shared = &mut keyed[start as usize..end as usize];
            shared.sort_unstable();
            for edge in shared.chunk_by(|a, b| a >> 32 == b >> 32) {
                starts.push(start);
                start += edge.len() as u32;
            }
        }
        starts.push(start);
        let sides = keyed.into_iter().map(|key| key as u32).collect();
        Self { sides, starts }
    }

    /// The sides on each edge.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|range| &self.sides[range[0] as usize..range[1] as usize])
    }

    /// For each side the only other one on its edge; [`NONE`] if there is none, or more.
    pub fn partners(&self, triangles: usize) -> Vec<u32> {
        let mut partners = vec![NONE; 3 * triangles];
        for edge in self.iter() {
            if let &[a, b] = edge {
                partners[a as usize] = b;
                partners[b as usize] = a;
            }
        }
        partners
    }
}

/// The vertices that a side goes from and to.
pub(super) fn ends_of(triangles: &[[u32; 3]], side: u32) -> (u32, u32) {
    let triangle = triangles[side as usize / 3];
    (triangle[side as usize % 3], triangle[(side as usize + 1) % 3])
}

/// Sets of items that grow together.
pub(super) struct Unions(Vec<u32>);

impl Unions {
    /// So many items, each in a set of its own.
    pub fn new(items: usize) -> Self {
        Self((0..items as u32).collect())
    }

    /// Makes one set of those of two items.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        // The lesser one stands for both, so that sets come in the order of their first items.
        self.0[a.max(b) as usize] = a.min(b);
    }

    /// The least item of an item's set.
    pub fn find(&mut self, mut item: u32) -> u32 {
        while self.0[item as usize] != item {
            let before = self.0[self.0[item as usize] as usize];
            self.0[item as usize] = before;
            item = before;
        }
        item
    }
}
