//! Meshes written as files, for tests.

use glam::DVec3;
use lumiduct_base::mesh::TriangleMesh;
use serde_json::{Value, json};

/// A mesh as a glTF document and its buffer: one primitive and one material per face, nothing shared.
pub(crate) fn gltf_parts(mesh: &TriangleMesh) -> (Value, Vec<u8>) {
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    let push = |list: &mut Vec<u8>, v: DVec3| {
        list.extend(v.as_vec3().to_array().iter().flat_map(|c| c.to_le_bytes()));
    };
    let corners = 3 * mesh.triangles.len();
    let mut primitives = Vec::new();
    let mut accessors = vec![
        json!({ "bufferView": 0, "componentType": 5126, "count": corners, "type": "VEC3" }),
        json!({ "bufferView": 1, "componentType": 5126, "count": corners, "type": "VEC3" }),
    ];
    for triangle in 0..mesh.triangles.len() {
        mesh.corners(triangle).iter().for_each(|corner| push(&mut positions, *corner));
        let smooth = &mesh.normals.as_ref().unwrap()[triangle];
        smooth.iter().for_each(|normal| push(&mut normals, *normal));
    }
    for face in 0..mesh.faces.len() {
        let start = indices.len();
        let of_face = |triangle: &usize| mesh.face_of[*triangle] as usize == face;
        for triangle in (0..mesh.triangles.len()).filter(of_face) {
            indices.extend((0..3).flat_map(|k| (3 * triangle as u16 + k).to_le_bytes()));
        }
        let count = (indices.len() - start) / 2;
        primitives.push(json!({
            "attributes": { "POSITION": 0, "NORMAL": 1 }, "indices": accessors.len(), "material": face,
        }));
        accessors.push(json!({
            "bufferView": 2, "byteOffset": start, "componentType": 5123, "count": count, "type": "SCALAR",
        }));
    }
    let lengths = [positions.len(), normals.len(), indices.len()];
    let blob = [positions, normals, indices].concat();
    let materials: Vec<_> = mesh.faces.iter().map(|name| json!({ "name": name })).collect();
    let document = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": primitives }],
        "materials": materials,
        "accessors": accessors,
        "bufferViews": [
            { "buffer": 0, "byteLength": lengths[0] },
            { "buffer": 0, "byteOffset": lengths[0], "byteLength": lengths[1] },
            { "buffer": 0, "byteOffset": lengths[0] + lengths[1], "byteLength": lengths[2] },
        ],
        "buffers": [{ "byteLength": blob.len() }],
    });
    (document, blob)
}

/// A GLB of a document and its buffer.
pub(crate) fn glb(document: &Value, blob: &[u8]) -> Vec<u8> {
    glb_of(document.to_string().as_bytes(), blob)
}

/// A GLB of any bytes in place of a document.
pub(crate) fn glb_of(document: &[u8], blob: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8; 4], data: &[u8], fill: u8| {
        let mut data = data.to_vec();
        data.resize(data.len().next_multiple_of(4), fill);
        [&(data.len() as u32).to_le_bytes(), kind.as_slice(), &data].concat()
    };
    let body = [chunk(b"JSON", document, b' '), chunk(b"BIN\0", blob, 0)].concat();
    let length = (12 + body.len()) as u32;
    [b"glTF".as_slice(), &2u32.to_le_bytes(), &length.to_le_bytes(), &body].concat()
}
