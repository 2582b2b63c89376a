//! Transforms of the nodes of a glTF document to its scene. Broken trees are refused: a node has at
//! most one parent.

use crate::mesh::error::MeshError;
use crate::mesh::gltf_buffers::broken;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf::json::mesh::Mesh;
use gltf::json::scene::Node;
use gltf::json::{Index, Root};
use lumiduct_base::mesh::WhyJoined;

/// A node that shows a mesh.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlacedMesh {
    /// The node, by its number in the document.
    pub(crate) node: usize,
    /// Its place among all nodes with meshes.
    pub(crate) order: usize,
    pub(crate) mesh: Index<Mesh>,
    pub(crate) to_scene: DAffine3,
    /// Why it does not share the triangles of its mesh, if it does not.
    pub(crate) joined: Option<WhyJoined>,
}

impl PlacedMesh {
    /// The node with triangles of its own.
    pub(crate) fn joined(self, why: WhyJoined) -> Self {
        Self { joined: Some(why), ..self }
    }
}

/// All nodes of the scene that show a mesh, parents before their children; a unit of the document has `unit_mm`.
pub(crate) fn placed_meshes(root: &Root, unit_mm: f64) -> Result<Vec<PlacedMesh>, MeshError> {
    let mut placed = Vec::new();
    for (number, node, to_scene) in placed_nodes(root)? {
        let Some(mesh) = node.mesh else { continue };
        if node.skin.is_some() {
            return Err(MeshError::Unsupported {
                what: "the glTF file has a mesh with a skin".into(),
                remedy: "apply the armature before exporting",
            });
        }
        if root.get(mesh).is_none() {
            return Err(broken("a node names a mesh that does not exist".into()));
        }
        let to_scene = DAffine3::from_scale(DVec3::splat(unit_mm)) * to_scene;
        let order = placed.len();
        placed.push(PlacedMesh { node: number, order, mesh, to_scene, joined: None });
    }
    Ok(placed)
}

/// All nodes of the scene with their numbers and their transforms to it.
fn placed_nodes(root: &Root) -> Result<Vec<(usize, &Node, DAffine3)>, MeshError> {
    let scene = match root.scene {
        Some(index) => root.get(index),
        None => root.scenes.first(),
    };
    let scene = scene.ok_or_else(|| broken("it has no scene".into()))?;
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Vec::new();
    // An explicit stack: a chain of nodes may overflow the thread's stack.
    let mut open: Vec<(Index<Node>, DAffine3)> =
        scene.nodes.iter().rev().map(|node| (*node, DAffine3::IDENTITY)).collect();
    while let Some((index, parent)) = open.pop() {
        let number = index.value();
        let node =
            root.get(index).ok_or_else(|| broken(format!("node {number} does not exist")))?;
        if std::mem::replace(&mut seen[number], true) {
            return Err(broken(format!("node {number} is its own ancestor or has two parents")));
        }
        let to_scene = parent
            * local_transform(node)
                .map_err(|problem| broken(format!("the transform of node {number} {problem}")))?;
        let children = node.children.iter().flatten().rev();
        open.extend(children.map(|child| (*child, to_scene)));
        placed.push((number, node, to_scene));
    }
    Ok(placed)
}

fn local_transform(node: &Node) -> Result<DAffine3, &'static str> {
    let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let transform = if let Some(m) = node.matrix {
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            return Err("is not affine");
        }
        let column = |i: usize| vector([m[i], m[i + 1], m[i + 2]]);
        DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(4), column(8)),
            translation: column(12),
        }
    } else {
        let rotation = DQuat::from_array(node.rotation.unwrap_or_default().0.map(f64::from));
        if !(rotation.is_finite() && rotation.length_squared() > 0.0) {
            return Err("has a rotation of no length");
        }
        let scale = vector(node.scale.unwrap_or([1.0; 3]));
        let rotation = DMat3::from_quat(rotation.normalize());
        DAffine3 {
            matrix3: rotation * DMat3::from_diagonal(scale),
            translation: vector(node.translation.unwrap_or_default()),
        }
    };
    let volume = transform.matrix3.determinant();
    if !transform.is_finite() || !volume.is_finite() {
        return Err("is not finite");
    }
    if volume == 0.0 { Err("makes everything flat") } else { Ok(transform) }
}

/// The matrix that transforms normals: the inverse transpose times the magnitude of the
/// determinant, which avoids a division.
pub(crate) fn cofactors(matrix: DMat3) -> DMat3 {
    let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * matrix.determinant().signum()
}
