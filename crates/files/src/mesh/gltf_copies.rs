//! Which nodes of a glTF document show copies that share the triangles of a mesh: a file of a megabyte can ask for any amount of
//! memory.
//!
//! Many nodes of one mesh share it if it is closed by itself and they turn, scale and move it only. Copies that may touch something
//! else, by their boxes, are left to be joined with it vertex by vertex, as all other nodes are.

use crate::mesh::error::{MAX_COPIES_BYTES, MeshError};
use crate::mesh::gltf_buffers::{Buffers, broken};
use crate::mesh::gltf_nodes::PlacedMesh;
use glam::{DAffine3, DMat3, DVec3};
use gltf::json::Root;
use gltf::json::accessor::Type;
use gltf::json::mesh::{Mesh, Primitive, Semantic};
use gltf::json::validation::Checked;
use lumiduct_base::math::Aabb;
use lumiduct_base::mesh::{
    CopiedBody, MAX_COORDINATE_MM, MAX_SHOWN_TRIANGLES, MAX_TRIANGLES, TRIANGLE_BYTES,
    TriangleMesh, UnusableMesh, WhyJoined,
};
use std::collections::{BTreeMap, HashMap};

/// Copies with fewer triangles than this, beyond those of the mesh itself, are joined: one tree over all is searched faster.
const LEAST_SHARED: u64 = 50_000;
/// Lengths and angles of a place may be off by this, 1: rounding of a matrix in f32.
const UNDISTORTED: f64 = 1e-5;
/// Largest magnitude accepted in a transform, mm or 1.
const HUGE: f64 = 1e15;
/// A copy smaller than this share of the largest copy of its mesh is joined, 1: one tree serves all.
const LEAST_SCALE: f64 = 1e-3;
/// Most pairs of boxes that are compared; copies that are still open then are joined.
const MOST_COMPARED: usize = 200_000_000;

/// Nodes that share the triangles of a mesh.
pub(crate) struct Copies {
    /// Whether these nodes show the mirror image of the mesh in x.
    pub(crate) is_mirrored: bool,
    pub(crate) nodes: Vec<PlacedMesh>,
}

/// Number of triangles of each mesh of a document that is shown; 0 for all others.
pub(crate) fn triangle_counts(
    root: &Root,
    buffers: &Buffers<'_>,
    placed: &[PlacedMesh],
) -> Result<Vec<u64>, MeshError> {
    let mut is_shown = vec![false; root.meshes.len()];
    placed.iter().for_each(|own| is_shown[own.mesh.value()] = true);
    let of = |(mesh, is_shown): (&Mesh, bool)| {
        let shown = mesh.primitives.iter().filter(|_| is_shown);
        let counts = shown.map(|primitive| corner_count(buffers, primitive));
        counts.sum::<Result<usize, MeshError>>().map(|corners| corners as u64 / 3)
    };
    root.meshes.iter().zip(is_shown).map(of).collect()
}

/// Number of corners of a primitive: of its indices, or of its positions where it has none.
fn corner_count(buffers: &Buffers<'_>, primitive: &Primitive) -> Result<usize, MeshError> {
    let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
    let counted = match (primitive.indices, positions) {
        (Some(indices), _) => buffers.elements(indices, Type::Scalar)?,
        (None, Some(positions)) => buffers.elements(*positions, Type::Vec3)?,
        (None, None) => return Ok(0),
    };
    Ok(counted.0.count())
}

/// Refuses two nodes that show a mesh at the same place, and copies of more triangles than can be numbered.
pub(crate) fn refuse_impossible_copies(
    placed: &[PlacedMesh],
    counts: &[u64],
) -> Result<(), MeshError> {
    let mut known: HashMap<(usize, [u64; 12]), usize> = HashMap::new();
    let mut triangles = 0_u64;
    for &PlacedMesh { node, mesh, to_scene, .. } in placed {
        triangles = triangles.saturating_add(counts[mesh.value()]);
        let place = (to_scene.to_cols_array()).map(|number| (number + 0.0).to_bits());
        if let Some(first) = known.insert((mesh.value(), place), node) {
            return Err(MeshError::Unsupported {
                what: format!(
                    "nodes {first} and {node} of the glTF file show a mesh at the same place"
                ),
                remedy: "delete one of them",
            });
        }
    }
    if triangles > MAX_SHOWN_TRIANGLES {
        return Err(MeshError::TooManyShown { nodes: placed.len(), triangles });
    }
    Ok(())
}

/// Refuses nodes whose copies of meshes take more than [`MAX_COPIES_BYTES`], before any is made.
pub(crate) fn refuse_large_copies(placed: &[PlacedMesh], counts: &[u64]) -> Result<(), MeshError> {
    let [_, bytes_of_triangle] = TRIANGLE_BYTES;
    let mut is_known = vec![false; counts.len()];
    let (mut nodes, mut triangles, mut bytes) = (0, 0_u64, 0_u64);
    for PlacedMesh { mesh, .. } in placed {
        let count = counts[mesh.value()];
        (nodes, triangles) = (nodes + 1, triangles.saturating_add(count));
        if std::mem::replace(&mut is_known[mesh.value()], true) {
            bytes = bytes.saturating_add(count.saturating_mul(bytes_of_triangle));
        }
    }
    if bytes > MAX_COPIES_BYTES {
        return Err(MeshError::TooManyCopies { nodes, triangles, bytes });
    }
    Ok(())
}

/// Refuses more triangles than a mesh may have, those of a group of copies counted once.
pub(crate) fn refuse_large_meshes(
    groups: &[Copies],
    others: &[PlacedMesh],
    counts: &[u64],
) -> Result<(), MeshError> {
    let first = groups.iter().filter_map(|copies| copies.nodes.first());
    let stored = first.chain(others).map(|own| counts[own.mesh.value()]);
    if stored.fold(0, u64::saturating_add) > MAX_TRIANGLES as u64 {
        return Err(UnusableMesh::TooManyTriangles.into());
    }
    Ok(())
}

/// Nodes that may share a mesh, and all others.
pub(crate) fn grouped(placed: Vec<PlacedMesh>, counts: &[u64]) -> (Vec<Copies>, Vec<PlacedMesh>) {
    let (similar, distorted): (Vec<_>, Vec<_>) =
        placed.into_iter().partition(|own| is_undistorted(own.to_scene.matrix3));
    let mut others: Vec<PlacedMesh> = joined(distorted, WhyJoined::Distorted).collect();
    let mut groups: BTreeMap<(usize, bool), Vec<PlacedMesh>> = BTreeMap::new();
    for own in similar {
        let is_mirrored = own.to_scene.matrix3.determinant() < 0.0;
        groups.entry((own.mesh.value(), is_mirrored)).or_default().push(own);
    }
    let mut shared = Vec::new();
    for ((mesh, is_mirrored), nodes) in groups {
        let scale = |own: &PlacedMesh| own.to_scene.matrix3.determinant().abs().cbrt();
        let least = LEAST_SCALE * nodes.iter().map(scale).fold(0.0, f64::max);
        let (nodes, tiny): (Vec<_>, Vec<_>) =
            nodes.into_iter().partition(|own| scale(own) >= least);
        others.extend(joined(tiny, WhyJoined::Tiny));
        let more = nodes.len() as u64 - 1;
        if more.saturating_mul(counts[mesh]) < LEAST_SHARED {
            others.extend(joined(nodes, WhyJoined::Few));
        } else {
            shared.push(Copies { is_mirrored, nodes });
        }
    }
    others.sort_by_key(|own| own.order);
    (shared, others)
}

/// Nodes with triangles of their own.
pub(crate) fn joined(nodes: Vec<PlacedMesh>, why: WhyJoined) -> impl Iterator<Item = PlacedMesh> {
    nodes.into_iter().map(move |own| own.joined(why))
}

/// How many nodes have triangles of their own though others show the same mesh, and why.
pub(crate) fn reasons(nodes: &[PlacedMesh], shown: &[usize]) -> BTreeMap<WhyJoined, usize> {
    let mut counts = BTreeMap::new();
    for own in nodes.iter().filter(|own| shown[own.mesh.value()] > 1) {
        let Some(why) = own.joined else { continue };
        *counts.entry(why).or_default() += 1;
    }
    counts
}

fn is_undistorted(matrix: DMat3) -> bool {
    let square = matrix.determinant().abs().cbrt().powi(2);
    let products = matrix.transpose() * matrix;
    let off = (products - DMat3::from_diagonal(DVec3::splat(square))).to_cols_array();
    square.is_normal() && off.iter().all(|own| own.abs() <= UNDISTORTED * square)
}

/// The mirror image in x.
pub(crate) fn mirror() -> DAffine3 {
    DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0))
}

/// The copies of a body; none beyond the largest coordinate of a mesh.
pub(crate) fn copied(copies: &Copies, body: TriangleMesh) -> Result<CopiedBody, MeshError> {
    let turn = if copies.is_mirrored { mirror() } else { DAffine3::IDENTITY };
    let places = copies.nodes.iter().map(|own| own.to_scene * turn).collect();
    let copied = CopiedBody { body, places };
    for (bounds, PlacedMesh { node, to_scene, .. }) in copied.boxes().zip(&copies.nodes) {
        // Larger numbers might overflow to a box without coordinates.
        let is_huge = to_scene.to_cols_array().iter().any(|own| own.abs() > HUGE);
        if is_huge || bounds.largest_coordinate() > MAX_COORDINATE_MM {
            let kilometres = MAX_COORDINATE_MM / 1e6;
            return Err(broken(format!("node {node} puts its mesh beyond {kilometres} km")));
        }
    }
    Ok(copied)
}

/// For each of some copies, by their boxes, whether it may touch another one or have a vertex in common with the other triangles of the file.
pub(crate) fn touching(boxes: &[Aabb], vertices: &[DVec3]) -> Vec<bool> {
    let middles = Aabb::of(boxes.iter().map(Aabb::center));
    // Along this axis they lie farthest apart.
    let axis = (middles.max - middles.min).max_position();
    let mut vertices: Vec<DVec3> = vertices.to_vec();
    vertices.sort_by(|one, other| one[axis].total_cmp(&other[axis]));
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|one, other| boxes[*one].min[axis].total_cmp(&boxes[*other].min[axis]));
    let mut found = vec![false; boxes.len()];
    let mut compared = 0;
    for (rank, &one) in order.iter().enumerate() {
        let own = &boxes[one];
        let first = vertices.partition_point(|vertex| vertex[axis] < own.min[axis]);
        let near = vertices[first..].iter().take_while(|vertex| vertex[axis] <= own.max[axis]);
        found[one] |= near.inspect(|_| compared += 1).any(|vertex| own.contains(*vertex));
        for &other in &order[rank + 1..] {
            if boxes[other].min[axis] > own.max[axis] {
                break;
            }
            compared += 1;
            if own.overlaps(&boxes[other]) {
                (found[one], found[other]) = (true, true);
            }
        }
        if compared > MOST_COMPARED {
            order[rank + 1..].iter().for_each(|open| found[*open] = true);
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::format::LengthUnit;
    use crate::mesh::from_gltf::read;
    use crate::mesh::samples::{glb, gltf_parts};
    use lumiduct_base::mesh::MeshAssembly;
    use lumiduct_base::mesh::bodies::{Normals, rod};
    use serde_json::{Value, json};
    use std::path::Path;

    /// Enough copies of the rod of the tests, 96 triangles, to be shared.
    const MANY: usize = LEAST_SHARED as usize / 96 + 2;

    /// Rods of radius 2 mm and length 40 mm as these nodes.
    fn rods(nodes: Vec<Value>) -> Result<MeshAssembly, MeshError> {
        let (mut json, blob) = gltf_parts(&rod(2.0, 40.0, 24, Normals::Smooth));
        json["scenes"][0]["nodes"] = (0..nodes.len()).collect();
        json["nodes"] = nodes.into();
        read(&glb(&json, &blob), Path::new(""), LengthUnit::Millimetre)
    }

    fn row(count: usize, spacing: f64) -> Vec<Value> {
        (0..count)
            .map(|node| json!({ "mesh": 0, "translation": [spacing * node as f64, 0, 0] }))
            .collect()
    }

    #[test]
    fn many_copies_share_their_triangles_and_few_are_joined() {
        let few = rods(row(20, 5.0)).unwrap();
        assert_eq!((few.mesh.triangles.len(), few.copied.len()), (20 * 96, 0));
        assert_eq!(few.joined, BTreeMap::from([(WhyJoined::Few, 20)]));
        let many = rods(row(MANY, 5.0)).unwrap();
        assert_eq!((many.mesh.triangles.len(), many.copied.len()), (0, 1));
        assert_eq!(many.copied[0].places.len(), MANY);
        let [few, many] = [few, many].map(|assembly| assembly.health());
        assert!(many.is_sound() && many.shells == MANY && few.shells == 20);
        let ratio = many.signed_volume_mm3 / few.signed_volume_mm3;
        assert!((ratio / (MANY as f64 / 20.0) - 1.0).abs() < 1e-9, "{ratio}");
    }

    #[test]
    fn copies_that_touch_are_joined_vertex_by_vertex() {
        let mut nodes = row(MANY, 5.0);
        // Far from all others, and far too small for their tree.
        nodes.push(json!({ "mesh": 0, "translation": [0, 90, 0], "scale": [1e-4, 1e-4, 1e-4] }));
        // End to end with the first, and one whose end is within the second.
        nodes.push(json!({ "mesh": 0, "translation": [0, 0, 40] }));
        nodes.push(json!({ "mesh": 0, "translation": [5, 0, 10] }));
        let assembly = rods(nodes).unwrap();
        assert_eq!(assembly.mesh.triangles.len(), 5 * 96);
        assert_eq!(
            assembly.joined,
            BTreeMap::from([(WhyJoined::Touching, 4), (WhyJoined::Tiny, 1)])
        );
        assert_eq!(assembly.copied[0].places.len(), MANY - 2);
        assert!(assembly.health().crowded_edges.count > 0, "ends that are joined face each other");
    }

    #[test]
    fn mirror_images_are_shared_and_distorted_ones_joined() {
        let mut nodes = row(MANY, 5.0);
        for node in row(MANY, 5.0) {
            let at = &node["translation"][0];
            nodes.push(json!({ "mesh": 0, "translation": [at, 9, 0], "scale": [-1, 1, 1] }));
        }
        nodes.push(json!({ "mesh": 0, "translation": [0, -9, 0], "scale": [1, 1.5, 1] }));
        let assembly = rods(nodes).unwrap();
        assert_eq!(assembly.mesh.triangles.len(), 96);
        assert_eq!(assembly.joined, BTreeMap::from([(WhyJoined::Distorted, 1)]));
        assert_eq!(assembly.copied.len(), 2);
        let volume = |assembly: &MeshAssembly| assembly.health().signed_volume_mm3;
        let (all, one) = (volume(&assembly), volume(&rods(row(1, 0.0)).unwrap()));
        assert!((all / one / (2.0 * MANY as f64 + 1.5) - 1.0).abs() < 1e-9, "{all} {one}");
    }

    #[test]
    fn open_meshes_are_never_shared() {
        let (mut json, blob) = gltf_parts(&rod(2.0, 40.0, 24, Normals::Smooth));
        // Without the face at one end.
        json["meshes"][0]["primitives"].as_array_mut().unwrap().pop();
        json["scenes"][0]["nodes"] = (0..2 * MANY).collect();
        json["nodes"] = row(2 * MANY, 5.0).into();
        let read = read(&glb(&json, &blob), Path::new(""), LengthUnit::Millimetre).unwrap();
        assert_eq!((read.mesh.triangles.len(), read.copied.len()), (2 * MANY * 72, 0));
        assert_eq!(read.joined, BTreeMap::from([(WhyJoined::Open, 2 * MANY)]));
    }

    #[test]
    fn copies_that_cannot_be_shared_are_counted_before_they_are_made() {
        let most = (MAX_COPIES_BYTES / (TRIANGLE_BYTES[1] * 96)) as usize;
        let error = rods(row(most + 2, 1.0)).unwrap_err();
        assert!(matches!(error, MeshError::TooManyCopies { .. }), "{error}");
        for words in ["export fewer copies", "about 1024 MiB", "copies may take 1024 MiB"] {
            assert!(error.to_string().contains(words), "{error}");
        }
    }

    #[test]
    fn impossible_copies_are_refused() {
        let twice = vec![json!({ "mesh": 0 }), json!({ "mesh": 0, "translation": [-0.0, 0, 0] })];
        let error = rods(twice).unwrap_err().to_string();
        assert!(
            error.contains("nodes 0 and 1 of the glTF file show a mesh at the same place"),
            "{error}"
        );
        let error = rods(row(MANY, 1e7)).unwrap_err().to_string();
        assert!(error.contains("puts its mesh beyond 1000 km"), "{error}");
        let place = |node: usize| PlacedMesh {
            node,
            order: node,
            mesh: gltf::json::Index::new(0),
            to_scene: DAffine3::from_translation(DVec3::X * node as f64),
            joined: None,
        };
        let placed: Vec<PlacedMesh> = (0..1000).map(place).collect();
        // Half a million triangles each, shared or not.
        let large = [MAX_TRIANGLES as u64 / 100 + 1];
        let group =
            |node| Copies { is_mirrored: false, nodes: vec![place(node), place(node + 100)] };
        let groups: Vec<Copies> = (0..60).map(group).collect();
        assert!(refuse_large_meshes(&groups, &placed[..40], &large).is_err());
        assert!(refuse_large_meshes(&groups, &placed[..39], &large).is_ok());
        let error =
            refuse_impossible_copies(&placed, &[MAX_SHOWN_TRIANGLES / 1000 + 1]).unwrap_err();
        assert!(matches!(error, MeshError::TooManyShown { nodes: 1000, .. }), "{error}");
    }

    #[test]
    fn boxes_are_compared_with_each_other_and_with_vertices() {
        let at = |x: f64, y: f64| {
            let min = DVec3::new(x, y, 0.0);
            Aabb { min, max: min + 1.0 }
        };
        let boxes = [at(0.0, 0.0), at(5.0, 0.0), at(6.0, 0.5), at(9.0, 9.0), at(0.0, 4.0)];
        assert_eq!(touching(&boxes, &[]), [false, true, true, false, false]);
        let vertices = [DVec3::new(9.0, 10.0, 1.0), DVec3::new(0.5, 0.5, 1.5)];
        assert_eq!(touching(&boxes, &vertices), [false, true, true, true, false]);
    }
}
