//! Transfer functions to begin with, fitted to the data.

use super::{ControlPoint, IsoValue, TransferFunction};
use crate::sources::Histogram;
use glam::Vec3;

/// A transfer function to begin with: its colours are given, where they lie follows from the histogram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Preset {
    /// From clear to white over the domain.
    Ramp,
    /// What lies above the background, faint to bright.
    Object,
    /// One level set, at the border of the background.
    Surface,
    /// Three level sets, each within the one before.
    Shells,
    /// A veil of violet with red, orange and white inside.
    Glow,
    /// Pale blue with bright cores.
    Mist,
    /// Bones, in Hounsfield units.
    CtBone,
    /// Skin, fat and organs over bones, in Hounsfield units.
    CtSoftTissue,
    /// The lungs and their airways, in Hounsfield units.
    CtLungs,
    /// Vessels with contrast agent, and bones, in Hounsfield units.
    CtVessels,
    /// Skin, brain and what is bright, of magnetic resonance.
    Mr,
}

/// The names of [`Preset::ALL`].
pub(super) const NAMES: [&str; 11] = {
    let mut names = [""; 11];
    let mut index = 0;
    while index < names.len() {
        names[index] = Preset::ALL[index].name();
        index += 1;
    }
    names
};

impl Preset {
    /// All of them, simple ones first.
    pub const ALL: [Self; 11] = [
        Self::Ramp,
        Self::Object,
        Self::Surface,
        Self::Shells,
        Self::Glow,
        Self::Mist,
        Self::CtBone,
        Self::CtSoftTissue,
        Self::CtLungs,
        Self::CtVessels,
        Self::Mr,
    ];

    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ramp => "Ramp",
            Self::Object => "Object",
            Self::Surface => "Surface",
            Self::Shells => "Shells",
            Self::Glow => "Glow",
            Self::Mist => "Mist",
            Self::CtBone => "CT bone",
            Self::CtSoftTissue => "CT soft tissue",
            Self::CtLungs => "CT lungs",
            Self::CtVessels => "CT vessels",
            Self::Mr => "MR",
        }
    }

    /// What it shows.
    pub fn description(self) -> &'static str {
        match self {
            Self::Ramp => "From clear to white over the domain",
            Self::Object => "What lies above the background, faint to bright",
            Self::Surface => "One level set, at the border of the background",
            Self::Shells => "Three level sets, each within the one before",
            Self::Glow => "A veil of violet with red, orange and white inside",
            Self::Mist => "Pale blue with bright cores",
            Self::CtBone => "Bones, in Hounsfield units",
            Self::CtSoftTissue => "Skin, fat and organs over bones, in Hounsfield units",
            Self::CtLungs => "The lungs and their airways, in Hounsfield units",
            Self::CtVessels => "Vessels with contrast agent, and bones, in Hounsfield units",
            Self::Mr => "Skin, brain and what is bright, of magnetic resonance",
        }
    }

    /// The data values that it is about, if it is in units.
    pub fn domain(self) -> Option<(f32, f32)> {
        match self {
            Self::CtBone | Self::CtSoftTissue | Self::CtLungs | Self::CtVessels => Some((-1024.0, 2048.0)),
            _ => None,
        }
    }

    /// `function` with the points and iso values of the preset, for data with this histogram; without one, for data that are spread evenly
    /// over `domain`.
    pub fn applied(
        self,
        function: &TransferFunction,
        histogram: Option<&Histogram>,
        domain: (f32, f32),
    ) -> TransferFunction {
        let [start, low, high, top] = landmarks(histogram, domain);
        let at = |value: f64, (r, g, b): (f32, f32, f32), opacity: f32| {
            let share = (value - f64::from(domain.0)) / (f64::from(domain.1) - f64::from(domain.0));
            let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
            ControlPoint((share * 1e4).round() as f32 / 1e4, Vec3::new(r, g, b), opacity)
        };
        let width = ((top - start) * 0.04).max(f64::from(f32::MIN_POSITIVE));
        let level = |value: f64, (r, g, b): (f32, f32, f32), absorption: f32| IsoValue {
            value: value as f32,
            width: width as f32,
            color: Vec3::new(r, g, b),
            absorption,
        };
        let middle = 0.5 * (start + low);
        // Of masked data the least values too are object.
        let is_masked = histogram.is_some_and(Histogram::is_masked);
        let from = |opacity: f32| if is_masked { opacity } else { 0.0 };
        let (points, iso) = match self {
            Self::Ramp => {
                (vec![ControlPoint(0.0, Vec3::ZERO, 0.0), ControlPoint(1.0, Vec3::ONE, 0.1)], Vec::new())
            }
            Self::Object => (
                vec![
                    at(start, (0.35, 0.25, 0.18), from(0.05)),
                    at(low, (0.80, 0.62, 0.45), 0.05),
                    at(high, (0.95, 0.90, 0.80), 0.3),
                    at(top, (1.0, 1.0, 1.0), 0.6),
                ],
                Vec::new(),
            ),
            // Ranges of tissues in Hounsfield units: Kalender, Computed Tomography (2011), fig. 1.9.
            Self::CtBone => (
                vec![
                    at(150.0, (0.55, 0.25, 0.15), 0.0),
                    at(300.0, (0.85, 0.65, 0.45), 0.1),
                    at(700.0, (0.95, 0.90, 0.78), 0.4),
                    at(1500.0, (1.0, 1.0, 0.96), 0.8),
                ],
                Vec::new(),
            ),
            Self::CtSoftTissue => (
                vec![
                    at(-250.0, (0.80, 0.55, 0.40), 0.0),
                    at(-100.0, (0.88, 0.68, 0.45), 0.03),
                    at(0.0, (0.75, 0.35, 0.25), 0.06),
                    at(80.0, (0.80, 0.40, 0.32), 0.12),
                    at(250.0, (0.92, 0.80, 0.65), 0.2),
                    at(1000.0, (1.0, 1.0, 0.95), 0.7),
                ],
                Vec::new(),
            ),
            Self::CtLungs => (
                vec![
                    at(-980.0, (0.30, 0.45, 0.70), 0.0),
                    at(-900.0, (0.45, 0.60, 0.85), 0.015),
                    at(-700.0, (0.85, 0.60, 0.55), 0.04),
                    at(-500.0, (0.90, 0.50, 0.45), 0.02),
                    at(-400.0, (0.90, 0.50, 0.45), 0.0),
                ],
                Vec::new(),
            ),
            Self::CtVessels => (
                vec![
                    at(130.0, (0.60, 0.08, 0.06), 0.0),
                    at(200.0, (0.80, 0.12, 0.08), 0.25),
                    at(400.0, (0.95, 0.35, 0.20), 0.5),
                    at(550.0, (0.95, 0.88, 0.75), 0.5),
                    at(1500.0, (1.0, 1.0, 0.96), 0.8),
                ],
                Vec::new(),
            ),
            Self::Mr => (
                vec![
                    at(start, (0.45, 0.22, 0.15), from(0.02)),
                    at(middle, (0.65, 0.42, 0.32), 0.02),
                    at(low, (0.80, 0.60, 0.50), 0.08),
                    at(high, (0.92, 0.84, 0.78), 0.35),
                    at(top, (1.0, 0.97, 0.90), 0.7),
                ],
                Vec::new(),
            ),
            Self::Surface => (Vec::new(), vec![level(middle, (0.90, 0.78, 0.60), 3.0)]),
            Self::Shells => (
                Vec::new(),
                vec![
                    level(middle, (0.25, 0.55, 0.95), 0.15),
                    level(low, (0.95, 0.75, 0.25), 0.5),
                    level(high, (0.95, 0.25, 0.20), 3.0),
                ],
            ),
            Self::Glow => (
                vec![
                    at(start, (0.25, 0.08, 0.60), from(0.02)),
                    at(middle, (0.45, 0.10, 0.85), 0.02),
                    at(low, (0.85, 0.08, 0.40), 0.08),
                    at(0.5 * (low + high), (1.00, 0.22, 0.05), 0.3),
                    at(high, (1.00, 0.55, 0.10), 0.7),
                    at(top, (1.00, 0.92, 0.60), 0.95),
                ],
                Vec::new(),
            ),
            Self::Mist => (
                vec![
                    at(start, (0.05, 0.25, 0.60), from(0.04)),
                    at(low, (0.20, 0.55, 0.90), 0.04),
                    at(high, (0.60, 0.88, 1.00), 0.25),
                    at(top, (0.92, 0.99, 1.00), 0.9),
                ],
                Vec::new(),
            ),
        };
        TransferFunction { preset: None, points, iso, labels: Vec::new(), ..function.clone() }
    }
}

/// Where the background ends, and the values that a quarter, nine tenths and all but a two-hundredth of what lies above it are below.
/// They rise, and lie within the domain.
fn landmarks(histogram: Option<&Histogram>, domain: (f32, f32)) -> [f64; 4] {
    let (first, last) = (f64::from(domain.0.min(domain.1)), f64::from(domain.0.max(domain.1)));
    let even = [0.15, 0.4, 0.7, 1.0].map(|share| first + share * (last - first));
    let Some(histogram) = histogram else { return even };
    let Some(border) = otsu(&histogram.bins) else { return even };
    let above: u64 = histogram.bins[border..].iter().sum();
    let value = |fraction: f64| {
        let wanted = fraction * above as f64;
        let mut passed = 0;
        let bin = (border..histogram.bins.len()).find(|bin| {
            passed += histogram.bins[*bin];
            passed as f64 >= wanted
        });
        f64::from(histogram.centre(bin.unwrap_or(border)))
    };
    let mut marks = [f64::from(histogram.centre(border)), value(0.25), value(0.9), value(0.995)];
    let mut least = first;
    let apart = (last - first) / 256.0;
    for (index, mark) in marks.iter_mut().enumerate() {
        *mark = mark.max(least).min(last - (3 - index) as f64 * apart);
        least = *mark + apart;
    }
    if marks.iter().all(|mark| mark.is_finite()) { marks } else { even }
}

/// The bin at which a histogram falls apart best into background and object (Otsu 1979): where the variance between both is greatest.
/// None where all samples are in one bin, or there are none.
fn otsu(bins: &[u64]) -> Option<usize> {
    let total: f64 = bins.iter().map(|bin| *bin as f64).sum();
    let sum: f64 = bins.iter().enumerate().map(|(index, bin)| index as f64 * *bin as f64).sum();
    let (mut below, mut sum_below) = (0.0, 0.0);
    let mut best = None;
    for (index, bin) in bins.iter().enumerate() {
        below += *bin as f64;
        sum_below += index as f64 * *bin as f64;
        let above = total - below;
        if below <= 0.0 || above <= 0.0 {
            continue;
        }
        let difference = sum_below / below - (sum - sum_below) / above;
        let between = below * above * difference * difference;
        if best.is_none_or(|(most, _)| between > most) {
            best = Some((between, index + 1));
        }
    }
    best.map(|(_, bin)| bin)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::components::Validate;
    use crate::sources::{Samples, VolumeData};

    fn histogram(samples: Vec<f32>) -> Histogram {
        let size = [samples.len() as u32, 1, 1];
        VolumeData::new(size, Vec3::ONE, Samples::F32(samples)).unwrap().histogram
    }

    #[test]
    fn of_masked_data_the_least_values_are_seen_too() {
        let values = |masked: usize| {
            let there = (0..1000).map(|index| 5.0 + (index / 10) as f32);
            there.chain(std::iter::repeat_n(f32::NAN, masked)).collect()
        };
        for preset in [Preset::Object, Preset::Mr, Preset::Glow, Preset::Mist] {
            let least = |masked| {
                let histogram = histogram(values(masked));
                preset.applied(&TransferFunction::default(), Some(&histogram), (5.0, 105.0)).points[0].2
            };
            assert_eq!(least(900), 0.0, "{preset:?}: a few samples are missing anywhere");
            assert!(least(1100) >= 0.02, "{preset:?}: {}", least(1100));
        }
    }

    #[test]
    fn the_background_is_left_out() {
        // Much air about 10, an object from 100 to 200.
        let air = (0..9000).map(|index| 10.0 + (index % 7) as f32);
        let object = (0..1000).map(|index| 100.0 + index as f32 / 10.0);
        let histogram = histogram(air.chain(object).collect());
        let function = Preset::Object.applied(&TransferFunction::default(), Some(&histogram), (0.0, 200.0));
        let start = function.points[0].0 * 200.0;
        assert!((17.0..=105.0).contains(&start), "{start}");
        assert_eq!(function.points[0].2, 0.0);
        let surface = Preset::Surface.applied(&function, Some(&histogram), (0.0, 200.0));
        assert!(surface.points.is_empty() && (17.0..130.0).contains(&surface.iso[0].value));
    }

    #[test]
    fn every_preset_is_right_for_any_data() {
        let nan = f32::NAN;
        let all = [
            None,
            Some(histogram(vec![5.0])),
            Some(histogram(vec![nan, nan])),
            Some(histogram(vec![0.0, 1.0])),
            Some(histogram(vec![-1e30, 0.0, 1e30])),
            Some(histogram((0..1000).map(|index| (index as f32).sin()).collect())),
        ];
        for histogram in &all {
            for domain in [(0.0, 1.0), (0.0, 255.0), (-1e30, 1e30), (5.0, 6.0), (1.0, 1.0)] {
                for preset in Preset::ALL {
                    let function = preset.applied(&TransferFunction::default(), histogram.as_ref(), domain);
                    assert_eq!(function.problems(), [], "{preset:?} {domain:?} {histogram:?}");
                    assert!(function.points.iter().all(|point| (0.0..=1.0).contains(&point.0)));
                    assert!(function.iso.iter().all(|iso| iso.width > 0.0 && iso.value.is_finite()));
                }
            }
        }
    }
}
