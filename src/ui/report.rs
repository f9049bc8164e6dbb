//! What the last picture took: passes, times, memory.

use super::{Command, LastReload, Totals};
use crate::report::{PassRecord, Report};
use bevy_ecs::prelude::*;
use egui::{Grid, ScrollArea, Ui};

pub(super) fn show(ui: &mut Ui, world: &mut World, commands: &mut Vec<Command>) {
    let totals = world.get_resource_or_init::<Totals>().clone();
    let report = world.get_resource_or_init::<Report>().clone();
    let reload = world.get_resource_or_init::<LastReload>().0.clone();
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            Grid::new("passes").striped(true).num_columns(5).show(ui, |ui| passes(ui, &report, &totals));
            ui.separator();
            Grid::new("memory").striped(true).num_columns(2).show(ui, |ui| memory(ui, &report));
            ui.separator();
            ui.vertical(|ui| {
                Grid::new("times").striped(true).num_columns(2).show(ui, |ui| {
                    times(ui, "the last picture", "What it took the processor, and then the device", &report.timeline);
                    let tip = "From the first sign of a change to the first picture that shows it, coarse as it may be";
                    times(ui, "after the last change of files", tip, &reload);
                });
                for (pass, lights) in &report.sharing_lights {
                    let tip = "There is not enough memory, or there are not enough textures, to keep what each of them brings: a change of one makes all of it anew";
                    ui.label(format!("{lights} lights share one sum of {pass}")).on_hover_text(tip);
                }
                let tip = "Give up all that is on the graphics device and make it again on another, as is done by itself when the driver loses it";
                if ui.button("Reopen the device").on_hover_text(tip).clicked() {
                    commands.push(Command::ReopenDevice);
                }
            });
        });
    });
}

fn passes(ui: &mut Ui, report: &Report, totals: &Totals) {
    let heads = [
        ("pass", "In the order of their names"),
        ("runs", "In the last picture; what has not changed is not made again"),
        ("ms", "In the last picture, by the GPU's clock where it has one"),
        ("on", "What the last picture worked on"),
        ("ever", "Runs since the window opened"),
    ];
    for (head, tip) in heads {
        ui.strong(head).on_hover_text(tip);
    }
    ui.end_row();
    let none = PassRecord::default();
    for (pass, ever) in &totals.0 {
        let record = report.passes.get(pass).unwrap_or(&none);
        ui.label(*pass);
        ui.label(if record.runs == 0 { "–".into() } else { record.runs.to_string() });
        ui.label(record.milliseconds.map_or("–".into(), |time| format!("{time:.1}")));
        let work = record.work.iter().map(|(unit, amount)| format!("{} {unit}", short(*amount)));
        ui.label(work.collect::<Vec<_>>().join(", "));
        ui.label(ever.to_string());
        ui.end_row();
    }
}

fn memory(ui: &mut Ui, report: &Report) {
    ui.strong("held on the GPU");
    ui.strong("MiB");
    ui.end_row();
    let mebibytes = |bytes: u64| format!("{:.1}", bytes as f64 / f64::from(1 << 20));
    for (what, bytes) in &report.gpu_bytes {
        ui.label(*what);
        ui.label(mebibytes(*bytes));
        ui.end_row();
    }
    ui.strong("all of it");
    ui.strong(mebibytes(report.gpu_bytes.values().copied().fold(0, u64::saturating_add)));
    ui.end_row();
}

fn times(ui: &mut Ui, head: &str, tip: &str, timeline: &[(&'static str, f64)]) {
    if timeline.is_empty() {
        return;
    }
    ui.strong(head).on_hover_text(tip);
    ui.strong("ms");
    ui.end_row();
    for (part, milliseconds) in timeline {
        ui.label(*part);
        ui.label(format!("{milliseconds:.1}"));
        ui.end_row();
    }
}

/// A number in three digits or so.
fn short(amount: u64) -> String {
    match amount {
        0..10_000 => amount.to_string(),
        10_000..10_000_000 => format!("{} k", amount / 1000),
        _ => format!("{} M", amount / 1_000_000),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn amounts_are_short() {
        assert_eq!([9_999, 518_400, 31_700_000].map(super::short), ["9999", "518 k", "31 M"]);
    }
}
