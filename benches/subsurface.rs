//! Speed against accuracy of translucent meshes: `cargo bench --bench subsurface`.
//!
//! For a sphere, and with `TYNDALL_DATA` set for the bunny and the dragon, the light that leaves points of the surface is compared with
//! the same integral summed in 64 bits over every texel that the light reaches, for both strategies over cameras, samples and texels.
//! Times are ratios to the published setting (Uniform, 16 cameras, 48 samples, 1200 x 680) of the same run: once for a light that
//! turned, once for a mesh that moved, which costs the cameras' views as well. The last column is a frame in which nothing changed, over
//! the same frame of the mesh lit locally.
#![allow(missing_docs, clippy::unwrap_used, reason = "a bench may panic")]

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::{DVec3, UVec2, Vec3};
use std::path::{Path, PathBuf};
use std::time::Instant;
use tyndall::components::{
    DirectionalLight, MapResolution, MapStrategy, ScatteringMaps, Shading, Subsurface, Transform,
};
use tyndall::cpu::{ScatteredPoint, brute_force, scattered_points};
use tyndall::gpu::{Gpu, GpuOptions};
use tyndall::{LightTexels, Picture, TyndallPlugins, render};

/// Points at which the error is measured.
const PROBES: usize = 160;

/// Repetitions of each time; the least counts.
const REPETITIONS: usize = 2;

struct Setting {
    name: &'static str,
    maps: ScatteringMaps,
}

fn settings(quick: bool) -> Vec<Setting> {
    let adaptive = ScatteringMaps::default();
    let uniform = ScatteringMaps {
        strategy: MapStrategy::Uniform,
        samples: 48,
        resolution: MapResolution::Texels(1200, 680),
        ..adaptive
    };
    let mut all = vec![
        Setting { name: "Uniform, as published", maps: uniform.clone() },
        Setting { name: "Adaptive, default", maps: adaptive.clone() },
    ];
    if quick {
        return all;
    }
    for cameras in [4, 8] {
        all.push(Setting { name: "Uniform", maps: ScatteringMaps { cameras, ..uniform } });
    }
    all.push(Setting {
        name: "Uniform",
        maps: ScatteringMaps { resolution: MapResolution::Texels(300, 170), ..uniform },
    });
    for samples in [24, 48, 256, 1024] {
        all.push(Setting { name: "Adaptive", maps: ScatteringMaps { samples, ..adaptive } });
    }
    for (cameras, side) in [(4, 256), (8, 256), (16, 128), (16, 256), (16, 512)] {
        let resolution = MapResolution::Texels(side, side);
        all.push(Setting {
            name: "Adaptive in maps",
            maps: ScatteringMaps { cameras, resolution, ..adaptive },
        });
    }
    all
}

fn main() {
    let quick = std::env::args().any(|argument| argument == "--quick");
    let mut scenes = vec![("sphere", "Sphere()".to_owned(), 20.0)];
    if let Some(data) = std::env::var_os("TYNDALL_DATA").map(PathBuf::from) {
        let file = |name: &str| format!("File({:?})", data.join("meshes").join(name));
        scenes.push(("bunny", file("stanford-bunny.obj"), 250.0));
        scenes.push(("dragon", file("dragon_50k_100k.obj"), 5.0));
    }
    let folder = tempfile::tempdir().unwrap();
    for (name, mesh, millimetres) in scenes {
        println!("\n{name}\n");
        println!("| strategy | K | N | texels | relative RMSE | light turned | mesh moved | static frame |");
        println!("|---|---|---|---|---|---|---|---|");
        measure(folder.path(), &mesh, millimetres, &settings(quick));
    }
}

fn measure(folder: &Path, mesh: &str, millimetres: f64, settings: &[Setting]) {
    let mut bench = Bench::new(folder, mesh, millimetres);
    let (probes, truth) = bench.truth();
    let local = bench.least(REPETITIONS + 2, |bench| {
        bench.set(Shading::Local);
    });
    bench.set(Shading::Scattering);
    let mut published = None;
    for Setting { name, maps } in settings {
        bench.set(maps.clone());
        bench.frame();
        let error = bench.error(&probes, &truth);
        let still = bench.least(REPETITIONS + 2, |_| ());
        let turned = bench.least(REPETITIONS, Bench::turn_light) - still;
        let moved = bench.least(REPETITIONS, Bench::move_mesh) - still;
        bench.put_back();
        let published = *published.get_or_insert((turned, moved));
        let texels = match maps.resolution {
            MapResolution::Auto => "–".to_owned(),
            MapResolution::Texels(across, down) => format!("{across} x {down}"),
        };
        println!(
            "| {name} | {} | {} | {texels} | {:.2} % | {:.0} ms, 1/{:.1} | {:.0} ms, 1/{:.1} | {:.2} x |",
            maps.cameras,
            maps.samples,
            100.0 * error,
            turned,
            published.0 / turned,
            moved,
            published.1 / moved,
            still / local
        );
    }
}

struct Bench {
    app: App,
    mesh: Entity,
    light: Entity,
    step: f32,
}

impl Bench {
    fn new(folder: &Path, mesh: &str, millimetres: f64) -> Self {
        let scene = folder.join("scene.ron");
        let text = format!(
            "(millimetres_per_unit: {millimetres:?}, entities: {{
                \"light\": ( DirectionalLight: (direction: (-1.0, -1.0, -1.0)) ),
                \"mesh\": ( Mesh: {mesh}, Subsurface: (material: Preset(\"marble\")), ScatteringMaps: (), Shading: Scattering ) }})"
        );
        std::fs::write(&scene, text).unwrap();
        let mut app = App::new();
        app.add_plugins(TyndallPlugins)
            .insert_resource(pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap());
        app.insert_resource(Picture { size: UVec2::new(1200, 680), ..Default::default() });
        let document = render::load_scene(&mut app, &scene, &[]);
        assert!(!document.has_errors(), "{:#?}", document.problems);
        app.update();
        let world = app.world_mut();
        let mesh = world.query_filtered::<Entity, With<Subsurface>>().single(world).unwrap();
        let light = world.query_filtered::<Entity, With<DirectionalLight>>().single(world).unwrap();
        Self { app, mesh, light, step: 0.0 }
    }

    fn set(&mut self, component: impl Component) {
        self.app.world_mut().entity_mut(self.mesh).insert(component);
    }

    fn world(&mut self) -> &mut World {
        self.app.world_mut()
    }

    /// Points spread over the surface, and what leaves them by brute force.
    fn truth(&mut self) -> (Vec<usize>, Vec<DVec3>) {
        let usual = *self.world().resource::<LightTexels>();
        self.world().insert_resource(LightTexels(1024));
        self.frame();
        let points = scattered_points(self.app.world(), self.mesh).unwrap();
        let probes: Vec<usize> = (0..PROBES).map(|index| index * points.len() / PROBES).collect();
        let chosen: Vec<ScatteredPoint> = probes.iter().map(|index| points[*index]).collect();
        let truth = brute_force(self.app.world(), self.mesh, &chosen).unwrap();
        self.world().insert_resource(usual);
        (probes, truth)
    }

    fn error(&self, probes: &[usize], truth: &[DVec3]) -> f64 {
        let points = scattered_points(self.app.world(), self.mesh).unwrap();
        let square = |difference: DVec3| difference.length_squared();
        let pairs = probes.iter().zip(truth);
        let wrong: f64 =
            pairs.map(|(index, truth)| square(points[*index].radiosity.as_dvec3() - *truth)).sum();
        (wrong / truth.iter().map(|truth| square(*truth)).sum::<f64>()).sqrt()
    }

    /// The least milliseconds that a frame takes after an edit.
    fn least(&mut self, repetitions: usize, edit: impl Fn(&mut Self)) -> f64 {
        let one = |bench: &mut Self| {
            edit(bench);
            let started = Instant::now();
            bench.frame();
            started.elapsed().as_secs_f64() * 1e3
        };
        // The first makes pipelines.
        one(self);
        (0..repetitions).map(|_| one(self)).fold(f64::INFINITY, f64::min)
    }

    fn frame(&mut self) {
        self.app.update();
        self.app.world().resource::<Gpu>().wait("drawing").unwrap();
    }

    /// Light and mesh as they were when the truth was found.
    fn put_back(&mut self) {
        self.step = -0.01;
        self.turn_light();
        self.step = -0.01;
        self.move_mesh();
    }

    fn turn_light(&mut self) {
        self.step += 0.01;
        let direction = Vec3::new(-1.0, -1.0, -1.0 + self.step);
        self.app.world_mut().get_mut::<DirectionalLight>(self.light).unwrap().direction = direction;
    }

    fn move_mesh(&mut self) {
        self.step += 0.01;
        let rotation = Vec3::new(0.0, self.step, 0.0);
        self.app.world_mut().get_mut::<Transform>(self.mesh).unwrap().rotation = rotation;
    }
}
