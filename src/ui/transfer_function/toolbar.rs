//! Presets, what is in view, files.

use super::file::{read_transfer_function, write_transfer_function};
use super::shown::Shown;
use super::{Selected, TransferFunctionEditor};
use crate::components::IsoValue;
use crate::components::Preset;
use egui::{Key, TextEdit, Ui, vec2};
use std::path::{Path, PathBuf};

impl TransferFunctionEditor {
    pub(super) fn toolbar(&mut self, ui: &mut Ui, shown: &mut Shown) {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.menu_button("Presets", |ui| self.presets(ui, shown))
                .response
                .on_hover_text("Functions to begin with; those built in fit themselves to the histogram");
            let add = ui.button("+ Point").accessible_name("Add point");
            if add.on_hover_text("Adds a control point in the middle of the view").clicked() {
                let value = self.middle(shown);
                self.add_point(shown, value);
            }
            let hint = "Adds a level set in the middle of the view, shown as a thin layer";
            if ui.button("+ Iso").accessible_name("Add iso value").on_hover_text(hint).clicked() {
                let value = self.middle(shown);
                self.add_iso(shown, value);
            }
            ui.separator();
            if ui.button("Domain").on_hover_text("Show the whole domain").clicked() {
                self.show_domain(shown);
            }
            ui.add_enabled_ui(shown.data.histogram.is_some(), |ui| {
                if ui.button("Data").on_hover_text("Show all values that occur").clicked() {
                    self.show_data(shown);
                }
            });
            let mut is_logarithmic = !self.is_linear;
            ui.checkbox(&mut is_logarithmic, "log").on_hover_text("Whether the histogram is logarithmic");
            self.is_linear = !is_logarithmic;
        });
    }

    fn middle(&self, shown: &Shown) -> f64 {
        let view = self.view(shown);
        super::super::number::round_to(0.5 * (view.low + view.high), view.width() / 200.0)
    }

    /// Adds a point that changes nothing yet.
    pub(super) fn add_point(&mut self, shown: &mut Shown, value: f64) {
        let (low, high) = (f64::from(shown.data.domain.0), f64::from(shown.data.domain.1));
        let position = ((value - low) / (high - low)).clamp(0.0, 1.0);
        let position = if position.is_finite() { position } else { 0.5 };
        let index = shown.add_point(super::curve::between(&shown.points, position));
        self.selected = Some(Selected::Point(index));
    }

    /// Adds an iso value that is a fiftieth of the view wide.
    pub(super) fn add_iso(&mut self, shown: &mut Shown, value: f64) {
        let width = super::super::number::round_to_digits(self.view(shown).width() / 50.0, 2);
        let width = (width as f32).max(f32::MIN_POSITIVE);
        let index = shown.add_iso(IsoValue { value: value as f32, width, ..IsoValue::default() });
        self.selected = Some(Selected::Iso(index));
    }

    fn presets(&mut self, ui: &mut Ui, shown: &mut Shown) {
        for preset in Preset::ALL {
            if ui.button(preset.name()).on_hover_text(preset.description()).clicked() {
                let data = shown.data;
                shown.put_all(preset.applied(shown.function, data.histogram, data.domain));
                self.selected = None;
                self.message = None;
                ui.close();
            }
        }
        let presets: &[PathBuf] = shown.data.presets;
        if presets.is_empty() {
            return;
        }
        ui.separator();
        for path in presets {
            let name = path
                .file_stem()
                .map_or_else(|| path.display().to_string(), |name| name.display().to_string());
            if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                self.load(shown, path);
                ui.close();
            }
        }
    }

    /// Loading from and saving to a file.
    pub(super) fn files(&mut self, ui: &mut Ui, shown: &mut Shown) {
        ui.add_space(3.0);
        let path = self.typed_path(shown.data.folder);
        let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
        let layout = egui::Layout::right_to_left(egui::Align::Center);
        let (mut wants_save, mut wants_load) = (false, false);
        ui.allocate_ui_with_layout(size, layout, |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.add_enabled_ui(path.is_some(), |ui| {
                let save = ui.button("Save").on_hover_text("Write the function into this file");
                wants_save = save.clicked();
            });
            ui.add_enabled_ui(path.is_some(), |ui| {
                let load = ui.button("Load").on_hover_text("Take the function from this file");
                wants_load = load.clicked();
            });
            let hint = "transfer_functions/name.ron";
            let edit = TextEdit::singleline(&mut self.path).hint_text(hint).align(egui::Align2::LEFT_CENTER);
            let size = vec2(ui.available_width(), size.y);
            let response = ui.add_sized(size, edit).accessible_name("File of the transfer function");
            wants_load |= response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            response.on_hover_text(format!("Starts at {}", shown.data.folder.display()));
        });
        let Some(path) = path else { return };
        if wants_load {
            self.load(shown, &path);
        } else if wants_save {
            match write_transfer_function(&path, shown.function) {
                Ok(()) => self.tell(format!("Saved as {}", path.display())),
                Err(error) => self.complain(error),
            }
        }
    }

    fn typed_path(&self, folder: &Path) -> Option<PathBuf> {
        let typed = self.path.trim();
        let mut path = folder.join(typed);
        if path.extension().is_none() {
            path.set_extension("ron");
        }
        (!typed.is_empty()).then_some(path)
    }

    fn load(&mut self, shown: &mut Shown, path: &Path) {
        match read_transfer_function(path, shown.data.registry) {
            Ok(function) => {
                shown.put_all(function);
                self.selected = None;
                self.tell(format!("Loaded {}", path.display()));
            }
            Err(error) => self.complain(error),
        }
    }
}
