//! Changes that are not yet right: what would break a component waits until it is whole again.

use super::super::edited::{Edited, get, put};
use super::leaf::copy;
use crate::components::ReflectValidate;
use bevy_reflect::{PartialReflect, Reflect, ReflectRef, TypeRegistry};
use std::sync::Arc;

/// A component as a person has changed it so far, held back because it is not right.
#[derive(Clone)]
pub(super) struct Draft {
    /// What was changed.
    pub component: Arc<dyn Reflect>,
    /// What it was changed from; when that is another, the draft is out of date.
    base: Arc<dyn Reflect>,
    /// Where it was changed.
    paths: Vec<String>,
}

/// What comes of changes: those to make, or a draft to keep.
pub(super) enum Outcome {
    Made(Vec<Edited>),
    Held(Draft),
}

impl Draft {
    /// Whether it is a draft of this component.
    pub fn is_of(&self, component: &dyn Reflect) -> bool {
        // Of what it points to: a pointer is a value to reflection, too.
        self.base.as_ref().reflect_partial_eq(component.as_partial_reflect()) == Some(true)
    }
}

/// Makes changes to a component, or to the draft of it, if the result is right; holds them back otherwise.
pub(super) fn change(
    component: &dyn Reflect,
    draft: Option<Draft>,
    edits: Vec<Edited>,
    registry: &TypeRegistry,
) -> Outcome {
    let shown = draft.as_ref().map_or(component, |draft| draft.component.as_ref());
    let Some(mut changed) = copy(shown.as_partial_reflect(), registry) else { return Outcome::Made(edits) };
    if edits
        .iter()
        .any(|edit| put(changed.as_partial_reflect_mut(), &edit.path, edit.value.as_ref()).is_err())
    {
        return Outcome::Made(edits);
    }
    let is_right = problems(changed.as_partial_reflect(), registry).is_empty();
    // What was wrong before may be changed step by step.
    let was_wrong = draft.is_none() && !problems(component.as_partial_reflect(), registry).is_empty();
    if draft.is_none() && (is_right || was_wrong) {
        return Outcome::Made(edits);
    }
    let mut paths = draft.as_ref().map(|draft| draft.paths.clone()).unwrap_or_default();
    paths.extend(edits.iter().map(|edit| edit.path.clone()));
    let finished = edits.iter().all(|edit| edit.finished);
    if is_right {
        // One change, of all that was held back.
        let path = common(&paths);
        let value = get(changed.as_partial_reflect(), &path).and_then(|value| copy(value, registry));
        return Outcome::Made(value.map(|value| Edited { path, value, finished }).into_iter().collect());
    }
    let base = draft
        .map(|draft| draft.base)
        .or_else(|| copy(component.as_partial_reflect(), registry).map(Arc::from));
    match base {
        Some(base) => Outcome::Held(Draft { component: Arc::from(changed), base, paths }),
        None => Outcome::Made(edits),
    }
}

/// The longest path that all of these begin with.
fn common(paths: &[String]) -> String {
    let Some(first) = paths.first() else { return String::new() };
    let ends = first.char_indices().filter(|(_, letter)| matches!(letter, '.' | '[')).map(|(at, _)| at);
    let mut beginnings = std::iter::once(0).chain(ends).chain([first.len()]).map(|end| &first[..end]);
    let is_shared = |beginning: &&str| {
        paths.iter().all(|path| {
            let rest = path.strip_prefix(beginning);
            rest.is_some_and(|rest| beginning.is_empty() || rest.is_empty() || rest.starts_with(['.', '[']))
        })
    };
    beginnings.rfind(is_shared).unwrap_or_default().to_owned()
}

/// Lists longer than this are taken to be right.
const ITEMS_VALIDATED: usize = 1000;

/// What is wrong with a value and what it holds: the path, and a sentence.
pub(super) fn problems(value: &dyn PartialReflect, registry: &TypeRegistry) -> Vec<(String, String)> {
    let mut found = Vec::new();
    validate(value, &mut String::new(), registry, &mut found);
    found
}

fn validate(
    value: &dyn PartialReflect,
    path: &mut String,
    registry: &TypeRegistry,
    found: &mut Vec<(String, String)>,
) {
    if let Some(value) = value.try_as_reflect()
        && let Some(validate) = registry.get_type_data::<ReflectValidate>(value.as_any().type_id())
        && let Some(value) = validate.get(value)
    {
        found.extend(value.problems().into_iter().map(|(field, message)| {
            let dot = if path.is_empty() || field.is_empty() { "" } else { "." };
            (format!("{path}{dot}{field}"), message)
        }));
    }
    let mut within = |step: &str, value: &dyn PartialReflect| {
        let length = path.len();
        if !path.is_empty() && !step.is_empty() && !step.starts_with('[') {
            path.push('.');
        }
        path.push_str(step);
        validate(value, path, registry, found);
        path.truncate(length);
    };
    match value.reflect_ref() {
        ReflectRef::Struct(fields) => {
            for (index, (_, field)) in fields.iter_fields().enumerate() {
                within(fields.name_at(index).unwrap_or_default(), field);
            }
        }
        ReflectRef::TupleStruct(fields) => {
            fields.iter_fields().enumerate().for_each(|(index, field)| within(&index.to_string(), field));
        }
        ReflectRef::Enum(variant) => {
            let is_transparent = super::super::edited::is_transparent(variant);
            for (index, field) in variant.iter_fields().enumerate() {
                let step = match variant.name_at(index) {
                    Some(name) => name.to_owned(),
                    None if is_transparent => String::new(),
                    None => index.to_string(),
                };
                within(&step, field.value());
            }
        }
        ReflectRef::List(items) if items.len() <= ITEMS_VALIDATED => {
            items.iter().enumerate().for_each(|(index, item)| within(&format!("[{index}]"), item));
        }
        _ => {}
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::components::{Material, Subsurface};
    use bevy_reflect::TypeRegistry;
    use glam::Vec3;

    fn edit(path: &str, value: Option<Vec3>) -> Vec<Edited> {
        vec![Edited { path: path.into(), value: Box::new(value), finished: true }]
    }

    #[test]
    fn what_is_half_done_waits_and_is_then_one_change() {
        let mut registry = TypeRegistry::new();
        registry.register::<Subsurface>();
        registry.register::<Option<Vec3>>();
        let material = Material::Custom {
            sigma_a: Some(Vec3::ONE),
            sigma_s: Some(Vec3::ONE),
            sigma_t: None,
            albedo: None,
            g: 0.0,
            eta: 1.3,
        };
        let body = Subsurface { material, ..Default::default() };
        let steps =
            [("sigma_t", Some(Vec3::ONE)), ("albedo", Some(Vec3::ONE)), ("sigma_a", None), ("sigma_s", None)];
        let mut draft = None;
        for (index, (field, value)) in steps.into_iter().enumerate() {
            match change(&body, draft.take(), edit(&format!("material.{field}"), value), &registry) {
                Outcome::Held(held) if index < 3 => {
                    assert!(held.is_of(&body));
                    let wrong = problems(held.component.as_partial_reflect(), &registry);
                    assert!(wrong.iter().all(|(path, _)| path.starts_with("material")), "{wrong:?}");
                    draft = Some(held);
                }
                Outcome::Made(made) if index == 3 => {
                    assert_eq!((made.len(), made[0].path.as_str()), (1, "material"));
                    let medium = made[0].value.downcast_ref::<Material>().unwrap();
                    assert!(matches!(medium, Material::Custom { sigma_t: Some(_), sigma_a: None, .. }));
                }
                _ => panic!("step {index}"),
            }
        }
    }

    #[test]
    fn paths_have_their_beginning_in_common() {
        let common =
            |paths: &[&str]| common(&paths.iter().map(|path| (*path).to_owned()).collect::<Vec<_>>());
        assert_eq!(common(&["material.sigma_a", "material.sigma_s"]), "material");
        assert_eq!(common(&["points[1]", "points[10].2"]), "points");
        assert_eq!(common(&["eye", "eyes"]), "");
        assert_eq!(common(&["eye", "eye"]), "eye");
    }
}
