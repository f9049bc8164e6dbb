//! Linear colours, brighter than white ones too.

mod picker;

use crate::components::Range;
use egui::{
    Color32, Popup, PopupCloseBehavior, Response, Rgba, Role, Sense, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use glam::Vec3;

/// A linear colour as a screen shows it; what is brighter than white keeps its hue.
pub(super) fn shown(colour: Vec3) -> Color32 {
    let (base, _) = split(colour);
    Rgba::from_rgb(base.x, base.y, base.z).into()
}

/// A colour that a screen can show, and the factor that it is brighter by.
fn split(colour: Vec3) -> (Vec3, f32) {
    let colour = Vec3::select(colour.is_finite_mask(), colour, Vec3::ZERO).max(Vec3::ZERO);
    let brightness = colour.max_element().max(1.0);
    (colour / brightness, brightness)
}

/// A button that shows a colour and opens a picker. Says what the colour became.
pub(super) fn colour_button(
    ui: &mut Ui,
    name: &str,
    colour: Vec3,
    range: Option<Range>,
) -> (Response, Option<Vec3>) {
    let size = vec2(30.0, ui.spacing().interact_size.y);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let [r, g, b, _] = shown(colour).to_array();
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ColorWell, ui.is_enabled(), name);
        info.current_text_value = Some(format!("#{r:02x}{g:02x}{b:02x}"));
        info
    });
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact(&response);
        let patch = rect.shrink(1.0);
        ui.painter().rect_filled(patch, visuals.corner_radius, shown(colour));
        if colour.max_element() > 1.0 {
            // A corner turned down says that there is more than is shown.
            let corner = patch.right_top();
            let points = vec![corner, pos2(corner.x - 8.0, corner.y), pos2(corner.x, corner.y + 8.0)];
            ui.painter().add(egui::Shape::convex_polygon(points, Color32::WHITE, (1.0, Color32::BLACK)));
        }
        let stroke = if response.has_focus() { ui.visuals().selection.stroke } else { visuals.bg_stroke };
        ui.painter().rect_stroke(patch, visuals.corner_radius, stroke, StrokeKind::Outside);
    }
    let mut picked = None;
    Popup::menu(&response).close_behavior(PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
        picked = picker::show(ui, response.id, name, colour, range);
    });
    (response, picked)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bright_colours_keep_their_hue() {
        assert_eq!(shown(Vec3::new(20.0, 10.0, 0.0)), shown(Vec3::new(1.0, 0.5, 0.0)));
        assert_eq!(shown(Vec3::splat(f32::NAN)), Color32::BLACK);
        assert_eq!(shown(Vec3::new(-1.0, 0.0, 1.0)), Color32::from_rgb(0, 0, 255));
        assert_eq!(split(Vec3::splat(0.25)), (Vec3::splat(0.25), 1.0));
    }
}
