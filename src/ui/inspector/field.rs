//! What is known about the field that a value stands in.

use crate::components::{Direction, Label, NameOf, Names, Range, Rgb, Slider, Unit};
use bevy_reflect::attributes::CustomAttributes;
use bevy_reflect::{NamedField, Reflect, UnnamedField};
use egui::text::{LayoutJob, TextFormat};
use egui::{FontId, TextStyle, Ui};

/// The field that a value stands in, or what takes its place: an item of a list, the whole component.
#[derive(Clone, Default)]
pub(super) struct Field {
    /// What it is called.
    pub label: String,
    /// The documentation of the field.
    pub docs: Option<&'static str>,
    /// The attributes of the field, and of the one around it where that is written without a step between: an `Option`, an `Auto`.
    attributes: [Option<&'static CustomAttributes>; 2],
}

impl Field {
    /// What takes the place of a field where there is none: the value is all there is.
    pub fn whole(label: &str) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    pub fn named(field: &'static NamedField) -> Self {
        let attributes = [Some(field.custom_attributes()), None];
        Self { label: field.name().into(), docs: field.docs(), attributes }
    }

    pub fn unnamed(field: &'static UnnamedField) -> Self {
        let attributes = field.custom_attributes();
        let label =
            attributes.get::<Label>().map_or_else(|| field.index().to_string(), |label| label.0.into());
        Self { label, docs: field.docs(), attributes: [Some(attributes), None] }
    }

    /// The field inside a variant that holds one value and is no step of a path: what `self` says holds for it too.
    pub fn inside(&self, field: &'static UnnamedField) -> Self {
        Self {
            attributes: [Some(field.custom_attributes()), self.attributes[0].or(self.attributes[1])],
            ..self.clone()
        }
    }

    /// An item of a list: what the field of the list allows, its items may be.
    pub fn item(&self, index: usize) -> Self {
        Self { label: index.to_string(), ..self.clone() }
    }

    fn get<T: Reflect>(&self) -> Option<&'static T> {
        self.attributes.iter().flatten().find_map(|attributes| attributes.get())
    }

    pub fn range(&self) -> Option<Range> {
        self.get().copied()
    }

    pub fn slider(&self) -> Option<Slider> {
        self.get().copied().or_else(|| self.range().and_then(slider_over))
    }

    pub fn unit(&self) -> Option<&'static str> {
        self.get::<Unit>().map(|unit| unit.0)
    }

    pub fn names(&self) -> Option<Names> {
        self.get().copied()
    }

    pub fn name_of(&self) -> Option<&'static str> {
        self.get::<NameOf>().map(|name| name.0)
    }

    pub fn rgb(&self) -> Option<Rgb> {
        self.get().copied()
    }

    pub fn is_direction(&self) -> bool {
        self.get::<Direction>().is_some()
    }

    /// The label with the unit behind it.
    pub fn text(&self, ui: &Ui) -> LayoutJob {
        let body = FontId::proportional(ui.text_style_height(&TextStyle::Body) * 0.8);
        let format = |color| TextFormat { font_id: body.clone(), color, ..Default::default() };
        let mut job = LayoutJob::default();
        job.append(&self.label, 0.0, format(ui.visuals().text_color()));
        if let Some(unit) = self.unit() {
            job.append(&format!(" {unit}"), 2.0, format(ui.visuals().weak_text_color()));
        }
        job
    }

    /// Meaning, unit and range, for a tooltip and for those who listen.
    pub fn explanation(&self, default: Option<&str>) -> String {
        let mut lines = vec![self.docs.map(plain).unwrap_or_default()];
        let bounds = [self.unit().map(str::to_owned), self.range().map(|range| range.to_string())];
        lines.push(bounds.into_iter().flatten().collect::<Vec<_>>().join(", "));
        lines.extend(default.map(|default| format!("default {default}")));
        lines.retain(|line| !line.is_empty());
        lines.join("\n")
    }
}

/// A slider over a range that has two ends, in decades where it spans three and more.
fn slider_over(range: Range) -> Option<Slider> {
    let is_bounded = range.min > f64::from(f32::MIN) && range.max < f64::from(u32::MAX);
    let spans_decades = range.min > 0.0 && range.max / range.min >= 1e3;
    is_bounded.then_some(Slider { min: range.min, max: range.max, is_logarithmic: spans_decades })
}

/// The first paragraph of documentation as a person reads it: without marks for links and code.
pub(super) fn plain(docs: &str) -> String {
    let paragraph = docs.trim().lines().map(str::trim).take_while(|line| !line.is_empty());
    let text = paragraph.collect::<Vec<_>>().join(" ");
    let mut plain = String::new();
    let mut rest = text.as_str();
    while let Some(at) = rest.find(['`', '[', ']', '*']) {
        plain.push_str(&rest[..at]);
        let is_closing = rest[at..].starts_with(']');
        rest = &rest[at + 1..];
        // The target of a link.
        if is_closing && rest.starts_with('(') {
            rest = rest.find(')').map_or("", |end| &rest[end + 1..]);
        }
    }
    plain.push_str(rest);
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn documentation_reads_without_marks() {
        let docs = " The look while [`Shading`](super::Shading) is `Local`:\n *all* of it.\n\n # More";
        assert_eq!(plain(docs), "The look while Shading is Local: all of it.");
        assert_eq!(plain(""), "");
        assert_eq!(plain("open [link](never"), "open link");
    }

    #[test]
    fn ranges_without_ends_have_no_slider() {
        assert_eq!(slider_over(Range::non_negative()), None);
        assert_eq!(slider_over(Range::positive()), None);
        assert_eq!(slider_over(Range::new(0.0, 1.0)), Some(Slider::linear(0.0, 1.0)));
        assert_eq!(slider_over(Range::new(1e-2, 1e2)), Some(Slider::logarithmic(1e-2, 1e2)));
    }
}
