//! A triangle mesh and its OBJ text.

use std::collections::HashMap;
use std::fmt::Write;

/// Positions, and three indices into them for each triangle, counter-clockwise seen from outside.
#[derive(Debug, Default, PartialEq)]
pub struct Mesh {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// OBJ text of `v` and `f` lines below the given comment.
    pub fn to_obj(&self, comment: &str) -> String {
        let mut obj = String::new();
        for line in comment.lines() {
            obj += format!("# {line}").trim_end();
            obj.push('\n');
        }
        for [x, y, z] in &self.positions {
            let _ = writeln!(obj, "v {x} {y} {z}");
        }
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|index| index + 1);
            let _ = writeln!(obj, "f {a} {b} {c}");
        }
        obj
    }

    /// Smallest and largest coordinates.
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let start = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        self.positions.iter().fold(start, |(low, high), position| {
            (
                std::array::from_fn(|axis| low[axis].min(position[axis])),
                std::array::from_fn(|axis| high[axis].max(position[axis])),
            )
        })
    }

    /// How many edges do not join exactly two triangles of one orientation: 0 for a closed surface.
    pub fn open_edges(&self) -> usize {
        let mut balance: HashMap<(u32, u32), (u32, u32)> = HashMap::new();
        for &[a, b, c] in &self.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (forward, backward) = balance.entry((from.min(to), from.max(to))).or_default();
                if from < to { *forward += 1 } else { *backward += 1 }
            }
        }
        balance.values().filter(|&&uses| uses != (1, 1)).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Mesh {
        Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        }
    }

    #[test]
    fn open_edges_are_counted() {
        let mut mesh = tetrahedron();
        assert_eq!(mesh.open_edges(), 0);
        mesh.triangles.pop();
        assert_eq!(mesh.open_edges(), 3);
        mesh.triangles.push([0, 2, 3]);
        assert_eq!(mesh.open_edges(), 3, "the wrong way round");
    }

    #[test]
    fn obj_counts_from_one() {
        let obj = tetrahedron().to_obj("by hand\n\nindeed");
        assert!(obj.starts_with("# by hand\n#\n# indeed\nv 0 0 0\n"), "{obj}");
        assert!(obj.ends_with("v 0 0 1.5\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"), "{obj}");
    }
}
