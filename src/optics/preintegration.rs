//! What a segment of a ray shows along which the value changes evenly: pre-integrated transfer functions, with self-attenuation.
//!
//! For each pair of entries (i, j) of a table, value going from i to j over a length d, with u from 0 to 1 along the segment,
//!
//! ```text
//! depth    = d ∫ sigma_t(s(u)) du
//! radiance = d ∫ c(s(u)) sigma_t(s(u)) exp(-depth up to u) du
//! ```
//!
//! where colour c and extinction sigma_t are linear between entries (Engel, Kraus and Ertl 2001, eqs. 3 and 4; they leave the exponential out
//! of their fast variant, which is not done here). All pairs that are k entries apart cross every cell between two entries over the same length
//! d / k. So for each k the cells are integrated once, and the segments are all windows of k cells: put together from the suffix of
//! one block of k cells and the prefix of the next (van Herk 1992), two compositions a pair. That is O(n^2) for all pairs, and nothing is
//! subtracted, so the thinnest segment keeps its digits beside the thickest.

use super::quadrature::gauss_legendre;
use super::transfer::{Layer, LookupTable};
use glam::{DVec3, Vec4};
use std::ops::RangeInclusive;

/// The greatest depth that is kept: nothing comes through it.
const MAX_DEPTH: f64 = 1e9;

/// Where light no longer comes from: exp(-40) is below what 32 bits hold beside 1.
const DEEP: f64 = 40.0;

/// Mean colour and optical depth of segments, by the values at their ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Preintegration {
    /// Entries of the table that it was made from.
    pub side: usize,
    /// Length of the segments, scene units.
    pub length: f64,
    /// Row by row, the value at the back; within a row, the value at the front: colour times depth, and depth. The colour is radiance over
    /// opacity. To be interpolated linearly, in cells on the diagonal within each of their two triangles: layers are exact then.
    pub pairs: Vec<Vec4>,
}

impl Preintegration {
    /// All pairs of entries of `table`, for segments of `length` scene units.
    pub fn new(table: &LookupTable, length: f64) -> Self {
        let side = table.entries.len();
        let mut made = Self { side, length, pairs: vec![Vec4::ZERO; side * side] };
        made.fill(table, 0..=side - 1);
        made
    }

    /// Makes again what depends on how `now` differs from `before`, of which this was made. Returns how many pairs that were.
    pub fn update(&mut self, before: &LookupTable, now: &LookupTable) -> usize {
        if before.entries.len() != self.side || now.entries.len() != self.side {
            *self = Self::new(now, self.length);
            return self.pairs.len();
        }
        match changed(before, now) {
            Some(stretch) => self.fill(now, stretch),
            None => 0,
        }
    }

    /// Makes the pairs that have an entry of `stretch` between them, or are one. Returns how many.
    fn fill(&mut self, table: &LookupTable, stretch: RangeInclusive<usize>) -> usize {
        let side = self.side;
        for entry in stretch.clone() {
            let [r, g, b, extinction] = table.entries[entry].as_dvec4().to_array();
            self.pairs[entry * side + entry] = stored(DVec3::new(r, g, b), extinction * self.length);
        }
        let mut count = stretch.end() - stretch.start() + 1;
        let medium = Medium::new(table, self.length);
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(side / 64 + 1);
        // Distances in turn, so that each thread has short and long ones.
        let part = |thread: usize| -> Vec<Diagonal> {
            (1 + thread..side).step_by(threads).map(|distance| medium.diagonal(distance, &stretch)).collect()
        };
        let parts: Vec<Vec<Diagonal>> = std::thread::scope(|scope| {
            let part = &part;
            let running: Vec<_> = (0..threads).map(|thread| scope.spawn(move || part(thread))).collect();
            running.into_iter().map(|thread| thread.join().unwrap_or_default()).collect()
        });
        for Diagonal { distance, first, segments } in parts.into_iter().flatten() {
            count += 2 * segments.len();
            for (low, [up, down]) in (first..).zip(segments) {
                self.pairs[(low + distance) * side + low] = up;
                self.pairs[low * side + low + distance] = down;
            }
        }
        count
    }
}

/// The entries by which two tables of equal length differ, those on both sides of a layer included.
fn changed(before: &LookupTable, now: &LookupTable) -> Option<RangeInclusive<usize>> {
    let entries = before.entries.iter().zip(&now.entries).enumerate();
    let entries = entries.filter(|(_, (before, now))| before != now).map(|(entry, _)| entry);
    let only = |these: &[Layer], those: &[Layer]| -> Vec<usize> {
        let alone = these.iter().filter(|layer| !those.contains(layer));
        alone.flat_map(|layer| [layer.cell, layer.cell + 1]).collect()
    };
    let layers = [only(&before.layers, &now.layers), only(&now.layers, &before.layers)].concat();
    let all: Vec<usize> = entries.chain(layers).collect();
    Some(*all.iter().min()?..=*all.iter().max()?)
}

/// Mean colour and depth as they are kept.
fn stored(colour: DVec3, depth: f64) -> Vec4 {
    let depth = depth.min(MAX_DEPTH);
    (colour * depth).extend(depth).as_vec4()
}

/// The segments of all pairs that are `distance` entries apart and touch a stretch, by their lower entry from `first`: with the lower
/// value in front, and the higher.
struct Diagonal {
    distance: usize,
    first: usize,
    segments: Vec<[Vec4; 2]>,
}

/// A piece of a ray.
#[derive(Clone, Copy)]
struct Piece {
    radiance: DVec3,
    transmittance: f64,
    depth: f64,
}

impl Piece {
    const NONE: Self = Self { radiance: DVec3::ZERO, transmittance: 1.0, depth: 0.0 };

    /// This in front of another.
    fn over(&self, behind: &Self) -> Self {
        Self {
            radiance: self.radiance + self.transmittance * behind.radiance,
            transmittance: self.transmittance * behind.transmittance,
            depth: self.depth + behind.depth,
        }
    }

    fn stored(&self) -> Vec4 {
        if self.depth > 0.0 {
            stored(self.radiance / -(-self.depth).exp_m1(), self.depth)
        } else {
            Vec4::ZERO
        }
    }
}

/// What a segment goes through: the cells of a table, `[low, high]` entries each, and the layers in them.
struct Medium<'a> {
    table: &'a LookupTable,
    length: f64,
    /// Nodes and weights for cells of a depth up to some, in rising order.
    rules: [(f64, Vec<(f64, f64)>); 3],
}

impl<'a> Medium<'a> {
    fn new(table: &'a LookupTable, length: f64) -> Self {
        let rule = |depth, nodes| (depth, gauss_legendre(nodes, 0.0, 1.0));
        Self { table, length, rules: [rule(1.0, 5), rule(8.0, 12), rule(f64::MAX, 26)] }
    }

    /// All segments of one distance that have an entry of `stretch` in them.
    fn diagonal(&self, distance: usize, stretch: &RangeInclusive<usize>) -> Diagonal {
        let side = self.table.entries.len();
        let first = stretch.start().saturating_sub(distance);
        let last = (side - 1 - distance).min(*stretch.end());
        let mut segments = Vec::new();
        if first > last {
            return Diagonal { distance, first, segments };
        }
        let cells: Vec<[Piece; 2]> =
            (first..last + distance).map(|cell| self.cell(cell, self.length / distance as f64)).collect();
        segments.reserve(last - first + 1);
        let mut suffixes = vec![[Piece::NONE; 2]; distance];
        for block in first / distance..=last / distance {
            let (begin, end) = (block * distance, (block + 1) * distance);
            let (from, to) = (begin.max(first), (end - 1).min(last));
            let mut suffix = [Piece::NONE; 2];
            for cell in (from..end).rev() {
                let [up, down] = &cells[cell - first];
                suffix = [up.over(&suffix[0]), suffix[1].over(down)];
                suffixes[cell - begin] = suffix;
            }
            let mut prefix = [Piece::NONE; 2];
            // Where the first window begins within the block, its prefix is longer than one cell.
            for cell in end..(from + distance).max(end) {
                let [up, down] = &cells[cell - first];
                prefix = [prefix[0].over(up), down.over(&prefix[1])];
            }
            for low in from..=to {
                let suffix = &suffixes[low - begin];
                segments.push([suffix[0].over(&prefix[0]).stored(), prefix[1].over(&suffix[1]).stored()]);
                if low < to {
                    let [up, down] = &cells[low + distance - first];
                    prefix = [prefix[0].over(up), down.over(&prefix[1])];
                }
            }
        }
        Diagonal { distance, first, segments }
    }

    /// One cell, crossed over some length, from its lower entry and from its upper.
    fn cell(&self, cell: usize, length: f64) -> [Piece; 2] {
        let [low, high] = [self.table.entries[cell], self.table.entries[cell + 1]].map(Vec4::as_dvec4);
        let mut pieces = [Piece::NONE; 2];
        let mut add = |up: Piece, down: Piece| {
            pieces = [pieces[0].over(&up), down.over(&pieces[1])];
        };
        let mut from = 0.0;
        let here = self.table.layers.partition_point(|layer| layer.cell < cell);
        for layer in self.table.layers[here..].iter().take_while(|layer| layer.cell == cell) {
            let to = layer.position - cell as f64;
            let [start, end] = [from, to].map(|part| low.lerp(high, part));
            add(
                self.stretch(start, end, (to - from) * length),
                self.stretch(end, start, (to - from) * length),
            );
            let depth = f64::from(layer.depth);
            let radiance = layer.colour.as_dvec3() * -(-depth).exp_m1();
            let surface = Piece { radiance, transmittance: (-depth).exp(), depth };
            add(surface, surface);
            from = to;
        }
        let start = low.lerp(high, from);
        add(
            self.stretch(start, high, (1.0 - from) * length),
            self.stretch(high, start, (1.0 - from) * length),
        );
        pieces
    }

    /// A stretch over which colour and extinction change linearly.
    fn stretch(&self, front: glam::DVec4, back: glam::DVec4, length: f64) -> Piece {
        let (start, rise) = (front.w * length, (back.w - front.w) * length);
        let depth = start + 0.5 * rise;
        if depth <= 0.0 {
            return Piece::NONE;
        }
        // The light is the integral of colour sigma exp(-depth so far): with a colour linear in t, that of 1 and that of t under the weight
        // sigma exp(-depth so far).
        let whole = -(-depth).exp_m1();
        let moment = if depth < 0.01 { thin_moment(start, rise) } else { self.moment(start, rise, depth) };
        let (from, to) = (front.truncate(), back.truncate());
        let radiance = from * (whole - moment).max(0.0) + to * moment;
        Piece { radiance, transmittance: 1.0 - whole, depth }
    }

    /// The integral of t a(t) exp(-A(t)) for t from 0 to 1, with a = start + rise t and A its integral.
    fn moment(&self, start: f64, rise: f64, depth: f64) -> f64 {
        // Up to where light comes from: start t + rise t^2 / 2 = DEEP.
        let reach = if depth > DEEP {
            2.0 * DEEP / (start + (start * start + 2.0 * rise * DEEP).max(0.0).sqrt())
        } else {
            1.0
        };
        let rule = self.rules.iter().find(|(most, _)| depth <= *most).unwrap_or(&self.rules[2]);
        let value = |t: f64| t * (start + rise * t) * (-t * (start + 0.5 * rise * t)).exp();
        reach * rule.1.iter().map(|(node, weight)| weight * value(reach * node)).sum::<f64>()
    }
}

/// The same by its series in the depth, of which the next term is below 10^-6 of the sum.
fn thin_moment(start: f64, rise: f64) -> f64 {
    let (a, b) = (start, rise);
    let first = a / 2.0 + b / 3.0;
    let second = a * a / 3.0 + 0.375 * a * b + b * b / 10.0;
    let third = a * a * a / 4.0 + 0.4 * a * a * b + 5.0 / 24.0 * a * b * b + b * b * b / 28.0;
    first - second + 0.5 * third
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A table of bumps, jumps, clear stretches and layers.
    fn table(side: usize) -> LookupTable {
        let entry = |index: usize| {
            let at = index as f32 / (side - 1) as f32;
            let wave = (at * 37.0).sin().max(0.0) * 40.0;
            let jump = if (0.55..0.6).contains(&at) { 3000.0 } else { 0.0 };
            let faint = if at > 0.9 { 1e-6 } else { 0.0 };
            Vec4::new(at, 1.0 - at, (at * 11.0).cos().abs(), if at < 0.5 { wave } else { jump + faint })
        };
        let layer = |place: f64, colour, depth| {
            let position = place * (side - 1) as f64;
            Layer { position, cell: position as usize, colour, depth }
        };
        LookupTable {
            entries: (0..side).map(entry).collect(),
            layers: vec![
                layer(0.1003, Vec3::X, 0.5),
                layer(0.1004, Vec3::Y, 2.0),
                layer(0.8, Vec3::ONE, 1e-6),
            ],
            is_exact: false,
        }
    }

    /// The segment in tiny steps of equal depth at most, each with the exact exponential; layers where they are.
    fn by_steps(table: &LookupTable, length: f64, front: usize, back: usize) -> (DVec3, f64) {
        let (low, high) = (front.min(back), front.max(back));
        let up = front <= back;
        let (mut radiance, mut depth) = (DVec3::ZERO, 0.0f64);
        let mut emit = |colour: DVec3, thick: f64| {
            radiance += colour * (-depth).exp() * -(-thick).exp_m1();
            depth += thick;
        };
        let stretch = |cell: usize, from: f64, to: f64, emit: &mut dyn FnMut(DVec3, f64)| {
            let steps = 4000;
            for step in 0..steps {
                let t = from + (to - from) * (step as f64 + 0.5) / steps as f64;
                let at = table.entries[cell].as_dvec4().lerp(table.entries[cell + 1].as_dvec4(), t);
                emit(at.truncate(), at.w * length / (high - low) as f64 * (to - from).abs() / steps as f64);
            }
        };
        let mut cells: Vec<usize> = (low..high).collect();
        if !up {
            cells.reverse();
        }
        for cell in cells {
            let mut stops: Vec<(f64, Option<&Layer>)> = table
                .layers
                .iter()
                .filter(|layer| layer.cell == cell)
                .map(|layer| (layer.position - cell as f64, Some(layer)))
                .collect();
            if !up {
                stops.reverse();
            }
            let (mut from, end) = if up { (0.0, 1.0) } else { (1.0, 0.0) };
            stops.push((end, None));
            for (to, layer) in stops {
                stretch(cell, from, to, &mut emit);
                if let Some(layer) = layer {
                    emit(layer.colour.as_dvec3(), f64::from(layer.depth));
                }
                from = to;
            }
        }
        (radiance, depth)
    }

    #[test]
    fn pairs_are_those_of_quadrature() {
        let (side, length) = (97, 0.7);
        let table = table(side);
        let made = Preintegration::new(&table, length);
        let cumulative = table.cumulative();
        for (front, back) in [
            (0, 96),
            (96, 0),
            (3, 40),
            (40, 3),
            (9, 10),
            (10, 9),
            (50, 60),
            (60, 50),
            (52, 53),
            (53, 52),
            (70, 95),
            (20, 22),
            (57, 58),
            (88, 87),
            (0, 30),
        ] {
            let (radiance, depth) = by_steps(&table, length, front, back);
            let pair = made.pairs[back * side + front].as_dvec4();
            let colour = pair.truncate() / pair.w.max(1e-30);
            let seen = colour * -(-pair.w).exp_m1();
            assert!((pair.w - depth).abs() <= 1e-6 * depth, "depth {front} {back}: {} {depth}", pair.w);
            assert!(
                (seen - radiance).abs().max_element() <= 1e-5 * radiance.max_element(),
                "{front} {back}: {seen} {radiance}"
            );
            let summed = cumulative.depth(front as f64, back as f64, length);
            assert!((summed - depth).abs() <= 1e-6 * depth + 3e-7, "sum {front} {back}: {summed} {depth}");
        }
        for entry in 0..side {
            let pair = made.pairs[entry * side + entry];
            assert!((pair.w - table.entries[entry].w * 0.7).abs() <= 1e-6 * pair.w);
        }
    }

    #[test]
    fn a_changed_stretch_makes_the_table_that_all_of_it_makes() {
        let before = table(130);
        let mut changes = Vec::new();
        for stretch in [0..3, 40..41, 60..75, 128..130] {
            let mut now = before.clone();
            now.entries[stretch].iter_mut().for_each(|entry| entry.w += 0.3);
            changes.push(now);
        }
        let mut moved = before.clone();
        moved.layers[2].depth = 3.0;
        changes.push(moved);
        let mut gone = before.clone();
        gone.layers.remove(0);
        changes.push(gone);
        for now in changes {
            let mut updated = Preintegration::new(&before, 1.5);
            let pairs = updated.update(&before, &now);
            assert!(pairs > 0 && pairs < 130 * 130 * 2 / 3, "{pairs}");
            assert_eq!(updated, Preintegration::new(&now, 1.5));
        }
        let mut same = Preintegration::new(&before, 1.5);
        assert_eq!(same.update(&before, &before.clone()), 0);
    }

    #[test]
    fn what_is_opaque_shows_what_is_in_front() {
        let mut table = table(16);
        table.entries.iter_mut().for_each(|entry| entry.w = f32::MAX);
        let made = Preintegration::new(&table, 1.0);
        assert!(made.pairs.iter().all(|pair| pair.is_finite() && pair.w == MAX_DEPTH as f32));
        let pair = made.pairs[15 * 16 + 3];
        assert!((pair.x / pair.w - table.entries[3].x).abs() < 1e-5);
    }
}
