//! Files of more than three axes, or of several numbers a voxel: which of them are read.

use std::path::Path;

use super::{
    Selection, SourceError, VolumeData,
    colour::{self, Channels},
    grid::Grid,
    pick::Pick,
    stored::{Scaling, Stored, StoredFormat},
};

/// More samples than any file holds.
const MAX_SAMPLES: u64 = 1 << 60;

/// What an axis of the samples is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Role {
    /// One of the three of space.
    Space,
    /// The numbers of a voxel, and what the file calls them.
    Components(String),
    /// Whole volumes, such as time points, and what the file calls them.
    Entries(String),
}

/// One axis of the samples of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Side {
    /// How many samples lie along it.
    pub samples: u64,
    /// What it is.
    pub role: Role,
}

impl Side {
    /// An axis of space.
    pub fn space(samples: u64) -> Self {
        Self { samples, role: Role::Space }
    }

    /// The numbers of a voxel.
    pub fn components(samples: u64, name: &str) -> Self {
        Self { samples, role: Role::Components(name.to_owned()) }
    }

    /// Whole volumes.
    pub fn entries(samples: u64, name: &str) -> Self {
        Self { samples, role: Role::Entries(name.to_owned()) }
    }
}

/// What of a file is read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Chosen {
    /// Which of its samples.
    pub pick: Pick,
    /// How many samples it has.
    pub all: u64,
    /// How they make colours, if they do.
    pub channels: Option<Channels>,
    /// What is read of several, for errors: `, entry 2 of 5`.
    part: String,
}

impl Chosen {
    /// How many samples of each voxel are read.
    pub fn per_voxel(&self) -> u64 {
        self.channels.map_or(1, |channels| channels.count)
    }

    /// Bytes of what is read of each voxel.
    pub fn bytes(&self, format: StoredFormat) -> u64 {
        self.per_voxel() * format.bytes()
    }

    /// `64 x 64 x 64 voxels of 2 bytes, entry 3 of 5`, for errors.
    pub fn what(&self, grid: &Grid, format: StoredFormat) -> String {
        format!("{}{}", grid.what(self.bytes(format)), self.part)
    }

    /// The volume of the samples that were read.
    pub fn volume(
        &self,
        grid: &Grid,
        path: &Path,
        stored: Stored,
        scaling: &Scaling,
        mut notes: Vec<String>,
    ) -> Result<VolumeData, SourceError> {
        match self.channels {
            Some(channels) => {
                let samples = colour::samples(path, &stored, channels, &mut notes)?;
                grid.volume_of(path, samples, notes)
            }
            None => grid.volume(path, stored, scaling, notes),
        }
    }
}

/// What is read of samples along these axes, the fastest first. All channels of a colour are, unless a component is asked for.
/// What there is besides is added to `notes`.
///
/// # Errors
///
/// If the file has no such entry or component.
pub(super) fn choose(
    path: &Path,
    sides: &[Side],
    selection: &Selection,
    is_colour: bool,
    notes: &mut Vec<String>,
) -> Result<Chosen, SourceError> {
    let (entries, entries_are) = several(sides, |role| match role {
        Role::Entries(name) => Some(name),
        _ => None,
    });
    let (components, components_are) = several(sides, |role| match role {
        Role::Components(name) => Some(name),
        _ => None,
    });
    let all = sides.iter().try_fold(1_u64, |all, side| all.checked_mul(side.samples));
    if all.is_none_or(|all| all > MAX_SAMPLES) {
        let sides: Vec<String> = sides.iter().map(|side| side.samples.to_string()).collect();
        return Err(SourceError::Field {
            path: path.to_owned(),
            field: "sizes".to_owned(),
            problem: format!(
                "{} samples are more than the limit of any file; correct the header",
                sides.join(" x ")
            ),
        });
    }
    let (index, component) = (u64::from(selection.index), selection.component.map(u64::from));
    let no_such = |what, asked, count| SourceError::NoSuchPart { path: path.to_owned(), what, asked, count };
    if index >= entries {
        return Err(no_such("index", index, entries));
    }
    if component.unwrap_or(0) >= components {
        return Err(no_such("component", component.unwrap_or(0), components));
    }
    let is_colour = is_colour && matches!(components, 3 | 4) && component.is_none();
    let mut part = String::new();
    if entries > 1 {
        part = format!(", entry {index} of {entries}");
        notes.push(format!(
            "it holds {entries} volumes ({entries_are}); number {index}, counted from 0, is read: `index` chooses"
        ));
    }
    if components > 1 && !is_colour {
        let component = component.unwrap_or(0);
        part = format!("{part}, number {component} of {components} at each");
        notes.push(format!(
            "each voxel has {components} numbers ({components_are}); number {component}, counted from 0, is read: `component` chooses"
        ));
    }
    let (mut stride, mut rules, mut channels) = (1_u64, Vec::new(), None);
    let (mut index, mut component, mut read) = (index, component.unwrap_or(0), 1_u64);
    for side in sides {
        match side.role {
            Role::Space => read = read.saturating_mul(side.samples),
            Role::Components(_) if is_colour => {
                if side.samples > 1 {
                    channels = Some(Channels { count: components, stride: read });
                }
                read = read.saturating_mul(side.samples);
            }
            Role::Components(_) => {
                rules.push((stride, side.samples, component % side.samples.max(1)));
                component /= side.samples.max(1);
            }
            Role::Entries(_) => {
                rules.push((stride, side.samples, index % side.samples.max(1)));
                index /= side.samples.max(1);
            }
        }
        stride = stride.saturating_mul(side.samples);
    }
    let pick = rules
        .into_iter()
        .rev()
        .fold(Pick::ALL, |pick, (stride, entries, entry)| pick.and(stride, entries, entry));
    Ok(Chosen { pick, all: stride, channels, part })
}

/// How many there are along the axes of a role, and what these are called.
fn several<'a>(sides: &'a [Side], name: impl Fn(&'a Role) -> Option<&'a String>) -> (u64, String) {
    let of = sides.iter().filter_map(|side| Some((side.samples, name(&side.role)?)));
    let many = of.clone().filter(|(samples, _)| *samples != 1);
    let names: Vec<&str> = many.map(|(_, name)| name.as_str()).collect();
    (of.map(|(samples, _)| samples).fold(1, u64::saturating_mul), names.join(", "))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn chosen(sides: &[Side], index: u32, component: Option<u32>, is_colour: bool) -> (Chosen, Vec<String>) {
        let (selection, mut notes) = (Selection { index, component, ..Selection::default() }, Vec::new());
        (choose(Path::new("a"), sides, &selection, is_colour, &mut notes).unwrap(), notes)
    }

    #[test]
    fn entries_and_components_are_chosen_wherever_their_axes_stand() {
        let time = |samples| Side::entries(samples, "time");
        let vector = Side::components(3, "vector");
        let first = [vector.clone(), Side::space(2), Side::space(2), time(5)];
        let (all, notes) = chosen(&first, 2, Some(1), false);
        assert_eq!((all.all, all.pick.run(0), all.pick.count(60)), (60, (25, 1), 4));
        assert_eq!(
            notes,
            [
                "it holds 5 volumes (time); number 2, counted from 0, is read: `index` chooses",
                "each voxel has 3 numbers (vector); number 1, counted from 0, is read: `component` chooses"
            ]
        );
        let last = [Side::space(2), Side::space(2), vector];
        assert_eq!(chosen(&last, 0, None, false).0.pick.run(0), (0, 4));
        assert_eq!(chosen(&last, 0, Some(2), false).0.pick.run(0), (8, 4));
        // Entries are counted over all axes that have any.
        let (two, notes) = chosen(&[Side::space(4), time(2), time(3)], 3, None, false);
        assert_eq!((two.pick.run(0), notes.len()), ((12, 4), 1));
        let (plain, notes) = chosen(&[Side::space(4), time(1)], 0, Some(0), false);
        assert_eq!((plain.pick, notes.len()), (Pick::ALL, 0));
    }

    #[test]
    fn colours_are_read_whole_unless_a_component_is_asked_for() {
        let sides = [Side::space(4), Side::components(3, "RGB-color"), Side::entries(2, "list")];
        let (colour, notes) = chosen(&sides, 1, None, true);
        assert_eq!(colour.channels, Some(Channels { count: 3, stride: 4 }));
        assert_eq!((colour.pick.run(0), notes.len()), ((12, 12), 1));
        let (red, notes) = chosen(&sides, 1, Some(0), true);
        assert_eq!((red.channels, red.pick.run(0), notes.len()), (None, (12, 4), 2));
    }

    #[test]
    fn what_is_not_there_is_told_with_how_many_there_are() {
        let refused = |sides: &[Side], index, component| {
            let selection = Selection { index, component, ..Selection::default() };
            choose(Path::new("a"), sides, &selection, false, &mut Vec::new()).unwrap_err().to_string()
        };
        let sides = [Side::components(3, "vector"), Side::space(2), Side::entries(5, "time")];
        assert_eq!(refused(&sides, 5, None), "a: index is 5, but its 5 volumes are 0 to 4");
        assert_eq!(refused(&sides, 0, Some(3)), "a: component is 3, but the 3 numbers of a voxel are 0 to 2");
        let absurd = [Side::space(1 << 40), Side::entries(1 << 40, "time")];
        assert!(refused(&absurd, 0, None).contains("more than the limit"));
        assert_eq!(refused(&sides[1..2], 1, None), "a: index is 1, but it holds a single volume, 0");
        assert_eq!(
            refused(&sides[1..2], 0, Some(1)),
            "a: component is 1, but each voxel has a single number, 0"
        );
    }
}
