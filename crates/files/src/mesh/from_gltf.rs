//! glTF 2.0 and GLB: all triangles of the scene, with the transforms of their nodes applied in f64.
//!
//! Every index is checked against its bound. The validation of the `gltf` crate is not used,
//! because it indexes an accessor out of bounds on bad files and refuses harmless ones. Skins,
//! morph targets and animations are not followed. Source: Khronos, glTF 2.0 Specification (2021),
//! sections 3.5-3.7 and 4.

use crate::mesh::error::MeshError;
use crate::mesh::format::LengthUnit;
use crate::mesh::gltf_buffers::{Buffers, broken};
use crate::mesh::gltf_copies::{
    Copies, copied, grouped, joined, mirror, reasons, refuse_impossible_copies,
    refuse_large_copies, refuse_large_meshes, touching, triangle_counts,
};
use crate::mesh::gltf_nodes::{PlacedMesh, placed_meshes};
use crate::mesh::gltf_primitive::add_primitive;
use glam::{DAffine3, DVec3};
use gltf::json::Root;
use lumiduct_base::math::Aabb;
use lumiduct_base::mesh::{CopiedBody, MeshAssembly, MeshBuilder, WhyJoined, is_closed};
use std::path::Path;

/// The extension that shows a mesh many times by one node.
const INSTANCING: &str = "EXT_mesh_gpu_instancing";
/// Length of a GLB's header, bytes.
const GLB_HEADER: usize = 12;

/// Reads a glTF document or a GLB; files that it references are read from `folder`.
pub(crate) fn read(
    bytes: &[u8],
    folder: &Path,
    unit: LengthUnit,
) -> Result<MeshAssembly, MeshError> {
    let glb = if bytes.starts_with(b"glTF") { Some(open_glb(bytes)?) } else { None };
    let json = glb.as_ref().map_or(bytes, |glb| &glb.json);
    let root = Root::from_slice(json).map_err(|error| broken(error.to_string()))?;
    refuse_unknown_extensions(&root)?;
    let blob = glb.as_ref().and_then(|glb| glb.bin.as_deref());
    let buffers = Buffers::load(&root, blob, folder)?;
    let document = Document { root: &root, buffers: &buffers };
    let placed = placed_meshes(&root, unit.millimetres())?;
    let counts = triangle_counts(&root, &buffers, &placed)?;
    refuse_impossible_copies(&placed, &counts)?;
    let mut shown = vec![0; counts.len()];
    placed.iter().for_each(|own| shown[own.mesh.value()] += 1);
    let (groups, others) = grouped(placed, &counts);
    refuse_large_meshes(&groups, &others, &counts)?;
    let (closed, open) = document.bodies(groups)?;
    let mut all_joined = [others, open].concat();
    refuse_large_copies(&all_joined, &counts)?;
    let mut builder = MeshBuilder::default();
    document.add(&mut builder, &all_joined)?;
    let (shared, near) = apart(closed, builder.positions());
    all_joined.extend(&near);
    refuse_large_copies(&all_joined, &counts)?;
    document.add(&mut builder, &near)?;
    let assembly = builder.finish_with(shared)?;
    Ok(MeshAssembly { joined: reasons(&all_joined, &shown), ..assembly })
}

/// A document and what it refers to.
#[derive(Clone, Copy)]
struct Document<'a> {
    root: &'a Root,
    buffers: &'a Buffers<'a>,
}

impl Document<'_> {
    /// Adds the triangles of some nodes.
    fn add(self, builder: &mut MeshBuilder, placed: &[PlacedMesh]) -> Result<(), MeshError> {
        for PlacedMesh { mesh, to_scene, .. } in placed {
            let primitives = self.root.get(*mesh).into_iter().flat_map(|mesh| &mesh.primitives);
            for primitive in primitives {
                add_primitive(builder, self.root, self.buffers, primitive, to_scene)?;
            }
        }
        Ok(())
    }

    /// The closed bodies of groups of nodes, and the nodes of all other groups.
    fn bodies(self, groups: Vec<Copies>) -> Result<(Vec<Placed>, Vec<PlacedMesh>), MeshError> {
        let (mut closed, mut open) = (Vec::new(), Vec::new());
        for copies in groups {
            let mut body = MeshBuilder::default();
            let to_scene = if copies.is_mirrored { mirror() } else { DAffine3::IDENTITY };
            self.add(&mut body, &[PlacedMesh { to_scene, ..copies.nodes[0] }])?;
            let body = body.finish()?;
            if is_closed(&body) {
                closed.push((copied(&copies, body)?, copies.nodes));
            } else {
                open.extend(joined(copies.nodes, WhyJoined::Open));
            }
        }
        Ok((closed, open))
    }
}

/// A body, and the node of each of its copies.
type Placed = (CopiedBody, Vec<PlacedMesh>);

/// The bodies with the copies that touch nothing else, and the nodes of the others.
fn apart(closed: Vec<Placed>, vertices: &[DVec3]) -> (Vec<CopiedBody>, Vec<PlacedMesh>) {
    let boxes: Vec<Aabb> = closed.iter().flat_map(|(copied, _)| copied.boxes()).collect();
    let mut touches = touching(&boxes, vertices).into_iter();
    let (mut shared, mut near) = (Vec::new(), Vec::new());
    for (CopiedBody { body, places }, nodes) in closed {
        let mut alone = Vec::new();
        for ((place, node), touches) in places.into_iter().zip(nodes).zip(&mut touches) {
            if touches { near.push(node.joined(WhyJoined::Touching)) } else { alone.push(place) }
        }
        if !alone.is_empty() {
            shared.push(CopiedBody { body, places: alone });
        }
    }
    (shared, near)
}

fn open_glb(bytes: &[u8]) -> Result<gltf::Glb<'_>, MeshError> {
    // The crate subtracts the header from this length unchecked.
    let announced = bytes.get(8..GLB_HEADER).map_or(0, |length| {
        u32::from_le_bytes([length[0], length[1], length[2], length[3]]) as usize
    });
    if announced < GLB_HEADER || announced > bytes.len() {
        return Err(broken(format!("it announces {announced} bytes and holds {}", bytes.len())));
    }
    gltf::Glb::from_slice(bytes).map_err(|error| broken(error.to_string()))
}

/// Required extensions that affect only appearance are harmless; others may hide geometry.
fn refuse_unknown_extensions(root: &Root) -> Result<(), MeshError> {
    if root.extensions_used.iter().any(|name| name == INSTANCING) {
        return Err(MeshError::Unsupported {
            what: format!(
                "the glTF file uses {INSTANCING}, without which one copy of many would remain"
            ),
            remedy: "export a node for each copy",
        });
    }
    let harmless = |name: &str| name.starts_with("KHR_materials_") || name.contains("_texture_");
    match root.extensions_required.iter().find(|name| !harmless(name)) {
        Some(name) => Err(MeshError::Unsupported {
            what: format!("the glTF file needs the extension {name}"),
            remedy: "export without compression and extensions",
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bytes::tests::mutants;
    use crate::mesh::samples::{glb, glb_of, gltf_parts};
    use lumiduct_base::mesh::bodies::{Normals, rod};
    use lumiduct_base::mesh::{TriangleMesh, health};
    use serde_json::{Value, json};

    /// The triangles that are not shared.
    fn read(bytes: &[u8], folder: &Path, unit: LengthUnit) -> Result<TriangleMesh, MeshError> {
        super::read(bytes, folder, unit).map(|assembly| assembly.mesh)
    }

    fn read_json(json: &Value, blob: &[u8]) -> Result<TriangleMesh, MeshError> {
        read(&glb(json, blob), Path::new(""), LengthUnit::Millimetre)
    }

    /// The test rod, its document and its buffer.
    fn rod_parts() -> (TriangleMesh, Value, Vec<u8>) {
        let rod = rod(2.0, 40.0, 24, Normals::Smooth);
        let (json, blob) = gltf_parts(&rod);
        (rod, json, blob)
    }

    #[test]
    fn a_rod_comes_back_with_names_and_normals() {
        let (rod, json, blob) = rod_parts();
        let mesh = read_json(&json, &blob).unwrap();
        assert_eq!(mesh.faces, ["wall", "entry", "exit"]);
        assert_eq!(mesh.triangles.len(), rod.triangles.len());
        let health = health(&mesh);
        assert!(health.is_sound() && health.opposed_normals.count == 0, "{health:?}");
        let metres = read(&glb(&json, &blob), Path::new(""), LengthUnit::Metre).unwrap();
        assert!((metres.bounds().max.z - 40_000.0).abs() < 1e-9);
    }

    #[test]
    fn buffers_may_be_data_uris_or_files_beside_the_document() {
        let (_, mut json, blob) = rod_parts();
        let expected = read_json(&json, &blob).unwrap();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("the rod.bin"), &blob).unwrap();
        json["buffers"][0]["uri"] = json!("the%20rod.bin");
        let text = json.to_string();
        let mesh = read(text.as_bytes(), folder.path(), LengthUnit::Millimetre).unwrap();
        assert_eq!(mesh, expected);
        let error = read(text.as_bytes(), Path::new("/no/where"), LengthUnit::Millimetre);
        let error = error.unwrap_err().to_string();
        assert!(error.contains("`the%20rod.bin` cannot be read"), "{error}");
        json["buffers"][0]["byteLength"] = json!(3);
        json["buffers"][0]["uri"] = json!("data:application/octet-stream;base64,AAAA");
        let error = read_json(&json, &blob).unwrap_err().to_string();
        assert!(error.contains("reaches beyond its buffer"), "{error}");
        for uri in ["/etc/hostname", "http://a.b/c.bin", "data:text/plain,abc"] {
            json["buffers"][0]["uri"] = json!(uri);
            assert!(matches!(read_json(&json, &blob), Err(MeshError::Broken { .. })), "{uri}");
        }
    }

    #[test]
    fn transforms_of_parents_add_up_and_mirrors_keep_the_outside_out() {
        let (_, mut json, blob) = rod_parts();
        let upright = health(&read_json(&json, &blob).unwrap());
        json["nodes"] = json!([
            { "children": [1], "translation": [1, 2, 3], "scale": [-1, 2, 1] },
            { "children": [2], "rotation": [0.5, 0.5, 0.5, 0.5] },
            { "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 5, 1] },
        ]);
        let mesh = read_json(&json, &blob).unwrap();
        let health = health(&mesh);
        assert!(health.is_sound() && health.opposed_normals.count == 0, "{health:?}");
        // z doubled and moved by 5, then x -> y -> z -> x, then x mirrored and y doubled.
        assert!((health.signed_volume_mm3 / upright.signed_volume_mm3 - 4.0).abs() < 1e-12);
        let bounds = mesh.bounds();
        let expected = [DVec3::new(-84.0, -2.0, 1.0), DVec3::new(-4.0, 6.0, 5.0)];
        assert!((bounds.min - expected[0]).length() < 1e-6, "{bounds:?}");
        assert!((bounds.max - expected[1]).length() < 1e-6, "{bounds:?}");
    }

    #[test]
    fn bad_documents_are_told_what_is_wrong() {
        type Change = fn(&mut Value);
        let cases: [(&str, Change); 17] = [
            ("export a node for each copy", |j| {
                j["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
            }),
            ("accessor 77", |j| {
                j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(77);
            }),
            ("accessor 78", |j| j["meshes"][0]["primitives"][0]["indices"] = json!(78)),
            ("is a Vec3, expected Scalar", |j| j["accessors"][2]["type"] = json!("VEC3")),
            ("reaches beyond its buffer", |j| j["accessors"][0]["count"] = json!(u64::MAX)),
            ("reaches beyond its buffer", |j| j["bufferViews"][0]["byteOffset"] = json!(u64::MAX)),
            ("reaches beyond its buffer", |j| j["bufferViews"][0]["byteStride"] = json!(0)),
            ("names a vertex that does not exist", |j| {
                j["accessors"][0]["count"] = json!(3);
                j["accessors"][1]["count"] = json!(3);
            }),
            ("not as many normals", |j| j["accessors"][1]["count"] = json!(3)),
            ("not three per triangle", |j| j["accessors"][2]["count"] = json!(4)),
            ("separate triangles only", |j| j["meshes"][0]["primitives"][0]["mode"] = json!(5)),
            ("material 9 does not exist", |j| {
                j["meshes"][0]["primitives"][0]["material"] = json!(9);
            }),
            ("node 0 is its own ancestor", |j| j["nodes"][0]["children"] = json!([0])),
            ("node 5 does not exist", |j| j["nodes"][0]["children"] = json!([5])),
            ("makes everything flat", |j| j["nodes"][0]["scale"] = json!([1, 0, 1])),
            ("it has no scene", |j| j["scenes"] = json!([])),
            ("needs the extension KHR_draco", |j| {
                j["extensionsRequired"] =
                    json!(["KHR_materials_ior", "KHR_draco_mesh_compression"]);
            }),
        ];
        for (expected, change) in cases {
            let (_, mut json, blob) = rod_parts();
            change(&mut json);
            let error = read_json(&json, &blob).unwrap_err().to_string();
            assert!(error.contains(expected), "{expected}: {error}");
        }
    }

    #[test]
    fn a_long_chain_of_nodes_does_not_overflow_the_stack() {
        let (_, mut json, blob) = rod_parts();
        let last = 100_000;
        let chain = (0..last).map(|node| json!({ "children": [node + 1] }));
        json["nodes"] = chain.chain([json!({ "mesh": 0 })]).collect();
        assert!(read_json(&json, &blob).is_ok());
    }

    #[test]
    fn headers_with_impossible_lengths_are_refused() {
        let (_, json, blob) = rod_parts();
        for length in [0u32, 11, u32::MAX] {
            let mut bytes = glb(&json, &blob);
            bytes[8..12].copy_from_slice(&length.to_le_bytes());
            let error = read(&bytes, Path::new(""), LengthUnit::Metre).unwrap_err().to_string();
            assert!(error.contains("it announces"), "{error}");
        }
        for end in 0..40 {
            assert!(read(&glb(&json, &blob)[..end], Path::new(""), LengthUnit::Metre).is_err());
        }
    }

    #[test]
    fn mutated_files_never_panic_and_good_results_are_finite() {
        let (json, blob) = gltf_parts(&rod(2.0, 40.0, 4, Normals::Smooth));
        let (mut good, mut bad) = (0, 0);
        // The document alone is shorter than a GLB, so damage hits it often.
        for original in [glb(&json, &blob), json.to_string().into_bytes()] {
            for (index, bytes) in mutants(&original, 20_000, 9).enumerate() {
                let bytes = if original.starts_with(b"{") { glb_of(&bytes, &blob) } else { bytes };
                match read(&bytes, Path::new("/no/where"), LengthUnit::Metre) {
                    Ok(mesh) => {
                        good += 1;
                        assert!(mesh.positions.iter().all(|p| p.is_finite()), "mutant {index}");
                    }
                    Err(_) => bad += 1,
                }
            }
        }
        // Both must occur, or the damage is too small or too large to test anything.
        assert!(good > 1000 && bad > 1000, "{good} good, {bad} bad");
    }
}
