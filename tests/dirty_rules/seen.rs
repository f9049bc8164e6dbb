//! What is seen of a frame: the passes that ran for it, and the picture.

use std::collections::BTreeMap;
use std::fmt;
use tyndall::prelude::*;
use tyndall::render::{self, Pixels};
use tyndall::report::PassRecord;

/// What draws each frame anew.
const FRAME: [&str; 3] = ["surface", "raycast", "tonemap"];

/// The passes that ran, but for those that draw each frame anew.
pub struct Ran(pub BTreeMap<&'static str, PassRecord>);

impl Ran {
    /// Whether it was these passes, so often: `classify 1, light_volume 2`. Where it matters, on so much: `classify 1 of 64 entries`.
    pub fn is(&self, expected: &str) -> bool {
        let mut expected: BTreeMap<&str, &str> =
            expected.split(", ").filter_map(|pass| pass.split_once(' ')).collect();
        let holds = |(pass, record): (&&str, &PassRecord)| {
            let Some(expected) = expected.remove(*pass) else { return false };
            let (runs, work) = expected.split_once(" of ").unwrap_or((expected, ""));
            let amount = |unit: &str| record.work.get(unit).map(u64::to_string);
            let is_on =
                work.split_once(' ').is_none_or(|(count, unit)| amount(unit).as_deref() == Some(count));
            runs == record.runs.to_string() && is_on
        };
        self.passes().all(holds) && expected.is_empty()
    }

    fn passes(&self) -> impl Iterator<Item = (&&'static str, &PassRecord)> {
        self.0.iter().filter(|(pass, _)| !FRAME.contains(*pass))
    }
}

impl fmt::Display for Ran {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pass = |(pass, record): (&&str, &PassRecord)| {
            let work = record.work.iter().map(|(unit, amount)| format!("{amount} {unit}"));
            let work = work.collect::<Vec<_>>().join(" + ");
            format!("{pass} {} of {work}", record.runs)
        };
        write!(f, "{}", self.passes().map(pass).collect::<Vec<_>>().join(", "))
    }
}

/// A picture, as radiance and as a screen shows it.
#[derive(PartialEq)]
pub struct Shown {
    radiance: Vec<[f32; 3]>,
    encoded: Vec<[u8; 3]>,
}

impl Shown {
    pub fn of(app: &mut App) -> Self {
        let mut draw = |encoded| {
            app.world_mut().resource_mut::<Picture>().encoded = encoded;
            render::render(app).unwrap().pixels
        };
        match (draw(false), draw(true)) {
            (Pixels::Radiance(radiance), Pixels::Encoded(encoded)) => Self { radiance, encoded },
            other => panic!("{other:?}"),
        }
    }

    /// The greatest difference of radiance.
    pub fn difference(&self, other: &Self) -> f32 {
        let pairs = self.radiance.iter().flatten().zip(other.radiance.iter().flatten());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    }
}
