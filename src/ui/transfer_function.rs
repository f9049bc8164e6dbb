//! The transfer-function editor: the curve as classification sees it over the histogram, with handles to change it.

mod axis;
mod curve;
mod details;
mod file;
mod handles;
mod picture;
mod plot;
mod shown;
mod toolbar;

pub use crate::components::Preset;
pub use file::{TransferFunctionFileError, read_transfer_function, write_transfer_function};

use super::edited::Edited;
use crate::components::TransferFunction;
use crate::sources::Histogram;
use axis::Stretch;
use bevy_reflect::TypeRegistry;
use curve::Curve;
use egui::{Id, RichText, Ui};
use handles::Drag;
use shown::Shown;
use std::path::{Path, PathBuf};

/// What a transfer function is edited over.
pub struct TransferFunctionData<'a> {
    /// The data values at positions 0 and 1 that are in force: see `LoadedVolume::domain`.
    pub domain: (f32, f32),
    /// How often each value occurs, if a volume is there.
    pub histogram: Option<&'a Histogram>,
    /// Reads files.
    pub registry: &'a TypeRegistry,
    /// Where paths of files start.
    pub folder: &'a Path,
    /// Files with transfer functions to choose from, beside those built in.
    pub presets: &'a [PathBuf],
}

/// What a transfer-function editor remembers from frame to frame; one for each function that is edited.
#[derive(Debug, Default)]
pub struct TransferFunctionEditor {
    curve: Curve,
    /// The values in view, and the domain that they were chosen for.
    view: Option<(Stretch, (f32, f32))>,
    /// Where a stretch to zoom into began, on the screen.
    zoom_from: Option<f32>,
    selected: Option<Selected>,
    drag: Option<Drag>,
    /// Whether the histogram is linear; it is logarithmic at first.
    is_linear: bool,
    /// The path that was typed.
    path: String,
    message: Option<Message>,
}

/// What is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Selected {
    Point(usize),
    Iso(usize),
}

/// What came of what was asked for.
#[derive(Clone, Debug)]
struct Message {
    text: String,
    is_error: bool,
}

impl TransferFunctionEditor {
    /// Shows `function`, which belongs to what is called `name`. Says what was changed; the function itself stays as it is, and is to be given
    /// with the changes the next time.
    ///
    /// Points are dragged between their neighbours and never pass them. A click on the curve adds one that changes nothing yet; Delete
    /// deletes; arrow keys move, with Shift a tenth as far. The wheel zooms into data values, a drag beside the handles moves along them, one
    /// with Shift zooms into what it covers.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        name: &str,
        function: &TransferFunction,
        data: &TransferFunctionData,
    ) -> Vec<Edited> {
        let id = Id::unique(("transfer function", name));
        let points = function.points_in_force();
        let mut shown = Shown { id, name, function, data, points, edits: Vec::new() };
        self.curve.update(function, data.domain);
        self.keep_selection(&shown);
        ui.push_id(id, |ui| {
            ui.spacing_mut().item_spacing.y = 4.0;
            self.toolbar(ui, &mut shown);
            let plot = self.picture(ui, &mut shown);
            ui.spacing_mut().item_spacing.y = 3.0;
            self.details(ui, &mut shown, &plot);
            self.files(ui, &mut shown);
            self.messages(ui);
        });
        shown.edits
    }

    /// What was chosen and is no more is not.
    fn keep_selection(&mut self, shown: &Shown) {
        self.selected = self.selected.filter(|selected| match *selected {
            Selected::Point(index) => index < shown.points.len(),
            Selected::Iso(index) => index < shown.function.iso.len(),
        });
    }

    fn tell(&mut self, text: impl Into<String>) {
        self.message = Some(Message { text: text.into(), is_error: false });
    }

    fn complain(&mut self, error: impl std::fmt::Display) {
        self.message = Some(Message { text: error.to_string(), is_error: true });
    }

    fn messages(&mut self, ui: &mut Ui) {
        let Some(message) = &self.message else { return };
        let visuals = ui.visuals();
        let colour = if message.is_error { visuals.error_fg_color } else { visuals.weak_text_color() };
        ui.add(egui::Label::new(RichText::new(&message.text).color(colour).small()).wrap());
    }
}
