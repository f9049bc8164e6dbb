#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::draft::{Corner, Draft, NONE};
use super::{MeshData, Normals};
use crate::sources::procedural;
use glam::{DVec3, Vec3};
use std::path::Path;

/// What readers make of triangles in smoothing groups.
fn read(positions: &[Vec3], triangles: &[[u32; 3]], group: impl Fn(usize) -> u32, rule: Normals) -> MeshData {
    let positions = positions.iter().map(|position| position.as_dvec3()).collect();
    let mut draft = Draft { positions, ..Draft::default() };
    for (place, triangle) in triangles.iter().enumerate() {
        draft.push_face(&triangle.map(Corner::at), group(place), NONE);
    }
    draft.finish(Path::new("a mesh"), rule).unwrap()
}

fn is_flat(mesh: &MeshData) -> bool {
    mesh.triangles.iter().all(|triangle| {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        let facing = (b - a).cross(c - a).normalize();
        triangle.iter().all(|&vertex| mesh.normals[vertex as usize].dot(facing) > 0.9999)
    })
}

#[test]
fn a_cube_has_hard_edges_and_a_ball_has_none() {
    let cube = procedural::cuboid(Vec3::ONE);
    let mesh = read(&cube.positions, &cube.triangles, |_| NONE, Normals::Auto);
    assert!(is_flat(&mesh));
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (24, 12));
    let ball = procedural::sphere(1.0, 3);
    let mesh = read(&ball.positions, &ball.triangles, |_| NONE, Normals::Auto);
    assert_eq!(mesh.positions.len(), ball.positions.len());
    assert!(mesh.positions.iter().zip(&mesh.normals).all(|(position, normal)| position.dot(*normal) > 0.999));
    // The same bits as without looking for edges.
    assert_eq!(mesh, MeshData::from_triangles(&ball.positions, &[], &ball.triangles));
}

#[test]
fn what_is_asked_for_wins_over_the_file() {
    let cube = procedural::cuboid(Vec3::ONE);
    let smooth = |rule| read(&cube.positions, &cube.triangles, |_| 1, rule).positions.len();
    assert_eq!(smooth(Normals::Auto), 8);
    assert_eq!(smooth(Normals::Flat), 24);
    assert_eq!(smooth(Normals::Smooth(89.0)), 24);
    assert_eq!(smooth(Normals::Smooth(91.0)), 8);
    let ball = procedural::sphere(1.0, 2);
    let mesh = read(&ball.positions, &ball.triangles, |_| NONE, Normals::Flat);
    assert!(is_flat(&mesh));
    assert_eq!(mesh.positions.len(), 3 * ball.triangles.len());
}

#[test]
fn edges_between_smoothing_groups_are_hard_and_within_one_soft() {
    let cube = procedural::cuboid(Vec3::ONE);
    let with_groups =
        |group: &dyn Fn(usize) -> u32| read(&cube.positions, &cube.triangles, group, Normals::Auto);
    // Two triangles a face; one group for each pair of opposite faces, then three for all.
    assert!(is_flat(&with_groups(&|place| place as u32 / 2 + 1)));
    assert!(is_flat(&with_groups(&|_| 0)));
    assert_eq!(with_groups(&|_| 7).positions.len(), 8);
    // Two faces smooth, the rest flat: two vertices less where they meet.
    let mesh = with_groups(&|place| if place < 2 || (4..6).contains(&place) { 1 } else { 0 });
    assert_eq!((is_flat(&mesh), mesh.positions.len()), (false, 22));
    // Where nothing is said the angle decides, beside faces of which something is said.
    assert!(is_flat(&with_groups(&|place| if place < 2 { 5 } else { NONE })));
}

#[test]
fn a_cone_of_very_many_facets_is_read_at_once() {
    let count = 200_000_u32;
    let mut positions = vec![Vec3::Y];
    positions.extend((0..count).map(|step| {
        let angle = step as f32 / count as f32 * std::f32::consts::TAU;
        Vec3::new(angle.sin(), 0.0, angle.cos())
    }));
    let triangles: Vec<_> = (0..count).map(|step| [0, 1 + step, 1 + (step + 1) % count]).collect();
    let start = std::time::Instant::now();
    let mesh = read(&positions, &triangles, |_| NONE, Normals::Flat);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    assert!(mesh.triangles.len() > 190_000);
}

#[test]
fn far_out_positions_keep_their_shape() {
    let ball = procedural::sphere(1.0, 4);
    for centre in
        [DVec3::new(512_345.678, 4_512_345.25, 120.5), DVec3::splat(5e8), DVec3::new(6_378_137.0, 0.0, 0.0)]
    {
        let positions = ball.positions.iter().map(|position| position.as_dvec3() + centre).collect();
        let mut draft = Draft { positions, ..Draft::default() };
        ball.triangles.iter().for_each(|triangle| draft.push_face(&triangle.map(Corner::at), NONE, NONE));
        let mesh = draft.finish(Path::new("a mesh"), Normals::Auto).unwrap();
        assert_eq!(mesh.origin, centre.round());
        let from_origin = (centre - mesh.origin).as_vec3();
        let radii = mesh.positions.iter().map(|position| (position - from_origin).length());
        assert!(radii.clone().all(|radius| (radius - 1.0).abs() < 1e-6), "{:?}", radii.fold(0.0, f32::max));
        assert_eq!(mesh.triangles.len(), ball.triangles.len());
        let (statistics, of_ball) = (mesh.statistics(), ball.statistics());
        assert!((statistics.area - of_ball.area).abs() < 1e-5);
        assert!((statistics.bounds.unwrap().0 - centre - of_ball.bounds.unwrap().0).length() < 1e-6);
    }
    // Near the origin every bit stays.
    let near: Vec<_> = ball.positions.iter().map(|position| position + Vec3::splat(7.0)).collect();
    let mesh = read(&near, &ball.triangles, |_| NONE, Normals::Auto);
    let expected = MeshData::from_triangles(&near, &[], &ball.triangles).positions;
    assert_eq!(mesh.origin, DVec3::ZERO);
    assert!(mesh.positions == expected);
}
