//! The segments that 3D Slicer describes in an NRRD file of labels (.seg.nrrd).

use std::collections::BTreeMap;

use crate::sources::{
    text::numbers,
    volume::{Label, Labels},
};

/// The most segments that are kept.
const MAX_SEGMENTS: usize = 1 << 16;

/// What is written of one segment.
#[derive(Debug, Default)]
struct Segment {
    value: Option<f32>,
    layer: Option<u32>,
    name: String,
    colour: Option<[f32; 4]>,
}

/// What lines `Segment0_Name:=bone` say.
#[derive(Debug, Default)]
pub(super) struct Segments(BTreeMap<u32, Segment>);

impl Segments {
    /// Takes in a key and its value, if they are of a segment.
    pub fn line(&mut self, key: &str, value: &str) {
        let Some((number, field)) = key.trim().strip_prefix("Segment").and_then(|rest| rest.split_once('_'))
        else {
            return;
        };
        let Ok(number) = number.parse() else { return };
        if self.0.len() >= MAX_SEGMENTS && !self.0.contains_key(&number) {
            return;
        }
        let (segment, value) = (self.0.entry(number).or_default(), value.trim());
        match field {
            "LabelValue" => segment.value = value.parse().ok(),
            "Layer" => segment.layer = value.parse().ok(),
            "Name" => value.clone_into(&mut segment.name),
            "Color" => {
                let colour = numbers::<f32>(value).and_then(|numbers| <[f32; 3]>::try_from(numbers).ok());
                segment.colour = colour.map(|[red, green, blue]| [red, green, blue, 1.0]);
            }
            _ => {}
        }
    }

    /// The labels of a layer; `None` where the file describes no segment. Files from before layers have one a segment, of 1.
    pub fn labels(&self, layer: u32) -> Option<Labels> {
        if self.0.is_empty() {
            return None;
        }
        let are_layers = self.0.values().all(|segment| segment.value.is_none());
        let layer_of =
            |number: u32, segment: &Segment| segment.layer.unwrap_or(if are_layers { number } else { 0 });
        let entries = self.0.iter().filter(|(number, segment)| layer_of(**number, segment) == layer);
        let label = |(_, segment): (&u32, &Segment)| Label {
            value: segment.value.unwrap_or(1.0),
            name: segment.name.clone(),
            colour: segment.colour,
        };
        Some(Labels { entries: entries.map(label).collect() })
    }
}
