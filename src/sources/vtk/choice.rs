//! Which array of several is read.

use std::path::Path;

use crate::sources::{Selection, SourceError};

/// Arrays that a note names.
const MAX_NAMED: usize = 8;

/// What is known of an array before it is read.
pub(in crate::sources) trait Described {
    /// What the file calls it.
    fn name(&self) -> &str;
    /// How many numbers each point has.
    fn components(&self) -> u64;
    /// Whether these are the channels of a colour.
    fn is_colour(&self) -> bool;
}

/// The array that is read, and what is left to choose in it. The first of one number a point is 0, else the first colours, else the
/// first; the others are counted behind it. If only a component is chosen, it is that of the first array of several numbers.
///
/// # Errors
///
/// If there are not so many arrays.
pub(in crate::sources) fn choose(
    path: &Path,
    arrays: &[impl Described],
    selection: &Selection,
    notes: &mut Vec<String>,
) -> Result<(usize, Selection), SourceError> {
    let first = |is_meant: &dyn Fn(usize) -> bool| (0..arrays.len()).find(|index| is_meant(*index));
    let by_default = first(&|index| arrays[index].components() == 1)
        .or_else(|| first(&|index| arrays[index].is_colour()))
        .unwrap_or(0);
    let mut order: Vec<usize> = (0..arrays.len()).filter(|index| *index != by_default).collect();
    order.insert(0, by_default);
    let asked = u64::from(selection.index);
    let mut chosen = *usize::try_from(asked)
        .ok()
        .and_then(|asked| order.get(asked))
        .filter(|_| !arrays.is_empty())
        .ok_or_else(|| SourceError::NoSuchPart {
            path: path.to_owned(),
            what: "index",
            asked,
            count: arrays.len() as u64,
        })?;
    if asked == 0 && selection.component.is_some() {
        chosen = first(&|index| arrays[index].components() > 1).unwrap_or(chosen);
    }
    if arrays.len() > 1 {
        let others = order.iter().enumerate().filter(|(_, index)| **index != chosen);
        let mut named: Vec<String> = others
            .take(MAX_NAMED)
            .map(|(number, index)| format!("`{}` is {number}", shown(arrays[*index].name())))
            .collect();
        if arrays.len() > MAX_NAMED + 1 {
            named.push("…".to_owned());
        }
        notes.push(format!(
            "of its {} arrays `{}` is read; `index` chooses another: {}",
            arrays.len(),
            shown(arrays[chosen].name()),
            named.join(", ")
        ));
    }
    Ok((chosen, Selection { index: 0, ..selection.clone() }))
}

/// A name without what cannot be shown, at most 40 characters long.
fn shown(name: &str) -> String {
    name.chars().filter(|letter| !letter.is_control()).take(40).collect()
}
