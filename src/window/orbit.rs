//! A camera that turns about a point: pure mathematics, in 64 bits.
//!
//! Yaw and pitch are kept as angles about the scene's up, and pitch ends at the poles: the picture never turns over, and looking straight
//! down is as good a view as any. In perspective and in an orthographic view alike the camera's *distance* says how large things at the target
//! appear, so that one becomes the other without a jump there.

use crate::components::Projection;
use crate::ui::Axis;
use crate::view::Viewpoint;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Opposite corners of a box in the scene.
pub type Bounds = (DVec3, DVec3);

/// A camera that turns about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// What the camera turns about and looks at.
    pub target: DVec3,
    /// From the eye to the target in perspective; in an orthographic view the one from which the target appears as large.
    pub distance: f64,
    /// The scene's up, and perpendicular to it where yaw is counted from.
    up: DVec3,
    front: DVec3,
    /// Radians, to the right of `front` and above it.
    yaw: f64,
    pitch: f64,
    /// Degrees from the bottom to the top of the picture.
    vertical_fov: f64,
    is_orthographic: bool,
}

/// Distances, in radii of the scene.
const CLOSEST: f64 = 1e-4;
const FARTHEST: f64 = 1e3;

/// The angle of view of an orthographic camera once it turns to perspective.
const DEFAULT_FOV: f64 = 45.0;

impl Orbit {
    /// The camera that sees what `viewpoint` sees.
    pub fn of(viewpoint: &Viewpoint) -> Self {
        let up = viewpoint.up.normalize();
        // Front is +z where that is not up, so that the views along the axes are where one expects them.
        let front = if up.z.abs() < 0.9 { DVec3::Z } else { -DVec3::Y };
        let front = (front - up * front.dot(up)).normalize();
        let offset = viewpoint.eye - viewpoint.target;
        let (distance, vertical_fov, is_orthographic) = match viewpoint.projection {
            Projection::Perspective { vertical_fov } => (offset.length(), f64::from(vertical_fov), false),
            Projection::Orthographic { height } => {
                (f64::from(height) / 2.0 / tangent(DEFAULT_FOV), DEFAULT_FOV, true)
            }
        };
        let mut orbit = Self {
            target: viewpoint.target,
            distance,
            up,
            front,
            yaw: 0.0,
            pitch: 0.0,
            vertical_fov,
            is_orthographic,
        };
        orbit.face(offset);
        orbit
    }

    /// The viewpoint to draw from. In an orthographic view the eye stands back far enough to see all of `bounds`.
    pub fn viewpoint(&self, bounds: Option<Bounds>) -> Viewpoint {
        let back = self.direction();
        let distance = if self.is_orthographic { self.standing_back(bounds) } else { self.distance };
        Viewpoint {
            eye: self.target + back * distance,
            target: self.target,
            up: back.cross(self.right()),
            projection: if self.is_orthographic {
                Projection::Orthographic { height: (2.0 * self.half_height()) as f32 }
            } else {
                Projection::Perspective { vertical_fov: self.vertical_fov as f32 }
            },
        }
    }

    /// Turns the camera as a drag over `by` turns the scene, in heights of the picture, y down: across the picture is half a turn.
    pub fn orbit(&mut self, by: DVec2) {
        self.yaw = (self.yaw - by.x * PI).rem_euclid(2.0 * PI);
        self.pitch = (self.pitch + by.y * PI).clamp(-FRAC_PI_2, FRAC_PI_2);
    }

    /// Moves the camera so that what lies at the target's depth follows a drag over `by`, in heights of the picture, y down.
    pub fn pan(&mut self, by: DVec2) {
        self.target += self.across(DVec2::new(-by.x, by.y) * 2.0);
    }

    /// Makes everything appear `1 / factor` times as large; what lies under `cursor` at the target's depth stays where it is. `cursor` is
    /// counted from the middle of the picture in half heights, y up.
    pub fn zoom(&mut self, factor: f64, cursor: DVec2, bounds: Option<Bounds>) {
        if !(factor.is_finite() && factor > 0.0 && cursor.is_finite()) {
            return;
        }
        let radius = bounds.map_or(self.distance, radius);
        let closest = (radius * CLOSEST).min(self.distance);
        let farthest = (radius * FARTHEST).max(self.distance);
        let distance = (self.distance * factor).clamp(closest, farthest);
        let fixed = self.target + self.across(cursor);
        self.target = fixed + (self.target - fixed) * (distance / self.distance);
        self.distance = distance;
    }

    /// Brings all of a box into the picture, which is `aspect` times as wide as high, from the side on which the camera is.
    pub fn frame(&mut self, bounds: Bounds, aspect: f64) {
        let half_height = tangent(self.vertical_fov);
        let narrow = aspect.clamp(1e-3, 1.0);
        self.target = (bounds.0 + bounds.1) / 2.0;
        self.distance = if self.is_orthographic {
            radius(bounds) / (half_height * narrow)
        } else {
            radius(bounds) / (half_height * narrow).atan().sin()
        };
    }

    /// Looks at the target along an axis of the scene.
    pub fn look_along(&mut self, axis: Axis) {
        self.face(match axis {
            Axis::Right => DVec3::X,
            Axis::Left => -DVec3::X,
            Axis::Above => DVec3::Y,
            Axis::Below => -DVec3::Y,
            Axis::Front => DVec3::Z,
            Axis::Back => -DVec3::Z,
        });
    }

    /// Turns perspective into an orthographic view and back; what lies at the target's depth keeps its size.
    pub fn toggle_projection(&mut self) {
        self.is_orthographic = !self.is_orthographic;
    }

    /// Whether rays are parallel.
    pub fn is_orthographic(&self) -> bool {
        self.is_orthographic
    }

    /// Puts the eye in this direction from the target. Straight above or below, what was right stays right.
    fn face(&mut self, direction: DVec3) {
        let level = direction - self.up * direction.dot(self.up);
        self.pitch = direction.dot(self.up).atan2(level.length());
        if level.length() > 1e-12 * direction.length() {
            self.yaw = level.dot(self.up.cross(self.front)).atan2(level.dot(self.front)).rem_euclid(2.0 * PI);
        }
    }

    /// From the target to the eye.
    fn direction(&self) -> DVec3 {
        let level = self.front * self.yaw.cos() + self.up.cross(self.front) * self.yaw.sin();
        (level * self.pitch.cos() + self.up * self.pitch.sin()).normalize()
    }

    /// What is to the right in the picture.
    fn right(&self) -> DVec3 {
        self.up.cross(self.front) * self.yaw.cos() - self.front * self.yaw.sin()
    }

    /// A way across the view at the target's depth, in half heights of the picture, y up.
    fn across(&self, by: DVec2) -> DVec3 {
        let right = self.right();
        (right * by.x + self.direction().cross(right) * by.y) * self.half_height()
    }

    /// Half of what the picture shows at the target's depth, from the bottom to the top.
    fn half_height(&self) -> f64 {
        self.distance * tangent(self.vertical_fov)
    }

    /// A distance from which nothing of a box lies behind the eye.
    fn standing_back(&self, bounds: Option<Bounds>) -> f64 {
        let Some((low, high)) = bounds else { return self.distance };
        let back = self.direction();
        let nearest = DVec3::new(
            if back.x > 0.0 { high.x } else { low.x },
            if back.y > 0.0 { high.y } else { low.y },
            if back.z > 0.0 { high.z } else { low.z },
        );
        let needed = (nearest - self.target).dot(back) + 1e-3 * radius((low, high));
        needed.max(self.distance)
    }
}

fn tangent(vertical_fov: f64) -> f64 {
    (vertical_fov.to_radians() / 2.0).tan()
}

/// Of the sphere around a box; 1 where the box is a point.
fn radius((low, high): Bounds) -> f64 {
    let radius = (high - low).length() / 2.0;
    if radius > 0.0 { radius } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    const SIZE: UVec2 = UVec2::new(960, 540);
    const ASPECT: f64 = 960.0 / 540.0;
    const BOX: Bounds = (DVec3::new(-1.0, -2.0, -3.0), DVec3::new(3.0, 2.0, 1.0));

    fn start() -> Orbit {
        Orbit::of(&Viewpoint {
            eye: DVec3::new(-0.9, 3.3, 5.0),
            target: DVec3::new(0.05, 0.28, 0.0),
            up: DVec3::Y,
            projection: Projection::Perspective { vertical_fov: 33.0 },
        })
    }

    /// Where a point appears: half heights from the middle, y up.
    fn seen(orbit: &Orbit, point: DVec3) -> DVec2 {
        let view = crate::view::View::from_viewpoint(orbit.viewpoint(Some(BOX)), 0.0, Default::default());
        let eye = view.eye_from_scene.transform_point3(point);
        let half = f64::from(view.half_extent(SIZE).y);
        let depth = if orbit.is_orthographic() { 1.0 } else { -eye.z };
        DVec2::new(eye.x, eye.y) / (depth * half)
    }

    fn assert_near(a: DVec2, b: DVec2) {
        assert!(a.distance(b) < 1e-5, "{a} and {b}");
    }

    #[test]
    fn a_camera_is_taken_over_as_it_is() {
        let orbit = start();
        let viewpoint = orbit.viewpoint(Some(BOX));
        assert!(viewpoint.eye.distance(DVec3::new(-0.9, 3.3, 5.0)) < 1e-12);
        assert_eq!(viewpoint.target, DVec3::new(0.05, 0.28, 0.0));
        assert_eq!(viewpoint.projection, Projection::Perspective { vertical_fov: 33.0 });
        // Up is the same way up, made perpendicular to the view.
        assert!(viewpoint.up.dot(DVec3::Y) > 0.5);
    }

    #[test]
    fn dragging_however_far_never_turns_the_picture_over() {
        let mut orbit = start();
        for step in 0..200 {
            orbit.orbit(DVec2::new(0.03, if step % 70 < 35 { 0.11 } else { -0.13 }));
            let viewpoint = orbit.viewpoint(Some(BOX));
            assert!(
                viewpoint.up.is_finite() && viewpoint.up.dot(DVec3::Y) > -1e-9,
                "{step}: {}",
                viewpoint.up
            );
            assert!((viewpoint.eye.distance(viewpoint.target) - orbit.distance).abs() < 1e-9);
        }
    }

    #[test]
    fn orbiting_is_smooth_through_the_pole() {
        let mut orbit = start();
        orbit.orbit(DVec2::new(0.0, 1.0));
        let above = orbit.viewpoint(None);
        assert!((above.eye - above.target).normalize().distance(DVec3::Y) < 1e-9);
        orbit.orbit(DVec2::new(0.0, -1e-6));
        let beside = orbit.viewpoint(None);
        assert!(above.up.distance(beside.up) < 1e-4, "{} and {}", above.up, beside.up);
    }

    #[test]
    fn what_is_dragged_follows_the_cursor() {
        for is_orthographic in [false, true] {
            let mut orbit = start();
            if is_orthographic {
                orbit.toggle_projection();
            }
            let at_target = orbit.target;
            orbit.pan(DVec2::new(0.25, 0.1));
            // A quarter of the height is half of the half height; down is below.
            assert_near(seen(&orbit, at_target), DVec2::new(0.5, -0.2));
        }
    }

    #[test]
    fn zooming_keeps_what_lies_under_the_cursor() {
        for is_orthographic in [false, true] {
            let mut orbit = start();
            if is_orthographic {
                orbit.toggle_projection();
            }
            let cursor = DVec2::new(0.7, -0.4);
            let under = orbit.target + orbit.across(cursor);
            orbit.zoom(0.5, cursor, Some(BOX));
            assert_near(seen(&orbit, under), cursor);
            orbit.zoom(3.0, cursor, Some(BOX));
            assert_near(seen(&orbit, under), cursor);
        }
    }

    #[test]
    fn zooming_has_an_end_on_either_side() {
        let mut orbit = start();
        for _ in 0..10_000 {
            orbit.zoom(0.5, DVec2::new(1.0, 1.0), Some(BOX));
        }
        assert!(orbit.distance >= radius(BOX) * CLOSEST && orbit.target.is_finite());
        for _ in 0..10_000 {
            orbit.zoom(2.0, DVec2::new(1.0, 1.0), Some(BOX));
        }
        assert!(orbit.distance <= radius(BOX) * FARTHEST && orbit.target.is_finite());
        let before = orbit;
        orbit.zoom(f64::NAN, DVec2::ZERO, Some(BOX));
        orbit.zoom(0.0, DVec2::ZERO, Some(BOX));
        assert_eq!(orbit, before);
    }

    #[test]
    fn all_of_a_box_is_framed_from_anywhere() {
        for aspect in [ASPECT, 1.0, 0.3] {
            for turn in 0..12 {
                for is_orthographic in [false, true] {
                    let mut orbit = start();
                    orbit.orbit(DVec2::new(f64::from(turn) / 6.0, f64::from(turn) / 20.0 - 0.3));
                    if is_orthographic {
                        orbit.toggle_projection();
                    }
                    orbit.frame(BOX, aspect);
                    let mut farthest = DVec2::ZERO;
                    for corner in crate::loading::corners((BOX.0.as_vec3(), BOX.1.as_vec3())) {
                        farthest = farthest.max(seen(&orbit, corner).abs());
                    }
                    assert!(farthest.x <= aspect && farthest.y <= 1.0, "{aspect}: {farthest}");
                    // Nor is it framed as a speck.
                    assert!(farthest.x > 0.4 * aspect.min(1.0) || farthest.y > 0.4 * aspect.min(1.0));
                }
            }
        }
    }

    #[test]
    fn toggling_the_projection_keeps_the_size_at_the_target() {
        let mut orbit = start();
        let beside = orbit.target + orbit.across(DVec2::new(0.6, 0.3));
        assert_near(seen(&orbit, beside), DVec2::new(0.6, 0.3));
        orbit.toggle_projection();
        assert_near(seen(&orbit, beside), DVec2::new(0.6, 0.3));
        orbit.zoom(0.25, DVec2::ZERO, Some(BOX));
        let closer = seen(&orbit, beside);
        orbit.toggle_projection();
        assert_near(seen(&orbit, beside), closer);
    }

    #[test]
    fn an_orthographic_eye_stands_behind_nothing() {
        let mut orbit = start();
        orbit.toggle_projection();
        orbit.zoom(1e-3, DVec2::ZERO, Some(BOX));
        for turn in 0..16 {
            orbit.orbit(DVec2::new(0.13, if turn % 4 < 2 { 0.2 } else { -0.2 }));
            let view = crate::view::View::from_viewpoint(orbit.viewpoint(Some(BOX)), 0.0, Default::default());
            for corner in crate::loading::corners((BOX.0.as_vec3(), BOX.1.as_vec3())) {
                assert!(view.eye_from_scene.transform_point3(corner).z < 0.0);
            }
        }
    }

    #[test]
    fn the_axes_are_looked_along() {
        let mut orbit = start();
        let sides = [
            (Axis::Front, DVec3::Z, DVec3::Y),
            (Axis::Back, -DVec3::Z, DVec3::Y),
            (Axis::Right, DVec3::X, DVec3::Y),
            (Axis::Left, -DVec3::X, DVec3::Y),
        ];
        for (axis, side, up) in sides {
            orbit.look_along(axis);
            let viewpoint = orbit.viewpoint(None);
            assert!((viewpoint.eye - viewpoint.target).normalize().distance(side) < 1e-12, "{axis:?}");
            assert!(viewpoint.up.distance(up) < 1e-12, "{axis:?}");
        }
        orbit.look_along(Axis::Front);
        orbit.look_along(Axis::Above);
        let above = orbit.viewpoint(None);
        assert!((above.eye - above.target).normalize().distance(DVec3::Y) < 1e-12);
        assert!(above.up.distance(-DVec3::Z) < 1e-12, "{}", above.up);
    }

    #[test]
    fn a_scene_may_stand_on_any_axis() {
        for up in [DVec3::X, -DVec3::Y, DVec3::Z, DVec3::new(1.0, 2.0, -3.0)] {
            let viewpoint = Viewpoint {
                eye: DVec3::new(3.0, 2.0, 1.5),
                target: DVec3::new(0.1, 0.2, 0.3),
                up,
                projection: Projection::Orthographic { height: 2.0 },
            };
            let mut orbit = Orbit::of(&viewpoint);
            let back = (viewpoint.eye - viewpoint.target).normalize();
            assert!(orbit.direction().distance(back) < 1e-12);
            let Projection::Orthographic { height } = orbit.viewpoint(None).projection else {
                panic!("orthographic")
            };
            assert!((height - 2.0).abs() < 1e-6);
            orbit.orbit(DVec2::new(0.3, 5.0));
            assert!(orbit.direction().distance(up.normalize()) < 1e-9);
        }
    }
}
