//! Numbers as people drag and type them.

use crate::components::{Range, Slider};
use egui::{DragValue, Response, Ui, vec2};

/// How a number is shown and what it may become.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Numeric<'a> {
    /// What those hear who cannot see it: `Phong.shininess`.
    pub name: &'a str,
    /// What the number may be.
    pub range: Option<Range>,
    /// What a slider offers.
    pub slider: Option<Slider>,
    /// Whether it counts something.
    pub is_whole: bool,
    /// What stands in front of it.
    pub prefix: &'a str,
    /// How much a point of a drag changes, where range and slider do not say it.
    pub speed: Option<f64>,
}

/// Width of a number beside a slider.
const NUMBER_WIDTH: f32 = 64.0;

impl Numeric<'_> {
    /// The number, and in front of it a slider if there is room. Says what it became, if it was changed.
    pub fn show(self, ui: &mut Ui, value: f64, width: f32) -> (Response, Option<f64>) {
        let slider = self.slider.filter(|_| width >= 2.0 * NUMBER_WIDTH && value.is_finite());
        let Some(slider) = slider else { return self.number(ui, value, width) };
        let slid = self.slide(ui, slider, value, width - NUMBER_WIDTH - ui.spacing().item_spacing.x);
        let (response, typed) = self.number(ui, slid.unwrap_or(value), NUMBER_WIDTH);
        (response, typed.or(slid))
    }

    fn slide(self, ui: &mut Ui, slider: Slider, value: f64, width: f32) -> Option<f64> {
        let mut new = value;
        ui.spacing_mut().slider_width = width;
        let mut widget = egui::Slider::new(&mut new, slider.min..=slider.max)
            .show_value(false)
            .clamping(egui::SliderClamping::Never)
            .logarithmic(slider.is_logarithmic);
        if slider.is_logarithmic {
            widget = widget.smallest_positive(slider.min.max(f64::MIN_POSITIVE));
        }
        if self.is_whole {
            widget = widget.step_by(1.0);
        }
        let response = ui.add(widget);
        let _ = response.accessible_name(format!("{} slider", self.name));
        self.accepted(value, if self.is_whole { new } else { round_to_digits(new, 4) })
            .filter(|_| new != value)
    }

    /// The number alone.
    pub fn number(self, ui: &mut Ui, value: f64, width: f32) -> (Response, Option<f64>) {
        let mut new = value;
        let range = self.range.unwrap_or(Range::new(f64::MIN, f64::MAX));
        let digits = if width < NUMBER_WIDTH { 4 } else { 6 };
        let shown = short(if self.is_whole { value } else { round_to_digits(value, digits) });
        let widget = DragValue::new(&mut new)
            .speed(self.speed.unwrap_or_else(|| self.natural_speed(value)))
            .range(range.min..=range.max)
            .clamp_existing_to_range(false)
            .update_while_editing(false)
            .prefix(self.prefix)
            .max_decimals(if self.is_whole { 0 } else { 12 })
            .custom_formatter(move |number, _| {
                short(if self.is_whole { number } else { round_to_digits(number, digits) })
            })
            // What is shown rounded and left as it is, is not rounded.
            .custom_parser(move |typed| if typed == shown { Some(value) } else { parsed(typed) })
            .clip_text(true);
        let size = vec2(width, ui.spacing().interact_size.y);
        let response = ui
            .scope(|ui| {
                ui.spacing_mut().button_padding.x = 2.0;
                ui.add_sized(size, widget)
            })
            .inner;
        let response = response.accessible_name(self.name);
        (response, self.accepted(value, new))
    }

    /// What `value` becomes, if it may become that and does not stay as it is.
    fn accepted(self, value: f64, new: f64) -> Option<f64> {
        let new = if self.is_whole { new.round() } else { new };
        let is_allowed = new.is_finite() && self.range.is_none_or(|range| range.contains(new));
        (is_allowed && new != value).then_some(new)
    }

    /// How much a point of a drag changes: a share of the slider, or of the number itself.
    fn natural_speed(self, value: f64) -> f64 {
        let magnitude = if value.is_finite() { value.abs() } else { 1.0 };
        if self.is_whole {
            return (magnitude / 200.0).clamp(0.05, 1e6);
        }
        match self.slider {
            Some(slider) if !slider.is_logarithmic => (slider.max - slider.min) / 400.0,
            Some(slider) => (magnitude / 100.0).max(slider.min / 100.0),
            // Not slower near 0, where it would never arrive or leave, unless it may not get there.
            None if self.range.is_some_and(|range| range.above_min) => (magnitude / 100.0).max(1e-30),
            None => (magnitude / 100.0).max(0.01),
        }
    }
}

/// The number that a person typed, with a sign as some keyboards have it.
fn parsed(typed: &str) -> Option<f64> {
    let typed: String = typed.chars().filter(|letter| !letter.is_whitespace()).collect();
    typed.replace('\u{2212}', "-").parse().ok()
}

/// A number with the digits that 32 bits hold, and an exponent where it would be long.
pub(super) fn short(number: f64) -> String {
    let number = number as f32;
    if number != 0.0 && number.is_finite() && !(1e-4..1e7).contains(&number.abs()) {
        return format!("{number:e}");
    }
    number.to_string()
}

/// Rounded to so many digits that count.
pub(super) fn round_to_digits(number: f64, digits: i32) -> f64 {
    if number == 0.0 || !number.is_finite() {
        return number;
    }
    round_to(number, 10f64.powi(number.abs().log10().floor() as i32 + 1 - digits))
}

/// The nearest multiple of a power of ten that is at most `step`.
pub(super) fn round_to(number: f64, step: f64) -> f64 {
    let exponent = step.abs().log10().floor();
    if !exponent.is_finite() || exponent.abs() > 300.0 || !number.is_finite() {
        return number;
    }
    // By whole powers, so that what is divided by is exact and no digits come back.
    let power = 10f64.powi(exponent.abs() as i32);
    if exponent < 0.0 { (number * power).round() / power } else { (number / power).round() * power }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(f64::from(0.1_f32)), "0.1");
        assert_eq!(short(1.5e12), "1.5e12");
        assert_eq!(short(-2.5e-7), "-2.5e-7");
        assert_eq!((short(0.0), short(10_000.0)), ("0".into(), "10000".into()));
        assert_eq!(short(f64::NAN), "NaN");
    }

    #[test]
    fn rounding_keeps_what_counts() {
        assert_eq!(round_to_digits(0.012_345_678, 4), 0.01235);
        assert_eq!(round_to_digits(-98_765.0, 2), -99_000.0);
        assert_eq!(round_to(0.123_456, 0.001), 0.123);
        assert_eq!(round_to(1234.0, 100.0), 1200.0);
        assert!(round_to(f64::NAN, 0.1).is_nan() && round_to(5.0, 0.0) == 5.0);
    }

    #[test]
    fn what_is_not_allowed_is_not_accepted() {
        let positive = Numeric { range: Some(Range::positive()), ..Default::default() };
        assert_eq!(positive.accepted(1.0, 0.0), None);
        assert_eq!(positive.accepted(1.0, f64::NAN), None);
        assert_eq!(positive.accepted(1.0, 1.0), None);
        assert_eq!(positive.accepted(1.0, 0.5), Some(0.5));
        assert_eq!(Numeric { is_whole: true, ..Default::default() }.accepted(1.0, 2.4), Some(2.0));
        assert_eq!(Numeric::default().accepted(f64::NAN, f64::NAN), None);
    }
}
