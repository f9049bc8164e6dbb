//! A transfer function as a table: colour and extinction by data value.

use crate::components::{ControlPoint, IsoValue, TransferFunction};
use glam::{DVec3, Vec4};

/// The greatest opacity that an extinction is derived from: one step of 32-bit floats below 1.
const MAX_OPACITY: f64 = 1.0 - 1.0 / (1u64 << 24) as f64;

/// A transfer function sampled evenly over its domain.
#[derive(Clone, Debug, PartialEq)]
pub struct LookupTable {
    /// Colour and extinction per scene unit of each entry; the first is at the lower end of the domain, the last at the upper.
    pub entries: Vec<Vec4>,
}

impl LookupTable {
    /// Samples `function` over `domain` (data values). `voxel` is the shortest spacing of the volume in millimetres, the default of
    /// `opacity_length`.
    pub fn new(
        function: &TransferFunction,
        domain: (f32, f32),
        voxel: f32,
        millimetres_per_unit: f32,
    ) -> Self {
        let length = f64::from(function.opacity_length.unwrap_or(voxel));
        let per_unit = f64::from(millimetres_per_unit) / length;
        let points = function.points_in_force();
        let last = f64::from(function.entries.max(2) - 1);
        let entries = (0..function.entries.max(2)).map(|index| {
            let position = f64::from(index) / last;
            let value = f64::from(domain.0) + position * (f64::from(domain.1) - f64::from(domain.0));
            let (colour, depth) = classify(&points, &function.iso, position, value);
            colour.as_vec3().extend((depth * per_unit).min(f64::from(f32::MAX)) as f32)
        });
        Self { entries: entries.collect() }
    }

    /// Place of a data value in the table, in entries, not clamped.
    pub fn position(&self, domain: (f32, f32), value: f32) -> f64 {
        (f64::from(value) - f64::from(domain.0)) / (f64::from(domain.1) - f64::from(domain.0))
            * (self.entries.len() - 1) as f64
    }

    /// Answers which stretches of the table absorb anything.
    pub fn holds_something(&self) -> Held {
        let mut before = vec![0u32];
        for entry in &self.entries {
            before.push(before[before.len() - 1] + u32::from(entry.w > 0.0));
        }
        Held { before }
    }
}

/// How many entries in front of each absorb something.
pub struct Held {
    before: Vec<u32>,
}

impl Held {
    /// Whether any value between two places of the table absorbs anything, those places and the entries around them included.
    pub fn between(&self, low: f64, high: f64) -> bool {
        if low.is_nan() || high < low {
            return false;
        }
        let last = self.before.len() - 2;
        let first = (low.floor().max(0.0) as usize).min(last);
        let end = (high.ceil().max(0.0) as usize).min(last);
        self.before[end + 1] > self.before[first]
    }
}

/// Colour and optical depth over `opacity_length` at a position 0..1 that has the data value `value`.
fn classify(points: &[ControlPoint], iso: &[IsoValue], position: f64, value: f64) -> (DVec3, f64) {
    let (mut colour, opacity) = interpolate(points, position);
    let mut depth = -(-opacity.clamp(0.0, MAX_OPACITY)).ln_1p();
    // Extinctions add; the colour is that of the mixture.
    let layers = iso.iter().map(|layer| {
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

/// 1 at 0, a half at a distance of half the width, 0 beyond the width.
fn tent(distance: f64, width: f64) -> f64 {
    (1.0 - distance.abs() / width).max(0.0)
}

/// Linear between points, constant beyond the first and last.
fn interpolate(points: &[ControlPoint], position: f64) -> (DVec3, f64) {
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
}
