//! What was done for a frame: the passes that ran, on how much, for how long, and the bytes held.

use bevy_ecs::prelude::Resource;
use serde::Serialize;
use std::collections::BTreeMap;

/// The report of what has been done since the program started, or since it was last taken.
#[derive(Resource, Clone, Debug, Default, Serialize)]
pub struct Report {
    /// Passes by name. A pass that no entity needs does not appear.
    pub passes: BTreeMap<&'static str, PassRecord>,
    /// Pipelines that were made, in order.
    pub pipelines: Vec<&'static str>,
    /// Bytes held on the GPU, by what holds them.
    pub gpu_bytes: BTreeMap<&'static str, u64>,
    /// Lights that share a product where the [`LightBudget`](crate::LightBudget) does not go round, by the pass that would keep one for each.
    pub sharing_lights: BTreeMap<&'static str, u64>,
    /// Wall-clock milliseconds of the parts of the program, in order.
    pub timeline: Vec<(&'static str, f64)>,
    /// Whether to measure what costs time to measure: GPU times and samples taken.
    #[serde(skip)]
    pub measure: bool,
}

/// What one pass did.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PassRecord {
    /// How often it ran.
    pub runs: u64,
    /// What it worked on, by unit: texels, voxels, triangles, samples.
    pub work: BTreeMap<&'static str, u64>,
    /// Milliseconds, by the GPU's clock for draws where it has one, else by the wall clock; none where not measured.
    pub milliseconds: Option<f64>,
}

impl Report {
    /// Notes that a pass ran and what it worked on.
    pub fn ran(&mut self, pass: &'static str, work: &[(&'static str, u64)]) {
        let record = self.passes.entry(pass).or_default();
        record.runs += 1;
        for (unit, amount) in work {
            *record.work.entry(unit).or_default() += amount;
        }
    }

    /// Notes how many bytes something holds on the GPU; what holds none is not listed.
    pub fn hold(&mut self, what: &'static str, bytes: u64) {
        if bytes == 0 {
            self.gpu_bytes.remove(what);
        } else {
            self.gpu_bytes.insert(what, bytes);
        }
    }

    /// Notes how many lights share a product of a pass; none are not listed.
    pub fn share(&mut self, pass: &'static str, lights: usize) {
        if lights == 0 {
            self.sharing_lights.remove(pass);
        } else {
            self.sharing_lights.insert(pass, lights as u64);
        }
    }

    /// Adds time to a pass.
    pub fn took(&mut self, pass: &'static str, milliseconds: f64) {
        *self.passes.entry(pass).or_default().milliseconds.get_or_insert(0.0) += milliseconds;
    }

    /// Adds a part of the program's running to the timeline.
    pub fn spent(&mut self, part: &'static str, since: std::time::Instant) {
        self.timeline.push((part, since.elapsed().as_secs_f64() * 1e3));
    }
}
