//! The axes of the scene in a corner of the picture; a click on one looks along it.

use super::{Axis, Command};
use crate::view::View;
use bevy_ecs::prelude::*;
use egui::{Align2, Color32, Rect, Role, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2};
use glam::DVec3;

/// Points from the middle to the end of an axis, and the radius of the disc there.
const LENGTH: f32 = 34.0;
const DISC: f32 = 9.0;

pub(super) fn show(ui: &mut Ui, world: &World, picture: Rect, commands: &mut Vec<Command>) {
    let Some(view) = world.get_resource::<View>() else { return };
    let side = 2.0 * (LENGTH + DISC + 2.0);
    if picture.width() < 2.0 * side || picture.height() < 2.0 * side {
        return;
    }
    let middle = picture.left_bottom() + vec2(side / 2.0, -side / 2.0);
    let mut ends = [
        (Axis::Right, DVec3::X, "x", Color32::from_rgb(230, 80, 80)),
        (Axis::Above, DVec3::Y, "y", Color32::from_rgb(110, 200, 90)),
        (Axis::Front, DVec3::Z, "z", Color32::from_rgb(90, 140, 240)),
    ]
    .map(|(axis, direction, name, colour)| {
        (axis, view.eye_from_scene.transform_vector3(direction).normalize_or_zero(), name, colour)
    });
    // What points away from the eye lies behind.
    ends.sort_by(|a, b| a.1.z.total_cmp(&b.1.z));
    for (axis, direction, name, colour) in ends {
        let end = middle + Vec2::new(direction.x as f32, -direction.y as f32) * LENGTH;
        let disc = Rect::from_center_size(end, Vec2::splat(2.0 * DISC));
        let response = ui
            .interact(disc, ui.scope_id().with(name), Sense::click())
            .on_hover_text(format!("Look from +{name}; again, from -{name}"));
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Look from +{name}")));
        let strong = response.hovered() || response.has_focus();
        let colour = if direction.z < -0.2 && !strong { colour.gamma_multiply(0.6) } else { colour };
        ui.painter().line_segment([middle, end], Stroke::new(2.0, colour));
        ui.painter().circle_filled(end, if strong { DISC + 1.0 } else { DISC }, colour);
        let font = egui::TextStyle::Body.resolve(ui.style());
        ui.painter().text(end, Align2::CENTER_CENTER, name, font, Color32::BLACK);
        if response.clicked() {
            commands.push(Command::LookAlong(if direction.z > 0.999 { opposite(axis) } else { axis }));
        }
    }
}

fn opposite(axis: Axis) -> Axis {
    match axis {
        Axis::Right => Axis::Left,
        Axis::Left => Axis::Right,
        Axis::Above => Axis::Below,
        Axis::Below => Axis::Above,
        Axis::Front => Axis::Back,
        Axis::Back => Axis::Front,
    }
}
