//! Rows of two columns, aligned however deep a field lies.

use super::icons::{ICON_WIDTH, disclosure};
use egui::{
    Align, Id, Label, Layout, Rect, Response, RichText, Role, Sense, Ui, UiBuilder, WidgetInfo, pos2,
    text::LayoutJob, vec2,
};

/// How far what belongs to a row stands to its right.
pub(in crate::ui) const INDENT: f32 = 12.0;
/// Space for the triangle of rows that open.
const TRIANGLE: f32 = 14.0;

/// Where the columns of a panel are.
#[derive(Clone, Copy, Debug)]
pub(in crate::ui) struct Columns {
    /// Where values begin.
    split: f32,
    /// Where values end; behind it there is space for a button.
    right: f32,
}

impl Columns {
    pub fn of(ui: &Ui) -> Self {
        let left = ui.max_rect().left();
        let width = if ui.available_width().is_finite() { ui.available_width() } else { 320.0 };
        Self { split: left + (0.4 * width).clamp(90.0, 190.0), right: left + width - ICON_WIDTH - 2.0 }
    }

    /// The same with values that end earlier.
    pub fn narrowed(self, by: f32) -> Self {
        Self { right: self.right - by, ..self }
    }

    /// A row: its label, its value, and a button behind them.
    pub fn row<R>(
        self,
        ui: &mut Ui,
        label: impl FnOnce(&mut Ui),
        value: impl FnOnce(&mut Ui) -> R,
        behind: impl FnOnce(&mut Ui),
    ) -> R {
        let height = ui.spacing().interact_size.y;
        let width = (self.right + ICON_WIDTH + 2.0 - ui.cursor().left()).max(0.0);
        let (rect, _) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
        let part = |from: f32, to: f32| {
            Rect::from_min_max(pos2(from, rect.top()), pos2(to.max(from), rect.bottom()))
        };
        let mut within = |salt: &str, rect: Rect| {
            let layout = Layout::left_to_right(Align::Center);
            let mut child = ui.new_child(UiBuilder::new().id_salt(salt).max_rect(rect).layout(layout));
            child.spacing_mut().item_spacing.x = 4.0;
            child
        };
        label(&mut within("label", part(rect.left(), self.split - 6.0)));
        let result = value(&mut within("value", part(self.split, self.right)));
        behind(&mut within("behind", part(self.right + 2.0, self.right + 2.0 + ICON_WIDTH)));
        result
    }

    /// The right end of a row that begins at `top`, so wide that it reaches to its left into the column of values.
    pub fn behind(self, top: f32, height: f32, width: f32) -> Rect {
        let right = self.right + ICON_WIDTH + 2.0;
        Rect::from_min_max(pos2(right - width, top), pos2(right, top + height))
    }

    /// What is wrong with the rows above.
    pub fn complaint(self, ui: &mut Ui, message: &str) {
        ui.horizontal(|ui| {
            ui.add_space((ui.cursor().left() - ui.max_rect().left()).max(0.0) + TRIANGLE);
            let text = RichText::new(message).color(ui.visuals().error_fg_color).small();
            ui.add(Label::new(text).wrap());
        });
    }
}

/// A label that stands where others have a triangle.
pub(in crate::ui) fn label(ui: &mut Ui, text: LayoutJob) -> Response {
    ui.add_space(TRIANGLE);
    ui.add(Label::new(text).truncate().selectable(false).sense(Sense::hover()))
}

/// A label that opens and closes what belongs to it; remembers which.
pub(in crate::ui) fn opening_label(ui: &mut Ui, id: Id, text: LayoutJob, opens: bool) -> (Response, bool) {
    let id = id.with("is open");
    let mut is_open = ui.data_mut(|data| *data.get_persisted_mut_or(id, opens));
    let rect = ui.available_rect_before_wrap();
    let response = ui.interact(rect, id, Sense::click());
    if response.clicked() {
        is_open = !is_open;
        ui.data_mut(|data| data.insert_persisted(id, is_open));
    }
    let name = text.text.clone();
    response.widget_info(|| WidgetInfo::selected(Role::DisclosureTriangle, ui.is_enabled(), is_open, &name));
    let visuals = *ui.style().interact(&response);
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, visuals.corner_radius, ui.visuals().faint_bg_color);
    }
    if response.has_focus() {
        ui.painter().rect_stroke(rect, visuals.corner_radius, visuals.bg_stroke, egui::StrokeKind::Inside);
    }
    disclosure(ui, pos2(rect.left() + 6.0, rect.center().y), is_open, visuals.fg_stroke.color);
    let mut job = text;
    job.wrap = egui::text::TextWrapping::truncate_at_width((rect.width() - TRIANGLE).max(0.0));
    let galley = ui.painter().layout_job(job);
    let at = pos2(rect.left() + TRIANGLE, rect.center().y - 0.5 * galley.size().y);
    ui.painter().galley(at, galley, ui.visuals().text_color());
    (response, is_open)
}

/// A text on the line of a row, cut off where the row ends.
pub(in crate::ui) fn note(ui: &mut Ui, text: &str) -> Response {
    let text = RichText::new(text).color(ui.visuals().weak_text_color());
    ui.add(Label::new(text).truncate().selectable(false))
}
