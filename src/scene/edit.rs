//! Changing one value in the text of a scene, leaving the rest of the text as it is.

use super::document::{Override, SceneDocument};
use super::names::nearest;
use super::parts::{Part, Payload, Shape};
use super::problem::{Place, Problem, SourceFile};
use bevy_reflect::TypeRegistry;
use std::path::PathBuf;

/// The path in `File("…")`, where the part is written so.
pub(super) fn file_path<'a>(part: &Part<'a>) -> Option<Part<'a>> {
    part.word().filter(|word| word.text == "File")?;
    match part.payload(Shape::Tuple(1)) {
        Ok(Payload::Values(values)) => values.into_iter().next(),
        _ => None,
    }
}

/// The file that an override changes, and its new text.
pub(super) fn apply(
    document: &SceneDocument,
    change: &Override,
    registry: &TypeRegistry,
) -> Result<(PathBuf, String), Box<Problem>> {
    let written = SourceFile::new("--set", format!("{}={}", change.path, change.value));
    let at = Place { file: written, bytes: 0..change.path.len() };
    let fail = |message: String, help: String| {
        Box::new(Problem::error(message).label("names nothing").help(help).at(at.clone()))
    };

    let entity = document
        .entities
        .iter()
        .filter(|entity| change.path.strip_prefix(&entity.name).is_some_and(|rest| rest.starts_with('.')));
    let Some(entity) = entity.max_by_key(|entity| entity.name.len()) else {
        return head(document, change).ok_or_else(|| {
            let first = change.path.split('.').next().unwrap_or_default();
            let names = document.entities.iter().map(|entity| entity.name.as_str());
            let help = nearest(first, names).map_or("write entity.Component.field=VALUE".into(), |near| {
                format!("did you mean `{near}`?")
            });
            fail(format!("the scene has no entity `{first}`"), help)
        });
    };
    let path = &change.path[entity.name.len() + 1..];
    let component = path.split(['.', '[']).next().unwrap_or_default();
    if registry.get_with_short_type_path(component).is_none() {
        return Err(fail(
            format!("there is no component `{component}`"),
            format!("`{}` has: {}", entity.name, names(entity)),
        ));
    }
    let place = entity.place_of(path);
    if entity.is_written(path) {
        return Ok(splice(&place, &change.value));
    }
    // Not written yet: added as the first field of what is around it, which must be written with parentheses.
    let (around, field) = path.rsplit_once('.').unwrap_or(("", path));
    if !entity.is_written(around) {
        return Err(fail(
            format!("`{around}` is not written in the scene, so its `{field}` cannot be set"),
            format!("set the whole: {}.{around}=(…)", entity.name),
        ));
    }
    let place = entity.place_of(around);
    let text = &place.file.text()[place.bytes.clone()];
    match text.find('(') {
        Some(open) => {
            let empty = text[open + 1..].trim_start().starts_with(')');
            let after =
                Place { bytes: place.bytes.start + open + 1..place.bytes.start + open + 1, ..place.clone() };
            Ok(splice(&after, &format!("{field}: {}{}", change.value, if empty { "" } else { ", " })))
        }
        None => Ok(splice(&place, &format!("{text}({field}: {})", change.value))),
    }
}

fn head(document: &SceneDocument, change: &Override) -> Option<(PathBuf, String)> {
    let field = change.path.as_str();
    if let Some(place) = document.head_place(field) {
        return Some(splice(place, &change.value));
    }
    let whole = document.head_place("").filter(|_| super::document::SETTINGS.contains(&field))?;
    let open = whole.file.text().find('(')?;
    Some(splice(
        &Place { bytes: open + 1..open + 1, ..whole.clone() },
        &format!("{field}: {}, ", change.value),
    ))
}

fn names(entity: &super::SceneEntity) -> String {
    entity.components.iter().map(|component| component.name.as_str()).collect::<Vec<_>>().join(", ")
}

fn splice(place: &Place, value: &str) -> (PathBuf, String) {
    let mut text = place.file.text().to_owned();
    text.replace_range(place.bytes.clone(), value);
    (place.file.path().to_owned(), text)
}
