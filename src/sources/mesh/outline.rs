//! Outlines of very many corners -> triangles, by a sweep, in n log n steps.
//!
//! A line sweeps over the corners from left to right (Hertel and Mehlhorn, "Fast triangulation of simple polygons", FCT 1983). Between an
//! edge below and one above, where the inside of the outline is, lies a *gap*: what is to the left of it is cut up but for a chain of
//! corners that a later one will see. A corner that opens or closes a gap, splits one or merges two is the next corner of one chain or two.

use std::cmp::Ordering;

use glam::DVec2;

/// How far the area of the triangles may be from that of the outline, relative to it: more, and the outline crosses itself.
const MOST_AREA_ERROR: f64 = 1e-6;

/// Gaps of a block; the blocks of all gaps are a list of lists, so that putting one in moves few others.
const BLOCK: usize = 256;

/// Adds the triangles of an outline that goes counter-clockwise, as indices into it. Nothing, and no triangle, if it crosses or touches
/// itself.
pub(super) fn triangulate(outline: &[DVec2], triangles: &mut Vec<[usize; 3]>) -> Option<()> {
    let start = triangles.len();
    let mut sweep = Sweep { outline, triangles, gaps: Vec::new(), blocks: Vec::new() };
    let done = sweep.run().filter(|()| is_whole(outline, &triangles[start..]));
    if done.is_none() {
        triangles.truncate(start);
    }
    done
}

/// Whether triangles cover the outline once.
fn is_whole(outline: &[DVec2], triangles: &[[usize; 3]]) -> bool {
    let around = outline.iter().zip(outline.iter().cycle().skip(1));
    let expected: f64 = around.map(|(a, b)| (a - outline[0]).perp_dot(b - outline[0])).sum();
    let covered: f64 =
        triangles.iter().map(|&[a, b, c]| turn(outline[a], outline[b], outline[c]).abs()).sum();
    (covered - expected).abs() <= MOST_AREA_ERROR * expected.abs()
}

/// Twice the signed area of a triangle: positive if it is counter-clockwise.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    Below,
    Above,
}

/// Corners from left to right that are still to be cut off: all but the first lie on one side of the gap, and see each other over nothing.
#[derive(Debug, Clone)]
struct Chain {
    corners: Vec<usize>,
    side: Side,
}

/// A stretch of the sweep line inside of the outline.
#[derive(Debug, Default)]
struct Gap {
    /// The edges that bound it, by the corners that they begin at.
    below: usize,
    above: usize,
    /// Of a gap that two merged to, that of the lower one; the upper one is next. Both end at the corner that merged them.
    chains: Vec<Chain>,
}

struct Sweep<'a> {
    outline: &'a [DVec2],
    triangles: &'a mut Vec<[usize; 3]>,
    gaps: Vec<Gap>,
    /// Gaps from below to above.
    blocks: Vec<Vec<usize>>,
}

impl Sweep<'_> {
    fn run(&mut self) -> Option<()> {
        let mut order: Vec<usize> = (0..self.outline.len()).collect();
        order.sort_unstable_by(|&a, &b| self.compare(a, b));
        order.into_iter().try_for_each(|corner| self.visit(corner))
    }

    /// From left to right, and from below to above.
    fn compare(&self, a: usize, b: usize) -> Ordering {
        let (at, bt) = (self.outline[a], self.outline[b]);
        at.x.total_cmp(&bt.x).then(at.y.total_cmp(&bt.y)).then(a.cmp(&b))
    }

    fn next(&self, corner: usize) -> usize {
        if corner + 1 == self.outline.len() { 0 } else { corner + 1 }
    }

    fn previous(&self, corner: usize) -> usize {
        corner.checked_sub(1).unwrap_or(self.outline.len() - 1)
    }

    /// Whether a corner lies above the edge that begins at another: positive if so, 0 on it.
    fn height(&self, corner: usize, edge: usize) -> f64 {
        let (from, to) = (edge, self.next(edge));
        let (left, right) = if self.compare(from, to).is_lt() { (from, to) } else { (to, from) };
        turn(self.outline[left], self.outline[right], self.outline[corner])
    }

    fn visit(&mut self, corner: usize) -> Option<()> {
        let (before, after) = (self.previous(corner), self.next(corner));
        let is_left_of = |other: usize| self.compare(corner, other).is_lt();
        let is_convex = turn(self.outline[before], self.outline[corner], self.outline[after]) > 0.0;
        let place = self.find(corner);
        match (is_left_of(before), is_left_of(after), is_convex) {
            (true, true, true) => self.open(corner, before, place),
            (true, true, false) => self.split(corner, before, place),
            (false, false, true) => self.close(corner, before, place),
            (false, false, false) => self.merge(corner, before, place),
            (false, true, _) => {
                let gap = self.gap(place).filter(|&gap| self.gaps[gap].below == before)?;
                self.gaps[gap].below = corner;
                self.extend(gap, corner, Side::Below);
                Some(())
            }
            (true, false, _) => {
                let gap = self.gap(place).filter(|&gap| self.gaps[gap].above == corner)?;
                self.gaps[gap].above = before;
                self.extend(gap, corner, Side::Above);
                Some(())
            }
        }
    }

    /// A corner that opens a gap between its two edges.
    fn open(&mut self, corner: usize, before: usize, place: (usize, usize)) -> Option<()> {
        if self.gap(place).is_some_and(|gap| self.height(corner, self.gaps[gap].below) > 0.0) {
            return None;
        }
        let chain = Chain { corners: vec![corner], side: Side::Below };
        self.insert(place, Gap { below: corner, above: before, chains: vec![chain] });
        Some(())
    }

    /// A corner that splits a gap in two: it sees the last corner of the chain.
    fn split(&mut self, corner: usize, before: usize, place: (usize, usize)) -> Option<()> {
        let gap = self.gap(place).filter(|&gap| self.height(corner, self.gaps[gap].below) >= 0.0)?;
        let mut chains = std::mem::take(&mut self.gaps[gap].chains);
        let (mut lower, mut upper) = match (chains.pop()?, chains.pop()) {
            (upper, Some(lower)) => (lower, upper),
            (chain, None) => {
                let seen = vec![*chain.corners.last()?];
                match chain.side {
                    Side::Below => (Chain { corners: seen, side: Side::Above }, chain),
                    Side::Above => (chain, Chain { corners: seen, side: Side::Below }),
                }
            }
        };
        self.add(&mut lower, corner, Side::Above);
        self.add(&mut upper, corner, Side::Below);
        let above = std::mem::replace(&mut self.gaps[gap].above, before);
        self.gaps[gap].chains = vec![lower];
        self.insert((place.0, place.1 + 1), Gap { below: corner, above, chains: vec![upper] });
        Some(())
    }

    /// A corner that closes a gap.
    fn close(&mut self, corner: usize, before: usize, place: (usize, usize)) -> Option<()> {
        let gap = self.gap(place)?;
        if (self.gaps[gap].below, self.gaps[gap].above) != (before, corner) {
            return None;
        }
        for chain in std::mem::take(&mut self.gaps[gap].chains) {
            self.finish(&chain, corner);
        }
        self.remove(place);
        Some(())
    }

    /// A corner that merges the gap below it with that above it.
    fn merge(&mut self, corner: usize, before: usize, place: (usize, usize)) -> Option<()> {
        let upper_place = self.following(place);
        let (lower, upper) = (self.gap(place)?, self.gap(upper_place)?);
        if self.gaps[lower].above != corner || self.gaps[upper].below != before {
            return None;
        }
        self.extend(lower, corner, Side::Above);
        self.extend(upper, corner, Side::Below);
        let merged = std::mem::take(&mut self.gaps[upper]);
        self.gaps[lower].above = merged.above;
        self.gaps[lower].chains.extend(merged.chains);
        self.remove(upper_place);
        Some(())
    }

    /// Adds a corner on one side of a gap. In one that two merged to, it sees the corner that merged them.
    fn extend(&mut self, gap: usize, corner: usize, side: Side) {
        let mut chains = std::mem::take(&mut self.gaps[gap].chains);
        if chains.len() > 1 {
            let seen = if side == Side::Below { chains.remove(0) } else { chains.remove(1) };
            self.finish(&seen, corner);
        }
        self.add(&mut chains[0], corner, side);
        self.gaps[gap].chains = chains;
    }

    /// Adds a corner to a chain, and cuts off what it sees.
    fn add(&mut self, chain: &mut Chain, corner: usize, side: Side) {
        if chain.corners.len() > 1 && chain.side != side {
            self.finish(chain, corner);
            let last = chain.corners.pop();
            chain.corners.clear();
            chain.corners.extend(last);
        }
        while let [.., a, b] = chain.corners[..] {
            let turns = turn(self.outline[a], self.outline[b], self.outline[corner]);
            if (side == Side::Below && turns <= 0.0) || (side == Side::Above && turns >= 0.0) {
                break;
            }
            self.triangles.push(if side == Side::Below { [a, b, corner] } else { [b, a, corner] });
            chain.corners.pop();
        }
        chain.corners.push(corner);
        chain.side = side;
    }

    /// Cuts off all of a chain with a corner on the other side.
    fn finish(&mut self, chain: &Chain, corner: usize) {
        for pair in chain.corners.windows(2) {
            let [a, b] = if chain.side == Side::Below { [pair[0], pair[1]] } else { [pair[1], pair[0]] };
            self.triangles.push([a, b, corner]);
        }
    }

    /// The place of the first gap whose upper edge is not below a corner: a block, and a place in it.
    fn find(&self, corner: usize) -> (usize, usize) {
        let is_below = |gap: &usize| self.height(corner, self.gaps[*gap].above) > 0.0;
        let block = self.blocks.partition_point(|block| block.last().is_some_and(is_below));
        (block, self.blocks.get(block).map_or(0, |block| block.partition_point(is_below)))
    }

    fn gap(&self, (block, place): (usize, usize)) -> Option<usize> {
        self.blocks.get(block)?.get(place).copied()
    }

    fn following(&self, (block, place): (usize, usize)) -> (usize, usize) {
        let is_last = self.blocks.get(block).is_none_or(|block| place + 1 >= block.len());
        if is_last { (block + 1, 0) } else { (block, place + 1) }
    }

    fn insert(&mut self, (block, place): (usize, usize), gap: Gap) {
        let number = self.gaps.len();
        self.gaps.push(gap);
        if block == self.blocks.len() {
            self.blocks.push(Vec::new());
        }
        let gaps = &mut self.blocks[block];
        gaps.insert(place, number);
        if gaps.len() > BLOCK {
            let upper = gaps.split_off(BLOCK / 2);
            self.blocks.insert(block + 1, upper);
        }
    }

    fn remove(&mut self, (block, place): (usize, usize)) {
        self.blocks[block].remove(place);
        if self.blocks[block].is_empty() {
            self.blocks.remove(block);
        }
    }
}
