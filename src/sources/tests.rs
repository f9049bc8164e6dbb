//! Every file of the test data folder, with what must become of it.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};
use tyndall_needs::needs;

use glam::Vec3;

use super::*;
use crate::sources::mesh::Normals;

fn data(folder: &str) -> PathBuf {
    Path::new(&std::env::var_os("TYNDALL_DATA").unwrap()).join(folder)
}

/// The names in a folder that end in `ending`.
fn names(folder: &str, ending: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(data(folder)).unwrap();
    entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(ending))
        .collect()
}

/// What must become of a mesh file.
#[derive(Debug)]
enum Outcome {
    /// Triangles, open edges, and a part of the notes.
    Mesh(usize, usize, &'static str),
    /// A part of the error.
    Error(&'static str),
}
use Outcome::{Error, Mesh};

const ODD_MESHES: &[(&str, Outcome)] = &[
    ("assimp_box_UTF16BE.obj", Error("found UTF-16 (big-endian); convert it: iconv")),
    ("assimp_box_longline.obj", Mesh(12, 0, "")),
    ("assimp_box_without_lineending.obj", Mesh(12, 0, "")),
    // A ring: 66 corners, of which the two of the seam come twice.
    ("assimp_concave_polygon.obj", Mesh(64, 64, "")),
    ("assimp_cube_with_vertexcolors.obj", Mesh(12, 0, "")),
    ("assimp_multiple_spaces.obj", Mesh(1, 3, "")),
    ("assimp_number_formats.obj", Error(":11: `3.1+e2` is not a number")),
    ("made_backslash_continuation.obj", Mesh(12, 0, "")),
    ("made_crlf.obj", Mesh(12, 0, "")),
    ("made_empty.obj", Error("no triangles: found 0 vertices and 0 faces")),
    ("made_flat_plane.obj", Mesh(2, 4, "")),
    ("made_huge_coordinates.obj", Mesh(12, 0, "")),
    ("made_index_out_of_range.obj", Error(":15: a face names vertex 900, but 8 are defined")),
    ("made_no_faces.obj", Error("no triangles: found 2 vertices and 0 faces")),
    ("made_truncated_mid_line.obj", Mesh(10, 4, "it may be cut off")),
    ("tinyobj_cube-vertex-w-component.obj", Mesh(12, 0, "8 weights (a fourth number of `v`) ignored")),
    ("tinyobj_cube-vertexcol.obj", Mesh(12, 0, "")),
    ("tinyobj_invalid-face-definition.obj", Error("2 faces with fewer than three corners dropped")),
    ("tinyobj_invalid-relative-vertex-index.obj", Error(":1: a face names vertex -4, but 0 are defined")),
    ("tinyobj_issue-140-zero-face-idx.obj", Error(":16: a face names index 0, but indices start at 1")),
    ("tinyobj_issue-161-inconsistent-f.obj", Mesh(12, 0, "")),
    ("tinyobj_issue-295-trianguation-failure.obj", Mesh(28, 0, "")),
    ("tinyobj_leading-decimal-dot-issue-201.obj", Mesh(1, 3, "")),
    (
        "tinyobj_line-prim.obj",
        Error("no triangles: found 8 vertices and 0 faces, 2 point or line elements ignored"),
    ),
    ("tinyobj_missing_material_file.obj", Mesh(36, 8, "")),
    (
        "tinyobj_points-prim.obj",
        Error("no triangles: found 8 vertices and 0 faces, 1 point or line element ignored"),
    ),
    (
        "tinyobj_test-nan.obj",
        Mesh(34, 10, "4 of 72 used vertices with a NaN or infinite coordinate; 1 face dropped"),
    ),
    ("tobj_invalid_index.obj", Error(":12: a face names vertex 7, but 6 are defined")),
    ("tobj_lines.obj", Error("no triangles: found 3 vertices and 0 faces, 3 point or line elements ignored")),
    ("tobj_quad_colored_merge.obj", Mesh(2, 4, "")),
    ("tobj_triangle.obj", Mesh(1, 3, "")),
    ("trimesh_empty.obj", Error("no triangles: found 0 vertices and 0 faces")),
    ("trimesh_face_in_group_name.obj", Error("no triangles: found 1 vertex and 0 faces")),
    ("trimesh_nancolor.obj", Mesh(12, 0, "")),
    ("trimesh_negative_indices.obj", Mesh(12, 0, "")),
    ("trimesh_notenoughindices.obj", Mesh(1, 3, "1 face with fewer than three corners dropped")),
    (
        "trimesh_obj_wireframe.obj",
        Error("no triangles: found 8 vertices and 0 faces, 12 point or line elements"),
    ),
    ("trimesh_two_objects.obj", Mesh(16, 0, "")),
];

const MESHES: &[(&str, Outcome)] = &[
    ("armadillo_43k_86k.obj", Mesh(86_482, 0, "")),
    ("buddha_50k_100k.obj", Mesh(100_000, 0, "")),
    ("bunny_npm.obj", Mesh(3_674, 0, "")),
    ("cornell_box_multimaterial.obj", Mesh(36, 8, "")),
    ("cornell_box_tinyobj.obj", Mesh(36, 8, "")),
    ("cornell_box_tobj.obj", Mesh(36, 8, "")),
    ("cow.obj", Mesh(5_804, 0, "")),
    ("dragon_50k_100k.obj", Mesh(100_000, 0, "")),
    ("fandisk.obj", Mesh(12_946, 0, "")),
    ("horse_48k_97k.obj", Mesh(96_966, 0, "")),
    ("lucy_50k_100k.obj", Mesh(99_970, 0, "")),
    ("spot.obj", Mesh(5_856, 0, "")),
    ("stanford-bunny.obj", Mesh(69_451, 223, "")),
    ("suzanne.obj", Mesh(968, 42, "")),
    ("teapot.obj", Mesh(6_320, 160, "")),
    ("uv_sphere_382_760.obj", Mesh(760, 0, "")),
    ("uv_sphere_382_800.obj", Mesh(760, 0, "40 zero-area triangles dropped")),
];

fn check_meshes(folder: &str, expected: &[(&str, Outcome)]) {
    let listed: BTreeSet<_> = expected.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(names(folder, ".obj"), listed, "a file without an outcome, or the other way round");
    for (name, outcome) in expected {
        match (read_obj(&data(folder).join(name), Normals::default()), outcome) {
            (Ok(mesh), Mesh(triangles, open_edges, note)) => {
                let statistics = mesh.statistics();
                assert_eq!(
                    (statistics.triangles, statistics.open_edges),
                    (*triangles, *open_edges),
                    "{name}"
                );
                assert!(mesh.notes.join("; ").contains(note), "{name}: {:?}", mesh.notes);
                assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-5), "{name}");
                assert!(mesh.positions.iter().all(|position| position.is_finite()), "{name}");
            }
            (Err(error), Error(part)) => assert!(error.to_string().contains(part), "{error}"),
            (result, outcome) => panic!("{name}: expected {outcome:?}, got {result:?}"),
        }
    }
}

#[needs(data)]
#[test]
fn odd_meshes_load_or_say_why_not() {
    check_meshes("meshes/odd", ODD_MESHES);
}

#[needs(data)]
#[test]
fn real_meshes_load_whole() {
    check_meshes("meshes", MESHES);
}

#[needs(data)]
#[test]
fn a_concave_ring_keeps_its_hole() {
    let statistics = read_obj(&data("meshes/odd").join("assimp_concave_polygon.obj"), Normals::default())
        .unwrap()
        .statistics();
    // The area that Newell's formula gives for the outline, which a fan around its first corner exceeds by far.
    assert!((statistics.area - 0.245_496_6).abs() < 1e-6, "{}", statistics.area);
}

/// Size, format and byte order out of `tooth_103x94x161_uint16_be.raw.gz`.
fn layout_of(name: &str) -> RawLayout {
    let words: Vec<_> = name.trim_end_matches(".raw.gz").split('_').collect();
    let place = words
        .iter()
        .position(|word| word.split('x').filter_map(|side| side.parse::<u32>().ok()).count() == 3);
    let place = place.unwrap();
    let sides: Vec<u32> = words[place].split('x').map(|side| side.parse().unwrap()).collect();
    let format = match words[place + 1] {
        "uint8" => SampleFormat::U8,
        "int16" => SampleFormat::I16,
        "uint16" => SampleFormat::U16,
        "float32" => SampleFormat::F32,
        other => panic!("{name}: {other}"),
    };
    let endian = if words.last() == Some(&"be") { Endian::Big } else { Endian::Little };
    RawLayout { size: sides.try_into().unwrap(), format, endian, spacing: Vec3::ONE, skip_bytes: 0 }
}

/// The ranges as the folder's manifest states them.
const VOLUME_RANGES: &[(&str, (f32, f32))] = &[
    ("axes_test_96x64x48_uint8.raw.gz", (0.0, 255.0)),
    ("bonsai_256x256x256_uint8.raw.gz", (0.0, 255.0)),
    ("boston_teapot_256x256x178_uint8.raw.gz", (0.0, 255.0)),
    ("brainweb_t1_180x216x180_uint8.raw.gz", (0.0, 255.0)),
    ("bucky_32x32x32_uint8.raw.gz", (0.0, 255.0)),
    ("engine_256x256x128_uint8.raw.gz", (0.0, 255.0)),
    ("fuel_cropped_64x33x32_uint8.raw.gz", (0.0, 255.0)),
    ("headsq_quarter_64x64x93_int16.raw.gz", (0.0, 3926.0)),
    ("hydrogen_64x64x64_float32.raw.gz", (0.0, 1.0)),
    ("marschner_lobb_41x41x41_uint8.raw.gz", (0.0, 255.0)),
    ("neghip_66x66x66_uint8.raw.gz", (0.0, 255.0)),
    ("ramp_called_bucky_32x32x32_uint8.raw.gz", (1.0, 248.0)),
    ("sphere_distance_64x64x64_uint8.raw.gz", (6.0, 221.0)),
    ("sphere_distance_u16be_64x64x64_uint16_be.raw.gz", (1475.0, 56457.0)),
    ("stent_128x128x256_int16.raw.gz", (0.0, 2000.0)),
    ("tooth_103x94x161_uint16_be.raw.gz", (0.0, 1300.0)),
];

#[needs(data)]
#[test]
fn real_volumes_have_the_ranges_their_manifest_states() {
    let listed: BTreeSet<_> = VOLUME_RANGES.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(names("volumes", ".raw.gz"), listed);
    for (name, range) in VOLUME_RANGES {
        let volume = read_raw(&data("volumes").join(name), &layout_of(name)).unwrap();
        assert_eq!((volume.range, volume.non_finite), (*range, 0), "{name}");
    }
    let name = "ramp_called_bucky_32x32x32_uint8.raw.gz";
    let ramp = read_raw(&data("volumes").join(name), &layout_of(name)).unwrap();
    assert_eq!(ramp.bricks.ranges[..4], [[1.0, 64.0], [56.0, 128.0], [120.0, 192.0], [184.0, 248.0]]);
}

#[needs(data)]
#[test]
fn odd_volumes_load_or_say_why_not() {
    let read = |name: &str, side| {
        let (size, spacing) = ([side; 3], Vec3::ONE);
        let layout =
            RawLayout { size, format: SampleFormat::U8, endian: Endian::Little, spacing, skip_bytes: 0 };
        read_raw(&data("volumes/odd").join(name), &layout)
    };
    let listed = ["bucky_one_byte_long.raw", "bucky_truncated_20000.raw", "constant_16.raw"];
    assert_eq!(names("volumes/odd", ".raw"), listed.map(str::to_owned).into());
    let text = read(listed[0], 32).unwrap_err().to_string();
    assert!(text.contains("32769 bytes; 32 x 32 x 32 U8 voxels need 32768 (1 more than expected"), "{text}");
    assert!(text.contains("set skip_bytes to 1;"), "{text}");
    let text = read(listed[1], 32).unwrap_err().to_string();
    assert!(
        text.contains("20000 bytes; 32 x 32 x 32 U8 voxels need 32768 (12768 fewer than expected"),
        "{text}"
    );
    let constant = read(listed[2], 16).unwrap();
    assert_eq!(constant.range.0, constant.range.1);
    assert!(constant.bricks.ranges.iter().all(|range| *range == [constant.range.0; 2]));
}
