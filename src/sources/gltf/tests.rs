#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use super::*;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{Vec2, Vec3};
use serde_json::{Value, json};

/// Numbers of buffers.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Bytes {
    fn floats(mut self, numbers: &[f32]) -> Self {
        self.0.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        self
    }

    fn shorts(mut self, numbers: &[u16]) -> Self {
        self.0.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        self
    }
}

/// A triangle of side 1 in a buffer: positions, then three indices.
fn triangle() -> Vec<u8> {
    Bytes::default().floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]).shorts(&[0, 1, 2]).0
}

/// The document of a triangle with a buffer of `bytes` bytes.
fn document(bytes: usize) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": bytes }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }, { "buffer": 0, "byteOffset": 36, "byteLength": 6 }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR" },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "nodes": [{ "mesh": 0 }],
        "scenes": [{ "nodes": [0] }],
        "scene": 0,
    })
}

fn glb(document: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend(((12 + 8 + text.len() + 8 + binary.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text[..]), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

fn read_document(document: &Value, binary: &[u8]) -> Result<MeshData, SourceError> {
    read(Path::new("a.glb"), &glb(document, binary), Normals::Auto)
}

fn message(document: &Value, binary: &[u8]) -> String {
    read_document(document, binary).unwrap_err().to_string()
}

#[test]
fn buffers_may_be_inside_in_text_or_beside() {
    let bytes = triangle();
    let mut written = document(bytes.len());
    let expected = read_document(&written, &bytes).unwrap();
    assert_eq!((expected.triangles.len(), expected.statistics().area), (1, 0.5));
    assert!(expected.notes.is_empty(), "{:?}", expected.notes);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("the buffer é.bin"), &bytes).unwrap();
    for uri in [
        format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes)),
        format!("data:application/gltf-buffer;base64,{}", STANDARD.encode(&bytes).trim_end_matches('=')),
        "the%20buffer%20%C3%A9.bin".to_owned(),
        "the buffer é.bin".to_owned(),
    ] {
        written["buffers"][0]["uri"] = uri.clone().into();
        let text = format!("\u{feff}{written:#}");
        let mesh = read(&folder.path().join("a.gltf"), text.as_bytes(), Normals::Auto);
        assert_eq!(mesh.unwrap(), expected, "{uri}");
    }
}

#[test]
fn nodes_place_meshes_and_mirrors_turn_them() {
    let bytes = triangle();
    let mut written = document(bytes.len());
    written["nodes"] = json!([
        { "translation": [10, 0, 0], "children": [1, 2, 3] },
        { "mesh": 0 },
        { "mesh": 0, "scale": [-2, 2, 2] },
        { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 5, 1] },
        { "mesh": 0, "translation": [0, 0, 900] },
    ]);
    let mesh = read_document(&written, &bytes).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.statistics().area), (3, 0.5 + 2.0 + 0.5));
    assert_eq!(mesh.bounds().unwrap(), (Vec3::new(8.0, 0.0, 0.0), Vec3::new(11.0, 2.0, 6.0)));
    let facing = |normal: Vec3| mesh.normals.iter().filter(|at| at.abs_diff_eq(normal, 1e-6)).count();
    // The two in the plane share a corner.
    assert_eq!((facing(Vec3::Z), facing(Vec3::NEG_Y)), (5, 3), "{:?}", mesh.normals);
    // A node that is its own grandchild, and one that is not there.
    written["nodes"][3]["children"] = json!([0]);
    assert_eq!(read_document(&written, &bytes).unwrap().notes, ["not used: a second parent of node 0"]);
    written["nodes"][3]["children"] = json!([77]);
    assert!(message(&written, &bytes).contains("nodes: there is no node 77"));
}

#[test]
fn without_a_scene_all_nodes_are_shown() {
    let bytes = triangle();
    let mut written = document(bytes.len());
    written["nodes"] = json!([{ "children": [1], "translation": [1, 0, 0] }, { "mesh": 0 }, { "mesh": 0 }]);
    for name in ["scene", "scenes"] {
        written.as_object_mut().unwrap().remove(name);
    }
    assert_eq!(read_document(&written, &bytes).unwrap().triangles.len(), 2);
}

#[test]
fn strips_fans_and_every_type_of_index_are_read() {
    let square = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];
    for (mode, indices) in [(5, vec![0, 1, 2, 3]), (6, vec![0, 1, 3, 2]), (4, vec![0, 1, 3, 0, 3, 2])] {
        for (component, size) in [(5121, 1), (5123, 2), (5125, 4)] {
            let mut bytes = Bytes::default().floats(&square).0;
            indices.iter().for_each(|index: &u32| bytes.extend(&index.to_le_bytes()[..size]));
            let mut written = document(bytes.len());
            written["bufferViews"] = json!([
                { "buffer": 0, "byteLength": 48 },
                { "buffer": 0, "byteOffset": 48, "byteLength": indices.len() * size },
            ]);
            written["accessors"][0]["count"] = 4.into();
            written["accessors"][1]["count"] = indices.len().into();
            written["accessors"][1]["componentType"] = component.into();
            written["meshes"][0]["primitives"][0]["mode"] = mode.into();
            let mesh = read_document(&written, &bytes).unwrap();
            assert_eq!((mesh.triangles.len(), mesh.statistics().area), (2, 1.0), "{mode} {component}");
            assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z));
        }
    }
    let bytes = Bytes::default().floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]).0;
    let mut written = document(bytes.len());
    written["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    assert_eq!(read_document(&written, &bytes).unwrap().triangles.len(), 1);
}

#[test]
fn sparse_and_quantised_accessors_are_read() {
    // All zeros but for two of three vertices.
    let mut bytes = Bytes::default().floats(&[2., 0., 0., 0., 2., 0.]).0;
    bytes.extend([1, 2]);
    let mut written = document(bytes.len());
    written["bufferViews"] =
        json!([{ "buffer": 0, "byteLength": 24 }, { "buffer": 0, "byteOffset": 24, "byteLength": 2 }]);
    written["accessors"] = json!([{
        "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [2, 2, 0],
        "sparse": {
            "count": 2, "values": { "bufferView": 0 }, "indices": { "bufferView": 1, "componentType": 5121 },
        },
    }]);
    written["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": 0 } });
    assert_eq!(read_document(&written, &bytes).unwrap().statistics().area, 2.0);
    written["accessors"][0]["count"] = 4_000_000_000_u64.into();
    assert!(message(&written, &bytes).contains("4000000000 values, of which 2 are there"));
    // 16-bit positions, eight bytes apart, normalised.
    let shorts = [0, 0, 0, 0, 32_767, 0, 0, 0, 0, 32_767, 0, 0];
    let bytes = Bytes::default().shorts(&shorts).0;
    let mut written = document(bytes.len());
    written["bufferViews"] = json!([{ "buffer": 0, "byteLength": 24, "byteStride": 8 }]);
    written["accessors"] = json!([{
        "bufferView": 0, "componentType": 5122, "normalized": true, "count": 3, "type": "VEC3", "min": [0, 0, 0],
        "max": [1, 1, 0],
    }]);
    written["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": 0 } });
    written["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    assert_eq!(read_document(&written, &bytes).unwrap().statistics().area, 0.5);
}

/// A triangle with normals, colours of three bytes and texture coordinates.
fn decorated(material: Value) -> (Value, Vec<u8>) {
    let mut bytes = triangle();
    bytes.extend([0; 2]);
    let bytes =
        Bytes(bytes).floats(&[0., 0., 2., 0., 0., 2., 0., 0., 2.]).floats(&[0., 0., 1., 0., 0.25, 1.]);
    let mut bytes = bytes.0;
    bytes.extend([255, 0, 0, 255, 0, 128, 0, 255, 0, 0, 255, 51]);
    let mut written = document(bytes.len());
    for (offset, length) in [(44, 36), (80, 24), (104, 12)] {
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
        written["bufferViews"].as_array_mut().unwrap().push(view);
    }
    for (view, component, kind) in [(2, 5126, "VEC3"), (3, 5126, "VEC2"), (4, 5121, "VEC4")] {
        let accessor = json!({
            "bufferView": view, "componentType": component, "count": 3, "type": kind, "normalized": component == 5121,
        });
        written["accessors"].as_array_mut().unwrap().push(accessor);
    }
    written["meshes"][0]["primitives"][0] = json!({
        "attributes": { "POSITION": 0, "NORMAL": 2, "TEXCOORD_0": 3, "COLOR_0": 4 }, "indices": 1, "material": 0,
    });
    written["materials"] = json!([material]);
    (written, bytes)
}

#[test]
fn materials_become_what_phong_needs() {
    let (written, bytes) = decorated(json!({
        "name": "paint",
        "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 1, 0.5], "metallicFactor": 0.5, "roughnessFactor": 0.5 },
        "alphaMode": "BLEND",
        "emissiveFactor": [1, 0, 0],
    }));
    let mesh = read_document(&written, &bytes).unwrap();
    let [paint] = &mesh.materials[..] else { panic!("{:?}", mesh.materials) };
    assert_eq!((&paint.name[..], paint.opacity, paint.diffuse), ("paint", 0.5, Vec3::new(0.25, 0.125, 0.5)));
    assert!(paint.specular.abs_diff_eq(Vec3::new(0.27, 0.145, 0.52), 1e-6), "{}", paint.specular);
    assert!((paint.shininess - 30.0).abs() < 1e-4 && paint.subsurface.is_none(), "{}", paint.shininess);
    assert_eq!((mesh.parts.len(), mesh.parts[0].triangles.clone()), (1, 0..1));
    let opacity = "the opacity of material `paint`, 0.5, is ignored: meshes hide what is behind them";
    assert_eq!(mesh.notes, ["not used: light of its own", opacity]);
    // Linear, as glTF has them.
    let colour = |at: Vec3| mesh.colours[mesh.positions.iter().position(|position| *position == at).unwrap()];
    assert_eq!(colour(Vec3::X), [0.0, 128.0 / 255.0, 0.0, 1.0]);
    assert!((colour(Vec3::Y)[3] - 0.2).abs() < 1e-6);
    assert!(mesh.normals.iter().all(|normal| *normal == Vec3::Z));
}

#[test]
fn pictures_colour_the_surface() {
    let mut picture = std::io::Cursor::new(Vec::new());
    let texels = image::RgbaImage::from_pixel(1, 2, image::Rgba([10, 20, 30, 40]));
    texels.write_to(&mut picture, image::ImageFormat::Png).unwrap();
    let uri = format!("data:image/png;base64,{}", STANDARD.encode(picture.get_ref()));
    let (mut written, bytes) = decorated(json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": {
                "index": 0, "extensions": { "KHR_texture_transform": { "offset": [0.5, 0], "scale": [2, 2] } },
            },
            "metallicRoughnessTexture": { "index": 0 },
            "metallicFactor": 0,
        },
    }));
    written["images"] = json!([{ "uri": uri }]);
    written["textures"] = json!([{ "source": 0 }]);
    let mesh = read_document(&written, &bytes).unwrap();
    let texture = mesh.materials[0].diffuse_texture.as_ref().unwrap();
    // Opaque, as the material is.
    assert_eq!((texture.width, texture.height, texture.texels[0]), (1, 2, [10, 20, 30, 255]));
    let at = |at: Vec3| {
        mesh.texture_coordinates[mesh.positions.iter().position(|position| *position == at).unwrap()]
    };
    assert_eq!((at(Vec3::ZERO), at(Vec3::X)), (Vec2::new(0.5, 1.0), Vec2::new(2.5, 1.0)));
    assert_eq!(at(Vec3::Y), Vec2::new(1.0, -1.0));
    assert_eq!(mesh.notes, ["not used: maps of metalness and roughness"]);
    written["images"] = json!([{ "uri": "gone.png" }]);
    let mesh = read_document(&written, &bytes).unwrap();
    assert!(mesh.materials[0].diffuse_texture.is_none() && mesh.texture_coordinates.is_empty());
    assert!(mesh.notes[0].starts_with("image 0 cannot be read: "), "{:?}", mesh.notes);
}

#[test]
fn media_become_coefficients_per_millimetre() {
    let volume =
        json!({ "thicknessFactor": 1, "attenuationColor": [0.5, 0.1, 1], "attenuationDistance": 0.01 });
    let material = |scattering: Value| {
        let mut extensions = json!({
            "KHR_materials_volume": volume, "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_ior": { "ior": 1.33 },
        });
        extensions.as_object_mut().unwrap().extend(scattering.as_object().unwrap().clone());
        let (written, bytes) = decorated(json!({ "extensions": extensions }));
        let mesh = read_document(&written, &bytes).unwrap();
        (mesh.materials[0].subsurface, mesh.notes)
    };
    let (clear, notes) = material(json!({}));
    let clear = clear.unwrap();
    // -ln(c) per 10 mm.
    let sigma_t = Vec3::new(2.0_f32.ln(), 10.0_f32.ln(), 0.0) / 10.0;
    assert!(clear.sigma_a.abs_diff_eq(sigma_t, 1e-6) && clear.sigma_s == Vec3::ZERO, "{clear:?}");
    assert!((clear.eta - 1.33).abs() < 1e-6 && notes[0].starts_with("a clear medium"), "{notes:?}");
    for name in ["KHR_materials_volume_scatter", "KHR_materials_scatter"] {
        let scattering =
            json!({ name: { "multiscatterColor": [0.527_119_87, 1, 0], "scatterAnisotropy": 0 } });
        let (medium, notes) = material(scattering);
        let medium = medium.unwrap();
        assert!(notes.is_empty(), "{notes:?}");
        assert!((medium.sigma_s.x / sigma_t.x - 0.924_191_5).abs() < 1e-4, "{medium:?}");
        assert!((medium.sigma_s.y - sigma_t.y).abs() < 1e-5 && medium.sigma_s.z == 0.0);
        assert!((medium.sigma_a + medium.sigma_s).abs_diff_eq(sigma_t, 1e-6));
    }
    let scattering = json!({ "KHR_materials_volume_scatter": { "scatterAlbedo": [0.8, 0.8, 0.8], "scatterAnisotropy": 0.8 } });
    let medium = material(scattering).0.unwrap();
    // By the similarity relation, what is scattered forwards counts less.
    let (one_way, forwards) = (
        material(json!({ "KHR_materials_scatter": { "multiscatterColor": [0.8, 0.8, 0.8] } })).0.unwrap(),
        medium,
    );
    let reduced = |sigma_a: f32, sigma_s: f32, g: f32| sigma_s * (1.0 - g) / (sigma_a + sigma_s * (1.0 - g));
    let (a, b) = (
        reduced(one_way.sigma_a.x, one_way.sigma_s.x, 0.0),
        reduced(forwards.sigma_a.x, forwards.sigma_s.x, 0.8),
    );
    assert!((a - b).abs() < 1e-4 && forwards.g == 0.8, "{a} {b}");
}

#[test]
fn what_cannot_be_read_is_refused_by_name() {
    let bytes = triangle();
    let mut written = document(bytes.len());
    written["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(
        message(&written, &bytes)
            .starts_with("a.glb: its meshes are compressed (KHR_draco_mesh_compression); export")
    );
    written["extensionsRequired"] = json!(["VENDOR_curves"]);
    assert!(
        message(&written, &bytes)
            .starts_with("a.glb: it requires the extension VENDOR_curves; export it without")
    );
    written["extensionsRequired"] = json!([]);
    written["meshes"][0]["primitives"][0]["extensions"] =
        json!({ "KHR_draco_mesh_compression": { "bufferView": 0 } });
    assert_eq!(read_document(&written, &bytes).unwrap().triangles.len(), 1);
    written["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    assert!(
        message(&written, &bytes)
            .contains("it is compressed (KHR_draco_mesh_compression), which is not read")
    );
    let mut written = document(bytes.len());
    for (place, value, expected) in [
        ("/accessors/0/count", json!(4), "4 values of 12 bytes, 12 apart, at 0 of buffer view 0 of 36 bytes"),
        ("/accessors/0/type", json!("VEC2"), "accessor 0 of FLOAT VEC2 is of the wrong type"),
        ("/accessors/1/componentType", json!(5126), "accessor 1 of FLOAT SCALAR is of the wrong type"),
        ("/accessors/0/byteOffset", json!(u64::MAX), "of buffer view 0 of 36 bytes"),
        (
            "/bufferViews/1/byteOffset",
            json!(40),
            "buffer view 1 of 6 bytes at 40 ends outside of its buffer of 42",
        ),
        ("/bufferViews/0/buffer", json!(3), "there is no buffer 3"),
        ("/buffers/0/byteLength", json!(43), "buffer 0: 42 bytes; it should have 43: it is cut off"),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(9), "there is no accessor 9"),
        ("/meshes/0/primitives/0/mode", json!(9), "its mode is none that there is"),
    ] {
        let before = written.pointer(place).cloned();
        let (parent, last) = place.rsplit_once('/').unwrap();
        written.pointer_mut(parent).unwrap()[last] = value;
        let text = message(&written, &bytes);
        assert!(text.contains(expected), "{place}: {text}");
        match before {
            Some(before) => *written.pointer_mut(place).unwrap() = before,
            None => drop(written.pointer_mut(parent).unwrap().as_object_mut().unwrap().remove(last)),
        }
    }
    let whole = glb(&written, &bytes);
    let read = |bytes: &[u8]| read(Path::new("a.glb"), bytes, Normals::Auto).unwrap_err().to_string();
    assert!(read(&whole[..whole.len() - 9]).contains("its BIN chunk of 42 bytes is cut off after 33"));
    assert!(read(b"glTF\x01\0\0\0\0\0\0\0").contains("binary glTF of version 1; version 2 is read"));
    assert!(read(b"{ \"asset\": 3 }").contains("a.glb: JSON: "));
}

#[test]
fn what_is_left_out_is_told() {
    let bytes = triangle();
    let mut written = document(bytes.len());
    written["animations"] = json!([{ "channels": [], "samplers": [] }]);
    written["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }]);
    written["skins"] = json!([{ "joints": [0] }]);
    written["nodes"][0]["skin"] = 0.into();
    written["meshes"][0]["primitives"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "attributes": { "POSITION": 0 }, "mode": 0 }));
    written["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0 }]);
    let notes = read_document(&written, &bytes).unwrap().notes;
    let expected = "not used: 1 animation, 1 camera, 1 skin, morph targets, points and skins: meshes are shown as they were modelled";
    assert_eq!(notes, [expected]);
    written["meshes"][0]["primitives"].as_array_mut().unwrap().remove(0);
    assert!(message(&written, &bytes).starts_with("a.glb: no triangles: found 1 mesh, not used: "));
}
