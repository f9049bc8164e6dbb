//! The scene of a glTF document: which meshes are where.

use std::collections::{BTreeSet, HashSet};

use glam::{DMat4, DQuat, DVec3, Quat, Vec3};
use gltf::json;

use super::File;
use super::material::Materials;
use super::primitive::{self, Placed};
use crate::sources::SourceError;
use crate::sources::mesh::draft::Draft;
use crate::sources::mesh::{counted, quoted};

/// Corners of all meshes together, where nodes share some: more than the file holds.
const MOST_CORNERS: usize = 1 << 26;

/// Adds what the scene shows to the draft; what it has and is not used to `unused`.
pub(super) fn read(
    file: &File<'_>,
    draft: &mut Draft,
    unused: &mut BTreeSet<String>,
) -> Result<(), SourceError> {
    let mut seen = HashSet::new();
    let mut materials = Materials::new(file);
    let mut nodes: Vec<(usize, DMat4)> =
        roots(file.root).into_iter().rev().map(|node| (node, DMat4::IDENTITY)).collect();
    while let Some((index, parent)) = nodes.pop() {
        // In a tree each node has one parent; one that comes again would come for ever.
        if !seen.insert(index) {
            unused.insert(format!("a second parent of node {index}"));
            continue;
        }
        let Some(node) = file.root.nodes.get(index) else {
            return Err(file.error("nodes", &format!("there is no node {index}")));
        };
        let placement = parent * local(node);
        if let Some(mesh) = node.mesh {
            add_mesh(file, mesh, node, placement, draft, &mut materials, unused)?;
        }
        let instances =
            node.extensions.as_ref().is_some_and(|all| all.others.contains_key("EXT_mesh_gpu_instancing"));
        if instances {
            unused.insert("instances of EXT_mesh_gpu_instancing".to_owned());
        }
        let children = node.children.iter().flatten().rev();
        nodes.extend(children.map(|child| (child.value(), placement)));
    }
    materials.finish(draft, unused);
    Ok(())
}

/// The nodes that a scene begins with: of the default scene, else the first one, else all that are no children.
fn roots(root: &json::Root) -> Vec<usize> {
    let default = root.scene.and_then(|scene| root.get(scene));
    match default.or(root.scenes.first()) {
        Some(scene) => scene.nodes.iter().map(json::Index::value).collect(),
        None => {
            let children = root.nodes.iter().filter_map(|node| node.children.as_ref()).flatten();
            let children: HashSet<usize> = children.map(json::Index::value).collect();
            (0..root.nodes.len()).filter(|node| !children.contains(node)).collect()
        }
    }
}

/// What a node does to what is in it.
fn local(node: &json::Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let scale = node.scale.map_or(Vec3::ONE, Vec3::from_array).as_dvec3();
    let rotation = node.rotation.map_or(Quat::IDENTITY, |rotation| Quat::from_array(rotation.0)).as_dquat();
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
    let translation = node.translation.map_or(Vec3::ZERO, Vec3::from_array).as_dvec3();
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}

fn add_mesh(
    file: &File<'_>,
    index: json::Index<json::Mesh>,
    node: &json::Node,
    placement: DMat4,
    draft: &mut Draft,
    materials: &mut Materials<'_>,
    unused: &mut BTreeSet<String>,
) -> Result<(), SourceError> {
    let place = format!("meshes[{}]", index.value());
    let mesh = file.root.get(index).ok_or_else(|| file.error(&place, "it is not there"))?;
    if node.skin.is_some() {
        unused.insert("skins: meshes are shown as they were modelled".to_owned());
    }
    let normals = placement.inverse().transpose();
    let is_mirrored = placement.determinant() < 0.0;
    for (number, primitive) in mesh.primitives.iter().enumerate() {
        let placed = Placed { placement, normals, is_mirrored };
        let place = format!("{place}.primitives[{number}]");
        primitive::add(file, primitive, &placed, draft, materials, unused)
            .map_err(|problem| file.error(&place, &problem))?;
        if draft.corners() > MOST_CORNERS {
            let found = format!(
                "more than {} once each node has its mesh",
                counted(MOST_CORNERS as u64 / 3, "triangle")
            );
            let mend = "export fewer nodes, or simpler meshes".to_owned();
            return Err(SourceError::Unsupported { path: file.path.to_owned(), found, mend });
        }
    }
    Ok(())
}

/// The extensions of a document's part, by name.
pub(super) fn names(others: &serde_json::Map<String, serde_json::Value>) -> impl Iterator<Item = String> {
    others.keys().map(|name| quoted(name))
}

/// A point moved by a matrix.
pub(super) fn moved(placement: &DMat4, point: [f32; 3]) -> DVec3 {
    placement.transform_point3(Vec3::from_array(point).as_dvec3())
}
