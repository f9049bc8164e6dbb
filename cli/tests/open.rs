//! Files of data given where a scene could stand: a scene is made for them, and it shows them.

#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tyndall_needs::needs;

/// A folder with a mesh and volumes in it.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        desk.write("box.obj", cuboid([0.5, 1.0, 0.25]));
        desk.write("ball.nrrd", ball(24));
        desk.write("scan.nii", nifti(24));
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    fn run(&self, code: i32, arguments: &[&str]) -> Output {
        let output = Command::new(env!("CARGO_BIN_EXE_tyndall"))
            .current_dir(self.0.path())
            .args(arguments)
            .output()
            .unwrap();
        let person = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "tyndall {arguments:?} said:\n{person}");
        output
    }

    /// Rows and columns that differ from the upper left corner, of the picture of some files.
    fn seen(&self, files: &[&str]) -> (Vec<u32>, Vec<u32>, image::RgbImage) {
        self.run(0, &[&["render"], files, &["-o", "seen.png", "--size", "200x200"]].concat());
        let picture = image::open(self.path("seen.png")).unwrap().to_rgb8();
        let corner = *picture.get_pixel(0, 0);
        let differs = |pixel: &image::Rgb<u8>| pixel.0.iter().zip(corner.0).any(|(a, b)| a.abs_diff(b) > 12);
        let (mut rows, mut columns) = (Vec::new(), Vec::new());
        for (x, y, pixel) in picture.enumerate_pixels() {
            if differs(pixel) {
                rows.push(y);
                columns.push(x);
            }
        }
        (rows, columns, picture)
    }
}

/// A box of these half sides.
fn cuboid([x, y, z]: [f32; 3]) -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let side = |axis: u32, half: f32| if corner >> axis & 1 == 0 { -half } else { half };
        text += &format!("v {} {} {}\n", side(0, x), side(1, y), side(2, z));
    }
    text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

/// A ball of 1000 in -1000, as 16-bit integers.
fn ball_samples(side: i32) -> Vec<u8> {
    let centre = f64::from(side - 1) / 2.0;
    let cells = (0..side).flat_map(|z| (0..side).flat_map(move |y| (0..side).map(move |x| [x, y, z])));
    let value = |cell: [i32; 3]| {
        let away = cell.map(|part| (f64::from(part) - centre).powi(2)).iter().sum::<f64>().sqrt();
        // A wall two voxels thick.
        let share = ((f64::from(side) * 0.4 - away) / 2.0).clamp(-0.5, 0.5);
        (share * 2000.0) as i16
    };
    cells.flat_map(|cell| value(cell).to_le_bytes()).collect()
}

fn ball(side: i32) -> Vec<u8> {
    let header = format!(
        "NRRD0004\ntype: short\ndimension: 3\nsizes: {side} {side} {side}\nencoding: raw\nendian: little\n\n"
    );
    [header.into_bytes(), ball_samples(side)].concat()
}

/// The same in a patient, with a bright corner at the right, front and head.
fn nifti(side: i32) -> Vec<u8> {
    let mut header = vec![0_u8; 352];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348_i32.to_le_bytes());
    let dims: Vec<u8> =
        [3, side, side, side, 1, 1, 1, 1].iter().flat_map(|dim| (*dim as i16).to_le_bytes()).collect();
    put(40, &dims);
    put(70, &4_i16.to_le_bytes());
    put(72, &16_i16.to_le_bytes());
    let spacing: Vec<u8> = [1.0_f32; 4].iter().flat_map(|length| length.to_le_bytes()).collect();
    put(76, &spacing);
    put(108, &352_f32.to_le_bytes());
    put(254, &1_i16.to_le_bytes());
    for (row, translation) in [-12.0_f32, -12.0, -12.0].into_iter().enumerate() {
        put(280 + 16 * row + 4 * row, &1_f32.to_le_bytes());
        put(280 + 16 * row + 12, &translation.to_le_bytes());
    }
    put(344, b"n+1\0");
    let mut samples = ball_samples(side);
    for z in side - 6..side {
        for y in side - 6..side {
            for x in side - 6..side {
                let at = 2 * ((z * side + y) * side + x) as usize;
                samples[at..at + 2].copy_from_slice(&1000_i16.to_le_bytes());
            }
        }
    }
    [header, samples].concat()
}

#[needs(gpu)]
#[test]
fn a_mesh_alone_is_lit_and_fills_the_picture() {
    let desk = Desk::new();
    let (rows, columns, picture) = desk.seen(&["box.obj"]);
    let height = rows.last().unwrap() - rows.first().unwrap() + 1;
    assert!((171..=190).contains(&height), "{height} of 200 rows");
    let middle = (columns.iter().min().unwrap() + columns.iter().max().unwrap()) / 2;
    assert!((96..=104).contains(&middle), "{middle}");
    assert!(picture.get_pixel(100, 100).0[0] > 150, "{:?}", picture.get_pixel(100, 100));
    let corner = picture.get_pixel(0, 0).0[0];
    assert!((30..90).contains(&corner), "a dark grey background, not {corner}");
}

#[needs(gpu)]
#[test]
fn a_volume_of_any_type_alone_is_seen() {
    let desk = Desk::new();
    let (rows, _, picture) = desk.seen(&["ball.nrrd"]);
    let height = rows.last().unwrap() - rows.first().unwrap() + 1;
    // The box around it comes nearer than its sides do.
    assert!((150..=195).contains(&height), "{height} of 200 rows");
    let bright = picture.pixels().filter(|pixel| pixel.0[0] > 110).count();
    assert!((4000..30_000).contains(&bright), "{bright} pixels of a ball, not of a box");
}

#[needs(gpu)]
#[test]
fn a_patient_is_seen_from_the_front_with_the_head_up() {
    let desk = Desk::new();
    let (.., picture) = desk.seen(&["scan.nii"]);
    // The right hand of who faces the camera is on the left of the picture.
    let brightness = |columns: std::ops::Range<u32>| {
        let pixels = columns.flat_map(|x| (8..45).map(move |y| (x, y)));
        pixels.map(|(x, y)| u32::from(picture.get_pixel(x, y).0[0])).max().unwrap()
    };
    let (left, right) = (brightness(5..50), brightness(150..195));
    assert!(left > right + 40, "{left} and {right}");
}

#[test]
fn a_scene_is_written_that_is_right_and_shows_the_files() {
    let desk = Desk::new();
    fs::create_dir(desk.path("in")).unwrap();
    desk.run(0, &["new", "box.obj", "scan.nii", "-o", "in/both.ron"]);
    let text = fs::read_to_string(desk.path("in/both.ron")).unwrap();
    assert!(text.contains("Mesh: File(\"../box.obj\")"), "{text}");
    assert!(text.contains("Volume: File(path: \"../scan.nii\", place: Patient)"), "{text}");
    desk.run(0, &["check", "in/both.ron"]);
    // What is there stays, and what is no data is not made a scene of.
    desk.run(2, &["new", "box.obj", "-o", "in/both.ron"]);
    desk.write("notes.txt", "nothing");
    desk.run(2, &["new", "notes.txt", "-o", "in/notes.ron"]);
    assert!(!desk.path("in/notes.ron").exists());
}

#[test]
fn data_are_checked_and_told_of_like_scenes() {
    let desk = Desk::new();
    desk.run(0, &["check", "box.obj", "ball.nrrd"]);
    let told = desk.run(0, &["info", "scan.nii", "box.obj", "--json"]);
    let facts: serde_json::Value = serde_json::from_slice(&told.stdout).unwrap();
    assert_eq!(facts["scan"]["size"], serde_json::json!([24, 24, 24]));
    assert_eq!(facts["box"]["triangles"], 12);
    desk.write("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    desk.run(1, &["check", "broken.obj"]);
    desk.run(2, &["render", "box.obj", "--up", "y", "--front=-y", "-o", "a.png"]);
    assert!(!Path::new(&desk.path("a.png")).exists());
}
