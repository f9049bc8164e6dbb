#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::*;
use crate::sources::procedural;
use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const OBJ: &str = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\nvt 0 0\nvn 0 0 1\ns 1\nusemtl a\n\
    f 1/1/1 2/1/1 3/1/1 4/1/1\ns off\nf 1 3 4\n";

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty short z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\nproperty list uchar int vertex_indices\n\
    end_header\n0 0 0 255 0 0\n1 0 0 1 2 3\n1 1 0 4 5 6\n0 1 0 7 8 9\n3 0 1 2\n4 0 1 2 3\n";

const STL: &str = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";

const GLTF: &str = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":42,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],"accessors":[{"bufferView":0,"componentType":5126,
"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}"#;

/// A PLY file and an STL file of bytes, and a glTF file of one piece.
fn binary_samples() -> [Vec<u8>; 3] {
    let mut ply =
        PLY[..PLY.find("end_header\n").unwrap() + 11].replace("ascii", "binary_little_endian").into_bytes();
    for [x, y, z] in [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]] {
        ply.extend((x as f32).to_le_bytes());
        ply.extend(f64::from(y).to_le_bytes());
        ply.extend((z as i16).to_le_bytes());
        ply.extend([1, 2, 3]);
    }
    for face in [&[0, 1, 2][..], &[0, 1, 2, 3_i32]] {
        ply.push(face.len() as u8);
        face.iter().for_each(|index| ply.extend(index.to_le_bytes()));
    }
    let cube = procedural::cuboid(glam::Vec3::ONE);
    let mut stl = vec![0; 80];
    stl.extend((cube.triangles.len() as u32).to_le_bytes());
    for triangle in &cube.triangles {
        stl.extend([0; 12]);
        for &vertex in triangle {
            cube.positions[vertex as usize]
                .to_array()
                .iter()
                .for_each(|number| stl.extend(number.to_le_bytes()));
        }
        stl.extend([0; 2]);
    }
    let mut text = GLTF.as_bytes().to_vec();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((20 + text.len() as u32).to_le_bytes());
    glb.extend((text.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(text);
    [ply, stl, glb]
}

fn write(folder: &tempfile::TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn the_content_tells_the_format_whatever_the_name_says() {
    let folder = tempfile::tempdir().unwrap();
    let [ply, stl, glb] = binary_samples();
    let samples =
        [OBJ.as_bytes(), PLY.as_bytes(), STL.as_bytes(), GLTF.as_bytes(), &ply[..], &stl[..], &glb[..]];
    for (bytes, triangles) in samples.into_iter().zip([3, 3, 1, 1, 3, 12, 1]) {
        for name in ["mesh", "mesh.obj", "mesh.PLY", "mesh.stl", "mesh.glb", "mesh.dat"] {
            let path = write(&folder, name, bytes);
            let mesh = read_mesh(&path, Normals::Auto);
            assert_eq!(mesh.unwrap().triangles.len(), triangles, "{name}");
            let path = write(&folder, &format!("{name}.gz"), &packed(bytes));
            let mesh = read_mesh(&path, Normals::Auto);
            assert_eq!(mesh.unwrap().triangles.len(), triangles, "{name}.gz");
        }
    }
    let refused = |name: &str, bytes: &[u8]| {
        read_mesh(&write(&folder, name, bytes), Normals::Auto).unwrap_err().to_string()
    };
    assert!(
        refused("a.fbx", b"Kaydara")
            .ends_with("FBX files are not read; export the mesh as glTF, PLY, STL or Wavefront OBJ")
    );
    assert!(refused("a.txt", b"A letter.").contains("not a mesh format that is known"));
    assert!(refused("a.obj", b"").contains("a.obj: no triangles: found 0 vertices and 0 faces"));
    assert!(refused("a.obj.gz", &packed(OBJ.as_bytes())[..40]).contains("the gzip is corrupt or cut off"));
    assert!(refused("a.glb", b"glTF").contains("binary glTF of version 0"));
}

#[test]
fn damaged_files_neither_panic_nor_hang() {
    let [ply, stl, glb] = binary_samples();
    let samples =
        [OBJ.as_bytes(), PLY.as_bytes(), STL.as_bytes(), GLTF.as_bytes(), &ply[..], &stl[..], &glb[..]];
    let mut state = 7_u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    let folder = tempfile::tempdir().unwrap();
    let (mut loaded, mut slowest) = (0, Duration::ZERO);
    for round in 0..7000 {
        let mut bytes = samples[round % samples.len()].to_vec();
        for _ in 0..=random(4) {
            let place = random(bytes.len());
            match random(5) {
                0 => bytes[place] ^= 1 << random(8),
                1 => bytes[place] = b"0123456789- .e\n\0\xff"[random(17)],
                2 => bytes.insert(place, b"019-\n\xff\0"[random(7)]),
                3 => drop(bytes.drain(place..(place + random(8)).min(bytes.len()))),
                _ if random(6) == 0 => bytes.truncate(place + 1),
                _ => {}
            }
            if bytes.is_empty() {
                bytes.push(0);
            }
        }
        let path = write(
            &folder,
            ["a.obj", "a.ply", "a.stl", "a.gltf", "b.ply", "b.stl", "a.glb"][round % 7],
            &bytes,
        );
        let start = Instant::now();
        let read = read_mesh(&path, Normals::Auto);
        slowest = slowest.max(start.elapsed());
        if let Ok(mesh) = read {
            loaded += 1;
            let vertices = mesh.positions.len();
            assert!(mesh.triangles.iter().flatten().all(|&index| (index as usize) < vertices));
            assert!(mesh.normals.len() == vertices && [0, vertices].contains(&mesh.colours.len()));
            assert!([0, vertices].contains(&mesh.texture_coordinates.len()));
            assert!(mesh.positions.iter().all(|position| position.is_finite()));
            assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-5));
            assert!(mesh.colours.iter().flatten().all(|value| (0.0..=1.0).contains(value)));
            let end = mesh.triangles.len() as u32;
            assert!(
                mesh.parts
                    .iter()
                    .all(|part| part.triangles.end <= end && (part.material as usize) < mesh.materials.len())
            );
        }
    }
    assert!(slowest < Duration::from_secs(5), "{slowest:?}");
    assert!(
        (1000..6500).contains(&loaded),
        "{loaded} of 7000 loaded: the mutations are too strong or too weak"
    );
}
