//! What is worth knowing about a scene that is right in every part.

use super::document::{SceneDocument, SceneEntity};
use super::problem::Problem;
use crate::components::{
    Auto, DirectionalLight, MapResolution, MapStrategy, Mesh, Phong, ScatteringCamera, ScatteringMaps,
    Shading, Subsurface, ViewCamera, Volume, VolumeLighting,
};
use bevy_reflect::Reflect;
use glam::Vec3;
use std::any::TypeId;

/// Notes on a scene without errors: nothing to see in it, no light on what needs some, components without effect.
pub(super) fn advice(document: &SceneDocument) -> Vec<Problem> {
    let whole = [nothing_to_see(document), no_light(document)].into_iter().flatten();
    whole.chain(document.entities.iter().flat_map(|entity| scattering(document, entity))).collect()
}

fn nothing_to_see(document: &SceneDocument) -> Option<Problem> {
    // A component of a plugin may well be something to see.
    let unseen = [TypeId::of::<DirectionalLight>(), TypeId::of::<ViewCamera>()];
    let mut components = document.entities.iter().flat_map(|entity| entity.components.iter());
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
    let mut dark = document.entities.iter().filter(|entity| needs_light(entity, document.settings.shading));
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

fn needs_light(entity: &SceneEntity, shading: Shading) -> bool {
    let shading = component::<Shading>(entity).copied().unwrap_or(shading);
    let phong = match component::<Subsurface>(entity) {
        Some(subsurface) => Some(&subsurface.local).filter(|_| shading == Shading::Local),
        None => component::<Phong>(entity),
    };
    let glows = phong.is_some_and(|phong| phong.ambient != Vec3::ZERO);
    let is_mesh = component::<Mesh>(entity).is_some();
    let is_volume = component::<Volume>(entity).is_some();
    let lit_volume = match component::<VolumeLighting>(entity) {
        Some(VolumeLighting::Gradient { ambient, .. }) => *ambient == 0.0,
        Some(VolumeLighting::SingleScattering { .. }) => true,
        Some(VolumeLighting::LightVolume { emission, .. }) => *emission == 0.0,
        _ => false,
    };
    is_mesh && !glows || is_volume && lit_volume
}

/// What is written for scattering, and has no effect.
fn scattering(document: &SceneDocument, entity: &SceneEntity) -> Vec<Problem> {
    let note = |path: &str, message: String, help: String| {
        Problem::note(message).label("without effect").help(help).at(entity.place_of(path))
    };
    let name = &entity.name;
    let mut notes = Vec::new();
    let subsurface = component::<Subsurface>(entity);
    if subsurface.is_some() && component::<Mesh>(entity).is_none() {
        let message = format!("`{name}` has a `Subsurface`, but no `Mesh` for light to enter");
        notes.push(note("Subsurface", message, "write one beside it: `Mesh: Sphere()`".into()));
    }
    if subsurface.is_some() && component::<Phong>(entity).is_some() {
        let message = format!("`{name}` is translucent, so its `Phong` plays no part");
        let help =
            "a highlight is `Subsurface.specular`; the look while `Shading` is `Local` is `Subsurface.local`";
        notes.push(note("Phong", message, help.into()));
    }
    if let Some(VolumeLighting::LightVolume { towards_eye: true, g, .. }) = component(entity)
        && *g <= 0.0
    {
        let message =
            format!("`towards_eye` has no effect on `{name}`, whose medium scatters no light forwards");
        let help = "leave it out, or write a `g` above 0";
        notes.push(note("VolumeLighting.towards_eye", message, help.into()));
    }
    let Some(maps) = component::<ScatteringMaps>(entity) else { return notes };
    if subsurface.is_none() {
        let message = format!("`{name}` has `ScatteringMaps`, but no `Subsurface` that they are for");
        notes.push(note(
            "ScatteringMaps",
            message,
            "write one beside it: `Subsurface: (material: Preset(\"marble\"))`".into(),
        ));
    } else if maps.cameras != ScatteringMaps::default().cameras
        && !makes_maps(maps)
        && !has_camera(document, name)
    {
        let message = format!(
            "`cameras` has no effect on `{name}`: its light is computed at the points of the surface"
        );
        let help = "leave it out, or ask for maps: `resolution: Texels(512, 512)`";
        notes.push(note("ScatteringMaps.cameras", message, help.into()));
    }
    if maps.strategy == MapStrategy::Adaptive && maps.candidates != Auto::Auto {
        let message = format!("`candidates` has no effect on `{name}`, whose `strategy` is `Adaptive`");
        let help = "leave it out, or write `strategy: Uniform`";
        notes.push(note("ScatteringMaps.candidates", message, help.into()));
    }
    notes
}

fn makes_maps(maps: &ScatteringMaps) -> bool {
    maps.strategy == MapStrategy::Uniform || maps.resolution != MapResolution::Auto
}

fn has_camera(document: &SceneDocument, target: &str) -> bool {
    let mut cameras = document.entities.iter().filter_map(component::<ScatteringCamera>);
    cameras.any(|camera| camera.target == target)
}

fn component<T: Reflect>(entity: &SceneEntity) -> Option<&T> {
    entity.components.iter().find_map(|component| component.value.as_any().downcast_ref())
}
