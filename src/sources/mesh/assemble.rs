//! Any positions, normals and triangles -> a clean mesh.

use std::collections::HashMap;

use glam::Vec3;

use super::creases::{self, CREASE_DEGREES, Normals, Rule};
use super::{MeshData, normals, orient};

/// `1 face`, `2 faces`, `3 vertices`.
pub(in crate::sources) fn counted(count: u64, noun: &str) -> String {
    match (count, noun.strip_suffix("ex")) {
        (1, _) => format!("1 {noun}"),
        (_, Some(stem)) => format!("{count} {stem}ices"),
        (_, None) => format!("{count} {noun}s"),
    }
}

/// What tells positions apart: their bits, with -0 equal to 0.
pub(super) fn position_key(position: Vec3) -> [u32; 3] {
    (position + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// For each position the index of the first that equals it.
pub(super) fn weld(positions: &[Vec3]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    let keyed = positions.iter().enumerate();
    keyed.map(|(index, &position)| *first.entry(position_key(position)).or_insert(index as u32)).collect()
}

/// See [`MeshData::from_triangles`].
pub(super) fn assemble(positions: &[Vec3], normals: &[Vec3], triangles: &[[u32; 3]]) -> MeshData {
    let mut notes = Vec::new();
    let triangles = usable_triangles(positions, triangles, &mut notes);
    let normals = complete_normals(positions, normals, &triangles, &mut notes);
    let mut mesh = join_vertices(positions, &normals, &triangles);
    mesh.notes = notes;
    mesh
}

/// See [`MeshData::from_file`].
pub(super) fn assemble_file(
    positions: &[Vec3],
    given: &[Vec3],
    triangles: &[[u32; 3]],
    groups: Option<&[u32]>,
    rule: Normals,
) -> MeshData {
    let mut notes = Vec::new();
    let kept = usable(positions, triangles, &mut notes);
    let groups: Option<Vec<u32>> = groups.map(|groups| kept.iter().map(|&index| groups[index]).collect());
    let mut triangles: Vec<[u32; 3]> = kept.into_iter().map(|index| triangles[index]).collect();
    orient::orient(positions, &mut triangles, &mut notes);
    let has_normals = given.iter().any(|normal| normals::unit(normal.as_dvec3()).is_some());
    let computed = match (rule, groups.as_deref()) {
        (Normals::Auto, _) if has_normals => None,
        (Normals::Smooth(degrees), _) if degrees >= 180.0 => None,
        (Normals::Auto, Some(groups)) => Some(Rule::Groups(groups)),
        (Normals::Auto, None) => Some(Rule::Crease(CREASE_DEGREES)),
        (Normals::Flat, _) => Some(Rule::Crease(0.0)),
        (Normals::Smooth(degrees), _) => Some(Rule::Crease(degrees)),
    };
    let mut mesh = match computed {
        Some(rule) => {
            let corners = creases::corner_normals(positions, &triangles, rule);
            join_corners(positions, &corners, &triangles)
        }
        None => {
            let given = if matches!(rule, Normals::Auto) { given } else { &[] };
            let mut normals = complete_normals(positions, given, &triangles, &mut notes);
            if has_normals {
                turn_with_faces(positions, &mut normals, &triangles, &mut notes);
            }
            join_vertices(positions, &normals, &triangles)
        }
    };
    mesh.notes = notes;
    mesh
}

/// Turns all normals where most of them point to the other side than their faces.
fn turn_with_faces(
    positions: &[Vec3],
    normals: &mut [Vec3],
    triangles: &[[u32; 3]],
    notes: &mut Vec<String>,
) {
    let (mut with, mut against) = (0_u64, 0_u64);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|index| positions[index as usize]);
        let Some(facing) = normals::facing(a, b, c) else { continue };
        for index in triangle {
            let along = normals[*index as usize].as_dvec3().dot(facing);
            with += u64::from(along > 0.0);
            against += u64::from(along < 0.0);
        }
    }
    if against > with {
        normals.iter_mut().for_each(|normal| *normal = -*normal);
        notes.push("its normals point to the other side than its faces do; they are turned over".to_owned());
    }
}

/// Makes one vertex of each different pair of position and normal of a corner.
fn join_corners(positions: &[Vec3], corners: &[[Vec3; 3]], triangles: &[[u32; 3]]) -> MeshData {
    let mut mesh = MeshData { triangles: Vec::with_capacity(triangles.len()), ..MeshData::default() };
    let mut joined = HashMap::new();
    for (triangle, normals) in triangles.iter().zip(corners) {
        let vertex = |corner: usize| {
            let (position, normal) = (positions[triangle[corner] as usize], normals[corner]);
            *joined.entry((position_key(position), position_key(normal))).or_insert_with(|| {
                mesh.positions.push(position);
                mesh.normals.push(normal);
                (mesh.positions.len() - 1) as u32
            })
        };
        let corners = [0, 1, 2].map(vertex);
        mesh.triangles.push(corners);
    }
    mesh
}

/// The triangles with three finite corners and an area.
fn usable_triangles(positions: &[Vec3], triangles: &[[u32; 3]], notes: &mut Vec<String>) -> Vec<[u32; 3]> {
    usable(positions, triangles, notes).into_iter().map(|index| triangles[index]).collect()
}

/// Which triangles have three finite corners and an area.
fn usable(positions: &[Vec3], triangles: &[[u32; 3]], notes: &mut Vec<String>) -> Vec<usize> {
    let (mut outside, mut not_finite, mut flat) = (0, 0, 0);
    let mut usable = Vec::with_capacity(triangles.len());
    for (index, &triangle) in triangles.iter().enumerate() {
        let [Some(a), Some(b), Some(c)] = triangle.map(|index| positions.get(index as usize).copied()) else {
            outside += 1;
            continue;
        };
        if !(a.is_finite() && b.is_finite() && c.is_finite()) {
            not_finite += 1;
        } else if normals::facing(a, b, c).is_none() {
            flat += 1;
        } else {
            usable.push(index);
        }
    }
    if outside > 0 {
        notes.push(format!("{} with a missing vertex dropped", counted(outside, "triangle")));
    }
    if not_finite > 0 {
        notes.push(format!("{} with a NaN or infinite coordinate dropped", counted(not_finite, "triangle")));
    }
    if flat > 0 {
        notes.push(format!("{} dropped", counted(flat, "zero-area triangle")));
    }
    usable
}

/// One unit normal per position: the given one where it has a direction, else computed.
fn complete_normals(
    positions: &[Vec3],
    given: &[Vec3],
    triangles: &[[u32; 3]],
    notes: &mut Vec<String>,
) -> Vec<Vec3> {
    let mut normals: Vec<Option<Vec3>> = (0..positions.len())
        .map(|index| given.get(index).and_then(|normal| normals::unit(normal.as_dvec3())))
        .collect();
    let mut is_used = vec![false; positions.len()];
    triangles.iter().flatten().for_each(|&index| is_used[index as usize] = true);
    let used = is_used.iter().filter(|&&used| used).count();
    let missing = is_used.iter().zip(&normals).filter(|(used, normal)| **used && normal.is_none()).count();
    if missing > 0 {
        let computed = normals::angle_weighted(positions, &weld(positions), triangles);
        for (normal, computed) in normals.iter_mut().zip(computed) {
            normal.get_or_insert(computed);
        }
        // A mesh without any normals is an ordinary one.
        if missing < used {
            notes.push(format!(
                "normals of {missing} of {used} vertices computed (angle-weighted): missing, zero or not finite"
            ));
        }
    }
    normals.into_iter().map(|normal| normal.unwrap_or(normals::FALLBACK)).collect()
}

/// Makes one vertex of each different pair of position and normal that a triangle uses.
fn join_vertices(positions: &[Vec3], normals: &[Vec3], triangles: &[[u32; 3]]) -> MeshData {
    let mut mesh = MeshData { triangles: Vec::with_capacity(triangles.len()), ..MeshData::default() };
    let mut joined = HashMap::new();
    let mut vertex_of: Vec<Option<u32>> = vec![None; positions.len()];
    for triangle in triangles {
        mesh.triangles.push(triangle.map(|index| {
            let index = index as usize;
            *vertex_of[index].get_or_insert_with(|| {
                let key = (position_key(positions[index]), position_key(normals[index]));
                *joined.entry(key).or_insert_with(|| {
                    mesh.positions.push(positions[index]);
                    mesh.normals.push(normals[index]);
                    (mesh.positions.len() - 1) as u32
                })
            })
        }));
    }
    mesh
}
