//! Meshes as people reported them, beside the test data folder, with what must become of each.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::read_mesh;
use crate::sources::{MeshData, Normals};
use glam::{DVec3, Vec3};
use std::path::{Path, PathBuf};
use tyndall_needs::needs;

fn reported(path: &str) -> PathBuf {
    Path::new(&std::env::var_os("TYNDALL_DATA").unwrap()).join("../reported").join(path)
}

fn read(path: &str) -> MeshData {
    read_mesh(&reported(path), Normals::Auto).unwrap()
}

/// The least cosine between a corner's normal and the way that its triangle faces.
fn least_agreement(mesh: &MeshData) -> f32 {
    let of_triangle = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        let facing = (b - a).cross(c - a).normalize();
        triangle.map(|vertex| mesh.normals[vertex as usize].dot(facing)).into_iter().fold(1.0, f32::min)
    };
    mesh.triangles.iter().map(of_triangle).fold(1.0, f32::min)
}

#[needs(data)]
#[test]
fn a_ball_in_a_national_grid_is_round() {
    let mesh = read("fail/03_obj_large_coordinates/utm.obj");
    let centre = (DVec3::new(512_345.25, 4_512_345.75, 120.5) - mesh.origin).as_vec3();
    assert!(mesh.positions.iter().all(|position| ((position - centre).length() - 1.0).abs() < 1e-4));
    let statistics = mesh.statistics();
    assert_eq!((statistics.open_edges, statistics.closed_components), (0, 1));
    let volume = statistics.volume.unwrap() / (4.0 / 3.0 * std::f64::consts::PI);
    assert!((0.99..1.0).contains(&volume), "{volume}");
    assert!(mesh.notes.is_empty(), "{:?}", mesh.notes);
}

#[needs(data)]
#[test]
fn a_cube_has_flat_faces_whether_the_file_says_so_or_nothing() {
    let folder = "fail/13_obj_hard_edges";
    let expected = read(&format!("{folder}/normals.obj"));
    assert_eq!((expected.positions.len(), expected.triangles.len()), (24, 12));
    for name in ["soff", "sgroups", "plain"] {
        let mesh = read(&format!("{folder}/{name}.obj"));
        assert!(least_agreement(&mesh) > 0.9999, "{name}");
        assert_eq!((mesh.positions.len(), mesh.triangles.len(), mesh.notes.len()), (24, 12, 0), "{name}");
    }
}

#[needs(data)]
#[test]
fn parts_face_outwards_however_they_are_wound() {
    let folder = "fail/14_winding_under_subsurface";
    let good = read(&format!("{folder}/good.obj"));
    assert!(good.notes.is_empty(), "{:?}", good.notes);
    let volume = good.statistics().volume.unwrap();
    for (name, note) in [("inward", "turned over"), ("mixed", "turned over"), ("vn_in", "normals of")] {
        let mesh = read(&format!("{folder}/{name}.obj"));
        assert!((mesh.statistics().volume.unwrap() - volume).abs() < 1e-4 * volume, "{name}");
        assert!(least_agreement(&mesh) > 0.8, "{name}: {}", least_agreement(&mesh));
        assert!(mesh.notes.len() == 1 && mesh.notes[0].contains(note), "{name}: {:?}", mesh.notes);
    }
}

#[needs(data)]
#[test]
fn materials_and_colours_are_read() {
    let folder = "fail/20_obj_materials_silent";
    let mesh = read(&format!("{folder}/mtl.obj"));
    let names: Vec<_> = mesh.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["red", "green", "blue"]);
    assert_eq!(mesh.materials[0].diffuse, Vec3::new(0.9, 0.1, 0.1));
    let parts: Vec<_> = mesh.parts.iter().map(|part| (part.material, part.triangles.clone())).collect();
    assert_eq!(parts, [(0, 0..4), (1, 4..8), (2, 8..12)]);
    // The first part has the back and the right face.
    assert!(
        mesh.triangles[0..2].iter().flatten().all(|&vertex| mesh.normals[vertex as usize] == Vec3::NEG_Z)
    );
    assert!(mesh.triangles[2..4].iter().flatten().all(|&vertex| mesh.normals[vertex as usize] == Vec3::X));
    assert_eq!(mesh.notes, ["texture `missing.png` is not there"]);
    let mesh = read(&format!("{folder}/vcol.obj"));
    let colours = mesh.positions.iter().zip(&mesh.colours);
    let expected = |position: Vec3| ((position + Vec3::ONE) / 2.0).extend(1.0).to_array();
    assert!(colours.clone().count() == 24 && colours.clone().all(|(at, colour)| *colour == expected(*at)));
    let mesh = read(&format!("{folder}/mixcol.obj"));
    assert_eq!(mesh.notes, ["8 of 11 vertices have a colour; the others are white"]);
    assert_eq!(mesh.colours[mesh.positions.iter().position(|at| at.x == 4.0).unwrap()], [1.0; 4]);
}

#[needs(data)]
#[test]
fn every_form_of_statement_is_read_or_refused_at_its_place() {
    for name in ["UPPER.OBJ", "crlf.obj", "cr.obj", "bom.obj", "plus.obj", "lines.obj", "noext.wavefront"] {
        let statistics = read(&format!("pass/obj_forms/{name}")).statistics();
        assert_eq!((statistics.open_edges, statistics.closed_components), (0, 1), "{name}");
    }
    // A cube and a triangle.
    let statistics = read("pass/obj_forms/groups.obj").statistics();
    assert_eq!((statistics.open_edges, statistics.closed_components, statistics.components), (3, 1, 2));
    for (name, triangles) in [("f_slash.obj", 2), ("vcount.obj", 1), ("hash.obj", 1), ("indent.obj", 1)] {
        assert_eq!(read(&format!("pass/obj_forms/{name}")).triangles.len(), triangles, "{name}");
    }
    for (name, part) in [
        ("decimal_comma.obj", ":1: `"),
        ("exp.obj", ":3: `1d0`"),
        ("rational.obj", ":4: `"),
        ("nondigit.obj", ":4: `"),
        ("fo.obj", "no triangles"),
        ("upperkw.obj", "no triangles"),
    ] {
        let error =
            read_mesh(&reported(&format!("pass/obj_forms/{name}")), Normals::Auto).unwrap_err().to_string();
        assert!(error.contains(part), "{name}: {error}");
    }
}

#[needs(data)]
#[test]
fn tiny_and_huge_meshes_keep_their_shape() {
    let good = read("pass/mirror_and_scale/good.obj").statistics();
    for (name, scale) in [("e-12.obj", 1e-12), ("e18.obj", 1e18)] {
        let statistics = read(&format!("pass/mirror_and_scale/{name}")).statistics();
        assert_eq!((statistics.open_edges, statistics.closed_components), (0, 1), "{name}");
        let thickness = statistics.thickness.unwrap() / scale;
        assert!((0.1..10.0).contains(&(thickness / good.thickness.unwrap())), "{name}: {thickness}");
    }
}

#[needs(data)]
#[test]
fn a_scan_in_packed_ply_is_whole() {
    let path = reported("../data/meshes/dragon_vrip_res2.ply.gz");
    let mesh = read_mesh(&path, Normals::Auto).unwrap();
    let statistics = mesh.statistics();
    assert_eq!((statistics.triangles, mesh.positions.len() >= 100_000), (202_520, true), "{:?}", mesh.notes);
}
