//! What a person asks of a mesh: how large, how many, is it closed?

use glam::DVec3;

use super::{MeshData, assemble::weld};

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
    /// The least and greatest corner of the box around it, in the file's coordinates; `None` without vertices.
    pub bounds: Option<(DVec3, DVec3)>,
}

impl MeshStatistics {
    pub(super) fn of(mesh: &MeshData) -> Self {
        let welded = weld(&mesh.positions);
        let triangles: Vec<_> =
            mesh.triangles.iter().map(|t| t.map(|index| welded[index as usize])).collect();
        let (open_edges, non_manifold_edges) = count_edges(&triangles);
        Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            area: mesh.triangles.iter().map(|triangle| area(mesh, triangle)).sum(),
            open_edges,
            non_manifold_edges,
            components: count_components(mesh.positions.len(), &triangles),
            bounds: mesh
                .bounds()
                .map(|(least, greatest)| (mesh.origin + least.as_dvec3(), mesh.origin + greatest.as_dvec3())),
        }
    }
}

fn area(mesh: &MeshData, triangle: &[u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|index| mesh.positions[index as usize].as_dvec3());
    (b - a).cross(c - a).length() / 2.0
}

/// How many edges have one triangle, and how many more than two.
fn count_edges(triangles: &[[u32; 3]]) -> (usize, usize) {
    let sides = triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let mut edges: Vec<_> = sides.filter(|(a, b)| a != b).map(|(a, b)| (a.min(b), a.max(b))).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).fold((0, 0), |(open, non_manifold), uses| match uses.len() {
        1 => (open + 1, non_manifold),
        2 => (open, non_manifold),
        _ => (open, non_manifold + 1),
    })
}

fn count_components(vertices: usize, triangles: &[[u32; 3]]) -> usize {
    let mut parents: Vec<u32> = (0..vertices as u32).collect();
    let mut is_used = vec![false; vertices];
    for &[a, b, c] in triangles {
        for vertex in [a, b, c] {
            is_used[vertex as usize] = true;
        }
        for other in [b, c] {
            let (a, other) = (root(&mut parents, a), root(&mut parents, other));
            parents[other as usize] = a;
        }
    }
    (0..vertices).filter(|&vertex| is_used[vertex] && parents[vertex] as usize == vertex).count()
}

/// The representative of the vertex's part; halves the path to it.
fn root(parents: &mut [u32], mut vertex: u32) -> u32 {
    while parents[vertex as usize] != vertex {
        let grandparent = parents[parents[vertex as usize] as usize];
        parents[vertex as usize] = grandparent;
        vertex = grandparent;
    }
    vertex
}
