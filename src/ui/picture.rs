//! The picture: shown, turned, moved, zoomed, and split by the line of a comparison.

use super::{Command, Shown, axes, shading};
use crate::view::Comparison;
use bevy_ecs::prelude::*;
use egui::{
    Color32, CursorIcon, EventFilter, Key, PointerButton, Pos2, Rect, Response, Role, Sense, Stroke, Ui,
    Vec2, WidgetInfo, pos2, vec2,
};
use glam::DVec2;

/// What a key moves: as much as a drag over so many heights of the picture.
const KEY_STEP: f64 = 0.04;

/// Factor of a key that zooms.
const KEY_ZOOM: f64 = 1.15;

/// Points of scrolling that zoom by the factor e.
const SCROLL: f64 = 300.0;

/// Shows the picture in all the room that is left, and says which room that is.
pub(super) fn show(
    ui: &mut Ui,
    world: &mut World,
    shown: &Shown,
    with_axes: bool,
    commands: &mut Vec<Command>,
) -> Rect {
    let rect = ui.available_rect_before_wrap();
    let response = ui.interact(
        rect,
        ui.scope_id().with("picture"),
        Sense::click_and_drag() | Sense::focusable_noninteractive(),
    );
    let label = "Picture of the scene. Drag to turn it, with Shift or the right button to move it, scroll to zoom; arrow keys likewise";
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, label));
    if let Some(texture) = shown.texture {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        ui.painter().image(texture, rect, whole, Color32::WHITE);
    }
    if response.has_focus() {
        ui.painter().rect_stroke(rect, 0.0, ui.visuals().selection.stroke, egui::StrokeKind::Inside);
    }
    pointer(ui, &response, rect, commands);
    keys(ui, &response, commands);
    split(ui, world, rect);
    if with_axes {
        axes::show(ui, world, rect, commands);
    }
    rect
}

fn pointer(ui: &Ui, response: &Response, rect: Rect, commands: &mut Vec<Command>) {
    let height = f64::from(rect.height().max(1.0));
    let moved = response.drag_delta();
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    if response.double_clicked() {
        commands.push(Command::Frame(None));
    }
    if moved != Vec2::ZERO {
        let by = DVec2::new(f64::from(moved.x), f64::from(moved.y)) / height;
        let is_pan = !response.dragged_by(PointerButton::Primary) || ui.input(|input| input.modifiers.shift);
        commands.push(if is_pan { Command::Pan(by) } else { Command::Orbit(by) });
    }
    if let Some(at) = response.hover_pos() {
        // Pinching, or turning the wheel with Ctrl, is a zoom already; with Shift the wheel scrolls sideways.
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta(), input.zoom_delta()));
        let factor = (-f64::from(scroll.x + scroll.y) / SCROLL).exp() / f64::from(pinch);
        if factor != 1.0 {
            let from_middle = (at - rect.center()) * vec2(1.0, -1.0);
            let cursor = DVec2::new(f64::from(from_middle.x), f64::from(from_middle.y)) * 2.0 / height;
            commands.push(Command::Zoom { factor, cursor });
        }
    }
}

/// What keys do while the picture has the focus.
fn keys(ui: &Ui, response: &Response, commands: &mut Vec<Command>) {
    if !response.has_focus() {
        return;
    }
    let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    let pressed = |key: Key| ui.input(|input| input.num_presses(key) as f64);
    let by = DVec2::new(
        pressed(Key::ArrowRight) - pressed(Key::ArrowLeft),
        pressed(Key::ArrowDown) - pressed(Key::ArrowUp),
    ) * KEY_STEP;
    if by != DVec2::ZERO {
        let is_pan = ui.input(|input| input.modifiers.shift);
        commands.push(if is_pan { Command::Pan(by) } else { Command::Orbit(by) });
    }
    let closer = pressed(Key::Plus) + pressed(Key::Equals) - pressed(Key::Minus);
    if closer != 0.0 {
        commands.push(Command::Zoom { factor: KEY_ZOOM.powf(-closer), cursor: DVec2::ZERO });
    }
}

/// The line between two shadings, and its handle.
fn split(ui: &mut Ui, world: &mut World, rect: Rect) {
    let mut comparison = world.get_resource_or_init::<Comparison>();
    let Some(mut split) = comparison.0 else { return };
    let x = rect.left() + split.at * rect.width();
    let handle = Rect::from_center_size(pos2(x, rect.center().y), vec2(14.0, rect.height()));
    let response = ui
        .interact(handle, ui.scope_id().with("split"), Sense::drag() | Sense::focusable_noninteractive())
        .on_hover_cursor(CursorIcon::ResizeHorizontal)
        .on_hover_text("Drag the line, or focus it and press the left and right arrow keys");
    if response.drag_started() {
        response.request_focus();
    }
    if response.has_focus() {
        let arrows = EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        let pressed = |key: Key| ui.input(|input| input.num_presses(key) as f32);
        split.at += 0.02 * (pressed(Key::ArrowRight) - pressed(Key::ArrowLeft));
    }
    split.at = (split.at + response.drag_delta().x / rect.width().max(1.0)).clamp(0.0, 1.0);
    response.widget_info(|| WidgetInfo::slider(true, f64::from(split.at), "Line between two shadings"));
    comparison.set_if_neq(Comparison(Some(split)));
    let width = if response.hovered() || response.dragged() || response.has_focus() { 3.0 } else { 1.0 };
    ui.painter().vline(x, rect.y_range(), Stroke::new(width, Color32::WHITE));
    let top = rect.top() + 6.0;
    let font = egui::TextStyle::Body.resolve(ui.style());
    let sides =
        [(x - 8.0, egui::Align2::RIGHT_TOP, split.left), (x + 8.0, egui::Align2::LEFT_TOP, split.right)];
    for (at, align, side) in sides {
        ui.painter().text(pos2(at, top), align, shading::name(side), font.clone(), Color32::WHITE);
    }
}
