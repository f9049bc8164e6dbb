//! A draft -> a mesh: what is unusable dropped, faces cut up, triangles turned, normals made, equal vertices joined.

use super::creases::{Creases, Surface};
use super::draft::Draft;
use super::options::{CREASE_DEGREES, Normals};
use super::orient::{self, Facing};
use super::topology::Edges;
use super::{
    MeshData, MeshMaterial, MeshPart, join, normals, origin, triangulate::Cutter, weld::weld, words::counted,
};
use crate::sources::SourceError;
use glam::{DVec3, Vec3};
use std::collections::HashSet;
use std::path::Path;

/// More cannot be indexed by corner.
const MOST_TRIANGLES: usize = u32::MAX as usize / 3;

/// A mesh in the making. Triangles are of *corners*, which have a place in the draft's faces each.
pub(super) struct Finisher<'a> {
    draft: &'a Draft,
    origin: DVec3,
    /// Of each position of the draft, relative to the origin.
    positions: Vec<Vec3>,
    /// Three corners each.
    triangles: Vec<[u32; 3]>,
    /// The face that each is of.
    faces: Vec<u32>,
    notes: Vec<String>,
}

impl Draft {
    /// Makes a mesh of it, which may be empty.
    ///
    /// # Errors
    ///
    /// If 32-bit indices do not reach its triangles.
    pub fn finish(mut self, path: &Path, rule: Normals) -> Result<MeshData, SourceError> {
        if self.corners.len() / 3 > MOST_TRIANGLES {
            return Err(SourceError::TooManyTriangles {
                path: path.to_owned(),
                limit: MOST_TRIANGLES as u64,
            });
        }
        let origin = origin::origin_of(&self.positions, &self.corners);
        let mut mesh = Finisher::new(&self, origin).finish(rule);
        let mut notes = std::mem::take(&mut self.notes);
        notes.append(&mut mesh.notes);
        notes.extend(note_on_opacity(&self.materials, &mesh.parts));
        mesh.notes = notes;
        mesh.materials = if mesh.parts.is_empty() { Vec::new() } else { self.materials };
        Ok(mesh)
    }
}

/// Meshes are drawn as opaque, whatever their files say.
fn note_on_opacity(materials: &[MeshMaterial], parts: &[MeshPart]) -> Option<String> {
    let used = parts.iter().filter_map(|part| materials.get(part.material as usize));
    let mut clear = used.filter(|material| material.opacity < 1.0);
    let first = clear.next()?;
    let others = match clear.count() {
        0 => String::new(),
        more => format!(" and those of {}", counted(more as u64, "other material")),
    };
    Some(format!(
        "the opacity of material `{}`, {},{others} is ignored: meshes hide what is behind them",
        first.name, first.opacity
    ))
}

impl<'a> Finisher<'a> {
    /// Begins with what there is, and drops what is unusable.
    pub fn new(draft: &'a Draft, origin: DVec3) -> Self {
        let positions = draft.positions.iter().map(|position| (*position - origin).as_vec3()).collect();
        let mut finisher =
            Self { draft, origin, positions, triangles: Vec::new(), faces: Vec::new(), notes: Vec::new() };
        finisher.cut_faces();
        finisher.drop_flat_triangles();
        finisher
    }

    fn position(&self, corner: u32) -> Option<Vec3> {
        let position = *self.draft.corners.get(corner as usize)?;
        self.positions.get(position as usize).copied()
    }

    /// Cuts the faces up; those with a corner that is missing or not finite are left out, with a note.
    fn cut_faces(&mut self) {
        let draft = self.draft;
        self.triangles.reserve_exact(draft.corners.len() / 3);
        let (mut missing, mut not_finite, mut crossing) = (0, 0, 0);
        let (mut cutter, mut corners, mut cut) = (Cutter::default(), Vec::new(), Vec::new());
        for (face, (start, count)) in draft.spans().enumerate() {
            let of_face = start as u32..(start + count) as u32;
            corners.clear();
            corners.extend(of_face.clone().map_while(|corner| self.position(corner)));
            if corners.len() < count {
                missing += 1;
            } else if !corners.iter().all(|corner| corner.is_finite()) {
                not_finite += 1;
            } else if count == 3 {
                self.triangles.push([0, 1, 2].map(|corner| of_face.start + corner));
                self.faces.push(face as u32);
            } else {
                cut.clear();
                crossing += u64::from(!cutter.cut(&corners, &mut cut));
                self.triangles
                    .extend(cut.iter().map(|triangle| triangle.map(|corner| of_face.start + corner as u32)));
                self.faces.resize(self.triangles.len(), face as u32);
            }
        }
        self.tell(missing, |faces| format!("{faces} with a missing vertex dropped"));
        if not_finite > 0 {
            self.tell_not_finite(not_finite);
        }
        self.tell(crossing, |faces| {
            format!("{faces} that cross or touch themselves, cut up as well as can be")
        });
    }

    fn tell(&mut self, count: u64, note: impl Fn(String) -> String) {
        if count > 0 {
            let noun = if self.draft.is_of_triangles() { "triangle" } else { "face" };
            self.notes.push(note(counted(count, noun)));
        }
    }

    fn tell_not_finite(&mut self, faces: u64) {
        if self.draft.is_of_triangles() {
            self.tell(faces, |faces| format!("{faces} with a NaN or infinite coordinate dropped"));
            return;
        }
        let used: HashSet<_> =
            (0..self.draft.corners.len() as u32).map(|corner| self.vertex_of(corner)).collect();
        let is_unfit = |(position, _): &&(u32, u32)| {
            self.positions.get(*position as usize).is_none_or(|position| !position.is_finite())
        };
        let unfit = used.iter().filter(is_unfit).count();
        let used = counted(used.len() as u64, "used vertex");
        self.tell(faces, |faces| {
            format!("{unfit} of {used} with a NaN or infinite coordinate; {faces} dropped")
        });
    }

    /// Leaves out triangles without an area.
    fn drop_flat_triangles(&mut self) {
        let (mut flat, mut too_small) = (0, 0);
        let mut kept = 0;
        for index in 0..self.triangles.len() {
            let triangle = self.triangles[index];
            let [a, b, c] = triangle.map(|corner| self.position(corner).unwrap_or_default());
            if normals::facing(a, b, c).is_some() {
                self.triangles[kept] = triangle;
                self.faces[kept] = self.faces[index];
                kept += 1;
                continue;
            }
            let [a, b, c] =
                triangle.map(|corner| self.draft.positions[self.draft.corners[corner as usize] as usize]);
            let had_area = (b - a).cross(c - a).length() > 1e-12 * (b - a).length() * (c - a).length();
            *(if had_area { &mut too_small } else { &mut flat }) += 1;
        }
        self.triangles.truncate(kept);
        self.faces.truncate(kept);
        if flat > 0 {
            self.notes.push(format!("{} dropped", counted(flat, "zero-area triangle")));
        }
        if too_small > 0 {
            let triangles = counted(too_small, "triangle");
            self.notes
                .push(format!("{triangles} dropped: too small for 32-bit numbers in a mesh of this extent"));
        }
    }

    /// Turns triangles, makes normals and joins vertices.
    fn finish(mut self, rule: Normals) -> MeshData {
        let welded = weld(&self.positions);
        let mut vertices = self.vertices(&welded);
        let edges = Edges::of(&vertices, self.positions.len());
        let partners = edges.partners(vertices.len());
        let turned = {
            let facing = Facing {
                positions: &self.positions,
                triangles: &vertices,
                agreement: &|triangle| self.agreement(triangle),
            };
            orient::orient(&facing, &edges, &partners)
        };
        self.notes.extend(turned.notes);
        let mut edges = edges;
        if !turned.triangles.is_empty() {
            for (triangle, _) in
                self.triangles.iter_mut().zip(&turned.triangles).filter(|(_, turned)| **turned)
            {
                triangle.swap(1, 2);
            }
            vertices = self.vertices(&welded);
            edges = Edges::of(&vertices, self.positions.len());
        }
        let normals = self.normals(rule, &vertices, &edges, &turned.normals);
        let mut mesh =
            join::join(self.draft, &self.positions, &welded, &self.triangles, &self.faces, &normals);
        mesh.origin = self.origin;
        mesh.notes = self.notes;
        mesh
    }

    /// Keeps how triangles face and the normals that there are; where none is, all triangles that meet at the position have their part.
    pub fn finish_as_given(mut self) -> MeshData {
        let welded = weld(&self.positions);
        let computed = normals::angle_weighted(&self.positions, &self.vertices(&welded));
        let given: Vec<_> =
            self.triangles.iter().flatten().map(|&corner| self.given_normal(corner)).collect();
        self.tell_computed(&given);
        let corners = self.triangles.iter().flatten().zip(given);
        let normals: Vec<Vec3> = corners
            .map(|(&corner, given)| {
                given.unwrap_or_else(|| {
                    computed[welded[self.draft.corners[corner as usize] as usize] as usize]
                })
            })
            .collect();
        let mut mesh =
            join::join(self.draft, &self.positions, &welded, &self.triangles, &self.faces, &normals);
        mesh.notes = self.notes;
        mesh
    }

    /// The triangles by position, one for those that are equal.
    fn vertices(&self, welded: &[u32]) -> Vec<[u32; 3]> {
        let of_corner = |corner: u32| welded[self.draft.corners[corner as usize] as usize];
        self.triangles.iter().map(|triangle| triangle.map(of_corner)).collect()
    }

    /// The normal that the file gives to a corner, if it has a direction.
    fn given_normal(&self, corner: u32) -> Option<Vec3> {
        let index = self.draft.corner_normals.get(corner as usize);
        normals::unit(self.draft.normals.get(index as usize)?.as_dvec3())
    }

    /// See [`Facing::agreement`].
    fn agreement(&self, triangle: usize) -> Option<f64> {
        if self.draft.corner_normals.is_empty() {
            return None;
        }
        let corners = self.triangles[triangle];
        let [a, b, c] = corners.map(|corner| self.position(corner).unwrap_or_default());
        let facing = normals::facing(a, b, c)?;
        let mut sum = 0.0;
        for corner in corners {
            sum += self.given_normal(corner)?.as_dvec3().dot(facing) / 3.0;
        }
        Some(sum)
    }

    /// One normal for each corner of each triangle, where `turned` are those whose given normals point backwards.
    fn normals(&mut self, rule: Normals, vertices: &[[u32; 3]], edges: &Edges, turned: &[bool]) -> Vec<Vec3> {
        let surface = Surface { positions: &self.positions, triangles: vertices, edges };
        let groups =
            Creases::Groups { groups: &self.draft.groups, faces: &self.faces, otherwise: CREASE_DEGREES };
        match rule {
            Normals::Flat => surface.flat_normals(),
            Normals::Smooth(degrees) => surface.normals(Creases::Angle(degrees)),
            Normals::Auto if self.draft.corner_normals.is_empty() => surface.normals(groups),
            Normals::Auto => {
                let mut given = Vec::with_capacity(3 * self.triangles.len());
                for (index, triangle) in self.triangles.iter().enumerate() {
                    let sign = if turned.get(index) == Some(&true) { -1.0 } else { 1.0 };
                    given
                        .extend(triangle.map(|corner| self.given_normal(corner).map(|normal| normal * sign)));
                }
                if given.contains(&None) {
                    let computed = surface.normals(groups);
                    self.tell_computed(&given);
                    given
                        .into_iter()
                        .zip(computed)
                        .map(|(given, computed)| given.unwrap_or(computed))
                        .collect()
                } else {
                    given.into_iter().flatten().collect()
                }
            }
        }
    }

    /// What the file calls a vertex: an index of a position and one of a normal.
    fn vertex_of(&self, corner: u32) -> (u32, u32) {
        (self.draft.corners[corner as usize], self.draft.corner_normals.get(corner as usize))
    }

    /// Says how many vertices had no usable normal; a mesh without any normals is an ordinary one.
    fn tell_computed(&mut self, given: &[Option<Vec3>]) {
        let corners = self.triangles.iter().flatten();
        let used: HashSet<_> = corners.clone().map(|&corner| self.vertex_of(corner)).collect();
        let without = corners.zip(given).filter(|(_, given)| given.is_none());
        let missing: HashSet<_> = without.map(|(corner, _)| self.vertex_of(*corner)).collect();
        if !missing.is_empty() && missing.len() < used.len() {
            self.notes.push(format!(
                "normals of {} of {} vertices computed (angle-weighted): missing, zero or not finite",
                missing.len(),
                used.len()
            ));
        }
    }
}
