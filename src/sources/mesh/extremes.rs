//! The vertices of a mesh that lie farthest out: all that it takes to bring it into a picture.

use super::MeshData;
use glam::Vec3;

/// Steps across each face of a cube whose lattice points are the directions.
const STEPS: i8 = 4;

impl MeshData {
    /// A vertex that lies farthest out in each of 98 directions, without repetitions; empty for an empty mesh.
    ///
    /// The box around them, seen from anywhere, is that around the mesh to within a few hundredths of its size, and exactly along the axes.
    pub fn extremes(&self) -> Vec<Vec3> {
        extremes(&self.positions)
    }
}

/// Those of some points that lie farthest out in each of 98 directions.
pub fn extremes(points: &[Vec3]) -> Vec<Vec3> {
    let half = STEPS / 2;
    let lattice = move || -half..=half;
    let on_surface = |direction: &Vec3| direction.abs().max_element() == f32::from(half);
    let directions: Vec<Vec3> = lattice()
        .flat_map(|x| lattice().flat_map(move |y| lattice().map(move |z| [x, y, z])))
        .map(|cell| Vec3::from(cell.map(f32::from)))
        .filter(on_surface)
        .collect();
    let mut farthest = vec![(f32::NEG_INFINITY, 0_usize); directions.len()];
    for (index, position) in points.iter().enumerate() {
        for (found, direction) in farthest.iter_mut().zip(&directions) {
            let along = position.dot(*direction);
            if along > found.0 {
                *found = (along, index);
            }
        }
    }
    let mut indices: Vec<usize> = farthest.into_iter().map(|(_, index)| index).collect();
    indices.sort_unstable();
    indices.dedup();
    indices.into_iter().filter_map(|index| points.get(index).copied()).collect()
}

#[cfg(test)]
mod tests {
    use crate::sources::procedural;
    use glam::Vec3;

    #[test]
    fn the_extremes_of_a_mesh_have_its_box() {
        let ball = procedural::sphere(2.0, 4);
        let extremes = ball.extremes();
        assert!((26..=98).contains(&extremes.len()), "{}", extremes.len());
        let box_of = |points: &[Vec3]| {
            points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), point| {
                (low.min(*point), high.max(*point))
            })
        };
        assert_eq!(Some(box_of(&extremes)), ball.bounds());
        assert!(crate::sources::MeshData::default().extremes().is_empty());
    }
}
