//! What is asked of a picture, beside what the scene says.

use crate::components::{Projection, Shading, ViewCamera};
use crate::failure::Failure;
use bevy_ecs::prelude::*;
use glam::{DAffine3, DVec3, UVec2};
use std::ops::Range;

/// The picture that is asked for.
#[derive(Resource, Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels across and down.
    pub size: UVec2,
    /// The camera to take it with; the first by name where none is said.
    pub camera: Option<String>,
    /// Whether it is to be encoded for a screen, besides its radiance.
    pub encoded: bool,
}

impl Default for Picture {
    fn default() -> Self {
        Self { size: UVec2::new(960, 540), camera: None, encoded: true }
    }
}

/// A place to take pictures from, in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Where the camera stands.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub target: DVec3,
    /// What points up in the picture; not along the view.
    pub up: DVec3,
    /// How the scene is projected.
    pub projection: Projection,
}

impl Viewpoint {
    pub(super) fn of(camera: &ViewCamera, placement: DAffine3) -> Self {
        Self {
            eye: placement.transform_point3(camera.eye.as_dvec3()),
            target: placement.transform_point3(camera.target.as_dvec3()),
            up: placement.transform_vector3(camera.up.as_dvec3()),
            projection: camera.projection,
        }
    }
}

/// A viewpoint that is in no file, as that of a person who turns the scene in a window: it takes the place of the scene's cameras, which
/// stay as they are and still say how bright the picture is. Reloading the scene leaves it alone.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeCamera(pub Option<Viewpoint>);

/// How much more coarsely than the scene asks for pictures are drawn, while they are to follow a hand.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct Coarseness {
    /// Factor on the steps of rays through volumes, but for those that are pre-integrated: their tables hold for one length of step.
    pub step: f32,
    /// Share of the texels, along each side, of a light's view of a translucent mesh, and the root of the share of samples of the light that
    /// leaves it, where either is to be made anew. What is there in full stays.
    pub light: f32,
}

impl Default for Coarseness {
    fn default() -> Self {
        Self { step: 1.0, light: 1.0 }
    }
}

/// Whether updates draw a picture, or only bring up to date what it is made of.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Drawing(pub bool);

impl Default for Drawing {
    fn default() -> Self {
        Self(true)
    }
}

/// For the passes of the picture itself.
pub(crate) fn is_wanted(drawing: Res<Drawing>, failure: Res<Failure>) -> bool {
    drawing.0 && !failure.keeps_picture()
}

/// A picture that is split from top to bottom, to compare two shadings of the same scene. What is computed for scattering is kept, whichever side
/// shows it.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct Comparison(pub Option<Split>);

/// Whether pictures leave the background out: it is then black, so that radiance is what is in front of it, and
/// [`Image::coverage`](crate::render::Image::coverage) says how much of it each pixel hides.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CutOut(pub bool);

/// Where a picture is split, and how its sides are shaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// The share of the picture that lies left of the line.
    pub at: f32,
    /// Left of the line: `Scattering` is what the scene says, `Local` the local models for everything.
    pub left: Shading,
    /// Right of it.
    pub right: Shading,
}

/// A stretch of a picture's columns.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    pub columns: Range<u32>,
    /// `Scattering` is what the scene says.
    pub shading: Shading,
}

/// The parts of a picture, from left to right; none of them is empty.
pub(crate) fn in_parts(comparison: &Comparison, size: UVec2) -> Vec<Part> {
    let Some(Split { at, left, right }) = comparison.0 else {
        return vec![Part { columns: 0..size.x, shading: Shading::Scattering }];
    };
    let line = ((at * size.x as f32).round() as u32).min(size.x);
    let sides = [Part { columns: 0..line, shading: left }, Part { columns: line..size.x, shading: right }];
    sides.into_iter().filter(|part| !part.columns.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_split_into_parts_that_are_there() {
        let size = UVec2::new(10, 4);
        assert_eq!(
            in_parts(&Comparison(None), size),
            [Part { columns: 0..10, shading: Shading::Scattering }]
        );
        let split = |at| {
            let split = Split { at, left: Shading::Scattering, right: Shading::Local };
            in_parts(&Comparison(Some(split)), size).into_iter().map(|part| part.columns).collect::<Vec<_>>()
        };
        assert_eq!(split(0.3), [0..3, 3..10]);
        for (at, whole) in [(0.0, 0..10), (1.0, 0..10), (-3.0, 0..10), (7.0, 0..10), (f32::NAN, 0..10)] {
            assert_eq!(split(at), [whole], "{at}");
        }
    }
}
