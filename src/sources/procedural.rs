//! Meshes made on the spot, in exact positions and normals.

use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3};

use super::MeshData;

/// The finest [`sphere`]: 1,310,720 triangles.
pub const MAX_SUBDIVISIONS: u32 = 8;

/// A sphere about the origin: an icosahedron whose triangles are cut in four `subdivisions` times, at most
/// [`MAX_SUBDIVISIONS`].
///
/// `radius` must be finite and greater than 0. Normals are the sphere's own; triangles face outwards.
pub fn sphere(radius: f32, subdivisions: u32) -> MeshData {
    let (mut directions, mut triangles) = icosahedron();
    for _ in 0..subdivisions.min(MAX_SUBDIVISIONS) {
        triangles = subdivide(&mut directions, &triangles);
    }
    MeshData {
        positions: directions.iter().map(|direction| (direction * f64::from(radius)).as_vec3()).collect(),
        normals: directions.iter().map(|direction| direction.as_vec3()).collect(),
        triangles,
        ..MeshData::default()
    }
}

/// A box of side lengths `size` about the origin: 24 vertices, flat normals, facing outwards.
///
/// Each length must be finite and greater than 0.
pub fn cuboid(size: Vec3) -> MeshData {
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * size / 2.0);
    let mut mesh = MeshData::default();
    for [normal, right, up] in [[x, y, z], [y, z, x], [z, x, y]] {
        push_rectangle(&mut mesh, normal, right, up);
        push_rectangle(&mut mesh, -normal, up, right);
    }
    mesh
}

/// A rectangle about the origin in the xz plane, `size.x` along x and `size.y` along z, facing +y.
///
/// Each length must be finite and greater than 0.
pub fn plane(size: Vec2) -> MeshData {
    let mut mesh = MeshData::default();
    push_rectangle(&mut mesh, Vec3::ZERO, Vec3::Z * size.y / 2.0, Vec3::X * size.x / 2.0);
    mesh
}

/// A room of side 2 about the origin, open towards +z: floor, ceiling, back wall, left and right wall, facing inwards.
pub fn cornell_box() -> MeshData {
    let mut mesh = MeshData::default();
    push_rectangle(&mut mesh, Vec3::NEG_Y, Vec3::Z, Vec3::X);
    push_rectangle(&mut mesh, Vec3::Y, Vec3::X, Vec3::Z);
    push_rectangle(&mut mesh, Vec3::NEG_Z, Vec3::X, Vec3::Y);
    push_rectangle(&mut mesh, Vec3::NEG_X, Vec3::Y, Vec3::Z);
    push_rectangle(&mut mesh, Vec3::X, Vec3::Z, Vec3::Y);
    mesh
}

/// Adds the rectangle of half extents `right` and `up`, which faces along `right` x `up`.
fn push_rectangle(mesh: &mut MeshData, centre: Vec3, right: Vec3, up: Vec3) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([
        centre - right - up,
        centre + right - up,
        centre + right + up,
        centre - right + up,
    ]);
    mesh.normals.extend([right.normalize_or(Vec3::Y).cross(up.normalize_or(Vec3::Y)); 4]);
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut corners = Vec::with_capacity(12);
    for (x, y) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        corners.push(DVec3::new(x, y, 0.0).normalize());
    }
    for (y, z) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        corners.push(DVec3::new(0.0, y, z).normalize());
    }
    for (z, x) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        corners.push(DVec3::new(x, 0.0, z).normalize());
    }
    let around_first = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11]];
    let beside_them = [[1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8]];
    let around_last = [[3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9]];
    let above_them = [[4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]];
    (corners, [around_first, beside_them, around_last, above_them].concat())
}

/// Cuts each triangle in four, adding the edges' centres to the directions.
fn subdivide(directions: &mut Vec<DVec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut centres = HashMap::with_capacity(triangles.len() * 3 / 2);
    let mut centre = |a: u32, b: u32| {
        *centres.entry((a.min(b), a.max(b))).or_insert_with(|| {
            directions.push((directions[a as usize] + directions[b as usize]).normalize());
            (directions.len() - 1) as u32
        })
    };
    let mut finer = Vec::with_capacity(triangles.len() * 4);
    for &[a, b, c] in triangles {
        let (ab, bc, ca) = (centre(a, b), centre(b, c), centre(c, a));
        finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    finer
}

#[cfg(test)]
mod tests;
