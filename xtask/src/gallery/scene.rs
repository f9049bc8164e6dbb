//! The scene of a cell: a scan two units tall, standing upright in the middle, and a camera that has all of it in the picture.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::sheets::{Cell, Sheet};

/// Half the height of the picture, as a tangent: a long lens, so that near and far parts keep their proportions.
const HALF_HEIGHT: f64 = 0.18;

/// How much of the picture's height, or of its width where that is less, the scan fills.
const FILLED: f64 = 0.84;

/// The camera looks down by so many degrees.
const DOWN: f64 = 6.0;

type Point = [f64; 3];

/// A scan as it stands in its scenes.
pub struct Posed {
    file: PathBuf,
    scale: f64,
    translation: Point,
    /// Its points, in the scene.
    points: Vec<Point>,
}

impl Posed {
    /// Reads the points of an OBJ file and finds where it has to be put.
    pub fn read(file: &Path, sheet: &Sheet) -> Result<Self> {
        let context = || format!("cannot read {}", file.display());
        let text = fs::read_to_string(file).with_context(context)?;
        let points: Vec<Point> =
            text.lines().filter_map(vertex).map(|point| turned(point, sheet.turned)).collect();
        if points.is_empty() {
            bail!("{} has no vertices", file.display());
        }
        let file = file.canonicalize().with_context(context)?;
        Ok(Self::of(file, points))
    }

    fn of(file: PathBuf, mut points: Vec<Point>) -> Self {
        let side = |axis: usize, better: fn(f64, f64) -> f64| {
            points.iter().map(|point| point[axis]).reduce(better).unwrap_or(0.0)
        };
        let low: Point = std::array::from_fn(|axis| side(axis, f64::min));
        let high: Point = std::array::from_fn(|axis| side(axis, f64::max));
        let scale = 2.0 / (high[1] - low[1]);
        let translation = std::array::from_fn(|axis| -scale * (low[axis] + high[axis]) / 2.0);
        for point in &mut points {
            *point = std::array::from_fn(|axis| scale * point[axis] + translation[axis]);
        }
        Self { file, scale, translation, points }
    }

    /// How far from the middle the camera stands.
    fn distance(&self, aspect: f64) -> f64 {
        let (sin, cos) = DOWN.to_radians().sin_cos();
        let half = HALF_HEIGHT * FILLED;
        let needed = |[x, y, z]: &Point| {
            let (up, near) = (y * cos - z * sin, y * sin + z * cos);
            near + up.abs().max(x.abs() / aspect) / half
        };
        self.points.iter().map(needed).fold(0.0, f64::max)
    }
}

/// The point of a line `v x y z`.
fn vertex(line: &str) -> Option<Point> {
    let mut words = line.strip_prefix("v ")?.split_whitespace().map(str::parse);
    Some([words.next()?.ok()?, words.next()?.ok()?, words.next()?.ok()?])
}

/// About the x axis, then about the y axis, as `Transform` does it.
fn turned([x, y, z]: Point, (about_x, about_y): (f64, f64)) -> Point {
    let (sin, cos) = about_x.to_radians().sin_cos();
    let [y, z] = [y * cos - z * sin, y * sin + z * cos];
    let (sin, cos) = about_y.to_radians().sin_cos();
    [x * cos + z * sin, y, z * cos - x * sin]
}

/// The RON of a cell.
pub fn text(sheet: &Sheet, cell: &Cell, posed: &Posed, (across, down): (u32, u32)) -> String {
    let distance = posed.distance(f64::from(across) / f64::from(down));
    let (sin, cos) = DOWN.to_radians().sin_cos();
    let eye = (0.0, distance * sin, distance * cos);
    let fov = 2.0 * HALF_HEIGHT.atan().to_degrees();
    let [x, y, z] = posed.translation;
    let Cell { label, look, light } = cell;
    format!(
        r#"// {title}; {label}. Written by `cargo xtask gallery`.
(
    millimetres_per_unit: {millimetres_per_unit:?},
    background: (0.012, 0.013, 0.016),
    entities: {{
        "eye": ( ViewCamera: (eye: {eye:?}, projection: Perspective(vertical_fov: {fov:?})) ),
        "light": ( DirectionalLight: (direction: {direction:?}, irradiance: ({e:?}, {e:?}, {e:?})) ),
        "body": (
            Transform: (translation: ({x:?}, {y:?}, {z:?}), rotation: ({about_x:?}, {about_y:?}, 0.0), scale: {scale:?}),
            Mesh: File({file:?}),
            Subsurface: (material: Preset({material:?}), model: {model}, specular: {specular}),
            ScatteringMaps: ({maps}),
        ),
    }},
)
"#,
        title = sheet.title,
        millimetres_per_unit = sheet.millimetres / 2.0,
        direction = light.direction,
        e = light.irradiance,
        about_x = sheet.turned.0,
        about_y = sheet.turned.1,
        scale = posed.scale,
        file = posed.file.to_string_lossy(),
        material = look.material,
        model = look.model,
        specular = look.specular,
        maps = look.maps,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scan_stands_upright_in_the_middle_two_units_tall() {
        // A bar along z that turns upright.
        let points: Vec<Point> = [[5.0, 1.0, -3.0], [7.0, 2.0, 9.0]].into();
        let points = points.into_iter().map(|point| turned(point, (-90.0, 0.0))).collect();
        let posed = Posed::of(PathBuf::new(), points);
        let expected = [[-1.0 / 6.0, -1.0, 1.0 / 12.0], [1.0 / 6.0, 1.0, -1.0 / 12.0]];
        for (point, expected) in posed.points.iter().zip(expected) {
            assert!(point.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{point:?}");
        }
    }

    #[test]
    fn the_scan_fills_the_picture_and_no_more() {
        let corners = |index: u8| [0, 1, 2].map(|axis| if index >> axis & 1 == 0 { -1.0 } else { 1.0 });
        let posed = Posed::of(PathBuf::new(), (0..8).map(corners).collect());
        let (sin, cos) = DOWN.to_radians().sin_cos();
        for aspect in [0.5, 1.0, 3.0] {
            let distance = posed.distance(aspect);
            let largest = posed.points.iter().map(|[x, y, z]| {
                let depth = distance - (y * sin + z * cos);
                (y * cos - z * sin).abs().max(x.abs() / aspect) / depth / HALF_HEIGHT
            });
            let largest = largest.fold(0.0, f64::max);
            assert!((largest - FILLED).abs() < 1e-9, "{largest} of the picture at {aspect}");
        }
    }

    #[test]
    fn other_lines_are_no_vertices() {
        assert_eq!(vertex("v 1 2.5 -3e1 0.5"), Some([1.0, 2.5, -30.0]));
        assert_eq!(vertex("vn 1 2 3"), None);
        assert_eq!(vertex("v 1 2"), None);
    }
}
