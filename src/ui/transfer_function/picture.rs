//! The picture with the curve: what is in view, and what a pointer does beside the handles.

use super::TransferFunctionEditor;
use super::axis::Stretch;
use super::plot::Plot;
use super::shown::Shown;
use crate::components::ControlPoint;
use egui::{
    CursorIcon, EventFilter, Key, PointerButton, Pos2, Rect, Response, Role, Sense, Ui, WidgetInfo, pos2,
    vec2,
};

/// How near to the curve a click adds a point.
const NEAR: f32 = 9.0;
/// By how much a step of a key or a hundred points of a wheel zooms.
const ZOOM: f64 = 1.25;

impl TransferFunctionEditor {
    /// The values in view.
    pub(super) fn view(&self, shown: &Shown) -> Stretch {
        self.view.map_or_else(|| domain(shown), |(view, _)| view)
    }

    pub(super) fn show_domain(&mut self, shown: &Shown) {
        self.view = Some((domain(shown), shown.data.domain));
    }

    pub(super) fn show_data(&mut self, shown: &Shown) {
        if let Some(histogram) = shown.data.histogram {
            let view = Stretch::new(f64::from(histogram.range.0), f64::from(histogram.range.1));
            self.view = Some((view, shown.data.domain));
        }
    }

    fn set_view(&mut self, shown: &Shown, view: Stretch) {
        self.view = Some((view, shown.data.domain));
    }

    /// Draws the picture and answers to the pointer. Where things are in it.
    pub(super) fn picture(&mut self, ui: &mut Ui, shown: &mut Shown) -> Plot {
        self.follow_domain(ui, shown);
        let size = vec2(ui.available_width().clamp(80.0, 4000.0), Plot::HEIGHT);
        let (whole, _) = ui.allocate_exact_size(size, Sense::hover());
        let plot = Plot::new(whole, self.view(shown), shown.data.domain);
        let response = ui.interact(plot.rect, shown.id.with("picture"), Sense::click_and_drag());
        response.widget_info(|| {
            let name = format!("Transfer function of {}", shown.name);
            let mut info = WidgetInfo::labeled(Role::Canvas, ui.is_enabled(), name);
            info.current_text_value = Some(format!("{} to {}", plot.view.low, plot.view.high));
            info
        });
        self.zoom(ui, shown, &response, &plot);
        self.drag_beside(ui, shown, &response, &plot);
        self.keys(ui, shown, &response, &plot);
        // As the view is now, so that nothing lags behind the pointer.
        let plot = Plot::new(whole, self.view(shown), shown.data.domain);
        let histogram = shown.data.histogram.map(|histogram| (histogram, self.is_linear));
        plot.draw(ui, &self.curve, &shown.points, !shown.function.iso.is_empty(), histogram);
        if response.has_focus() {
            let stroke = ui.visuals().selection.stroke;
            ui.painter().rect_stroke(plot.rect, 3.0, stroke, egui::StrokeKind::Inside);
        }
        self.clicks(shown, &response, &plot);
        self.menu(shown, &response, &plot);
        self.handles(ui, shown, &plot);
        self.zoom_stretch(ui, &plot);
        if let Some(pointer) = response.hover_pos().filter(|_| self.drag.is_none()) {
            plot.readout(ui, &self.curve, pointer, shown.data.histogram);
        }
        plot
    }

    /// A domain that changes elsewhere is shown whole; one that is dragged here moves in the view.
    fn follow_domain(&mut self, ui: &Ui, shown: &Shown) {
        let is_dragged = ui.input(|input| input.pointer.any_down());
        match self.view {
            Some((view, of)) if of != shown.data.domain && is_dragged => self.set_view(shown, view),
            Some((_, of)) if of == shown.data.domain => {}
            _ => self.show_domain(shown),
        }
    }

    fn zoom(&mut self, ui: &Ui, shown: &Shown, response: &Response, plot: &Plot) {
        let Some(pointer) = ui.input(|input| input.pointer.hover_pos()).filter(|at| plot.rect.contains(*at))
        else {
            return;
        };
        if !response.contains_pointer() {
            return;
        }
        // Taken away, so that the panel around does not scroll as well.
        let (scroll, pinch) = ui.input_mut(|input| {
            let pinch = input.zoom_delta();
            (std::mem::take(&mut input.smooth_scroll_delta), pinch)
        });
        let whole = everything(shown);
        let factor = ZOOM.powf(-f64::from(scroll.y) / 50.0) / f64::from(pinch.max(1e-3));
        if factor != 1.0 {
            self.set_view(shown, plot.view.zoomed(plot.value_at(pointer.x), factor, whole));
        }
        if scroll.x != 0.0 {
            let by = -f64::from(scroll.x / plot.rect.width()) * plot.view.width();
            self.set_view(shown, self.view(shown).moved(by, whole));
        }
    }

    /// A drag beside the handles moves the view; one with Shift zooms into what it covers.
    fn drag_beside(&mut self, ui: &Ui, shown: &Shown, response: &Response, plot: &Plot) {
        if response.drag_started_by(PointerButton::Primary) && ui.input(|input| input.modifiers.shift) {
            self.zoom_from = ui.input(|input| input.pointer.press_origin()).map(|press| press.x);
        }
        let pointer = response.interact_pointer_pos();
        if let (Some(from), Some(to)) = (self.zoom_from, pointer.map(|pointer| pointer.x)) {
            if response.drag_stopped() {
                self.zoom_from = None;
                if (to - from).abs() >= 4.0 {
                    let stretch = Stretch::new(plot.value_at(from), plot.value_at(to));
                    self.set_view(shown, stretch);
                }
            }
            return;
        }
        if response.dragged() {
            let by = -f64::from(response.drag_delta().x / plot.rect.width()) * plot.view.width();
            self.set_view(shown, plot.view.moved(by, everything(shown)));
        }
        if response.dragged() {
            ui.set_cursor_icon(CursorIcon::Grabbing);
        }
    }

    /// The stretch that is about to be zoomed into.
    fn zoom_stretch(&mut self, ui: &Ui, plot: &Plot) {
        let Some(from) = self.zoom_from else { return };
        let Some(to) = ui.input(|input| input.pointer.latest_pos()).map(|at| at.x) else { return };
        if !ui.input(|input| input.pointer.any_down()) {
            self.zoom_from = None;
            return;
        }
        let across = plot.across();
        let (left, right) = (from.min(to).max(across.min), from.max(to).min(across.max));
        let rect = Rect::from_min_max(pos2(left, plot.rect.top()), pos2(right.max(left), plot.rect.bottom()));
        let selection = ui.visuals().selection;
        ui.painter().rect(
            rect,
            0.0,
            selection.bg_fill.gamma_multiply(0.4),
            selection.stroke,
            egui::StrokeKind::Inside,
        );
    }

    fn keys(&mut self, ui: &Ui, shown: &Shown, response: &Response, plot: &Plot) {
        if !response.has_focus() {
            return;
        }
        let filter = EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let pressed = |keys: &[Key]| ui.input(|input| keys.iter().any(|key| input.key_pressed(*key)));
        let (whole, view) = (everything(shown), plot.view);
        let middle = 0.5 * (view.low + view.high);
        if pressed(&[Key::Plus, Key::Equals]) {
            self.set_view(shown, view.zoomed(middle, 1.0 / ZOOM, whole));
        } else if pressed(&[Key::Minus]) {
            self.set_view(shown, view.zoomed(middle, ZOOM, whole));
        } else if pressed(&[Key::ArrowRight]) {
            self.set_view(shown, view.moved(0.1 * view.width(), whole));
        } else if pressed(&[Key::ArrowLeft]) {
            self.set_view(shown, view.moved(-0.1 * view.width(), whole));
        } else if pressed(&[Key::Home]) {
            self.show_domain(shown);
        }
    }

    /// A click on the curve adds a point; beside it, nothing is chosen any more.
    fn clicks(&mut self, shown: &mut Shown, response: &Response, plot: &Plot) {
        if response.double_clicked() || !response.clicked() {
            return;
        }
        response.request_focus();
        let Some(at) = response.interact_pointer_pos() else { return };
        // Where there are labels a curve takes their place, which no click may do unasked.
        if shown.function.labels.is_empty() && self.is_on_curve(shown, plot, at) {
            self.add_point(shown, super::super::number::round_to(plot.value_at(at.x), plot.grain()));
        } else {
            self.selected = None;
        }
    }

    /// Whether a place is near to the curve, or to the lines between the points.
    fn is_on_curve(&self, shown: &Shown, plot: &Plot, at: Pos2) -> bool {
        let value = plot.value_at(at.x);
        let ControlPoint(.., opacity) = super::curve::between(&shown.points, plot.position(value));
        let is_near = |opacity: f32| (plot.y(opacity) - at.y).abs() <= NEAR;
        is_near(opacity) || self.curve.at(value).is_some_and(|sample| is_near(sample.opacity))
    }

    fn menu(&mut self, shown: &mut Shown, response: &Response, plot: &Plot) {
        // Where the menu was asked for.
        let id = response.id.with("menu at");
        if response.secondary_clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            response.ctx.data_mut(|data| data.insert_temp(id, plot.value_at(at.x)));
        }
        response.context_menu(|ui| {
            let value = ui.data(|data| data.get_temp::<f64>(id)).unwrap_or(plot.view.low);
            let value = super::super::number::round_to(value, plot.grain());
            if ui.button("Add control point here").clicked() {
                self.add_point(shown, value);
                ui.close();
            }
            if ui.button("Add iso value here").clicked() {
                self.add_iso(shown, value);
                ui.close();
            }
            ui.separator();
            if ui.button("Show the domain").clicked() {
                self.show_domain(shown);
                ui.close();
            }
        });
    }
}

fn domain(shown: &Shown) -> Stretch {
    Stretch::new(f64::from(shown.data.domain.0), f64::from(shown.data.domain.1))
}

/// All that is worth looking at.
fn everything(shown: &Shown) -> Stretch {
    let domain = domain(shown);
    shown.data.histogram.map_or(domain, |histogram| {
        domain.with(Stretch::new(f64::from(histogram.range.0), f64::from(histogram.range.1)))
    })
}
