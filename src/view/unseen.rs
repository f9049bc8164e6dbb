//! Entities of which nothing can be seen, and why.

use super::{FreeCamera, Picture, View};
use crate::components::{Placement, SceneSettings, TransferFunction};
use crate::loading::{LoadedMesh, LoadedVolume, placed_corners};
use crate::passes::classify::Classified;
use crate::scene::{EntityProblems, Problem};
use bevy_ecs::prelude::*;
use glam::{DVec3, UVec2};

/// Who says so.
const SOURCE: &str = "unseen";

type Seen<'a> = (
    Entity,
    &'a Placement,
    Option<&'a LoadedMesh>,
    Option<&'a LoadedVolume>,
    Option<&'a Classified>,
    Option<&'a TransferFunction>,
    Option<&'a EntityProblems>,
);

/// Notes on entities that are all transparent or lie outside of the picture. A camera that a person moves is no reason to speak.
pub(super) fn tell(
    mut commands: Commands,
    entities: Query<Seen, Or<(With<LoadedMesh>, With<LoadedVolume>)>>,
    changed: Query<(), Or<(Changed<Placement>, Changed<LoadedMesh>, Changed<Classified>)>>,
    (view, picture, free, settings): (Res<View>, Res<Picture>, Res<FreeCamera>, Res<SceneSettings>),
) {
    if !(view.is_changed() || picture.is_changed() || settings.is_changed() || !changed.is_empty()) {
        return;
    }
    for (entity, placement, mesh, volume, classified, function, known) in &entities {
        let transparent =
            volume.zip(classified).zip(function).and_then(|((volume, classified), function)| {
                classified
                    .distances
                    .iter()
                    .all(|distance| *distance > 0)
                    .then(|| why_transparent(volume, classified, function).on(entity, "TransferFunction"))
            });
        let outside = || {
            let bounds = match (mesh, volume) {
                (Some(mesh), _) => mesh.bounds,
                (None, Some(volume)) => {
                    let half = volume.half_extent() / settings.millimetres_per_unit;
                    (-half, half)
                }
                (None, None) => return None,
            };
            let corners: Vec<DVec3> = placed_corners(placement, bounds).collect();
            Some(Problem::note(why_outside(&view, picture.size, &corners)?).on(entity, "Transform"))
        };
        let problem = transparent.or_else(|| if free.0.is_none() { outside() } else { None });
        if problem.is_none() && known.is_none() {
            continue;
        }
        EntityProblems::set(&mut commands, entity, SOURCE, problem.into_iter().collect());
    }
}

fn why_transparent(volume: &LoadedVolume, classified: &Classified, function: &TransferFunction) -> Problem {
    let or_a_preset = if function.preset.is_some() { "" } else { ", or write `Preset(\"Object\")`" };
    let function = volume.function_in_force(function);
    let is_clear = function.points_in_force().iter().all(|point| point.2 == 0.0)
        && function.iso.iter().all(|iso| iso.absorption == 0.0);
    let ((low, high), (least, greatest)) = (classified.domain, volume.data.range);
    let values = format!("its values are from {least} to {greatest}");
    let nothing = "nothing of it can be seen";
    if volume.data.non_finite == volume.data.histogram.bins.iter().sum::<u64>() + volume.data.non_finite
        && volume.data.non_finite > 0
    {
        Problem::note(format!("{nothing}: it has no finite sample"))
    } else if is_clear {
        Problem::note(format!("{nothing}: its transfer function is clear everywhere"))
            .help(format!("give a point an opacity above 0{or_a_preset}"))
    } else if greatest < low || least > high {
        Problem::note(format!(
            "{nothing}: {values}, beside the domain of its transfer function, {low} to {high}"
        ))
        .help(format!("write `domain: ({least:?}, {greatest:?})`, or leave it out"))
    } else {
        Problem::note(format!("{nothing}: {values}, where its transfer function is clear"))
            .help(format!("give a point at these values an opacity above 0{or_a_preset}"))
    }
}

/// Why a box is in no part of the picture, if it is not: one side of the view has all of its corners outside.
fn why_outside(view: &View, size: UVec2, corners: &[DVec3]) -> Option<String> {
    let seen: Vec<DVec3> =
        corners.iter().map(|corner| view.eye_from_scene.transform_point3(*corner)).collect();
    let half = view.half_extent(size).as_dvec2();
    let is_perspective = matches!(view.projection, crate::components::Projection::Perspective { .. });
    let width = |point: &DVec3| if is_perspective { -point.z } else { 1.0 };
    if seen.iter().all(|point| point.z >= 0.0) {
        return Some("nothing of it can be seen: it lies behind the camera".to_owned());
    }
    let sides: [(&str, &dyn Fn(&DVec3) -> bool); 4] = [
        ("left of", &|point| point.x < -half.x * width(point)),
        ("right of", &|point| point.x > half.x * width(point)),
        ("below", &|point| point.y < -half.y * width(point)),
        ("above", &|point| point.y > half.y * width(point)),
    ];
    let (side, _) = sides.into_iter().find(|(_, is_beyond)| seen.iter().all(is_beyond))?;
    Some(format!("nothing of it can be seen: it lies {side} the picture"))
}
