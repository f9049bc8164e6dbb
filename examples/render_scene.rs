//! Draws a scene file into a PNG: Tyndall as a library.
//!
//! `cargo run --example render_scene -- scenes/cornell.ron` writes `target/render_scene.png`.

use bevy_app::App;
use glam::UVec2;
use std::error::Error;
use std::path::PathBuf;
use tyndall::gpu::{Gpu, GpuOptions};
use tyndall::render::{Pixels, load_scene, problems, render};
use tyndall::{Picture, TyndallPlugins};

fn main() -> Result<(), Box<dyn Error>> {
    let scene = std::env::args_os().nth(1).map_or("scenes/cornell.ron".into(), PathBuf::from);
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

    let document = load_scene(&mut app, &scene, &[]);
    let drawn = render(&mut app);
    for problem in problems(app.world(), &document) {
        eprintln!("{}", problem.message);
    }
    let image = drawn?;

    if let Pixels::Encoded(pixels) = image.pixels {
        std::fs::create_dir_all("target")?;
        let picture = image::RgbImage::from_raw(image.width, image.height, pixels.into_flattened());
        picture.ok_or("pixels are missing")?.save("target/render_scene.png")?;
        eprintln!("wrote target/render_scene.png");
    }
    Ok(())
}
