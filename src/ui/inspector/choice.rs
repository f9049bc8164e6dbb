//! Variants of enums, values that may be absent, names.

use super::super::edited::is_transparent;
use super::super::rows::note;
use super::defaults;
use super::field::{Field, plain};
use super::leaf::Leaf;
use super::walk::{Walk, explain};
use bevy_reflect::Reflect;
use bevy_reflect::enums::{DynamicEnum, DynamicVariant, Enum, EnumInfo, VariantInfo};
use egui::{Checkbox, ComboBox, Response, Ui};

/// The widest that a choice is which has a value beside it.
const CHOICE_WIDTH: f32 = 84.0;

impl Walk<'_> {
    /// A choice of variants; behind it, where the variants are not written by name, what the one chosen holds.
    pub(super) fn choice(
        &mut self,
        ui: &mut Ui,
        field: &Field,
        value: &dyn Enum,
        info: &'static EnumInfo,
        explanation: &str,
    ) {
        let beside = match (info.variant(value.variant_name()), value.field_at(0)) {
            (Some(VariantInfo::Tuple(tuple)), Some(inner))
                if is_transparent(value) && Leaf::of(inner).is_some() =>
            {
                tuple.field_at(0).map(|unnamed| (unnamed, inner))
            }
            _ => None,
        };
        let width = if beside.is_some() { CHOICE_WIDTH } else { ui.available_width() };
        let mut chosen = None;
        // The heading, or the value beside it, has the name itself.
        let shares_name = self.path.is_empty() || is_transparent(value);
        let name = if shares_name { format!("{} kind", self.name()) } else { self.name() };
        let response = self.combo(ui, &name, value.variant_name(), width, |ui| {
            for variant in info.iter() {
                let is_now = variant.name() == value.variant_name();
                let mut entry = ui.selectable_label(is_now, variant.name());
                if let Some(docs) = variant.docs() {
                    entry = entry.on_hover_text(plain(docs));
                }
                if entry.clicked() && !is_now {
                    chosen = Some(variant);
                }
            }
        });
        let docs = info.variant(value.variant_name()).and_then(|variant| variant.docs()).map(plain);
        let both = [explanation, docs.as_deref().unwrap_or_default()];
        explain(response, both.map(str::trim).join("\n").trim());
        if let Some(variant) = chosen {
            match defaults::of_variant(value.as_partial_reflect(), info, variant, field, self.registry) {
                Some(new) => self.edit(new, true),
                None => {
                    let message =
                        format!("`{}` cannot be begun: what it holds has no default", variant.name());
                    self.complain(ui, message);
                }
            }
        }
        if let Some((unnamed, inner)) = beside {
            let mark = self.edits.len();
            self.inline(ui, &field.inside(unnamed), inner, explanation);
            self.wrap(mark, value);
        }
    }

    /// A switch for a value that may be absent, and the value where it is there.
    pub(super) fn option(
        &mut self,
        ui: &mut Ui,
        field: &Field,
        value: &dyn Enum,
        info: &'static EnumInfo,
        explanation: &str,
    ) {
        let Some(VariantInfo::Tuple(some)) = info.variant("Some") else { return };
        let Some(unnamed) = some.field_at(0) else { return };
        let mut is_there = value.variant_name() == "Some";
        let response =
            ui.add(Checkbox::without_text(&mut is_there)).accessible_name(format!("{} is set", self.name()));
        let is_changed = response.changed();
        explain(response, explanation);
        if is_changed {
            match self.present(is_there, info, unnamed.type_id(), &field.inside(unnamed)) {
                Some(new) => self.edit(new, true),
                None => self.complain(ui, "this cannot be begun: it has no default"),
            }
        }
        match value.field_at(0) {
            Some(inner) => {
                let mark = self.edits.len();
                self.inline(ui, &field.inside(unnamed), inner, explanation);
                self.wrap(mark, value);
            }
            None => {
                note(ui, "none");
            }
        }
    }

    fn present(
        &self,
        is_there: bool,
        info: &'static EnumInfo,
        inner: std::any::TypeId,
        field: &Field,
    ) -> Option<Box<dyn Reflect>> {
        let value = if is_there {
            let mut payload = bevy_reflect::tuple::DynamicTuple::default();
            payload.insert_boxed(defaults::of_field(inner, field, self.registry)?.into_partial_reflect());
            DynamicEnum::new("Some", DynamicVariant::Tuple(payload))
        } else {
            DynamicEnum::new("None", DynamicVariant::Unit)
        };
        super::leaf::whole(&value, self.registry.get(info.type_id())?.type_info(), self.registry)
    }

    /// A name out of several.
    pub(super) fn pick(
        &self,
        ui: &mut Ui,
        name: &str,
        text: &str,
        known: impl Fn() -> Vec<String>,
        kind: &str,
        explanation: &str,
    ) -> Option<String> {
        let mut picked = None;
        let response = self.combo(ui, name, text, ui.available_width(), |ui| {
            let known = known();
            if known.is_empty() {
                note(ui, &format!("there is no {kind}"));
            }
            for name in known {
                if ui.selectable_label(name == text, &name).clicked() && name != text {
                    picked = Some(name);
                }
            }
        });
        explain(response, explanation);
        picked
    }

    pub(super) fn combo(
        &self,
        ui: &mut Ui,
        name: &str,
        text: &str,
        width: f32,
        contents: impl FnOnce(&mut Ui),
    ) -> Response {
        let combo =
            ComboBox::from_id_salt("choice").selected_text(text).width(width).height(320.0).truncate();
        combo.show_ui(ui, contents).response.accessible_name(name)
    }
}
