//! Picks a colour by hue, saturation and value, and how much brighter than white it is.
//!
//! Not egui's own, whose parts have no names for those who cannot see them and which ends at white.

use super::super::number::{Numeric, round_to};
use super::split;
use crate::components::{Range, Slider};
use egui::ecolor::Hsva;
use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Color32, Id, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};
use glam::Vec3;

/// Width of the picker.
const WIDTH: f32 = 210.0;

/// What the picker last showed: hue and saturation, which black and grey do not tell.
#[derive(Clone, Copy)]
struct Picked {
    colour: Vec3,
    hsva: Hsva,
}

/// The picker. Says what the colour became.
pub(super) fn show(ui: &mut Ui, id: Id, name: &str, colour: Vec3, range: Option<Range>) -> Option<Vec3> {
    let id = id.with("picked");
    let (base, brightness) = split(colour);
    let known = ui.data(|data| data.get_temp::<Picked>(id)).filter(|picked| picked.colour == colour);
    let old = known.map_or_else(|| Hsva::from_rgb(base.to_array()), |picked| picked.hsva);
    ui.set_width(WIDTH);
    ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
    let mut hsva = old;
    square(ui, id, name, &mut hsva);
    strip(ui, id, name, &mut hsva);
    ui.columns(3, |columns| {
        let parts =
            [("hue", &mut hsva.h, 360.0), ("saturation", &mut hsva.s, 1.0), ("value", &mut hsva.v, 1.0)];
        for (ui, (part, value, most)) in columns.iter_mut().zip(parts) {
            ui.label(egui::RichText::new(part).small());
            let numeric = Numeric {
                name: &format!("{name} {part}"),
                range: Some(Range::new(0.0, most)),
                speed: Some(most / 200.0),
                ..Default::default()
            };
            let (_, new) = numeric.number(ui, f64::from(*value) * most, ui.available_width());
            *value = new.map_or(*value, |new| (new / most) as f32);
        }
    });
    let mut new = (hsva != old).then(|| {
        let rounded = Vec3::from(hsva.to_rgb().map(|part| round_to(f64::from(part), 1e-5) as f32));
        brightness * rounded.clamp(Vec3::ZERO, Vec3::ONE)
    });
    if range.is_none_or(|range| range.max > 1.0) {
        ui.label(egui::RichText::new("brightness").small());
        let numeric = Numeric {
            name: &format!("{name} brightness"),
            range: Some(Range::new(1.0, 1e6)),
            slider: Some(Slider::logarithmic(1.0, 100.0)),
            ..Default::default()
        };
        let changed = ui.horizontal(|ui| numeric.show(ui, f64::from(brightness), WIDTH).1).inner;
        // Only what is as bright as white in a channel can be brighter.
        let full = base / base.max_element().max(1e-6);
        new = new.or(changed.map(|brightness| full * brightness as f32));
    }
    if let Some(colour) = new.filter(|new| *new != colour) {
        ui.data_mut(|data| data.insert_temp(id, Picked { colour, hsva }));
        return Some(colour);
    }
    None
}

/// Saturation to the right, value upwards.
fn square(ui: &mut Ui, id: Id, name: &str, hsva: &mut Hsva) {
    const STEPS: u32 = 16;
    let rect = area(ui, 130.0);
    let response = ui.interact(rect, id.with("square"), Sense::click_and_drag());
    named(ui, &response, &format!("{name} saturation and value"));
    if let Some(at) = response.interact_pointer_pos() {
        hsva.s = egui::remap_clamp(at.x, rect.x_range(), 0.0..=1.0);
        hsva.v = egui::remap_clamp(at.y, rect.bottom()..=rect.top(), 0.0..=1.0);
    }
    let mut mesh = Mesh::default();
    for row in 0..=STEPS {
        for column in 0..=STEPS {
            let (s, v) = (column as f32 / STEPS as f32, 1.0 - row as f32 / STEPS as f32);
            let at = pos2(egui::lerp(rect.x_range(), s), egui::lerp(rect.y_range(), 1.0 - v));
            mesh.vertices.push(vertex(at, Hsva::new(hsva.h, s, v, 1.0)));
        }
    }
    for row in 0..STEPS {
        for column in 0..STEPS {
            let first = row * (STEPS + 1) + column;
            mesh.add_triangle(first, first + 1, first + STEPS + 1);
            mesh.add_triangle(first + 1, first + STEPS + 1, first + STEPS + 2);
        }
    }
    ui.painter().add(Shape::mesh(mesh));
    let at = pos2(egui::lerp(rect.x_range(), hsva.s), egui::lerp(rect.y_range(), 1.0 - hsva.v));
    mark(ui, at, *hsva);
}

/// Hue from red to red.
fn strip(ui: &mut Ui, id: Id, name: &str, hsva: &mut Hsva) {
    const STEPS: u32 = 36;
    let rect = area(ui, 16.0);
    let response = ui.interact(rect, id.with("strip"), Sense::click_and_drag());
    named(ui, &response, &format!("{name} hue strip"));
    if let Some(at) = response.interact_pointer_pos() {
        hsva.h = egui::remap_clamp(at.x, rect.x_range(), 0.0..=1.0);
    }
    let mut mesh = Mesh::default();
    for step in 0..=STEPS {
        let hue = step as f32 / STEPS as f32;
        let x = egui::lerp(rect.x_range(), hue);
        for y in [rect.top(), rect.bottom()] {
            mesh.vertices.push(vertex(pos2(x, y), Hsva::new(hue, 1.0, 1.0, 1.0)));
        }
    }
    for first in (0..STEPS).map(|step| 2 * step) {
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first + 1, first + 2, first + 3);
    }
    ui.painter().add(Shape::mesh(mesh));
    let at = pos2(egui::lerp(rect.x_range(), hsva.h), rect.center().y);
    mark(ui, at, Hsva::new(hsva.h, 1.0, 1.0, 1.0));
}

fn area(ui: &mut Ui, height: f32) -> Rect {
    ui.allocate_exact_size(vec2(WIDTH, height), Sense::hover()).0
}

fn named(ui: &Ui, response: &Response, name: &str) {
    response.widget_info(|| WidgetInfo::labeled(Role::Slider, ui.is_enabled(), name));
}

fn vertex(pos: Pos2, colour: Hsva) -> Vertex {
    Vertex { pos, uv: WHITE_UV, color: Color32::from(colour) }
}

fn mark(ui: &Ui, at: Pos2, colour: Hsva) {
    let ring = if colour.v > 0.6 && colour.s < 0.6 { Color32::BLACK } else { Color32::WHITE };
    ui.painter().circle(at, 6.0, Color32::from(colour), Stroke::new(2.0, ring));
}
