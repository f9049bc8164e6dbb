//! Finding what a misspelt name was meant to be.

use crate::components::AlsoCalled;
use crate::plain::piece;
use bevy_ecs::reflect::ReflectComponent;
use bevy_reflect::attributes::CustomAttributes;
use bevy_reflect::enums::VariantInfo;
use bevy_reflect::{NamedField, TypeInfo, TypeRegistry};
use std::path::Path;

/// Bytes of a name that may be misspelt; nobody types more.
const LONGEST: usize = 256;

/// The candidate nearest to `name`, if one is near enough to be meant.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    nearest_within(name, candidates, 1)
}

/// The same, where so many letters may differ, and one more of every three that the candidate has.
fn nearest_within<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
    letters: usize,
) -> Option<&'a str> {
    if name.len() > LONGEST {
        return None;
    }
    let wanted = name.to_lowercase();
    let length = wanted.chars().count();
    candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST)
        .filter_map(|candidate| {
            let own = candidate.chars().count();
            let most = letters + own / 3;
            // As many letters differ at least as one has more than the other; comparing them takes its time.
            if own.abs_diff(length) > most {
                return None;
            }
            let distance = strsim::damerau_levenshtein(&wanted, &candidate.to_lowercase());
            (distance <= most).then_some((distance, candidate))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// The file of the path's folder whose name is nearest to the one that the path asks for.
pub(super) fn nearest_file(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).ok()?.take(4096).flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort_unstable();
    nearest(&path.file_name()?.to_string_lossy(), names.iter().map(String::as_str)).map(str::to_owned)
}

/// A name that can be written, and what else people call what it names.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Known<'a> {
    pub name: &'a str,
    also: &'a [&'static str],
}

impl<'a> Known<'a> {
    /// One that has no other names.
    pub fn plain(name: &'a str) -> Self {
        Self { name, also: &[] }
    }

    fn new(name: &'a str, attributes: &'a CustomAttributes) -> Self {
        Self { name, also: attributes.get::<AlsoCalled>().map_or(&[], |also| also.0) }
    }

    pub fn field(field: &'a NamedField) -> Self {
        Self::new(field.name(), field.custom_attributes())
    }

    pub fn variant(variant: &'a VariantInfo) -> Self {
        Self::new(variant.name(), variant.custom_attributes())
    }

    /// All components, in the order of the alphabet.
    pub fn components(registry: &'a TypeRegistry) -> Vec<Self> {
        let components =
            registry.iter().filter(|registration| registration.data::<ReflectComponent>().is_some());
        let mut known: Vec<Self> =
            components.map(|registration| Self::component(registration.type_info())).collect();
        known.sort_unstable_by_key(|known| known.name);
        known
    }

    fn component(info: &'a TypeInfo) -> Self {
        let name = info.type_path_table().short_path();
        match info {
            TypeInfo::Struct(info) => Self::new(name, info.custom_attributes()),
            TypeInfo::TupleStruct(info) => Self::new(name, info.custom_attributes()),
            TypeInfo::Enum(info) => Self::new(name, info.custom_attributes()),
            _ => Self::plain(name),
        }
    }

    fn is_also_called(&self, name: &str) -> bool {
        self.also.iter().any(|also| is_same_word(also, name))
    }
}

/// `LookupTable`, `lookup_table` and `lookup table` are the same.
fn is_same_word(a: &str, b: &str) -> bool {
    fn letters(text: &str) -> impl Iterator<Item = char> + '_ {
        text.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase)
    }
    letters(a).eq(letters(b))
}

/// Which of the candidates may be meant: the one that is spelt nearly so, else those that are also called so, or nearly so.
pub(crate) fn meant<'a>(name: &str, candidates: &[Known<'a>]) -> Vec<&'a str> {
    if let Some(same) = candidates.iter().find(|known| is_same_word(known.name, name)) {
        return vec![same.name];
    }
    let called = |name: &str| -> Vec<&'a str> {
        candidates.iter().filter(|known| known.is_also_called(name)).map(|known| known.name).collect()
    };
    let exactly = called(name);
    if !exactly.is_empty() {
        return exactly;
    }
    if let Some(near) = nearest(name, candidates.iter().map(|known| known.name)) {
        return vec![near];
    }
    // These are many, and short: less is a slip of the finger here.
    nearest_within(name, candidates.iter().flat_map(|known| known.also.iter().copied()), 0)
        .map(called)
        .unwrap_or_default()
}

/// "did you mean `x`?" where something may be meant, else the list of all that would do.
pub(super) fn suggestion(name: &str, candidates: &[Known]) -> String {
    let meant: Vec<String> =
        meant(name, candidates).iter().map(|name| format!("`{}`", piece(name))).collect();
    if !meant.is_empty() {
        return format!("did you mean {}?", meant.join(" or "));
    }
    if candidates.is_empty() {
        return "nothing is known here".into();
    }
    let all: Vec<&str> = candidates.iter().map(|known| known.name).collect();
    format!("known here: {}", all.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_finger_is_understood() {
        assert_eq!(nearest("difuse", ["ambient", "diffuse"]), Some("diffuse"));
        assert_eq!(nearest("phong", ["Phong", "Mesh"]), Some("Phong"));
        assert_eq!(nearest("sigma", ["ambient", "diffuse"]), None);
        // Comparing them would take more memory than there is.
        let endless = "a".repeat(1 << 26);
        assert_eq!(nearest(&endless, [endless.as_str(), "diffuse"]), None);
        assert_eq!(nearest("difuse", [endless.as_str(), "diffuse"]), Some("diffuse"));
    }

    const FILE: Known = Known { name: "File", also: &["Obj", "Ply"] };
    const BOX: Known = Known { name: "Box", also: &["Cube"] };

    #[test]
    fn what_others_call_it_is_understood() {
        let known = [FILE, BOX, Known::plain("Plane")];
        assert_eq!(meant("Obj", &known), ["File"], "though `Box` is but two letters away");
        assert_eq!(meant("OBJ", &known), ["File"]);
        assert_eq!(meant("Cubee", &known), ["Box"]);
        assert_eq!(meant("Bx", &known), ["Box"]);
        assert_eq!(meant("plane", &known), ["Plane"]);
        assert_eq!(meant("Torus", &known), [""; 0]);
        assert_eq!(meant("Ohm", &[FILE]), [""; 0], "`Obj` is something else");
        assert_eq!(suggestion("Torus", &known), "known here: File, Box, Plane");
        let two = [Known { name: "Phong", also: &["Material"] }, Known { name: "Skin", also: &["Material"] }];
        assert_eq!(suggestion("material", &two), "did you mean `Phong` or `Skin`?");
        assert!(is_same_word("look_at", "LookAt"));
    }
}
