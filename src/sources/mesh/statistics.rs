//! What a person asks of a mesh: how large, how many, is it closed, how thick?

use glam::DVec3;

use super::topology::{Edges, Unions, ends_of};
use super::{MeshData, weld::weld};

/// Counts and measures of a mesh. Edges and components are counted after joining vertices of equal position.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct MeshStatistics {
    /// Vertices, before joining.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Surface area, in square units of the positions.
    pub area: f64,
    /// Edges of one triangle only: 0 for a closed surface.
    pub open_edges: usize,
    /// Edges of more than two triangles: 0 for a surface that encloses a volume without touching itself.
    pub non_manifold_edges: usize,
    /// Parts that share no vertex.
    pub components: usize,
    /// Parts without open edges, whose triangles agree at every edge which side is outside.
    pub closed_components: usize,
    /// What the closed parts enclose, in cubic units of the positions; those that face inwards, such as cavities, count negative. Nothing
    /// if no part is closed.
    pub volume: Option<f64>,
    /// The mean length of straight ways through the closed parts, in units of the positions: four volumes over their area (Cauchy). Nothing
    /// if they enclose nothing.
    pub thickness: Option<f64>,
    /// The least and greatest corner of the box around it, in the file's coordinates; `None` without vertices.
    pub bounds: Option<(DVec3, DVec3)>,
}

/// What is summed up of a part.
#[derive(Clone, Copy, Default)]
struct Part {
    is_open: bool,
    area: f64,
    volume: f64,
}

impl MeshStatistics {
    pub(super) fn of(mesh: &MeshData) -> Self {
        let welded = weld(&mesh.positions);
        let triangles: Vec<_> =
            mesh.triangles.iter().map(|t| t.map(|index| welded[index as usize])).collect();
        let mut parts_of = Unions::new(mesh.positions.len());
        for &[a, b, c] in &triangles {
            parts_of.join(a, b);
            parts_of.join(b, c);
        }
        let mut statistics = Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            bounds: mesh
                .bounds()
                .map(|(least, greatest)| (mesh.origin + least.as_dvec3(), mesh.origin + greatest.as_dvec3())),
            ..Self::default()
        };
        let mut parts = vec![Part::default(); mesh.positions.len()];
        statistics.count_edges(&triangles, |vertex| parts[parts_of.find(vertex) as usize].is_open = true);
        let corner = |vertex: u32| mesh.positions[vertex as usize].as_dvec3();
        let mut is_any = vec![false; parts.len()];
        for &[a, b, c] in &triangles {
            let first = parts_of.find(a);
            is_any[first as usize] = true;
            let part = &mut parts[first as usize];
            // Relative to a corner of the part, so that nothing cancels far out.
            let [a, b, c] = [a, b, c].map(|vertex| corner(vertex) - corner(first));
            let area = (b - a).cross(c - a).length() / 2.0;
            statistics.area += area;
            part.area += area;
            part.volume += a.dot(b.cross(c)) / 6.0;
        }
        statistics.sum_up(parts.iter().zip(is_any).filter_map(|(part, is_any)| is_any.then_some(part)));
        statistics
    }

    /// Counts edges, and tells a vertex of each that its part cannot be closed at.
    fn count_edges(&mut self, triangles: &[[u32; 3]], mut open_at: impl FnMut(u32)) {
        let vertices = triangles.iter().flatten().max().map_or(0, |&greatest| greatest as usize + 1);
        for edge in Edges::of(triangles, vertices).iter() {
            self.open_edges += usize::from(edge.len() == 1);
            self.non_manifold_edges += usize::from(edge.len() > 2);
            let forwards =
                edge.iter().filter(|&&side| ends_of(triangles, side).0 < ends_of(triangles, side).1);
            if 2 * forwards.count() != edge.len() {
                open_at(ends_of(triangles, edge[0]).0);
            }
        }
    }

    fn sum_up<'a>(&mut self, parts: impl Iterator<Item = &'a Part>) {
        let (mut area, mut volume) = (0.0, 0.0);
        for part in parts {
            self.components += 1;
            if !part.is_open {
                self.closed_components += 1;
                area += part.area;
                volume += part.volume;
            }
        }
        self.volume = (self.closed_components > 0).then_some(volume);
        self.thickness = (volume > 0.0 && area > 0.0).then(|| 4.0 * volume / area);
    }
}
