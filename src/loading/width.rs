//! Bodies in which scattered light can hardly be seen, since they are far too small for their medium, or far too large.

use super::LoadedMesh;
use crate::components::{Placement, SceneSettings, Shading, Subsurface};
use crate::passes::body::Body;
use crate::scene::{EntityProblems, Problem};
use bevy_ecs::prelude::*;

/// Who says so.
const SOURCE: &str = "width";

/// Fewer transport mean free paths than this across are too few for a diffusion: most light comes out as it went in.
const FEWEST: f64 = 4.0;

/// With more than this, light comes out so close to where it entered that no picture shows it.
const MOST: f64 = 4000.0;

/// What looks good: edges that glow, and shading that is still a solid's.
const GOOD: f64 = 60.0;

type Translucent<'a> =
    (Entity, &'a LoadedMesh, &'a Placement, &'a Subsurface, Option<&'a Shading>, Option<&'a EntityProblems>);

/// Notes on meshes that are only a few mean free paths wide, or thousands.
pub(super) fn advise(
    mut commands: Commands,
    meshes: Query<Translucent>,
    changed: Query<(), Or<(Changed<LoadedMesh>, Changed<Placement>, Changed<Subsurface>, Changed<Shading>)>>,
    mut former: RemovedComponents<Subsurface>,
    settings: Res<SceneSettings>,
) {
    for entity in former.read() {
        EntityProblems::set(&mut commands, entity, SOURCE, Vec::new());
    }
    if changed.is_empty() && !settings.is_changed() {
        return;
    }
    for (entity, mesh, placement, subsurface, shading, known) in &meshes {
        let is_local = shading.unwrap_or(&settings.shading) == &Shading::Local;
        let width = 2.0 * Body::of(mesh.bounds, placement, settings.millimetres_per_unit).millimetres;
        let problem = advice(width, subsurface, settings.millimetres_per_unit).filter(|_| !is_local);
        if problem.is_none() && known.is_none() {
            continue;
        }
        let problems = problem.into_iter().map(|problem| problem.on(entity, "Subsurface")).collect();
        EntityProblems::set(&mut commands, entity, SOURCE, problems);
    }
}

/// What there is to say of a body so many millimetres wide.
fn advice(width: f64, subsurface: &Subsurface, millimetres_per_unit: f32) -> Option<Problem> {
    let media = subsurface.coefficients()?;
    let paths = media.map(|medium| medium.diffusion().sigma_t_prime.recip());
    let (least, greatest) = paths
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(least, greatest), path| (least.min(*path), greatest.max(*path)));
    let is_known = width > 0.0 && width.is_finite() && least > 0.0 && greatest.is_finite();
    let (path, what) = match (width / least < FEWEST, width / greatest > MOST) {
        _ if !is_known => return None,
        (true, _) => (least, "most light passes through it without being scattered often enough"),
        (_, true) => (greatest, "light comes out so close to where it entered that it looks opaque"),
        _ => return None,
    };
    let count = width / path;
    let count = if count < 10.0 { format!("{count:.1}") } else { format!("{count:.0}") };
    let size = GOOD * (least * greatest).sqrt();
    let unit = f64::from(millimetres_per_unit) * size / width;
    Some(
        Problem::note(format!(
            "it is {} mm wide, {count} mean free paths of its medium: {what}",
            rounded(width)
        ))
        .help(format!(
            "if its units are no millimetres, say what they are: with `millimetres_per_unit: {}`, or `Transform: (fit: {})`, it is about {GOOD} wide",
            rounded(unit),
            rounded(size)
        )),
    )
}

/// A number to two digits.
fn rounded(number: f64) -> f64 {
    let digit = 10.0_f64.powi(number.abs().log10().floor() as i32 - 1);
    // Dividing by a whole number is exact where multiplying by a fraction is not.
    let rounded = if digit < 1.0 {
        (number / digit).round() / digit.recip().round()
    } else {
        (number / digit).round() * digit
    };
    if rounded.is_finite() { rounded } else { number }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_far_too_small_or_too_large_is_told() {
        let marble = Subsurface::default();
        let said = |width| advice(width, &marble, 1.0).map(|problem| problem.message);
        assert_eq!([1.0, 40.0, 300.0].map(|width| said(width).is_some()), [true, false, false]);
        assert!(said(0.5).unwrap().starts_with("it is 0.5 mm wide, "), "{said:?}", said = said(0.5));
        assert!(said(1e5).unwrap().contains("looks opaque"));
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(|width| said(width).is_some()), [false; 3]);
    }

    #[test]
    fn numbers_have_two_digits() {
        assert_eq!([1234.0, 0.123, 9.96, 55.5].map(rounded), [1200.0, 0.12, 10.0, 56.0]);
    }
}
