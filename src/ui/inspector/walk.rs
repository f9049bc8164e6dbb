//! Walks through a value and shows a row for each that it holds.

use super::super::edited::{Edited, is_transparent, settle};
use super::super::icons::{ICON_WIDTH, Icon, icon_button};
use super::super::rows::{Columns, INDENT, label, note, opening_label};
use super::field::Field;
use super::leaf::{Leaf, copy};
use super::{InspectorContext, defaults};
use bevy_reflect::enums::{Enum, VariantInfo, VariantType};
use bevy_reflect::{PartialReflect, Reflect, ReflectRef, TypeInfo, TypeRegistry};
use egui::{Id, Response, Ui};

/// A walk through a component, and what a person changed on it.
pub(super) struct Walk<'a> {
    pub registry: &'a TypeRegistry,
    pub context: &'a InspectorContext<'a>,
    pub columns: Columns,
    /// Distinguishes what is remembered of this component from others.
    pub id: Id,
    /// The name of the component.
    pub component: &'a str,
    /// Where the walk is, from the component.
    pub path: String,
    pub edits: Vec<Edited>,
    /// What is wrong, by path; each is taken when it is shown.
    pub problems: Vec<(String, String)>,
}

/// Deeper values are shown as text: types may be nested without end.
const MOST_DEPTH: usize = 24;

impl Walk<'_> {
    /// What the value at hand is called, by those who see only names: `Phong.shininess`.
    pub fn name(&self) -> String {
        let dot = if self.path.is_empty() || self.path.starts_with('[') { "" } else { "." };
        format!("{}{dot}{}", self.component, self.path)
    }

    /// What is remembered of the value at hand.
    pub fn value_id(&self) -> Id {
        self.id.with(&self.path)
    }

    /// Goes a step deeper.
    pub fn within<R>(&mut self, step: &str, walk: impl FnOnce(&mut Self) -> R) -> R {
        let length = self.path.len();
        if !self.path.is_empty() && !step.is_empty() && !step.starts_with('[') {
            self.path.push('.');
        }
        self.path.push_str(step);
        let result = walk(self);
        self.path.truncate(length);
        result
    }

    /// Notes that the value at hand became another.
    pub fn edit(&mut self, value: Box<dyn Reflect>, finished: bool) {
        self.edits.push(Edited { path: self.path.clone(), value, finished });
    }

    /// Notes what a widget that may be dragged made of the value at hand; `now` is what the value is without a change.
    pub fn gesture(&mut self, ui: &Ui, new: Option<Box<dyn Reflect>>, now: &dyn PartialReflect) {
        if let Some(finished) = settle(ui, self.value_id(), new.is_some())
            && let Some(value) = new.or_else(|| copy(now, self.registry))
        {
            self.edit(value, finished);
        }
    }

    /// The fields of a value, or the value itself where it has none.
    pub fn contents(
        &mut self,
        ui: &mut Ui,
        value: &dyn PartialReflect,
        default: Option<&dyn PartialReflect>,
    ) {
        match value.reflect_ref() {
            ReflectRef::Struct(_) | ReflectRef::TupleStruct(_) | ReflectRef::Tuple(_)
                if Leaf::of(value).is_none() =>
            {
                self.children(ui, &Field::default(), value, default);
            }
            ReflectRef::Enum(_) => self.node(ui, &Field::whole("kind"), value, default),
            _ => self.node(ui, &Field::whole("value"), value, default),
        }
    }

    /// A row for a value, and rows for what it holds.
    pub fn node(
        &mut self,
        ui: &mut Ui,
        field: &Field,
        value: &dyn PartialReflect,
        default: Option<&dyn PartialReflect>,
    ) {
        let opens = self.path.matches(['.', '[']).count() < MOST_DEPTH && has_children(value);
        let is_item = self.path.ends_with(']');
        // Items have more buttons behind them.
        let columns = if is_item { self.columns.narrowed(2.0 * ICON_WIDTH) } else { self.columns };
        let id = self.value_id();
        let differs = default.filter(|default| value.reflect_partial_eq(*default) == Some(false));
        let explanation = explanation(field, default);
        let mut is_open = true;
        let mut is_reset = false;
        let reset = format!("Reset {}", self.name());
        ui.push_id(id, |ui| {
            columns.row(
                ui,
                |ui| {
                    let text = field.text(ui);
                    let response = if opens {
                        let (response, open) = opening_label(ui, id, text, !is_item);
                        is_open = open;
                        response
                    } else {
                        label(ui, text)
                    };
                    explain(response, &explanation);
                },
                |ui| self.inline(ui, field, value, &explanation),
                |ui| {
                    if differs.is_some() && !is_item {
                        is_reset = icon_button(ui, Icon::Reset, &reset).clicked();
                    }
                },
            );
        });
        if is_reset && let Some(default) = differs.and_then(|default| copy(default, self.registry)) {
            self.edit(default, true);
        }
        if opens && is_open {
            indented(ui, |ui| self.children(ui, field, value, default));
        }
        self.complaints(ui);
    }

    /// Says why the value at hand did not become what was asked for, until something is changed.
    pub fn complain(&self, ui: &Ui, message: impl Into<String>) {
        let complaint = (self.path.clone(), message.into());
        ui.data_mut(|data| data.insert_temp(refused(self.id), complaint));
    }

    /// What is wrong with the value at hand.
    pub fn complaints(&mut self, ui: &mut Ui) {
        let path = self.path.clone();
        let (here, elsewhere) =
            std::mem::take(&mut self.problems).into_iter().partition(|(at, _)| *at == path);
        self.problems = elsewhere;
        for (_, message) in here {
            self.columns.complaint(ui, &message);
        }
    }

    /// The part of a value that stands on its row.
    pub fn inline(&mut self, ui: &mut Ui, field: &Field, value: &dyn PartialReflect, explanation: &str) {
        if let Some(leaf) = Leaf::of(value) {
            return self.leaf(ui, field, value, &leaf, explanation);
        }
        match value.reflect_ref() {
            ReflectRef::Enum(variant) => match value.get_represented_type_info() {
                Some(TypeInfo::Enum(info)) if info.type_path_table().ident() == Some("Option") => {
                    self.option(ui, field, variant, info, explanation);
                }
                Some(TypeInfo::Enum(info)) => self.choice(ui, field, variant, info, explanation),
                _ => {
                    note(ui, variant.variant_name());
                }
            },
            ReflectRef::List(items) => {
                note(ui, &count(items.len()));
            }
            ReflectRef::Array(items) => {
                note(ui, &count(items.len()));
            }
            _ => {
                if let Some(summary) = super::summary(value) {
                    note(ui, &summary);
                }
            }
        }
    }

    /// Rows for what a value holds.
    fn children(
        &mut self,
        ui: &mut Ui,
        field: &Field,
        value: &dyn PartialReflect,
        default: Option<&dyn PartialReflect>,
    ) {
        match (value.reflect_ref(), value.get_represented_type_info()) {
            (ReflectRef::Struct(fields), Some(TypeInfo::Struct(info))) => {
                for named in info.iter() {
                    if let Some(value) = fields.field(named.name()) {
                        let default = default.and_then(|default| part(default, named.name()));
                        self.within(named.name(), |walk| walk.node(ui, &Field::named(named), value, default));
                    }
                }
            }
            (ReflectRef::TupleStruct(fields), Some(TypeInfo::TupleStruct(info))) => {
                self.unnamed(ui, info.iter(), |index| fields.field(index), default);
            }
            (ReflectRef::Tuple(fields), Some(TypeInfo::Tuple(info))) => {
                self.unnamed(ui, info.iter(), |index| fields.field(index), default);
            }
            (ReflectRef::Enum(variant), Some(TypeInfo::Enum(info))) => {
                self.payload(ui, field, variant, info.variant(variant.variant_name()), default);
            }
            (ReflectRef::List(items), Some(TypeInfo::List(info))) => {
                self.list(ui, field, items, value, info.item_ty().id());
            }
            (ReflectRef::Array(items), _) => {
                for (index, item) in items.iter().take(super::list::MOST_ITEMS).enumerate() {
                    self.within(&format!("[{index}]"), |walk| walk.node(ui, &field.item(index), item, None));
                }
            }
            _ => {}
        }
    }

    fn unnamed<'v>(
        &mut self,
        ui: &mut Ui,
        fields: impl Iterator<Item = &'static bevy_reflect::UnnamedField>,
        value: impl Fn(usize) -> Option<&'v dyn PartialReflect>,
        default: Option<&dyn PartialReflect>,
    ) {
        for unnamed in fields {
            let step = unnamed.index().to_string();
            if let Some(value) = value(unnamed.index()) {
                let default = default.and_then(|default| part(default, &step));
                self.within(&step, |walk| walk.node(ui, &Field::unnamed(unnamed), value, default));
            }
        }
    }

    /// The fields of a variant.
    fn payload(
        &mut self,
        ui: &mut Ui,
        field: &Field,
        value: &dyn Enum,
        variant: Option<&'static VariantInfo>,
        default: Option<&dyn PartialReflect>,
    ) {
        // What the default says counts only for its own variant.
        let same = default.filter(|default| match default.reflect_ref() {
            ReflectRef::Enum(default) => default.variant_name() == value.variant_name(),
            _ => false,
        });
        let own = match (same, variant, value.get_represented_type_info()) {
            (None, Some(variant @ VariantInfo::Struct(_)), Some(TypeInfo::Enum(info))) => {
                defaults::variant_default(info, variant, field, self.registry)
            }
            _ => None,
        };
        let default = same.or(own.as_ref().map(|own| own.as_partial_reflect()));
        match variant {
            Some(VariantInfo::Struct(info)) => {
                for named in info.iter() {
                    if let Some(value) = value.field(named.name()) {
                        let default = default.and_then(|default| part(default, named.name()));
                        self.within(named.name(), |walk| walk.node(ui, &Field::named(named), value, default));
                    }
                }
            }
            Some(VariantInfo::Tuple(info)) if is_transparent(value) => {
                // Not a step of its own: what it holds belongs to this row.
                if let (Some(unnamed), Some(inner)) = (info.field_at(0), value.field_at(0)) {
                    let mark = self.edits.len();
                    self.children(ui, &field.inside(unnamed), inner, None);
                    self.wrap(mark, value);
                }
            }
            Some(VariantInfo::Tuple(info)) => {
                for unnamed in info.iter() {
                    let step = unnamed.index().to_string();
                    if let Some(inner) = value.field_at(unnamed.index()) {
                        let mut inner_field = Field::unnamed(unnamed);
                        if info.field_len() == 1 && inner_field.label == "0" {
                            inner_field.label = what_it_is(inner);
                        }
                        let default = default.and_then(|default| part(default, &step));
                        self.within(&step, |walk| walk.node(ui, &inner_field, inner, default));
                    }
                }
            }
            _ => {}
        }
    }

    /// Changes of what a transparent variant holds become changes of the whole.
    pub fn wrap(&mut self, mark: usize, around: &dyn Enum) {
        let Some(info) = around.get_represented_type_info() else { return };
        let (path, name) = (self.path.clone(), around.variant_name().to_owned());
        let registry = self.registry;
        let edits = self.edits.split_off(mark).into_iter().filter_map(|edit| {
            if edit.path != path {
                return Some(edit);
            }
            let mut payload = bevy_reflect::tuple::DynamicTuple::default();
            payload.insert_boxed(edit.value.into_partial_reflect());
            let value = bevy_reflect::enums::DynamicEnum::new(name.clone(), payload);
            Some(Edited { value: super::leaf::whole(&value, info, registry)?, ..edit })
        });
        self.edits.extend(edits);
    }
}

/// Where it is remembered what was refused last.
pub(super) fn refused(id: Id) -> Id {
    id.with("refused")
}

fn indented(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        ui.add_space(INDENT);
        ui.vertical(add);
    });
}

fn explanation(field: &Field, default: Option<&dyn PartialReflect>) -> String {
    field.explanation(default.and_then(super::summary).as_deref())
}

/// Tells those who hover, and those who listen.
pub(super) fn explain(response: Response, explanation: &str) -> Response {
    if explanation.is_empty() {
        return response;
    }
    response.ctx.accesskit_node_builder(response.id, |node| node.set_description(explanation));
    response.on_hover_text(explanation)
}

/// What a tuple variant's one value is, where its name says nothing.
fn what_it_is(value: &dyn PartialReflect) -> String {
    match Leaf::of(value) {
        Some(Leaf::Path(_)) => "path".into(),
        Some(Leaf::Text(_)) => "name".into(),
        _ => "value".into(),
    }
}

fn count(items: usize) -> String {
    match items {
        0 => "none".into(),
        1 => "1 item".into(),
        items => format!("{items} items"),
    }
}

/// Whether anything in a value has rows of its own.
fn has_children(value: &dyn PartialReflect) -> bool {
    if Leaf::of(value).is_some() {
        return false;
    }
    match value.reflect_ref() {
        ReflectRef::Enum(variant) if variant.variant_type() == VariantType::Unit => false,
        ReflectRef::Enum(variant) if is_transparent(variant) => variant.field_at(0).is_some_and(has_children),
        _ => true,
    }
}

/// A field of a value, by its name or number.
fn part<'v>(value: &'v dyn PartialReflect, step: &str) -> Option<&'v dyn PartialReflect> {
    super::super::edited::get(value, step)
}
