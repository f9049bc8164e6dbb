//! Meshes in the colours of their files, meshes that many entities have, and sizes that fit.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use support::{Studio, difference, middle};
use tyndall_needs::needs;

/// A light along the view, and a camera that sees 2 x 2 units.
const STAGE: &str = "\"eye\": ( ViewCamera: (eye: (0.0, 0.0, 5.0), projection: Orthographic(height: 2.0)) ),
    \"sun\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0), irradiance: (3.1415927, 3.1415927, 3.1415927)) ),";

fn scene(entities: &str) -> String {
    format!("(entities: {{ {STAGE} {entities} }})")
}

/// A square of 2 x 2 units with a picture of 2 x 2 texels, white at the lower left: red, green; white, blue.
fn square(studio: &Studio) {
    let rows: [[u8; 3]; 4] = [[255, 0, 0], [0, 255, 0], [255, 255, 255], [0, 0, 255]];
    let picture = image::RgbImage::from_raw(2, 2, rows.concat()).unwrap();
    let path = studio.file("picture.png", b"");
    picture.save(path).unwrap();
    studio.file("square.mtl", b"newmtl painted\nKd 1 1 1\nmap_Kd picture.png\nnewmtl plain\nKd 0.5 0.25 0\n");
    let head = "mtllib square.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    studio.file("square.obj", format!("{head}usemtl painted\nf 1/1 2/2 3/3 4/4\n").as_bytes());
    studio.file("plain.obj", format!("{head}usemtl plain\nf 1 2 3 4\n").as_bytes());
    let coloured = "v -1 -1 0 1 0 0\nv 1 -1 0 1 0 0\nv 1 1 0 1 0 0\nv -1 1 0 1 0 0\nf 1 2 3 4\n";
    studio.file("coloured.obj", coloured.as_bytes());
}

/// The pixel at a place of a picture of 40 x 40, 0 to 1 from the lower left.
fn at(pixels: &[[f32; 3]], x: f32, y: f32) -> [f32; 3] {
    pixels[(39 - (y * 39.0) as usize) * 40 + (x * 39.0) as usize]
}

fn is_near(found: [f32; 3], expected: [f32; 3]) -> bool {
    found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 2e-3)
}

#[needs(gpu)]
#[test]
fn pictures_lie_as_the_coordinates_say_and_repeat_beyond_them() {
    let mut studio = Studio::new();
    square(&studio);
    let pixels = studio.radiance(&scene("\"s\": ( Mesh: File(\"square.obj\") )"), 40, 40);
    // In the middle of each texel its colour is alone; the light's irradiance is pi, so radiance is albedo.
    for (place, colour) in [
        ((0.25, 0.25), [1.0, 1.0, 1.0]),
        ((0.75, 0.25), [0.0, 0.0, 1.0]),
        ((0.25, 0.75), [1.0, 0.0, 0.0]),
        ((0.75, 0.75), [0.0, 1.0, 0.0]),
    ] {
        let found = at(&pixels, place.0, place.1);
        let differs = found.iter().zip(colour).map(|(a, b): (&f32, f32)| (a - b).abs()).fold(0.0, f32::max);
        assert!(differs < 0.1, "{place:?}: {found:?}");
    }
}

#[needs(gpu)]
#[test]
fn materials_hold_unless_the_scene_says_otherwise() {
    let mut studio = Studio::new();
    square(&studio);
    let mut seen = |entity: &str| middle(&studio.radiance(&scene(&format!("\"s\": ( {entity} )")), 41, 41));
    assert!(is_near(seen("Mesh: File(\"plain.obj\")"), [0.5, 0.25, 0.0]));
    assert!(is_near(seen("Mesh: File(\"plain.obj\"), Phong: (diffuse: (0.5, 1.0, 1.0))"), [0.25, 0.25, 0.0]));
    assert!(is_near(seen("Mesh: File(path: \"plain.obj\", materials: false)"), [0.8; 3]));
    assert!(is_near(
        seen("Mesh: File(\"coloured.obj\"), Phong: (diffuse: (0.5, 0.5, 0.5))"),
        [0.5, 0.0, 0.0]
    ));
}

#[needs(gpu)]
#[test]
fn what_leaves_a_translucent_mesh_is_multiplied_by_its_colours() {
    let mut studio = Studio::new();
    let faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let corners = ["1 0 0", "-1 1 0", "-1 -1 1", "-1 -1 -1"];
    let body = |colour: &str| {
        let vertices: String = corners.iter().map(|corner| format!("v {corner}{colour}\n")).collect();
        format!("{vertices}{faces}")
    };
    studio.file("white.obj", body("").as_bytes());
    studio.file("half.obj", body(" 0.5 0.5 0.5").as_bytes());
    let mut seen = |name: &str| {
        let entity =
            format!("\"s\": ( Mesh: File(\"{name}.obj\"), Transform: (scale: 5.0), Subsurface: () )");
        studio.radiance(&scene(&entity), 41, 41)
    };
    let (white, half) = (seen("white"), seen("half"));
    // The file's colours are encoded as sRGB has it.
    let factor = ((0.5_f32 + 0.055) / 1.055).powf(2.4);
    let linear = middle(&half)[0] / middle(&white)[0];
    assert!(middle(&white)[0] > 0.01, "{:?}", middle(&white));
    assert!((linear - factor).abs() < 1e-3 || (linear - 0.5).abs() < 1e-3, "{linear}");
    let scaled: Vec<[f32; 3]> = white.iter().map(|pixel| pixel.map(|value| value * linear)).collect();
    assert!(difference(&scaled, &half) < 1e-4);
}

#[needs(gpu)]
#[test]
fn equal_meshes_and_volumes_are_uploaded_once() {
    let mut studio = Studio::new();
    studio.volume("v.raw", [4, 4, 4], |[x, ..]| x as f32);
    let sphere = |index: usize, radius: &str| {
        format!(
            "\"s{index}\": ( Mesh: Sphere(radius: {radius}, subdivisions: 1), Transform: (translation: ({}.0, 0.0, 0.0)) ),",
            index * 3
        )
    };
    let spheres: String = (0..50).map(|index| sphere(index, "1.0")).collect();
    let other = sphere(50, "0.5");
    let volume = |index: usize| {
        format!(
            "\"v{index}\": ( Volume: Raw(path: \"v.raw\", size: (4, 4, 4), format: F32), Transform: (translation: (0.0, {}.0, 0.0)) ),",
            index * 9
        )
    };
    let volumes: String = (0..3).map(volume).collect();
    let many = studio.radiance(&scene(&format!("{spheres}{other}{volumes}")), 40, 40);
    assert_eq!(studio.report().passes["upload_meshes"].work["triangles"], 160);
    assert_eq!(studio.report().passes["upload_volumes"].work["voxels"], 64);
    let drawn = studio.report().passes["surface"].work["triangles"];
    assert_eq!(drawn, 51 * 80);
    assert!(many.iter().any(|pixel| pixel[0] > 0.1));
}

#[needs(gpu)]
#[test]
fn a_mesh_that_is_a_volume_now_is_seen_no_more() {
    let mut studio = Studio::new();
    studio.volume("v.raw", [4, 4, 4], |_| 1.0);
    assert!(middle(&studio.radiance(&scene("\"a\": ( Mesh: Sphere() )"), 41, 41))[0] > 0.1);
    let clear = "Volume: Raw(path: \"v.raw\", size: (4, 4, 4), format: F32), TransferFunction: (domain: (0.0, 2.0), points: [(0.0, (1.0, 1.0, 1.0), 0.0)])";
    assert_eq!(middle(&studio.radiance(&scene(&format!("\"a\": ( {clear} )")), 41, 41)), [0.0; 3]);
}

#[needs(gpu)]
#[test]
fn what_is_to_fit_measures_what_it_is_to() {
    let mut studio = Studio::new();
    // Ten millimetres a unit: 15 of them are 1.5 of the 2 units that are seen.
    let head = "(millimetres_per_unit: 10.0, entities: {";
    studio.volume("v.raw", [8, 4, 2], |_| 1.0);
    for shape in [
        "Mesh: Box(size: (400.0, 100.0, 1.0))",
        "Volume: Raw(path: \"v.raw\", size: (8, 4, 2), format: F32, spacing: (0.3, 0.3, 0.3)), TransferFunction: (domain: (0.0, 2.0), points: [(0.0, (1.0, 1.0, 1.0), 1.0)])",
    ] {
        let text = format!("{head} {STAGE} \"b\": ( {shape}, Transform: (fit: 15.0) ) }})");
        let pixels = studio.radiance(&text, 40, 40);
        let across = (0..40).filter(|x| pixels[20 * 40 + x][0] > 0.01).count();
        assert!((29..=31).contains(&across), "{shape}: {across} of 40 pixels");
    }
}
