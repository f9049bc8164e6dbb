//! A panel with a component in it, and a history that can be undone.

use bevy_reflect::{Reflect, TypeRegistry};
use egui::{Pos2, Vec2, pos2, vec2};
use egui_kittest::{Harness, Node, kittest::Queryable};
use glam::Quat;
use std::path::Path;
use tyndall::TyndallPlugins;
use tyndall::prelude::*;
use tyndall::ui::{Edited, InspectorContext, TransferFunctionData, TransferFunctionEditor, inspect};

/// The registry of the framework.
pub fn registry() -> TypeRegistry {
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let mut own = TypeRegistry::new();
    for registration in registry.iter() {
        own.add_registration(registration.clone());
    }
    own
}

/// A component, what was changed of it, and what it was before.
pub struct Edits<T> {
    pub component: T,
    /// What it was before each complete change.
    pub before: Vec<T>,
    /// The path of each change that was reported, and whether it was complete.
    pub log: Vec<(String, bool)>,
    /// What it was before the gesture that goes on.
    open: Option<T>,
}

impl<T: Reflect + Clone + PartialEq> Edits<T> {
    pub fn new(component: T) -> Self {
        Self { component, before: Vec::new(), log: Vec::new(), open: None }
    }

    pub fn take(&mut self, edits: Vec<Edited>) {
        for edit in edits {
            let before = self.open.take().unwrap_or_else(|| self.component.clone());
            edit.apply(self.component.as_partial_reflect_mut()).unwrap();
            self.log.push((edit.path, edit.finished));
            if edit.finished {
                self.before.push(before);
            } else {
                self.open = Some(before);
            }
        }
    }

    pub fn undo(&mut self) {
        self.component = self.before.pop().unwrap();
    }
}

/// What an inspector test looks at.
pub struct Inspected<T> {
    pub edits: Edits<T>,
    pub registry: TypeRegistry,
}

/// An inspector with one component.
pub fn inspector<T: Reflect + Clone + PartialEq>(component: T) -> Harness<'static, Inspected<T>> {
    inspector_with(component, registry(), vec2(360.0, 700.0))
}

pub fn inspector_with<T: Reflect + Clone + PartialEq>(
    component: T,
    registry: TypeRegistry,
    size: Vec2,
) -> Harness<'static, Inspected<T>> {
    let state = Inspected { edits: Edits::new(component), registry };
    Harness::builder().with_size(size).build_ui_state(
        |ui, state: &mut Inspected<T>| {
            let context = InspectorContext {
                entities_with: &|component| match component {
                    "Subsurface" => vec!["bunny".into(), "dragon".into()],
                    _ => Vec::new(),
                },
                folder: Path::new(env!("CARGO_MANIFEST_DIR")),
                eye_from_scene: Quat::IDENTITY,
            };
            let edits = inspect(ui, "thing", &state.edits.component, &state.registry, &context);
            state.edits.take(edits);
        },
        state,
    )
}

/// What a test of the transfer-function editor looks at.
pub struct Function {
    pub edits: Edits<TransferFunction>,
    pub editor: TransferFunctionEditor,
    pub histogram: Option<tyndall::sources::Histogram>,
    /// The domain while the function's own is `Auto`.
    pub automatic: (f32, f32),
    pub registry: TypeRegistry,
    pub folder: tempfile::TempDir,
}

impl Function {
    pub fn show(&mut self, ui: &mut egui::Ui) {
        let domain = match self.edits.component.domain {
            Auto::Auto => self.automatic,
            Auto::Value(domain) => (domain.x, domain.y),
        };
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/transfer_functions/ember.ron");
        let data = TransferFunctionData {
            domain,
            histogram: self.histogram.as_ref(),
            registry: &self.registry,
            folder: self.folder.path(),
            presets: &[shipped],
        };
        let edits = self.editor.show(ui, "head", &self.edits.component, &data);
        self.edits.take(edits);
    }
}

pub fn function(component: TransferFunction) -> Harness<'static, Function> {
    function_over(component, Some(two_humps()), (0.0, 255.0), 1.0)
}

pub fn function_over(
    component: TransferFunction,
    histogram: Option<tyndall::sources::Histogram>,
    automatic: (f32, f32),
    scale: f32,
) -> Harness<'static, Function> {
    let state = Function {
        edits: Edits::new(component),
        editor: TransferFunctionEditor::default(),
        histogram,
        automatic,
        registry: registry(),
        folder: tempfile::tempdir().unwrap(),
    };
    Harness::builder()
        .with_size(vec2(380.0, 390.0))
        .with_pixels_per_point(scale)
        .build_ui_state(|ui, state: &mut Function| state.show(ui), state)
}

/// A histogram like that of a scan: much air, some tissue, little bone.
pub fn two_humps() -> tyndall::sources::Histogram {
    let humps = [(20.0, 6.0, 60_000.0), (95.0, 14.0, 9_000.0), (190.0, 20.0, 700.0)];
    let mut samples = Vec::new();
    for value in 0..=255u8 {
        let at = f64::from(value);
        let count: f64 = humps
            .iter()
            .map(|(middle, width, most): &(f64, f64, f64)| most * (-((at - middle) / width).powi(2)).exp())
            .sum();
        samples.extend(std::iter::repeat_n(value, count as usize));
    }
    let size = [samples.len() as u32, 1, 1];
    let samples = tyndall::sources::Samples::U8(samples);
    tyndall::sources::VolumeData::new(size, Vec3::ONE, samples).unwrap().histogram
}

/// Presses at a place, moves in a few steps, and lets go.
pub fn drag<S>(harness: &mut Harness<S>, from: Pos2, by: Vec2) {
    harness.hover_at(from);
    harness.run();
    harness.drag_at(from);
    harness.run();
    for step in 1..=4 {
        harness.hover_at(from + by * (step as f32 / 4.0));
        harness.run();
    }
    harness.drop_at(from + by);
    harness.run();
}

/// Clicks at a place.
pub fn click<S>(harness: &mut Harness<S>, at: Pos2) {
    harness.hover_at(at);
    harness.drag_at(at);
    harness.drop_at(at);
    harness.run();
}

/// Sets a number as assistive technology does.
pub fn set<S>(harness: &mut Harness<S>, label: &str, value: f64) {
    harness.get_by_label(label).set_value_accesskit(value);
    harness.run();
}

/// Clicks what is called so.
pub fn press<S>(harness: &mut Harness<S>, label: &str) {
    harness.get_by_label(label).click();
    harness.run();
    harness.remove_cursor();
    harness.run();
}

/// Chooses from what opens.
pub fn choose<S>(harness: &mut Harness<S>, label: &str, entry: &str) {
    harness.get_by_label(label).click();
    harness.run();
    harness.get_by_role_and_label(egui::accesskit::Role::Button, entry).click();
    harness.run();
    harness.remove_cursor();
    harness.run();
}

pub fn centre(node: &Node) -> Pos2 {
    node.rect().center()
}

/// Where the opacity is drawn at a value, with the picture from `low` to `high`.
pub fn on_picture(node: &Node, value: f32, (low, high): (f32, f32), opacity: f32) -> Pos2 {
    let rect = node.rect();
    let x = rect.left() + (value - low) / (high - low) * rect.width();
    pos2(x, rect.bottom() - 9.0 - opacity * (rect.height() - 18.0))
}
