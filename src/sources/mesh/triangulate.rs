//! Polygons -> triangles, by clipping ears in the polygon's plane.
//!
//! Meisters, "Polygons have ears", 1975: any simple polygon of more than three corners has a corner whose triangle lies
//! inside; cutting it off leaves a simple polygon. Convex polygons come out as the fan around their first corner.
//!
//! That takes up to the square of the number of corners, so polygons of very many are swept over: see [`super::outline`].

use super::outline;
use glam::{DVec2, DVec3, Vec3};

/// Corners of a polygon whose ears are clipped at once.
const MOST_CLIPPED: usize = 256;

/// Squares of numbers of corners of larger polygons whose ears are clipped, all in all: a second's work.
const MOST_WORK: usize = 1 << 26;

/// Cuts up the polygons of a mesh.
#[derive(Debug, Default)]
pub(in crate::sources) struct Cutter {
    work: usize,
}

impl Cutter {
    /// The triangles of a polygon, as indices into its corners, in the polygon's direction of rotation: two fewer than it has corners, also
    /// if it cannot be cut cleanly because it crosses itself.
    ///
    /// False if it has very many corners and crosses or touches itself, and too much was done for such ones already: then they are the fan
    /// around its first corner.
    pub fn cut(&mut self, corners: &[Vec3], triangles: &mut Vec<[usize; 3]>) -> bool {
        let count = unwound_length(corners);
        match count {
            0..=2 => return true,
            3 => {
                triangles.push([0, 1, 2]);
                return true;
            }
            _ => {}
        }
        let outline = project(&corners[..count]);
        if count > MOST_CLIPPED {
            if outline::triangulate(&outline, triangles).is_some() {
                return true;
            }
            self.work = self.work.saturating_add(count.saturating_mul(count));
            if self.work > MOST_WORK {
                triangles.extend((1..count - 1).map(|corner| [0, corner, corner + 1]));
                return false;
            }
        }
        Clipper::new(outline).clip(triangles);
        true
    }
}

/// Corners of one round: a file may walk the same outline several times.
fn unwound_length(corners: &[Vec3]) -> usize {
    // The lengths of the borders that each prefix begins and ends with: Knuth, Morris and Pratt, 1977.
    let mut borders = vec![0; corners.len()];
    let mut border = 0;
    for end in 1..corners.len() {
        while border > 0 && corners[end] != corners[border] {
            border = borders[border - 1];
        }
        border += usize::from(corners[end] == corners[border]);
        borders[end] = border;
    }
    let period = corners.len() - border;
    if period >= 3 && corners.len().is_multiple_of(period) { period } else { corners.len() }
}

/// Times a polygon that seems to have no ear is looked through again before a corner is cut off regardless.
const MAX_RESCANS: usize = 8;

/// What is left of a polygon: a ring of corners.
struct Clipper {
    points: Vec<DVec2>,
    previous: Vec<usize>,
    next: Vec<usize>,
    /// Whether each corner was an ear when it or a neighbour last changed.
    is_ear: Vec<bool>,
    /// Corners that may lie inside an ear: those that were not convex at first. Clipping makes no convex corner reflex.
    obstacles: Vec<usize>,
    rescans: usize,
}

impl Clipper {
    /// Begins with a polygon that is counter-clockwise.
    fn new(points: Vec<DVec2>) -> Self {
        let count = points.len();
        let mut clipper = Self {
            points,
            previous: (0..count).map(|corner| (corner + count - 1) % count).collect(),
            next: (0..count).map(|corner| (corner + 1) % count).collect(),
            is_ear: Vec::new(),
            obstacles: Vec::new(),
            rescans: 0,
        };
        clipper.obstacles = (0..count).filter(|&corner| clipper.turn_at(corner) <= 0.0).collect();
        clipper.is_ear = (0..count).map(|corner| clipper.find_ear_at(corner)).collect();
        clipper
    }

    fn clip(mut self, triangles: &mut Vec<[usize; 3]>) {
        let mut left = self.points.len();
        let mut corner = 1;
        while left > 3 {
            let ear = self.find_ear(corner, left);
            triangles.push([self.previous[ear], ear, self.next[ear]]);
            corner = self.remove(ear);
            left -= 1;
        }
        triangles.push([self.previous[corner], corner, self.next[corner]]);
    }

    /// The corner to cut off; where none is an ear, because the polygon crosses or touches itself, a convex one.
    fn find_ear(&mut self, start: usize, left: usize) -> usize {
        let known = self.find(start, left, |clipper, corner| clipper.is_ear[corner]);
        if let Some(ear) = known {
            return ear;
        }
        if self.rescans < MAX_RESCANS {
            self.rescans += 1;
            if let Some(ear) = self.find(start, left, Self::find_ear_at) {
                return ear;
            }
        }
        self.find(start, left, |clipper, corner| clipper.turn_at(corner) > 0.0).unwrap_or(start)
    }

    /// The first corner from `start` on that satisfies `wanted`.
    fn find(&self, start: usize, left: usize, wanted: fn(&Self, usize) -> bool) -> Option<usize> {
        let ring = std::iter::successors(Some(start), |&corner| Some(self.next[corner]));
        ring.take(left).find(|&corner| wanted(self, corner))
    }

    /// Takes a corner out of the ring; gives the one after it.
    fn remove(&mut self, corner: usize) -> usize {
        let (before, after) = (self.previous[corner], self.next[corner]);
        self.next[before] = after;
        self.previous[after] = before;
        self.obstacles.retain(|&obstacle| obstacle != corner);
        self.is_ear[before] = self.find_ear_at(before);
        self.is_ear[after] = self.find_ear_at(after);
        after
    }

    fn turn_at(&self, corner: usize) -> f64 {
        turn(self.points[self.previous[corner]], self.points[corner], self.points[self.next[corner]])
    }

    /// Whether the corner's triangle is convex and no other corner lies in it or on its border.
    fn find_ear_at(&self, corner: usize) -> bool {
        let [a, b, c] = [self.previous[corner], corner, self.next[corner]].map(|corner| self.points[corner]);
        turn(a, b, c) > 0.0
            && !self.obstacles.iter().any(|&obstacle| {
                let point = self.points[obstacle];
                point != a
                    && point != b
                    && point != c
                    && turn(a, b, point) >= 0.0
                    && turn(b, c, point) >= 0.0
                    && turn(c, a, point) >= 0.0
            })
    }
}

/// Twice the signed area of a triangle: positive if it is counter-clockwise.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// The corners in the plane of the polygon, so that it is counter-clockwise there.
fn project(corners: &[Vec3]) -> Vec<DVec2> {
    let origin = corners[0].as_dvec3();
    let relative: Vec<DVec3> = corners.iter().map(|corner| corner.as_dvec3() - origin).collect();
    // Newell's normal: Sutherland, Sproull and Schumacker, 1974.
    let turns = relative.iter().zip(relative.iter().cycle().skip(1));
    let normal: DVec3 = turns.map(|(&from, &to)| from.cross(to)).sum();
    let size = normal.abs();
    // Looking along the normal's greatest axis changes areas by a factor only.
    let along = if size.x >= size.y && size.x >= size.z {
        |point: DVec3| DVec2::new(point.y, point.z)
    } else if size.y >= size.z {
        |point: DVec3| DVec2::new(point.z, point.x)
    } else {
        |point: DVec3| DVec2::new(point.x, point.y)
    };
    let is_flipped = size.max_element() > normal.max_element();
    let flip = |point: DVec2| {
        if is_flipped { DVec2::new(point.y, point.x) } else { point }
    };
    relative.into_iter().map(along).map(flip).collect()
}
