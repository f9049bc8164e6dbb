//! Corners -> vertices: one for each different combination of position, normal, colour and texture coordinates.

use super::draft::{Draft, NONE};
use super::weld::position_key;
use super::{MeshData, MeshPart};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Vertices of one position that are looked through; the tip of a cone may have thousands, which are found by their bits.
const MOST_LISTED: usize = 8;

/// The colour of what the file gives none, where it gives some.
const WHITE: [f32; 4] = [1.0; 4];

/// Makes a mesh of triangles of corners. `welded` are the first equal position of each position, `normals` those of each triangle's
/// corners, `faces` the face of each triangle.
pub(super) fn join(
    draft: &Draft,
    positions: &[Vec3],
    welded: &[u32],
    triangles: &[[u32; 3]],
    faces: &[u32],
    normals: &[Vec3],
) -> MeshData {
    let mut joiner = Joiner {
        draft,
        mesh: MeshData::default(),
        first: vec![NONE; positions.len()],
        next: Vec::new(),
        others: HashMap::new(),
        has_texture: !draft.corner_textures.is_empty(),
    };
    let order = by_material(draft, faces, &mut joiner.mesh.parts);
    joiner.mesh.triangles.reserve_exact(triangles.len());
    for index in order.iter().map(|&index| index as usize) {
        let corners = triangles[index];
        let triangle = [0, 1, 2].map(|corner| {
            let position = draft.corners[corners[corner] as usize];
            joiner.vertex(corners[corner], positions, position, welded, normals[3 * index + corner])
        });
        joiner.mesh.triangles.push(triangle);
    }
    joiner.mesh
}

/// The order of triangles in which those of a material stand together; as they are if there are no materials.
fn by_material(draft: &Draft, faces: &[u32], parts: &mut Vec<MeshPart>) -> Vec<u32> {
    let mut order: Vec<u32> = (0..faces.len() as u32).collect();
    let material = |triangle: &u32| {
        let material = draft.face_materials.get(faces[*triangle as usize] as usize);
        if (material as usize) < draft.materials.len() { material } else { NONE }
    };
    if !draft.face_materials.is_empty() {
        order.sort_by_key(material);
        let mut start = 0;
        for part in order.chunk_by(|a, b| material(a) == material(b)) {
            let end = start + part.len() as u32;
            if material(&part[0]) != NONE {
                parts.push(MeshPart { triangles: start..end, material: material(&part[0]) });
            }
            start = end;
        }
    }
    order
}

struct Joiner<'a> {
    draft: &'a Draft,
    mesh: MeshData,
    /// The vertices at each position are a list: its head, and what follows each vertex.
    first: Vec<u32>,
    next: Vec<u32>,
    /// Vertices that are in no list.
    others: HashMap<(u32, Look), u32>,
    has_texture: bool,
}

/// What tells vertices of one position apart, as bits.
type Look = ([u32; 3], Option<[u32; 4]>, Option<[u32; 2]>);

impl Joiner<'_> {
    /// The vertex of a corner: one that there is, or a new one.
    fn vertex(
        &mut self,
        corner: u32,
        positions: &[Vec3],
        position: u32,
        welded: &[u32],
        normal: Vec3,
    ) -> u32 {
        let colour = self.draft.colours.get(position as usize);
        let colour = colour.map(|colour| if colour[0].is_nan() { WHITE } else { *colour });
        let texture = self.texture(corner);
        let look = look(normal, colour, texture);
        let head = welded[position as usize];
        let mut listed = 0;
        let mut vertex = self.first[head as usize];
        while vertex != NONE {
            if self.look(vertex) == look {
                return vertex;
            }
            listed += 1;
            vertex = self.next[vertex as usize];
        }
        let vertex = self.mesh.positions.len() as u32;
        if listed < MOST_LISTED {
            self.next.push(std::mem::replace(&mut self.first[head as usize], vertex));
        } else {
            let known = *self.others.entry((head, look)).or_insert(vertex);
            if known != vertex {
                return known;
            }
            self.next.push(NONE);
        }
        self.mesh.positions.push(positions[position as usize]);
        self.mesh.normals.push(normal);
        self.mesh.colours.extend(colour);
        self.mesh.texture_coordinates.extend(texture);
        vertex
    }

    fn look(&self, vertex: u32) -> Look {
        let (mesh, vertex) = (&self.mesh, vertex as usize);
        let (colour, texture) = (mesh.colours.get(vertex), mesh.texture_coordinates.get(vertex));
        look(mesh.normals[vertex], colour.copied(), texture.copied())
    }

    /// The texture coordinates of a corner, if any corner has some; (0, 0) where it has none that are finite.
    fn texture(&self, corner: u32) -> Option<Vec2> {
        let index = self.draft.corner_textures.get(corner as usize);
        let given = self.draft.texture_coordinates.get(index as usize).copied();
        self.has_texture.then(|| given.filter(|at| at.is_finite()).unwrap_or_default())
    }
}

fn look(normal: Vec3, colour: Option<[f32; 4]>, texture: Option<Vec2>) -> Look {
    let bits = |texture: Vec2| texture.to_array().map(f32::to_bits);
    (position_key(normal), colour.map(|colour| colour.map(f32::to_bits)), texture.map(bits))
}
