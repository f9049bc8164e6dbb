//! Every pass makes its pipelines and runs on wgpu's empty backend: a wrong layout, format or binding shows without any adapter.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use bevy_app::App;
use tyndall::gpu::{Gpu, GpuOptions};
use tyndall::report::Report;
use tyndall::{Picture, TyndallPlugins, render};

/// A device that does nothing, but checks everything.
fn noop(options: &GpuOptions) -> Gpu {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::NOOP;
    descriptor.backend_options.noop.enable = true;
    let instance = wgpu::Instance::new(descriptor);
    let adapter =
        pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).unwrap();
    pollster::block_on(Gpu::from_adapter(&adapter, options)).unwrap()
}

/// A pipeline for each use: classified voxels; opaque and translucent surfaces; points, texels and unseen points.
const EXPECTED: [&str; 12] = [
    "preclassify",
    "gbuffer",
    "scattering_texels",
    "scattered_radiosity",
    "scattered_texels",
    "gather",
    "scattered_radiosity",
    "combine",
    "surface",
    "surface",
    "raycast",
    "tonemap",
];

#[test]
fn every_pass_has_valid_pipelines_and_bindings() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("v.raw"), [7; 64]).unwrap();
    let scene = folder.path().join("scene.ron");
    let volume = "Volume: Raw(path: \"v.raw\", size: (4, 4, 4))";
    let text = format!(
        "(entities: {{ \"sun\": ( DirectionalLight: () ), \"ball\": ( Mesh: Sphere() ),
            \"wax\": ( Mesh: Sphere(), Subsurface: () ),
            \"published\": ( Mesh: Sphere(), Subsurface: (model: StandardDipole), ScatteringMaps: (strategy: Uniform) ),
            \"a\": ( {volume} ), \"b\": ( {volume}, VolumeLighting: Gradient() ),
            \"c\": ( Volume: Raw(path: \"v.raw\", size: (4, 4, 1), format: F32) ),
            \"d\": ( {volume}, TransferFunction: (entries: 64, iso: [(value: 3.0, width: 0.0)], classification: PreIntegrated) ),
            \"e\": ( {volume}, TransferFunction: (classification: Pre) ),
            \"f\": ( Volume: Raw(path: \"v.raw\", size: (4, 4, 1), format: F32), TransferFunction: (classification: Pre) ) }})"
    );
    check(&scene, &text, |_| EXPECTED.to_vec());
}

/// A pipeline for each use: volumes with and without a mesh in their light; the network, and light that diffuses in it.
const EXPECTED_OF_LIGHT: [&str; 27] = [
    "gbuffer",
    "light_volume",
    "light_cells",
    "light_network",
    "light_network",
    "light_network",
    "light_network",
    "light_escape",
    "scattered_light",
    "scattered_light",
    "diffusion",
    "diffusion",
    "diffusion",
    "diffusion",
    "diffusion",
    "diffusion",
    "diffusion",
    "summed_light",
    "eye_light",
    "eye_light",
    "dimmed_gbuffer",
    "scattered_radiosity",
    "combine",
    "surface",
    "surface",
    "raycast",
    "tonemap",
];

#[test]
fn every_pass_of_light_in_volumes_has_valid_pipelines_and_bindings() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("v.raw"), [7; 64]).unwrap();
    let scene = folder.path().join("scene.ron");
    let text = "(entities: { \"sun\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0)) ),
        \"ball\": ( Transform: (translation: (0.0, 0.0, 9.0)), Mesh: Sphere() ),
        \"wax\": ( Transform: (translation: (0.0, 0.0, -9.0)), Mesh: Sphere(), Subsurface: () ),
        \"a\": ( Volume: Raw(path: \"v.raw\", size: (4, 4, 4)), VolumeLighting: SingleScattering(g: 0.5) ),
        \"b\": ( Volume: Raw(path: \"v.raw\", size: (4, 4, 4)), VolumeLighting: LightVolume(g: -0.3, gradient_specular: 0.5) ),
        \"c\": ( Transform: (translation: (20.0, 0.0, 0.0)), Volume: Raw(path: \"v.raw\", size: (4, 4, 1), format: F32), VolumeLighting: LightVolume(g: 0.3, towards_eye: true) ) })";
    // Floats want a kernel of their own where no sampler interpolates them.
    check(&scene, text, |portable| {
        let own = portable.then_some(["light_cells", "light_volume"]);
        EXPECTED_OF_LIGHT.into_iter().chain(own.into_iter().flatten()).collect()
    });
}

#[test]
fn rays_that_are_cast_in_parts_have_valid_pipelines_and_bindings() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("v.raw"), [7; 64]).unwrap();
    let scene = folder.path().join("scene.ron");
    let text = "(entities: { \"sun\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0)) ),
        \"a\": ( Volume: Raw(path: \"v.raw\", size: (4, 4, 4), spacing: (0.001, 1.0, 1.0)), VolumeLighting: Gradient(), RayCast: (step: 0.1) ),
        \"b\": ( Volume: Raw(path: \"v.raw\", size: (4, 4, 1), format: F32) ) })";
    check(&scene, text, |_| vec!["raycast", "tonemap"]);
}

/// Draws a scene on all that an adapter may offer, and on as little as it may.
fn check(scene: &std::path::Path, text: &str, expected: impl Fn(bool) -> Vec<&'static str>) {
    std::fs::write(scene, text).unwrap();
    for portable in [false, true] {
        let mut app = App::new();
        app.add_plugins(TyndallPlugins).insert_resource(noop(&GpuOptions { portable }));
        app.insert_resource(Picture { size: glam::UVec2::new(16, 8), ..Default::default() });
        let document = render::load_scene(&mut app, scene, &[]);
        assert!(!document.has_errors(), "{:#?}", document.problems);
        app.update();
        let mut made = app.world().resource::<Report>().pipelines.clone();
        let mut expected = expected(portable);
        made.sort_unstable();
        expected.sort_unstable();
        assert_eq!(made, expected, "portable: {portable}");
        render::render(&mut app).unwrap();
    }
}
