//! Many lights: what is kept for each as far as the budget goes, and summed beyond it.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use support::{Studio, difference};
use tyndall::LightBudget;
use tyndall_needs::needs;

const SIDE: usize = 24;

/// Three lights and a cloud that is thinner towards its rim, with a ball to cast a shadow into it.
fn scene(lighting: &str, second: &str) -> String {
    format!(
        "(entities: {{
            \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 90.0), projection: Perspective(vertical_fov: 24.0)) ),
            \"a\": ( DirectionalLight: (direction: (0.0, -1.0, -0.3), irradiance: (2.0, 1.0, 1.0)) ),
            \"b\": ( DirectionalLight: (direction: (1.0, 0.3, -0.2), irradiance: {second}) ),
            \"c\": ( DirectionalLight: (direction: (-0.4, 0.2, -1.0), irradiance: (1.0, 1.0, 2.0)) ),
            \"ball\": ( Mesh: Sphere(radius: 4.0, subdivisions: 2), Transform: (translation: (-18.0, -5.0, 0.0)) ),
            \"cloud\": (
                Volume: Raw(path: \"cloud.raw\", size: ({SIDE}, {SIDE}, {SIDE}), format: F32),
                TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (0.9, 0.8, 0.6), 0.0), (1.0, (0.9, 0.8, 0.6), 0.25)]),
                VolumeLighting: {lighting},
            ) }})"
    )
}

fn studio(volumes: u64) -> Studio {
    let mut studio = Studio::new();
    studio.app.insert_resource(LightBudget { volumes, ..Default::default() });
    studio.volume("cloud.raw", [SIDE; 3], |at| {
        let middle = (SIDE as f32 - 1.0) / 2.0;
        let apart = at.map(|cell| (cell as f32 - middle).powi(2)).iter().sum::<f32>().sqrt();
        (1.2 - apart / middle).clamp(0.0, 1.0)
    });
    studio
}

const GREEN: &str = "(1.0, 2.0, 1.0)";

fn relative_rmse(found: &[[f32; 3]], truth: &[[f32; 3]]) -> f32 {
    let squares = |pixels: &mut dyn Iterator<Item = f32>| pixels.map(|value| value * value).sum::<f32>();
    let off = squares(&mut found.iter().zip(truth).flat_map(|(a, b)| (0..3).map(move |c| a[c] - b[c])));
    (off / squares(&mut truth.iter().flatten().copied())).sqrt()
}

#[needs(gpu)]
#[test]
fn lights_beyond_the_budget_are_summed_and_still_there() {
    for (lighting, most) in [
        ("LightVolume()", 0.03),
        // What is scattered for the first time loses its direction.
        ("LightVolume(g: 0.3)", 0.15),
        ("SingleScattering()", 0.03),
        ("SingleScattering(g: -0.4)", 0.25),
    ] {
        let scene = scene(lighting, GREEN);
        let mut rich = studio(u64::MAX);
        let truth = rich.radiance(&scene, 48, 48);
        assert!(rich.report().sharing_lights.is_empty());
        assert!(!rich.report().pipelines.contains(&"shared_light"));
        let mut poor = studio(0);
        let found = poor.radiance(&scene, 48, 48);
        assert_eq!(poor.report().sharing_lights.get("light_volume"), Some(&2), "{lighting}");
        assert_eq!(poor.report().passes["shared_light"].work["lights"], 2);
        assert!(poor.report().gpu_bytes["light_volume"] < rich.report().gpu_bytes["light_volume"] / 2);
        let off = relative_rmse(&found, &truth);
        eprintln!("{lighting}: off by {:.1} %", 100.0 * off);
        assert!(off < most, "{lighting}: {off}");
    }
}

/// The colour of the light that has its own changes nothing but the sum; that of one that shares makes what they share anew, alone.
#[needs(gpu)]
#[test]
fn what_shares_is_made_anew_and_nothing_else() {
    const PASSES: [&str; 4] = ["light_cells", "light_network", "scattered_light", "shared_light"];
    for (lighting, alone, shares) in
        [("LightVolume()", [0, 0, 0, 0], [0, 0, 2, 1]), ("SingleScattering()", [0; 4], [0, 0, 0, 1])]
    {
        let mut studio = studio(0);
        let first = studio.radiance(&scene(lighting, GREEN), 16, 16);
        let runs = |studio: &Studio| {
            PASSES.map(|pass| studio.report().passes.get(pass).map_or(0, |record| record.runs))
        };
        let mut seen = Vec::new();
        // One colour for another, of each light in turn.
        for colour in ["(2.0, 1.0, 1.0)", GREEN, "(1.0, 1.0, 2.0)"] {
            let before = runs(&studio);
            studio.radiance(&scene(lighting, GREEN).replace(colour, "(3.0, 3.0, 0.5)"), 16, 16);
            let after = runs(&studio);
            seen.push(std::array::from_fn(|pass| after[pass] - before[pass]));
            // And back again, all is as it was.
            assert_eq!(difference(&first, &studio.radiance(&scene(lighting, GREEN), 16, 16)), 0.0);
        }
        seen.sort_unstable();
        assert_eq!(seen, [alone, shares, shares], "{lighting}");
        // With room for all lights nothing is shared.
        studio.app.insert_resource(LightBudget::default());
        studio.radiance(&scene(lighting, GREEN), 16, 16);
        assert!(studio.report().sharing_lights.is_empty());
        assert!(!studio.report().gpu_bytes.contains_key("shared_light"));
    }
}

/// Twenty lights are more than an adapter can bind textures for where it has but sixteen.
#[needs(gpu)]
#[test]
fn more_lights_than_textures_are_drawn() {
    let options = tyndall::gpu::GpuOptions { portable: true };
    let mut studio = Studio::with(&options);
    studio.volume("cloud.raw", [SIDE; 3], |_| 0.5);
    let lights: String = (0..20)
        .map(|i| format!("\"l{i}\": ( DirectionalLight: (direction: ({}.0, -9.0, -5.0)) ),", i - 10))
        .collect();
    let scene = scene("LightVolume()", GREEN).replace("\"ball\"", &format!("{lights} \"ball\""));
    let pixels = studio.radiance(&scene, 16, 16);
    assert!(pixels.iter().flatten().all(|value| value.is_finite()));
    assert!(studio.report().sharing_lights["light_volume"] > 10);
}

/// The light that leaves a mesh is summed exactly.
#[needs(gpu)]
#[test]
fn meshes_lose_nothing_by_sharing() {
    let scene = "(millimetres_per_unit: 10.0, entities: {
        \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 4.0)) ),
        \"a\": ( DirectionalLight: (direction: (0.0, -1.0, -1.0), irradiance: (1.0, 2.0, 3.0)) ),
        \"b\": ( DirectionalLight: (direction: (1.0, 0.0, -1.0)) ),
        \"ball\": ( Mesh: Sphere(subdivisions: 3), Subsurface: (), ScatteringMaps: (progressive: false) ) })";
    let mut rich = Studio::new();
    let truth = rich.radiance(scene, 24, 24);
    let mut poor = Studio::new();
    poor.app.insert_resource(LightBudget { mesh: 0, ..Default::default() });
    let found = poor.radiance(scene, 24, 24);
    assert_eq!(poor.report().sharing_lights.get("scattered_radiosity"), Some(&2));
    assert!(difference(&truth, &found) < 1e-5 * truth.iter().flatten().copied().fold(0.0, f32::max));
}
