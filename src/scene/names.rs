//! Finding what a misspelt name was meant to be.

use crate::plain::piece;
use std::path::Path;

/// Bytes of a name that may be misspelt; nobody types more.
const LONGEST: usize = 256;

/// The candidate nearest to `name`, if one is near enough to be meant.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > LONGEST {
        return None;
    }
    let wanted = name.to_lowercase();
    candidates
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST)
        .map(|candidate| (strsim::damerau_levenshtein(&wanted, &candidate.to_lowercase()), candidate))
        .filter(|(distance, candidate)| *distance <= 1 + candidate.chars().count() / 3)
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

/// "did you mean `x`?" where something is near, else the list of all that would do.
pub(super) fn suggestion(name: &str, candidates: &[&str]) -> String {
    match nearest(name, candidates.iter().copied()) {
        Some(near) => format!("did you mean `{}`?", piece(near)),
        None if candidates.is_empty() => "nothing is known here".into(),
        None => format!("known here: {}", candidates.join(", ")),
    }
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
}
