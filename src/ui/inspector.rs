//! The inspector: rows for the values of a component, made from its reflection.
//!
//! It knows no component. What is registered for reflection can be changed here, those of plugins too: numbers with sliders where their
//! fields have a [`Range`](crate::components::Range) or a [`Slider`](crate::components::Slider), colours where they are
//! [`Rgb`](crate::components::Rgb), variants of enums with their defaults, lists, names, paths. The documentation of a field is its
//! tooltip. What would break a component, by its [`Validate`](crate::components::Validate), is held back until the rest of the change
//! makes it right.

mod choice;
mod defaults;
mod draft;
mod field;
mod leaf;
mod leaves;
mod list;
mod text;
mod walk;

use super::edited::Edited;
use super::icons::{Icon, icon_button};
use super::rows::{self, Columns};
use bevy_reflect::{PartialReflect, Reflect, ReflectRef, TypeRegistry, std_traits::ReflectDefault};
use draft::{Draft, Outcome};
use egui::{Frame, Id, RichText, Ui};
use glam::Quat;
use std::path::Path;
use walk::Walk;

/// What an inspector wants to know of the scene around a component.
pub struct InspectorContext<'a> {
    /// The names of the entities that have a component, by its short type name: what fields with
    /// [`NameOf`](crate::components::NameOf) choose from.
    pub entities_with: &'a dyn Fn(&str) -> Vec<String>,
    /// The folder that paths start at which have none yet: that of the scene.
    pub folder: &'a Path,
    /// How the view is turned: takes directions in the scene to those in eye space. Directions are shown in it.
    pub eye_from_scene: Quat,
}

/// Shows the values of a component of the entity `entity` under a heading. Says what was changed; the component itself stays as it is, and
/// is to be given with the changes the next time.
///
/// Several values may change at once: one that was being typed is complete when another is clicked.
pub fn inspect(
    ui: &mut Ui,
    entity: &str,
    component: &dyn Reflect,
    registry: &TypeRegistry,
    context: &InspectorContext,
) -> Vec<Edited> {
    let name = component.reflect_short_type_path().to_owned();
    let id = Id::unique(("inspector", entity, component.reflect_type_path()));
    ui.push_id(id, |ui| {
        ui.spacing_mut().item_spacing.y = 3.0;
        let docs = component.get_represented_type_info().and_then(|info| info.docs());
        ui.add_space(2.0);
        let (response, is_open) = heading(ui, id, &name);
        if let Some(docs) = docs {
            walk::explain(response, &field::plain(docs));
        }
        if is_open { rows(ui, id, &name, component, registry, context) } else { Vec::new() }
    })
    .inner
}

/// The name of a component, over the width of the panel.
fn heading(ui: &mut Ui, id: Id, name: &str) -> (egui::Response, bool) {
    let frame = Frame::new()
        .fill(ui.visuals().widgets.inactive.weak_bg_fill.gamma_multiply(0.6))
        .corner_radius(3)
        .inner_margin(egui::Margin::symmetric(2, 1));
    frame
        .show(ui, |ui| {
            let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
            let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
            let mut child = ui.new_child(egui::UiBuilder::new().max_rect(rect));
            let style = egui::TextStyle::Button.resolve(child.style());
            let format = egui::TextFormat {
                font_id: style,
                color: child.visuals().strong_text_color(),
                ..Default::default()
            };
            let job = egui::text::LayoutJob::single_section(name.to_owned(), format);
            rows::opening_label(&mut child, id, job, true)
        })
        .inner
}

fn rows(
    ui: &mut Ui,
    id: Id,
    name: &str,
    component: &dyn Reflect,
    registry: &TypeRegistry,
    context: &InspectorContext,
) -> Vec<Edited> {
    let draft_id = id.with("draft");
    let draft = ui.data(|data| data.get_temp::<Draft>(draft_id)).filter(|draft| draft.is_of(component));
    let shown = draft.as_ref().map_or(component, |draft| draft.component.as_ref());
    let default =
        registry.get_type_data::<ReflectDefault>(component.as_any().type_id()).map(|data| data.default());
    let mut problems = draft::problems(shown.as_partial_reflect(), registry);
    // What was asked for and could not be done is told until something is changed.
    let refused = walk::refused(id);
    problems.extend(ui.data(|data| data.get_temp::<(String, String)>(refused)));
    let mut walk = Walk {
        registry,
        context,
        columns: Columns::of(ui),
        id,
        component: name,
        path: String::new(),
        edits: Vec::new(),
        problems,
    };
    walk.contents(
        ui,
        shown.as_partial_reflect(),
        default.as_ref().map(|default| default.as_partial_reflect()),
    );
    walk.complaints(ui);
    for (_, message) in std::mem::take(&mut walk.problems) {
        walk.columns.complaint(ui, &message);
    }
    let edits = walk.edits;
    let is_discarded = draft.is_some() && drafted(ui, name);
    if is_discarded || draft.is_none() {
        ui.data_mut(|data| data.remove::<Draft>(draft_id));
    }
    if edits.is_empty() || is_discarded {
        return Vec::new();
    }
    ui.data_mut(|data| data.remove::<(String, String)>(refused));
    match draft::change(component, draft, edits, registry) {
        Outcome::Made(edits) => {
            ui.data_mut(|data| data.remove::<Draft>(draft_id));
            edits
        }
        Outcome::Held(draft) => {
            ui.data_mut(|data| data.insert_temp(draft_id, draft));
            ui.ctx().request_repaint();
            Vec::new()
        }
    }
}

/// Says that changes are held back. Whether they are to be given up.
fn drafted(ui: &mut Ui, name: &str) -> bool {
    ui.horizontal(|ui| {
        let text = RichText::new("not in force until it is right").color(ui.visuals().warn_fg_color).small();
        let is_discarded = icon_button(ui, Icon::Remove, &format!("Give up changes of {name}")).clicked();
        ui.label(text);
        is_discarded
    })
    .inner
}

/// The most characters of a value in a word.
const SUMMARY_LENGTH: usize = 60;

/// A value in a few characters; none of those that would say nothing.
fn summary(value: &dyn PartialReflect) -> Option<String> {
    let text = words(value, 3)?;
    let mut letters = text.chars();
    let short: String = letters.by_ref().take(SUMMARY_LENGTH).collect();
    Some(if letters.next().is_some() { format!("{short}…") } else { short })
}

/// A value in words, so many levels deep.
fn words(value: &dyn PartialReflect, levels: u32) -> Option<String> {
    let join = |parts: Vec<Option<String>>| {
        let parts: Vec<_> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    };
    let inner = |value: &dyn PartialReflect| levels.checked_sub(1).and_then(|levels| words(value, levels));
    Some(match leaf::Leaf::of(value) {
        Some(leaf::Leaf::Switch(switch)) => switch.to_string(),
        Some(leaf::Leaf::Number(number)) => super::number::short(number.value),
        Some(leaf::Leaf::Vector(parts)) => {
            let numbers: Vec<_> =
                parts.iter().map(|(_, number)| super::number::short(number.value)).collect();
            format!("({})", numbers.join(", "))
        }
        Some(leaf::Leaf::Text(text)) => Some(text.to_owned()).filter(|text| !text.is_empty())?,
        Some(leaf::Leaf::Path(path)) => Some(path.written().to_owned()).filter(|path| !path.is_empty())?,
        Some(leaf::Leaf::Written) => format!("{value:?}"),
        None => match value.reflect_ref() {
            ReflectRef::Struct(fields) => {
                join(fields.iter_fields().map(|(_, field)| inner(field)).collect())?
            }
            ReflectRef::TupleStruct(fields) => join(fields.iter_fields().map(inner).collect())?,
            ReflectRef::Tuple(fields) => join(fields.iter_fields().map(inner).collect())?,
            ReflectRef::Enum(variant)
                if super::edited::is_transparent(variant) && variant.field_len() == 1 =>
            {
                inner(variant.field_at(0)?)?
            }
            ReflectRef::Enum(variant) => variant.variant_name().to_owned(),
            _ => return None,
        },
    })
}
