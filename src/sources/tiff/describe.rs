//! How pages make a volume: what ImageJ and OME write into the description of the first, and the resolution that any program writes.

use super::{Page, ome};
use crate::sources::{nrrd, shape::Side};

/// Millimetres of an inch and a centimetre, the units of a resolution.
const INCH: f64 = 25.4;
const CENTIMETRE: f64 = 10.0;

/// What is known beside the pages themselves.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Description {
    /// The axes along which pages lie, the fastest first; together as many as there are pages.
    pub stack: Vec<Side>,
    /// Distance of voxels along x, y, z, mm, where it is written.
    pub spacing: [Option<f64>; 3],
    /// Where the samples of all pages begin, if they lie behind each other and only the first has a directory.
    pub contiguous: Option<u64>,
    /// The values to look at, if the file recommends any.
    pub window: Option<(f32, f32)>,
    /// What a person should know.
    pub notes: Vec<String>,
}

impl Description {
    /// What the first of so many pages says.
    pub fn of(page: &Page, pages: u64) -> Self {
        let text = &*page.description;
        let described = if text.starts_with("ImageJ=") {
            Some(Self::of_image_j(page, text, pages))
        } else {
            ome::described(text, pages)
        };
        let mut described = described.unwrap_or_default();
        let [x, y] = page.resolution_unit.map_or([None; 2], |unit| {
            let millimetres = if unit == 3 { CENTIMETRE } else { INCH };
            page.pixels_per_unit.map(|pixels| pixels.map(|pixels| millimetres / pixels))
        });
        let [own_x, own_y, z] = described.spacing;
        described.spacing = [own_x.or(x), own_y.or(y), z];
        if described.stack.is_empty() {
            described.stack = vec![Side::space(pages)];
        }
        if described.spacing.iter().all(Option::is_none) {
            described.notes.push("it does not say how far apart voxels are; 1 mm is taken".to_owned());
        } else if described.spacing[2].is_none() && pages > 1 {
            let note = "it does not say how far apart its pages are; the distance of its columns is taken";
            described.notes.push(note.to_owned());
        }
        described
    }

    /// Lines `name=value`, in which channels are fastest, then slices, then frames.
    fn of_image_j(page: &Page, text: &str, pages: u64) -> Self {
        let value = |name: &str| {
            text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('=')).map(str::trim)
        };
        let count =
            |name: &str| value(name).and_then(|value| value.parse().ok()).filter(|count: &u64| *count > 0);
        let number = |name: &str| {
            value(name).and_then(|value| value.parse().ok()).filter(|number: &f64| number.is_finite())
        };
        let images = count("images").unwrap_or(pages);
        // Only the first page has a directory, and what follows its samples are the others.
        let contiguous = page.plain_at.filter(|_| pages == 1 && images > 1);
        let there = if contiguous.is_some() { images } else { pages };
        let (channels, frames) = (count("channels").unwrap_or(1), count("frames").unwrap_or(1));
        let slices = count("slices").unwrap_or(if channels == 1 && frames == 1 { there } else { 1 });
        let fits = channels.checked_mul(slices).and_then(|images| images.checked_mul(frames)) == Some(there);
        let mut described = Self { contiguous, ..Self::default() };
        if !fits {
            described.stack = vec![Side::space(there)];
        } else if slices == 1 && frames > 1 {
            // Many pictures of one slice are more often a stack that says "frames" than a film.
            described.stack = vec![Side::components(channels, "channels"), Side::space(frames)];
            described.notes.push(format!("its {frames} frames are taken for slices"));
        } else {
            described.stack = vec![
                Side::components(channels, "channels"),
                Side::space(slices),
                Side::entries(frames, "frames"),
            ];
        }
        // Escaped as in Java.
        let unit = value("unit").unwrap_or("").replace("\\u00B5", "µ");
        let scale = nrrd::millimetres(&unit);
        described.spacing = [page.pixels_per_unit[0], page.pixels_per_unit[1], None]
            .map(|pixels| scale.zip(pixels).map(|(scale, pixels)| scale / pixels));
        let depth = number("spacing").map(f64::abs).filter(|depth| *depth > 0.0);
        described.spacing[2] = depth.zip(scale).map(|(depth, scale)| depth * scale);
        if scale.is_none() && depth.is_some() {
            // In pixels, or a unit of no length: at least the proportions are kept.
            let [x, y] = page.pixels_per_unit.map(|pixels| pixels.map_or(1.0, |pixels| 1.0 / pixels));
            described.spacing = [Some(x), Some(y), depth];
            described.notes.push("it does not say in what unit; millimetres are taken".to_owned());
        }
        described.window = number("min")
            .zip(number("max"))
            .filter(|(least, greatest)| least < greatest)
            .map(|(least, greatest)| (least as f32, greatest as f32));
        described
    }
}
