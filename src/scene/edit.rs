//! Changing one value in the text of a scene, leaving the rest of the text as it is.

use super::document::{Override, SETTINGS, SceneDocument};
use super::names::{Known, meant, nearest};
use super::parts::{Part, Payload, Shape};
use super::problem::{Place, Problem, SourceFile};
use super::tokens::tokens;
use super::wanted::{is_led, shorthand};
use bevy_reflect::enums::VariantInfo;
use bevy_reflect::{TypeInfo, TypeRegistration, TypeRegistry};
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
            let is_head = first.len() == change.path.len();
            let near = nearest(first, names.chain(SETTINGS.into_iter().filter(|_| is_head)));
            let help = near.map_or("write entity.Component.field=VALUE".into(), |near| {
                format!("did you mean `{near}`?")
            });
            let what = if is_head { "setting" } else { "entity" };
            fail(format!("the scene has no {what} `{first}`"), help)
        });
    };
    let path = &change.path[entity.name.len() + 1..];
    let component = path.split(['.', '[']).next().unwrap_or_default();
    let Some(registration) = registry.get_with_short_type_path(component) else {
        let written: Vec<&str> = entity.components.iter().map(|component| component.name.as_str()).collect();
        let help = match meant(component, &Known::components(registry)).first() {
            Some(near) => format!("did you mean `{}.{near}{}`?", entity.name, &path[component.len()..]),
            None => format!("`{}` has: {}", entity.name, written.join(", ")),
        };
        return Err(fail(format!("there is no component `{component}`"), help));
    };
    let place = entity.place_of(path);
    if entity.is_written(path) {
        return Ok(splice(&place, &change.value));
    }
    // Not written yet: added as the first field of what is around it.
    let (around, field) = path.rsplit_once('.').unwrap_or(("", path));
    if around == component
        && !entity.is_written(around)
        && matches!(registration.type_info(), TypeInfo::Struct(_))
    {
        return Ok(insert(&entity.place_of(""), component, &format!("({field}: {})", change.value), None));
    }
    if !entity.is_written(around) {
        return Err(fail(
            format!("`{around}` is not written in the scene, so its `{field}` cannot be set"),
            format!("set the whole: {}.{around}=(…)", entity.name),
        ));
    }
    let place = entity.place_of(around);
    let led = if around == component { Led::at(&place, registration) } else { None };
    Ok(insert(&place, field, &change.value, led))
}

/// A first field that stands alone and without its name: `File("head.nii")`, `Preset("Object")`.
struct Led {
    field: &'static str,
    /// Whether the word in front stays when the field gets its name.
    keeps_word: bool,
}

impl Led {
    fn at(place: &Place, registration: &TypeRegistration) -> Option<Self> {
        let part = Part::at(place);
        let word = part.word()?.text;
        let (payload, field, keeps_word) = match registration.type_info() {
            TypeInfo::Struct(info) => {
                (part.struct_payload(shorthand(info)), info.iter().next()?.name(), false)
            }
            TypeInfo::Enum(info) => match info.variant(word)? {
                VariantInfo::Struct(variant) if is_led(variant) => {
                    (part.payload(Shape::LedStruct), variant.iter().next()?.name(), true)
                }
                _ => return None,
            },
            _ => return None,
        };
        matches!(payload, Ok(Payload::Led(_))).then_some(Self { field, keeps_word })
    }
}

/// Adds a field in front of the others of what stands at `place`, which may be a bare name without parentheses.
fn insert(place: &Place, field: &str, value: &str, led: Option<Led>) -> (PathBuf, String) {
    let text = &place.file.text()[place.bytes.clone()];
    // The parentheses of `Some((…))` that hold fields are the second.
    let is_some = tokens(text).next().is_some_and(|token| &text[token] == "Some");
    let mut opening = tokens(text).filter(|token| text[token.clone()].starts_with('('));
    let Some(open) = opening.nth(usize::from(is_some)) else {
        return splice(place, &format!("{text}({field}: {value})"));
    };
    let inside = place.bytes.start + open.end;
    if let Some(name) = led {
        // What stood alone without its name gets it; a struct loses the word in front.
        let mut text = text.to_owned();
        let close = text.rfind(')').unwrap_or(text.len());
        let comma = if text[..close].trim_end().ends_with(',') { " " } else { ", " };
        text.insert_str(close, &format!("{comma}{field}: {value}"));
        text.insert_str(open.end, &format!("{}: ", name.field));
        let from = if name.keeps_word { 0 } else { open.start };
        return splice(place, &text[from..]);
    }
    let is_empty =
        tokens(&text[open.end..]).next().is_some_and(|token| text[open.end..][token].starts_with(')'));
    let comma = if is_empty { "" } else { ", " };
    splice(&Place { bytes: inside..inside, ..place.clone() }, &format!("{field}: {value}{comma}"))
}

fn head(document: &SceneDocument, change: &Override) -> Option<(PathBuf, String)> {
    let field = change.path.as_str();
    if let Some(place) = document.head_place(field).filter(|_| !field.is_empty()) {
        return Some(splice(place, &change.value));
    }
    let whole = document.head_place("").filter(|_| SETTINGS.contains(&field))?;
    Some(insert(whole, field, &change.value, None))
}

fn splice(place: &Place, value: &str) -> (PathBuf, String) {
    let mut text = place.file.text().to_owned();
    text.replace_range(place.bytes.clone(), value);
    (place.file.path().to_owned(), text)
}
