#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::draft::{Corner, Draft, NONE};
use super::{MeshData, Normals};
use crate::sources::procedural;
use glam::Vec3;
use std::path::Path;

/// What readers make of these triangles, each with the normals of its corners or without.
fn read(positions: &[Vec3], triangles: &[[u32; 3]], normals: &[Vec3]) -> MeshData {
    let mut draft = Draft {
        positions: positions.iter().map(|position| position.as_dvec3()).collect(),
        normals: normals.to_vec(),
        ..Draft::default()
    };
    for triangle in triangles {
        let normal = |index| if normals.is_empty() { NONE } else { index };
        draft.push_face(
            &triangle.map(|index| Corner { normal: normal(index), ..Corner::at(index) }),
            NONE,
            NONE,
        );
    }
    draft.finish(Path::new("a mesh"), Normals::Auto).unwrap()
}

fn ball() -> MeshData {
    procedural::sphere(1.0, 3)
}

fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
    [a, c, b]
}

fn volume(mesh: &MeshData) -> f64 {
    mesh.statistics().volume.unwrap()
}

/// The least agreement of a vertex' normal with the direction from the origin.
fn least_outward(mesh: &MeshData) -> f32 {
    let outward = mesh.positions.iter().zip(&mesh.normals).map(|(at, normal)| at.normalize().dot(*normal));
    outward.fold(f32::INFINITY, f32::min)
}

#[test]
fn what_is_right_stays_as_it_is() {
    let ball = ball();
    let mesh = read(&ball.positions, &ball.triangles, &ball.normals);
    assert!(mesh.notes.is_empty(), "{:?}", mesh.notes);
    assert!(mesh == MeshData::from_triangles(&ball.positions, &ball.normals, &ball.triangles));
    // An open room faces inwards, and an icosahedron's half is as it is.
    let room = procedural::cornell_box();
    assert_eq!(read(&room.positions, &room.triangles, &[]).notes, [""; 0]);
    let half = &ball.triangles[..ball.triangles.len() / 2];
    assert_eq!(read(&ball.positions, half, &[]).notes, [""; 0]);
}

#[test]
fn closed_parts_face_outwards_however_they_are_written() {
    let ball = ball();
    let count = ball.triangles.len();
    let inwards: Vec<_> = ball.triangles.iter().map(|&triangle| turned(triangle)).collect();
    let mesh = read(&ball.positions, &inwards, &[]);
    let note = "so that parts face one way and closed ones outwards";
    assert_eq!(mesh.notes, [format!("{count} of {count} triangles turned over, {note}")]);
    assert!(volume(&mesh) > 4.0 && least_outward(&mesh) > 0.99);
    let mixed = ball.triangles.iter().enumerate();
    let mixed: Vec<_> = mixed.map(|(place, &t)| if place % 3 == 0 { turned(t) } else { t }).collect();
    let mesh = read(&ball.positions, &mixed, &[]);
    assert_eq!(mesh.notes, [format!("{} of {count} triangles turned over, {note}", count.div_ceil(3))]);
    assert!(volume(&mesh) > 4.0 && least_outward(&mesh) > 0.99);
    assert_eq!(mesh.statistics().closed_components, 1);
}

#[test]
fn normals_that_point_inwards_are_turned_with_their_faces() {
    let ball = ball();
    let inward_normals: Vec<Vec3> = ball.normals.iter().map(|normal| -normal).collect();
    let inward_triangles: Vec<_> = ball.triangles.iter().map(|&triangle| turned(triangle)).collect();
    for (triangles, normals, notes) in [
        (&ball.triangles, &inward_normals, 1),
        (&inward_triangles, &inward_normals, 2),
        (&inward_triangles, &ball.normals, 1),
    ] {
        let mesh = read(&ball.positions, triangles, normals);
        assert_eq!(mesh.notes.len(), notes, "{:?}", mesh.notes);
        assert!(volume(&mesh) > 4.0 && least_outward(&mesh) > 0.9999);
    }
}

#[test]
fn an_open_part_goes_by_its_normals_or_by_the_most_of_it() {
    let plane = procedural::plane(glam::Vec2::ONE);
    let down: Vec<_> = plane.triangles.iter().map(|&triangle| turned(triangle)).collect();
    let mesh = read(&plane.positions, &down, &plane.normals);
    assert_eq!((&mesh.triangles, &mesh.normals), (&plane.triangles, &plane.normals));
    assert_eq!(mesh.notes.len(), 1);
    let sheet: Vec<Vec3> =
        (0..8).map(|place| Vec3::new((place / 2) as f32, (place % 2) as f32, 0.0)).collect();
    let right = [[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3], [4, 6, 7], [4, 7, 5]];
    let mut mixed = right;
    mixed[0] = turned(mixed[0]);
    mixed[3] = turned(mixed[3]);
    let mesh = read(&sheet, &mixed, &[]);
    assert!(mesh.notes[0].starts_with("2 of 6 triangles turned over"), "{:?}", mesh.notes);
    assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z));
}

/// A shell in a shell, each facing outwards or inwards.
fn nested(outer_inwards: bool, inner_inwards: bool) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let ball = ball();
    let count = ball.positions.len() as u32;
    let mut positions = ball.positions.clone();
    positions.extend(ball.positions.iter().map(|position| position * 0.5 + Vec3::X * 0.2));
    let facing = |inwards: bool, triangle: [u32; 3]| if inwards { turned(triangle) } else { triangle };
    let mut triangles: Vec<_> = ball.triangles.iter().map(|&t| facing(outer_inwards, t)).collect();
    triangles.extend(ball.triangles.iter().map(|&t| facing(inner_inwards, t.map(|index| index + count))));
    (positions, triangles)
}

#[test]
fn a_cavity_stays_a_cavity_and_a_body_in_a_body_a_body() {
    let (one, small) = (volume(&ball()), volume(&ball()) / 8.0);
    for (outer_inwards, inner_inwards, expected) in [
        (false, true, one - small),
        (true, false, one - small),
        (true, true, one + small),
        (false, false, one + small),
    ] {
        let (positions, triangles) = nested(outer_inwards, inner_inwards);
        let mesh = read(&positions, &triangles, &[]);
        assert!(
            (volume(&mesh) - expected).abs() < 1e-5,
            "{outer_inwards} {inner_inwards}: {}",
            volume(&mesh)
        );
        assert_eq!(mesh.notes.is_empty(), !outer_inwards);
    }
    // Side by side, neither decides for the other.
    let (mut positions, triangles) = nested(false, true);
    let count = positions.len();
    positions[count / 2..].iter_mut().for_each(|position| *position += Vec3::Y * 5.0);
    assert!((volume(&read(&positions, &triangles, &[])) - one - small).abs() < 1e-5);
}

#[test]
fn a_moebius_strip_stays_as_it_is() {
    let (steps, width) = (24_u32, 0.3);
    let positions: Vec<Vec3> = (0..2 * steps)
        .map(|place| {
            let angle = (place / 2) as f32 / steps as f32 * std::f32::consts::TAU;
            let across = if place % 2 == 0 { width } else { -width };
            let (sin, cos) = angle.sin_cos();
            let radius = 1.0 + across * (angle / 2.0).cos();
            Vec3::new(radius * cos, radius * sin, across * (angle / 2.0).sin())
        })
        .collect();
    let corner = |step: u32, side: u32| {
        let (step, side) = if step == steps { (0, 1 - side) } else { (step, side) };
        2 * step + side
    };
    let triangles: Vec<[u32; 3]> = (0..steps)
        .flat_map(|step| {
            let [a, b, c, d] = [corner(step, 0), corner(step, 1), corner(step + 1, 0), corner(step + 1, 1)];
            [[a, c, d], [a, d, b]]
        })
        .collect();
    let mesh = read(&positions, &triangles, &[]);
    assert_eq!(mesh.notes, ["1 part with one side only, like a Möbius strip, facing as in the file"]);
    assert_eq!(mesh.triangles.len(), triangles.len());
    assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-5));
}

#[test]
fn many_shells_that_face_inwards_take_no_square_of_time() {
    let cube = procedural::cuboid(Vec3::splat(0.1));
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for number in 0..20_000_u32 {
        let first = positions.len() as u32;
        let at = Vec3::new((number % 100) as f32, (number / 100) as f32, 0.0);
        positions.extend(cube.positions.iter().map(|position| position + at));
        triangles.extend(cube.triangles.iter().map(|&triangle| turned(triangle.map(|index| index + first))));
    }
    let start = std::time::Instant::now();
    let mesh = read(&positions, &triangles, &[]);
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    assert!((volume(&mesh) - 20.0).abs() < 1e-2);
}
