//! Edits of scenes whose volumes scatter light: what reruns, what stays, and that nothing of the former scene is left.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use support::{Studio, difference};
use tyndall_needs::needs;

/// In the order of [`Runs`].
const PASSES: [&str; 5] = ["classify", "light_volume", "light_cells", "scattered_light", "summed_light"];

/// How often those passes ran.
type Runs = [u64; 5];

fn runs(studio: &Studio) -> Runs {
    PASSES.map(|pass| studio.report().passes.get(pass).map_or(0, |record| record.runs))
}

fn added(before: Runs, after: Runs) -> Runs {
    std::array::from_fn(|pass| after[pass] - before[pass])
}

/// A volume in two lights, the first of which goes along its z and so comes in at one face of a cell, the second at three; and a mesh beside.
const SCENE: &str = "(background: (0.0, 0.0, 0.1), entities: {
    \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 40.0), projection: Perspective(vertical_fov: 40.0)) ),
    \"a\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0), irradiance: (1.0, 2.0, 3.0)) ),
    \"b\": ( DirectionalLight: (direction: (1.0, 0.5, -1.0)) ),
    \"v\": (
        Transform: (translation: (0.0, 0.0, 0.0)),
        Volume: Raw(path: \"v.raw\", size: (16, 16, 16), format: F32),
        TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 0.5, 0.2), 0.0), (1.0, (0.5, 0.9, 0.2), 0.3)]),
        VolumeLighting: LightVolume(),
    ),
    \"m\": ( Transform: (translation: (30.0, 0.0, 0.0)), Mesh: Sphere(radius: 2.0, subdivisions: 1) ) })";

/// A studio with two volumes to show.
fn studio() -> Studio {
    let studio = Studio::new();
    let blob = |[x, y, z]: [usize; 3]| {
        let apart = [x, y, z].map(|cell| (cell as f32 - 7.5).powi(2)).iter().sum::<f32>().sqrt();
        (1.0 - apart / 9.0).max(0.0)
    };
    studio.volume("v.raw", [16; 3], blob);
    studio.volume("w.raw", [16; 3], |at| 0.7 * blob(at));
    studio
}

fn edited(edits: &[(&str, &str)]) -> String {
    edits.iter().fold(SCENE.to_owned(), |scene, (from, to)| {
        assert!(scene.contains(from), "{from}");
        scene.replace(from, to)
    })
}

#[needs(gpu)]
#[test]
fn an_edit_reruns_what_depends_on_it_and_nothing_else() {
    let mut studio = studio();
    studio.radiance(SCENE, 24, 24);
    assert_eq!(runs(&studio), [1, 2, 1, 2, 1]);
    let mut complaints = Vec::new();
    let mut step = |what: &str, edits: &[(&str, &str)], expected: Runs| {
        let first = studio.radiance(SCENE, 24, 24);
        let before = runs(&studio);
        studio.radiance(&edited(edits), 24, 24);
        let seen = added(before, runs(&studio));
        if seen != expected {
            complaints.push(format!("{what}: {seen:?}, expected {expected:?}"));
        }
        // And back: the picture is what it was.
        let again = studio.radiance(SCENE, 24, 24);
        if difference(&first, &again) > 0.0 {
            complaints.push(format!("{what}, and back: off by {}", difference(&first, &again)));
        }
    };
    const LIGHTING: &str = "LightVolume()";
    let nothing = [0, 0, 0, 0, 0];
    step("drawing again", &[], nothing);
    step("a step of the camera", &[("eye: (0.0, 0.0, 40.0)", "eye: (1.0, 0.5, 39.0)")], nothing);
    step("the exposure", &[("vertical_fov: 40.0)", "vertical_fov: 40.0), exposure: 2.0")], nothing);
    step("the background", &[("(0.0, 0.0, 0.1)", "(0.3, 0.0, 0.1)")], nothing);
    step("the step of rays", &[(LIGHTING, "LightVolume(), RayCast: (step: 0.5)")], nothing);
    step("a light's colour", &[("(1.0, 2.0, 3.0)", "(2.0, 2.0, 1.0)")], [0, 0, 0, 0, 1]);
    step("a light's direction", &[("(0.0, 0.0, -1.0)", "(0.0, 0.01, -1.0)")], [0, 1, 0, 1, 1]);
    step("the other light's direction", &[("(1.0, 0.5, -1.0)", "(1.0, 0.6, -1.0)")], [0, 1, 0, 1, 1]);
    step("a direction's length", &[("(0.0, 0.0, -1.0)", "(0.0, 0.0, -2.0)")], nothing);
    step("an opacity", &[("0.3)]", "0.4)]")], [1, 2, 1, 2, 1]);
    step("a colour", &[("(0.5, 0.9, 0.2)", "(0.5, 0.9, 0.9)")], [1, 0, 1, 2, 1]);
    step("the classification", &[("0.3)]", "0.3)], classification: Pre")], [1, 0, 0, 0, 0]);
    step("the data", &[("v.raw", "w.raw")], [1, 2, 1, 2, 1]);
    step("the mean cosine", &[(LIGHTING, "LightVolume(g: 0.3)")], [0, 0, 0, 2, 1]);
    step("the cone", &[(LIGHTING, "LightVolume(cone_angle: 30.0)")], [0, 0, 0, 2, 1]);
    step("the nearest axis alone", &[(LIGHTING, "LightVolume(blend: false)")], [0, 0, 0, 1, 1]);
    // Cells of scattered light are as many: a volume of no more than 16 voxels has one for each.
    step("the resolution", &[(LIGHTING, "LightVolume(resolution: 0.5)")], [0, 2, 0, 2, 1]);
    step("the highlight", &[(LIGHTING, "LightVolume(gradient_specular: 0.5)")], nothing);
    step("emission", &[(LIGHTING, "LightVolume(emission: 0.5)")], nothing);
    step("one technique for the other", &[(LIGHTING, "SingleScattering()")], nothing);
    step(
        "moving the volume",
        &[("(translation: (0.0, 0.0, 0.0))", "(translation: (1.0, 2.0, 0.0))")],
        nothing,
    );
    step(
        "turning the volume",
        &[("(translation: (0.0, 0.0, 0.0))", "(rotation: (0.0, 10.0, 20.0))")],
        [0, 2, 0, 2, 1],
    );
    step("growing the volume", &[("(translation: (0.0, 0.0, 0.0))", "(scale: 2.0)")], [0, 2, 0, 2, 1]);
    step(
        "the unit of the scene",
        &[("(background", "(millimetres_per_unit: 2.0, background")],
        [1, 2, 1, 2, 1],
    );
    // The light `a` comes from +z, `b` from -x and -y.
    step("a mesh beside the light", &[("(30.0, 0.0, 0.0)", "(30.0, 0.0, 1.0)")], nothing);
    step("a mesh behind the volume", &[("(30.0, 0.0, 0.0)", "(0.0, 0.0, -30.0)")], nothing);
    step("a mesh in one light", &[("(30.0, 0.0, 0.0)", "(0.0, 0.0, 30.0)")], [0, 0, 0, 1, 1]);
    step(
        "a mesh in it that counts for nothing",
        &[
            ("(30.0, 0.0, 0.0)", "(0.0, 0.0, 30.0)"),
            ("(background", "(meshes_shade_volumes: false, background"),
        ],
        nothing,
    );
    step(
        "the look of a mesh",
        &[("subdivisions: 1)", "subdivisions: 1), Phong: (diffuse: (1.0, 0.0, 0.0))")],
        nothing,
    );
    step("local shading", &[("(background", "(shading: Local, background")], nothing);
    step(
        "a light less",
        &[("\"b\": ( DirectionalLight: (direction: (1.0, 0.5, -1.0)) ),", "")],
        [0, 0, 0, 0, 1],
    );
    step(
        "another light",
        &[("\"m\":", "\"c\": ( DirectionalLight: (direction: (0.0, 0.0, 1.0)) ), \"m\":")],
        [0, 1, 0, 1, 1],
    );
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[needs(gpu)]
#[test]
fn shadows_of_meshes_are_drawn_when_one_moves_in_a_light() {
    let mut studio = studio();
    let mut drawn = |edits: &[(&str, &str)]| {
        studio.radiance(&edited(edits), 24, 24);
        studio.report().passes.get("volume_shadow").map_or(0, |record| record.runs)
    };
    assert_eq!(drawn(&[]), 0);
    let above = ("(30.0, 0.0, 0.0)", "(0.0, 0.0, 30.0)");
    assert_eq!(drawn(&[above]), 1);
    assert_eq!(drawn(&[above, ("(0.0, 0.0, 40.0)", "(1.0, 0.0, 40.0)")]), 1);
    assert_eq!(drawn(&[above, ("(0.5, 0.9, 0.2), 0.3)", "(0.5, 0.9, 0.2), 0.4)")]), 1);
    assert_eq!(drawn(&[("(30.0, 0.0, 0.0)", "(1.0, 0.0, 30.0)")]), 2);
    assert_eq!(drawn(&[]), 2);
    assert!(!studio.report().gpu_bytes.contains_key("volume_shadow"));
}

/// What the GPU holds of light.
fn light_held(studio: &Studio) -> Vec<(&'static str, u64)> {
    const LIGHT: [&str; 5] =
        ["light_volume", "light_cells", "light_network", "scattered_light", "summed_light"];
    let held = studio.report().gpu_bytes.iter().map(|(name, bytes)| (*name, *bytes));
    held.filter(|(name, _)| LIGHT.contains(name)).collect()
}

#[needs(gpu)]
#[test]
fn what_nobody_asks_for_any_more_leaves_the_gpu() {
    let mut studio = studio();
    let [start, end] = [SCENE.find("\"v\": (").unwrap(), SCENE.find("\"m\":").unwrap()];
    let without_volume = [&SCENE[..start], &SCENE[end..]].concat();
    let volume_gone = SCENE.replace("Volume: Raw(path: \"v.raw\", size: (16, 16, 16), format: F32),", "").replace(
        "TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 0.5, 0.2), 0.0), (1.0, (0.5, 0.9, 0.2), 0.3)]),\n        VolumeLighting: LightVolume(),",
        "",
    );
    assert!(!volume_gone.contains("Volume"));
    let no_lights = edited(&[
        ("\"a\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0), irradiance: (1.0, 2.0, 3.0)) ),", ""),
        ("\"b\": ( DirectionalLight: (direction: (1.0, 0.5, -1.0)) ),", ""),
    ]);
    for (what, scene) in [
        ("emission and absorption", edited(&[("LightVolume()", "EmissionAbsorption")])),
        ("the gradient", edited(&[("LightVolume()", "Gradient()")])),
        ("local shading", edited(&[("(background", "(shading: Local, background")])),
        ("local shading of its own", edited(&[("LightVolume()", "LightVolume(), Shading: Local")])),
        ("no volume", without_volume),
        ("an entity that is no volume any more", volume_gone),
        ("no lights", no_lights),
    ] {
        studio.radiance(SCENE, 24, 24);
        assert_eq!(light_held(&studio).len(), 5, "before {what}: {:?}", light_held(&studio));
        studio.radiance(&scene, 24, 24);
        assert_eq!(light_held(&studio), [], "{what}");
    }
    studio.radiance(SCENE, 24, 24);
    studio.radiance(&edited(&[("LightVolume()", "SingleScattering()")]), 24, 24);
    assert_eq!(light_held(&studio).iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["light_volume"]);
}

#[needs(gpu)]
#[test]
fn volumes_that_do_not_scatter_make_nothing_of_it() {
    for lighting in ["EmissionAbsorption", "Gradient()"] {
        let mut studio = studio();
        studio.radiance(&edited(&[("LightVolume()", lighting)]), 24, 24);
        assert_eq!(studio.report().pipelines, ["surface", "raycast"], "{lighting}");
        assert_eq!(light_held(&studio), [], "{lighting}");
        assert_eq!(runs(&studio), [1, 0, 0, 0, 0], "{lighting}");
    }
}

#[needs(gpu)]
#[test]
fn light_takes_eight_bytes_a_voxel_at_most() {
    let mut studio = Studio::new();
    studio.volume("v.raw", [64; 3], |_| 0.5);
    for (lights, g) in [(1, 0.0), (1, 0.5), (4, 0.5)] {
        let sun = |index: u32| {
            format!("\"sun{index}\": ( DirectionalLight: (direction: (0.3, {index}.5, -1.0)) ),")
        };
        let suns: String = (0..lights).map(sun).collect();
        studio.radiance(
            &format!(
                "(entities: {{ {suns} \"v\": ( Volume: Raw(path: \"v.raw\", size: (64, 64, 64), format: F32), VolumeLighting: LightVolume(g: {g:?}) ) }})"
            ),
            4,
            4,
        );
        let held = light_held(&studio);
        let bytes: u64 = held.iter().map(|(_, bytes)| bytes).sum();
        let per_voxel = bytes as f64 / f64::from(lights) / 64f64.powi(3);
        eprintln!("{lights} lights, g {g}: {per_voxel:.2} bytes a voxel and light: {held:?}");
        assert!(per_voxel <= 8.0, "{lights} lights, g {g}: {per_voxel}: {held:?}");
    }
}

/// Whatever was in the scene before, the picture is that of a program that starts with it.
#[needs(gpu)]
#[test]
fn a_picture_does_not_depend_on_the_scenes_before_it() {
    let states: Vec<String> = [
        edited(&[]),
        edited(&[("LightVolume()", "LightVolume(g: 0.4)"), ("(30.0, 0.0, 0.0)", "(0.0, 0.0, 30.0)")]),
        edited(&[("LightVolume()", "SingleScattering(g: 0.4)"), ("(0.5, 0.9, 0.2)", "(0.5, 0.9, 0.9)")]),
        edited(&[("\"b\": ( DirectionalLight: (direction: (1.0, 0.5, -1.0)) ),", ""), ("v.raw", "w.raw")]),
        edited(&[("\"a\":", "\"c\":"), ("LightVolume()", "LightVolume(resolution: 0.3)")]),
        edited(&[("(background", "(shading: Local, background")]),
        edited(&[
            ("(background", "(millimetres_per_unit: 2.0, background"),
            ("(0.5, 0.9, 0.2)", "(0.1, 0.1, 0.9)"),
        ]),
        edited(&[
            ("\"m\":", "\"c\": ( DirectionalLight: (direction: (0.0, 0.0, 1.0)) ), \"m\":"),
            ("(translation: (0.0, 0.0, 0.0))", "(scale: 2.0)"),
        ]),
    ]
    .into();
    let fresh: Vec<_> = states.iter().map(|state| studio().radiance(state, 16, 16)).collect();
    let mut studio = studio();
    let (mut at, mut changes) = (0, Vec::new());
    for step in 0..60 {
        // Steps of different lengths, each state after most others sometime.
        let from = at;
        at = (at + 1 + (step * step + step / 7) % (states.len() - 1)) % states.len();
        let off = difference(&studio.radiance(&states[at], 16, 16), &fresh[at]);
        if off > 1e-6 {
            changes.push(format!("state {at} after {from}: off by {off}"));
        }
    }
    assert!(changes.is_empty(), "{}", changes.join("\n"));
}
