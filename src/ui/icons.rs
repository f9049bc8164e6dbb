//! Small buttons that show a sign. Drawn, because fonts for signs are large and lack some.

use egui::{Color32, Pos2, Response, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};

/// What a button shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Icon {
    Add,
    Remove,
    Up,
    Down,
    Left,
    Right,
    Reset,
}

/// Width of a button with an icon.
pub(super) const ICON_WIDTH: f32 = 18.0;

/// A button with an icon. `name` says what it does, to those who hover and those who listen.
pub(super) fn icon_button(ui: &mut Ui, icon: Icon, name: &str) -> Response {
    let size = vec2(ICON_WIDTH, ui.spacing().interact_size.y);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, ui.is_enabled(), name));
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact(&response);
        if response.hovered() || response.has_focus() {
            let back = rect.shrink2(vec2(0.0, 1.0));
            ui.painter().rect(
                back,
                visuals.corner_radius,
                visuals.weak_bg_fill,
                visuals.bg_stroke,
                egui::StrokeKind::Inside,
            );
        }
        let colour = if ui.is_enabled() { visuals.fg_stroke.color } else { ui.visuals().weak_text_color() };
        draw(ui, icon, rect.center(), colour);
    }
    response.on_hover_text(name)
}

/// A triangle that points down where something is open, and to the right where it is closed.
pub(super) fn disclosure(ui: &Ui, centre: Pos2, is_open: bool, colour: Color32) {
    draw(ui, if is_open { Icon::Down } else { Icon::Right }, centre, colour);
}

fn draw(ui: &Ui, icon: Icon, centre: Pos2, colour: Color32) {
    let stroke = Stroke::new(1.5, colour);
    let line = |from: Vec2, to: Vec2| {
        ui.painter().line_segment([centre + from, centre + to], stroke);
    };
    match icon {
        Icon::Add => {
            line(vec2(-4.0, 0.0), vec2(4.0, 0.0));
            line(vec2(0.0, -4.0), vec2(0.0, 4.0));
        }
        Icon::Remove => {
            line(vec2(-3.0, -3.0), vec2(3.0, 3.0));
            line(vec2(-3.0, 3.0), vec2(3.0, -3.0));
        }
        Icon::Up => triangle(ui, centre, vec2(0.0, -1.0), colour),
        Icon::Down => triangle(ui, centre, vec2(0.0, 1.0), colour),
        Icon::Left => triangle(ui, centre, vec2(-1.0, 0.0), colour),
        Icon::Right => triangle(ui, centre, vec2(1.0, 0.0), colour),
        Icon::Reset => {
            // Three quarters of a circle with an arrow at its beginning.
            let radius = 3.8;
            let at = |turn: f32| {
                let angle = std::f32::consts::TAU * turn;
                centre + radius * vec2(angle.cos(), angle.sin())
            };
            let arc: Vec<Pos2> = (0..=12).map(|step| at(-0.45 + 0.8 * step as f32 / 12.0)).collect();
            let start = arc[0];
            ui.painter().add(Shape::line(arc, stroke));
            triangle(ui, pos2(start.x, start.y + 0.5), vec2(-0.6, 0.8), colour);
        }
    }
}

fn triangle(ui: &Ui, centre: Pos2, towards: Vec2, colour: Color32) {
    let (tip, side) = (3.4 * towards, 3.4 * vec2(-towards.y, towards.x));
    let corners = vec![centre + tip, centre - tip + side, centre - tip - side];
    ui.painter().add(Shape::convex_polygon(corners, colour, Stroke::NONE));
}
