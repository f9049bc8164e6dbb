//! Triangles of a part that face one way.
//!
//! A *part* is what can be reached over edges of exactly two triangles. Within one, two triangles agree if they go through their common
//! edge in opposite directions, so one triangle decides for all (as in VTK's `vtkPolyDataNormals`). Which way that is:
//!
//! - A part that is closed faces outwards: the volume that it encloses is positive. One that lies inside another closed part keeps facing
//!   it or facing away from it, as the file has it: that is a cavity, or a body inside a body.
//! - Any other part faces the way of its normals if the file gives all of them, else of the greater part of its area.
//! - A part that cannot be made to agree, such as a Möbius strip, stays as it is.
//!
//! Normals that the file gives are then turned where those of the triangles that were turned, or of the others, point backwards on the
//! whole. Where nothing has to be turned nothing is changed.

use super::draft::NONE;
use super::inside;
use super::topology::{Edges, ends_of};
use super::words::counted;
use glam::{DVec3, Vec3};

/// Volumes smaller than this, relative to the 3/2nd power of the area, are rounding errors of surfaces that enclose none.
const MIN_RELATIVE_VOLUME: f64 = 1e-9;

/// Normals that agree, or disagree, with less than this share of the area do not say which way it faces.
const MIN_AGREEMENT: f64 = 0.25;

/// The triangles of a mesh, as far as their orientation goes.
pub(super) struct Facing<'a> {
    /// By vertex.
    pub positions: &'a [Vec3],
    /// Triangles of vertices, of which there is one for each position.
    pub triangles: &'a [[u32; 3]],
    /// How far the given normals of a triangle point where the triangle faces, -1 to 1; `None` if any is missing.
    pub agreement: &'a dyn Fn(usize) -> Option<f64>,
}

impl Facing<'_> {
    fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize].as_dvec3())
    }
}

/// What has to be turned.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Turned {
    /// Whether each triangle is to be turned over; empty if none is.
    pub triangles: Vec<bool>,
    /// Whether the normals of each triangle are to be turned; empty if none are.
    pub normals: Vec<bool>,
    /// What to tell of it.
    pub notes: Vec<String>,
}

/// Finds out which triangles, and which given normals, face the wrong way.
pub(super) fn orient(facing: &Facing<'_>, edges: &Edges, partners: &[u32]) -> Turned {
    let mut parts = Parts::of(facing, partners);
    parts.find_open(facing, edges);
    let turned = parts.turned_triangles(facing);
    let normals = parts.turned_normals(facing, &turned);
    let count = |turned: &[bool]| turned.iter().filter(|&&turned| turned).count() as u64;
    let all = counted(facing.triangles.len() as u64, "triangle");
    let one_sided = parts.parts.iter().filter(|part| part.is_one_sided).count() as u64;
    let notes = [
        (
            count(&turned),
            format!(
                "{} of {all} turned over, so that parts face one way and closed ones outwards",
                count(&turned)
            ),
        ),
        (
            count(&normals),
            format!(
                "normals of {} of {all} turned: they pointed to the back of the surface",
                count(&normals)
            ),
        ),
        (
            one_sided,
            format!(
                "{} with one side only, like a Möbius strip, facing as in the file",
                counted(one_sided, "part")
            ),
        ),
    ];
    let notes = notes.into_iter().filter_map(|(count, note)| (count > 0).then_some(note)).collect();
    let unless_none = |turned: Vec<bool>| if turned.contains(&true) { turned } else { Vec::new() };
    Turned { triangles: unless_none(turned), normals: unless_none(normals), notes }
}

/// What was found out about a part.
#[derive(Debug, Clone, Default)]
struct Part {
    /// The area of the triangles that agree with the first one, and of the others.
    area: [f64; 2],
    /// Whether it cannot be made to agree.
    is_one_sided: bool,
    /// Whether it has a border.
    is_open: bool,
    /// The volume that it encloses if all triangles agree with the first one.
    volume: f64,
    /// A point near it, which volumes are summed about.
    anchor: DVec3,
    /// The area whose normals agree with where triangles face if they all agree with the first one; NaN if some have no normals.
    agreement: f64,
    bounds: (DVec3, DVec3),
}

impl Part {
    /// Whether the greater part of its area disagrees with the first triangle.
    fn differs(&self) -> bool {
        self.area[1] > self.area[0]
    }

    /// The volume as most of its area has it; nothing if it encloses none.
    fn written_volume(&self) -> Option<f64> {
        let area = self.area[0] + self.area[1];
        let encloses = !self.is_open && self.volume.abs() > MIN_RELATIVE_VOLUME * area.powf(1.5);
        encloses.then_some(if self.differs() { -self.volume } else { self.volume })
    }
}

/// The parts of a mesh, and how each triangle is to the first one of its part.
struct Parts {
    parts: Vec<Part>,
    part_of: Vec<u32>,
    /// Whether each triangle disagrees with the first one of its part.
    differs: Vec<bool>,
}

impl Parts {
    fn of(facing: &Facing<'_>, partners: &[u32]) -> Self {
        let count = facing.triangles.len();
        let mut found = Self { parts: Vec::new(), part_of: vec![NONE; count], differs: vec![false; count] };
        for first in 0..count {
            if found.part_of[first] == NONE {
                found.add_part(facing, partners, first);
            }
        }
        found
    }

    /// Walks over all that can be reached from a triangle.
    fn add_part(&mut self, facing: &Facing<'_>, partners: &[u32], first: usize) {
        let index = self.parts.len() as u32;
        let anchor = facing.corners(first)[0];
        let mut part = Part { anchor, bounds: (anchor, anchor), ..Part::default() };
        let mut reached = vec![first];
        self.part_of[first] = index;
        while let Some(triangle) = reached.pop() {
            self.measure(facing, triangle, &mut part);
            for (side, &partner) in partners.iter().enumerate().skip(3 * triangle).take(3) {
                if partner == NONE {
                    continue;
                }
                let beside = partner as usize / 3;
                let agree = ends_of(facing.triangles, side as u32).0 == ends_of(facing.triangles, partner).1;
                let differs = self.differs[triangle] == agree;
                if self.part_of[beside] == NONE {
                    self.part_of[beside] = index;
                    self.differs[beside] = differs;
                    reached.push(beside);
                } else if self.differs[beside] != differs {
                    part.is_one_sided = true;
                }
            }
        }
        self.parts.push(part);
    }

    /// Adds a triangle to what is known of its part.
    fn measure(&self, facing: &Facing<'_>, triangle: usize, part: &mut Part) {
        let [a, b, c] = facing.corners(triangle);
        for corner in [a, b, c] {
            part.bounds = (part.bounds.0.min(corner), part.bounds.1.max(corner));
        }
        let sign = if self.differs[triangle] { -1.0 } else { 1.0 };
        let area = (b - a).cross(c - a).length() / 2.0;
        part.area[usize::from(self.differs[triangle])] += area;
        let [a, b, c] = [a, b, c].map(|corner| corner - part.anchor);
        part.volume += sign * a.dot(b.cross(c)) / 6.0;
        part.agreement += sign * area * (facing.agreement)(triangle).unwrap_or(f64::NAN);
    }

    /// Marks the parts that have a border: an edge at which their triangles do not cancel.
    fn find_open(&mut self, facing: &Facing<'_>, edges: &Edges) {
        let mut sides = Vec::new();
        for edge in edges.iter().filter(|edge| edge.len() != 2) {
            sides.clear();
            sides.extend(edge.iter().map(|&side| {
                let (from, to) = ends_of(facing.triangles, side);
                let triangle = side as usize / 3;
                let forwards = (from < to) != self.differs[triangle];
                (self.part_of[triangle], if forwards { 1_i64 } else { -1 })
            }));
            sides.sort_unstable();
            for of_part in sides.chunk_by(|a, b| a.0 == b.0) {
                if of_part.iter().map(|(_, sign)| sign).sum::<i64>() != 0 {
                    self.parts[of_part[0].0 as usize].is_open = true;
                }
            }
        }
    }

    /// Whether each triangle is to be turned over.
    fn turned_triangles(&self, facing: &Facing<'_>) -> Vec<bool> {
        let inwards = self.inward_parts(facing);
        let of_part = |(part, inwards): (&Part, bool)| {
            let area = part.area[0] + part.area[1];
            let has_normals = part.agreement.abs() >= MIN_AGREEMENT * area;
            match part.written_volume() {
                Some(_) => part.differs() != inwards,
                None if has_normals => part.agreement < 0.0,
                None => part.differs(),
            }
        };
        let flips: Vec<bool> = self.parts.iter().zip(inwards).map(of_part).collect();
        let turns = |(&part, &differs): (&u32, &bool)| {
            !self.parts[part as usize].is_one_sided && differs != flips[part as usize]
        };
        self.part_of.iter().zip(&self.differs).map(turns).collect()
    }

    /// Which closed parts are to be turned from what most of their area says, with those inside them.
    fn inward_parts(&self, facing: &Facing<'_>) -> Vec<bool> {
        let is_inward =
            |part: &Part| !part.is_one_sided && part.written_volume().is_some_and(|volume| volume < 0.0);
        let inward: Vec<bool> = self.parts.iter().map(is_inward).collect();
        if !inward.contains(&true) {
            return inward;
        }
        let mut shells = inside::Shells::new(facing.positions, facing.triangles);
        for (index, part) in self.parts.iter().enumerate() {
            if part.written_volume().is_some() && !part.is_one_sided {
                shells.add(index, part.bounds, inward[index]);
            }
        }
        shells.fill(&self.part_of, &self.differs);
        let outermost = shells.outermost();
        (0..self.parts.len()).map(|part| inward[outermost.get(&part).copied().unwrap_or(part)]).collect()
    }

    /// Whether the normals of each triangle are to be turned, given which triangles are.
    fn turned_normals(&self, facing: &Facing<'_>, turned: &[bool]) -> Vec<bool> {
        // By part, and whether the triangle was turned: the area, and that with which the normals agree.
        let mut sums = vec![[(0.0, 0.0); 2]; self.parts.len()];
        let agreements: Vec<Option<f64>> = (0..turned.len()).map(facing.agreement).collect();
        for (triangle, agreement) in agreements.iter().enumerate() {
            let Some(agreement) = agreement else { continue };
            let [a, b, c] = facing.corners(triangle);
            let area = (b - a).cross(c - a).length();
            let sum = &mut sums[self.part_of[triangle] as usize][usize::from(turned[triangle])];
            sum.0 += area;
            sum.1 += if turned[triangle] { -area * agreement } else { area * agreement };
        }
        let points_back = |triangle: usize| {
            let part = self.part_of[triangle] as usize;
            let (area, agreement) = sums[part][usize::from(turned[triangle])];
            let part = &self.parts[part];
            // Of a part with a border they are only known to be backwards if all of them say which way that is.
            let is_known = part.written_volume().is_some() || !part.agreement.is_nan();
            let is_told = is_known && !part.is_one_sided && agreements[triangle].is_some();
            is_told && agreement < -MIN_AGREEMENT * area
        };
        (0..turned.len()).map(points_back).collect()
    }
}
