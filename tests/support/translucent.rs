//! Translucent meshes as scenes, and what pictures of them say.
#![allow(dead_code, reason = "each test binary uses its own part")]

use tyndall::optics::medium::Medium;

/// What each test needs of a picture in many digits.
pub type Pixels = Vec<[f32; 3]>;

/// A `Material` of three media that share `g` and `eta`.
pub fn custom(media: &[Medium; 3]) -> String {
    let list = |of: &dyn Fn(&Medium) -> f64| {
        format!("({:?}, {:?}, {:?})", of(&media[0]), of(&media[1]), of(&media[2]))
    };
    let Medium { g, eta, .. } = media[0];
    assert!(media.iter().all(|medium| medium.g == g && medium.eta == eta));
    let (sigma_a, sigma_s) = (list(&|medium| medium.sigma_a), list(&|medium| medium.sigma_s));
    format!("Custom(sigma_a: {sigma_a}, sigma_s: {sigma_s}, g: {g:?}, eta: {eta:?})")
}

/// A medium, alike in all colours.
pub fn grey(sigma_a: f64, sigma_s: f64, g: f64, eta: f64) -> String {
    custom(&[Medium { sigma_a, sigma_s, g, eta }; 3])
}

/// A light that comes down at some degrees from the vertical, from the side of -x.
pub fn sun(degrees: f64) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    format!(
        "\"sun\": ( DirectionalLight: (direction: ({sin:?}, {:?}, 0.0), irradiance: (1.0, 1.0, 1.0)) ),",
        -cos
    )
}

/// A camera that looks down, x to the right and -z up.
pub fn from_above(distance: f64, height: f64) -> String {
    format!(
        "\"eye\": ( ViewCamera: (eye: (0.0, {distance:?}, 0.0), up: (0.0, 0.0, -1.0), projection: Orthographic(height: {height:?})) ),"
    )
}

/// The mean of each channel.
pub fn mean(pixels: &[[f32; 3]]) -> [f64; 3] {
    let sum = |c: usize| pixels.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>();
    [0, 1, 2].map(|c| sum(c) / pixels.len() as f64)
}

/// The standard deviation of each channel over its mean.
pub fn spread(pixels: &[[f32; 3]]) -> [f64; 3] {
    let mean = mean(pixels);
    [0, 1, 2].map(|c| {
        let squares = pixels.iter().map(|pixel| (f64::from(pixel[c]) - mean[c]).powi(2)).sum::<f64>();
        (squares / pixels.len() as f64).sqrt() / mean[c]
    })
}

/// Writes the first channel of a picture as `/tmp/NAME.png` where the environment says `TYNDALL_LOOK`: to be looked at by whoever changes
/// a test.
pub fn look(name: &str, pixels: &[[f32; 3]], width: u32) {
    if std::env::var_os("TYNDALL_LOOK").is_none() {
        return;
    }
    let most = pixels.iter().flatten().copied().fold(1e-30f32, f32::max);
    let byte = |value: f32| (255.0 * (value / most).max(0.0).powf(1.0 / 2.2)) as u8;
    let bytes: Vec<u8> = pixels.iter().flatten().map(|value| byte(*value)).collect();
    let height = pixels.len() as u32 / width;
    image::save_buffer(format!("/tmp/{name}.png"), &bytes, width, height, image::ColorType::Rgb8)
        .unwrap_or_else(|error| panic!("{error}"));
}

/// A square plate in the plane y = 0 with a square hole in its middle, as OBJ.
pub fn plate_with_hole(side: f64, half_width: f64) -> String {
    let lines = [-side / 2.0, -half_width, half_width, side / 2.0];
    let vertices = lines.iter().flat_map(|z| lines.iter().map(move |x| format!("v {x:?} 0 {z:?}\n")));
    // Four by four vertices make nine squares, of which the middle one is the hole.
    let square = |i: usize| {
        let first = i / 3 * 4 + i % 3 + 1;
        format!("f {} {} {} {}\n", first, first + 4, first + 5, first + 1)
    };
    vertices.chain((0..9).filter(|i| *i != 4).map(square)).collect()
}
