//! The line below everything: what is shown, what is still being done, what is wrong.

use super::log::{Level, colour};
use super::{SceneProblems, Shown};
use bevy_ecs::prelude::*;
use egui::{ProgressBar, Ui};

pub(super) fn show(ui: &mut Ui, world: &mut World, shown: &Shown) {
    ui.horizontal(|ui| {
        let ([width, height], [full_width, full_height]) = (shown.pixels, shown.room);
        let full = if shown.is_coarse { format!(" of {full_width} x {full_height}") } else { String::new() };
        ui.label(format!("{width} x {height}{full} pixels in {:.0} ms", shown.took.as_secs_f64() * 1e3))
            .on_hover_text(format!("The picture as it was drawn last, by {}", shown.adapter));
        refinement(ui, shown);
        problems(ui, world, shown);
    });
}

/// How far the light that leaves translucent meshes is refined.
fn refinement(ui: &mut Ui, shown: &Shown) {
    let Some((done, wanted)) = shown.refined.filter(|(done, wanted)| done < wanted) else { return };
    let bar = ProgressBar::new(done as f32 / wanted.max(1) as f32)
        .desired_width(120.0)
        .text(format!("refined {done} of {wanted}"));
    let text = "Sets of samples averaged in the light that leaves translucent meshes. Work stops while you move something";
    let response = ui.add(bar).on_hover_text(text);
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, format!("refined {done} of {wanted}"))
    });
}

/// Why what is shown may not be the scene.
fn problems(ui: &mut Ui, world: &mut World, shown: &Shown) {
    for failure in shown.notice.iter().chain(&shown.failure) {
        ui.colored_label(colour(ui, Level::Error), first_line(failure)).on_hover_text(failure);
    }
    let problems = world.get_resource_or_init::<SceneProblems>();
    let Some(first) = problems.of(None).first() else { return };
    let level = problems.level(None).unwrap_or(Level::Warning);
    ui.colored_label(colour(ui, level), first_line(&first.message))
        .on_hover_ui(|ui| super::problems::list(ui, problems.of(None)));
}

fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}
