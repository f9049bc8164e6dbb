//! What is written, where to, and what each format says of itself.

use super::{BALL, Place};
use std::fs;
use std::io::Read;
use std::process::Stdio;
use tyndall_needs::needs;

/// A white ball in the middle of a bright background.
const WHITE: &str = r#"(
    background: (0.5, 0.25, 0.125),
    entities: {
        "eye": ( ViewCamera: (eye: (0.0, 0.0, 5.0), projection: Orthographic(height: 2.0)) ),
        "ball": ( Mesh: Sphere(radius: 0.5), Phong: (ambient: (0.25, 0.5, 0.75), diffuse: (0.0, 0.0, 0.0)) ),
    },
)
"#;

/// A box of fog that hides the same of everything behind it: depth 0.5 along the view.
const FOG: &str = r#"(
    background: (0.5, 0.25, 0.125),
    entities: {
        "eye": ( ViewCamera: (eye: (0.0, 0.0, 50.0), projection: Orthographic(height: 10.0)) ),
        "fog": (
            Volume: Raw(path: "fog.raw", size: (4, 4, 4)),
            TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (0.2, 0.4, 0.8), 0.3), (1.0, (0.2, 0.4, 0.8), 0.3)], opacity_length: 1.0),
            RayCast: (step: 0.1),
        ),
    },
)
"#;

/// As IEC 61966-2-1 encodes radiance from 0 to 1.
fn srgb(linear: f64) -> f64 {
    255.0 * if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

fn assert_near(found: [u8; 3], linear: [f64; 3], what: &str) {
    for (found, linear) in found.iter().zip(linear) {
        assert!((f64::from(*found) - srgb(linear)).abs() <= 1.0, "{what}: {found} for {linear}");
    }
}

fn chunk<'a>(png: &'a [u8], name: &[u8; 4]) -> Option<&'a [u8]> {
    let at = png.windows(4).position(|window| window == name)?;
    let length = u32::from_be_bytes(png[at - 4..at].try_into().unwrap()) as usize;
    Some(&png[at + 4..at + 4 + length])
}

#[needs(gpu)]
#[test]
fn a_png_is_srgb_and_says_so() {
    let place = Place::with_scene(WHITE);
    let draw = |more: &[&str]| {
        place.run(0, &[&["render", "scene.ron", "--size", "16x16", "-o", "a.png"], more].concat());
        fs::read(place.path("a.png")).unwrap()
    };
    let png = draw(&[]);
    let picture = image::load_from_memory(&png).unwrap().into_rgb8();
    assert_near(picture.get_pixel(0, 0).0, [0.5, 0.25, 0.125], "background");
    assert_near(picture.get_pixel(8, 8).0, [0.25, 0.5, 0.75], "ball");
    assert_eq!(chunk(&png, b"sRGB"), Some(&[0_u8][..]));
    assert_eq!(chunk(&png, b"gAMA"), Some(&45_455_u32.to_be_bytes()[..]));
    let primaries = [31_270, 32_900, 64_000, 33_000, 30_000, 60_000, 15_000, 6_000_u32];
    assert_eq!(chunk(&png, b"cHRM"), Some(&primaries.map(u32::to_be_bytes).concat()[..]));
    // What is encoded otherwise is not called sRGB.
    let png = draw(&["--set", "eye.ViewCamera.gamma=2.0"]);
    assert_eq!(chunk(&png, b"sRGB"), None);
    assert_eq!(chunk(&png, b"gAMA"), Some(&50_000_u32.to_be_bytes()[..]));
    let picture = image::load_from_memory(&png).unwrap().into_rgb8();
    assert_eq!(picture.get_pixel(0, 0).0, [180, 128, 90]);
}

#[needs(gpu)]
#[test]
fn the_background_can_be_left_out() {
    let place = Place::with_scene(WHITE);
    let draw = |scene: &str, output: &str| {
        place.run(0, &["render", scene, "--size", "16x16", "--transparent", "-o", output]);
        image::open(place.path(output)).unwrap()
    };
    let ball = draw("scene.ron", "ball.png").into_rgba8();
    assert_eq!(ball.get_pixel(0, 0).0, [0; 4]);
    let [r, g, b, a] = ball.get_pixel(8, 8).0;
    assert_near([r, g, b], [0.25, 0.5, 0.75], "ball");
    assert_eq!(a, 255);
    let linear = draw("scene.ron", "ball.exr").into_rgba32f();
    assert_eq!((linear.get_pixel(0, 0).0, linear.get_pixel(8, 8).0), ([0.0; 4], [0.25, 0.5, 0.75, 1.0]));

    place.write("fog.raw", [128; 64]);
    place.write("fog.ron", FOG);
    let linear = draw("fog.ron", "fog.exr").into_rgba32f();
    assert_eq!(linear.get_pixel(0, 0).0, [0.0; 4]);
    let [r, g, b, a] = linear.get_pixel(8, 8).0;
    // 0.3 of what is behind a millimetre is hidden by it, and the box is four deep.
    let expected = 1.0 - 0.7_f32.powi(4);
    assert!((a - expected).abs() < 0.01, "{a} {expected}");
    for (found, colour) in [r, g, b].iter().zip([0.2, 0.4, 0.8]) {
        assert!((found - a * colour).abs() < 0.01, "premultiplied: {found} of {colour} at {a}");
    }
    // What it hides and what it lets through are the picture with its background.
    place.run(0, &["render", "fog.ron", "--size", "16x16", "-o", "whole.exr"]);
    let whole = image::open(place.path("whole.exr")).unwrap().into_rgb32f();
    for (x, y, pixel) in whole.enumerate_pixels() {
        let [front @ .., a] = linear.get_pixel(x, y).0;
        for channel in 0..3 {
            let over = front[channel] + (1.0 - a) * [0.5, 0.25, 0.125][channel];
            assert!((pixel.0[channel] - over).abs() < 1e-4, "{x} {y}: {:?} {over}", pixel.0);
        }
    }
    // Straight: the colour does not depend on how much of the pixel it hides.
    let [r, g, b, a] = draw("fog.ron", "fog.png").into_rgba8().get_pixel(8, 8).0;
    assert_near([r, g, b], [0.2, 0.4, 0.8], "fog");
    assert!((f32::from(a) / 255.0 - expected).abs() < 0.01, "{a}");
    place
        .run(2, &["render", "fog.ron", "--transparent", "-o", "fog.y4m"])
        .says("cannot leave the background out");
}

#[needs(gpu)]
#[test]
fn a_picture_goes_down_a_pipe() {
    let place = Place::with_scene(BALL);
    place.run(0, &["render", "scene.ron", "--size", "32x24", "-o", "a.png"]);
    let file = fs::read(place.path("a.png")).unwrap();
    let piped = |more: &[&str]| {
        let arguments = [&["render", "scene.ron", "--size", "32x24", "-o", "-"], more].concat();
        let output = place.command(&arguments).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && told.is_empty(), "{told}");
        output.stdout
    };
    assert_eq!(piped(&[]), file);
    assert_eq!(piped(&["--format", "png"]), file);
    let exr = image::load_from_memory_with_format(&piped(&["--format", "exr"]), image::ImageFormat::OpenExr);
    assert_eq!(exr.unwrap().into_rgb32f().dimensions(), (32, 24));
    assert_eq!(piped(&["--format", "raw"]), image::open(place.path("a.png")).unwrap().into_rgb8().into_raw());
    assert_eq!(place.names(), ["a.png", "scene.ron"]);
}

#[needs(gpu)]
#[test]
fn frames_are_streamed() {
    let place = Place::with_scene(BALL);
    let size = ["--size", "32x24", "--frames", "0..3", "--fps", "29.97"];
    let render = |more: &[&str]| {
        let arguments = [&["render", "scene.ron"], &size[..], more].concat();
        let output = place.command(&arguments).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    render(&["-o", "a.png"]);
    let frames: Vec<Vec<u8>> = (0..3)
        .map(|frame| image::open(place.path(&format!("a_000{frame}.png"))).unwrap().into_rgb8().into_raw())
        .collect();
    assert_ne!(frames[0], frames[1]);
    let raw = render(&["-o", "-", "--format", "raw"]);
    assert_eq!(raw, frames.concat());
    let rgba = render(&["-o", "-", "--format", "raw", "--transparent"]);
    assert_eq!(rgba.len(), 3 * 32 * 24 * 4);
    render(&["-o", "a.rgb"]);
    assert_eq!(fs::read(place.path("a.rgb")).unwrap(), raw);

    let video = render(&["-o", "-", "--format", "y4m"]);
    render(&["-o", "a.y4m"]);
    assert_eq!(fs::read(place.path("a.y4m")).unwrap(), video);
    let (head, planes) = video.split_at(video.iter().position(|byte| *byte == b'\n').unwrap() + 1);
    let head = String::from_utf8(head.to_vec()).unwrap();
    assert!(head.starts_with("YUV4MPEG2 W32 H24 F30000:1001 Ip A1:1 C444 "), "{head}");
    let frame_length = 6 + 3 * 32 * 24;
    assert_eq!(planes.len(), 3 * frame_length);
    for (frame, rgb) in planes.chunks(frame_length).zip(&frames) {
        assert!(frame.starts_with(b"FRAME\n"));
        for (pixel, rgb) in rgb.chunks(3).enumerate() {
            let plane = |index: usize| f64::from(frame[6 + index * 32 * 24 + pixel]);
            let (y, cb, cr) =
                ((plane(0) - 16.0) / 219.0, (plane(1) - 128.0) / 224.0, (plane(2) - 128.0) / 224.0);
            let decoded =
                [y + 1.402 * cr, y - (0.114 * 1.772 * cb + 0.299 * 1.402 * cr) / 0.587, y + 1.772 * cb];
            for (decoded, rgb) in decoded.iter().zip(rgb) {
                assert!((255.0 * decoded - f64::from(*rgb)).abs() < 2.0, "pixel {pixel}: {decoded} {rgb}");
            }
        }
    }
    let names = place.names();
    assert_eq!(names, ["a.rgb", "a.y4m", "a_0000.png", "a_0001.png", "a_0002.png", "scene.ron"]);
}

#[cfg(unix)]
#[needs(gpu)]
#[test]
fn a_pipe_that_nobody_reads_ends_the_program_quietly() {
    let place = Place::with_scene(BALL);
    let arguments =
        ["render", "scene.ron", "--size", "64x64", "--frames", "0..10000", "-o", "-", "--format", "raw"];
    let mut command = place.command(&arguments);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut first = [0; 64 * 64 * 3];
    let mut stdout = child.stdout.take().unwrap();
    stdout.read_exact(&mut first).unwrap();
    drop(stdout);
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert_eq!(output.status.code(), Some(141));
}

#[test]
fn what_cannot_be_written_is_told_before_any_work() {
    let place = Place::with_scene(BALL);
    place.run(2, &["render", "scene.ron", "-o", "out.jpg"]).says("a picture is written as .png or .exr");
    place.run(2, &["render", "scene.ron", "-o", "out"]).says("else say --format");
    place.run(2, &["render", "scene.ron", "-o", "out.png", "--format", "jpg"]).says("possible values");
    place.run(2, &["render", "scene.ron", "-o", "nowhere/out.y4m"]).says("there is no folder nowhere");
    assert_eq!(place.names(), ["scene.ron"]);
}
