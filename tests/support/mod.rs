//! Scenes made on the spot, drawn in this process.
#![allow(dead_code, reason = "each test binary uses its own part")]

use bevy_app::App;
use glam::UVec2;
use std::path::{Path, PathBuf};
use tyndall::gpu::{Gpu, GpuOptions};
use tyndall::render::{self, Pixels};
use tyndall::report::Report;
use tyndall::{Picture, TyndallPlugins};

/// An app with a GPU and a folder of its own for scenes and their files.
pub struct Studio {
    pub app: App,
    folder: tempfile::TempDir,
}

impl Studio {
    pub fn new() -> Self {
        Self::with(&GpuOptions::default())
    }

    pub fn with(options: &GpuOptions) -> Self {
        let gpu = pollster::block_on(Gpu::new(options)).unwrap_or_else(|error| panic!("{error}"));
        let mut app = App::new();
        app.add_plugins(TyndallPlugins).insert_resource(gpu);
        Self { app, folder: tempfile::tempdir().unwrap() }
    }

    /// Writes a file that scenes can name.
    pub fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// Writes 32-bit float samples, `value(x, y, z)` at each voxel.
    pub fn volume(&self, name: &str, size: [usize; 3], value: impl Fn([usize; 3]) -> f32) {
        let [nx, ny, nz] = size;
        let cells = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        let bytes: Vec<u8> = cells.flat_map(|cell| value(cell).to_le_bytes()).collect();
        self.file(name, &bytes);
    }

    /// The radiance of each pixel of a scene, row by row from the top.
    pub fn radiance(&mut self, scene: &str, width: u32, height: u32) -> Vec<[f32; 3]> {
        let path = self.file("scene.ron", scene.as_bytes());
        match self.draw(&path, width, height, false) {
            Pixels::Radiance(pixels) => pixels,
            Pixels::Encoded(_) => unreachable!("radiance was asked for"),
        }
    }

    /// The exposed and encoded pixels of a scene file.
    pub fn encoded(&mut self, path: &Path, width: u32, height: u32) -> Vec<[u8; 3]> {
        match self.draw(path, width, height, true) {
            Pixels::Encoded(pixels) => pixels,
            Pixels::Radiance(_) => unreachable!("an encoded picture was asked for"),
        }
    }

    fn draw(&mut self, path: &Path, width: u32, height: u32, encoded: bool) -> Pixels {
        let document = render::load_scene(&mut self.app, path, &[]);
        assert!(!document.has_errors(), "{:#?}", document.problems);
        self.app.insert_resource(Picture { size: UVec2::new(width, height), camera: None, encoded });
        match render::render(&mut self.app) {
            Ok(image) => image.pixels,
            Err(error) => panic!("{error}: {:#?}", render::problems(self.app.world(), &document)),
        }
    }

    pub fn report(&self) -> &Report {
        self.app.world().resource::<Report>()
    }
}

/// The middle pixel of a square picture of odd width.
pub fn middle(pixels: &[[f32; 3]]) -> [f32; 3] {
    pixels[pixels.len() / 2]
}

/// The greatest difference of two pictures in any channel.
pub fn difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).flat_map(|(a, b)| (0..3).map(move |c| (a[c] - b[c]).abs())).fold(0.0, f32::max)
}
