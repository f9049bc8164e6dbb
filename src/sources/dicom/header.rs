//! What the elements of a DICOM file say of it and of its frames.

use std::path::Path;

use super::{
    SourceError,
    attributes::{Attributes, always_matters, pair},
    elements::{Element, Elements},
    image::Image,
    palette::Palette,
    segments::Segments,
    syntax::Syntax,
    tags::{self, is_pixels},
    values::{Unreadable, numbers, shorts, text, whole},
};

/// Frames of one file whose places are kept.
pub(super) const MAX_FRAMES: usize = 1 << 16;

/// Elements of one file that could not be understood and are kept to be told.
const MAX_UNREADABLE: usize = 8;

/// What a volume needs to know of a file.
#[derive(Debug, Clone)]
pub(super) struct Header {
    /// How the file is written.
    pub syntax: Syntax,
    /// How its pixels are stored.
    pub image: Image,
    /// Images in the file.
    pub frames: usize,
    /// What is said of all frames.
    pub all: Attributes,
    /// What is said of the first detector that the frames come from.
    detector: Attributes,
    /// What is said of each, as far as it is.
    per_frame: Vec<Attributes>,
    /// Distance of pixel centres on the detector or the film, mm, and which.
    pub other_spacing: Option<([f64; 2], u32)>,
    /// How much higher a pixel is than wide: two numbers of any unit.
    pub aspect: Option<[f64; 2]>,
    /// Places of the frames along their normal, mm.
    pub offsets: Vec<f64>,
    /// The slice that each frame is of, counted from 1.
    pub slice_vector: Vec<u16>,
    /// What a dose is multiplied by.
    dose_scaling: Option<f64>,
    /// Where the slice says it is along its normal, mm.
    pub location: Option<f64>,
    /// Colours of the values.
    pub palette: Palette,
    /// Parts of the body that frames are masks of.
    pub segments: Segments,
    /// The series that it belongs to: its UID, its number and what people call it.
    pub series: String,
    /// The number of the series.
    pub series_number: String,
    /// What people call it.
    pub description: String,
    /// CT, MR, …
    pub modality: String,
    /// The number of the acquisition, and the number in the series.
    pub number: [i64; 2],
    /// Whether a table changes its values, which is not applied.
    pub has_modality_table: bool,
    /// What could not be understood and may not matter.
    pub unreadable: Vec<Unreadable>,
    /// Where frames begin, where the file has a table of it.
    pub extended_offsets: Vec<u8>,
}

impl Header {
    /// Reads a file up to its pixels.
    pub fn read(path: &Path) -> Result<Self, SourceError> {
        Self::read_up_to_pixels(path).map(|(header, ..)| header)
    }

    /// Also gives what is next to be read: the pixels, and the element that they are.
    pub fn read_up_to_pixels(path: &Path) -> Result<(Self, Elements, Element), SourceError> {
        let mut elements = Elements::open(path)?;
        let mut header = Self::empty(elements.syntax.clone());
        while let Some(element) = elements.next()? {
            if is_pixels(element.tag) {
                header.image.is_float = element.tag != tags::PIXELS;
                header.image.complete(path)?;
                header.check_frames(path)?;
                return Ok((header, elements, element));
            }
            match header.element(&element) {
                Err(problem) if always_matters(problem.tag) => return Err(field(path, &problem)),
                Err(problem) if header.unreadable.len() < MAX_UNREADABLE => header.unreadable.push(problem),
                _ => {}
            }
        }
        Err(unsupported(path, "a DICOM file without pixels", "name one with an image in it"))
    }

    fn empty(syntax: Syntax) -> Self {
        Self {
            syntax,
            image: Image::default(),
            frames: 1,
            all: Attributes::default(),
            detector: Attributes::default(),
            per_frame: Vec::new(),
            other_spacing: None,
            aspect: None,
            offsets: Vec::new(),
            slice_vector: Vec::new(),
            dose_scaling: None,
            location: None,
            palette: Palette::default(),
            segments: Segments::default(),
            series: String::new(),
            series_number: String::new(),
            description: String::new(),
            modality: String::new(),
            number: [0; 2],
            has_modality_table: false,
            unreadable: Vec::new(),
            extended_offsets: Vec::new(),
        }
    }

    fn element(&mut self, element: &Element) -> Result<(), Unreadable> {
        let big = self.syntax.big_endian;
        match (element.root, element.parent) {
            (None, _) => self.of_file(element),
            (Some((tags::SHARED_GROUPS, _)), Some(parent)) if is_of_frames(parent) => {
                self.all.element(element, big)
            }
            (Some((tags::FRAME_GROUPS, frame)), Some(parent))
                if is_of_frames(parent) && frame < MAX_FRAMES =>
            {
                if self.per_frame.len() <= frame {
                    self.per_frame.resize(frame + 1, Attributes::default());
                }
                self.per_frame[frame].element(element, big)
            }
            (Some((tags::DETECTOR, 0)), Some(tags::DETECTOR)) => self.detector.element(element, big),
            (Some((tags::SEGMENTS, item)), Some(tags::SEGMENTS)) => self.segments.element(item, element, big),
            // Other sequences tell of other images.
            _ => Ok(()),
        }
    }

    fn of_file(&mut self, element: &Element) -> Result<(), Unreadable> {
        let big = self.syntax.big_endian;
        let value = &element.value;
        let text = || text(value);
        match element.tag {
            tags::DESCRIPTION => self.description = text(),
            tags::SERIES => self.series = text(),
            tags::SERIES_NUMBER => self.series_number = text(),
            tags::MODALITY => self.modality = text(),
            tags::ACQUISITION => self.number[0] = whole(element, big)?.unwrap_or(0),
            tags::INSTANCE => self.number[1] = whole(element, big)?.unwrap_or(0),
            // The distance on the detector, where that in the patient is not known.
            tags::IMAGER_SPACING => self.other_spacing = pair(element, big)?.map(|pair| (pair, element.tag)),
            tags::SCANNED_SPACING => {
                let scanned = pair(element, big)?.map(|pair| (pair, element.tag));
                self.other_spacing = self.other_spacing.or(scanned);
            }
            tags::ASPECT => self.aspect = pair(element, big)?,
            tags::SLICE_LOCATION => {
                self.location = numbers(element, big)?.and_then(|all| all.first().copied());
            }
            tags::FRAMES => self.frames = usize::try_from(whole(element, big)?.unwrap_or(1)).unwrap_or(0),
            tags::OFFSETS => self.offsets = numbers(element, big)?.unwrap_or_default(),
            tags::SLICE_VECTOR => self.slice_vector = shorts(value, big),
            tags::DOSE_SCALING => {
                self.dose_scaling = numbers(element, big)?.and_then(|all| all.first().copied());
            }
            tags::MODALITY_LUT => self.has_modality_table = true,
            tags::EXTENDED_OFFSETS => self.extended_offsets = value.clone(),
            tags::SEGMENTATION | tags::GREATEST_FRACTION => self.segments.of_file(element, big),
            tags::RED_LAYOUT..=tags::BLUE => self.palette.element(element, big),
            tags::CHANNELS..=tags::COLUMNS | tags::BITS..=tags::SIGNED => self.image.element(element, big),
            _ => {}
        }
        self.all.element(element, big)
    }

    fn check_frames(&self, path: &Path) -> Result<(), SourceError> {
        if (1..=MAX_FRAMES).contains(&self.frames) {
            return Ok(());
        }
        Err(SourceError::Field {
            path: path.to_owned(),
            field: tags::called(tags::FRAMES),
            problem: format!("{} frames; expected 1 to {MAX_FRAMES}", self.frames),
        })
    }

    /// What is known of a frame.
    pub fn frame(&self, frame: usize) -> Attributes {
        let all = self.all.or(&self.detector);
        match self.per_frame.get(frame) {
            Some(own) => own.or(&all),
            None => all,
        }
    }

    /// Whether each frame says for itself where it is.
    pub fn places_each_frame(&self) -> bool {
        self.per_frame.len() >= self.frames
            && self.per_frame[..self.frames].iter().all(|frame| frame.position.is_some())
    }

    /// Slope and intercept of a frame.
    pub fn scale(&self, frame: usize) -> [f64; 2] {
        let attributes = self.frame(frame);
        let slope = self.dose_scaling.or(attributes.slope).filter(|slope| *slope != 0.0);
        [slope.unwrap_or(1.0), attributes.intercept.unwrap_or(0.0)]
    }

    /// Refuses to go on without an element that is there and cannot be understood.
    pub fn needs(&self, path: &Path, tags: &[u32]) -> Result<(), SourceError> {
        match self.unreadable.iter().find(|problem| tags.contains(&problem.tag)) {
            Some(problem) => Err(field(path, problem)),
            None => Ok(()),
        }
    }
}

/// The sequences that tell of frames.
fn is_of_frames(parent: u32) -> bool {
    matches!(
        parent,
        tags::FRAME_CONTENT
            | tags::PLANE_POSITION
            | tags::PLANE_ORIENTATION
            | tags::PIXEL_MEASURES
            | tags::FRAME_VOI
            | tags::PIXEL_VALUES
            | tags::SEGMENT_OF_FRAME
    )
}

fn field(path: &Path, problem: &Unreadable) -> SourceError {
    SourceError::Field { path: path.to_owned(), field: problem.field(), problem: problem.problem.clone() }
}

/// The error for what is no image that makes a volume.
pub(super) fn unsupported(path: &Path, found: &str, mend: &str) -> SourceError {
    SourceError::Unsupported { path: path.to_owned(), found: found.to_owned(), mend: mend.to_owned() }
}
