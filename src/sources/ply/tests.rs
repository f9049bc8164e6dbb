#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::*;
use crate::sources::procedural;
use glam::{DVec3, Vec2, Vec3};

fn read_bytes(bytes: &[u8]) -> Result<MeshData, SourceError> {
    read(Path::new("a.ply"), bytes, Normals::Auto)
}

fn message(bytes: impl AsRef<[u8]>) -> String {
    read_bytes(bytes.as_ref()).unwrap_err().to_string()
}

const HEADER: &str = "comment made by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 2\nproperty list uchar int vertex_indices\nend_header\n";

const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

fn text(header: &str, body: &str) -> String {
    format!("ply\nformat ascii 1.0\n{header}{body}")
}

/// The square in bytes; `order` turns those of a number.
fn binary(format: &str, order: impl Fn(&mut [u8])) -> Vec<u8> {
    let mut bytes = format!("ply\nformat {format} 1.0\n{HEADER}").into_bytes();
    let mut put = |mut number: Vec<u8>| {
        order(&mut number);
        bytes.append(&mut number);
    };
    for coordinate in [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.0_f32] {
        put(coordinate.to_le_bytes().to_vec());
    }
    for face in [[0, 1, 2], [0, 2, 3_i32]] {
        put(vec![3]);
        face.into_iter().for_each(|index| put(index.to_le_bytes().to_vec()));
    }
    bytes
}

#[test]
fn text_and_binary_of_either_order_are_the_same() {
    let expected = read_bytes(text(HEADER, SQUARE).as_bytes()).unwrap();
    assert_eq!((expected.positions.len(), expected.triangles.len()), (4, 2));
    assert_eq!((expected.statistics().area, expected.statistics().open_edges), (1.0, 4));
    assert!(expected.notes.is_empty(), "{:?}", expected.notes);
    assert_eq!(read_bytes(&binary("binary_little_endian", |_| {})).unwrap(), expected);
    assert_eq!(read_bytes(&binary("binary_big_endian", <[u8]>::reverse)).unwrap(), expected);
    let windows = text(HEADER, SQUARE).replace('\n', "\r\n");
    assert_eq!(read_bytes(windows.as_bytes()).unwrap(), expected);
    assert_eq!(read_bytes(text(HEADER, SQUARE).replace('\n', "\r").as_bytes()).unwrap(), expected);
    let blank = text(HEADER, &SQUARE.replace("1 1 0\n", "\n  1 1 0  \n\n"));
    assert_eq!(read_bytes(blank.as_bytes()).unwrap(), expected);
}

#[test]
fn polygons_strips_and_lists_of_any_type_are_read() {
    for kind in ["uchar uchar", "char short", "ushort uint", "uint float", "int8 uint16"] {
        let header = HEADER.replace("uchar int", kind).replace("face 2", "face 1");
        let body = SQUARE.replace("3 0 1 2\n3 0 2 3\n", "4 0 1 2 3\n");
        assert_eq!(read_bytes(text(&header, &body).as_bytes()).unwrap().triangles.len(), 2, "{kind}");
    }
    let header = HEADER.replace("face 2", "tristrips 1").replace("uchar int", "int int");
    let strips = text(&header, &SQUARE.replace("3 0 1 2\n3 0 2 3\n", "7 0 1 3 2 -1 0 1\n"));
    let mesh = read_bytes(strips.as_bytes()).unwrap();
    assert_eq!(mesh.triangles.len(), 2);
    assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z), "{:?}", mesh.normals);
}

#[test]
fn normals_colours_and_texture_coordinates_are_read() {
    let more = "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n\
        property uchar green\nproperty uchar blue\nproperty uchar alpha\nproperty float s\nproperty float t\n";
    let header = HEADER.replace("property float z\n", more);
    let body = "0 0 0 0 0 1 255 0 188 255 0 0\n1 0 0 0 0 1 0 255 0 51 1 0\n1 1 0 0 0 1 0 0 0 0 1 1\n0 1 0 0 0 1 9 9 9 9 0 1\n\
        3 0 1 2\n3 0 2 3\n";
    let mesh = read_bytes(text(&header, body).as_bytes()).unwrap();
    assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z));
    assert_eq!(mesh.colours.len(), 4);
    // 188 of 255 is half of the light.
    assert!((mesh.colours[0][2] - 0.5).abs() < 0.01 && mesh.colours[0][0] == 1.0, "{:?}", mesh.colours[0]);
    assert!((mesh.colours[1][3] - 0.2).abs() < 1e-6);
    assert_eq!(mesh.texture_coordinates[2], Vec2::ONE);
    let floats = text(
        &header
            .replace("uchar red", "float red")
            .replace("uchar green", "float green")
            .replace("uchar blue", "float blue"),
        &body
            .replace("255 0 188 255", "1 0 0.7353569 255")
            .replace("0 255 0 51", "0 1 0 51")
            .replace("9 9 9 9", "0 0 0 9"),
    );
    let mesh = read_bytes(floats.as_bytes()).unwrap();
    assert!((mesh.colours[0][2] - 0.5).abs() < 1e-3, "{:?}", mesh.colours[0]);
}

#[test]
fn the_picture_of_a_comment_colours_the_corners_of_faces() {
    let folder = tempfile::tempdir().unwrap();
    image::RgbaImage::from_pixel(2, 1, image::Rgba([9, 8, 7, 255]))
        .save(folder.path().join("skin of it.png"))
        .unwrap();
    let header = HEADER
        .replace("made by hand", "TextureFile skin of it.png")
        .replace("vertex_indices\n", "vertex_indices\nproperty list uchar float texcoord\n");
    let body =
        SQUARE.replace("3 0 1 2", "3 0 1 2 6 0 0 1 0 1 1").replace("3 0 2 3", "3 0 2 3 6 0 0 1 1 0 .5");
    let path = folder.path().join("a.ply");
    let mesh = read(&path, text(&header, &body).as_bytes(), Normals::Auto).unwrap();
    assert!(mesh.notes.is_empty(), "{:?}", mesh.notes);
    let picture = mesh.materials[0].diffuse_texture.as_ref().unwrap();
    assert_eq!((picture.width, picture.height, picture.texels[1]), (2, 1, [9, 8, 7, 255]));
    assert_eq!((mesh.parts[0].triangles.clone(), mesh.materials[0].diffuse), (0..2, Vec3::ONE));
    let corner = mesh.positions.iter().position(|position| *position == Vec3::Y).unwrap();
    assert_eq!(mesh.texture_coordinates[corner], Vec2::new(0.0, 0.5));
    let missing = text(&header.replace("skin of it", "skin"), &body);
    let mesh = read_bytes(missing.as_bytes()).unwrap();
    assert_eq!((mesh.materials.len(), &mesh.notes[0][..]), (0, "texture `skin.png` is not there"));
}

#[test]
fn what_is_not_used_is_named_whatever_it_is_called() {
    let header = HEADER
        .replace("property float z\n", "property float z\nproperty float scalar_#2\nproperty float x\n")
        .replace("end_header", "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header")
        .replace("made by hand", "B\u{fc}ste");
    let body: String = SQUARE
        .lines()
        .enumerate()
        .fold(String::new(), |all, (line, text)| all + text + if line < 4 { " 7 9\n" } else { "\n" });
    let mesh = read_bytes(text(&header, &(body + "0 1\n")).as_bytes()).unwrap();
    assert_eq!(mesh.notes, ["not used: scalar__2 and x_ of vertex and 1 elements `edge`"]);
    assert_eq!((mesh.triangles.len(), mesh.statistics().area), (2, 1.0));
    // Latin-1 in a comment.
    let bytes = text(HEADER, SQUARE).replace("made by hand", "B?ste").into_bytes();
    let bytes: Vec<u8> = bytes.into_iter().map(|byte| if byte == b'?' { 0xfc } else { byte }).collect();
    assert_eq!(read_bytes(&bytes).unwrap().triangles.len(), 2);
}

#[test]
fn positions_of_text_have_all_their_digits() {
    let ball = procedural::sphere(1.0, 3);
    let centre = DVec3::new(512_345.0, 4_512_345.0, 120.0);
    let header = HEADER
        .replace("vertex 4", &format!("vertex {}", ball.positions.len()))
        .replace("face 2", &format!("face {}", ball.triangles.len()));
    let mut body = String::new();
    for position in &ball.positions {
        let at = position.as_dvec3() + centre;
        body += &format!("{} {} {}\n", at.x, at.y, at.z);
    }
    for [a, b, c] in &ball.triangles {
        body += &format!("3 {a} {b} {c}\n");
    }
    let mesh = read_bytes(text(&header, &body).as_bytes()).unwrap();
    assert!(mesh.positions.iter().all(|position| (position.length() - 1.0).abs() < 1e-6));
}

#[test]
fn errors_say_where_and_what() {
    let cut = text(HEADER, &SQUARE[..18]);
    assert_eq!(
        message(&cut),
        "a.ply:13: vertex 4 of 4: the file ends before it is complete: it is cut off; fetch or export it again"
    );
    let bytes = binary("binary_little_endian", |_| {});
    assert_eq!(
        message(&bytes[..bytes.len() - 3]),
        "a.ply: face 2 of 2: the file ends before it is complete: it is cut off; fetch or export it again"
    );
    let text_error = message(text(HEADER, &SQUARE.replace("1 1 0", "1 zero 0")));
    assert!(
        text_error.starts_with("a.ply:13: vertex 3 of 4: ") && text_error.contains("zero"),
        "{text_error}"
    );
    assert!(
        message("ply\nformat ascii 1.0\nelement vertex\n")
            .starts_with("a.ply:3: header: `element vertex` is no line")
    );
    assert!(message("ply\nformat ascii 1.0\n").contains("header: the file ends within it"));
    assert!(message(text(&HEADER.replace("float y", "float why"), SQUARE)).contains("vertex: it has no `y`"));
    let points = text(&HEADER.replace("face 2", "face 0"), SQUARE);
    assert_eq!(
        message(points),
        "a.ply: no triangles: found 4 vertices and 0 faces; export the mesh with its faces"
    );
    // Counts that no file holds take neither time nor memory.
    let lies = HEADER.replace("vertex 4", "vertex 4000000000").replace("property float x\n", "");
    assert!(message(text(&lies, SQUARE)).contains("it has no `x`"));
    let nothing = "element nothing 18446744073709551615\n".to_owned() + &HEADER[21..];
    assert_eq!(read_bytes(text(&nothing, SQUARE).as_bytes()).unwrap().triangles.len(), 2);
}
