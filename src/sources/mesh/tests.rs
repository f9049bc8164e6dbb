#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::*;
use crate::sources::procedural;

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn tetrahedron(scale: f32) -> Vec<Vec3> {
    [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| corner * scale).to_vec()
}

#[test]
fn normals_are_the_same_at_every_scale() {
    let reference = MeshData::from_triangles(&tetrahedron(1.0), &[], &TETRAHEDRON);
    assert!(reference.notes.is_empty(), "{:?}", reference.notes);
    assert!(reference.normals[0].abs_diff_eq(Vec3::splat(-1.0 / 3.0_f32.sqrt()), 1e-6));
    for scale in [1e-44, 1e-38, 1e-30, 1e-10, 1e10, 1e30, 3e38] {
        let mesh = MeshData::from_triangles(&tetrahedron(scale), &[], &TETRAHEDRON);
        assert_eq!(mesh.triangles.len(), 4, "{scale}");
        let pairs = mesh.normals.iter().zip(&reference.normals);
        assert!(pairs.clone().all(|(a, b)| a.abs_diff_eq(*b, 1e-5)), "{scale}: {:?}", mesh.normals);
    }
}

#[test]
fn normals_do_not_depend_on_how_a_face_is_cut() {
    let cube = procedural::cuboid(Vec3::ONE);
    let mesh = MeshData::from_triangles(&cube.positions, &[], &cube.triangles);
    assert_eq!(mesh.positions.len(), 8);
    let diagonals = mesh.positions.iter().zip(&mesh.normals);
    assert!(diagonals.clone().all(|(position, normal)| normal.abs_diff_eq(position.normalize(), 1e-6)));
}

#[test]
fn given_normals_stay_and_only_bad_ones_are_computed() {
    let given = [Vec3::X * 5.0, Vec3::ZERO, Vec3::NAN, Vec3::new(0.0, f32::INFINITY, 0.0)];
    let mesh = MeshData::from_triangles(&tetrahedron(1.0), &given, &TETRAHEDRON);
    let note = "normals of 3 of 4 vertices computed (angle-weighted): missing, zero or not finite";
    assert_eq!(mesh.notes, [note]);
    let at = |position| mesh.normals[mesh.positions.iter().position(|p| *p == position).unwrap()];
    assert_eq!(at(Vec3::ZERO), Vec3::X);
    assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-6));
    assert!(at(Vec3::X).dot(Vec3::X) > 0.5);
}

#[test]
fn normals_that_cancel_fall_back() {
    let mesh = MeshData::from_triangles(&tetrahedron(1.0), &[], &[[1, 2, 3], [1, 3, 2]]);
    assert_eq!(mesh.normals, [Vec3::Y; 3]);
}

#[test]
fn what_cannot_be_shown_is_dropped_with_a_note() {
    let mut positions = tetrahedron(1.0);
    positions.extend([Vec3::NAN, Vec3::X, Vec3::X * 2.0, Vec3::splat(7.0)]);
    let triangles = [[1, 2, 3], [0, 1, 4], [1, 5, 2], [0, 1, 6], [0, 0, 0], [0, 1, 99]];
    let mesh = MeshData::from_triangles(&positions, &[], &triangles);
    assert_eq!((mesh.triangles.as_slice(), mesh.positions.len()), ([[0, 1, 2]].as_slice(), 3));
    assert_eq!(
        mesh.notes,
        [
            "1 triangle with a missing vertex dropped",
            "1 triangle with a NaN or infinite coordinate dropped",
            "3 zero-area triangles dropped",
        ]
    );
    assert_eq!(MeshData::from_triangles(&[], &[], &[[0, 1, 2]]).bounds(), None);
}

#[test]
fn vertices_equal_in_position_and_normal_become_one() {
    let zero_and_minus_zero = [Vec3::ZERO, Vec3::X, Vec3::Y, -Vec3::ZERO, Vec3::Y, Vec3::NEG_X];
    let mesh = MeshData::from_triangles(&zero_and_minus_zero, &[Vec3::Z; 6], &[[0, 1, 2], [3, 4, 5]]);
    assert_eq!((mesh.positions.len(), mesh.triangles.as_slice()), (4, [[0, 1, 2], [0, 2, 3]].as_slice()));
}

#[test]
fn statistics_see_holes_parts_and_forks() {
    let mut mesh = MeshData::from_triangles(&tetrahedron(1.0), &[], &TETRAHEDRON);
    assert_eq!((mesh.statistics().open_edges, mesh.statistics().components), (0, 1));
    mesh.triangles.pop();
    assert_eq!(mesh.statistics().open_edges, 3);
    let mut positions = tetrahedron(1.0);
    positions.extend([Vec3::NEG_ONE, Vec3::splat(5.0), Vec3::new(6.0, 5.0, 5.0), Vec3::new(5.0, 6.0, 5.0)]);
    let fork = [[0, 1, 2], [1, 0, 3], [0, 1, 4], [5, 6, 7]];
    let statistics = MeshData::from_triangles(&positions, &[], &fork).statistics();
    assert_eq!((statistics.non_manifold_edges, statistics.open_edges, statistics.components), (1, 9, 2));
    assert!((statistics.area - (1.5 + 0.5_f64.sqrt())).abs() < 1e-6, "{}", statistics.area);
    assert_eq!(MeshData::default().statistics(), MeshStatistics::default());
}

#[test]
fn a_finer_mesh_keeps_colours_coordinates_and_parts() {
    let mesh = MeshData {
        positions: vec![Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0, Vec3::NEG_X],
        normals: vec![Vec3::Z; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        colours: vec![[0.0; 4], [1.0; 4], [0.0; 4], [0.0; 4]],
        texture_coordinates: vec![Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ZERO],
        parts: vec![MeshPart { triangles: 0..1, material: 1 }, MeshPart { triangles: 1..2, material: 0 }],
        ..MeshData::default()
    };
    let (finer, _) = mesh.refined(glam::DMat3::IDENTITY, 0.5, 10_000);
    assert!(finer.triangles.len() > 64);
    assert_eq!(finer.colours.len(), finer.positions.len());
    assert_eq!(finer.texture_coordinates.len(), finer.positions.len());
    let [first, second] = &finer.parts[..] else { panic!("{:?}", finer.parts) };
    assert_eq!((first.triangles.start, second.triangles.end), (0, finer.triangles.len() as u32));
    assert_eq!(first.triangles.end, second.triangles.start);
    for (index, triangle) in finer.triangles.iter().enumerate() {
        let part = if first.triangles.contains(&(index as u32)) { first } else { second };
        for &corner in triangle {
            let corner = corner as usize;
            let x = finer.positions[corner].x;
            assert!(if part.material == 1 { x >= 0.0 } else { x <= 0.0 });
            assert!((finer.colours[corner][0] - x.max(0.0) / 4.0).abs() < 1e-6);
            assert!((finer.texture_coordinates[corner].x - x.max(0.0) / 4.0).abs() < 1e-6);
        }
    }
}

#[test]
fn statistics_measure_what_closed_parts_enclose() {
    let ball = procedural::sphere(2.0, 5).statistics();
    let expected = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
    assert_eq!((ball.components, ball.closed_components), (1, 1));
    assert!((ball.volume.unwrap() / expected - 1.0).abs() < 0.002, "{ball:?}");
    // The mean chord of a ball is 4/3 of its radius.
    assert!((ball.thickness.unwrap() - 8.0 / 3.0).abs() < 0.005, "{ball:?}");
    let slab = procedural::cuboid(Vec3::new(10.0, 10.0, 0.5)).statistics();
    assert!(
        (slab.volume.unwrap() - 50.0).abs() < 1e-9 && (slab.thickness.unwrap() - 200.0 / 220.0).abs() < 1e-9
    );
    let room = procedural::cornell_box().statistics();
    assert_eq!((room.closed_components, room.volume, room.thickness), (0, None, None));
}
