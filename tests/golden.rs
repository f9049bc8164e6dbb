//! Small pictures of the scenes that the project ships, compared with pictures that were looked at.
//!
//! `TYNDALL_BLESS=name cargo xtask test golden` accepts what `name` looks like now (`all` for all of them). A failure leaves
//! `name.actual.png` and `name.difference.png` beside the golden picture.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use std::path::{Path, PathBuf};
use support::Studio;
use tyndall_needs::needs;

const WIDTH: u32 = 160;
const HEIGHT: u32 = 90;

/// Drivers differ in the last bit, and in which side of an edge a pixel falls on.
const MEAN_TOLERANCE: f64 = 0.4;
const OUTLIER: u8 = 16;
const MOST_OUTLIERS: usize = (WIDTH * HEIGHT) as usize / 200;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The scenes that stand directly in `scenes/`, those that are only there to be included excepted.
fn scenes() -> Vec<PathBuf> {
    let mut scenes: Vec<PathBuf> =
        std::fs::read_dir(folder("scenes")).unwrap().map(|entry| entry.unwrap().path()).collect();
    scenes.retain(|path| path.extension().is_some_and(|ending| ending == "ron"));
    scenes.retain(|path| std::fs::read_to_string(path).unwrap().contains("ViewCamera"));
    scenes.sort();
    scenes
}

#[needs(gpu)]
#[test]
fn every_scene_looks_as_it_did() {
    let mut studio = Studio::new();
    studio.app.add_plugins(tyndall_turntable::TurntablePlugin);
    let mut failures = Vec::new();
    let scenes = scenes();
    assert!(scenes.len() >= 3, "{scenes:?}");
    for scene in scenes {
        let name = scene.file_stem().unwrap().to_string_lossy().into_owned();
        let pixels = studio.encoded(&scene, WIDTH, HEIGHT);
        if let Err(failure) = compare(&name, &pixels) {
            failures.push(format!("{name}: {failure}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn compare(name: &str, pixels: &[[u8; 3]]) -> Result<(), String> {
    let golden = folder("tests/golden").join(format!("{name}.png"));
    let bless = std::env::var("TYNDALL_BLESS").unwrap_or_default();
    if bless == name || bless == "all" {
        save(&golden, pixels);
        let bytes = std::fs::metadata(&golden).unwrap().len();
        return if bytes <= 64 << 10 {
            Ok(())
        } else {
            Err(format!("a golden picture has at most 64 KiB, found {bytes} bytes"))
        };
    }
    let expected = image::open(&golden)
        .map_err(|error| format!("{error}; look at the picture and bless it: TYNDALL_BLESS={name}"))?
        .to_rgb8();
    let expected: Vec<[u8; 3]> = expected.pixels().map(|pixel| pixel.0).collect();
    let difference: Vec<[u8; 3]> = pixels
        .iter()
        .zip(&expected)
        .map(|(a, b)| std::array::from_fn(|channel| a[channel].abs_diff(b[channel])))
        .collect();
    let mean = difference.iter().flatten().map(|value| f64::from(*value)).sum::<f64>()
        / (3 * difference.len()) as f64;
    let outliers = difference.iter().filter(|pixel| pixel.iter().any(|value| *value > OUTLIER)).count();
    if expected.len() == pixels.len() && mean <= MEAN_TOLERANCE && outliers <= MOST_OUTLIERS {
        return Ok(());
    }
    save(&golden.with_extension("actual.png"), pixels);
    save(&golden.with_extension("difference.png"), &difference);
    Err(format!(
        "differs by {mean:.2} levels in the mean and in {outliers} pixels; see {}",
        golden.with_extension("actual.png").display()
    ))
}

fn save(path: &Path, pixels: &[[u8; 3]]) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    image::save_buffer(path, pixels.as_flattened(), WIDTH, HEIGHT, image::ColorType::Rgb8).unwrap();
}
