//! How much the nodes of a glTF document repeat its meshes: a file of a megabyte can ask for any amount of memory.

use crate::mesh::error::{MAX_COPIES_BYTES, MeshError, TRIANGLE_BYTES};
use crate::mesh::gltf_buffers::Buffers;
use gltf::json::accessor::Type;
use gltf::json::mesh::{Mesh, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};

/// Refuses copies of meshes that take more than [`MAX_COPIES_BYTES`], before any is made.
pub(crate) fn refuse_too_many_copies(
    root: &Root,
    buffers: &Buffers<'_>,
    placed: impl Iterator<Item = Index<Mesh>>,
) -> Result<(), MeshError> {
    let mut triangles_of: Vec<Option<u64>> = vec![None; root.meshes.len()];
    let (mut nodes, mut all, mut own) = (0, 0_u64, 0_u64);
    for index in placed {
        // The reader of nodes reports a mesh that does not exist.
        let (Some(mesh), Some(known)) = (root.get(index), triangles_of.get_mut(index.value()))
        else {
            continue;
        };
        let count = match *known {
            Some(count) => count,
            None => {
                let mut count = 0;
                for primitive in &mesh.primitives {
                    count += corner_count(buffers, primitive)? as u64 / 3;
                }
                own += count;
                *known.insert(count)
            }
        };
        nodes += 1;
        all = all.saturating_add(count);
    }
    let bytes = (all - own).saturating_mul(TRIANGLE_BYTES);
    if bytes > MAX_COPIES_BYTES {
        return Err(MeshError::TooManyCopies { nodes, triangles: all, bytes });
    }
    Ok(())
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
