//! What a frame costs, part by part: reading, scanning, drawing, pre-integrating. `cargo bench --bench frame`.
//!
//! Compare with `cargo bench --bench frame -- --baseline NAME` after `--save-baseline NAME`; absolute times say little on a shared machine.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

use bevy_app::App;
use bevy_ecs::reflect::AppTypeRegistry;
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{UVec2, Vec3};
use std::fmt::Write;
use std::hint::black_box;
use std::path::Path;
use tyndall::components::{ControlPoint, TransferFunction};
use tyndall::gpu::{Gpu, GpuOptions};
use tyndall::optics::preintegration::Preintegration;
use tyndall::optics::transfer::LookupTable;
use tyndall::scene::{self, SceneDocument};
use tyndall::sources::{Samples, VolumeData};
use tyndall::{Picture, TyndallPlugins, render};

/// A ball of density in 128^3 voxels, 8 bits.
fn ball() -> Vec<u8> {
    let n = 128i32;
    let cells = (0..n).flat_map(|z| (0..n).flat_map(move |y| (0..n).map(move |x| [x, y, z])));
    cells
        .map(|cell| {
            let squared: i32 = cell.iter().map(|i| (2 * i - n).pow(2)).sum();
            (255.0 * (1.2 - f64::from(squared).sqrt() / f64::from(n)).clamp(0.0, 1.0)) as u8
        })
        .collect()
}

fn scan(criterion: &mut Criterion) {
    let samples = ball();
    let mut group = criterion.benchmark_group("scan 128^3");
    group.bench_function("U8", |bench| {
        bench.iter(|| VolumeData::new([128; 3], Vec3::ONE, Samples::U8(black_box(samples.clone()))));
    });
    let floats: Vec<f32> = samples.iter().map(|sample| f32::from(*sample)).collect();
    group.bench_function("F32", |bench| {
        bench.iter(|| VolumeData::new([128; 3], Vec3::ONE, Samples::F32(black_box(floats.clone()))));
    });
    group.finish();
}

/// A scene of 10,000 entities, of which one has this radius.
fn many(radius: f32) -> String {
    let mut text = String::from("(entities: {\n");
    for index in 0..10_000 {
        let radius = if index == 5_000 { radius } else { 1.0 };
        let _ = writeln!(
            text,
            "\"ball {index}\": ( Transform: (translation: ({index}.0, 0.0, 0.0)), Mesh: Sphere(radius: {radius:?}, subdivisions: 0) ), // a ball"
        );
    }
    text.push_str("})\n");
    text
}

fn read(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("many.ron");
    let write = |radius| std::fs::write(&path, many(radius)).expect("the scene is written");
    write(1.0);
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let mut group = criterion.benchmark_group("scene of 10,000 entities");
    group.sample_size(10);
    group.bench_function("read and reconcile", |bench| {
        bench.iter(|| render::load_scene(&mut app, &path, &[]));
    });
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let before = SceneDocument::load(&path, &registry, &[]);
    write(2.0);
    group.bench_function("read again with one changed", |bench| {
        bench.iter(|| SceneDocument::load_after(&path, &registry, &[], Some(&before)));
    });
    let after = SceneDocument::load_after(&path, &registry, &[], Some(&before));
    scene::reconcile(app.world_mut(), &before);
    group.bench_function("reconcile with one changed, there and back", |bench| {
        bench.iter(|| {
            let world = app.world_mut();
            let there = scene::reconcile_after(world, &after, Some(&before));
            let back = scene::reconcile_after(world, &before, Some(&after));
            assert_eq!((there.written, back.written), (1, 1));
        });
    });
    group.finish();
}

fn draw(criterion: &mut Criterion) {
    let Ok(gpu) = pollster::block_on(Gpu::new(&GpuOptions::default())) else {
        eprintln!("no graphics adapter: drawing is not measured");
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("ball.raw"), ball()).expect("the volume is written");
    let mut app = App::new();
    app.add_plugins(TyndallPlugins).insert_resource(gpu);
    app.insert_resource(Picture { size: UVec2::new(600, 340), ..Default::default() });
    let mut group = criterion.benchmark_group("draw 600x340");
    group.sample_size(10);
    for (name, entities) in [
        ("mesh of 20,480 triangles", "\"ball\": ( Mesh: Sphere() ),".to_owned()),
        ("emission-absorption 128^3", volume("EmissionAbsorption")),
        ("gradient 128^3", volume("Gradient()")),
    ] {
        load(&mut app, folder.path(), &entities);
        group.bench_function(BenchmarkId::from_parameter(name), |bench| {
            bench.iter(|| render::render(&mut app));
        });
    }
    group.finish();
}

fn volume(lighting: &str) -> String {
    format!(
        "\"v\": ( Volume: Raw(path: \"ball.raw\", size: (128, 128, 128)), VolumeLighting: {lighting},
            TransferFunction: (points: [(0.3, (0.2, 0.4, 0.8), 0.0), (1.0, (1.0, 0.8, 0.5), 0.1)]) ),"
    )
}

/// Tables of all pairs of values, whole and after a change of one entry in the middle.
fn pre_integrate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pre-integrate");
    group.sample_size(10);
    for entries in [256, 512, 1024] {
        let points = (0..=20).map(|at| {
            let place = at as f32 / 20.0;
            ControlPoint(place, Vec3::new(place, 0.5, 1.0 - place), 0.1 + 0.4 * (place * 9.0).sin().abs())
        });
        let function = TransferFunction { points: points.collect(), entries, ..Default::default() };
        let table = LookupTable::new(&function, (0.0, 255.0), 1.0, 1.0);
        group.bench_function(BenchmarkId::new("whole", entries), |bench| {
            bench.iter(|| Preintegration::new(black_box(&table), 1.0));
        });
        let mut tables = [table.clone(), table.clone()];
        tables[1].entries[entries as usize / 2].w *= 2.0;
        let mut made = Preintegration::new(&table, 1.0);
        group.bench_function(BenchmarkId::new("after a change of its middle", entries), |bench| {
            bench.iter(|| {
                tables.swap(0, 1);
                made.update(&tables[1], &tables[0])
            });
        });
    }
    group.finish();
}

fn load(app: &mut App, folder: &Path, entities: &str) {
    let path = folder.join("scene.ron");
    let text = format!(
        "(entities: {{ \"sun\": ( DirectionalLight: (direction: (-1.0, -1.0, -1.0)) ), {entities} }})"
    );
    std::fs::write(&path, text).expect("the scene is written");
    let document = render::load_scene(app, &path, &[]);
    assert!(!document.has_errors(), "{:#?}", document.problems);
}

criterion_group!(benches, scan, read, draw, pre_integrate);
criterion_main!(benches);
