//! Components that are kept in files of their own.

use crate::components::AssetPath;
use crate::scene::document::{SceneComponent, SceneDocument, SceneEntity, identity};
use crate::scene::edit::file_path;
use crate::scene::parts::Part;
use crate::scene::problem::Place;
use bevy_reflect::Reflect;
use std::any::TypeId;
use std::path::Path;

/// A component that was read from a file of its own.
pub(super) struct Shared<'d> {
    pub entity: &'d SceneEntity,
    pub component: &'d SceneComponent,
    /// All of it in its file.
    pub place: Place,
}

/// The components of a type that a document read from this file (by [`identity`]), one for each time that it is named.
pub(super) fn shared<'d>(
    document: &'d SceneDocument,
    file: &Path,
    type_id: TypeId,
) -> impl Iterator<Item = Shared<'d>> {
    document.entities.iter().filter_map(move |entity| {
        let component = entity.components.iter().find(|component| component.type_id == type_id)?;
        let place = entity.place_of(&component.name);
        let path = place.file.path();
        let is_meant = path != entity.place.file.path() && (path == file || identity(path) == file);
        is_meant.then_some(Shared { entity, component, place })
    })
}

/// The value that a document read from this file.
pub(super) fn value_of_file<'d>(
    document: &'d SceneDocument,
    file: &Path,
    type_id: TypeId,
) -> Option<&'d dyn Reflect> {
    shared(document, file, type_id).next().map(|shared| shared.component.value.as_ref())
}

/// The file of a component that is written as `File("…")`, as opposed to standing in the scene.
pub(super) fn own_file(entity: &SceneEntity, component: &str) -> Option<AssetPath> {
    let home = entity.place.file.path();
    if entity.place_of(component).file.path() == home {
        return None;
    }
    let whole = entity.place_of("");
    let fields = Part::at(&whole).fields().ok()?;
    let written = fields.iter().find(|field| field.name.text == component)?;
    let mut path = AssetPath::new(ron::from_str::<String>(file_path(&written.value)?.text).ok()?);
    path.resolve(home.parent().unwrap_or(Path::new("")));
    Some(path)
}
