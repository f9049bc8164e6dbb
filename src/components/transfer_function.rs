mod preset;

pub use preset::Preset;

use super::{
    AlsoCalled, Auto, Label, Names, Range, Rgb, Shorthand, Slider, Unit, Validate,
    attributes::{ReflectValidate, in_ron},
};
use crate::sources::Histogram;
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::{Vec2, Vec3};

/// What the values of a volume look like: colour and opacity of each.
///
/// | field | type | unit | range | default |
/// |---|---|---|---|---|
/// | `preset` | a name of the table below, or `None` | – | – | `None` |
/// | `domain` | `Auto` or (low, high) | data values | low below high | `Auto`: that of a preset in units; or what the file recommends (DICOM's window, NIfTI's `cal_min` and `cal_max`); or the range of the data, without fill values and extremes that would stretch it to more than twice its length |
/// | `points` | list of (position, (r, g, b), opacity) | position 0..1 in the domain | sorted; opacity 0 to 1 | a ramp from clear to white |
/// | `iso` | list of (value, width, color, absorption) | data values; per `opacity_length` | – | none |
/// | `labels` | list of (value, color, opacity, name) | data values | whole, -32,768 to 65,535; each once | none |
/// | `entries` | entries of the lookup table | – | 2 to 8,192; to 1,024 where `PreIntegrated` | 1024 |
/// | `classification` | `Post`, `Pre` or `PreIntegrated` | – | – | `Post` |
/// | `opacity_length` | `Auto` or a length | mm | above 0 | `Auto`: one voxel of the shortest spacing |
///
/// `TransferFunction: Preset("Object")` stands for `(preset: "Object")`. A preset takes the place of
/// `points` and `iso`:
///
/// | preset | shows |
/// |---|---|
/// | `Ramp` | from clear to white over the domain |
/// | `Object` | what lies above the background, faint to bright; of a label map, each label in a colour of its own |
/// | `Surface`, `Shells` | one level set at the border of the background; three, each within the one before |
/// | `Glow`, `Mist` | a veil of violet with red, orange and white inside; pale blue with bright cores |
/// | `CT bone`, `CT soft tissue`, `CT lungs`, `CT vessels` | of computed tomography, in Hounsfield units |
/// | `MR` | skin, brain and what is bright in magnetic resonance, by the data's own distribution |
///
/// Between points colour and opacity are linear; beyond the first and last they are constant. An opacity holds over
/// `opacity_length`: a slab of that thickness absorbs this share, whatever the step of the ray is. So the extinction per millimetre
/// is -ln(1 - opacity) / opacity_length; an opacity of 1 counts as one minus 2^-24.
///
/// Each `iso` value adds a tent of extinction `absorption` / `opacity_length` at its peak that is `width` wide at half its height.
/// Where several overlap, or lie over `points`, extinctions add and colours mix in proportion to them. With `iso` and no `points`
/// written, the points are left out.
///
/// A `width` of 0, which only `PreIntegrated` can show, makes a surface of the level set: each crossing has the optical depth
/// `absorption`, however steep the field is there and however long a step the ray takes. It is seen wherever the ends of a segment lie on
/// different sides of `value`, and is as exact in place as one entry of the table. Outside the domain there is none.
///
/// # Labels
///
/// Where the values of a volume name what is there, as in a segmentation, no value lies between two others. `labels` says what each looks like;
/// with any, they are the whole function: values that are not listed are clear, `points` and `iso` are to be empty, `domain` and `entries` play no
/// part, and voxels are not mixed whatever `Volume` and `classification` say. A label map (see [`Volume`](super::Volume)) whose function has none of
/// `domain`, `points`, `iso`, `labels` and no preset but `Object` has the colours of its file, where there are any, and else a palette by value; label 0 is clear.
///
/// # Colours
///
/// Where the data are colours (`Rgba8`), the function is applied to their luminance, 0 to 255, and says their opacity alone: a place shows the colour of
/// the data, and its extinction is that of the function times the opacity of the data. Colours of `points` and `iso` that are written multiply those of the
/// data; without any, and with a preset, they are white. With `PreIntegrated` the colour of a segment is the mean of its ends.
///
/// # Classification
///
/// A ray cuts a volume into segments. They differ in what is made of one:
///
/// | | a segment shows | cost | wrong where |
/// |---|---|---|---|
/// | `Post` | the function at the value in its middle | a table | the function is narrower than the values that a step passes |
/// | `PreIntegrated` | all values between those at its ends, passed evenly, each hiding those behind it | a table of `entries` squared, 16 bytes each (16 MiB at 1024), made again when the function, its domain or the length of the step changes | the field bends within a step |
/// | `Pre` | the function at the voxels, interpolated | 8 bytes a voxel, made again when the function or the data changes | voxels are coarser than what is shown: edges follow them |
///
/// `PreIntegrated` (Engel, Kraus and Ertl 2001) takes values beyond the domain for its ends, and its table is for segments of `RayCast.step`;
/// where a segment is cut short by the end of the volume or a mesh its depth is exact and its colour that of a whole one.
/// `Pre` interpolates extinction and colour times extinction, so what is clear has no colour to bleed; both have 11 bits, over a range of
/// 1 to 10^-7 of their greatest. It is the oldest of the three, and there to compare with. Where a volume's `interpolation` is `Nearest` there is
/// nothing between voxels, and all three show the same: the function at each voxel.
///
/// Like every component it can be kept in a file of its own: `TransferFunction: File("transfer_functions/bone.ron")`.
///
/// ```ron
/// TransferFunction: (domain: (0.0, 255.0), points: [(0.0, (0.0, 0.0, 0.0), 0.0), (1.0, (0.9, 0.8, 0.6), 0.6)])
/// TransferFunction: Preset("CT bone")
/// TransferFunction: (iso: [(value: 0.0, width: 0.02, color: (1.0, 0.8, 0.0), absorption: 1.0)])
/// TransferFunction: (iso: [(value: 0.0, width: 0.0, absorption: 3.0)], classification: PreIntegrated)
/// TransferFunction: (labels: [(value: 2, color: (0.8, 0.1, 0.1), name: "liver"), (value: 7, color: (0.9, 0.8, 0.6), opacity: 0.2)])
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq, Validate)]
#[reflect(@AlsoCalled(&["ColorMap", "ColourMap", "LookupTable", "Lut", "OpacityMap", "Palette", "Tf"]))]
pub struct TransferFunction {
    /// A built-in function that follows the data, in place of `points` and `iso`.
    #[reflect(@Shorthand("Preset"), @Names { of: "preset", known: &preset::NAMES })]
    pub preset: Option<String>,
    /// The data values at positions 0 and 1.
    #[reflect(@Unit("data values"))]
    pub domain: Auto<Vec2>,
    /// Colour and opacity at some positions.
    pub points: Vec<ControlPoint>,
    /// Level sets shown on top.
    pub iso: Vec<IsoValue>,
    /// What each value looks like where values are labels; the whole function where there are any.
    pub labels: Vec<LabelColour>,
    /// Entries of the lookup table.
    #[reflect(@Range::new(2.0, 8192.0), @Slider::logarithmic(16.0, 8192.0))]
    pub entries: u32,
    /// When the function is applied.
    pub classification: Classification,
    /// The thickness over which an opacity holds.
    #[reflect(@Range::positive(), @Slider::logarithmic(1e-3, 1e3), @Unit("mm"))]
    pub opacity_length: Auto<f32>,
}

impl Default for TransferFunction {
    fn default() -> Self {
        Self {
            preset: None,
            domain: Auto::Auto,
            points: Vec::new(),
            iso: Vec::new(),
            labels: Vec::new(),
            entries: 1024,
            classification: Classification::Post,
            opacity_length: Auto::Auto,
        }
    }
}

impl TransferFunction {
    /// The function with the points and iso values of its preset, if it has one, for data with this histogram.
    pub fn in_force(&self, histogram: Option<&Histogram>, domain: (f32, f32)) -> Self {
        match self.preset() {
            Some(preset) => preset.applied(self, histogram, domain),
            None => self.clone(),
        }
    }

    /// The preset, if it has one that is known.
    pub fn preset(&self) -> Option<Preset> {
        let name = self.preset.as_deref()?;
        Preset::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// The data values that its preset is about, if that is in units.
    pub fn preset_domain(&self) -> Option<(f32, f32)> {
        self.preset()?.domain()
    }

    /// Whether nothing says what single values look like: then those of a label map have a colour each.
    pub fn leaves_labels_alone(&self) -> bool {
        let is_general = |preset: &String| preset == Preset::Object.name();
        self.domain == Auto::Auto
            && self.preset.as_ref().is_none_or(is_general)
            && self.points.is_empty()
            && self.iso.is_empty()
            && self.labels.is_empty()
    }

    /// Whether it says no colour itself, be it because a preset does, which suits greys.
    pub fn colours_are_unwritten(&self) -> bool {
        self.preset.is_some() || (self.points.is_empty() && self.iso.is_empty() && self.labels.is_empty())
    }

    /// The same opacities, in white.
    pub fn in_white(&self) -> Self {
        let white = |point: ControlPoint| ControlPoint(point.0, Vec3::ONE, point.2);
        Self {
            points: self.points_in_force().into_iter().map(white).collect(),
            iso: self.iso.iter().map(|iso| IsoValue { color: Vec3::ONE, ..*iso }).collect(),
            ..self.clone()
        }
    }

    /// The points in force: those written, or a ramp from clear to white where neither points nor iso values nor labels are.
    pub fn points_in_force(&self) -> Vec<ControlPoint> {
        if !self.points.is_empty() || !self.iso.is_empty() || !self.labels.is_empty() {
            return self.points.clone();
        }
        vec![ControlPoint(0.0, Vec3::ZERO, 0.0), ControlPoint(1.0, Vec3::ONE, 0.1)]
    }
}

impl TransferFunction {
    /// What is wrong with labels, if anything is.
    fn problem_of_labels(&self) -> Option<String> {
        let others = [
            ("preset", self.preset.is_some()),
            ("points", !self.points.is_empty()),
            ("iso", !self.iso.is_empty()),
        ];
        if let Some((other, _)) = others.iter().find(|(_, is_written)| *is_written && !self.labels.is_empty())
        {
            return Some(format!("labels are a whole function; leave out `{other}`, or the labels"));
        }
        let mut values: Vec<i32> = self.labels.iter().map(|label| label.value).collect();
        values.sort_unstable();
        let twice = values.windows(2).find(|pair| pair[0] == pair[1])?;
        Some(format!("each label stands once, found {} twice", twice[0]))
    }
}

impl Validate for TransferFunction {
    fn problems(&self) -> Vec<(&'static str, String)> {
        let mut problems = Vec::new();
        if let Auto::Value(domain) = self.domain
            && domain.x >= domain.y
        {
            problems.push((
                "domain",
                format!("a domain goes from a lower to a higher value, found {}", in_ron(&domain.to_array())),
            ));
        }
        if let Some(pair) = self.points.windows(2).find(|pair| pair[0].0 > pair[1].0) {
            problems.push((
                "points",
                format!("points must be sorted by position, found {} after {}", pair[1].0, pair[0].0),
            ));
        }
        problems.extend(self.problem_of_labels().map(|problem| ("labels", problem)));
        let pre_integrated = self.classification == Classification::PreIntegrated;
        if pre_integrated && self.entries > Classification::MOST_ENTRIES {
            problems.push((
                "entries",
                format!(
                    "with `PreIntegrated` at most {} entries are allowed, since its table has their square; found {}",
                    Classification::MOST_ENTRIES,
                    self.entries
                ),
            ));
        }
        if !pre_integrated && self.iso.iter().any(|iso| iso.width == 0.0) {
            problems.push((
                "iso",
                format!(
                    "samples would miss an iso value of width 0; write `classification: PreIntegrated`, or a width above 0; found `{:?}`",
                    self.classification
                ),
            ));
        }
        problems
    }
}

/// Position (0 to 1 in the domain), colour (RGB, emitted radiance at full opacity) and opacity (0 to 1).
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, PartialEq)]
pub struct ControlPoint(
    /// Place in the domain, from its lower end to its upper.
    #[reflect(@Range::new(0.0, 1.0), @Label("position"))]
    pub f32,
    /// Emitted radiance at full opacity.
    #[reflect(@Range::non_negative(), @Rgb::Colour, @Label("colour"))]
    pub Vec3,
    /// The share of the light that a slab of `opacity_length` absorbs.
    #[reflect(@Range::new(0.0, 1.0), @Label("opacity"))]
    pub f32,
);

/// A level set of the field, shown as a thin layer.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, PartialEq)]
pub struct IsoValue {
    /// The level.
    #[reflect(@Unit("data values"))]
    pub value: f32,
    /// Thickness of the layer at half its height; 0, with `PreIntegrated`, for a surface.
    #[reflect(@Range::non_negative(), @Unit("data values"))]
    pub width: f32,
    /// Emitted radiance at full opacity.
    #[reflect(@Range::non_negative(), @Rgb::Colour)]
    pub color: Vec3,
    /// Peak optical depth over `opacity_length`; of a surface of width 0, that of each crossing.
    #[reflect(@Range::non_negative(), @Slider::logarithmic(0.01, 100.0), @Unit("optical depth"))]
    pub absorption: f32,
}

impl Default for IsoValue {
    fn default() -> Self {
        Self { value: 0.0, width: 0.02, color: Vec3::new(1.0, 0.8, 0.0), absorption: 1.0 }
    }
}

/// What a value looks like that names something.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, PartialEq)]
pub struct LabelColour {
    /// The value of its voxels.
    #[reflect(@Range::new(LabelColour::LEAST as f64, LabelColour::GREATEST as f64), @Unit("data values"))]
    pub value: i32,
    /// Emitted radiance at full opacity.
    #[reflect(@Range::non_negative(), @Rgb::Colour)]
    pub color: Vec3,
    /// The share of the light that a slab of `opacity_length` absorbs.
    #[reflect(@Range::new(0.0, 1.0))]
    pub opacity: f32,
    /// What it is, for people.
    pub name: String,
}

impl LabelColour {
    /// The least value that can have a colour.
    pub const LEAST: i32 = -32_768;
    /// The greatest value that can have a colour.
    pub const GREATEST: i32 = 65_535;
}

impl Default for LabelColour {
    fn default() -> Self {
        Self { value: 1, color: Vec3::ONE, opacity: 1.0, name: String::new() }
    }
}

/// When the transfer function is applied.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, PartialEq)]
pub enum Classification {
    /// To the interpolated value at each sample.
    #[default]
    Post,
    /// To the voxels, before their colours and extinctions are interpolated.
    Pre,
    /// To all values between those at the ends of each segment of a ray.
    PreIntegrated,
}

impl Classification {
    /// The most entries of a function that is `PreIntegrated`.
    pub const MOST_ENTRIES: u32 = 1024;
}
