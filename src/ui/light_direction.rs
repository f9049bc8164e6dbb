//! A handle for directions of light: a ball, lit as the light would light it, that is dragged about.

use super::edited::settle;
use super::number::Numeric;
use crate::components::Range;
use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{
    Color32, EventFilter, Id, Key, Popup, PopupCloseBehavior, Pos2, Rect, Response, Role, Sense, Shape,
    Stroke, Ui, WidgetInfo, pos2, vec2,
};
use glam::{Quat, Vec2, Vec3};

/// What a person made of a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightDirection {
    /// The direction in which the light travels, of length 1.
    pub direction: Vec3,
    /// Whether the change is complete: it is not while a drag goes on.
    pub finished: bool,
}

/// Diameter of the ball.
const BALL: f32 = 96.0;
/// How near to the handle a press is one on it.
const GRIP: f32 = 9.0;
/// How far an arrow key turns, in degrees; with Shift, a fifth of it.
const KEY_DEGREES: f32 = 5.0;

/// A ball with a handle where the light comes from, and azimuth and elevation of that place in numbers.
///
/// `direction` is that in which the light travels, in the scene; the ball shows it as the view does that `eye_from_scene` turns
/// directions into: x right, y up, z towards the viewer. The handle follows the pointer on the near side; beyond the rim it goes on on
/// the far side, where it is hollow. A press on a hollow handle takes hold of it there. Azimuth is measured about the scene's y axis from z
/// towards x, elevation from the plane of x and z. Arrow keys turn by 5 degrees, with Shift by 1.
pub fn light_direction(
    ui: &mut Ui,
    name: &str,
    direction: Vec3,
    eye_from_scene: Quat,
) -> Option<LightDirection> {
    let id = ui.scope_id().with(("light direction", name));
    let eye_from_scene = turn(eye_from_scene);
    let towards_light = towards(direction);
    let new = ui
        .horizontal(|ui| {
            let dragged = ball(ui, id, name, towards_light, eye_from_scene);
            let typed = ui.vertical(|ui| angles(ui, id, name, towards_light)).inner;
            dragged.or(typed)
        })
        .inner;
    let finished = settle(ui, id, new.is_some())?;
    let direction = new.map_or(direction, |towards_light| rounded(-towards_light));
    Some(LightDirection { direction, finished })
}

/// A small ball that opens a [`light_direction`]; for rows of an inspector, which settle gestures themselves.
pub(super) fn sphere_button(ui: &mut Ui, name: &str, direction: Vec3, eye_from_scene: Quat) -> Option<Vec3> {
    let height = ui.spacing().interact_size.y;
    let (rect, response) = ui.allocate_exact_size(vec2(height, height), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, ui.is_enabled(), name));
    let radius = 0.5 * height - 1.5;
    shade(ui, rect.center(), radius, turn(eye_from_scene) * towards(direction), 4);
    let stroke = if response.has_focus() {
        ui.visuals().selection.stroke
    } else {
        ui.style().interact(&response).bg_stroke
    };
    ui.painter().circle_stroke(rect.center(), radius + 0.5, stroke);
    let mut new = None;
    Popup::menu(&response).close_behavior(PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
        new = light_direction(ui, name, direction, eye_from_scene);
    });
    response.on_hover_text("Turn it by hand");
    new.map(|new| new.direction)
}

/// A rotation; none where it is no rotation.
fn turn(rotation: Quat) -> Quat {
    let is_rotation = rotation.is_finite() && rotation.length_squared() > 1e-12;
    if is_rotation { rotation.normalize() } else { Quat::IDENTITY }
}

/// Where light comes from that travels in this direction; from above, where it has none.
fn towards(direction: Vec3) -> Vec3 {
    let direction = direction.as_dvec3().normalize_or_zero().as_vec3();
    if direction.is_finite() && direction != Vec3::ZERO { -direction } else { Vec3::Y }
}

/// Four decimals are a hundredth of a degree, and read well in a file.
fn rounded(direction: Vec3) -> Vec3 {
    let rounded = (direction * 1e4).round() / 1e4;
    // No negative zeros.
    Vec3::select(rounded.cmpeq(Vec3::ZERO), Vec3::ZERO, rounded)
}

fn ball(ui: &mut Ui, id: Id, name: &str, towards_light: Vec3, eye_from_scene: Quat) -> Option<Vec3> {
    let (rect, _) = ui.allocate_exact_size(vec2(BALL, BALL), Sense::hover());
    let response = ui.interact(rect, id, Sense::click_and_drag());
    let (azimuth, elevation) = azimuth_elevation(towards_light);
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Slider, ui.is_enabled(), name);
        info.current_text_value = Some(format!("azimuth {azimuth:.1}, elevation {elevation:.1} degrees"));
        info
    });
    let radius = 0.5 * BALL - 4.0;
    let in_eye = eye_from_scene * towards_light;
    let handle = rect.center() + radius * vec2(in_eye.x, -in_eye.y);
    let new = dragged(ui, &response, rect.center(), radius, in_eye)
        .or_else(|| turned_by_keys(ui, &response, in_eye));
    if ui.is_rect_visible(rect) {
        draw(ui, &response, rect, radius, in_eye, handle, eye_from_scene);
    }
    response.on_hover_text("Where the light comes from: drag the handle, beyond the rim to the far side");
    new.map(|in_eye| (eye_from_scene.inverse() * in_eye).normalize())
}

/// Where the handle goes that is dragged.
fn dragged(ui: &Ui, response: &Response, centre: Pos2, radius: f32, in_eye: Vec3) -> Option<Vec3> {
    let side_id = response.id.with("far side");
    let is_pressed = response.drag_started() || response.clicked();
    let pointer = response.interact_pointer_pos().filter(|_| response.dragged() || is_pressed)?;
    if is_pressed {
        // Where the press was: a drag starts when the pointer is a little farther.
        let press = ui.input(|input| input.pointer.press_origin()).unwrap_or(pointer);
        let handle = centre + radius * vec2(in_eye.x, -in_eye.y);
        let is_far = in_eye.z < 0.0 && press.distance(handle) <= GRIP;
        ui.data_mut(|data| data.insert_temp(side_id, is_far));
    }
    let is_far = ui.data(|data| data.get_temp::<bool>(side_id)).unwrap_or(false);
    let at = (pointer - centre) / radius;
    Some(on_ball(Vec2::new(at.x, -at.y), is_far)).filter(|new| new.distance(in_eye) > 1e-4)
}

/// The place on the ball of a point in its picture; beyond the rim the sides change, and the way leads back.
fn on_ball(at: Vec2, is_far: bool) -> Vec3 {
    let distance = at.length();
    let (length, is_far) =
        if distance <= 1.0 { (distance, is_far) } else { ((2.0 - distance).max(0.0), !is_far) };
    let at = at.normalize_or_zero() * length;
    let depth = (1.0 - length * length).max(0.0).sqrt();
    Vec3::new(at.x, at.y, if is_far { -depth } else { depth })
}

fn turned_by_keys(ui: &Ui, response: &Response, in_eye: Vec3) -> Option<Vec3> {
    if !response.has_focus() {
        return None;
    }
    let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let (right, up, is_slow) = ui.input(|input| {
        let pressed = |key| f32::from(u8::from(input.key_pressed(key)));
        let right = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
        (right, pressed(Key::ArrowUp) - pressed(Key::ArrowDown), input.modifiers.shift)
    });
    let degrees = if is_slow { 0.2 * KEY_DEGREES } else { KEY_DEGREES };
    let turn = Quat::from_rotation_y((right * degrees).to_radians())
        * Quat::from_rotation_x((-up * degrees).to_radians());
    (right != 0.0 || up != 0.0).then(|| turn * in_eye)
}

fn draw(
    ui: &Ui,
    response: &Response,
    rect: Rect,
    radius: f32,
    in_eye: Vec3,
    handle: Pos2,
    eye_from_scene: Quat,
) {
    shade(ui, rect.center(), radius, in_eye, 24);
    let stroke = if response.has_focus() {
        ui.visuals().selection.stroke
    } else {
        Stroke::new(1.0, ui.style().interact(response).fg_stroke.color.gamma_multiply(0.5))
    };
    ui.painter().circle_stroke(rect.center(), radius, stroke);
    axes(ui, rect.center(), radius, eye_from_scene);
    let yellow = Color32::from_rgb(255, 214, 90);
    let stem = Stroke::new(1.5, yellow.gamma_multiply(if in_eye.z < 0.0 { 0.35 } else { 0.8 }));
    ui.painter().line_segment([rect.center(), handle], stem);
    let (fill, ring) = if in_eye.z < 0.0 {
        (Color32::from_black_alpha(160), Stroke::new(2.0, yellow))
    } else {
        (yellow, Stroke::new(1.0, Color32::BLACK))
    };
    ui.painter().circle(handle, 6.0, fill, ring);
}

/// The scene's axes, in the colours that they usually have.
fn axes(ui: &Ui, centre: Pos2, radius: f32, eye_from_scene: Quat) {
    let axes = [(Vec3::X, (220, 80, 80)), (Vec3::Y, (90, 190, 90)), (Vec3::Z, (90, 130, 240))];
    for (axis, (r, g, b)) in axes {
        let in_eye = eye_from_scene * axis;
        let tip = centre + 0.45 * radius * vec2(in_eye.x, -in_eye.y);
        let alpha = if in_eye.z < -0.01 { 0.4 } else { 1.0 };
        let colour = Color32::from_rgb(r, g, b).gamma_multiply(alpha);
        ui.painter().line_segment([centre, tip], Stroke::new(1.5, colour));
    }
}

/// A matt ball in the light.
fn shade(ui: &Ui, centre: Pos2, radius: f32, in_eye: Vec3, rings: u32) {
    const SEGMENTS: u32 = 64;
    let mut mesh = Mesh::default();
    let colour = |normal: Vec3| {
        let light = normal.dot(in_eye).max(0.0);
        Color32::from_gray((46.0 + 165.0 * light) as u8)
    };
    for ring in 0..=rings {
        // Even in depth rather than in the picture, so that the rim is as smooth as the middle.
        let angle = std::f32::consts::FRAC_PI_2 * ring as f32 / rings as f32;
        for segment in 0..SEGMENTS {
            let turn = std::f32::consts::TAU * segment as f32 / SEGMENTS as f32;
            let normal = Vec3::new(angle.sin() * turn.cos(), angle.sin() * turn.sin(), angle.cos());
            let pos = pos2(centre.x + radius * normal.x, centre.y - radius * normal.y);
            mesh.vertices.push(Vertex { pos, uv: WHITE_UV, color: colour(normal) });
        }
    }
    for ring in 0..rings {
        for segment in 0..SEGMENTS {
            let next = (segment + 1) % SEGMENTS;
            let [a, b] = [segment, next].map(|segment| ring * SEGMENTS + segment);
            mesh.add_triangle(a, b, a + SEGMENTS);
            mesh.add_triangle(b, b + SEGMENTS, a + SEGMENTS);
        }
    }
    ui.painter().add(Shape::mesh(mesh));
}

/// Azimuth and elevation, in degrees, of a place in the scene's sky.
fn azimuth_elevation(towards_light: Vec3) -> (f32, f32) {
    let azimuth = towards_light.x.atan2(towards_light.z).to_degrees();
    let elevation = towards_light.y.atan2(towards_light.x.hypot(towards_light.z)).to_degrees();
    (azimuth, elevation)
}

fn sky(azimuth: f32, elevation: f32) -> Vec3 {
    let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
    Vec3::new(elevation.cos() * azimuth.sin(), elevation.sin(), elevation.cos() * azimuth.cos())
}

/// The same in numbers.
fn angles(ui: &mut Ui, id: Id, name: &str, towards_light: Vec3) -> Option<Vec3> {
    let id = id.with("azimuth");
    let (mut azimuth, elevation) = azimuth_elevation(towards_light);
    if elevation.abs() > 89.9 {
        // At a pole every azimuth is the same: the last one stays.
        azimuth = ui.data(|data| data.get_temp(id)).unwrap_or(azimuth);
    }
    ui.data_mut(|data| data.insert_temp(id, azimuth));
    let number = |ui: &mut Ui, label: &str, value: f32, most: f64| {
        ui.label(label);
        let numeric = Numeric {
            name: &format!("{name} {label}"),
            range: Some(Range::new(-most, most)),
            speed: Some(0.5),
            ..Default::default()
        };
        let value = f64::from((value * 10.0).round() / 10.0);
        let (response, new) = numeric.number(ui, value, 64.0);
        response.on_hover_text("degrees");
        new.map(|new| new as f32)
    };
    ui.spacing_mut().item_spacing.y = 2.0;
    let turned = number(ui, "azimuth", azimuth, 360.0);
    ui.add_space(4.0);
    let raised = number(ui, "elevation", elevation, 90.0);
    if turned.is_none() && raised.is_none() {
        return None;
    }
    let azimuth = turned.unwrap_or(azimuth);
    ui.data_mut(|data| data.insert_temp(id, azimuth));
    Some(sky(azimuth, raised.unwrap_or(elevation)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_directions_are_the_same_thing() {
        for (azimuth, elevation) in [(0.0, 0.0), (90.0, 30.0), (-120.0, -60.0), (179.0, 89.0)] {
            let (a, e) = azimuth_elevation(sky(azimuth, elevation));
            assert!(
                (a - azimuth).abs() < 1e-2 && (e - elevation).abs() < 1e-3,
                "{azimuth} {elevation}: {a} {e}"
            );
        }
        assert_eq!(azimuth_elevation(Vec3::Z), (0.0, 0.0));
        assert!((azimuth_elevation(Vec3::X).0 - 90.0).abs() < 1e-5);
    }

    #[test]
    fn beyond_the_rim_is_the_far_side() {
        assert_eq!(on_ball(Vec2::ZERO, false), Vec3::Z);
        assert_eq!(on_ball(Vec2::ZERO, true), -Vec3::Z);
        assert!(on_ball(Vec2::new(1.5, 0.0), false).distance(Vec3::new(0.5, 0.0, -0.75_f32.sqrt())) < 1e-6);
        assert!(on_ball(Vec2::new(0.0, 9.0), false).distance(-Vec3::Z) < 1e-6);
    }

    #[test]
    fn no_direction_comes_from_above() {
        for nothing in [Vec3::ZERO, Vec3::NAN, Vec3::splat(f32::INFINITY)] {
            assert_eq!(towards(nothing), Vec3::Y);
        }
        assert!(towards(Vec3::new(0.0, 0.0, 1e-30)).distance(-Vec3::Z) < 1e-6);
        assert_eq!(rounded(Vec3::new(-1e-9, 0.333_333, -1.0)).to_string(), "[0, 0.3333, -1]");
    }
}
