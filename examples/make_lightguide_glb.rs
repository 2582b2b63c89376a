//! Makes `scenes/meshes/lightguide.glb`: a round glass rod in the shape of an S, as a closed mesh with smooth normals.
//!
//! `cargo run --example make_lightguide_glb [FILE]`. The rod has a radius of 2 mm and a centre line of 40 mm in the
//! plane y = 0: from the origin 5 mm along +z, 15 mm bent toward +x, 15 mm bent back, 5 mm along +z. Its materials are
//! `entry`, `wall` and `exit`. Lengths are metres, as glTF prescribes, so a scene reads it with `unit = "m"`.

use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::path::Path;

/// Facets around the rod, and rings of them along it.
const AROUND: usize = 96;
const ALONG: usize = 160;
const RADIUS_MM: f64 = 2.0;
const LEG_MM: f64 = 5.0;
/// Each of the two bends turns by one radian.
const BEND_RADIUS_MM: f64 = 15.0;
const LENGTH_MM: f64 = 2.0 * (LEG_MM + BEND_RADIUS_MM);
const METRES_PER_MM: f64 = 0.001;

#[derive(Default)]
struct Mesh {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    /// Name and vertex numbers of every primitive.
    faces: Vec<(&'static str, Vec<u16>)>,
}

fn main() -> std::io::Result<()> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/meshes/lightguide.glb");
    let path = std::env::args().nth(1).unwrap_or_else(|| default.to_owned());
    let mut mesh = Mesh::default();
    add_cap(&mut mesh, "entry", 0.0);
    add_wall(&mut mesh);
    add_cap(&mut mesh, "exit", LENGTH_MM);
    std::fs::write(Path::new(&path), glb(&mesh))
}

/// Centre of the section at `s` mm along the rod, and its x axis, which leans by the angle of the bends.
fn section(s: f64) -> (DVec3, DVec3) {
    // The way back is the way there, turned half round about the middle.
    if s > 0.5 * LENGTH_MM {
        let (center, x) = section(LENGTH_MM - s);
        let (end, _) = section(0.5 * LENGTH_MM);
        return (2.0 * end - center, x);
    }
    if s <= LEG_MM {
        return (DVec3::new(0.0, 0.0, s), DVec3::X);
    }
    let (sin, cos) = ((s - LEG_MM) / BEND_RADIUS_MM).sin_cos();
    let center = DVec3::new(BEND_RADIUS_MM * (1.0 - cos), 0.0, LEG_MM + BEND_RADIUS_MM * sin);
    (center, DVec3::new(cos, 0.0, -sin))
}

/// Outward direction of the wall at facet corner `around` of a section.
fn outward(x: DVec3, around: usize) -> DVec3 {
    let (sin, cos) = (TAU * around as f64 / AROUND as f64).sin_cos();
    cos * x + sin * DVec3::Y
}

fn add_vertex(mesh: &mut Mesh, position_mm: DVec3, normal: DVec3) {
    // Adding zero turns -0 into 0.
    mesh.positions.push((METRES_PER_MM * position_mm + DVec3::ZERO).as_vec3());
    mesh.normals.push((normal + DVec3::ZERO).as_vec3());
}

fn add_wall(mesh: &mut Mesh) {
    let first = mesh.positions.len();
    for ring in 0..=ALONG {
        let (center, x) = section(LENGTH_MM * ring as f64 / ALONG as f64);
        for around in 0..AROUND {
            let normal = outward(x, around);
            add_vertex(mesh, center + RADIUS_MM * normal, normal);
        }
    }
    let vertex = |ring: usize, around: usize| (first + ring * AROUND + around % AROUND) as u16;
    let quads = (0..ALONG).flat_map(|ring| (0..AROUND).map(move |around| (ring, around)));
    let indices = quads.flat_map(|(ring, around)| {
        let [a, b] = [around, around + 1].map(|around| vertex(ring, around));
        let [d, c] = [around, around + 1].map(|around| vertex(ring + 1, around));
        [a, b, c, a, c, d]
    });
    mesh.faces.push(("wall", indices.collect()));
}

fn add_cap(mesh: &mut Mesh, name: &'static str, s: f64) {
    let (center, x) = section(s);
    let out = if s == 0.0 { -DVec3::Z } else { DVec3::Z };
    let hub = mesh.positions.len();
    add_vertex(mesh, center, out);
    for around in 0..AROUND {
        add_vertex(mesh, center + RADIUS_MM * outward(x, around), out);
    }
    let rim = |around: usize| (hub + 1 + around % AROUND) as u16;
    let indices = (0..AROUND).flat_map(|around| {
        let [from, to] = if s == 0.0 { [around + 1, around] } else { [around, around + 1] };
        [hub as u16, rim(from), rim(to)]
    });
    mesh.faces.push((name, indices.collect()));
}

/// glTF 2.0 specification, section 4: header, JSON chunk, binary chunk.
fn glb(mesh: &Mesh) -> Vec<u8> {
    let vectors = |list: &[Vec3]| -> Vec<u8> {
        list.iter().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes).collect()
    };
    let indices = mesh.faces.iter().flat_map(|(_, indices)| indices).flat_map(|i| i.to_le_bytes());
    let views = [vectors(&mesh.positions), vectors(&mesh.normals), indices.collect()];
    let mut json = document(mesh, views.each_ref().map(Vec::len)).to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = views.concat();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let word = |number: usize| (number as u32).to_le_bytes();
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let mut bytes = [*b"glTF", word(2), word(length), word(json.len()), *b"JSON"].concat();
    bytes.extend(json);
    bytes.extend([word(binary.len()), *b"BIN\0"].concat());
    bytes.extend(binary);
    bytes
}

fn document(mesh: &Mesh, view_lengths: [usize; 3]) -> Value {
    let count = mesh.positions.len();
    let bound = |pick: fn(Vec3, Vec3) -> Vec3| {
        mesh.positions.iter().copied().reduce(pick).unwrap_or_default().to_array()
    };
    // 5126 and 5123: f32 and u16; 34962 and 34963: vertices and indices.
    let mut accessors = vec![
        json!({ "bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3",
            "min": bound(Vec3::min), "max": bound(Vec3::max) }),
        json!({ "bufferView": 1, "componentType": 5126, "count": count, "type": "VEC3" }),
    ];
    let (mut primitives, mut materials, mut offset) = (Vec::new(), Vec::new(), 0);
    for (name, indices) in &mesh.faces {
        primitives.push(json!({ "attributes": { "POSITION": 0, "NORMAL": 1 },
            "indices": accessors.len(), "material": materials.len() }));
        materials.push(json!({ "name": name }));
        accessors.push(json!({ "bufferView": 2, "byteOffset": offset, "componentType": 5123,
            "count": indices.len(), "type": "SCALAR" }));
        offset += 2 * indices.len();
    }
    let [positions, normals, indices] = view_lengths;
    json!({
        "asset": { "version": "2.0", "generator": "lumiduct examples/make_lightguide_glb.rs" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": "lightguide", "mesh": 0 }],
        "meshes": [{ "primitives": primitives }],
        "materials": materials,
        "accessors": accessors,
        "bufferViews": [
            { "buffer": 0, "byteLength": positions, "target": 34962 },
            { "buffer": 0, "byteOffset": positions, "byteLength": normals, "target": 34962 },
            { "buffer": 0, "byteOffset": positions + normals, "byteLength": indices, "target": 34963 },
        ],
        "buffers": [{ "byteLength": positions + normals + indices }],
    })
}
