//! Faces of connected parts turned so that they agree, and outwards where the part is closed.

use super::assemble::{counted, weld};
use glam::{DVec3, Vec3};

/// Turns triangles over, and tells how many in `notes`. What agrees already, and faces outwards where it is closed, stays as it is.
///
/// A closed part that faces inwards and lies within another is taken for the wall of a hollow. A part that cannot agree with itself, as a
/// Möbius strip, stays as it is.
pub(super) fn orient(positions: &[Vec3], triangles: &mut [[u32; 3]], notes: &mut Vec<String>) {
    let welded = weld(positions);
    let neighbours = Neighbours::new(&welded, triangles);
    let parts = neighbours.parts(triangles.len());
    let boxes: Vec<Option<(DVec3, DVec3)>> = parts
        .iter()
        .map(|part| part.is_closed.then(|| bounds(positions, triangles, &part.triangles)))
        .collect();
    let (mut turned, mut twisted) = (0_u64, 0_u64);
    for (index, part) in parts.iter().enumerate() {
        if part.is_twisted {
            twisted += 1;
            continue;
        }
        let against = part.triangles.iter().filter(|(_, is_turned)| *is_turned).count();
        let all_others = if part.is_closed {
            let volume: f64 = part
                .triangles
                .iter()
                .map(|&(triangle, is_turned)| {
                    let sign = if is_turned { -1.0 } else { 1.0 };
                    sign * volume(positions, triangles[triangle as usize], part_origin(&boxes[index]))
                })
                .sum();
            let is_hollow = against == 0
                && boxes
                    .iter()
                    .enumerate()
                    .any(|(other, around)| other != index && is_within(&boxes[index], around));
            volume < 0.0 && !is_hollow
        } else {
            // The way of most of them.
            2 * against > part.triangles.len()
        };
        for &(triangle, is_turned) in &part.triangles {
            if is_turned != all_others {
                triangles[triangle as usize].swap(1, 2);
                turned += 1;
            }
        }
    }
    if turned > 0 {
        let all = counted(triangles.len() as u64, "triangle");
        notes.push(format!("{turned} of {all} turned over, so that parts agree and face outwards"));
    }
    if twisted > 0 {
        notes.push(format!("{} with one side only left as they are", counted(twisted, "part")));
    }
}

fn part_origin(bounds: &Option<(DVec3, DVec3)>) -> DVec3 {
    bounds.map_or(DVec3::ZERO, |(low, high)| (low + high) / 2.0)
}

fn is_within(inner: &Option<(DVec3, DVec3)>, outer: &Option<(DVec3, DVec3)>) -> bool {
    match (inner, outer) {
        (Some(inner), Some(outer)) => inner.0.cmpgt(outer.0).all() && inner.1.cmplt(outer.1).all(),
        _ => false,
    }
}

fn bounds(positions: &[Vec3], triangles: &[[u32; 3]], part: &[(u32, bool)]) -> (DVec3, DVec3) {
    let corners = part.iter().flat_map(|(triangle, _)| triangles[*triangle as usize]);
    corners
        .map(|corner| positions[corner as usize].as_dvec3())
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), corner| {
            (low.min(corner), high.max(corner))
        })
}

/// Six times the volume between a triangle and a point.
fn volume(positions: &[Vec3], triangle: [u32; 3], origin: DVec3) -> f64 {
    let [a, b, c] = triangle.map(|corner| positions[corner as usize].as_dvec3() - origin);
    a.dot(b.cross(c))
}

/// The edges of each triangle that exactly one other has too.
struct Neighbours {
    /// For each edge a to b, b to c and c to a of each triangle: the other triangle, and whether it runs along the edge the same way, so
    /// that one of both is to be turned.
    across: Vec<[Option<(u32, bool)>; 3]>,
}

/// Triangles that hang together, each with whether it is to be turned to agree with the first.
struct Part {
    triangles: Vec<(u32, bool)>,
    is_closed: bool,
    is_twisted: bool,
}

impl Neighbours {
    fn new(welded: &[u32], triangles: &[[u32; 3]]) -> Self {
        // (edge, triangle, which edge of it, whether it runs upwards)
        let mut edges: Vec<(u64, u32, u8, bool)> = Vec::with_capacity(3 * triangles.len());
        for (triangle, index) in triangles.iter().zip(0_u32..) {
            for side in 0..3_u8 {
                let from = welded[triangle[usize::from(side)] as usize];
                let to = welded[triangle[usize::from(side + 1) % 3] as usize];
                let key = u64::from(from.min(to)) << 32 | u64::from(from.max(to));
                edges.push((key, index, side, from < to));
            }
        }
        edges.sort_unstable();
        let mut across = vec![[None; 3]; triangles.len()];
        for shared in edges.chunk_by(|a, b| a.0 == b.0) {
            if let [one, other] = shared {
                let same_way = one.3 == other.3;
                across[one.1 as usize][usize::from(one.2)] = Some((other.1, same_way));
                across[other.1 as usize][usize::from(other.2)] = Some((one.1, same_way));
            }
        }
        Self { across }
    }

    fn parts(&self, triangles: usize) -> Vec<Part> {
        let mut turn: Vec<Option<bool>> = vec![None; triangles];
        let mut parts = Vec::new();
        for first in 0..triangles as u32 {
            if turn[first as usize].is_some() {
                continue;
            }
            turn[first as usize] = Some(false);
            let mut part = Part { triangles: vec![(first, false)], is_closed: true, is_twisted: false };
            let mut next = 0;
            while let Some(&(triangle, is_turned)) = part.triangles.get(next) {
                next += 1;
                for across in self.across[triangle as usize] {
                    let Some((other, same_way)) = across else {
                        part.is_closed = false;
                        continue;
                    };
                    let wanted = is_turned != same_way;
                    match turn[other as usize] {
                        None => {
                            turn[other as usize] = Some(wanted);
                            part.triangles.push((other, wanted));
                        }
                        Some(known) => part.is_twisted |= known != wanted,
                    }
                }
            }
            parts.push(part);
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sources::procedural;

    fn oriented(mut triangles: Vec<[u32; 3]>, positions: &[Vec3]) -> (Vec<[u32; 3]>, Vec<String>) {
        let mut notes = Vec::new();
        orient(positions, &mut triangles, &mut notes);
        (triangles, notes)
    }

    #[test]
    fn closed_parts_face_outwards_whichever_way_they_did() {
        let ball = procedural::sphere(1.0, 2);
        let right = ball.triangles.clone();
        assert_eq!(oriented(right.clone(), &ball.positions), (right.clone(), vec![]));
        let turned = |every: usize| {
            let turn = |(index, [a, b, c]): (usize, &[u32; 3])| {
                if index % every == 0 { [*a, *c, *b] } else { [*a, *b, *c] }
            };
            right.iter().enumerate().map(turn).collect::<Vec<_>>()
        };
        for every in [1, 2, 3, 7] {
            let (now, notes) = oriented(turned(every), &ball.positions);
            assert_eq!(now, right);
            assert_eq!(notes.len(), 1, "{notes:?}");
        }
    }

    #[test]
    fn the_wall_of_a_hollow_stays_and_open_parts_go_with_most() {
        let (outer, inner) = (procedural::sphere(2.0, 1), procedural::sphere(1.0, 1));
        let first = outer.positions.len() as u32;
        let inwards = inner.triangles.iter().map(|[a, b, c]| [a + first, c + first, b + first]);
        let triangles: Vec<_> = outer.triangles.iter().copied().chain(inwards).collect();
        let positions = [outer.positions, inner.positions].concat();
        assert_eq!(oriented(triangles.clone(), &positions), (triangles, vec![]));
        let square = [Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y, Vec3::NEG_X];
        let (now, _) = oriented(vec![[0, 1, 2], [0, 3, 2], [0, 3, 4]], &square);
        assert_eq!(now, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    }

    #[test]
    fn a_strip_with_one_side_stays_as_it_is() {
        let ring: Vec<Vec3> = (0..10)
            .map(|index| {
                let angle = std::f32::consts::TAU * (index / 2) as f32 / 5.0;
                let across = (angle / 2.0).sin_cos();
                let side = if index % 2 == 0 { 0.3 } else { -0.3 };
                let reach = 1.0 + side * across.1;
                Vec3::new(reach * angle.cos(), reach * angle.sin(), side * across.0)
            })
            .collect();
        let mut triangles = Vec::new();
        for step in 0..5_u32 {
            // The last meets the first with its sides exchanged.
            let (a, b) = (2 * step, 2 * step + 1);
            let (c, d) = if step == 4 { (1, 0) } else { (a + 2, a + 3) };
            triangles.extend([[a, c, b], [b, c, d]]);
        }
        let (now, notes) = oriented(triangles.clone(), &ring);
        assert_eq!(now, triangles);
        assert!(notes[0].contains("one side only"), "{notes:?}");
    }
}
