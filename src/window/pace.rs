//! How coarse a picture must be to follow a hand.

use glam::UVec2;
use std::time::Duration;

/// Chooses how coarsely to draw while something moves, by how long the pictures before took.
#[derive(Clone, Debug)]
pub struct Pace {
    level: usize,
    /// Pictures in a row that would have been fast enough one level finer.
    leisurely: u32,
    /// How many of them there must be.
    patience: u32,
}

/// From fine to coarse: the share of the pixels along each side, and the factor on the steps of rays.
const LEVELS: [(f64, f32); 8] =
    [(1.0, 1.0), (0.75, 1.5), (0.5, 1.5), (0.5, 2.5), (0.35, 2.5), (0.25, 3.0), (0.2, 4.0), (0.15, 4.0)];

/// What a picture may take, so that with everything around it there are more than ten a second.
const BUDGET: Duration = Duration::from_millis(70);

/// Pictures in a row that must be fast before finer ones are tried; each time that these turn out too slow, more are asked for, so that the
/// quality does not flicker.
const PATIENCE: u32 = 4;
const MOST_PATIENCE: u32 = 256;

/// Where adapters that are programs begin.
const SOFTWARE: usize = 5;

impl Pace {
    /// A pace to begin with, for adapters that are programs and for others.
    pub fn new(is_software: bool) -> Self {
        Self { level: if is_software { SOFTWARE } else { 0 }, leisurely: 0, patience: PATIENCE }
    }

    /// Whether pictures are drawn in full even while something moves.
    pub fn is_full(&self) -> bool {
        self.level == 0
    }

    /// Pixels of a picture that is `full` large when nothing moves.
    pub fn size(&self, full: UVec2) -> UVec2 {
        (full.as_dvec2() * LEVELS[self.level].0).round().as_uvec2().max(UVec2::ONE)
    }

    /// Factor on the steps of rays.
    pub fn step(&self) -> f32 {
        LEVELS[self.level].1
    }

    /// Learns from a picture drawn in full.
    pub fn full_took(&mut self, time: Duration) {
        let fits = |level: &usize| time.mul_f64(cost(*level)) <= BUDGET;
        let level = (0..LEVELS.len()).find(fits).unwrap_or(LEVELS.len() - 1);
        // What was learnt while moving counts for more, as long as it is not far off.
        if level.abs_diff(self.level) > 1 {
            *self = Self { level, leisurely: 0, patience: PATIENCE };
        }
    }

    /// Learns from a picture drawn at this pace.
    pub fn took(&mut self, time: Duration) {
        let coarser = (self.level + 1..LEVELS.len())
            .find(|level| time.mul_f64(cost(*level) / cost(self.level)) <= BUDGET)
            .unwrap_or(LEVELS.len() - 1);
        if time > BUDGET {
            self.level = coarser;
            self.leisurely = 0;
            self.patience = (4 * self.patience).min(MOST_PATIENCE);
            return;
        }
        let Some(finer) = self.level.checked_sub(1) else { return };
        let would_take = time.mul_f64(cost(finer) / cost(self.level));
        self.leisurely = if would_take < BUDGET.mul_f64(0.8) { self.leisurely + 1 } else { 0 };
        if self.leisurely >= self.patience {
            self.level = finer;
            self.leisurely = 0;
        }
    }
}

/// What a level costs compared with a picture drawn in full; some of it does not depend on pixels.
fn cost(level: usize) -> f64 {
    let (scale, step) = LEVELS[level];
    0.02 + 0.98 * scale * scale / f64::from(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a picture takes on a machine where a full one takes `full` seconds, of which `fixed` do not depend on pixels.
    fn picture(pace: &Pace, full: f64, fixed: f64) -> Duration {
        let size = pace.size(UVec2::new(1000, 1000)).as_dvec2() / 1000.0;
        Duration::from_secs_f64(fixed + (full - fixed) * size.x * size.y / f64::from(pace.step()))
    }

    #[test]
    fn a_fast_machine_draws_in_full() {
        let mut pace = Pace::new(false);
        for _ in 0..50 {
            pace.took(Duration::from_millis(5));
            pace.full_took(Duration::from_millis(5));
        }
        assert_eq!((pace.size(UVec2::new(960, 540)), pace.step()), (UVec2::new(960, 540), 1.0));
    }

    #[test]
    fn any_machine_gets_there_within_a_few_pictures_and_stays() {
        for full in [0.05f64, 0.2, 0.7, 1.5, 2.5] {
            for fixed in [0.0f64, 0.03, 0.05] {
                let mut pace = Pace::new(false);
                pace.full_took(Duration::from_secs_f64(full));
                let mut levels = Vec::new();
                for turn in 0..200 {
                    let time = picture(&pace, full, fixed.min(full));
                    pace.took(time);
                    if turn > 6 {
                        assert!(time <= BUDGET.mul_f64(1.3), "{full} {fixed}: {time:?} at {}", pace.level);
                        levels.push(pace.level);
                    }
                }
                levels.dedup();
                assert!(levels.len() < 8, "{full} {fixed}: flickers between {levels:?}");
            }
        }
    }

    #[test]
    fn pictures_are_never_empty() {
        let mut pace = Pace::new(false);
        pace.took(Duration::from_secs(100));
        assert_eq!(pace.size(UVec2::ONE), UVec2::ONE);
        assert_eq!(pace.size(UVec2::new(1, 4000)).x, 1);
    }

    #[test]
    fn levels_get_cheaper() {
        assert!((1..LEVELS.len()).all(|level| cost(level) < cost(level - 1)));
    }
}
