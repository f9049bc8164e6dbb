//! Some samples of many: one entry along an axis that is no space, all along the others.

use std::io::{self, BufRead, Read};

/// Which samples of a row are read.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Pick {
    /// What a sample must meet, the slowest axis first.
    rules: Vec<Rule>,
    /// Samples of the whole row in front of this part of it.
    from: u64,
}

/// One entry of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Rule {
    /// Samples from one entry to the next.
    stride: u64,
    /// How many entries there are.
    entries: u64,
    /// The one that is read.
    entry: u64,
}

impl Pick {
    /// Every sample.
    pub const ALL: Self = Self { rules: Vec::new(), from: 0 };

    /// Also only one entry of an axis that is faster than all that were chosen before. Its samples lie `stride` apart.
    pub fn and(mut self, stride: u64, entries: u64, entry: u64) -> Self {
        if entries > 1 {
            self.rules.push(Rule { stride: stride.max(1), entries, entry });
        }
        self
    }

    /// The same of a part of the row.
    pub fn part(&self, from: u64) -> Self {
        Self { rules: self.rules.clone(), from }
    }

    /// Whether no sample is left out.
    pub fn is_all(&self) -> bool {
        self.rules.is_empty()
    }

    /// How many of the first `samples` are read.
    pub fn count(&self, samples: u64) -> u64 {
        let to = kept(&self.rules, self.from.saturating_add(samples));
        to - kept(&self.rules, self.from)
    }

    /// Where the last sample ends if so many are read, in samples.
    pub fn end(&self, read: u64) -> u64 {
        match read.checked_sub(1) {
            None => 0,
            Some(last) => {
                let last = place(&self.rules, kept(&self.rules, self.from).saturating_add(last));
                last.saturating_add(1) - self.from
            }
        }
    }

    /// The next run of samples that are read, from `at` on: its beginning and how many there are.
    pub fn run(&self, at: u64) -> (u64, u64) {
        let mut to = self.from.saturating_add(at);
        let mut length = u64::MAX - to;
        for Rule { stride, entries, entry } in &self.rules {
            let (phase, into) = ((to / stride) % entries, to % stride);
            if phase == *entry {
                length = length.min(stride - into);
                continue;
            }
            let steps = if phase < *entry { entry - phase } else { entries - phase + entry };
            // At the beginning of an entry all faster axes are at theirs.
            to = to.saturating_add(steps.saturating_mul(*stride) - into);
            length = *stride;
        }
        (to - self.from, length)
    }
}

/// How many of the first `samples` meet the rules.
fn kept(rules: &[Rule], samples: u64) -> u64 {
    let Some((Rule { stride, entries, entry }, faster)) = rules.split_first() else { return samples };
    let period = stride.saturating_mul(*entries);
    let begun = (samples % period).saturating_sub(stride.saturating_mul(*entry)).min(*stride);
    (samples / period).saturating_mul(kept(faster, *stride)).saturating_add(kept(faster, begun))
}

/// Where the sample is that `before` others come before.
fn place(rules: &[Rule], before: u64) -> u64 {
    let Some((Rule { stride, entries, entry }, faster)) = rules.split_first() else { return before };
    let in_each = kept(faster, *stride).max(1);
    let entry = (before / in_each).saturating_mul(*entries).saturating_add(*entry);
    entry.saturating_mul(*stride).saturating_add(place(faster, before % in_each))
}

/// The bytes of the samples that are read, out of a reader of all.
pub(super) struct PickReader<'a, R> {
    reader: R,
    pick: &'a Pick,
    /// Bytes of a sample.
    bytes: u64,
    /// Bytes that were read or passed over.
    at: u64,
}

impl<'a, R: BufRead> PickReader<'a, R> {
    /// Reads on from `reader`, which has come to the byte `at`.
    pub fn new(reader: R, pick: &'a Pick, bytes: u64, at: u64) -> Self {
        Self { reader, pick, bytes, at }
    }
}

impl<R: BufRead> Read for PickReader<'_, R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        while filled < to.len() {
            let (start, length) = self.pick.run(self.at / self.bytes);
            let end = start.saturating_add(length).saturating_mul(self.bytes);
            let gap = start.saturating_mul(self.bytes).saturating_sub(self.at);
            let buffer = self.reader.fill_buf()?;
            if buffer.is_empty() {
                break;
            }
            let used = if gap > 0 {
                buffer.len().min(usize::try_from(gap).unwrap_or(usize::MAX))
            } else {
                let left = usize::try_from(end - self.at).unwrap_or(usize::MAX);
                let copied = buffer.len().min(left).min(to.len() - filled);
                to[filled..filled + copied].copy_from_slice(&buffer[..copied]);
                filled += copied;
                copied
            };
            self.reader.consume(used);
            self.at += used as u64;
        }
        Ok(filled)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    /// The samples that are read of a row of `all`, by asking each.
    fn one_by_one(rules: &[(u64, u64, u64)], all: u64) -> Vec<u64> {
        let is_read =
            |sample: &u64| rules.iter().all(|(stride, entries, entry)| (sample / stride) % entries == *entry);
        (0..all).filter(is_read).collect()
    }

    #[test]
    fn runs_counts_and_ends_agree_with_asking_each_sample() {
        let rules: [&[(u64, u64, u64)]; 6] = [
            &[],
            &[(1, 3, 1)],
            &[(12, 2, 1)],
            &[(4, 3, 0)],
            &[(12, 2, 1), (1, 3, 2)],
            &[(8, 3, 1), (2, 2, 1)],
        ];
        for rules in rules {
            let pick = rules.iter().fold(Pick::ALL, |pick, rule| pick.and(rule.0, rule.1, rule.2));
            let expected = one_by_one(rules, 96);
            for from in [0, 5, 24, 41] {
                let part = pick.part(from);
                let expected: Vec<u64> =
                    expected.iter().filter(|sample| **sample >= from).map(|sample| sample - from).collect();
                let (mut at, mut found) = (0, Vec::new());
                while at < 96 - from {
                    let (start, length) = part.run(at);
                    at = start.saturating_add(length).min(96 - from);
                    found.extend(start..at.max(start));
                }
                found.retain(|sample| *sample < 96 - from);
                assert_eq!(found, expected, "{rules:?} from {from}");
                assert_eq!(part.count(96 - from), expected.len() as u64);
                for (index, place) in expected.iter().enumerate() {
                    assert_eq!(part.end(index as u64 + 1), place + 1, "{rules:?} from {from}");
                }
                let bytes: Vec<u8> = (from as u8..96).flat_map(|sample| [sample, !sample]).collect();
                let mut read = Vec::new();
                let small = io::BufReader::with_capacity(7, &bytes[..]);
                PickReader::new(small, &part, 2, 0).read_to_end(&mut read).unwrap();
                let expected: Vec<u8> = expected
                    .iter()
                    .map(|sample| (sample + from) as u8)
                    .flat_map(|sample| [sample, !sample])
                    .collect();
                assert_eq!(read, expected, "{rules:?} from {from}");
            }
        }
    }
}
