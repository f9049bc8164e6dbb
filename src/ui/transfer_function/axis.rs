//! The data values that a panel shows, and where.

use super::super::number::short;
use egui::Rangef;

/// A stretch of data values. Low is below high, both are finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    pub low: f64,
    pub high: f64,
}

impl Stretch {
    /// From `low` to `high`, or around them where that is no stretch.
    pub fn new(low: f64, high: f64) -> Self {
        let bounded = |value: f64| if value.is_finite() { value.clamp(-1e38, 1e38) } else { 0.0 };
        let (low, high) = (bounded(low.min(high)), bounded(low.max(high)));
        if high - low > Self::least_width(low, high) {
            return Self { low, high };
        }
        let half = 0.5 * low.abs().max(1.0);
        Self { low: low - half, high: high + half }
    }

    /// What can still be told apart by 32-bit floats, a few hundred steps of it.
    fn least_width(low: f64, high: f64) -> f64 {
        (low.abs().max(high.abs()) * 1e-5).max(1e-30)
    }

    pub fn width(self) -> f64 {
        self.high - self.low
    }

    pub fn contains(self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    pub fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Where a value is drawn; outside of `across` for values outside.
    pub fn x(self, across: Rangef, value: f64) -> f32 {
        let share = ((value - self.low) / self.width()).clamp(-10.0, 11.0);
        across.min + share as f32 * across.span()
    }

    /// The value that is drawn at a place.
    pub fn value(self, across: Rangef, x: f32) -> f64 {
        self.low + f64::from((x - across.min) / across.span().max(1e-3)) * self.width()
    }

    /// A stretch `factor` as wide, with `value` at the same place. At most that much wider than `whole`, and not narrower than what can be
    /// told apart.
    pub fn zoomed(self, value: f64, factor: f64, whole: Self) -> Self {
        let factor = if factor.is_finite() { factor } else { 1.0 };
        let least = 4.0 * Self::least_width(self.low, self.high);
        let width = (self.width() * factor).clamp(least, (3.0 * whole.width()).max(least));
        let share = ((value - self.low) / self.width()).clamp(0.0, 1.0);
        Self::new(value - share * width, value + (1.0 - share) * width).near(whole)
    }

    /// Moved by so many values.
    pub fn moved(self, by: f64, whole: Self) -> Self {
        let by = if by.is_finite() { by } else { 0.0 };
        Self { low: self.low + by, high: self.high + by }.near(whole)
    }

    /// Moved so that its middle lies in `whole`: there is nothing farther out.
    fn near(self, whole: Self) -> Self {
        let middle = 0.5 * (self.low + self.high);
        let by = middle.clamp(whole.low, whole.high) - middle;
        Self { low: self.low + by, high: self.high + by }
    }

    /// Round values within it, at most so many, and how each is written.
    pub fn ticks(self, most: usize) -> Vec<(f64, String)> {
        let rough = self.width() / most.max(1) as f64;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * power).find(|step| *step >= rough);
        let Some(step) = step.filter(|step| step.is_normal()) else { return Vec::new() };
        let first = (self.low / step).ceil();
        let ticks = (0..=most).map(|index| (first + index as f64) * step);
        let rounded = |value: f64| {
            if value.abs() < 0.5 * step { 0.0 } else { super::super::number::round_to(value, 0.1 * step) }
        };
        ticks.map(rounded).filter(|value| self.contains(*value)).map(|value| (value, short(value))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        let written = |low, high, most| {
            Stretch::new(low, high).ticks(most).into_iter().map(|tick| tick.1).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(written(0.0, 255.0, 6), "0 50 100 150 200 250");
        assert_eq!(written(-1.0, 1.0, 5), "-1 -0.5 0 0.5 1");
        assert_eq!(written(0.1, 0.4, 4), "0.1 0.2 0.3 0.4");
        assert!(written(-1e38, 1e38, 5).contains('0'));
        assert_eq!(written(0.0, 1.0, 0), "0");
    }

    #[test]
    fn a_stretch_is_never_empty() {
        for (low, high) in
            [(3.0, 3.0), (f64::NAN, 1.0), (f64::NEG_INFINITY, f64::INFINITY), (1e30, 1e30), (0.0, 0.0)]
        {
            let stretch = Stretch::new(low, high);
            assert!(stretch.high > stretch.low && stretch.width().is_finite(), "{stretch:?}");
            assert!(stretch.x(Rangef::new(0.0, 100.0), 3.0).is_finite());
        }
        assert_eq!(Stretch::new(5.0, 2.0), Stretch { low: 2.0, high: 5.0 });
    }

    #[test]
    fn zooming_keeps_what_is_under_the_pointer() {
        let whole = Stretch::new(0.0, 100.0);
        let zoomed = whole.zoomed(25.0, 0.5, whole);
        assert_eq!(zoomed, Stretch { low: 12.5, high: 62.5 });
        let mut out = whole;
        for _ in 0..100 {
            out = out.zoomed(10.0, 2.0, whole);
        }
        assert!(out.width() <= 300.0 && out.contains(10.0));
        let mut deep = whole;
        for _ in 0..1000 {
            deep = deep.zoomed(40.0, 0.5, whole);
        }
        assert!(deep.width() > 0.0 && (deep.low - 40.0).abs() < 0.1);
        assert!(whole.moved(1e9, whole).low <= 50.0);
    }
}
