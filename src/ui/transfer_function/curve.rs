//! A transfer function as classification sees it.

use crate::components::{Auto, ControlPoint, TransferFunction};
use crate::optics::transfer::{LookupTable, interpolate};
use glam::Vec3;

/// What light meets at one data value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub value: f64,
    pub colour: Vec3,
    /// The share of the light that a slab of `opacity_length` absorbs.
    pub opacity: f32,
}

/// The samples of a transfer function, made again only when it changes.
#[derive(Clone, Debug, Default)]
pub(super) struct Curve {
    made_from: Option<(TransferFunction, (f32, f32))>,
    /// One for each entry of the lookup table, from the lower end of the domain.
    pub samples: Vec<Sample>,
    /// Surfaces without thickness.
    pub layers: Vec<Sample>,
}

impl Curve {
    /// Samples `function` over `domain`, by the table that volumes are drawn with.
    pub fn update(&mut self, function: &TransferFunction, domain: (f32, f32)) {
        if self.made_from.as_ref().is_some_and(|(old, of)| old == function && *of == domain) {
            return;
        }
        // With lengths of 1, a table holds the depth of `opacity_length`.
        let sampled = TransferFunction {
            opacity_length: Auto::Auto,
            points: in_order(function.points_in_force()),
            entries: function.entries.clamp(2, 8192),
            ..function.clone()
        };
        let table = LookupTable::new(&sampled, domain, 1.0, 1.0);
        let (low, high) = (f64::from(domain.0), f64::from(domain.1));
        let last = (table.entries.len() - 1) as f64;
        let value = |place: f64| low + (high - low) * place / last;
        let opacity = |depth: f32| -(-depth.max(0.0)).exp_m1();
        let sample = |(index, entry): (usize, &glam::Vec4)| Sample {
            value: value(index as f64),
            colour: entry.truncate(),
            opacity: opacity(entry.w),
        };
        self.samples = table.entries.iter().enumerate().map(sample).collect();
        self.layers = table
            .layers
            .iter()
            .map(|layer| Sample {
                value: value(layer.position),
                colour: layer.colour,
                opacity: opacity(layer.depth),
            })
            .collect();
        self.made_from = Some((function.clone(), domain));
    }

    /// What is sampled at a data value; what is outside the domain looks like its ends.
    pub fn at(&self, value: f64) -> Option<Sample> {
        let (first, last) = (self.samples.first()?, self.samples.last()?);
        let place = (value - first.value) / (last.value - first.value) * (self.samples.len() - 1) as f64;
        let place = if place.is_finite() { place.clamp(0.0, (self.samples.len() - 1) as f64) } else { 0.0 };
        let below = &self.samples[place as usize];
        let above = &self.samples[(place as usize + 1).min(self.samples.len() - 1)];
        let share = place.fract() as f32;
        Some(Sample {
            value,
            colour: below.colour.lerp(above.colour, share),
            opacity: below.opacity + share * (above.opacity - below.opacity),
        })
    }
}

/// The points that have numbers, which is all that can be drawn.
fn in_order(points: Vec<ControlPoint>) -> Vec<ControlPoint> {
    let mut points = points;
    points.retain(|point| point.0.is_finite() && point.1.is_finite() && point.2.is_finite());
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// A point on the lines between `points`, so that adding it changes nothing.
pub(super) fn between(points: &[ControlPoint], position: f64) -> ControlPoint {
    let (colour, opacity) = interpolate(points, position);
    ControlPoint(position as f32, colour.as_vec3(), opacity as f32)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::components::IsoValue;

    #[test]
    fn opacities_are_those_that_are_written() {
        let points = vec![ControlPoint(0.0, Vec3::ZERO, 0.2), ControlPoint(1.0, Vec3::ONE, 0.8)];
        let function = TransferFunction { points, opacity_length: Auto::Value(7.0), ..Default::default() };
        let mut curve = Curve::default();
        curve.update(&function, (0.0, 100.0));
        assert!((curve.at(0.0).unwrap().opacity - 0.2).abs() < 1e-6);
        assert!((curve.at(50.0).unwrap().opacity - 0.5).abs() < 1e-3);
        assert_eq!(curve.at(500.0).unwrap().opacity, curve.at(100.0).unwrap().opacity);
    }

    #[test]
    fn functions_that_no_scene_may_hold_are_sampled_too() {
        let nan = f32::NAN;
        let points = vec![
            ControlPoint(nan, Vec3::ONE, nan),
            ControlPoint(0.7, Vec3::ONE, 2.0),
            ControlPoint(0.2, Vec3::X, -1.0),
        ];
        let iso = vec![
            IsoValue { value: nan, width: nan, ..Default::default() },
            IsoValue { width: 0.0, ..Default::default() },
        ];
        for domain in [(0.0, 1.0), (5.0, 5.0), (nan, 1.0), (1.0, 0.0), (-1e30, 1e30)] {
            for entries in [0, 1, 2, u32::MAX] {
                let function = TransferFunction {
                    points: points.clone(),
                    iso: iso.clone(),
                    entries,
                    ..Default::default()
                };
                let mut curve = Curve::default();
                curve.update(&function, domain);
                assert!(curve.at(0.5).is_some() && curve.at(f64::NAN).is_some());
            }
        }
    }

    #[test]
    fn a_point_between_others_changes_nothing() {
        let points = [ControlPoint(0.0, Vec3::ZERO, 0.0), ControlPoint(0.5, Vec3::ONE, 0.4)];
        assert_eq!(between(&points, 0.25), ControlPoint(0.25, Vec3::splat(0.5), 0.2));
        assert_eq!(between(&[], 0.25), ControlPoint(0.25, Vec3::ZERO, 0.0));
    }
}
