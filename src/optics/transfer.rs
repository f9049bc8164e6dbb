//! A transfer function as a table: colour and extinction by data value.

use crate::components::{ControlPoint, IsoValue, LabelColour, TransferFunction};
use glam::{DVec3, Vec3, Vec4};

/// The greatest opacity that an extinction is derived from: one step of 32-bit floats below 1.
const MAX_OPACITY: f64 = 1.0 - 1.0 / (1u64 << 24) as f64;

/// A transfer function sampled evenly over its domain.
#[derive(Clone, Debug, PartialEq)]
pub struct LookupTable {
    /// Colour and extinction per scene unit of each entry; the first is at the lower end of the domain, the last at the upper.
    pub entries: Vec<Vec4>,
    /// Iso values of no width within the domain, by position.
    pub layers: Vec<Layer>,
    /// Whether each entry is a value of its own, with nothing between it and the next.
    pub is_exact: bool,
}

/// A surface without thickness. In a table it fills the cell between two entries that it lies in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Place in the table, in entries.
    pub position: f64,
    /// The entry below that place, never the last: the layer lies between it and the next.
    pub cell: usize,
    /// Emitted radiance at full opacity.
    pub colour: Vec3,
    /// Optical depth of a crossing.
    pub depth: f32,
}

impl LookupTable {
    /// Samples `function` over `domain` (data values); of labels, the domain is [`domain_of_labels`]. `voxel` is the shortest spacing of the volume in millimetres, the default of
    /// `opacity_length`.
    pub fn new(
        function: &TransferFunction,
        domain: (f32, f32),
        voxel: f32,
        millimetres_per_unit: f32,
    ) -> Self {
        let length = f64::from(function.opacity_length.unwrap_or(voxel));
        let per_unit = f64::from(millimetres_per_unit) / length;
        if let Some(domain) = domain_of_labels(&function.labels) {
            return Self::of_labels(&function.labels, domain, per_unit);
        }
        let points = function.points_in_force();
        let last = f64::from(function.entries.max(2) - 1);
        let entries = (0..function.entries.max(2)).map(|index| {
            let position = f64::from(index) / last;
            let value = f64::from(domain.0) + position * (f64::from(domain.1) - f64::from(domain.0));
            let (colour, depth) = classify(&points, &function.iso, position, value);
            colour.as_vec3().extend((depth * per_unit).min(f64::from(f32::MAX)) as f32)
        });
        let entries = entries.collect();
        let mut layers: Vec<Layer> = function.iso.iter().filter_map(|iso| layer(iso, domain, last)).collect();
        layers.sort_by(|a, b| a.position.total_cmp(&b.position));
        Self { entries, layers, is_exact: false }
    }

    /// An entry for each whole number of a domain.
    fn of_labels(labels: &[LabelColour], (low, high): (f32, f32), per_unit: f64) -> Self {
        let mut entries = vec![Vec4::ZERO; (high - low) as usize + 1];
        for label in labels {
            let depth = depth_of(f64::from(label.opacity)) * per_unit;
            if let Some(entry) = entries.get_mut((label.value as f32 - low) as usize) {
                *entry = label.color.extend(depth.min(f64::from(f32::MAX)) as f32);
            }
        }
        Self { entries, layers: Vec::new(), is_exact: true }
    }

    /// Place of a data value in the table, in entries, not clamped.
    pub fn position(&self, domain: (f32, f32), value: f32) -> f64 {
        (f64::from(value) - f64::from(domain.0)) / (f64::from(domain.1) - f64::from(domain.0))
            * (self.entries.len() - 1) as f64
    }

    /// Answers which stretches of the table absorb anything.
    pub fn holds_something(&self) -> Held {
        self.holds_above(0.0)
    }

    /// Answers which stretches of the table absorb as much as can be noticed beside the rest: a fiftieth of the greatest extinction.
    pub fn holds_noticeable(&self) -> Held {
        self.holds_above(self.entries.iter().map(|entry| entry.w).fold(0.0, f32::max) / 50.0)
    }

    fn holds_above(&self, least: f32) -> Held {
        let mut before = vec![0u32];
        for entry in &self.entries {
            before.push(before[before.len() - 1] + u32::from(entry.w > least));
        }
        let layers = self.layers.iter().filter(|layer| layer.depth > 0.0);
        Held { before, layers: layers.map(|layer| layer.cell as f64).collect() }
    }

    /// What has been passed up to each entry.
    pub fn cumulative(&self) -> Cumulative {
        let mut entries = Vec::with_capacity(self.entries.len());
        let (mut depth, mut layers) = (0.0, 0.0);
        for (index, entry) in self.entries.iter().enumerate() {
            let high = depth as f32;
            entries.push([high, (depth - f64::from(high)) as f32, layers as f32, entry.w]);
            let next = self.entries.get(index + 1).unwrap_or(entry).w;
            depth += 0.5 * (f64::from(entry.w) + f64::from(next));
            let here = self.layers.iter().filter(|layer| layer.cell == index);
            layers += here.map(|layer| f64::from(layer.depth)).sum::<f64>();
        }
        Cumulative { entries }
    }
}

/// The integral of a table's extinction from its lower end, from which the optical depth of any segment follows along which the value
/// changes evenly: `length (K(b) - K(a)) / (b - a) + |L(b) - L(a)|`, for values at the places a and b of the table, in entries.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cumulative {
    /// For each entry: K, extinction per scene unit integrated over places, and what rounding K to 32 bits left over; L, the depth of
    /// layers passed; the extinction. Texels of a texture as they are. Between entries L is linear, and K grows by
    /// `t (sigma + t/2 (next sigma - sigma))`. Differences of K and of its rest are taken each for itself: the sum of both is exact to 48
    /// bits of the greatest K.
    pub entries: Vec<[f32; 4]>,
}

impl Cumulative {
    /// Optical depth of a segment of `length` scene units whose value goes evenly from place `front` to place `back`, in entries. Places
    /// outside the table count as its ends.
    pub fn depth(&self, front: f64, back: f64, length: f64) -> f64 {
        let (front, back) = (self.at(front), self.at(back));
        let across = back.place - front.place;
        let mean = if across.abs() > 1e-6 {
            (back.depth - front.depth) / across
        } else {
            0.5 * (front.extinction + back.extinction)
        };
        length * mean.max(0.0) + (back.layers - front.layers).abs()
    }

    fn at(&self, place: f64) -> Passed {
        let last = self.entries.len().saturating_sub(1);
        let place = place.clamp(0.0, last as f64);
        let below = (place as usize).min(last.saturating_sub(1));
        let part = place - below as f64;
        let [low, high] = [below, (below + 1).min(last)].map(|entry| self.entries[entry].map(f64::from));
        let rise = high[3] - low[3];
        Passed {
            place,
            depth: low[0] + low[1] + part * (low[3] + 0.5 * part * rise),
            layers: low[2] + part * (high[2] - low[2]),
            extinction: low[3] + part * rise,
        }
    }
}

/// [`Cumulative`] at one place.
struct Passed {
    place: f64,
    depth: f64,
    layers: f64,
    extinction: f64,
}

/// The layer of an iso value without width, if it has none and lies within the domain.
fn layer(iso: &IsoValue, domain: (f32, f32), last: f64) -> Option<Layer> {
    let (low, high) = (f64::from(domain.0), f64::from(domain.1));
    let position = (f64::from(iso.value) - low) / (high - low) * last;
    let within = iso.width == 0.0 && (0.0..=last).contains(&position);
    within.then(|| Layer {
        position,
        cell: position.min(last - 1.0) as usize,
        colour: iso.color,
        depth: iso.absorption,
    })
}

/// How many entries in front of each absorb something, and the cells in which there is a layer.
pub struct Held {
    before: Vec<u32>,
    layers: Vec<f64>,
}

impl Held {
    /// Whether anything between two places of the table absorbs, those places and the entries around them included.
    pub fn between(&self, low: f64, high: f64) -> bool {
        if low.is_nan() || high < low {
            return false;
        }
        let last = self.before.len() - 2;
        let first = (low.floor().max(0.0) as usize).min(last);
        let end = (high.ceil().max(0.0) as usize).min(last);
        // A layer is met by those who cross it, or part of its cell.
        self.before[end + 1] > self.before[first]
            || self.layers.iter().any(|cell| low < cell + 1.0 && high > *cell && low < high)
    }
}

/// Colour and optical depth over `opacity_length` at a position 0..1 that has the data value `value`.
fn classify(points: &[ControlPoint], iso: &[IsoValue], position: f64, value: f64) -> (DVec3, f64) {
    let (mut colour, opacity) = interpolate(points, position);
    let mut depth = depth_of(opacity);
    // Extinctions add; the colour is that of the mixture.
    let layers = iso.iter().filter(|layer| layer.width > 0.0).map(|layer| {
        (
            layer.color.as_dvec3(),
            tent(value - f64::from(layer.value), f64::from(layer.width)) * f64::from(layer.absorption),
        )
    });
    for (layer_colour, layer_depth) in layers.filter(|(_, depth)| *depth > 0.0) {
        colour = (colour * depth + layer_colour * layer_depth) / (depth + layer_depth);
        depth += layer_depth;
    }
    (colour, depth)
}

/// Optical depth of a slab that absorbs a share of the light.
fn depth_of(opacity: f64) -> f64 {
    -(-opacity.clamp(0.0, MAX_OPACITY)).ln_1p()
}

/// The values at the ends of the table of labels, one beyond the least and the greatest, so that whatever lies outside is clear; `None` where
/// there is no label.
pub fn domain_of_labels(labels: &[LabelColour]) -> Option<(f32, f32)> {
    let least = labels.iter().map(|label| label.value).min()?;
    let greatest = labels.iter().map(|label| label.value).max()?;
    Some(domain_around(least, greatest))
}

/// The same for labels from one value to another.
pub fn domain_around(least: i32, greatest: i32) -> (f32, f32) {
    ((least - 1) as f32, (greatest + 1) as f32)
}

/// 1 at 0, a half at a distance of half the width, 0 beyond the width.
fn tent(distance: f64, width: f64) -> f64 {
    (1.0 - distance.abs() / width).max(0.0)
}

/// Colour and opacity at a position 0..1: linear between points, constant beyond the first and last; nothing where there are none.
pub fn interpolate(points: &[ControlPoint], position: f64) -> (DVec3, f64) {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return (DVec3::ZERO, 0.0) };
    let at = |point: &ControlPoint| (point.1.as_dvec3(), f64::from(point.2));
    if position <= f64::from(first.0) {
        return at(first);
    }
    let Some(pair) = points.windows(2).find(|pair| position <= f64::from(pair[1].0)) else { return at(last) };
    let (start, end) = (f64::from(pair[0].0), f64::from(pair[1].0));
    let share = if end > start { (position - start) / (end - start) } else { 1.0 };
    let ((from_colour, from), (to_colour, to)) = (at(&pair[0]), at(&pair[1]));
    (from_colour.lerp(to_colour, share), from + (to - from) * share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::Auto;
    use glam::Vec3;

    fn ramp() -> TransferFunction {
        let points = vec![ControlPoint(0.25, Vec3::ZERO, 0.0), ControlPoint(0.75, Vec3::ONE, 0.5)];
        TransferFunction { points, entries: 5, opacity_length: Auto::Value(2.0), ..Default::default() }
    }

    #[test]
    fn extinction_follows_from_opacity_and_its_length() {
        let table = LookupTable::new(&ramp(), (0.0, 100.0), 1.0, 10.0);
        // Opacity 0.5 over 2 mm is ln 2 / 2 per mm, and a scene unit has 10 of them.
        assert!((table.entries[3].w - std::f32::consts::LN_2 / 2.0 * 10.0).abs() < 1e-5);
        assert_eq!(table.entries[0], Vec4::ZERO);
        assert!((table.entries[2].x - 0.5).abs() < 1e-6);
    }

    #[test]
    fn opacity_one_stays_finite() {
        let function = TransferFunction {
            points: vec![ControlPoint(0.0, Vec3::ONE, 1.0)],
            opacity_length: Auto::Value(1e-6),
            ..ramp()
        };
        let table = LookupTable::new(&function, (0.0, 1.0), 1.0, 1.0);
        assert!(table.entries.iter().all(|entry| entry.is_finite() && entry.w > 1e6));
    }

    #[test]
    fn iso_values_add_extinction_and_mix_colours() {
        let layer = |value, color| IsoValue { value, width: 30.0, color, absorption: 1.0 };
        let function = TransferFunction {
            points: Vec::new(),
            iso: vec![layer(50.0, Vec3::X), layer(50.0, Vec3::Y)],
            ..ramp()
        };
        let table = LookupTable::new(&function, (0.0, 100.0), 1.0, 2.0);
        assert_eq!(table.entries[2], Vec4::new(0.5, 0.5, 0.0, 2.0));
        assert_eq!(table.entries[0].w, 0.0);
    }

    #[test]
    fn stretches_without_absorption_are_known() {
        let held = LookupTable::new(&ramp(), (0.0, 100.0), 1.0, 1.0).holds_something();
        assert!(!held.between(0.0, 1.0));
        assert!(held.between(0.0, 1.5));
        assert!(held.between(2.0, 2.0));
        assert!(!held.between(f64::INFINITY, f64::NEG_INFINITY));
    }
    #[test]
    fn the_integral_of_any_stretch_is_that_of_its_parts() {
        let mut function = ramp();
        function.iso = vec![IsoValue { value: 40.0, width: 0.0, absorption: 2.0, ..Default::default() }];
        let table = LookupTable::new(&function, (0.0, 100.0), 1.0, 10.0);
        assert_eq!((table.layers.len(), table.layers[0].cell), (1, 1));
        let passed = table.cumulative();
        // The layer fills the cell from 1 to 2; a length of 1 for each entry.
        let depth = |front: f64, back: f64| passed.depth(front, back, (back - front).abs());
        let whole = depth(0.0, 4.0);
        assert!(
            (whole
                - (2.0 + table.entries.iter().map(|entry| f64::from(entry.w)).sum::<f64>()
                    - f64::from(table.entries[4].w) / 2.0))
                .abs()
                < 1e-6
        );
        for middle in [0.3, 1.25, 2.0, 3.9] {
            assert!((depth(0.0, middle) + depth(middle, 4.0) - whole).abs() < 1e-9);
            assert!((depth(4.0, middle) + depth(middle, 0.0) - whole).abs() < 1e-9);
        }
        let flat = passed.depth(2.5, 2.5, 3.0);
        assert!((flat - 1.5 * f64::from(table.entries[2].w + table.entries[3].w)).abs() < 1e-6);
        assert!((passed.depth(-7.0, 1.0, 1.0) - passed.depth(0.0, 1.0, 1.0)).abs() < 1e-12);
    }

    #[test]
    fn each_label_has_an_entry_of_its_own() {
        let label = |value, opacity| LabelColour { value, opacity, color: Vec3::X, ..Default::default() };
        let labels = vec![label(65_535, 0.5), label(-3, 1.0), label(2, 0.0)];
        let function = TransferFunction { labels, ..Default::default() };
        let domain = domain_of_labels(&function.labels).unwrap_or_default();
        let table = LookupTable::new(&function, domain, 2.0, 10.0);
        assert!(table.is_exact && domain == (-4.0, 65_536.0));
        for value in [-4, -3, -2, 2, 3, 65_534, 65_535, 65_536] {
            let place = table.position(domain, value as f32);
            assert_eq!(place, f64::from(value) + 4.0);
            let held = table.holds_something().between(place, place);
            assert_eq!(held, [-3, 65_535].contains(&value), "{value}");
        }
        assert!((table.entries[65_539].w - std::f32::consts::LN_2 * 5.0).abs() < 1e-5);
        assert_eq!(table.entries[6].truncate(), Vec3::X);
        assert_eq!(domain_of_labels(&[]), None);
    }

    #[test]
    fn a_layer_is_met_by_what_crosses_it() {
        let mut function = ramp();
        function.points.clear();
        function.iso = vec![IsoValue { value: 40.0, width: 0.0, ..Default::default() }];
        let held = LookupTable::new(&function, (0.0, 100.0), 1.0, 1.0).holds_something();
        assert!(held.between(0.0, 4.0) && held.between(1.9, 3.0) && held.between(0.5, 1.1));
        assert!(!held.between(0.0, 1.0) && !held.between(2.0, 4.0) && !held.between(1.5, 1.5));
    }
}
