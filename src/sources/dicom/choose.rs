//! Which of the images in a folder make the volume.

use std::{
    collections::{BTreeMap, HashMap},
    path::Path,
};

use glam::DVec3;

use super::{File, SourceError};

/// Other series that a note names.
const MAX_NAMED: usize = 6;

/// Letters of a description that a note repeats.
const MAX_DESCRIPTION: usize = 60;

/// Letters of a UID or number that a message repeats; neither may have more (DICOM PS3.5, table 6.2-1).
const MAX_UID: usize = 64;

/// Images that make one volume.
type Group = Vec<File>;

/// The images of the series that is asked for, or else of the one with the most: of these, the most that are alike. What is
/// left out is told in notes, with what chooses it.
///
/// # Errors
///
/// If there is no such series.
pub(super) fn choose(
    path: &Path,
    files: Vec<File>,
    wanted: Option<&str>,
    notes: &mut Vec<String>,
) -> Result<Group, SourceError> {
    let mut series: BTreeMap<String, BTreeMap<String, Group>> = BTreeMap::new();
    for (path, header) in files {
        let like = series.entry(header.series.clone()).or_default();
        like.entry(alike(&path, &header)).or_default().push((path, header));
    }
    let mut series: Vec<Vec<Group>> =
        series.into_values().map(|groups| groups.into_values().collect()).collect();
    for groups in &mut series {
        groups.sort_by_key(|group| std::cmp::Reverse(images(group)));
    }
    series.sort_by_key(|groups| std::cmp::Reverse(groups.first().map_or(0, images)));
    let mut with_number: HashMap<String, usize> = HashMap::new();
    for (_, header) in series.iter().filter_map(|groups| groups.first().and_then(|group| group.first())) {
        *with_number.entry(header.series_number.clone()).or_default() += 1;
    }
    let names: Vec<String> = series.iter().map(|groups| name(groups, &with_number)).collect();
    let chosen = match wanted {
        None => 0,
        Some(wanted) => series.iter().position(|groups| is_called(groups, wanted)).ok_or_else(|| {
            SourceError::Unsupported {
                path: path.to_owned(),
                found: format!("no series `{}`", wanted.chars().take(MAX_DESCRIPTION).collect::<String>()),
                mend: format!("there are {}", list(&names)),
            }
        })?,
    };
    if series.len() > 1 {
        let others: Vec<String> = names
            .iter()
            .enumerate()
            .filter(|(index, _)| *index != chosen)
            .map(|(_, name)| name.clone())
            .collect();
        let which = if wanted.is_none() { "only the largest is read" } else { "the one asked for is read" };
        notes.push(format!(
            "of {} series {which}, {}; left out are {}",
            series.len(),
            names[chosen],
            list(&others)
        ));
    }
    let mut groups = series.swap_remove(chosen).into_iter();
    let group = groups.next().unwrap_or_default();
    unlike(&group, groups.as_slice(), notes);
    Ok(group)
}

/// Tells what of the series itself is left out.
fn unlike(group: &Group, others: &[Group], notes: &mut Vec<String>) {
    let Some((_, first)) = group.first() else { return };
    if others.is_empty() {
        return;
    }
    let size = |group: &Group| {
        group.first().map_or(String::new(), |(path, header)| {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            format!("{} of {} x {} pixels ({name})", images(group), header.image.columns, header.image.rows)
        })
    };
    let sizes: Vec<String> = others.iter().map(size).collect();
    notes.push(format!(
        "of its series only what is alike is read, {} of {} x {} pixels; left out for their size, type, orientation or file are {}",
        images(group),
        first.image.columns,
        first.image.rows,
        list(&sizes)
    ));
}

/// What images of one volume have in common; a file of many frames is a volume by itself.
fn alike(path: &Path, header: &super::Header) -> String {
    let alone = if header.frames > 1 { path.display().to_string() } else { String::new() };
    let rounded = |axis: DVec3| (axis * 100.0).round().as_ivec3();
    let frame = header.frame(0);
    let orientation = frame.orientation.map(|axes| axes.map(rounded));
    let placed = (frame.position.is_some(), header.location.is_some() || frame.position.is_some());
    let image = &header.image;
    let pixels = (image.rows, image.columns, image.bits, image.signed, image.is_float, image.kind() as u8);
    format!("{pixels:?} {orientation:?} {placed:?} {alone}")
}

fn images(group: &Group) -> usize {
    group.iter().map(|(_, header)| header.frames).fold(0, usize::saturating_add)
}

/// `` `AX T1` of 16 (`series: "3"`) ``: by its number where no other series has it.
fn name(groups: &[Group], with_number: &HashMap<String, usize>) -> String {
    let Some((_, header)) = groups.first().and_then(|group| group.first()) else { return String::new() };
    let number = &header.series_number;
    let is_unique = !number.is_empty() && with_number.get(number) == Some(&1);
    let chooses = if is_unique { number } else { &header.series };
    let chooses: String = chooses.chars().take(MAX_UID).collect();
    let description: String =
        header.description.chars().filter(|letter| !letter.is_control()).take(MAX_DESCRIPTION).collect();
    let description = if description.is_empty() { "no name" } else { &description };
    let count: usize = groups.iter().map(images).sum();
    format!("`{description}` of {count} (`series: {chooses:?}`)")
}

/// Whether a series has this UID, number or description.
fn is_called(groups: &[Group], wanted: &str) -> bool {
    let wanted = wanted.trim();
    groups.first().and_then(|group| group.first()).is_some_and(|(_, header)| {
        header.series == wanted
            || header.series_number == wanted
            || !wanted.is_empty() && header.description.eq_ignore_ascii_case(wanted)
    })
}

fn list(names: &[String]) -> String {
    let more = names.len().saturating_sub(MAX_NAMED);
    let listed = names.iter().take(MAX_NAMED).cloned().collect::<Vec<String>>().join(", ");
    if more > 0 { format!("{listed} and {more} more") } else { listed }
}
