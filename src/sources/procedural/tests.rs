#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::PI;

use super::*;

/// Each triangle's geometric normal and the normal of its first vertex.
fn facings(mesh: &MeshData) -> impl Iterator<Item = (Vec3, Vec3)> {
    mesh.triangles.iter().map(|&[a, b, c]| {
        let [a, b, c] = [a, b, c].map(|index| index as usize);
        let [p, q, r] = [a, b, c].map(|index| mesh.positions[index]);
        ((q - p).cross(r - p).normalize(), mesh.normals[a])
    })
}

#[test]
fn a_sphere_is_closed_faces_outwards_and_grows_towards_its_area() {
    for (subdivisions, triangles, area_ratio) in [(0, 20, 0.76), (1, 80, 0.92), (4, 5120, 0.998)] {
        let mesh = sphere(2.5, subdivisions);
        let statistics = mesh.statistics();
        assert_eq!((statistics.triangles, statistics.vertices), (triangles, triangles / 2 + 2));
        assert_eq!((statistics.open_edges, statistics.non_manifold_edges, statistics.components), (0, 0, 1));
        let ratio = statistics.area / (4.0 * PI * 2.5 * 2.5);
        assert!(ratio > area_ratio && ratio < 1.0, "{ratio}");
        assert!(facings(&mesh).all(|(facing, normal)| facing.dot(normal) > 0.7));
        assert!(mesh.positions.iter().zip(&mesh.normals).all(|(p, n)| p.abs_diff_eq(*n * 2.5, 1e-6)));
        assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-6));
    }
}

#[test]
fn a_cuboid_is_closed_and_flat() {
    let mesh = cuboid(Vec3::new(1.0, 2.0, 3.0));
    let statistics = mesh.statistics();
    assert_eq!((statistics.vertices, statistics.triangles, statistics.open_edges), (24, 12, 0));
    assert_eq!(statistics.area, 22.0);
    assert_eq!(mesh.bounds(), Some((Vec3::new(-0.5, -1.0, -1.5), Vec3::new(0.5, 1.0, 1.5))));
    assert!(facings(&mesh).all(|(facing, normal)| facing == normal));
    assert!(mesh.positions.iter().zip(&mesh.normals).all(|(position, normal)| position.dot(*normal) > 0.0));
}

#[test]
fn a_plane_faces_up() {
    let mesh = plane(Vec2::new(4.0, 2.0));
    assert_eq!(mesh.bounds(), Some((Vec3::new(-2.0, 0.0, -1.0), Vec3::new(2.0, 0.0, 1.0))));
    assert!(facings(&mesh).all(|(facing, normal)| facing == Vec3::Y && normal == Vec3::Y));
}

#[test]
fn a_cornell_box_faces_inwards_and_is_open_in_front() {
    let mesh = cornell_box();
    let statistics = mesh.statistics();
    assert_eq!((statistics.triangles, statistics.open_edges, statistics.area), (10, 4, 20.0));
    assert_eq!(statistics.bounds, Some((DVec3::NEG_ONE, DVec3::ONE)));
    assert!(facings(&mesh).all(|(facing, normal)| facing == normal));
    assert!(mesh.positions.iter().zip(&mesh.normals).all(|(position, normal)| position.dot(*normal) < 0.0));
    assert!(mesh.normals.iter().all(|normal| *normal != Vec3::NEG_Z));
}
