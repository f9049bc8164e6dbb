//! A scene without a file: entities made in code, a value changed between two pictures.
//!
//! `cargo run --example build_in_code` writes `target/build_in_code_0.png` and `target/build_in_code_1.png`.

use bevy_app::App;
use bevy_ecs::prelude::Name;
use glam::{UVec2, UVec3, Vec3};
use std::error::Error;
use tyndall::components::{
    AssetPath, ControlPoint, DirectionalLight, Mesh, Phong, SceneSettings, TransferFunction, Transform,
    ViewCamera, Volume, VolumeLighting,
};
use tyndall::gpu::{Gpu, GpuOptions};
use tyndall::render::{Pixels, render};
use tyndall::{Picture, TyndallPlugins};

fn main() -> Result<(), Box<dyn Error>> {
    let gpu = match pollster::block_on(Gpu::new(&GpuOptions::default())) {
        Ok(gpu) => gpu,
        Err(error) => {
            eprintln!("nothing is drawn: {error}");
            return Ok(());
        }
    };
    let mut app = App::new();
    app.add_plugins(TyndallPlugins).insert_resource(gpu);
    app.insert_resource(Picture { size: UVec2::new(480, 270), ..Picture::default() });
    app.insert_resource(SceneSettings { millimetres_per_unit: 10.0, ..SceneSettings::default() });

    let world = app.world_mut();
    // Cameras are told apart by their names.
    world.spawn((Name::new("eye"), ViewCamera { eye: Vec3::new(0.0, 1.2, 6.0), ..ViewCamera::default() }));
    world.spawn(DirectionalLight {
        direction: Vec3::new(1.0, -2.0, -1.0),
        irradiance: Vec3::new(3.0, 2.9, 2.7),
    });
    // What is not given takes its default: a mesh brings a Transform with it, a volume a RayCast.
    let ball = world.spawn((Mesh::Sphere { radius: 0.8, subdivisions: 5 }, Phong::default())).id();
    world.spawn((
        Volume::Raw {
            path: AssetPath::new("assets/c60_32x32x32_u8.raw"),
            size: UVec3::splat(32),
            format: Default::default(),
            endian: Default::default(),
            spacing: Vec3::ONE,
            skip_bytes: 0,
            interpolation: Default::default(),
        },
        TransferFunction {
            points: vec![
                ControlPoint(0.15, Vec3::new(0.9, 0.2, 0.1), 0.0),
                ControlPoint(0.50, Vec3::new(1.0, 0.6, 0.1), 0.5),
            ],
            ..TransferFunction::default()
        },
        VolumeLighting::Gradient { ambient: 0.2, diffuse: 0.7, specular: 0.3, shininess: 16.0 },
    ));

    save(&mut app, "target/build_in_code_0.png")?;
    // Nothing is read or uploaded again for this: only what an entity's change makes stale is made anew.
    app.world_mut()
        .entity_mut(ball)
        .insert(Transform { translation: Vec3::new(1.5, 0.0, 0.0), ..Transform::default() });
    save(&mut app, "target/build_in_code_1.png")
}

fn save(app: &mut App, path: &str) -> Result<(), Box<dyn Error>> {
    let image = render(app)?;
    if let Pixels::Encoded(pixels) = image.pixels {
        std::fs::create_dir_all("target")?;
        let picture = image::RgbImage::from_raw(image.width, image.height, pixels.into_flattened());
        picture.ok_or("pixels are missing")?.save(path)?;
        eprintln!("wrote {path}");
    }
    Ok(())
}
