//! A folder of numbered pictures, TIFF, PNG or JPEG, one for each slice.

use std::{
    cmp::Ordering,
    fs,
    io::Read,
    path::{Path, PathBuf},
};

use glam::DVec3;
use image::{DynamicImage, ImageReader};

use super::{
    Selection, SourceError, VolumeData, file,
    grid::Grid,
    pick::PickReader,
    shape::{self, Side},
    stored::{Scaling, Stored},
    tiff, trail,
    volume::MAX_VOLUME_BYTES,
};

/// Entries of a folder that are looked at.
const MAX_ENTRIES: usize = 1 << 16;

/// More bytes than this for one of a file no picture unpacks to.
const MAX_UNPACKED: u64 = 1400;

/// A picture of one slice.
pub(super) struct Slice {
    /// Its axes, the fastest first: two of space, and the numbers of a pixel.
    pub sides: Vec<Side>,
    /// Whether the numbers of a pixel are a colour.
    pub is_colour: bool,
    /// Distance of pixels along x and y, mm, where the file says so.
    pub spacing: [Option<f64>; 2],
    /// All its numbers.
    pub samples: Stored,
}

/// The pictures of a folder in the order of their numbers; none where it holds other files as well, of which a reader of folders may
/// know more.
pub(super) fn pictures(folder: &Path) -> Option<Vec<PathBuf>> {
    let (mut pictures, mut others) = (Vec::new(), 0);
    for entry in fs::read_dir(folder).ok()?.take(MAX_ENTRIES) {
        let path = entry.ok()?.path();
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        let ending = name.rsplit('.').next().unwrap_or_default();
        match ending {
            _ if name.starts_with('.') || path.is_dir() => {}
            "tif" | "tiff" | "png" | "jpg" | "jpeg" => pictures.push(path),
            // What lies beside slices to describe them.
            "txt" | "csv" | "json" | "xml" | "ini" | "log" | "md" | "yml" | "yaml" | "db" | "ron" => {}
            _ => others += 1,
        }
    }
    pictures.sort_by(|a, b| in_order(&a.to_string_lossy(), &b.to_string_lossy()));
    (others == 0 && !pictures.is_empty()).then_some(pictures)
}

/// Whether a folder is listed as one volume: it holds several pictures and nothing else, none of which is a volume by itself.
pub(crate) fn is_stack(folder: &Path) -> bool {
    let is_slice = |path: &PathBuf| {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        !matches!(ending.as_deref(), Some("tif" | "tiff")) || tiff::is_one_page(path)
    };
    pictures(folder).is_some_and(|pictures| pictures.len() > 1 && is_slice(&pictures[0]))
}

/// Reads the pictures of a folder as the slices of a volume, the first as the lowest.
///
/// # Errors
///
/// If a picture cannot be read, or the folder holds no such component.
pub(super) fn read(
    folder: &Path,
    pictures: &[PathBuf],
    selection: &Selection,
) -> Result<VolumeData, SourceError> {
    trail::note(folder);
    let mut notes = Vec::new();
    let first = slice(&pictures[0])?;
    let alike =
        |slice: &Slice| slice.sides == first.sides && slice.samples.format() == first.samples.format();
    let mut stacked = Stack::default();
    // The first is the pattern of the others, and is read again as one of them.
    let sides = |slices: u64| first.sides.iter().cloned().chain([Side::space(slices)]).collect::<Vec<_>>();
    let choose = |slices, notes: &mut Vec<String>| {
        shape::choose(folder, &sides(slices), selection, first.is_colour, notes)
    };
    let pick = choose(1, &mut Vec::new())?.pick;
    let mut left_out = Vec::new();
    for path in pictures {
        let slice = slice(path)?;
        if alike(&slice) {
            let bytes = slice.samples.as_bytes();
            let mut kept = Vec::new();
            let read =
                PickReader::new(bytes, &pick, slice.samples.format().bytes(), 0).read_to_end(&mut kept);
            read.map_err(|cause| file::io_error(path, cause))?;
            stacked.add(folder, &slice, &kept)?;
        } else {
            left_out.push(path.file_name().unwrap_or_default().to_string_lossy().into_owned());
        }
    }
    if let Some(name) = left_out.first() {
        notes.push(format!("{} pictures of another size or kind are left out, as {name}", left_out.len()));
    }
    let chosen = choose(stacked.slices, &mut notes)?;
    let (format, [x, y]) = (first.samples.format(), first.spacing);
    let along_x = x.or(y).unwrap_or(1.0);
    notes.push(if x.is_none() {
        "they do not say how far apart voxels are; 1 mm is taken".to_owned()
    } else {
        "they do not say how far apart slices are; the distance of columns is taken".to_owned()
    });
    let axes = [DVec3::X * along_x, DVec3::Y * y.unwrap_or(along_x), DVec3::Z * along_x];
    let space = sides(stacked.slices).into_iter().filter(|side| side.role == shape::Role::Space);
    let size: Vec<u64> = space.map(|side| side.samples).collect();
    let grid = Grid::new(folder, &size, &axes, false, chosen.bytes(format))?;
    let samples = stacked.samples.unwrap_or_else(|| format.none());
    chosen.volume(&grid, folder, samples, &Scaling::NONE, notes)
}

/// What was read of the slices so far.
#[derive(Default)]
struct Stack {
    slices: u64,
    samples: Option<Stored>,
}

impl Stack {
    fn add(&mut self, folder: &Path, slice: &Slice, kept: &[u8]) -> Result<(), SourceError> {
        let samples = self.samples.get_or_insert_with(|| slice.samples.format().none());
        let bytes = samples.len() as u64 * samples.format().bytes() + kept.len() as u64;
        let out_of_memory = SourceError::OutOfMemory { path: folder.to_owned(), bytes };
        if bytes > MAX_VOLUME_BYTES {
            return Err(out_of_memory);
        }
        samples.append_bytes(kept).ok_or(out_of_memory)?;
        self.slices += 1;
        Ok(())
    }
}

/// Reads one picture.
fn slice(path: &Path) -> Result<Slice, SourceError> {
    let (mut file, bytes) = file::open(path)?;
    let mut head = Vec::new();
    (&mut file).take(4).read_to_end(&mut head).map_err(|cause| file::io_error(path, cause))?;
    if tiff::is_tiff(&head) {
        return tiff::read_slice(path);
    }
    let error = |cause: image::ImageError| SourceError::Unsupported {
        path: path.to_owned(),
        found: format!("it is no picture that can be read ({cause})"),
        mend: "fetch or export it again, or take it out of the folder".to_owned(),
    };
    let reader = ImageReader::open(path).and_then(ImageReader::with_guessed_format);
    let mut reader = reader.map_err(|cause| file::io_error(path, cause))?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(bytes.saturating_mul(MAX_UNPACKED));
    reader.limits(limits);
    let picture = reader.decode().map_err(error)?;
    let [x, y] = [picture.width(), picture.height()].map(|side| Side::space(side.into()));
    let channels = picture.color().channel_count();
    let samples = match picture {
        DynamicImage::ImageLuma8(pixels) => Stored::U8(pixels.into_raw()),
        DynamicImage::ImageLumaA8(pixels) => Stored::U8(pixels.into_raw()),
        DynamicImage::ImageRgb8(pixels) => Stored::U8(pixels.into_raw()),
        DynamicImage::ImageRgba8(pixels) => Stored::U8(pixels.into_raw()),
        DynamicImage::ImageLuma16(pixels) => Stored::U16(pixels.into_raw()),
        DynamicImage::ImageLumaA16(pixels) => Stored::U16(pixels.into_raw()),
        DynamicImage::ImageRgb16(pixels) => Stored::U16(pixels.into_raw()),
        DynamicImage::ImageRgba16(pixels) => Stored::U16(pixels.into_raw()),
        other => Stored::U8(other.into_rgba8().into_raw()),
    };
    let sides = vec![Side::components(channels.into(), "channels"), x, y];
    Ok(Slice { sides, is_colour: channels > 2, spacing: [None; 2], samples })
}

/// The order of names whose numbers count as numbers: `slice2` before `slice10`.
fn in_order(a: &str, b: &str) -> Ordering {
    let (mut a_rest, mut b_rest) = (a, b);
    loop {
        let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
        let (a_digits, b_digits) = (digits(a_rest), digits(b_rest));
        let order = if a_digits > 0 && b_digits > 0 {
            let number = |text: &str| text.trim_start_matches('0').to_owned();
            let (a_number, b_number) = (number(&a_rest[..a_digits]), number(&b_rest[..b_digits]));
            (a_rest, b_rest) = (&a_rest[a_digits..], &b_rest[b_digits..]);
            a_number.len().cmp(&b_number.len()).then(a_number.cmp(&b_number))
        } else {
            let (mut a_letters, mut b_letters) = (a_rest.chars(), b_rest.chars());
            let (a_letter, b_letter) = (a_letters.next(), b_letters.next());
            if a_letter.is_none() && b_letter.is_none() {
                return a.cmp(b);
            }
            (a_rest, b_rest) = (a_letters.as_str(), b_letters.as_str());
            a_letter.cmp(&b_letter)
        };
        if order != Ordering::Equal {
            return order;
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;
    use crate::sources::{Kind, Samples, read_volume, recognise, self_describing::tests::values};
    use glam::Vec3;

    #[test]
    fn numbers_in_names_count_as_numbers() {
        let mut names = ["s10.png", "s9.png", "s010.png", "a", "s1_2", "s1_10", "s"];
        names.sort_by(|a, b| in_order(a, b));
        assert_eq!(names, ["a", "s", "s1_2", "s1_10", "s9.png", "s010.png", "s10.png"]);
    }

    #[test]
    fn pictures_of_a_folder_are_slices() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let png = |name: &str, value: u16| {
            image::ImageBuffer::<image::Luma<u16>, _>::from_vec(2, 3, vec![value, 1, 2, 3, 4, 5])
                .unwrap()
                .save(at(name))
                .unwrap();
        };
        png("slice10.png", 1000);
        png("slice9.png", 900);
        fs::write(at("notes.txt"), "pixel 2 um").unwrap();
        let read = |component| read_volume(folder.path(), &Selection { component, ..Selection::default() });
        let volume = read(None).unwrap();
        assert_eq!((volume.size, volume.spacing), ([2, 3, 2], Vec3::ONE));
        assert_eq!((volume.sample([0, 0, 0]), volume.sample([0, 0, 1])), (Some(900.0), Some(1000.0)));
        assert!(volume.notes[0].contains("1 mm is taken"), "{:?}", volume.notes);
        image::RgbImage::new(2, 3).save(at("thumbnail.png")).unwrap();
        let volume = read(None).unwrap();
        assert!(
            volume.size[2] == 2 && volume.notes[0].ends_with("left out, as thumbnail.png"),
            "{:?}",
            volume.notes
        );
        for name in ["slice9.png", "slice10.png"] {
            fs::remove_file(at(name)).unwrap();
        }
        let colour = image::Rgb([1, 2, 3]);
        image::RgbImage::from_pixel(2, 3, colour).save(at("x1.png")).unwrap();
        let volume = read(None).unwrap();
        assert_eq!(volume.samples.len(), 12);
        assert!(matches!(&volume.samples, Samples::Rgba8(colours) if colours[11] == [1, 2, 3, 255]));
        assert_eq!(values(&read(Some(2)).unwrap())[6..], [3.0; 6]);
        fs::write(at("x2.png"), b"\x89PNG\r\n\x1a\nnothing").unwrap();
        assert!(read(None).unwrap_err().to_string().contains("no picture that can be read"));
        assert!(
            is_stack(folder.path()) && recognise(folder.path()) == Some(Kind::Volume { in_patient: false })
        );
        // A folder of something else as well is none of pictures.
        fs::write(at("other.bin"), "").unwrap();
        assert!(read(None).unwrap_err().to_string().contains("a folder without DICOM slices"));
        assert!(
            !is_stack(folder.path()) && recognise(folder.path()) == Some(Kind::Volume { in_patient: true })
        );
    }

    #[test]
    fn each_tiff_of_a_folder_is_one_slice() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, pages: u8| {
            let mut file = fs::File::create(folder.path().join(name)).unwrap();
            let mut encoder = ::tiff::encoder::TiffEncoder::new(&mut file).unwrap();
            for page in 0..pages {
                encoder.write_image::<::tiff::encoder::colortype::Gray8>(2, 1, &[page, pages]).unwrap();
            }
        };
        write("1.tif", 1);
        write("2.TIF", 1);
        let volume = read_volume(folder.path(), &Selection::default()).unwrap();
        assert_eq!((volume.size, values(&volume)), ([2, 1, 2], vec![0.0, 1.0, 0.0, 1.0]));
        assert!(is_stack(folder.path()));
        write("1.tif", 3);
        let text = read_volume(folder.path(), &Selection::default()).unwrap_err().to_string();
        assert!(text.contains("1.tif: it holds several pages") && !is_stack(folder.path()), "{text}");
    }
}
