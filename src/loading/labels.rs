//! What a volume looks like whose values are labels.

use super::LoadedVolume;
use crate::components::{Interpolation, LabelColour, TransferFunction, Volume};
use crate::optics::labels::{linear_of_srgb, palette};
use crate::sources::{Label, VolumeData};
use glam::Vec3;
use std::collections::{BTreeMap, HashMap};
use std::ops::RangeInclusive;

impl LoadedVolume {
    /// The labels that are to be told apart where a function says nothing of them; 0 is nothing.
    pub(super) fn default_labels(&self, function: &TransferFunction) -> Option<RangeInclusive<i32>> {
        if !function.leaves_labels_alone() || !self.data.is_label_map() {
            return None;
        }
        let (low, high) = self.data.range;
        let least = match low.ceil().max(LabelColour::LEAST as f32) as i32 {
            0 => 1,
            least => least,
        };
        let greatest = match high.min(LabelColour::GREATEST as f32) as i32 {
            0 => -1,
            greatest => greatest,
        };
        (least <= greatest).then_some(least..=greatest)
    }

    /// What labels look like: as the file says, or by a palette.
    pub(super) fn colours_of(&self, values: RangeInclusive<i32>) -> Vec<LabelColour> {
        let known = self.data.labels.iter().flat_map(|labels| &labels.entries);
        let known: HashMap<i32, &Label> = known.map(|label| (label.value as i32, label)).collect();
        let colour = |value: i32| {
            let label = known.get(&value);
            let (color, opacity) = match label.and_then(|label| label.colour) {
                Some([red, green, blue, opacity]) => (linear_of_srgb(Vec3::new(red, green, blue)), opacity),
                None => (palette(value), 1.0),
            };
            let name = label.map(|label| label.name.clone()).unwrap_or_default();
            LabelColour { value, color, opacity, name }
        };
        values.filter(|value| *value != 0).map(colour).collect()
    }

    /// Whether what lies between samples is the nearest of them, with the function in force.
    pub(crate) fn is_nearest(&self, volume: &Volume, function: &TransferFunction) -> bool {
        let is_labelled = !function.labels.is_empty();
        match volume.interpolation() {
            Interpolation::Nearest => true,
            Interpolation::Linear => is_labelled,
            Interpolation::Auto => is_labelled || self.data.is_label_map(),
        }
    }

    /// The labels that occur and have a colour where no function says one, and how many voxels each has; none unless it is a label map whose
    /// samples are still here.
    pub fn label_counts(&self) -> Vec<(LabelColour, u64)> {
        let Some(values) = self.default_labels(&TransferFunction::default()) else { return Vec::new() };
        let Some(samples) = &self.samples else { return Vec::new() };
        let mut counts: BTreeMap<i32, u64> = BTreeMap::new();
        for value in (0..samples.len()).filter_map(|index| samples.get(index)) {
            // What has no fraction and is small is itself as an integer.
            if value.fract() == 0.0 && values.contains(&(value as i32)) {
                *counts.entry(value as i32).or_default() += 1;
            }
        }
        let counted = |label: LabelColour| counts.get(&label.value).map(|count| (label, *count));
        self.colours_of(values).into_iter().filter_map(counted).collect()
    }
}

/// What a person should know about how labels were made out.
pub(super) fn notes(volume: &Volume, data: &VolumeData) -> Vec<String> {
    let mut notes = Vec::new();
    if data.labels.is_none() && data.looks_labelled && volume.interpolation() == Interpolation::Auto {
        let (low, high) = data.range;
        notes.push(format!(
            "its values, whole numbers from {low} to {high} in even pieces, are taken for labels; each voxel shows its own (`interpolation: Linear` mixes \
             neighbours)"
        ));
    }
    if data.is_label_map() && data.range.1 > LabelColour::GREATEST as f32 {
        notes.push(format!(
            "labels above {} have no colours of their own and are clear",
            LabelColour::GREATEST
        ));
    }
    notes
}
