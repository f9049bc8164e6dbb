#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;

use glam::{DVec3, Vec3};

use super::*;
use crate::sources::mesh::Normals;
use crate::sources::mesh::triangulate::Cutter;

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

fn read(bytes: impl AsRef<[u8]>) -> Result<MeshData, SourceError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    fs::write(&path, bytes).unwrap();
    read_obj(&path, Normals::default())
}

/// The error's text without the folder.
fn message(bytes: impl AsRef<[u8]>) -> String {
    let text = read(bytes).unwrap_err().to_string();
    text[text.find("a.obj").unwrap()..].to_owned()
}

/// How many triangles a polygon gives, and their area over that of the polygon.
fn cut(corners: &[Vec3]) -> (usize, f64) {
    let mut triangles = Vec::new();
    Cutter::default().cut(corners, &mut triangles);
    let corner = |index: usize| corners[index].as_dvec3();
    let areas =
        triangles.iter().map(|&[a, b, c]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).length());
    let around = (0..corners.len()).map(|index| corner(index).cross(corner((index + 1) % corners.len())));
    (triangles.len(), areas.sum::<f64>() / around.sum::<DVec3>().length())
}

#[test]
fn a_cube_is_closed_however_its_lines_end() {
    let endings =
        [CUBE.to_owned(), CUBE.replace('\n', "\r\n"), CUBE.replace('\n', "\r"), CUBE.trim_end().to_owned()];
    let bom = format!("\u{feff}{CUBE}");
    let continued = CUBE.replace("f 1 4 3 2", "f 1 \\\n  4\\\r\n 3 \\ \n2");
    for text in endings.into_iter().chain([bom, continued]) {
        let statistics = read(&text).unwrap().statistics();
        assert_eq!(
            (statistics.vertices, statistics.triangles, statistics.open_edges),
            (24, 12, 0),
            "{text:?}"
        );
        assert_eq!(statistics.area, 6.0);
    }
}

#[test]
fn a_trailing_backslash_continues_geometry_only() {
    let text = format!("# C:\\models\\\nmtllib C:\\\n{CUBE}g back\\\nv 0 0 0 # origin");
    assert_eq!(read(text).unwrap().triangles.len(), 12);
}

#[test]
fn errors_name_the_line_as_the_file_counts_it() {
    let problem = "a face names vertex 9, but 8 are defined; export the mesh again, or correct the index";
    assert_eq!(message(format!("{CUBE}f 1 2 9\n")), format!("a.obj:15: {problem}"));
    assert_eq!(message(format!("{}f 1 2 9\r\n", CUBE.replace('\n', "\r\n"))), format!("a.obj:15: {problem}"));
    let continued = CUBE.replace("v 1 0 0\n", "v 1 \\\n 0 0\n\n");
    assert_eq!(message(format!("{continued}f 1 2 9\n")), format!("a.obj:17: {problem}"));
    // The first of several, although it is known to be wrong at the end only.
    assert!(
        message(format!("f 1 8 9\nf 1 2 8\nf 1 2 70\n{CUBE}")).starts_with("a.obj:1: a face names vertex 9,")
    );
    assert!(message(format!("{CUBE}f 1 2 -9\n")).starts_with("a.obj:15: a face names vertex -9, but 8"));
    assert!(message(format!("{CUBE}f 1 0 2\n")).starts_with("a.obj:15: a face names index 0"));
    assert!(
        message(format!("{CUBE}vn 0 0 1\nf 1//1 2//1 3//2\n"))
            .starts_with("a.obj:16: a face names normal 2, but 1")
    );
}

#[test]
fn a_mesh_far_from_its_origin_keeps_its_shape() {
    // A pyramid of a tenth of a unit at a place of a national grid.
    let text = "v 512345.00 4512345.00 120.0\nv 512345.10 4512345.00 120.0\nv 512345.00 4512345.10 120.0\nv 512345.00 4512345.00 120.1\n\
                f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let mesh = read(text).unwrap();
    assert_eq!(mesh.origin, DVec3::new(512345.0, 4512345.0, 120.0));
    let (low, high) = mesh.bounds().unwrap();
    assert!((high - low).abs_diff_eq(Vec3::splat(0.1), 1e-6), "{low} {high}");
    assert_eq!(read("v 1 2 3\nv 2 2 3\nv 1 3 3\nf 1 2 3\n").unwrap().origin, DVec3::ZERO);
}

#[test]
fn edges_are_hard_where_the_file_or_the_angle_says_so() {
    // Two squares that meet at a right angle.
    let bent = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 1\nv 1 1 1\n";
    let vertices = |groups: [&str; 2], rule: Normals| {
        let [first, second] = groups;
        let text = format!("{bent}{first}\nf 1 2 3 4\n{second}\nf 2 5 6 3\n");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bent.obj");
        fs::write(&path, text).unwrap();
        read_obj(&path, rule).unwrap().positions.len()
    };
    assert_eq!(vertices(["", ""], Normals::Auto), 8, "a right angle is a crease");
    assert_eq!(vertices(["s 1", ""], Normals::Auto), 6, "a group is smooth whatever its angles");
    assert_eq!(vertices(["s 1", "s 2"], Normals::Auto), 8);
    assert_eq!(vertices(["s off", ""], Normals::Auto), 8);
    assert_eq!(vertices(["s off", ""], Normals::Smooth(100.0)), 6, "what is asked for counts for more");
    assert_eq!(vertices(["s 1", ""], Normals::Flat), 8);
}

#[test]
fn vertices_may_follow_the_faces_that_use_them() {
    assert_eq!(read("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap().triangles.len(), 1);
}

#[test]
fn what_is_no_number_or_corner_is_quoted() {
    assert!(message("v 0 0 zero\n").starts_with("a.obj:1: `zero` is not a number; `v` needs three"));
    assert!(message("v 0 0 \u{1b}[31m\n").contains("`\\u{1b}[31m` is not a number"));
    assert!(message(format!("v {} 0 0\n", "x".repeat(1000))).contains(&format!("`{}...`", "x".repeat(40))));
    assert!(message("v 0 0\n").starts_with("a.obj:1: `v` needs three numbers, z is missing; add it"));
    assert!(message("vn 0\n").starts_with("a.obj:1: `vn` needs three numbers, y is missing"));
    assert!(
        message("v 0 0 0\nf 1 a/2 1\n").starts_with("a.obj:2: `a/2` is no face corner; write indices like")
    );
    let huge = "9".repeat(30);
    assert!(message(format!("v 0 0 0\nf 1 {huge} 1\n")).contains("is no face corner"));
    // Texture coordinates are not used: whatever they are does no harm.
    assert!(read(format!("{CUBE}f 1/{huge} 2/-7 3/0\n")).is_ok());
}

#[test]
fn a_file_cut_off_says_so() {
    assert!(message("v 0 0 0\nv 1 0").ends_with("add it; the file ends within this line: is it cut off?"));
    let mesh = read(CUBE.strip_suffix(" 4 1 5 8\n").unwrap()).unwrap();
    assert_eq!(mesh.triangles.len(), 10);
    assert!(
        mesh.notes.contains(&"the file ends within a face: it may be cut off".to_owned()),
        "{:?}",
        mesh.notes
    );
}

#[test]
fn other_encodings_are_named() {
    let utf16 = |to_bytes: fn(u16) -> [u8; 2]| CUBE.encode_utf16().flat_map(to_bytes).collect::<Vec<_>>();
    let (little, big) = (utf16(u16::to_le_bytes), utf16(u16::to_be_bytes));
    for bytes in [little.clone(), [&[0xff, 0xfe], &little[..]].concat()] {
        let text = message(bytes);
        assert!(text.contains("found UTF-16 (little-endian); convert it: iconv -f UTF-16LE"), "{text}");
    }
    for bytes in [big.clone(), [&[0xfe, 0xff], &big[..]].concat()] {
        assert!(message(bytes).contains("found UTF-16 (big-endian); convert it: iconv -f UTF-16BE"));
    }
    assert!(message([0x1f, 0x8b, 8, 1]).contains("found gzip; unpack it"));
    assert!(message("ply\nformat ascii 1.0\n").contains("found PLY"));
    assert!(message(b"o x\nv 1 2 3\nf 1 2 3 4 5 6\0").contains("found binary data"));
    // Latin-1 in a comment is no reason to refuse a mesh.
    assert!(read([b"# B\xfcste\n", CUBE.as_bytes()].concat()).is_ok());
}

#[test]
fn without_triangles_it_says_what_there_is() {
    let mend = "export the mesh with its faces";
    assert_eq!(message(""), format!("a.obj: no triangles: found 0 vertices and 0 faces; {mend}"));
    let found = "3 vertices and 0 faces, 1 face with fewer than three corners dropped, 2 point or line elements ignored";
    let text = message("v 0 0 0\nv 1 0 0\nv 0 1 0\np 1\nl 1 2\nf 1 2\n");
    assert_eq!(text, format!("a.obj: no triangles: found {found}; {mend}"));
    let text = message("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    assert!(text.contains("found 3 vertices and 1 face, 1 zero-area triangle dropped"), "{text}");
}

#[test]
fn what_is_ignored_is_noted() {
    let text = format!("{CUBE}v 0 0 0 0.5\nv nan -1.#IND inf\nf 1 2 10\np 1\ncurv 0 1 1 2\n");
    let notes = [
        "1 point or line element ignored",
        "1 free-form curve or surface ignored",
        "1 weight (a fourth number of `v`) ignored: only rational curves have any",
        "1 of 9 used vertices with a NaN or infinite coordinate; 1 face dropped",
    ];
    assert_eq!(read(text).unwrap().notes, notes);
}

#[test]
fn faces_with_and_without_normals_mix() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 -2\nf 1//1 2//-1 3/7/1\nf 2 4 3\n";
    let mesh = read(text).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (6, 2));
    assert_eq!(mesh.normals, [Vec3::NEG_Z, Vec3::NEG_Z, Vec3::NEG_Z, Vec3::Z, Vec3::Z, Vec3::Z]);
    assert_eq!(
        mesh.notes,
        ["normals of 3 of 6 vertices computed (angle-weighted): missing, zero or not finite"]
    );
}

#[test]
fn concave_polygons_keep_their_area() {
    let points = |points: &[(f32, f32)]| -> Vec<Vec3> {
        let tilted = |&(x, y): &(f32, f32)| Vec3::new(x, y, 2.0 * x - y) * 1e-3 + Vec3::splat(7.0);
        points.iter().map(tilted).collect()
    };
    let arrow = points(&[(0.0, 0.0), (4.0, 4.0), (0.0, 1.0), (-4.0, 4.0)]);
    let comb = points(&[
        (0., 0.),
        (9., 0.),
        (9., 5.),
        (7., 5.),
        (7., 1.),
        (5., 1.),
        (5., 5.),
        (3., 5.),
        (3., 1.),
        (0., 5.),
    ]);
    let on_an_edge = points(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 1.0)]);
    let spiral: Vec<_> = (0..200)
        .map(|step| (step.min(399 - step), if step < 100 { 1.0 } else { 0.9 }))
        .map(|(step, scale)| (if scale == 1.0 { step } else { 199 - step } as f32 * 0.2, scale))
        .map(|(angle, scale)| (angle.cos() * (angle + 4.0) * scale, angle.sin() * (angle + 4.0) * scale))
        .collect();
    for mut polygon in [arrow, comb, on_an_edge, points(&spiral)] {
        for _ in 0..polygon.len() {
            for _ in 0..2 {
                let (triangles, area) = cut(&polygon);
                assert_eq!(triangles, polygon.len() - 2);
                assert!((area - 1.0).abs() < 1e-2, "{area}: {polygon:?}");
                polygon.reverse();
            }
            polygon.rotate_left(1);
        }
    }
}

#[test]
fn strange_polygons_end() {
    assert_eq!(cut(&[Vec3::ZERO; 7]).0, 5);
    assert_eq!(cut(&[Vec3::X, Vec3::Y]).0, 0);
    let line: Vec<_> = (0..50).map(|step| Vec3::X * step as f32).collect();
    assert_eq!(cut(&line).0, 48);
    let star: Vec<_> =
        (0..7).map(|step| step as f32 * 2.7).map(|a| Vec3::new(a.cos(), a.sin(), 0.0)).collect();
    assert_eq!(cut(&star).0, 5);
    let twice: Vec<_> = [Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y].repeat(2);
    assert_eq!(cut(&twice).0, 2);
    // Its last edge crosses all others.
    for count in [200, 2000, 20_000] {
        let at = |step: usize| Vec3::new(step as f32, (step % 2 * 100) as f32, 0.0);
        let comb: Vec<_> = (0..count).map(at).collect();
        assert_eq!(cut(&comb).0, count - 2);
    }
}

#[test]
fn faces_of_very_many_corners_are_cut_at_once() {
    let count = 1_000_000;
    let circle = (0..count).map(|step| step as f64 / count as f64 * std::f64::consts::TAU);
    let circle: Vec<_> = circle.map(|angle| Vec3::new(angle.cos() as f32, 1.0, angle.sin() as f32)).collect();
    let comb = (0..count - 2).map(|step| Vec3::new((count - step) as f32, (1 + step % 2 * 100) as f32, 0.0));
    let comb = comb.chain([Vec3::ZERO, Vec3::X * count as f32]).collect();
    // Corners on straight edges stay corners.
    let side = |from: Vec3, to: Vec3| (0..count / 4).map(move |step| from.lerp(to, step as f32 / 250_000.0));
    let [a, b, c, d] =
        [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y].map(|corner| corner * 250_000.0);
    let square = side(a, b).chain(side(b, c)).chain(side(c, d)).chain(side(d, a)).collect();
    for polygon in [circle, comb, square] {
        let start = std::time::Instant::now();
        let (triangles, area) = cut(&polygon);
        assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
        assert!(triangles >= count - 2 - 100 && (area - 1.0).abs() < 1e-3, "{triangles}: {area}");
    }
}

#[test]
fn a_face_of_very_many_corners_may_have_a_hole() {
    // A ring: its outer edge, a bridge, its inner edge the other way round, the bridge back.
    for count in [100, 1000] {
        let at = |radius: f64, step: usize| {
            let angle = step as f64 / count as f64 * std::f64::consts::TAU;
            Vec3::new((radius * angle.cos()) as f32, (radius * angle.sin()) as f32, 0.0)
        };
        let ring: Vec<_> = (0..=count).map(|step| at(2.0, step % count)).collect();
        let hole = (0..=count).rev().map(|step| at(1.0, step % count));
        let polygon: Vec<_> = ring.into_iter().chain(hole).collect();
        let (triangles, area) = cut(&polygon);
        assert_eq!(triangles, polygon.len() - 2);
        assert!((area - 1.0).abs() < 1e-3, "{count}: {area}");
    }
}

#[test]
fn a_face_of_too_many_corners_is_refused() {
    let text = message(format!("{CUBE}f {}\n", "1 2 3 ".repeat(1_400_000)));
    assert!(text.starts_with("a.obj:15: a face of more than 4194304 corners; triangulate it"), "{text}");
}

#[test]
fn a_file_too_long_is_refused_unread() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    // Sparse: takes no room on the disk.
    fs::File::create(&path).unwrap().set_len(MAX_OBJ_BYTES + 1).unwrap();
    let text = read_obj(&path, Normals::default()).unwrap_err().to_string();
    assert!(
        text.ends_with("1073741825 bytes; at most 1073741824 are read; split or decimate the mesh"),
        "{text}"
    );
    let text = read_obj(folder.path(), Normals::default()).unwrap_err().to_string();
    assert!(text.contains("expected a file, found a folder"), "{text}");
    let text = read_obj(&folder.path().join("b.obj"), Normals::default()).unwrap_err().to_string();
    assert!(text.ends_with("no such file; did you mean `a.obj`?"), "{text}");
}

#[test]
fn broken_files_never_panic() {
    let texts = [
        CUBE.to_owned(),
        CUBE.replace('\n', " \\\r\n"),
        "v 0 0 0\nv 1 0 0\nv .5 2e-3 0\nvn 0 0 1\nvt 0 0\nf 1/1/1 -2/-1/-1 3//1\nf 1 2 3 1 2 3\nl 1 2\n"
            .repeat(3),
    ];
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let mut loaded = 0;
    for round in 0..2000 {
        let mut bytes = texts[round % texts.len()].clone().into_bytes();
        for _ in 0..=random(4) {
            let place = random(bytes.len());
            match random(4) {
                0 => bytes[place] ^= 1 << random(8),
                1 => bytes[place] = b" \n\r\\/-+.e#9f0v"[random(14)],
                2 => bytes.insert(place, b"\\\n/-9"[random(5)]),
                _ if random(4) == 0 => bytes.truncate(place + 1),
                _ => {}
            }
        }
        fs::write(&path, &bytes).unwrap();
        if let Ok(mesh) = read_obj(&path, Normals::default()) {
            loaded += 1;
            assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-5));
            assert!(mesh.triangles.iter().flatten().all(|&index| (index as usize) < mesh.positions.len()));
        }
    }
    assert!(
        (200..1900).contains(&loaded),
        "{loaded} of 2000 loaded: the mutations are too strong or too weak"
    );
}

#[test]
fn opacity_that_is_not_drawn_is_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let library = "newmtl glass\nKd 1 0 0\nd 0.3\nnewmtl stone\nKd 0 1 0\nnewmtl unused\nd 0\n";
    fs::write(folder.path().join("a.mtl"), library).unwrap();
    for (name, notes) in [("stone", 0), ("glass", 1)] {
        fs::write(&path, format!("mtllib a.mtl\nusemtl {name}\n{CUBE}")).unwrap();
        let mesh = read_obj(&path, Normals::default()).unwrap();
        assert_eq!(mesh.notes.len(), notes, "{:?}", mesh.notes);
        assert!(
            mesh.notes
                .iter()
                .all(|note| note.starts_with("the opacity of material `glass`, 0.3, is ignored"))
        );
    }
}
