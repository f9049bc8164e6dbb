//! Edits of scenes with translucent meshes: what reruns, what stays, and that nothing of the former scene is left.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;
#[path = "support/translucent.rs"]
mod translucent;

use support::{Studio, difference};
use translucent::{Pixels, grey, mean, sun};
use tyndall::Refinement;
use tyndall_needs::needs;

/// What came of the passes of translucent meshes so far, in the order of [`PASSES`].
const PASSES: [&str; 4] = ["surface_points", "light_gbuffer", "scattered_radiosity", "combine"];

fn runs(studio: &Studio) -> [u64; 4] {
    PASSES.map(|pass| studio.report().passes.get(pass).map_or(0, |record| record.runs))
}

fn added(before: [u64; 4], after: [u64; 4]) -> [u64; 4] {
    std::array::from_fn(|i| after[i] - before[i])
}

/// A medium of mean free path 0.1 mm in which light dies out over 0.2 mm.
fn medium() -> String {
    grey(0.9, 9.1, 0.0, 1.3)
}

const MAPS: &str = "ScatteringMaps: (progressive: false)";

#[needs(gpu)]
#[test]
fn meshes_beside_the_light_and_behind_the_body_change_nothing() {
    let mut studio = Studio::new();
    let scene = |more: &str| {
        format!(
            "(entities: {{ \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 4.0), projection: Orthographic(height: 2.0)) ),
                {} \"ball\": ( Mesh: Sphere(subdivisions: 3), Subsurface: (material: {}), {MAPS} ), {more} }})",
            sun(30.0),
            medium()
        )
    };
    let alone = studio.radiance(&scene(""), 32, 32);
    let before = runs(&studio);
    assert!(before.iter().all(|runs| *runs == 1), "{before:?}");
    let other = |x: f64, y: f64| {
        scene(&format!("\"other\": ( Mesh: Box(), Transform: (translation: ({x:?}, {y:?}, 0.0)) )"))
    };
    // The light comes from -x and above.
    for (x, y) in [(4.0, 1.0), (3.0, -5.2)] {
        let with = studio.radiance(&other(x, y), 32, 32);
        assert_eq!(difference(&alone, &with), 0.0, "at {x} {y}");
        assert_eq!(runs(&studio), before, "at {x} {y}");
    }
    // In its way it counts.
    let shadowed = studio.radiance(&other(-2.0, 3.46), 32, 32);
    assert!(mean(&shadowed)[0] < 0.8 * mean(&alone)[0]);
    assert_eq!(added(before, runs(&studio)), [0, 1, 1, 1]);
    // Out of it again everything is as it was.
    let again = studio.radiance(&scene(""), 32, 32);
    assert_eq!(difference(&alone, &again), 0.0);
}

#[needs(gpu)]
#[test]
fn an_edit_reruns_what_depends_on_it_and_nothing_else() {
    let mut studio = Studio::new();
    let scene = "(entities: {
        \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 4.0), projection: Perspective(vertical_fov: 40.0)) ),
        \"a\": ( DirectionalLight: (direction: (0.0, -1.0, -1.0), irradiance: (1.0, 2.0, 3.0)) ),
        \"b\": ( DirectionalLight: (direction: (1.0, 0.0, -1.0)) ),
        \"ball\": ( Mesh: Sphere(subdivisions: 3), Subsurface: (material: Preset(\"skin1\")), ScatteringMaps: (progressive: false) ),
        \"other\": ( Transform: (translation: (-3.0, -4.0, 1.0)), Mesh: Sphere(radius: 0.3, subdivisions: 1) ) })";
    studio.radiance(scene, 24, 24);
    let first = runs(&studio);
    assert_eq!(first, [1, 2, 2, 1]);
    assert!(studio.report().gpu_bytes.contains_key("light_gbuffer"));
    let mut step = |what: &str, edits: &[(&str, &str)], expected: [u64; 4]| {
        studio.radiance(scene, 24, 24);
        let before = runs(&studio);
        let mut edited = scene.to_owned();
        for (from, to) in edits {
            assert!(edited.contains(from), "{from}");
            edited = edited.replace(from, to);
        }
        studio.radiance(&edited, 24, 24);
        assert_eq!(added(before, runs(&studio)), expected, "{what}");
    };
    step("drawing again", &[], [0, 0, 0, 0]);
    step("a step of the camera", &[("eye: (0.0, 0.0, 4.0)", "eye: (0.1, 0.05, 3.9)")], [0, 0, 0, 0]);
    step("the exposure", &[("vertical_fov: 40.0)", "vertical_fov: 40.0), exposure: 2.0")], [0, 0, 0, 0]);
    step("a light's colour", &[("(1.0, 2.0, 3.0)", "(2.0, 2.0, 1.0)")], [0, 0, 0, 1]);
    step("a light's direction", &[("(1.0, 0.0, -1.0)", "(1.0, 0.5, -1.0)")], [0, 1, 1, 1]);
    step("a direction's length", &[("(1.0, 0.0, -1.0)", "(2.0, 0.0, -2.0)")], [0, 0, 0, 0]);
    step("the model", &[("Preset(\"skin1\")", "Preset(\"skin1\"), model: StandardDipole")], [0, 0, 2, 1]);
    step("the highlight", &[("Preset(\"skin1\")", "Preset(\"skin1\"), specular: Some(())")], [0, 0, 0, 0]);
    step(
        "the local look",
        &[("Preset(\"skin1\")", "Preset(\"skin1\"), local: (shininess: 2.0)")],
        [0, 0, 0, 0],
    );
    step("samples", &[("progressive: false", "progressive: false, samples: 20")], [0, 0, 2, 1]);
    step("a mesh out of the way", &[("(-3.0, -4.0, 1.0)", "(-3.0, -4.0, 0.5)")], [0, 0, 0, 0]);
    step(
        "its look",
        &[("subdivisions: 1)", "subdivisions: 1), Phong: (diffuse: (1.0, 0.0, 0.0))")],
        [0, 0, 0, 0],
    );
}

/// A material of the same mean free path changes nothing but how light spreads; the points of the surface stay.
#[needs(gpu)]
#[test]
fn another_material_scatters_anew() {
    let mut studio = Studio::new();
    let scene = |sigma_a: f64| {
        format!(
            "(entities: {{ {} \"ball\": ( Mesh: Sphere(subdivisions: 3), Subsurface: (material: {}), {MAPS} ) }})",
            sun(20.0),
            grey(sigma_a, 10.0 - sigma_a, 0.0, 1.4)
        )
    };
    let dark = studio.radiance(&scene(5.0), 24, 24);
    let before = runs(&studio);
    let bright = studio.radiance(&scene(0.1), 24, 24);
    assert_eq!(added(before, runs(&studio)), [0, 0, 1, 1]);
    assert!(mean(&bright)[0] > 2.0 * mean(&dark)[0]);
}

#[needs(gpu)]
#[test]
fn what_leaves_the_scene_leaves_the_gpu() {
    let mut studio = Studio::new();
    let scene = |what: &str| {
        format!("(entities: {{ {} \"ball\": ( Mesh: Sphere(subdivisions: 3), {what} ) }})", sun(0.0))
    };
    let names = |studio: &Studio| studio.report().gpu_bytes.keys().copied().collect::<Vec<_>>();
    studio.radiance(&scene(""), 8, 8);
    let opaque = (names(&studio), studio.report().pipelines.clone());
    assert_eq!(opaque, (vec!["meshes", "surface"], vec!["surface"]));
    studio.radiance(&scene("Subsurface: ()"), 8, 8);
    assert!(names(&studio).len() > 4, "{:?}", names(&studio));
    studio.radiance(&scene(""), 8, 8);
    assert_eq!(names(&studio), opaque.0);
}

/// Whatever was in the scene before, the picture is that of a program that starts with it.
#[needs(gpu)]
#[test]
fn a_picture_does_not_depend_on_the_scenes_before_it() {
    let lamp = |name: &str, direction: &str| {
        format!("{name:?}: ( DirectionalLight: (direction: {direction}, irradiance: (1.0, 2.0, 0.5)) ),")
    };
    let (a, b) = (lamp("a", "(0.2, -1.0, -1.0)"), lamp("b", "(1.0, -0.1, -0.3)"));
    let ball = |shape: &str, looks: &str| format!("\"ball\": ( Mesh: {shape}, {looks}, {MAPS} ),");
    let marble = "Subsurface: (material: Preset(\"marble\"))";
    let skin = "Subsurface: (material: Preset(\"skin1\"), model: StandardDipole, specular: Some(()))";
    let (round, square) = ("Sphere(subdivisions: 2)", "Box()");
    let other = "\"other\": ( Mesh: Box(), Transform: (translation: (-0.3, 1.5, 1.5), scale: 0.4), Subsurface: (material: Preset(\"ketchup\")), ScatteringMaps: (progressive: false) ),";
    let states: Vec<String> = [
        (String::new(), [a.clone(), ball(round, marble)].concat()),
        (String::new(), [a.clone(), b.clone(), ball(round, marble)].concat()),
        (String::new(), [b.clone(), ball(round, marble)].concat()),
        (String::new(), ball(round, marble)),
        (String::new(), [a.clone(), b.clone(), ball(square, skin)].concat()),
        (String::new(), [a.clone(), lamp("b", "(-1.0, -0.1, -0.3)"), ball(round, skin)].concat()),
        (String::new(), [a.clone(), ball(round, "Phong: ()")].concat()),
        ("shading: Local,".into(), [a.clone(), ball(round, marble)].concat()),
        (String::new(), [a.clone(), b.clone(), ball(round, marble), other.into()].concat()),
        (String::new(), [a.clone(), b].concat()),
        (
            String::new(),
            [a.clone(), ball(round, &format!("{marble}, Transform: (scale: (1.0, 0.5, 0.7))"))].concat(),
        ),
        ("millimetres_per_unit: 30.0,".into(), [a, ball(round, marble), other.into()].concat()),
    ]
    .into_iter()
    .map(|(head, entities)| {
        let eye = "\"eye\": ( ViewCamera: (eye: (0.0, 1.0, 4.0)) ),";
        format!("({head} entities: {{ {eye} {entities} }})")
    })
    .collect();
    let fresh: Vec<Pixels> = states.iter().map(|state| Studio::new().radiance(state, 16, 16)).collect();
    // The last two ask for finer points of the surface, which then stay, so what comes after them is another estimate of the same.
    for (count, exact) in [(states.len() - 2, true), (states.len(), false)] {
        let mut studio = Studio::new();
        let (mut at, mut changes) = (0, Vec::new());
        for step in 0..60 {
            // Steps of different lengths, each state after most others sometime.
            let from = at;
            at = (at + 1 + (step * step + step / 7) % (count - 1)) % count;
            let pixels = studio.radiance(&states[at], 16, 16);
            let off = difference(&pixels, &fresh[at]);
            let share = mean(&pixels)[0] / mean(&fresh[at])[0].max(1e-9);
            if off > 1e-6 && (exact || (share - 1.0).abs() > 0.02) {
                changes.push(format!("state {at} after {from}: off by {off}, {share} times as bright"));
            }
        }
        assert!(changes.is_empty(), "{}", changes.join("\n"));
    }
}

/// While a picture is to follow a hand, light that is to be found anew is found coarsely; what is there in full stays, and is what there is
/// again afterwards.
#[needs(gpu)]
#[test]
fn coarse_light_is_for_the_moment() {
    let mut studio = Studio::new();
    let scene = |degrees: f64| {
        format!(
            "(entities: {{ {} \"ball\": ( Mesh: Sphere(subdivisions: 3), Subsurface: (material: {}), {MAPS} ) }})",
            sun(degrees),
            medium()
        )
    };
    let full = studio.radiance(&scene(20.0), 24, 24);
    let before = runs(&studio);
    let coarse = tyndall::Coarseness { light: 0.35, ..Default::default() };
    studio.app.insert_resource(coarse);
    assert_eq!(difference(&full, &studio.radiance(&scene(20.0), 24, 24)), 0.0);
    assert_eq!(runs(&studio), before);
    let moved = studio.radiance(&scene(40.0), 24, 24);
    assert_eq!(added(before, runs(&studio)), [0, 1, 1, 1]);
    studio.radiance(&scene(40.0), 24, 24);
    assert_eq!(added(before, runs(&studio)), [0, 1, 1, 1]);
    studio.app.insert_resource(tyndall::Coarseness::default());
    let settled = studio.radiance(&scene(40.0), 24, 24);
    assert_eq!(added(before, runs(&studio)), [0, 2, 2, 2]);
    assert_eq!(difference(&settled, &Studio::new().radiance(&scene(40.0), 24, 24)), 0.0);
    // Near enough for the moment: noisier, and as bright.
    let brightness = mean(&moved)[0] / mean(&settled)[0];
    assert!((brightness - 1.0).abs() < 0.05, "{brightness}");
}

#[needs(gpu)]
#[test]
fn one_that_no_longer_averages_shows_its_first_samples_again() {
    let mut studio = Studio::new();
    let scene = |progressive: bool| {
        format!(
            "(entities: {{ {} \"ball\": ( Mesh: Sphere(subdivisions: 2), Subsurface: (), ScatteringMaps: (samples: 4, progressive: {progressive}) ) }})",
            sun(20.0)
        )
    };
    let first = studio.radiance(&scene(false), 16, 16);
    let before = runs(&studio);
    assert_eq!(difference(&first, &studio.radiance(&scene(true), 16, 16)), 0.0);
    assert_eq!(runs(&studio), before);
    studio.app.world_mut().insert_resource(Refinement { sets: 3, per_update: 4 });
    assert!(difference(&first, &studio.radiance(&scene(true), 16, 16)) > 0.0);
    assert_eq!(added(before, runs(&studio)), [0, 0, 2, 1]);
    assert_eq!(difference(&first, &studio.radiance(&scene(false), 16, 16)), 0.0);
}
