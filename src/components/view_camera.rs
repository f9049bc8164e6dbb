use super::{
    AlsoCalled, Auto, Range, Slider, Unit, Validate,
    attributes::{ReflectValidate, in_ron},
};
use crate::components::Placement;
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::Vec3;

/// Where the picture is taken from.
///
/// | field | type | unit | range | default |
/// |---|---|---|---|---|
/// | `eye` | point | scene units | not `target` | (0, 0, 4) |
/// | `target` | point that appears in the middle | scene units | – | (0, 0, 0) |
/// | `up` | vector that points up in the picture | – | not along the view | (0, 1, 0) |
/// | `frame` | `None`, or `(from, fill, flat)`: the camera stands in the direction `from` of all that can be seen, so far away that it fills this share of the picture; `eye` and `target` play no part. What is ten times as wide as thick, and would be seen from its edge, is seen so with `flat: Edge`, or from above, its front below (`FrontBelow`) or on top (`FrontOnTop`, as slices of patients are shown), or from the left if it stands upright | – | `from` not 0 and not along `up`; `fill` 0.01 to 1 | `None` |
/// | `projection` | `Perspective(vertical_fov)` or `Orthographic(height)` | degrees; scene units | 0.01 to 179; above 0 | `Perspective(vertical_fov: 45.0)` |
/// | `exposure` | number | EV: each step doubles the brightness | -100 to 100 | 0 |
/// | `gamma` | `Auto` for the curve of sRGB, or an exponent | – | 0.1 to 10 | `Auto` |
///
/// `exposure` and `gamma` concern what a person sees (window, PNG, video); an EXR holds the radiance as it is. Screens and pictures without a
/// word of their encoding are taken for sRGB (IEC 61966-2-1), which is what `Auto` is; `2.2` is near it, and brighter where it is nearly black. A scene without a camera is
/// seen from the front, with all of it in the picture.
///
/// ```ron
/// ViewCamera: (eye: (0.0, 1.2, 4.0), target: (0.0, 0.6, 0.0), projection: Perspective(vertical_fov: 40.0))
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq, Validate)]
#[reflect(@AlsoCalled(&["Camera", "Eye", "Viewer", "PerspectiveCamera", "OrthographicCamera"]))]
#[require(Placement)]
pub struct ViewCamera {
    /// Where the camera stands.
    #[reflect(@Unit("scene units"))]
    #[reflect(@AlsoCalled(&["position", "from", "location", "origin"]))]
    pub eye: Vec3,
    /// The point in the middle of the picture.
    #[reflect(@Unit("scene units"))]
    #[reflect(@AlsoCalled(&["look_at", "to", "at", "center", "centre", "focus"]))]
    pub target: Vec3,
    /// What points up in the picture.
    pub up: Vec3,
    /// Has the camera stand where all of the scene fills the picture, in place of `eye` and `target`.
    pub frame: Option<Framing>,
    /// How the scene is projected.
    #[reflect(@AlsoCalled(&["fov", "vertical_fov", "lens"]))]
    pub projection: Projection,
    /// Exposure value.
    #[reflect(@Range::new(-100.0, 100.0), @Slider::linear(-8.0, 8.0), @Unit("EV"))]
    pub exposure: f32,
    /// How brightness is encoded: as sRGB, or by an exponent.
    #[reflect(@Range::new(0.1, 10.0), @Slider::linear(1.0, 3.0))]
    pub gamma: Auto<f32>,
}

impl Default for ViewCamera {
    fn default() -> Self {
        Self {
            eye: Vec3::new(0.0, 0.0, 4.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            frame: None,
            projection: Projection::default(),
            exposure: 0.0,
            gamma: Auto::Auto,
        }
    }
}

impl Validate for ViewCamera {
    fn problems(&self) -> Vec<(&'static str, String)> {
        let view = match self.frame {
            Some(frame) => -frame.from.as_dvec3().normalize_or_zero(),
            None => (self.target.as_dvec3() - self.eye.as_dvec3()).normalize_or_zero(),
        };
        let up = self.up.as_dvec3().normalize_or_zero();
        if view.length_squared() == 0.0 && self.frame.is_some() {
            return vec![("frame", "`from` must point somewhere, found (0, 0, 0)".to_owned())];
        }
        if view.length_squared() == 0.0 {
            return vec![(
                "target",
                format!(
                    "the camera must look somewhere: `target` and `eye` are both {}",
                    in_ron(&self.eye.to_array())
                ),
            )];
        }
        if view.cross(up).length() < 1e-6 {
            let up = in_ron(&self.up.to_array());
            let message = match self.up {
                Vec3::ZERO => format!("`up` must point somewhere, found {up}"),
                _ => format!("`up` must point across the view, found {up} along it"),
            };
            return vec![("up", message)];
        }
        Vec::new()
    }
}

/// A camera that stands where all of the scene fills the picture.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, PartialEq)]
pub struct Framing {
    /// The direction from what is seen to the camera.
    pub from: Vec3,
    /// The share of the picture's height or width, whichever is less, that is filled.
    #[reflect(@Range::new(0.01, 1.0))]
    pub fill: f32,
    /// How what is ten times as wide as thick is seen that would be seen from its edge.
    pub flat: Flat,
}

/// How flat things are seen.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, PartialEq)]
pub enum Flat {
    /// As all other things: from the edge.
    #[default]
    Edge,
    /// From above with the front below, as what lies on a table; from the left if it stands upright.
    FrontBelow,
    /// From above with the front on top, as slices of patients are shown; from the left if it stands upright.
    FrontOnTop,
}

impl Default for Framing {
    fn default() -> Self {
        Self { from: Vec3::Z, fill: 0.9, flat: Flat::Edge }
    }
}

/// How a camera projects the scene.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, PartialEq)]
pub enum Projection {
    /// Rays leave the eye in all directions.
    Perspective {
        /// Angle between the bottom and the top of the picture.
        #[reflect(default = "default_vertical_fov", @Range::new(0.01, 179.0), @Slider::linear(5.0, 120.0), @Unit("degrees"))]
        vertical_fov: f32,
    },
    /// Rays are parallel and start in the plane through the eye.
    Orthographic {
        /// Height of the picture in the scene.
        #[reflect(default = "default_height", @Range::positive(), @Unit("scene units"))]
        height: f32,
    },
}

impl Default for Projection {
    fn default() -> Self {
        Self::Perspective { vertical_fov: default_vertical_fov() }
    }
}

fn default_vertical_fov() -> f32 {
    45.0
}

fn default_height() -> f32 {
    2.0
}
