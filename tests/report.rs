//! Only what the scene needs: which passes run, which pipelines are made, what is held.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use support::Studio;
use tyndall_needs::needs;

const LIGHT: &str = "\"sun\": ( DirectionalLight: () ),";
const MESH: &str = "\"ball\": ( Mesh: Sphere(subdivisions: 2) ),";
const VOLUME: &str = "\"v\": ( Volume: Raw(path: \"v.raw\", size: (4, 4, 4), format: F32) ),";

fn passes(entities: &str) -> (Vec<&'static str>, Vec<&'static str>, Vec<&'static str>) {
    let mut studio = Studio::new();
    studio.volume("v.raw", [4, 4, 4], |[x, ..]| x as f32);
    studio.radiance(&format!("(entities: {{ {entities} }})"), 8, 8);
    let report = studio.report();
    let names = report.passes.keys().copied().collect();
    (names, report.pipelines.clone(), report.gpu_bytes.keys().copied().collect())
}

#[needs(gpu)]
#[test]
fn passes_that_no_entity_needs_neither_run_nor_exist() {
    let (mesh, pipelines, held) = passes(&format!("{LIGHT} {MESH}"));
    assert_eq!(mesh, ["surface", "upload_meshes"]);
    assert_eq!(pipelines, ["surface"]);
    assert_eq!(held, ["meshes", "surface"]);

    let (volume, pipelines, held) = passes(VOLUME);
    assert_eq!(volume, ["classify", "raycast", "upload_volumes"]);
    assert_eq!(pipelines, ["raycast"]);
    assert_eq!(held, ["brick distances", "lookup tables", "raycast", "volumes"]);

    let (both, pipelines, _) = passes(&format!("{MESH} {VOLUME}"));
    assert_eq!(both, ["classify", "raycast", "surface", "upload_meshes", "upload_volumes"]);
    assert_eq!(pipelines, ["surface", "raycast"]);

    let (nothing, pipelines, _) = passes("");
    assert_eq!((nothing, pipelines), (vec!["surface"], vec![]));
}

#[needs(gpu)]
#[test]
fn drawing_again_uploads_and_classifies_nothing_and_an_edit_only_what_it_touches() {
    let mut studio = Studio::new();
    studio.volume("v.raw", [4, 4, 4], |[x, ..]| x as f32);
    let scene = format!("(entities: {{ {MESH} {VOLUME} }})");
    let runs = |studio: &Studio, pass: &str| studio.report().passes[pass].runs;
    studio.radiance(&scene, 8, 8);
    studio.radiance(&scene, 8, 8);
    assert_eq!(["upload_meshes", "upload_volumes", "classify"].map(|pass| runs(&studio, pass)), [1, 1, 1]);
    let edited = scene.replace("format: F32) )", "format: F32), TransferFunction: (entries: 64) )");
    assert_ne!(edited, scene);
    studio.radiance(&edited, 8, 8);
    assert_eq!(["upload_meshes", "upload_volumes", "classify"].map(|pass| runs(&studio, pass)), [1, 1, 2]);
    studio.radiance(&edited.replace("subdivisions: 2", "subdivisions: 3"), 8, 8);
    assert_eq!(["upload_meshes", "upload_volumes", "classify"].map(|pass| runs(&studio, pass)), [2, 1, 2]);
    assert_eq!(studio.report().pipelines, ["surface", "raycast"]);
}

#[needs(gpu)]
#[test]
fn samples_are_counted_and_a_volume_is_held_once_in_a_narrow_format() {
    let mut studio = Studio::new();
    studio.file("u8.raw", &[200; 16 * 16 * 16]);
    studio.app.world_mut().resource_mut::<tyndall::report::Report>().measure = true;
    let scene = "(entities: {
        \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 40.0), projection: Orthographic(height: 8.0)) ),
        \"v\": ( Volume: Raw(path: \"u8.raw\", size: (16, 16, 16)), RayCast: (early_termination: 1.0) ) })";
    studio.radiance(scene, 4, 4);
    let report = studio.report();
    // 16 rays of 16 voxels each.
    assert_eq!(report.passes["raycast"].work["samples"], 256);
    assert!(report.gpu_bytes["volumes"] <= 2 * 16 * 16 * 16, "{:?}", report.gpu_bytes);
    assert!(
        studio
            .app
            .world_mut()
            .query::<&tyndall::loading::LoadedVolume>()
            .iter(studio.app.world())
            .all(|volume| volume.data.samples.is_empty())
    );
}
