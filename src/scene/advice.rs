//! What is worth knowing about a scene that is right in every part.

use super::document::{SceneDocument, SceneEntity};
use super::problem::Problem;
use crate::components::{DirectionalLight, Mesh, Phong, ViewCamera, Volume, VolumeLighting};
use bevy_reflect::Reflect;
use glam::Vec3;
use std::any::TypeId;

/// Notes on a scene without errors: nothing to see in it, or no light on what needs some.
pub(super) fn advice(document: &SceneDocument) -> Vec<Problem> {
    [nothing_to_see(document), no_light(document)].into_iter().flatten().collect()
}

fn nothing_to_see(document: &SceneDocument) -> Option<Problem> {
    // A component of a plugin may well be something to see.
    let unseen = [TypeId::of::<DirectionalLight>(), TypeId::of::<ViewCamera>()];
    let mut components = document.entities.iter().flat_map(|entity| &entity.components);
    if components.any(|component| !unseen.contains(&component.type_id)) {
        return None;
    }
    let problem = Problem::note("the scene holds nothing to see, so the picture is its background")
        .label("nothing in here that can be seen")
        .help("add a mesh or a volume: `\"ball\": ( Mesh: Sphere() )`");
    Some(problem.at_maybe(document.head_place("entities").or(document.head_place("")).cloned()))
}

fn no_light(document: &SceneDocument) -> Option<Problem> {
    let is_light = |entity: &SceneEntity| component::<DirectionalLight>(entity).is_some();
    if document.entities.iter().any(is_light) {
        return None;
    }
    let mut dark = document.entities.iter().filter(|entity| needs_light(entity));
    let first = dark.next()?;
    let others = match dark.count() {
        0 => String::new(),
        1 => " and another entity".into(),
        more => format!(" and {more} others"),
    };
    let problem = Problem::note(format!("`{}`{others} are in the dark: the scene has no light", first.name));
    let problem = if others.is_empty() {
        Problem { message: format!("`{}` is in the dark: the scene has no light", first.name), ..problem }
    } else {
        problem
    };
    Some(
        problem
            .label("needs light to be seen")
            .help("add one: `\"sun\": ( DirectionalLight: (direction: (1.0, -2.0, -1.0), irradiance: (3.0, 3.0, 3.0)) )`")
            .at(first.place.clone()),
    )
}

fn needs_light(entity: &SceneEntity) -> bool {
    let glows = component::<Phong>(entity).is_some_and(|phong| phong.ambient != Vec3::ZERO);
    let is_mesh = component::<Mesh>(entity).is_some();
    let is_volume = component::<Volume>(entity).is_some();
    let lit_volume = match component::<VolumeLighting>(entity) {
        Some(VolumeLighting::Gradient { ambient, .. }) => *ambient == 0.0,
        _ => false,
    };
    is_mesh && !glows || is_volume && lit_volume
}

fn component<T: Reflect>(entity: &SceneEntity) -> Option<&T> {
    entity.components.iter().find_map(|component| component.value.as_any().downcast_ref())
}
