//! The chosen point or iso value, and the domain, in numbers.

use super::super::colour::colour_button;
use super::super::icons::{Icon, icon_button};
use super::super::number::Numeric;
use super::super::rows::{Columns, label};
use super::handles::{between_neighbours, least_width};
use super::plot::Plot;
use super::shown::Shown;
use super::{Selected, TransferFunctionEditor};
use crate::components::{Auto, ControlPoint, IsoValue, Range, Slider};
use egui::text::{LayoutJob, TextFormat};
use egui::{FontId, RichText, TextStyle, Ui};
use glam::{Vec2, Vec3};

/// Rows of numbers that belong to one thing.
struct Rows {
    columns: Columns,
    /// What the numbers belong to: `Control point 2`.
    of: String,
}

impl Rows {
    fn row<R>(&self, ui: &mut Ui, text: &str, explanation: &str, value: impl FnOnce(&mut Ui) -> R) -> R {
        self.columns.row(ui, |ui| drop(label(ui, body(ui, text)).on_hover_text(explanation)), value, |_| {})
    }

    fn number(
        &self,
        ui: &mut Ui,
        name: &str,
        explanation: &str,
        value: f32,
        numeric: Numeric,
    ) -> Option<f32> {
        let full = format!("{} {name}", self.of);
        self.row(ui, name, explanation, |ui| {
            let (response, new) =
                Numeric { name: &full, ..numeric }.show(ui, f64::from(value), ui.available_width());
            response.on_hover_text(explanation);
            new.map(|new| new as f32)
        })
    }

    fn colour(&self, ui: &mut Ui, colour: Vec3) -> Option<Vec3> {
        let explanation = "emitted radiance at full opacity; where light is scattered, the albedo";
        self.row(ui, "colour", explanation, |ui| {
            let range = Range::non_negative();
            let (_, mut new) = colour_button(ui, &format!("{} colour", self.of), colour, Some(range));
            let width = (ui.available_width() - 2.0 * ui.spacing().item_spacing.x) / 3.0;
            for (index, part) in ["red", "green", "blue"].into_iter().enumerate() {
                let name = format!("{} {part}", self.of);
                let numeric =
                    Numeric { name: &name, range: Some(range), speed: Some(0.005), ..Default::default() };
                let (_, typed) = numeric.number(ui, f64::from(colour[index]), width);
                if let Some(typed) = typed {
                    let mut changed = new.unwrap_or(colour);
                    changed[index] = typed as f32;
                    new = Some(changed);
                }
            }
            new
        })
    }
}

fn body(ui: &Ui, text: &str) -> LayoutJob {
    let font_id = FontId::proportional(TextStyle::Body.resolve(ui.style()).size);
    let format = TextFormat { font_id, color: ui.visuals().text_color(), ..Default::default() };
    LayoutJob::single_section(text.to_owned(), format)
}

/// Opacities below a hundredth matter as much as those above.
const OPACITY: Slider = Slider::linear(0.0, 1.0);

impl TransferFunctionEditor {
    pub(super) fn details(&mut self, ui: &mut Ui, shown: &mut Shown, plot: &Plot) {
        self.heading(ui, shown);
        match self.selected {
            Some(Selected::Point(index)) => point(ui, shown, plot, index),
            Some(Selected::Iso(index)) => iso(ui, shown, plot, index),
            None => {
                let labels = shown.function.labels.len();
                let hint = match labels {
                    0 => "Click on the curve to add a control point, or choose one to change it.".to_owned(),
                    1 => "One label, and no curve. A control point or a preset takes its place.".to_owned(),
                    _ => format!(
                        "{labels} labels, and no curve. A control point or a preset takes their place."
                    ),
                };
                ui.label(RichText::new(hint).weak().small());
            }
        }
        domain(ui, shown);
    }

    /// Which one is chosen, with buttons that choose the next and delete it.
    fn heading(&mut self, ui: &mut Ui, shown: &mut Shown) {
        let points = shown.points.len();
        let all = points + shown.function.iso.len();
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            let place = match self.selected {
                Some(Selected::Point(index)) => Some(index),
                Some(Selected::Iso(index)) => Some(points + index),
                None => None,
            };
            let at = |place: usize| match place.checked_sub(points) {
                Some(iso) => Selected::Iso(iso),
                None => Selected::Point(place),
            };
            let before = icon_button(ui, Icon::Left, "Previous point");
            if before.clicked() && all > 0 {
                self.selected = Some(at(place.map_or(all - 1, |place| (place + all - 1) % all)));
            }
            if icon_button(ui, Icon::Right, "Next point").clicked() && all > 0 {
                self.selected = Some(at(place.map_or(0, |place| (place + 1) % all)));
            }
            ui.add_space(4.0);
            let text = match self.selected {
                Some(Selected::Point(index)) => format!("Control point {} of {points}", index + 1),
                Some(Selected::Iso(index)) => {
                    format!("Iso value {} of {}", index + 1, shown.function.iso.len())
                }
                None => "Nothing chosen".into(),
            };
            ui.label(RichText::new(text).strong());
            if let Some(selected) = self.selected {
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if icon_button(ui, Icon::Remove, "Delete it").clicked() {
                        self.delete(shown, selected);
                    }
                });
            }
        });
    }
}

fn point(ui: &mut Ui, shown: &mut Shown, plot: &Plot, index: usize) {
    let Some(old) = shown.points.get(index).copied() else { return };
    let rows = Rows { columns: Columns::of(ui), of: format!("Control point {}", index + 1) };
    let mut new = old;
    let value = plot.value(old.0) as f32;
    let numeric = Numeric { speed: Some(2.0 * plot.grain()), ..Default::default() };
    if let Some(value) = rows.number(ui, "value", "data value", value, numeric) {
        new.0 = plot.position(f64::from(value)) as f32;
    }
    let explanation = "the share of the light that a slab of opacity_length absorbs, 0 to 1";
    let numeric = Numeric { range: Some(Range::new(0.0, 1.0)), slider: Some(OPACITY), ..Default::default() };
    new.2 = rows.number(ui, "opacity", explanation, old.2, numeric).unwrap_or(old.2);
    new.1 = rows.colour(ui, old.1).unwrap_or(old.1);
    let new: ControlPoint = between_neighbours(&shown.points, index, new);
    shown.set_point(ui, index, (new != old && new.0.is_finite()).then_some(new));
}

fn iso(ui: &mut Ui, shown: &mut Shown, plot: &Plot, index: usize) {
    let Some(old) = shown.function.iso.get(index).copied() else { return };
    let rows = Rows { columns: Columns::of(ui), of: format!("Iso value {}", index + 1) };
    let speed = Some(2.0 * plot.grain());
    let value = rows.number(ui, "value", "data value", old.value, Numeric { speed, ..Default::default() });
    let least = least_width(shown, plot);
    let range = Some(Range::new(f64::from(least), f64::from(f32::MAX)));
    let explanation =
        "thickness of the layer at half its height, in data values; 0, with PreIntegrated, for a surface";
    let width =
        rows.number(ui, "width", explanation, old.width, Numeric { range, speed, ..Default::default() });
    let numeric = Numeric {
        range: Some(Range::non_negative()),
        slider: Some(Slider::logarithmic(0.01, 100.0)),
        ..Default::default()
    };
    let explanation = "peak optical depth over opacity_length; of a surface, that of each crossing";
    let absorption = rows.number(ui, "absorption", explanation, old.absorption, numeric);
    let color = rows.colour(ui, old.color);
    let new = IsoValue {
        value: value.unwrap_or(old.value),
        width: width.unwrap_or(old.width),
        absorption: absorption.unwrap_or(old.absorption),
        color: color.unwrap_or(old.color),
    };
    shown.set_iso(ui, index, (new != old).then_some(new).filter(|new| new.value.is_finite()));
}

/// The data values at positions 0 and 1.
fn domain(ui: &mut Ui, shown: &mut Shown) {
    let rows = Rows { columns: Columns::of(ui), of: "Domain".into() };
    let explanation =
        "the data values between which the function lies; auto: those of an integer format, or of the data";
    let (low, high) = shown.data.domain;
    let is_auto = shown.function.domain == Auto::Auto;
    let new = rows.row(ui, "domain", explanation, |ui| {
        let mut wants_auto = is_auto;
        ui.checkbox(&mut wants_auto, "auto").on_hover_text(explanation);
        let width = 0.5 * (ui.available_width() - ui.spacing().item_spacing.x);
        let speed = Some((f64::from(high) - f64::from(low)).abs() / 500.0);
        let mut ends = [None, None];
        ui.add_enabled_ui(!is_auto, |ui| {
            let least = [f64::from(f32::MIN), f64::from(low)];
            let most = [f64::from(high), f64::from(f32::MAX)];
            for (index, (end, name)) in [(low, "Domain from"), (high, "Domain to")].into_iter().enumerate() {
                let range = Some(Range::new(least[index], most[index]));
                let numeric = Numeric { name, range, speed, ..Default::default() };
                ends[index] = numeric.number(ui, f64::from(end), width).1.map(|end| end as f32);
            }
        });
        let changed = Vec2::new(ends[0].unwrap_or(low), ends[1].unwrap_or(high));
        match (wants_auto != is_auto, ends) {
            (true, _) if wants_auto => Some(Auto::Auto),
            (true, _) => Some(Auto::Value(Vec2::new(low, high))),
            (false, [None, None]) => None,
            // Nothing lies between two ends that are the same.
            (false, _) => Some(Auto::Value(changed)).filter(|_| changed.x < changed.y),
        }
    });
    shown.set_domain(ui, new);
}
