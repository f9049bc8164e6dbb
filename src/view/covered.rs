//! Which pixels can show a box.

use super::View;
use crate::components::Projection;
use glam::{DAffine3, DVec2, DVec3, UVec2};
use std::ops::Range;

/// A rectangle of pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pixels {
    pub columns: Range<u32>,
    pub rows: Range<u32>,
}

impl Pixels {
    /// All of a picture.
    pub fn all(size: UVec2) -> Self {
        Self { columns: 0..size.x, rows: 0..size.y }
    }

    /// Those of them in a stretch of columns.
    pub fn within(&self, columns: &Range<u32>) -> Self {
        let start = self.columns.start.max(columns.start);
        let end = self.columns.end.min(columns.end).max(start);
        Self { columns: start..end, rows: self.rows.clone() }
    }

    /// How many there are.
    pub fn count(&self) -> u64 {
        let length = |range: &Range<u32>| u64::from(range.end.saturating_sub(range.start));
        length(&self.columns) * length(&self.rows)
    }
}

/// In eye space; a corner that is closer, or behind the eye, can be anywhere in the picture.
const NEAREST: f64 = 1e-6;

/// The pixels that rays through boxes, given as what takes the unit cube to the scene, go through, and a pixel more on each side.
pub(crate) fn covered(view: &View, size: UVec2, boxes: impl IntoIterator<Item = DAffine3>) -> Pixels {
    let half = view.half_extent(size).as_dvec2();
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for scene_from_cube in boxes {
        let eye_from_cube = view.eye_from_scene * scene_from_cube;
        for corner in 0..8 {
            let corner = DVec3::from([0, 1, 2].map(|axis| f64::from(corner >> axis & 1)));
            let at = eye_from_cube.transform_point3(corner);
            let across = match view.projection {
                Projection::Perspective { .. } if at.z > -NEAREST => return Pixels::all(size),
                Projection::Perspective { .. } => at.truncate() / -at.z,
                Projection::Orthographic { .. } => at.truncate(),
            };
            let pixel = (DVec2::new(0.5, -0.5) * across / half + 0.5) * size.as_dvec2();
            if !pixel.is_finite() {
                return Pixels::all(size);
            }
            low = low.min(pixel);
            high = high.max(pixel);
        }
    }
    let pixels = |from: f64, to: f64, most: u32| {
        let [from, to] = [from.floor() - 1.0, to.ceil() + 1.0].map(|edge| edge.clamp(0.0, f64::from(most)));
        from as u32..(to as u32).max(from as u32)
    };
    Pixels { columns: pixels(low.x, high.x, size.x), rows: pixels(low.y, high.y, size.y) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Viewpoint;

    const SIZE: UVec2 = UVec2::new(200, 100);

    fn view(projection: Projection) -> View {
        let viewpoint =
            Viewpoint { eye: DVec3::new(0.0, 0.0, 10.0), target: DVec3::ZERO, up: DVec3::Y, projection };
        View::from_viewpoint(viewpoint, 0.0, Default::default())
    }

    /// A cube with this edge around a place.
    fn cube(centre: DVec3, edge: f64) -> DAffine3 {
        DAffine3::from_translation(centre - edge / 2.0) * DAffine3::from_scale(DVec3::splat(edge))
    }

    #[test]
    fn an_orthographic_view_sees_a_box_as_large_as_it_is() {
        let view = view(Projection::Orthographic { height: 10.0 });
        let found = covered(&view, SIZE, [cube(DVec3::new(2.0, 1.0, 0.0), 2.0)]);
        assert_eq!(found, Pixels { columns: 109..131, rows: 29..51 });
        assert_eq!(found.within(&(0..120)).count(), 11 * 22);
        assert_eq!(found.within(&(0..50)).count(), 0);
    }

    #[test]
    fn a_box_beside_the_picture_has_no_pixels_and_one_around_the_eye_all() {
        let view = view(Projection::Perspective { vertical_fov: 40.0 });
        assert_eq!(covered(&view, SIZE, [cube(DVec3::X * 1e3, 1.0)]).count(), 0);
        assert_eq!(covered(&view, SIZE, []).count(), 0);
        assert_eq!(covered(&view, SIZE, [cube(DVec3::Z * 9.0, 4.0)]), Pixels::all(SIZE));
        let two = covered(&view, SIZE, [cube(DVec3::X, 1.0), cube(-DVec3::X, 1.0)]);
        assert!(two.count() > 2 * covered(&view, SIZE, [cube(DVec3::X, 1.0)]).count());
    }
}
