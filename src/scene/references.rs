//! Entities that name each other: whether those named are there.

use super::document::{SceneComponent, SceneDocument, SceneEntity};
use super::names::nearest;
use super::problem::{Place, Problem, Severity};
use crate::components::NameOf;
use bevy_reflect::{ReflectRef, TypeInfo};
use std::cell::LazyCell;
use std::sync::Arc;

/// An error for each name that no entity has, or one without the component that is asked for.
///
/// What may only follow from another error is left out: a name that a part of the scene may have which could not be read, a component
/// that may be misspelt.
pub(super) fn references(document: &SceneDocument) -> Vec<Problem> {
    let entities_are_complete = LazyCell::new(|| {
        errors(document)
            .all(|place| document.entities.iter().any(|entity| lies_in(place, &entity.place_of(""))))
    });
    let mut problems = Vec::new();
    for entity in &document.entities {
        for reference in entity.components.iter().flat_map(references_in) {
            let problem = match document.entity(reference.name) {
                None if *entities_are_complete => nobody(document, &reference),
                Some(named) if !named.is_written(reference.having) && is_sound(document, named) => {
                    unsuitable(document, &reference, named)
                }
                _ => continue,
            };
            let path = format!("{}.{}", reference.component, reference.field);
            problems.push(problem.at(entity.place_of(&path)));
        }
    }
    problems
}

/// A field that holds the name of an entity.
struct Reference<'d> {
    component: &'d str,
    field: &'static str,
    name: &'d str,
    having: &'static str,
}

fn references_in(component: &SceneComponent) -> Vec<Reference<'_>> {
    let Some(TypeInfo::Struct(info)) = component.value.get_represented_type_info() else { return Vec::new() };
    let ReflectRef::Struct(fields) = component.value.reflect_ref() else { return Vec::new() };
    let reference = |(field, NameOf(having)): (&'static str, &NameOf)| {
        let value = fields.field(field)?;
        let optional = || value.try_downcast_ref::<Option<String>>().and_then(Option::as_ref);
        let name = value.try_downcast_ref::<String>().or_else(optional)?;
        Some(Reference { component: &component.name, field, name, having })
    };
    let named = info.iter().filter_map(|field| Some((field.name(), field.get_attribute()?)));
    named.filter_map(reference).collect()
}

fn nobody(document: &SceneDocument, reference: &Reference) -> Problem {
    let all = document.entities.iter().map(|entity| entity.name.as_str());
    let near = nearest(reference.name, suitable(document, reference)).or(nearest(reference.name, all));
    let help = near.map_or_else(|| known(document, reference), |near| format!("did you mean `{near}`?"));
    Problem::error(format!("there is no entity `{}`", reference.name)).label("unknown name").help(help)
}

fn unsuitable(document: &SceneDocument, reference: &Reference, named: &SceneEntity) -> Problem {
    let Reference { component, field, name, having } = reference;
    let message = format!("the `{field}` of a `{component}` needs a `{having}`, and `{name}` has none");
    let other = Some((named.place.clone(), format!("has no `{having}`")));
    Problem { other, ..Problem::error(message) }.help(known(document, reference))
}

/// The names that would do.
fn suitable<'d>(document: &'d SceneDocument, reference: &Reference) -> impl Iterator<Item = &'d str> {
    let having = reference.having;
    let suitable = document.entities.iter().filter(move |entity| entity.is_written(having));
    suitable.map(|entity| entity.name.as_str())
}

/// As many names as one may care to read.
const NAMES_LISTED: usize = 12;

fn known(document: &SceneDocument, reference: &Reference) -> String {
    let having = reference.having;
    let mut names: Vec<_> =
        suitable(document, reference).take(NAMES_LISTED + 1).map(|name| format!("`{name}`")).collect();
    if names.is_empty() {
        return format!("no entity has a `{having}`: write one beside what is meant");
    }
    if names.len() > NAMES_LISTED {
        names[NAMES_LISTED] = "…".into();
    }
    format!("those with a `{having}`: {}", names.join(", "))
}

/// Whether no error stands in what the scene says of the entity.
fn is_sound(document: &SceneDocument, entity: &SceneEntity) -> bool {
    !errors(document).any(|place| lies_in(place, &entity.place_of("")))
}

fn errors(document: &SceneDocument) -> impl Iterator<Item = &Place> {
    let errors = document.problems.iter().filter(|problem| problem.severity == Severity::Error);
    errors.filter_map(|problem| problem.place.as_ref())
}

fn lies_in(inner: &Place, outer: &Place) -> bool {
    Arc::ptr_eq(&inner.file, &outer.file)
        && outer.bytes.start <= inner.bytes.start
        && inner.bytes.end <= outer.bytes.end
}
