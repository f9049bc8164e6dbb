//! Components kept in files of their own.

use super::parts::Part;
use super::problem::{Problem, Severity};
use super::reader::Reader;
use super::text::{COMPONENT, read_text, stranger};
use bevy_reflect::{Reflect, TypeRegistration, TypeRegistry};
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
    let file = read_text(path, COMPONENT, true).map_err(|problem| vec![*problem])?;
    let mut reader = Reader::new(registry, file);
    let value = reader.whole_file(registration, registration.type_info().type_path_table().short_path());
    let has_errors = reader.problems.iter().any(|problem| problem.severity == Severity::Error);
    value.filter(|_| !has_errors).ok_or(reader.problems)
}

impl Reader<'_> {
    /// Reads the component `name` that is all that the file holds.
    pub fn whole_file(&mut self, registration: &TypeRegistration, name: &str) -> Option<Box<dyn Reflect>> {
        let file = self.file.clone();
        let whole = Part::whole(file.text()).trimmed();
        if whole.text.is_empty() {
            let problem = Problem::error("the file is empty").label("nothing but white space and comments");
            self.report(&whole, problem.help(format!("write what would stand behind `{name}:` in a scene")));
            return None;
        }
        let value = self.complete(&whole, registration, name);
        if value.is_none()
            && let Some(problem) = stranger(&file, COMPONENT)
        {
            self.problems.clear();
            self.report(&whole, problem);
        }
        value
    }
}
