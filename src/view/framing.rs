//! Where a camera stands for all of a scene to fill the picture.

use super::Viewpoint;
use crate::components::{Flat, Framing, Projection, ViewCamera};
use glam::{DVec2, DVec3, UVec2};

/// The viewpoint of a camera with a [`Framing`], for points that are all to be in the picture; none where there are none.
///
/// In perspective a point at height y and depth z, both from the camera, lies within the share `fill` of the picture if |y| <= k z, where k
/// is `fill` times the tangent of half the angle of view. Each point thus bounds how near the camera may come on either side; the least
/// distance that all allow, above, below and at the sides, is what is wanted.
pub fn framed(camera: &ViewCamera, framing: &Framing, points: &[DVec3], size: UVec2) -> Option<Viewpoint> {
    let mut back = framing.from.as_dvec3().normalize();
    let right = camera.up.as_dvec3().cross(back).normalize();
    let mut up = back.cross(right);
    let mut upwards = camera.up.as_dvec3();
    if let Some(face) = across_flat(points, [right, up, back], framing.flat) {
        (back, upwards) = face;
        up = upwards;
    }
    let right = up.cross(back);
    // About a point in the midst of it, so that digits are kept far away from the origin.
    let centre = (points.iter().fold(DVec3::INFINITY, |low, point| low.min(*point))
        + points.iter().fold(DVec3::NEG_INFINITY, |high, point| high.max(*point)))
        / 2.0;
    let seen: Vec<DVec3> = points
        .iter()
        .map(|point| point - centre)
        .map(|point| DVec3::new(point.dot(right), point.dot(up), point.dot(back)))
        .collect();
    let greatest = |of: &dyn Fn(&DVec3) -> f64| seen.iter().map(of).reduce(f64::max);
    let nearest = greatest(&|point| point.z)?;
    let radius = greatest(&|point| point.length())?;
    let radius = if radius > 0.0 { radius } else { 1.0 };
    let aspect = f64::from(size.x) / f64::from(size.y);
    let fill = f64::from(framing.fill);
    let (middle, distance, projection) = match camera.projection {
        Projection::Perspective { vertical_fov } => {
            let tangent = (f64::from(vertical_fov).to_radians() / 2.0).tan();
            let along = |axis: usize, slope: f64| {
                let above = greatest(&|point| point[axis] + slope * point.z)?;
                let below = greatest(&|point| -point[axis] + slope * point.z)?;
                Some(((above - below) / 2.0, (above + below) / (2.0 * slope)))
            };
            let (x, across) = along(0, fill * tangent * aspect)?;
            let (y, down) = along(1, fill * tangent)?;
            // Flat things seen from the front would otherwise touch the camera.
            let least = nearest + radius * 1e-3;
            (DVec2::new(x, y), across.max(down).max(least), camera.projection)
        }
        Projection::Orthographic { .. } => {
            let extent = |axis: usize| {
                let (high, low) = (greatest(&|point| point[axis])?, -greatest(&|point| -point[axis])?);
                Some(((high + low) / 2.0, high - low))
            };
            let ((x, width), (y, height)) = (extent(0)?, extent(1)?);
            let height = (height / fill).max(width / fill / aspect).max(radius * 1e-6);
            let projection = Projection::Orthographic { height: height as f32 };
            (DVec2::new(x, y), nearest + radius, projection)
        }
    };
    // What is looked at lies in the middle of the depth, so that a turn is a turn about it.
    let target = centre + right * middle.x + up * middle.y;
    Some(Viewpoint { eye: target + back * distance, target, up: upwards, projection })
}

/// How many times as wide as thick what is flat is.
const FLAT: f64 = 10.0;

/// From where to look at flat things that would be seen from their edges, and what is up then. Lights of scenes that are made for files come from the
/// left above.
fn across_flat(points: &[DVec3], [right, up, back]: [DVec3; 3], flat: Flat) -> Option<(DVec3, DVec3)> {
    let on_top = match flat {
        Flat::Edge => return None,
        Flat::FrontBelow => -back,
        Flat::FrontOnTop => back,
    };
    let extent = |axis: DVec3| {
        let along = points.iter().map(|point| (*point - points[0]).dot(axis));
        along.clone().fold(0.0, f64::max) - along.fold(0.0, f64::min)
    };
    let [width, height, depth] = [right, up, back].map(extent);
    if height * FLAT < width.min(depth) {
        Some((up, on_top))
    } else if width * FLAT < height.min(depth) {
        Some((-right, up))
    } else {
        None
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Where the points lie in the picture, from -1 to 1 down and across.
    fn in_picture(viewpoint: &Viewpoint, points: &[DVec3], aspect: f64) -> Vec<DVec2> {
        let back = (viewpoint.eye - viewpoint.target).normalize();
        let right = viewpoint.up.cross(back).normalize();
        let up = back.cross(right);
        let scale = |depth: f64| match viewpoint.projection {
            Projection::Perspective { vertical_fov } => {
                depth * (f64::from(vertical_fov).to_radians() / 2.0).tan()
            }
            Projection::Orthographic { height } => f64::from(height) / 2.0,
        };
        points
            .iter()
            .map(|point| {
                let seen = point - viewpoint.eye;
                let half = scale(-seen.dot(back));
                DVec2::new(seen.dot(right) / half / aspect, seen.dot(up) / half)
            })
            .collect()
    }

    #[test]
    fn what_is_seen_fills_the_share_of_the_picture() {
        let tower = [DVec3::new(5.0, 0.0, 1.0), DVec3::new(6.0, 9.0, 0.0), DVec3::new(5.5, 4.0, -2.0)];
        let flat = [DVec3::new(-4e6, 1.0, 0.0), DVec3::new(-4e6 + 3.0, 1.5, 0.0), DVec3::new(-4e6, 1.2, 0.0)];
        for points in [tower, flat] {
            for projection in [Projection::default(), Projection::Orthographic { height: 1.0 }] {
                for (from, up) in
                    [(Vec3::Z, Vec3::Y), (Vec3::new(1.0, 0.4, -2.0), Vec3::Y), (Vec3::Y, Vec3::Z)]
                {
                    let framing = Framing { from, fill: 0.8, flat: Flat::Edge };
                    let camera = ViewCamera { up, projection, ..ViewCamera::default() };
                    let size = UVec2::new(320, 180);
                    let viewpoint = framed(&camera, &framing, &points, size).unwrap();
                    let seen = in_picture(&viewpoint, &points, 320.0 / 180.0);
                    let most = seen.iter().map(|place| place.abs().max_element()).fold(0.0, f64::max);
                    assert!((most - 0.8).abs() < 1e-3, "{most} for {points:?} from {from} in {projection:?}");
                }
            }
        }
        assert!(framed(&ViewCamera::default(), &Framing::default(), &[], UVec2::ONE).is_none());
        assert!(framed(&ViewCamera::default(), &Framing::default(), &[DVec3::ONE], UVec2::ONE).is_some());
    }

    #[test]
    fn flat_things_are_seen_from_their_flat_side() {
        let camera = ViewCamera::default();
        let from = |extent: DVec3, flat: Flat| {
            let framing = Framing { flat, ..Framing::default() };
            let corners = crate::loading::corners((Vec3::ZERO, extent.as_vec3()));
            let points: Vec<DVec3> = corners.collect();
            let view = framed(&camera, &framing, &points, UVec2::splat(100)).unwrap();
            let seen = in_picture(&view, &points, 1.0);
            let most = seen.iter().map(|place| place.abs().max_element()).fold(0.0, f64::max);
            assert!((most - 0.9).abs() < 1e-3, "{extent}");
            ((view.eye - view.target).normalize().round(), view.up.round())
        };
        let level = DVec3::new(3.0, 0.2, 4.0);
        assert_eq!(from(level, Flat::FrontBelow), (DVec3::Y, DVec3::NEG_Z));
        assert_eq!(from(level, Flat::FrontOnTop), (DVec3::Y, DVec3::Z));
        assert_eq!(from(level, Flat::Edge), (DVec3::Z, DVec3::Y));
        assert_eq!(from(DVec3::new(0.0, 4.0, 3.0), Flat::FrontOnTop), (DVec3::NEG_X, DVec3::Y));
        // From the front they are seen as they are, as is all that is no thinner than that, and what is a line.
        for extent in [DVec3::new(3.0, 4.0, 0.0), DVec3::new(3.0, 0.4, 4.0), DVec3::new(9.0, 0.0, 0.0)] {
            assert_eq!(from(extent, Flat::FrontBelow), (DVec3::Z, DVec3::Y));
        }
    }
}
