//! Media, scales, lights and meshes far from anything that is: every pixel is a number, and none is below 0.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;
#[path = "support/translucent.rs"]
mod translucent;

use std::path::Path;
use support::Studio;
use translucent::grey;
use tyndall::{Picture, render};
use tyndall_needs::needs;

const MODELS: [&str; 3] = ["CalibratedDipole", "DirectionalDipole", "StandardDipole"];

/// What a picture says that must not.
fn complaint(pixels: &[[f32; 3]]) -> Option<String> {
    let odd = pixels.iter().flatten().filter(|value| !(value.is_finite() && **value >= 0.0)).count();
    (odd > 0).then(|| format!("{odd} of {} values are odd", 3 * pixels.len()))
}

/// Draws all scenes in one studio and lists those that show odd pixels, or nothing where there should be something.
fn check(scenes: &[(String, String, bool)]) {
    let mut studio = Studio::new();
    let mut complaints = Vec::new();
    for (name, scene, shows) in scenes {
        let pixels = studio.radiance(scene, 24, 16);
        let dark = *shows && pixels.iter().flatten().all(|value| *value == 0.0);
        let dark = dark.then(|| "nothing is to be seen".to_owned());
        complaints.extend(complaint(&pixels).or(dark).map(|complaint| format!("{name}: {complaint}")));
    }
    assert!(complaints.is_empty(), "{} of {}:\n{}", complaints.len(), scenes.len(), complaints.join("\n"));
}

const LIGHT: &str = "\"sun\": ( DirectionalLight: (direction: (-0.5, -0.6, -0.7)) ),";

fn sphere(material: &str, model: &str) -> String {
    format!(
        "(entities: {{ {LIGHT} \"ball\": ( Mesh: Sphere(subdivisions: 2), Subsurface: (material: {material}, model: {model}, specular: Some(())) ) }})"
    )
}

#[needs(gpu)]
#[test]
fn any_medium_gives_numbers() {
    let mut scenes = Vec::new();
    let coefficients = [0.0, 1e-6, 1e-3, 1.0, 1e3, 1e6];
    for (i, sigma_a) in coefficients.into_iter().enumerate() {
        for (j, sigma_s) in coefficients.into_iter().enumerate() {
            for (k, g) in [-1.0, -0.999, 0.0, 0.999, 1.0].into_iter().enumerate() {
                // Every combination of three with four indices would be too many: each meets all others sometime.
                let eta = [0.5, 1.0, 1.3, 3.0][(i + 2 * j + k) % 4];
                let model = MODELS[(i + j + k) % 3];
                let name = format!("{model} sigma_a {sigma_a} sigma_s {sigma_s} g {g} eta {eta}");
                scenes.push((name, sphere(&grey(sigma_a, sigma_s, g, eta), model), false));
            }
        }
    }
    assert!(scenes.len() >= 100);
    check(&scenes);
}

#[needs(gpu)]
#[test]
fn any_index_of_refraction_gives_light() {
    let mut scenes = Vec::new();
    for eta in [0.5, 0.75, 0.999_999, 1.0, 1.000_001, 1.01, 1.33, 2.0, 2.5, 2.9, 3.0] {
        for model in MODELS {
            scenes.push((format!("{model} eta {eta}"), sphere(&grey(0.1, 3.0, 0.5, eta), model), true));
        }
    }
    check(&scenes);
}

#[needs(gpu)]
#[test]
fn any_scale_gives_light() {
    let mut scenes = Vec::new();
    for scale in [1e-6, 1e-3, 1e3, 1e6] {
        for unit in [1e-9, 1e-3, 1.0, 1e9] {
            // Of the same medium in units of the mesh, so that there is something to be seen.
            let length = scale * unit;
            let scene = format!(
                "(millimetres_per_unit: {unit:?}, entities: {{ {LIGHT} \"ball\": ( Mesh: Sphere(subdivisions: 2), Transform: (scale: {scale:?}),
                    Subsurface: (material: {}) ) }})",
                grey((0.1f64 / length).min(1e12), (10.0f64 / length).min(1e12), 0.0, 1.3)
            );
            scenes.push((format!("scale {scale} unit {unit}"), scene, true));
        }
    }
    for scale in ["(1.0, 1e-4, 1.0)", "(1e4, 1.0, 1e-3)", "(-1.0, 1.0, 1.0)", "(-2.0, -1.0, -1.0)"] {
        let scene = format!(
            "(entities: {{ {LIGHT} \"ball\": ( Mesh: Sphere(subdivisions: 2), Transform: (scale: {scale}), Subsurface: () ) }})"
        );
        scenes.push((format!("scale {scale}"), scene, false));
    }
    check(&scenes);
}

#[needs(gpu)]
#[test]
fn light_from_anywhere_gives_numbers() {
    let mut scenes = Vec::new();
    let directions = [
        "(1.0, 0.0, 0.0)",
        "(1.0, -1e-7, 0.0)",
        "(1.0, 1e-7, 0.0)",
        "(1.0, -1e-3, 0.0)",
        "(1.0, -0.02, 0.3)",
        "(0.0, 1.0, 0.0)",
        "(0.3, 0.7, 0.1)",
        "(0.0, -1.0, 0.0)",
        "(0.0, -1e-30, 0.0)",
        "(0.0, -1e30, 0.0)",
        "(1e-20, -1.0, 0.0)",
    ];
    let shapes = ["Plane(size: (2.0, 2.0))", "Box()", "Sphere(subdivisions: 1)", "CornellBox"];
    for direction in directions {
        for (i, shape) in shapes.into_iter().enumerate() {
            let model = MODELS[i % 3];
            let eta = [1.3, 1.0, 0.7][i % 3];
            let scene = format!(
                "(entities: {{ \"eye\": ( ViewCamera: (eye: (1.0, 2.0, 3.0)) ),
                    \"sun\": ( DirectionalLight: (direction: {direction}) ),
                    \"body\": ( Mesh: {shape}, Subsurface: (material: {}, model: {model}) ) }})",
                grey(0.2, 5.0, 0.0, eta)
            );
            scenes.push((format!("{shape} {model} light along {direction}"), scene, false));
        }
    }
    // No light at all, and a body that fills the view.
    scenes.push(("no light".into(), sphere("Preset(\"cream\")", MODELS[0]).replace(LIGHT, ""), false));
    let inside = sphere("Preset(\"cream\")", MODELS[0])
        .replace(LIGHT, &format!("{LIGHT} \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 0.5)) ),"));
    scenes.push(("from inside".into(), inside, false));
    check(&scenes);
}

/// Meshes as OBJ that are open, cut through themselves, or have triangles of no area.
const ODD: [(&str, &str); 7] = [
    ("one triangle", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("two that cross", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 -1 -1\nv 0 -1 1\nv 0 1 0.2\nf 1 2 3\nf 4 5 6\n"),
    ("the same twice, turned", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n"),
    ("one without area beside another", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n"),
    ("a needle", "v 0 0 0\nv 1e6 0 0\nv 0 1e-6 0\nf 1 2 3\n"),
    ("normals askew", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 0\nvn 1 0 0\nvn 0 0 -1\nf 1//1 2//2 3//3\n"),
    (
        "an open box",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 1 2 3 4\nf 1 2 6 5\nf 4 3 7 8\nf 1 4 8 5\n",
    ),
];

#[needs(gpu)]
#[test]
fn any_mesh_gives_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let mut scenes = Vec::new();
    for (i, (name, text)) in ODD.into_iter().enumerate() {
        let path = folder.path().join(format!("{i}.obj"));
        std::fs::write(&path, text).unwrap();
        for model in MODELS {
            let scene = sphere(&grey(0.3, 4.0, 0.3, 1.3), model)
                .replace("Sphere(subdivisions: 2)", &format!("File({path:?})"));
            scenes.push((format!("{model} {name}"), scene, false));
        }
    }
    check(&scenes);
}

/// Without any triangle that has an area there is an error that says so, and the program can go on.
#[needs(gpu)]
#[test]
fn an_empty_mesh_is_refused() {
    let mut studio = Studio::new();
    let whole = sphere("Preset(\"cream\")", MODELS[0]);
    let scene = whole.replace("Sphere(subdivisions: 2)", "File(\"empty.obj\")");
    for mesh in
        ["", "v 0 0 0\n", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"]
    {
        studio.file("empty.obj", mesh.as_bytes());
        let path = studio.file("scene.ron", scene.as_bytes());
        let document = render::load_scene(&mut studio.app, &path, &[]);
        assert!(render::render(&mut studio.app).is_err());
        let problems = render::problems(studio.app.world(), &document);
        assert!(problems.iter().any(|problem| problem.message.contains("empty.obj")), "{problems:?}");
        assert_eq!(complaint(&studio.radiance(&whole, 24, 16)), None);
    }
}

/// Tries one real file; true if it was refused.
fn try_file(studio: &mut Studio, mesh: &Path) -> bool {
    let scene = sphere("Preset(\"marble\")", MODELS[0])
        .replace("Sphere(subdivisions: 2)", &format!("File({mesh:?})"));
    let path = studio.file("scene.ron", scene.as_bytes());
    let document = render::load_scene(&mut studio.app, &path, &[]);
    assert!(!document.has_errors(), "{:#?}", document.problems);
    studio.app.insert_resource(Picture { size: glam::UVec2::new(24, 16), camera: None, encoded: false });
    match render::render(&mut studio.app) {
        Ok(render::Image { pixels: render::Pixels::Radiance(pixels), .. }) => {
            assert_eq!(complaint(&pixels), None, "{mesh:?}");
            false
        }
        Ok(_) => unreachable!("radiance was asked for"),
        Err(error) => {
            let problems = render::problems(studio.app.world(), &document);
            assert!(!problems.is_empty(), "{mesh:?}: {error}");
            true
        }
    }
}

#[needs(gpu, data)]
#[test]
fn the_odd_files_give_numbers_or_reasons() {
    let folder = Path::new(&std::env::var("TYNDALL_DATA").unwrap()).join("meshes/odd");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() >= 30);
    let mut studio = Studio::new();
    let refused = files.iter().filter(|file| try_file(&mut studio, file)).count();
    assert!((5..files.len() / 2).contains(&refused), "{refused} of {} refused", files.len());
}

/// Triangles narrower than the grid that rasterisers count in, with few samples at each of their corners.
#[needs(gpu)]
#[test]
fn no_light_is_negative_on_triangles_narrower_than_pixels() {
    let mut studio = Studio::new();
    let scene = "(entities: { \"sun\": ( DirectionalLight: (direction: (1.0, -1.0, -3.0), irradiance: (3.0, 3.0, 3.0)) ),
        \"m\": ( Mesh: Sphere(subdivisions: 8), Subsurface: (), ScatteringMaps: (samples: 1) ) })";
    let pixels = studio.radiance(scene, 32, 32);
    assert_eq!(complaint(&pixels), None);
    assert!(pixels.iter().any(|pixel| pixel[0] > 0.1));
}

/// Adapters that end long loops without a word must not show: as many candidates as can be written give the light that fewer give.
#[needs(gpu)]
#[test]
fn as_many_candidates_as_can_be_written_give_the_same_light() {
    let mut studio = Studio::new();
    let mut mean = |candidates: u32| {
        let scene = format!(
            "(entities: {{ \"sun\": ( DirectionalLight: (direction: (1.0, -1.0, -3.0), irradiance: (3.0, 3.0, 3.0)) ),
                \"m\": ( Mesh: Sphere(subdivisions: 3), Subsurface: (),
                    ScatteringMaps: (strategy: Uniform, cameras: 2, samples: 512, candidates: {candidates}, resolution: Texels(16, 16)) ) }})"
        );
        let pixels = studio.radiance(&scene, 32, 32);
        assert_eq!(complaint(&pixels), None);
        pixels.iter().flatten().sum::<f32>() / (3 * pixels.len()) as f32
    };
    let (some, all) = (mean(2500), mean(4096));
    assert!(some > 0.05 && (all / some - 1.0).abs() < 0.05, "{all} with 4096 candidates, {some} with 2500");
}
