//! Entities that name each other: whether those named are there.

use super::document::{SceneComponent, SceneDocument, SceneEntity};
use super::names::nearest;
use super::problem::{Place, Problem, Severity};
use crate::components::NameOf;
use crate::plain::piece;
use bevy_reflect::{ReflectRef, TypeInfo};
use std::cell::LazyCell;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

/// An error for each name that no entity has, or one without the component that is asked for.
///
/// What may only follow from another error is left out: a name that a part of the scene may have which could not be read, a component
/// that may be misspelt.
pub(super) fn references(document: &SceneDocument) -> Vec<Problem> {
    let errors = LazyCell::new(|| Errors::of(document));
    let mut advisor = Advisor { document, known: HashMap::new(), left: MOST_SUGGESTIONS };
    let mut problems = Vec::new();
    for entity in &document.entities {
        for reference in entity.components.iter().flat_map(references_in) {
            let problem = match document.entity(reference.name) {
                None if errors.all_in_entities => advisor.nobody(&reference),
                Some(named)
                    if !named.is_written(reference.having)
                        && !errors.unsound.contains(named.name.as_str()) =>
                {
                    advisor.unsuitable(&reference, named)
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

/// Misspelt names that are compared with all others: as many as are told in full.
const MOST_SUGGESTIONS: usize = 50;

/// As many names as one may care to read.
const NAMES_LISTED: usize = 12;

/// Says what was meant, or would do.
struct Advisor<'d> {
    document: &'d SceneDocument,
    /// The names that would do where a component is asked for, as a list to be read.
    known: HashMap<&'d str, String>,
    /// How many names more are compared with all others.
    left: usize,
}

impl<'d> Advisor<'d> {
    fn nobody(&mut self, reference: &Reference<'d>) -> Problem {
        let near = match self.left.checked_sub(1) {
            Some(left) => {
                self.left = left;
                let all = self.document.entities.iter().map(|entity| entity.name.as_str());
                nearest(reference.name, suitable(self.document, reference.having))
                    .or(nearest(reference.name, all))
            }
            None => None,
        };
        let help = match near {
            Some(near) => format!("did you mean `{}`?", piece(near)),
            None => self.known(reference),
        };
        let message = format!("there is no entity `{}`", piece(reference.name));
        Problem::error(message).label("unknown name").help(help)
    }

    fn unsuitable(&mut self, reference: &Reference<'d>, named: &SceneEntity) -> Problem {
        let Reference { component, field, name, having } = reference;
        let name = piece(name);
        let message = format!("the `{field}` of a `{component}` needs a `{having}`, and `{name}` has none");
        let other = Some((named.place.clone(), format!("has no `{having}`")));
        Problem { other, ..Problem::error(message) }.help(self.known(reference))
    }

    fn known(&mut self, reference: &Reference<'d>) -> String {
        let having = reference.having;
        let document = self.document;
        self.known.entry(having).or_insert_with(|| known(document, having)).clone()
    }
}

/// The names that would do.
fn suitable<'d>(document: &'d SceneDocument, having: &'d str) -> impl Iterator<Item = &'d str> {
    let suitable = document.entities.iter().filter(move |entity| entity.is_written(having));
    suitable.map(|entity| entity.name.as_str())
}

fn known(document: &SceneDocument, having: &str) -> String {
    let mut names: Vec<_> =
        suitable(document, having).take(NAMES_LISTED + 1).map(|name| format!("`{}`", piece(name))).collect();
    if names.is_empty() {
        return format!("no entity has a `{having}`: write one beside what is meant");
    }
    if names.len() > NAMES_LISTED {
        names[NAMES_LISTED] = "…".into();
    }
    format!("those with a `{having}`: {}", names.join(", "))
}

/// What the errors of a document lie in.
struct Errors<'d> {
    /// The names of entities in which errors lie.
    unsound: HashSet<&'d str>,
    /// Whether none lies anywhere else.
    all_in_entities: bool,
}

impl<'d> Errors<'d> {
    fn of(document: &'d SceneDocument) -> Self {
        let errors = document.problems.iter().filter(|problem| problem.severity == Severity::Error);
        let mut found = Self { unsound: HashSet::new(), all_in_entities: true };
        let entities = Entities::of(document);
        for place in errors.filter_map(|problem| problem.place.as_ref()) {
            match entities.around(place) {
                Some(entity) => _ = found.unsound.insert(entity.name.as_str()),
                None => found.all_in_entities = false,
            }
        }
        found
    }
}

/// The entities of a document by where they stand: the path of the file, and the bytes in it.
pub(crate) struct Entities<'d>(BTreeMap<(&'d Path, usize), (usize, &'d SceneEntity)>);

impl<'d> Entities<'d> {
    pub(crate) fn of(document: &'d SceneDocument) -> Self {
        let place = |entity: &'d SceneEntity| {
            let bytes = entity.place_of("").bytes;
            ((entity.place.file.path(), bytes.start), (bytes.end, entity))
        };
        Self(document.entities.iter().map(place).collect())
    }

    /// The entity in whose text a place lies, or did when the document was read, if the place is in a later text of the file.
    pub(crate) fn around(&self, place: &Place) -> Option<&'d SceneEntity> {
        let path = place.file.path();
        let ((of, _), (end, entity)) = self.0.range(..=(path, place.bytes.start)).next_back()?;
        (*of == path && place.bytes.end <= *end).then_some(*entity)
    }
}
