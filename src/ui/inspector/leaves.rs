//! The widgets of values that are shown in one piece.

use super::super::colour::colour_button;
use super::super::light_direction::sphere_button;
use super::super::number::Numeric;
use super::super::rows::note;
use super::field::Field;
use super::leaf::{Leaf, Number, with_parts};
use super::text::{exists, folder_of, line};
use super::walk::{Walk, explain};
use crate::components::{AssetPath, Rgb};
use bevy_reflect::serde::{TypedReflectDeserializer, TypedReflectSerializer};
use bevy_reflect::{PartialReflect, Reflect, ReflectDeserialize, ReflectSerialize};
use egui::{Checkbox, Ui};
use glam::Vec3;
use serde::de::DeserializeSeed;

impl Walk<'_> {
    /// A value in one piece, in what is left of its row.
    pub(super) fn leaf(
        &mut self,
        ui: &mut Ui,
        field: &Field,
        value: &dyn PartialReflect,
        leaf: &Leaf,
        explanation: &str,
    ) {
        match leaf {
            Leaf::Switch(switch) => {
                let mut new = *switch;
                let response = ui.add(Checkbox::without_text(&mut new)).accessible_name(self.name());
                explain(response, explanation);
                if new != *switch {
                    self.edit(Box::new(new), true);
                }
            }
            Leaf::Number(number) => {
                let new = self.number(ui, field, number, &self.name(), "", explanation);
                self.gesture(ui, new.map(|new| number.boxed(new)), value);
            }
            Leaf::Vector(parts) => self.vector(ui, field, value, parts, explanation),
            Leaf::Text(text) => self.text(ui, field, text, explanation),
            Leaf::Path(path) => self.asset_path(ui, path, explanation),
            Leaf::Written => self.written(ui, value, explanation),
        }
    }

    fn number(
        &self,
        ui: &mut Ui,
        field: &Field,
        number: &Number,
        name: &str,
        prefix: &str,
        explanation: &str,
    ) -> Option<f64> {
        let numeric = Numeric {
            name,
            range: Some(number.range(field)),
            slider: field.slider().filter(|_| prefix.is_empty()),
            is_whole: number.is_whole,
            prefix,
            ..Default::default()
        };
        let (response, new) = numeric.show(ui, number.value, ui.available_width());
        explain(response, explanation);
        new
    }

    fn vector(
        &mut self,
        ui: &mut Ui,
        field: &Field,
        value: &dyn PartialReflect,
        parts: &[(&str, Number)],
        explanation: &str,
    ) {
        let name = self.name();
        let vector = value.try_downcast_ref::<Vec3>().copied();
        let mut new: Option<Box<dyn Reflect>> = None;
        if let (Some(colour), Some(Rgb::Colour)) = (vector, field.rgb()) {
            let (response, picked) = colour_button(ui, &format!("{name} colour"), colour, field.range());
            explain(response, explanation);
            new = picked.map(|colour| Box::new(colour) as Box<dyn Reflect>);
        }
        if let (Some(direction), true) = (vector, field.is_direction()) {
            let turned = sphere_button(ui, &format!("{name} handle"), direction, self.context.eye_from_scene);
            new = turned.map(|direction| Box::new(direction) as Box<dyn Reflect>);
        }
        let gap = ui.spacing().item_spacing.x;
        let width = (ui.available_width() - gap * (parts.len() - 1) as f32) / parts.len() as f32;
        let names =
            if field.rgb().is_some() { ["red", "green", "blue", "alpha"] } else { ["x", "y", "z", "w"] };
        let mut changed = Vec::new();
        for (index, (part, number)) in parts.iter().enumerate() {
            let named = if field.rgb().is_some() { names[index] } else { part };
            let numeric = Numeric {
                name: &format!("{name} {named}"),
                range: Some(number.range(field)),
                is_whole: number.is_whole,
                ..Default::default()
            };
            let (response, typed) = numeric.number(ui, number.value, width);
            explain(response, explanation);
            changed.extend(typed.map(|typed| (*part, number.boxed(typed))));
        }
        if !changed.is_empty() {
            new = with_parts(value, changed, self.registry);
        }
        self.gesture(ui, new, value);
    }

    fn text(&mut self, ui: &mut Ui, field: &Field, text: &str, explanation: &str) {
        let name = self.name();
        let new = if let Some(names) = field.names() {
            let known = || names.known.iter().map(|name| (*name).to_owned()).collect();
            self.pick(ui, &name, text, known, names.of, explanation)
        } else if let Some(component) = field.name_of() {
            let kind = format!("entity with a {component}");
            self.pick(ui, &name, text, || (self.context.entities_with)(component), &kind, explanation)
        } else {
            let (response, new) = line(ui, self.value_id(), &name, text, ui.available_width());
            explain(response, explanation);
            new
        };
        if let Some(new) = new {
            self.edit(Box::new(new), true);
        }
    }

    fn asset_path(&mut self, ui: &mut Ui, path: &AssetPath, explanation: &str) {
        const MARK: f32 = 16.0;
        let is_there = exists(ui, path.path());
        let found = if is_there { "exists" } else { "does not exist" };
        let width = ui.available_width() - MARK;
        let (response, new) = line(ui, self.value_id(), &self.name(), path.written(), width);
        explain(response, &format!("{explanation}\n{}: {found}", path.path().display()));
        let colour =
            if is_there { ui.visuals().widgets.active.fg_stroke.color } else { ui.visuals().error_fg_color };
        let (rect, response) = ui.allocate_exact_size(egui::vec2(MARK - 4.0, 12.0), egui::Sense::hover());
        ui.painter().circle(
            rect.center(),
            4.0,
            if is_there { egui::Color32::from_rgb(70, 160, 90) } else { egui::Color32::TRANSPARENT },
            egui::Stroke::new(1.5, if is_there { egui::Color32::from_rgb(70, 160, 90) } else { colour }),
        );
        response.on_hover_text(found);
        if let Some(written) = new {
            let folder = folder_of(path.written(), path.path());
            let mut path = AssetPath::new(written);
            path.resolve(folder.as_deref().unwrap_or(self.context.folder));
            self.edit(Box::new(path), true);
        }
    }

    /// A value as it stands in a scene, to be typed.
    fn written(&mut self, ui: &mut Ui, value: &dyn PartialReflect, explanation: &str) {
        let registration =
            value.get_represented_type_info().and_then(|info| self.registry.get(info.type_id()));
        let is_readable = registration.is_some_and(|registration| {
            let is_opaque = matches!(registration.type_info(), bevy_reflect::TypeInfo::Opaque(_));
            !is_opaque
                || registration.contains::<ReflectDeserialize>()
                    && registration.contains::<ReflectSerialize>()
        });
        let text = ron::to_string(&TypedReflectSerializer::new(value, self.registry)).ok();
        let (Some(registration), Some(text), true) = (registration, text, is_readable) else {
            note(ui, &super::summary(value).unwrap_or_else(|| "cannot be shown".into()));
            return;
        };
        let (response, new) = line(ui, self.value_id(), &self.name(), &text, ui.available_width());
        explain(response, explanation);
        let Some(new) = new else { return };
        let read =
            ron::Deserializer::from_str(&new).map_err(|error| error.to_string()).and_then(|mut reader| {
                let seed = TypedReflectDeserializer::new(registration, self.registry);
                let value = seed.deserialize(&mut reader).map_err(|error| error.to_string())?;
                reader.end().map_err(|error| error.to_string())?;
                super::leaf::whole(value.as_ref(), registration.type_info(), self.registry)
                    .or_else(|| value.try_into_reflect().ok())
                    .ok_or_else(|| "it is not complete".to_owned())
            });
        match read {
            Ok(value) => self.edit(value, true),
            Err(error) => {
                let message = format!("`{new}` cannot be read: {error}; it stays {text}");
                self.complain(ui, message);
            }
        }
    }
}
