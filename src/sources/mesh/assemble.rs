//! Any positions, normals and triangles -> a clean mesh.

use glam::{DVec3, Vec3};

use super::draft::{Corner, Draft, NONE};
use super::{MeshData, finish::Finisher};

/// See [`MeshData::from_triangles`].
pub(super) fn assemble(positions: &[Vec3], normals: &[Vec3], triangles: &[[u32; 3]]) -> MeshData {
    let mut draft = Draft {
        positions: positions.iter().map(|position| position.as_dvec3()).collect(),
        normals: normals.to_vec(),
        ..Draft::default()
    };
    for triangle in triangles {
        let corner = |position| {
            let normal = if (position as usize) < normals.len() { position } else { NONE };
            Corner { normal, ..Corner::at(position) }
        };
        draft.push_face(&triangle.map(corner), NONE, NONE);
    }
    Finisher::new(&draft, DVec3::ZERO).finish_as_given()
}
