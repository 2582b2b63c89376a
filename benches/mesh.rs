//! Finding the next triangle along a ray: our search against testing all triangles, and against a
//! bare BVH.
//!
//! `cargo bench --bench mesh`. Round rods of 20,000 to a million triangles; the rays are segments of real
//! photon paths. All three use the same triangle test and must give the same answers. The bare tree
//! keeps only the nearest crossing: no coincident faces, no media. Ratios are medians of pairs of
//! runs in turn, with the smallest and the largest.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

#[allow(dead_code, reason = "shared with the other bench")]
mod clock;
#[allow(dead_code, reason = "shared with the other bench")]
mod guides;
mod spread;

use clock::cpu_seconds;
use guides::{B2, RODS, mesh_scene, rod_mesh};
use lumiduct_base::math::Frame;
use lumiduct_core::rng::Sampler;
use lumiduct_core::scene::mesh::{Mesh, TriangleLine};
use lumiduct_core::scene::shape::Toward;
use lumiduct_core::scene::{DrawnWavelength, Ray, Scene, SourceId};
use lumiduct_core::transport::{Event, Path, walk};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::fast_stack;
use obvhs::ray::{Ray as Ray32, RayHit};
use spread::Spread;
use std::ops::ControlFlow;
use std::time::Duration;

/// Rays traced in each run.
const RAYS: usize = 40_000;
/// Every how many rays one is tested against all triangles.
const BRUTE_EVERY: usize = 500;
/// How often a run repeats all its rays: a run must last longer than a tick of the clock.
const ROUNDS: usize = 10;
/// Pairs of runs.
const PAIRS: usize = 9;

fn main() {
    println!("Nanoseconds per ray, {RAYS} rays\n");
    println!("| triangles | beside ours | it | ours | it/ours |");
    println!("|--:|---|--:|--:|--:|");
    RODS.into_iter().for_each(print_rows);
}

/// Rows of a rod with this many facets around it and rings along it.
fn print_rows([facets, rings]: [u32; 2]) {
    let rod = rod_mesh(1.5, B2.length, facets, rings);
    let mesh = Mesh::new(&rod, &Frame::WORLD);
    let scene = mesh_scene(&B2, mesh.clone());
    let tree = bare_tree(&mesh);
    let queries = queries(&scene);
    let few: Vec<Query> = queries.iter().step_by(BRUTE_EVERY).cloned().collect();
    check(&scene, &mesh, &tree, &queries, &few);

    let ours = |query: &Query| by_scene(&scene, query);
    let bare = |query: &Query| by_bare_tree(&tree, &mesh, query);
    let brute = |query: &Query| by_all_triangles(&mesh, query);
    let count = mesh.triangle_count();
    let beside_bare = compare(&queries, bare, &queries, ours);
    println!("| {count} | bare obvhs tree, same leaf test | {beside_bare} |");
    let beside_brute = compare(&few, brute, &queries, ours);
    println!("| {count} | all triangles, same test | {beside_brute} |");
}

/// A ray to follow to the next surface.
#[derive(Clone)]
struct Query {
    path: Path,
    /// The triangle it starts on.
    from: Option<usize>,
    /// In which direction it may cross a triangle: out of the rod or into it.
    wanted: Toward,
}

/// The segments of photon paths, in order.
fn queries(scene: &Scene) -> Vec<Query> {
    let mut queries = Vec::with_capacity(RAYS);
    for index in 0.. {
        let mut sampler = Sampler::for_path(1, 1, index);
        let emitted = scene.sources[0].emit(scene, DrawnWavelength::REFERENCE, &mut sampler);
        let path = Path::emitted(scene, SourceId::new(0), emitted);
        walk(scene, path, 100_000, &mut sampler, &mut |path: &Path, event: Event<'_>| {
            if let Event::Travel(_) = event {
                let from = path.on.iter().next().map(|prim| prim.index());
                let wanted = if path.inside.is_empty() { Toward::Back } else { Toward::Front };
                queries.push(Query { path: path.clone(), from, wanted });
            }
            ControlFlow::Continue(())
        });
        if queries.len() >= RAYS {
            break;
        }
    }
    queries
}

/// Distance to the next surface, mm; infinite without one.
fn by_scene(scene: &Scene, query: &Query) -> f64 {
    let Path { ray, on, inside, .. } = &query.path;
    scene.find_next(ray, on, inside).map_or(f64::INFINITY, |hits| hits.distance())
}

fn by_all_triangles(mesh: &Mesh, query: &Query) -> f64 {
    let line = TriangleLine::of(&query.path.ray);
    mesh.triangles()
        .map(|triangle| distance(mesh, triangle, &line, query))
        .fold(f64::INFINITY, f64::min)
}

fn by_bare_tree(tree: &BareTree, mesh: &Mesh, query: &Query) -> f64 {
    let ray: &Ray = &query.path.ray;
    let line = TriangleLine::of(ray);
    let ray = Ray32::new_inf(ray.origin().as_vec3a(), ray.dir().as_vec3a());
    let mut nearest = f64::INFINITY;
    let mut hit = RayHit::none();
    fast_stack!(u32, (96, 192), tree.tree.max_depth, stack, {
        tree.tree.ray_traverse_dynamic(&mut stack, ray, &mut hit, |node, ray, _| {
            for slot in node.first_index..node.first_index + node.prim_count {
                let triangle = tree.numbers[tree.tree.primitive_indices[slot as usize] as usize];
                nearest = nearest.min(distance(mesh, triangle, &line, query));
                ray.tmax = ray.tmax.min((nearest as f32).next_up());
            }
            true
        });
    });
    nearest
}

/// Distance to a valid triangle, mm: crossed in the right direction, and not the one the ray starts
/// on.
#[inline]
fn distance(mesh: &Mesh, triangle: usize, line: &TriangleLine, query: &Query) -> f64 {
    if query.from == Some(triangle) {
        return f64::INFINITY;
    }
    match mesh.crossing_of(triangle, line) {
        Some(crossing) if crossing.toward == query.wanted && crossing.t >= -1e-12 => crossing.t,
        _ => f64::INFINITY,
    }
}

/// A tree of obvhs alone.
struct BareTree {
    tree: Bvh2,
    /// The number of each triangle in the mesh.
    numbers: Vec<usize>,
}

fn bare_tree(mesh: &Mesh) -> BareTree {
    let numbers: Vec<usize> = mesh.triangles().collect();
    let boxes: Vec<Aabb> = numbers
        .iter()
        .map(|triangle| {
            // Room for the rounding of rays to f32, as for every user of such a tree.
            let bounds = mesh.bounds(*triangle).grown(1e-4);
            Aabb::new(bounds.min.as_vec3a(), bounds.max.as_vec3a())
        })
        .collect();
    let tree = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
    BareTree { tree, numbers }
}

/// All searches must agree: speed of a wrong answer means nothing.
fn check(scene: &Scene, mesh: &Mesh, tree: &BareTree, queries: &[Query], few: &[Query]) {
    let same = |a: f64, b: f64| a == b || (a - b).abs() < 1e-9;
    for query in queries {
        let (ours, bare) = (by_scene(scene, query), by_bare_tree(tree, mesh, query));
        assert!(same(ours, bare.max(0.0)), "{ours} {bare}");
    }
    for query in few {
        let (ours, brute) = (by_scene(scene, query), by_all_triangles(mesh, query));
        assert!(same(ours, brute.max(0.0)), "{ours} {brute}");
    }
}

/// Columns of a row: nanoseconds per ray of the other program and of ours, and the other over ours.
fn compare(
    its: &[Query],
    it: impl Fn(&Query) -> f64,
    our: &[Query],
    ours: impl Fn(&Query) -> f64,
) -> String {
    let (mut other, mut own, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..PAIRS {
        other.push(nanoseconds(its, &it));
        own.push(nanoseconds(our, &ours));
        ratios.push(other[other.len() - 1] / own[own.len() - 1]);
    }
    format!("{} | {} | {}", spread(other, 0), spread(own, 0), spread(ratios, 2))
}

fn nanoseconds(queries: &[Query], next: impl Fn(&Query) -> f64) -> f64 {
    let all = || queries.iter().map(&next).filter(|t| t.is_finite()).count();
    let (seconds, _) = cpu_seconds(|| (0..ROUNDS).map(|_| all()).sum::<usize>());
    1e9 * seconds / (ROUNDS * queries.len()) as f64
}

fn spread(values: Vec<f64>, digits: usize) -> String {
    let Spread { median, min, max } = Spread::of(values);
    format!("{median:.digits$} ({min:.digits$} to {max:.digits$})")
}
