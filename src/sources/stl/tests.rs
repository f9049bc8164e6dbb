#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::*;
use crate::sources::procedural;
use glam::Vec3;

fn read_bytes(bytes: &[u8]) -> Result<MeshData, SourceError> {
    read(Path::new("a.stl"), bytes, Normals::Auto)
}

fn message(bytes: impl AsRef<[u8]>) -> String {
    read_bytes(bytes.as_ref()).unwrap_err().to_string()
}

/// A mesh as binary STL, with these bytes at the beginning of its header.
fn binary(mesh: &MeshData, header: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(HEADER, 0);
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for triangle in &mesh.triangles {
        bytes.extend([0; 12]);
        for vertex in triangle {
            let position = mesh.positions[*vertex as usize];
            bytes.extend(position.to_array().into_iter().flat_map(f32::to_le_bytes));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

/// A mesh as a solid of text, moved.
fn text(mesh: &MeshData, by: DVec3) -> String {
    let mut text = "solid a name, vertex and all\n".to_owned();
    for triangle in &mesh.triangles {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for vertex in triangle {
            let at = mesh.positions[*vertex as usize].as_dvec3() + by;
            text += &format!("      vertex {:e} {} {}\n", at.x, at.y, at.z);
        }
        text += "    endloop\n  endfacet\n";
    }
    text + "endsolid a name, vertex and all\n"
}

#[test]
fn a_ball_is_smooth_and_a_cube_is_not_in_text_and_binary() {
    let (ball, cube) = (procedural::sphere(1.0, 3), procedural::cuboid(Vec3::ONE));
    for bytes in [
        binary(&ball, b"made by a test"),
        binary(&ball, b"solid ball\n"),
        text(&ball, DVec3::ZERO).into_bytes(),
    ] {
        let mesh = read_bytes(&bytes).unwrap();
        assert_eq!(
            (mesh.positions.len(), mesh.triangles.len()),
            (ball.positions.len(), ball.triangles.len())
        );
        assert!(mesh.positions.iter().zip(&mesh.normals).all(|(at, normal)| at.dot(*normal) > 0.999));
        assert_eq!((mesh.statistics().open_edges, mesh.notes.len()), (0, 0), "{:?}", mesh.notes);
    }
    for bytes in [binary(&cube, &[]), text(&cube, DVec3::ZERO).replace('\n', "\r\n").into_bytes()] {
        let mesh = read_bytes(&bytes).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len(), mesh.statistics().area), (24, 12, 6.0));
    }
}

#[test]
fn text_far_out_is_round_and_has_any_number_of_solids() {
    let ball = procedural::sphere(1.0, 3);
    let centre = DVec3::new(512_345.0, 4_512_345.0, 120.0);
    let mesh = read_bytes(text(&ball, centre).as_bytes()).unwrap();
    assert!(mesh.positions.iter().all(|position| (position.length() - 1.0).abs() < 1e-6));
    let two =
        text(&ball, DVec3::ZERO) + "\n" + &text(&ball, DVec3::X * 3.0).to_uppercase().replace("E0", "e0");
    assert_eq!(read_bytes(two.as_bytes()).unwrap().statistics().components, 2);
    let unnamed = text(&ball, DVec3::ZERO).replace(" a name, vertex and all", "");
    assert_eq!(read_bytes(unnamed.as_bytes()).unwrap().triangles.len(), ball.triangles.len());
}

#[test]
fn what_is_odd_is_told() {
    let cube = procedural::cuboid(Vec3::ONE);
    let mut coloured = binary(&cube, b"COLOR=abcd");
    coloured[HEADER + 4 + 48] = 1;
    assert_eq!(read_bytes(&coloured).unwrap().notes, ["colours (attribute bytes) of 1 facet are not used"]);
    let mut longer = binary(&cube, &[]);
    longer.extend(*b"more");
    assert_eq!(read_bytes(&longer).unwrap().notes, ["4 bytes after the last triangle left out"]);
    let shorter = &binary(&cube, &[])[..500];
    let text_error = message(shorter);
    assert!(
        text_error.starts_with("a.stl: 500 bytes; an STL header and 12 triangles need 684 (184 fewer"),
        "{text_error}"
    );
    let cut = text(&cube, DVec3::ZERO);
    let cut = &cut[..cut.rfind("endloop").unwrap()];
    let mesh = read_bytes(cut.as_bytes()).unwrap();
    assert_eq!(
        (mesh.triangles.len(), &mesh.notes[0][..]),
        (11, "the file ends within a facet: it may be cut off")
    );
    let word = text(&cube, DVec3::ZERO).replacen("vertex 5e-1", "vertex five", 1);
    assert!(message(&word).contains("`five` is not a number; `vertex` needs three"), "{}", message(&word));
    let odd = text(&cube, DVec3::ZERO).replacen("outer loop", "inner loop", 1);
    assert!(message(&odd).starts_with("a.stl:3: `inner` is no statement of STL"), "{}", message(&odd));
    assert_eq!(
        message("solid nothing\nendsolid\n"),
        "a.stl: no triangles: found 0 facets; export the mesh with its faces"
    );
    let count = u32::MAX.to_le_bytes();
    assert!(message([&[0; HEADER][..], &count, &[0; 50]].concat()).contains("4294967295 triangles need"));
}
