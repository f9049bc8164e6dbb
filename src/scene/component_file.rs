//! Components kept in files of their own.

use super::loader::read_text;
use super::parts::Part;
use super::problem::{Problem, Severity};
use super::reader::Reader;
use bevy_reflect::{Reflect, TypeRegistry};
use std::any::TypeId;
use std::path::Path;

/// Reads a component of the type from a file that holds nothing else, as a scene does that names it: `Subsurface: File("marble.ron")`.
///
/// # Errors
///
/// Everything that is wrong with the file, each with its place.
pub fn read_component(
    path: &Path,
    component: TypeId,
    registry: &TypeRegistry,
) -> Result<Box<dyn Reflect>, Vec<Problem>> {
    let Some(registration) = registry.get(component) else {
        return Err(vec![Problem::error("the type of this component is not registered for reflection")]);
    };
    let file = read_text(path).map_err(|problem| vec![*problem])?;
    let name = registration.type_info().type_path_table().short_path();
    let mut reader = Reader::new(registry, file.clone());
    let whole = Part::whole(file.text()).trimmed();
    if whole.text.is_empty() {
        let problem = Problem::error("the file is empty").label("nothing but white space and comments");
        reader.report(&whole, problem.help(format!("write what would stand behind `{name}:` in a scene")));
        return Err(reader.problems);
    }
    let value = reader.complete(&whole, registration, name);
    let has_errors = reader.problems.iter().any(|problem| problem.severity == Severity::Error);
    value.filter(|_| !has_errors).ok_or(reader.problems)
}
