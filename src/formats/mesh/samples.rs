//! Meshes with known answers and damaged files, for tests.

use crate::formats::mesh::TriangleMesh;
use crate::formats::mesh::builder::Builder;
use crate::rng::{Dimension, Sampler};
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// Whether a sample carries the normals of the surface it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Normals {
    Smooth,
    None,
}

/// A closed box from the origin to `size`, one face per side, no normals.
pub(crate) fn block(size: DVec3) -> TriangleMesh {
    let mut builder = Builder::default();
    let corner = |bits: usize| {
        DVec3::new((bits & 1) as f64, (bits >> 1 & 1) as f64, (bits >> 2 & 1) as f64) * size
    };
    let sides = [
        ("minus_z", [0, 2, 3, 1]),
        ("plus_z", [4, 5, 7, 6]),
        ("minus_y", [0, 1, 5, 4]),
        ("plus_y", [2, 6, 7, 3]),
        ("minus_x", [0, 4, 6, 2]),
        ("plus_x", [1, 3, 7, 5]),
    ];
    for (name, quad) in sides {
        let [a, b, c, d] = quad.map(corner);
        builder.add([a, b, c], None, name).unwrap();
        builder.add([a, c, d], None, name).unwrap();
    }
    builder.finish().unwrap()
}

/// A sphere about the origin: an icosahedron whose triangles were split in four `level` times.
pub(crate) fn icosphere(radius: f64, level: u32, normals: Normals) -> TriangleMesh {
    let golden = 0.5 * (1.0 + 5.0f64.sqrt());
    let mut corners = Vec::new();
    for axis in 0..3 {
        for (a, b) in [(-1.0, -golden), (-1.0, golden), (1.0, -golden), (1.0, golden)] {
            let v = [0.0, a, b];
            corners.push(DVec3::new(v[(3 - axis) % 3], v[(4 - axis) % 3], v[(5 - axis) % 3]));
        }
    }
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let (a, b, c) = (corners[i], corners[j], corners[k]);
                // Edges have length 2, all other distances are longer.
                if [(a, b), (b, c), (c, a)].iter().all(|(p, q)| p.distance(*q) < 2.1) {
                    let outward = (b - a).cross(c - a).dot(a) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..level {
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    let mut builder = Builder::default();
    for triangle in triangles {
        let unit = triangle.map(DVec3::normalize);
        let normals = (normals == Normals::Smooth).then_some(unit);
        builder.add(unit.map(|p| radius * p), normals, "").unwrap();
    }
    builder.finish().unwrap()
}

fn split([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 4] {
    // Sums commute exactly, so that neighbours get the same middle.
    let middle = |p: DVec3, q: DVec3| (p.normalize() + q.normalize()).normalize();
    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// A closed round rod of `sides` facets along +z, faces entry, exit and wall; caps have flat normals if any.
pub(crate) fn rod(radius: f64, length: f64, sides: u32, normals: Normals) -> TriangleMesh {
    let mut builder = Builder::default();
    let rim = |side: u32, z: f64| {
        let (sin, cos) = (TAU * f64::from(side % sides) / f64::from(sides)).sin_cos();
        DVec3::new(radius * cos, radius * sin, z)
    };
    let wall = |corners: [DVec3; 3]| {
        (normals == Normals::Smooth).then_some(corners.map(|p| DVec3::new(p.x, p.y, 0.0)))
    };
    let cap = |normal: DVec3| (normals == Normals::Smooth).then_some([normal; 3]);
    for side in 0..sides {
        let [a, b, c, d] =
            [(0, 0.0), (1, 0.0), (1, length), (0, length)].map(|(step, z)| rim(side + step, z));
        for corners in [[a, b, c], [a, c, d]] {
            builder.add(corners, wall(corners), "wall").unwrap();
        }
        builder.add([DVec3::ZERO, b, a], cap(-DVec3::Z), "entry").unwrap();
        builder.add([length * DVec3::Z, d, c], cap(DVec3::Z), "exit").unwrap();
    }
    builder.finish().unwrap()
}

/// A closed pipe of radius 1.5 along +z whose far end is cut by a plane at 45 degrees, faces entry, wall and mirror.
pub(crate) fn mirror_pipe(sides: u32, normals: Normals) -> TriangleMesh {
    let mut builder = Builder::default();
    // The middle of a facet, not an edge, lies where the wall meets the plane at 45 degrees.
    let point = |side: u32, far: bool| {
        let (sin, cos) = (TAU * (f64::from(side % sides) + 0.5) / f64::from(sides)).sin_cos();
        let (x, y) = (1.5 * cos, 1.5 * sin);
        let point = DVec3::new(x, y, if far { 20.0 + x } else { 0.0 });
        // As a GLB has it: single precision, in metres.
        1000.0 * (1e-3 * point).as_vec3().as_dvec3()
    };
    let given = |corners: [DVec3; 3]| (normals == Normals::Smooth).then_some(corners);
    for side in 0..sides {
        let [a, b] = [side, side + 1].map(|side| point(side, false));
        let [d, c] = [side, side + 1].map(|side| point(side, true));
        for corners in [[a, b, c], [a, c, d]] {
            let across = corners.map(|p| DVec3::new(p.x, p.y, 0.0).normalize());
            builder.add(corners, given(across), "wall").unwrap();
        }
        builder.add([DVec3::ZERO, b, a], given([-DVec3::Z; 3]), "entry").unwrap();
        let mirror = DVec3::new(-1.0, 0.0, 1.0).normalize();
        builder.add([20.0 * DVec3::Z, d, c], given([mirror; 3]), "mirror").unwrap();
    }
    builder.finish().unwrap()
}

/// A closed prism of length 7 along +z over a counter-clockwise outline, one face, no normals.
pub(crate) fn prism(outline: &[[f64; 2]]) -> TriangleMesh {
    let mut builder = Builder::default();
    let points: Vec<DVec2> = outline.iter().map(|p| DVec2::from(*p)).collect();
    for triangle in crate::math::planar::triangulate(&points) {
        let [a, b, c] = triangle.map(|p| p.extend(0.0));
        builder.add([a, c, b], None, "").unwrap();
        builder.add([a, b, c].map(|p| p + 7.0 * DVec3::Z), None, "").unwrap();
    }
    for (index, from) in points.iter().enumerate() {
        let to = points[(index + 1) % points.len()];
        let [a, b] = [*from, to].map(|p| p.extend(0.0));
        let [d, c] = [a, b].map(|p| p + 7.0 * DVec3::Z);
        builder.add([a, b, c], None, "").unwrap();
        builder.add([a, c, d], None, "").unwrap();
    }
    builder.finish().unwrap()
}

/// `count` damaged copies of a file: bytes changed, cut out, doubled, and the end missing.
pub(crate) fn mutants(original: &[u8], count: u64, seed: u64) -> impl Iterator<Item = Vec<u8>> {
    (0..count).map(move |index| {
        let mut sampler = Sampler::for_path(seed, 0, index);
        let mut below = |n: usize| (sampler.one(Dimension::Lobe) * n as f64) as usize;
        let mut bytes = original.to_vec();
        for _ in 0..=below(8) {
            if bytes.is_empty() {
                break;
            }
            let at = below(bytes.len());
            let end = (at + 1 + below(12)).min(bytes.len());
            match below(6) {
                0 => bytes[at] = below(256) as u8,
                1 => bytes[at] ^= 1 << below(8),
                2 => bytes[at..end].fill([0x00, 0x7f, 0xff, b'9', b'-'][below(5)]),
                3 => drop(bytes.drain(at..end)),
                4 => bytes.extend_from_within(at..end),
                _ => bytes.truncate(at + (bytes.len() - at) * below(4) / 3),
            }
        }
        bytes
    })
}

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
