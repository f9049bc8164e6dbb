//! The handles of points and iso values: dragged, moved by keys, deleted.

use super::super::colour::shown as shown_colour;
use super::super::number::{round_to, short};
use super::plot::Plot;
use super::shown::Shown;
use super::{Selected, TransferFunctionEditor};
use crate::components::{Classification, ControlPoint, IsoValue};
use egui::{
    Color32, EventFilter, Key, Modifiers, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2,
    WidgetInfo, pos2, vec2,
};

/// A handle that is being dragged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drag {
    grip: Grip,
    /// From the pointer to the handle.
    offset: Vec2,
}

/// What a handle changes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Grip {
    Point(usize),
    Iso(usize),
    /// The width of an iso value, by its end to the left or to the right.
    Width(usize),
}

/// Radius of a handle.
const RADIUS: f32 = 5.0;
/// More in view than this cannot be told apart.
const MOST_HANDLES: usize = 200;
/// The greatest opacity that an iso value is dragged to: an optical depth of about 9.
const MOST_ISO_OPACITY: f32 = 0.9999;

impl TransferFunctionEditor {
    pub(super) fn handles(&mut self, ui: &mut Ui, shown: &mut Shown, plot: &Plot) {
        let in_view = |value: f64| plot.view.contains(value);
        let points: Vec<_> = shown.points.iter().copied().enumerate().collect();
        let points: Vec<_> = points.into_iter().filter(|(_, point)| in_view(plot.value(point.0))).collect();
        let iso: Vec<_> = shown.function.iso.iter().copied().enumerate().collect();
        let iso: Vec<_> = iso.into_iter().filter(|(_, iso)| in_view(f64::from(iso.value))).collect();
        if points.len() + iso.len() > MOST_HANDLES {
            let text =
                format!("{} points and iso values in view: zoom in to change them", points.len() + iso.len());
            let font = egui::FontId::proportional(12.0);
            let colour = ui.visuals().warn_fg_color;
            ui.painter().text(plot.rect.center(), egui::Align2::CENTER_CENTER, text, font, colour);
            return;
        }
        for (index, iso) in iso {
            self.iso_handle(ui, shown, plot, index, iso);
        }
        for (index, point) in points {
            self.point_handle(ui, shown, plot, index, point);
        }
        // What was dragged out of view, or released there, is finished all the same.
        match self.selected {
            Some(Selected::Point(index)) => shown.set_point(ui, index, None),
            Some(Selected::Iso(index)) => shown.set_iso(ui, index, None),
            None => {}
        }
    }

    fn point_handle(
        &mut self,
        ui: &mut Ui,
        shown: &mut Shown,
        plot: &Plot,
        index: usize,
        point: ControlPoint,
    ) {
        let at = pos2(plot.x(plot.value(point.0)), plot.y(point.2));
        let value = short(round_to(plot.value(point.0), plot.grain()));
        let text = format!("value {value}, opacity {}", point.2);
        let name = format!("Control point {}", index + 1);
        let response =
            self.handle(ui, shown, ("point handle", index), at, name, text, Selected::Point(index));
        self.grip(ui, &response, Grip::Point(index), at);
        let mut new = self.dragged_point(&response, shown, plot);
        if new.is_none() && self.drag.is_none() {
            new = moved_by_keys(ui, &response, plot).map(|(by, up)| {
                let position = plot.position(plot.value(point.0) + by);
                (index, ControlPoint(position as f32, point.1, (point.2 + up).clamp(0.0, 1.0)))
            });
        }
        if let Some((index, new)) = new
            && let Some(old) = shown.points.get(index).copied()
        {
            let new = between_neighbours(&shown.points, index, new);
            self.selected = Some(Selected::Point(index));
            shown.set_point(ui, index, (new != old).then_some(new));
        }
        let is_selected = self.selected == Some(Selected::Point(index));
        let ring = ring(ui, &response, is_selected);
        ui.painter().circle(at, if is_selected { RADIUS + 1.0 } else { RADIUS }, shown_colour(point.1), ring);
        if wants_deletion(ui, &response) {
            self.delete(shown, Selected::Point(index));
        }
    }

    /// The point that is dragged, and what becomes of it.
    fn dragged_point(
        &mut self,
        response: &Response,
        shown: &Shown,
        plot: &Plot,
    ) -> Option<(usize, ControlPoint)> {
        let drag = self.drag.filter(|_| response.dragged())?;
        let Grip::Point(index) = drag.grip else { return None };
        let target = response.interact_pointer_pos()? + drag.offset;
        let old = shown.points.get(index)?;
        let position = round_to(plot.position(plot.value_at(target.x)), position_grain(plot)) as f32;
        let opacity = round_to(f64::from(plot.opacity_at(target.y)), 0.001) as f32;
        // Of points in one place the one is dragged that can go that way.
        let is_same =
            |other: usize| shown.points.get(other).is_some_and(|other| other.0 == old.0 && other.2 == old.2);
        let index = if position < old.0 && index > 0 && is_same(index - 1) {
            index - 1
        } else if position > old.0 && is_same(index + 1) {
            index + 1
        } else {
            index
        };
        self.drag = Some(Drag { grip: Grip::Point(index), ..drag });
        Some((index, ControlPoint(position, shown.points[index].1, opacity)))
    }

    fn iso_handle(&mut self, ui: &mut Ui, shown: &mut Shown, plot: &Plot, index: usize, iso: IsoValue) {
        let (value, opacity) = (f64::from(iso.value), opacity_of(iso.absorption));
        let at = pos2(plot.x(value), plot.y(opacity));
        let colour = shown_colour(iso.color);
        ui.painter().line_segment(
            [pos2(at.x, plot.y(0.0)), at],
            Stroke::new(1.0, ui.visuals().strong_text_color().gamma_multiply(0.6)),
        );
        let text = format!("value {}, width {}, absorption {}", iso.value, iso.width, iso.absorption);
        let name = format!("Iso value {}", index + 1);
        let response = self.handle(ui, shown, ("iso handle", index), at, name, text, Selected::Iso(index));
        self.grip(ui, &response, Grip::Iso(index), at);
        let mut new = None;
        if let Some(target) = self.target(&response, Grip::Iso(index)) {
            let value = round_to(plot.value_at(target.x), plot.grain()) as f32;
            new = Some(IsoValue { value, absorption: absorption_of(plot.opacity_at(target.y)), ..iso });
        } else if let Some((by, up)) = moved_by_keys(ui, &response, plot) {
            let absorption = if up == 0.0 { iso.absorption } else { absorption_of(opacity + up) };
            new = Some(IsoValue { value: (value + by) as f32, absorption, ..iso });
        }
        let is_selected = self.selected == Some(Selected::Iso(index));
        if is_selected {
            new = new.or(self.width_handles(ui, shown, plot, index, iso));
        }
        if let Some(new) = new.filter(|new| *new != iso && new.value.is_finite()) {
            self.selected = Some(Selected::Iso(index));
            shown.set_iso(ui, index, Some(new));
        }
        let size = if is_selected { RADIUS + 2.0 } else { RADIUS + 1.0 };
        diamond(ui, at, size, colour, ring(ui, &response, is_selected));
        if wants_deletion(ui, &response) {
            self.delete(shown, Selected::Iso(index));
        }
    }

    /// Handles at both sides of a layer, where it is half as deep as at its peak.
    fn width_handles(
        &mut self,
        ui: &mut Ui,
        shown: &mut Shown,
        plot: &Plot,
        index: usize,
        iso: IsoValue,
    ) -> Option<IsoValue> {
        let y = plot.y(opacity_of(0.5 * iso.absorption));
        let mut new = None;
        for (side, name) in [(-0.5, "left"), (0.5, "right")] {
            let at = pos2(plot.x(f64::from(iso.value) + side * f64::from(iso.width)), y);
            let id = shown.id.with(("width handle", index, name));
            let rect = Rect::from_center_size(at, vec2(12.0, 14.0));
            let response = ui.interact(rect, id, Sense::click_and_drag());
            response.widget_info(|| {
                let name = format!("Width of iso value {}, {name}", index + 1);
                WidgetInfo::slider(ui.is_enabled(), f64::from(iso.width), name)
            });
            self.grip(ui, &response, Grip::Width(index), at);
            let least = least_width(shown, plot);
            let width = if let Some(target) = self.target(&response, Grip::Width(index)) {
                Some(round_to(2.0 * (plot.value_at(target.x) - f64::from(iso.value)).abs(), plot.grain())
                    as f32)
            } else {
                let keys = moved_by_keys(ui, &response, plot);
                keys.map(|(by, _)| iso.width + (2.0 * side.signum() * by) as f32)
            };
            new = new.or(width.map(|width| IsoValue { width: width.max(least), ..iso }));
            let ring = ring(ui, &response, false);
            ui.painter().rect(
                rect.shrink2(vec2(4.0, 3.0)),
                1.0,
                shown_colour(iso.color),
                ring,
                egui::StrokeKind::Middle,
            );
        }
        new
    }

    /// A handle that can be dragged and chosen.
    #[allow(clippy::too_many_arguments, reason = "each is another side of one handle")]
    fn handle(
        &mut self,
        ui: &Ui,
        shown: &mut Shown,
        salt: (&str, usize),
        at: Pos2,
        name: String,
        text: String,
        selects: Selected,
    ) -> Response {
        let rect = Rect::from_center_size(at, Vec2::splat(2.0 * RADIUS + 5.0));
        let response = ui.interact(rect, shown.id.with(salt), Sense::click_and_drag());
        response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::Slider, ui.is_enabled(), &name);
            info.current_text_value = Some(text.clone());
            info
        });
        if response.clicked() || response.drag_started() || response.secondary_clicked() {
            response.request_focus();
        }
        if response.clicked() || response.drag_started() || response.gained_focus() {
            self.selected = Some(selects);
        }
        let mut is_deleted = false;
        response.context_menu(|ui| {
            if ui.button("Delete").clicked() {
                is_deleted = true;
                ui.close();
            }
        });
        if is_deleted {
            self.delete(shown, selects);
        }
        response.on_hover_text(format!("{name}\n{text}\nArrow keys move it, Delete deletes it"))
    }

    fn grip(&mut self, ui: &Ui, response: &Response, grip: Grip, at: Pos2) {
        if response.drag_started() {
            let press = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
            self.drag = Some(Drag { grip, offset: at - press });
        }
        if response.drag_stopped() {
            self.drag = None;
        }
    }

    fn target(&self, response: &Response, grip: Grip) -> Option<Pos2> {
        let drag = self.drag.filter(|drag| drag.grip == grip && response.dragged())?;
        Some(response.interact_pointer_pos()? + drag.offset)
    }

    pub(super) fn delete(&mut self, shown: &mut Shown, what: Selected) {
        if shown.is_last() {
            self.tell(
                "The last one stays: a function without points and iso values is a ramp from clear to white.",
            );
            return;
        }
        match what {
            Selected::Point(index) => {
                shown.remove_point(index);
                let left = shown.points.len().saturating_sub(1);
                self.selected = (left > 0).then(|| Selected::Point(index.saturating_sub(1)));
            }
            Selected::Iso(index) => {
                shown.remove_iso(index);
                let left = shown.function.iso.len().saturating_sub(1);
                self.selected = (left > 0).then(|| Selected::Iso(index.saturating_sub(1)));
            }
        }
    }
}

/// A point goes as far as those before and behind it.
pub(super) fn between_neighbours(points: &[ControlPoint], index: usize, point: ControlPoint) -> ControlPoint {
    let least =
        index.checked_sub(1).and_then(|before| points.get(before)).map_or(0.0, |before| before.0.max(0.0));
    let most = points.get(index + 1).map_or(1.0, |behind| behind.0.min(1.0));
    // Not `clamp`, which wants what only a sorted list has.
    ControlPoint(point.0.min(most).max(least), point.1, point.2)
}

/// The least width of an iso value: only with `PreIntegrated` may it have none.
pub(super) fn least_width(shown: &Shown, plot: &Plot) -> f32 {
    match shown.function.classification {
        Classification::PreIntegrated => 0.0,
        _ => (plot.grain() * 0.1).max(f64::from(f32::MIN_POSITIVE)) as f32,
    }
}

/// What a layer of this optical depth absorbs.
fn opacity_of(absorption: f32) -> f32 {
    -(-absorption.max(0.0)).exp_m1()
}

fn absorption_of(opacity: f32) -> f32 {
    let depth = -f64::from(-opacity.clamp(0.0, MOST_ISO_OPACITY)).ln_1p();
    super::super::number::round_to_digits(depth, 3) as f32
}

fn position_grain(plot: &Plot) -> f64 {
    plot.grain() / (plot.domain.1 - plot.domain.0).abs().max(f64::MIN_POSITIVE)
}

/// Data values to the right, and opacity upwards, by which arrow keys move what has the focus; with Shift a tenth of it.
fn moved_by_keys(ui: &Ui, response: &Response, plot: &Plot) -> Option<(f64, f32)> {
    if !response.has_focus() {
        return None;
    }
    let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let (right, up, is_fine) = ui.input(|input| {
        let pressed = |key| i8::from(input.key_pressed(key));
        let right = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
        (right, pressed(Key::ArrowUp) - pressed(Key::ArrowDown), input.modifiers.shift)
    });
    let part = if is_fine { 0.1 } else { 1.0 };
    let by = f64::from(right) * round_to(part * plot.view.width() / 100.0, part * plot.view.width() / 100.0);
    (right != 0 || up != 0).then_some((by, f32::from(up) * 0.01 * part as f32))
}

fn wants_deletion(ui: &Ui, response: &Response) -> bool {
    let keys = [Key::Delete, Key::Backspace];
    response.has_focus()
        && ui.input_mut(|input| keys.iter().any(|key| input.consume_key(Modifiers::NONE, *key)))
}

fn ring(ui: &Ui, response: &Response, is_selected: bool) -> Stroke {
    if response.has_focus() {
        return Stroke::new(2.5, ui.visuals().selection.stroke.color);
    }
    match is_selected || response.hovered() {
        true => Stroke::new(2.0, ui.visuals().strong_text_color()),
        false => Stroke::new(1.5, Color32::from_gray(200)),
    }
}

fn diamond(ui: &Ui, at: Pos2, size: f32, fill: Color32, ring: Stroke) {
    let corners = [vec2(0.0, -size), vec2(size, 0.0), vec2(0.0, size), vec2(-size, 0.0)];
    let corners = corners.map(|corner| at + corner).to_vec();
    ui.painter().add(Shape::convex_polygon(corners, fill, ring));
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn points_stay_between_their_neighbours() {
        let at = |position| ControlPoint(position, Vec3::ONE, 0.5);
        let points = [at(0.2), at(0.5), at(0.5), at(0.9)];
        assert_eq!(between_neighbours(&points, 1, at(0.1)).0, 0.2);
        assert_eq!(between_neighbours(&points, 1, at(0.8)).0, 0.5);
        assert_eq!(between_neighbours(&points, 0, at(-3.0)).0, 0.0);
        assert_eq!(between_neighbours(&points, 3, at(7.0)).0, 1.0);
        let unsorted = [at(0.9), at(0.5), at(0.1)];
        assert!(between_neighbours(&unsorted, 1, at(0.5)).0.is_finite());
        let nothing = [at(f32::NAN), at(0.5), at(f32::NAN)];
        assert_eq!(between_neighbours(&nothing, 1, at(0.4)).0, 0.4);
    }

    #[test]
    fn opacity_and_depth_are_each_others_inverse() {
        for opacity in [0.0, 0.25, 0.9] {
            assert!((opacity_of(absorption_of(opacity)) - opacity).abs() < 2e-3);
        }
        assert!(absorption_of(1.0).is_finite() && absorption_of(f32::INFINITY).is_finite());
    }
}
