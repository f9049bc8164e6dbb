//! Which closed parts of a mesh lie inside which others.

use super::draft::NONE;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Triangles that are looked at in all: some seconds' work. Parts that it does not reach count as lying inside none.
const MOST_WORK: usize = 1 << 25;

/// A closed part.
struct Shell {
    part: usize,
    bounds: (DVec3, DVec3),
    is_inward: bool,
    /// Its triangles, facing one way.
    triangles: Vec<[u32; 3]>,
}

/// All closed parts.
pub(super) struct Shells<'a> {
    positions: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    shells: Vec<Shell>,
}

impl<'a> Shells<'a> {
    pub fn new(positions: &'a [Vec3], triangles: &'a [[u32; 3]]) -> Self {
        Self { positions, triangles, shells: Vec::new() }
    }

    pub fn add(&mut self, part: usize, bounds: (DVec3, DVec3), is_inward: bool) {
        self.shells.push(Shell { part, bounds, is_inward, triangles: Vec::new() });
    }

    /// Hands each shell its triangles.
    pub fn fill(&mut self, part_of: &[u32], differs: &[bool]) {
        let parts = self.shells.last().map_or(0, |shell| shell.part + 1);
        let mut shell_of = vec![NONE; parts];
        for (index, shell) in self.shells.iter().enumerate() {
            shell_of[shell.part] = index as u32;
        }
        for (triangle, &[a, b, c]) in self.triangles.iter().enumerate() {
            let shell = shell_of.get(part_of[triangle] as usize).copied().unwrap_or(NONE);
            if let Some(shell) = self.shells.get_mut(shell as usize) {
                shell.triangles.push(if differs[triangle] { [a, c, b] } else { [a, b, c] });
            }
        }
    }

    /// The outermost part around each part that has one. Those that face outwards are only looked for in parts that face inwards.
    pub fn outermost(&self) -> HashMap<usize, usize> {
        let mut by_size: Vec<&Shell> = self.shells.iter().collect();
        let size = |shell: &Shell| (shell.bounds.1 - shell.bounds.0).length_squared();
        by_size.sort_by(|a, b| size(b).total_cmp(&size(a)).then(a.part.cmp(&b.part)));
        let mut work = 0;
        let mut outermost = HashMap::new();
        for shell in &by_size {
            let mut holds = |outer: &&&Shell| {
                work += 1;
                (shell.is_inward || outer.is_inward) && self.holds(outer, shell, &mut work)
            };
            let mut larger = by_size.iter().take_while(|outer| size(outer) > size(shell));
            // The largest that holds it is held by none.
            if let Some(outer) = larger.find(&mut holds) {
                outermost.insert(shell.part, outer.part);
            }
            if work > MOST_WORK {
                break;
            }
        }
        outermost
    }

    /// Whether a shell lies wholly inside another one; three of its corners stand for it.
    fn holds(&self, outer: &Shell, inner: &Shell, work: &mut usize) -> bool {
        let (outer_box, inner_box) = (outer.bounds, inner.bounds);
        let is_within = outer_box.0.cmple(inner_box.0).all() && inner_box.1.cmple(outer_box.1).all();
        if !is_within || *work > MOST_WORK {
            return false;
        }
        let last = inner.triangles.len().saturating_sub(1);
        [0, last / 2, last].into_iter().all(|triangle| {
            *work += outer.triangles.len();
            let point = inner.triangles.get(triangle).map(|triangle| self.at(triangle[0]));
            point.is_some_and(|point| self.winding(outer, point).abs() > 0.5)
        })
    }

    fn at(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize].as_dvec3()
    }

    /// How often a shell goes around a point: the sum of the solid angles of its triangles over 4 pi (van Oosterom and Strackee, "The
    /// solid angle of a plane triangle", IEEE Transactions on Biomedical Engineering 30(2), 1983, eq. 8).
    fn winding(&self, shell: &Shell, point: DVec3) -> f64 {
        let solid_angle = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| self.at(vertex) - point);
            let [la, lb, lc] = [a, b, c].map(DVec3::length);
            let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            2.0 * a.dot(b.cross(c)).atan2(denominator)
        };
        shell.triangles.iter().map(solid_angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
    }
}
