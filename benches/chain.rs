//! Total reflections in a round rod of triangles, by our search alone and by another program.
//!
//! `cargo bench --bench chain -- PROGRAM`, where PROGRAM is for example `benches/embree_chain.cpp`, compiled:
//! `c++ -O3 -march=native benches/embree_chain.cpp -lembree3 -o PROGRAM`. It is given a mesh as OBJ and a number of paths, and prints
//! the number of segments that it followed and the seconds that this took. Without PROGRAM ours is measured alone.
//!
//! Light of a Lambertian disk enters the rod of benchmark B2 and is reflected at flat facets until it meets an end.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

#[allow(dead_code, reason = "shared with the other bench")]
mod clock;
#[allow(dead_code, reason = "shared with the other bench")]
mod guides;
mod spread;

use clock::cpu_seconds;
use glam::DVec3;
use guides::{B2, RODS, mesh_scene, rod_mesh};
use lumiduct_base::math::Frame;
use lumiduct_base::mesh::TriangleMesh;
use lumiduct_core::rng::{Dimension, Sampler};
use lumiduct_core::scene::mesh::Mesh;
use lumiduct_core::scene::{Inside, Ray, Scene, SolidId, StartSurfaces};
use spread::Spread;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::{env, fs};

/// Paths followed in each run.
const PATHS: u64 = 100_000;
/// Runs of each program.
const RUNS: usize = 9;
const RADIUS: f64 = 1.5;

fn main() {
    let other = env::args().skip(1).find(|arg| !arg.starts_with('-'));
    println!(
        "Million segments per second of CPU time\n\n| triangles | ours | other | ours/other |"
    );
    println!("|--:|--:|--:|--:|");
    for [facets, rings] in RODS {
        let rod = rod_mesh(RADIUS, B2.length, facets, rings);
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("rod_{facets}.obj"));
        fs::write(&file, obj(&rod)).expect("a file for the mesh");
        let scene = mesh_scene(&B2, Mesh::new(&rod, &Frame::WORLD));
        let (mut ours, mut others, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..RUNS {
            let (seconds, segments) = cpu_seconds(|| chain(&scene));
            ours.push(1e-6 * segments as f64 / seconds);
            if let Some(program) = &other {
                others.push(rate_of(program, &file));
                ratios.push(ours[ours.len() - 1] / others[others.len() - 1]);
            }
        }
        let columns = [ours, others, ratios].map(spread);
        println!("| {} | {} |", rod.triangles.len(), columns.join(" | "));
    }
}

/// Segments that light follows until it meets an end of the rod.
fn chain(scene: &Scene) -> u64 {
    let inside: Inside = [SolidId::new(0)].into_iter().collect();
    let wall = scene.face_named("rod.wall").expect("the rod has a wall");
    let mut segments = 0;
    for index in 0..PATHS {
        let mut sampler = Sampler::for_path(1, 1, index);
        let [place, turn] = sampler.pair(Dimension::EmitPosition);
        let [sine, azimuth] = sampler.pair(Dimension::EmitDirection);
        let polar = |radius: f64, turn: f64| {
            let (sin, cos) = (TAU * turn).sin_cos();
            radius * DVec3::new(cos, sin, 0.0)
        };
        // Cosine law before the entry, refracted there.
        let (sine, dir) = (sine.sqrt(), polar(sine.sqrt() / B2.index, azimuth));
        let way = B2.gap * sine / (1.0 - sine * sine).sqrt();
        let start = polar(B2.source_radius * place.sqrt(), turn) + polar(way, azimuth);
        if start.length() >= 0.99 * RADIUS {
            continue;
        }
        let ahead = dir + (1.0 - dir.length_squared()).sqrt() * DVec3::Z;
        let mut ray = Ray::new(start + 1e-5 * DVec3::Z, ahead);
        let mut from = StartSurfaces::default();
        while let Some(hits) = scene.find_next(&ray, &from, &inside) {
            segments += 1;
            if hits.nearest().face != wall {
                break;
            }
            let on = ray.advanced(hits.distance());
            let normal = scene.normal(hits.nearest().prim, on.origin());
            ray = Ray::new(on.origin(), ray.dir().reflect(normal));
            from = StartSurfaces::hits(&hits);
        }
    }
    segments
}

/// Million segments per second of another program.
fn rate_of(program: &str, file: &Path) -> f64 {
    let output = Command::new(program).arg(file).arg(PATHS.to_string()).output();
    let text = String::from_utf8(output.expect("the program starts").stdout).expect("text");
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let [segments, seconds] = numbers[..] else { panic!("segments and seconds: {text}") };
    1e-6 * segments / seconds
}

/// A mesh as the text of an OBJ file, with a material for each face.
fn obj(mesh: &TriangleMesh) -> String {
    let mut text = String::new();
    for DVec3 { x, y, z } in &mesh.positions {
        writeln!(text, "v {x:.9} {y:.9} {z:.9}").expect("memory");
    }
    for (face, name) in mesh.faces.iter().enumerate() {
        writeln!(text, "usemtl {name}").expect("memory");
        let own = mesh.triangles.iter().zip(&mesh.face_of).filter(|(_, of)| **of as usize == face);
        for ([a, b, c], _) in own {
            writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).expect("memory");
        }
    }
    text
}

fn spread(values: Vec<f64>) -> String {
    if values.is_empty() {
        return "-".into();
    }
    let Spread { median, min, max } = Spread::of(values);
    format!("{median:.2} ({min:.2} to {max:.2})")
}
