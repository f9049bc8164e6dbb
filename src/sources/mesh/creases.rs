//! Normals of corners, with hard edges where faces meet at more than an angle or belong to different smoothing groups.

use super::{assemble::weld, normals};
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::{DVec3, Vec3};

/// How the normals of a mesh come about.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, PartialEq)]
pub enum Normals {
    /// Those of the file; where it has none, by its smoothing groups; where it has none of those either, `Smooth(40.0)`.
    #[default]
    Auto,
    /// Those of the faces, whatever the file says.
    Flat,
    /// Means over the faces that meet at no more than this angle, in degrees, whatever the file says; 180 rounds every edge.
    Smooth(#[reflect(@crate::components::Range::new(0.0, 180.0), @crate::components::Unit("degrees"))] f32),
}

/// The angle, in degrees, beyond which edges are hard where nobody says otherwise.
pub const CREASE_DEGREES: f32 = 40.0;

/// Faces around a point among which hard edges are looked for; around more all are smooth, since each is compared with each.
const MOST_FACES: usize = 512;

/// Which faces around a point are smoothed together.
#[derive(Clone, Copy)]
pub(super) enum Rule<'a> {
    /// Those that meet at no more than this angle, in degrees.
    Crease(f32),
    /// Those of the same group, of which there is one for each triangle; 0 stands for none.
    Groups(&'a [u32]),
}

impl Rule<'_> {
    fn joins(&self, facing: &[DVec3], one: usize, other: usize) -> bool {
        match *self {
            Self::Crease(degrees) => {
                let cosine = f64::from(degrees).to_radians().cos();
                one == other || facing[one].dot(facing[other]) >= cosine - 1e-6
            }
            Self::Groups(groups) => one == other || groups[one] == groups[other] && groups[one] != 0,
        }
    }
}

/// One normal for each corner of each triangle: angle-weighted over the faces that are smoothed together.
pub(super) fn corner_normals(positions: &[Vec3], triangles: &[[u32; 3]], rule: Rule) -> Vec<[Vec3; 3]> {
    let welded = weld(positions);
    let facing: Vec<DVec3> = triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|index| positions[index as usize]);
            normals::facing(a, b, c).unwrap_or(DVec3::ZERO)
        })
        .collect();
    // The corners at each point, one run after the other.
    let mut corners: Vec<(u32, u32, u8)> = triangles
        .iter()
        .zip(0_u32..)
        .flat_map(|(triangle, index)| {
            (0..3_u8).map(move |corner| (triangle[usize::from(corner)], index, corner))
        })
        .map(|(vertex, triangle, corner)| (welded[vertex as usize], triangle, corner))
        .collect();
    corners.sort_unstable();
    let mut computed = vec![[normals::FALLBACK; 3]; triangles.len()];
    for around in corners.chunk_by(|a, b| a.0 == b.0) {
        let weighted: Vec<(usize, DVec3)> = around
            .iter()
            .map(|&(_, triangle, corner)| {
                let index = triangle as usize;
                let corners = triangles[index].map(|vertex| positions[vertex as usize]);
                let at = |step: usize| corners[(usize::from(corner) + step) % 3];
                (index, normals::angle_at(at(0), at(1), at(2)) * facing[index])
            })
            .collect();
        for &(_, triangle, corner) in around {
            let own = triangle as usize;
            let joined = weighted
                .iter()
                .filter(|(other, _)| around.len() > MOST_FACES || rule.joins(&facing, own, *other))
                .map(|(_, normal)| *normal)
                .sum::<DVec3>();
            computed[own][usize::from(corner)] =
                normals::unit(joined).or(normals::unit(facing[own])).unwrap_or(normals::FALLBACK);
        }
    }
    computed
}
