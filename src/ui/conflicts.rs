//! What was edited here and changed in the files too, until somebody chooses.

use super::edit::{tell, with_edits};
use crate::scene::{Conflict, Edits, Side};
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::AppTypeRegistry;
use bevy_reflect::TypeRegistry;
use egui::{Label, Panel, RichText, ScrollArea, Ui};

/// Points that the list takes of the window at most.
const HEIGHT: f32 = 160.0;

pub(super) fn show(ui: &mut Ui, world: &mut World) {
    let registry = world.get_resource_or_init::<AppTypeRegistry>().clone();
    let Some(edits) = world.get_resource::<Edits>().filter(|edits| !edits.conflicts().is_empty()) else {
        return;
    };
    let chosen = Panel::top("conflicts").show(ui, |ui| list(ui, edits.conflicts(), &registry.read())).inner;
    let Some((conflict, side)) = chosen else { return };
    let resolved = with_edits(world, |edits, world| edits.resolve(world, conflict, side));
    if let Some(Err(error)) = resolved {
        tell(world, error.to_string());
    }
}

/// Lists conflicts, and says which was decided how.
fn list(ui: &mut Ui, conflicts: &[Conflict], registry: &TypeRegistry) -> Option<(u64, Side)> {
    let mut chosen = None;
    ui.strong("Changed here and in the files, and not to the same");
    ScrollArea::vertical().max_height(HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
        for conflict in conflicts {
            let subject = subject(conflict);
            ui.horizontal(|ui| {
                let sides = [
                    ("Ours", Side::Ours, &conflict.ours, "Keep what was changed here"),
                    ("Theirs", Side::Theirs, &conflict.theirs, "Keep what the file has now, which is shown"),
                ];
                for (name, side, version, tip) in sides {
                    let text = version.text(registry);
                    let text = if version.is_nothing() { "nothing".to_owned() } else { text };
                    let button = ui.button(name).on_hover_text(format!("{tip}: {text}"));
                    button.widget_info(|| {
                        egui::WidgetInfo::labeled(egui::Role::Button, true, format!("{name}: {subject}"))
                    });
                    if button.clicked() {
                        chosen = Some((conflict.id, side));
                    }
                }
                ui.label(&subject);
                let line = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
                let (ours, theirs) =
                    (line(conflict.ours.text(registry)), line(conflict.theirs.text(registry)));
                ui.add(Label::new(RichText::new(format!("{ours} | {theirs}")).weak()).truncate());
            });
        }
    });
    chosen
}

/// What a conflict is about, `bunny.Subsurface.material`.
fn subject(conflict: &Conflict) -> String {
    let parts = [conflict.entity.as_deref().unwrap_or_default(), &conflict.path];
    let named: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    if named.is_empty() { "the head of the scene".into() } else { named.join(".") }
}
