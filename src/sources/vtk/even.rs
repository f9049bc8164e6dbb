//! Whether coordinates are those of an even grid.

use std::path::Path;

use glam::DVec3;

use crate::sources::SourceError;

/// How far a coordinate may be from its even place, as a part of the distance of voxels.
const EVEN: f64 = 0.01;

/// The first of these coordinates, and the distance from one to the next: 1 where there is only one.
///
/// # Errors
///
/// If one is further from its even place than a hundredth of that distance.
pub(in crate::sources) fn even(
    path: &Path,
    axis: &str,
    count: usize,
    coordinate: impl Fn(usize) -> f64,
) -> Result<(f64, f64), SourceError> {
    let first = coordinate(0);
    if count < 2 {
        return Ok((first, 1.0));
    }
    let step = (coordinate(count - 1) - first) / (count - 1) as f64;
    let off = |index: usize| (coordinate(index) - first - step * index as f64).abs();
    if (0..count).all(|index| off(index) <= EVEN * step.abs()) && step != 0.0 {
        return Ok((first, step));
    }
    let gaps = (1..count).map(|index| coordinate(index) - coordinate(index - 1));
    let (least, greatest) =
        gaps.fold((f64::MAX, f64::MIN), |(least, greatest), gap| (least.min(gap), greatest.max(gap)));
    Err(uneven(path, axis, &format!("its coordinates are {least} to {greatest} apart")))
}

/// The place of the first point of a curved grid, and from one point to the next along each axis, if these are everywhere the same.
pub(in crate::sources) fn affine(
    path: &Path,
    size: [u64; 3],
    point: impl Fn(u64) -> DVec3,
) -> Result<(DVec3, [DVec3; 3]), SourceError> {
    let [x, y, z] = size;
    let strides = [1, x, x * y];
    let first = point(0);
    let along = [0, 1, 2].map(|axis| {
        let last = size[axis].saturating_sub(1);
        (last > 0).then(|| (point(last * strides[axis]) - first) / last as f64)
    });
    let axes = completed(along);
    let shortest = axes.iter().map(|axis| axis.length()).fold(f64::MAX, f64::min);
    let off = |index: u64| {
        let [i, j, k] = [index % x, index / x % y, index / (x * y)].map(|step| step as f64);
        (first + axes[0] * i + axes[1] * j + axes[2] * k).distance(point(index))
    };
    match (0..x * y * z).find(|index| {
        let off = off(*index);
        off.is_nan() || off > EVEN * shortest
    }) {
        None => Ok((first, axes)),
        Some(index) => {
            let place = format!("point {index} is not where those at the corners have it");
            Err(uneven(path, ["x", "y", "z"][usize::from(index >= x) + usize::from(index >= x * y)], &place))
        }
    }
}

/// Axes of one point get a direction of their own, 1 long.
fn completed(along: [Option<DVec3>; 3]) -> [DVec3; 3] {
    let mut axes = along;
    for missing in 0..3 {
        if axes[missing].is_some() {
            continue;
        }
        let known: Vec<DVec3> = axes.iter().flatten().copied().collect();
        let free = |unit: DVec3| match &known[..] {
            [] => unit,
            [one] => unit.reject_from(one.normalize_or(DVec3::X)),
            [one, two, ..] => unit.project_onto(one.cross(*two).normalize_or(unit)),
        };
        let units = [DVec3::X, DVec3::Y, DVec3::Z];
        let candidates = [missing, (missing + 1) % 3, (missing + 2) % 3].map(|axis| free(units[axis]));
        let found = candidates.into_iter().find(|direction| direction.length() > 0.1);
        axes[missing] = Some(found.map_or(units[missing], DVec3::normalize));
    }
    axes.map(Option::unwrap_or_default)
}

fn uneven(path: &Path, axis: &str, how: &str) -> SourceError {
    SourceError::Unsupported {
        path: path.to_owned(),
        found: format!("its grid is not even along {axis}: {how}"),
        mend: "resample it to an image (in ParaView: Resample To Image) and save that".to_owned(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_even_to_a_hundredth() {
        let even =
            |coordinates: &[f64]| even(Path::new("a"), "y", coordinates.len(), |index| coordinates[index]);
        assert_eq!(even(&[3.0, 5.0, 7.0]).unwrap(), (3.0, 2.0));
        assert_eq!(even(&[3.0, 2.995, 2.99]).unwrap().0, 3.0);
        assert_eq!(even(&[4.0]).unwrap(), (4.0, 1.0));
        assert!(even(&[0.0, 1.009, 2.0]).is_ok());
        let text = even(&[0.0, 1.5, 2.0]).unwrap_err().to_string();
        assert!(text.contains("not even along y: its coordinates are 0.5 to 1.5 apart"), "{text}");
        assert!(even(&[1.0, 1.0]).is_err() && even(&[0.0, f64::NAN, 2.0]).is_err());
    }

    #[test]
    fn a_curved_grid_that_is_straight_has_axes() {
        let axes = [DVec3::new(0.0, 2.0, 0.1), DVec3::new(0.0, 0.0, 1.0), DVec3::new(3.0, 0.0, 0.0)];
        let point = |index: u64| {
            DVec3::splat(7.0)
                + axes[0] * (index % 3) as f64
                + axes[1] * (index / 3 % 2) as f64
                + axes[2] * (index / 6) as f64
        };
        let (first, found) = affine(Path::new("a"), [3, 2, 2], point).unwrap();
        assert_eq!(first, DVec3::splat(7.0));
        assert!(axes.iter().zip(found).all(|(axis, found)| axis.distance(found) < 1e-12));
        let bent = |index: u64| point(index) + DVec3::X * if index == 4 { 0.02 } else { 0.0 };
        let text = affine(Path::new("a"), [3, 2, 2], bent).unwrap_err().to_string();
        assert!(text.contains("not even along y: point 4"), "{text}");
        // A plane across x, and a line along y.
        let plane = affine(Path::new("a"), [1, 2, 2], |index| {
            DVec3::new(1.0, (index % 2) as f64, (index / 2) as f64)
        });
        assert_eq!(plane.unwrap().1, [DVec3::X, DVec3::Y, DVec3::Z]);
        let line = affine(Path::new("a"), [4, 1, 1], |index| DVec3::Y * index as f64);
        let [along, second, third] = line.unwrap().1;
        assert_eq!(
            (along, second.dot(along), third.dot(along), second.dot(third)),
            (DVec3::Y, 0.0, 0.0, 0.0)
        );
    }
}
