#[path = "../benches/guides.rs"]
mod guides;
use guides::*;
use lumiduct::math::Frame;
use lumiduct::scene::mesh::Mesh;
use lumiduct::scene::plan::*;
use lumiduct::transport::*;
fn cpu() -> f64 { std::fs::read_to_string("/proc/thread-self/schedstat").unwrap().split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9 }
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let reps: usize = args[2].parse().unwrap();
    let all = [("b1", 4096u64), ("b1l", 1024), ("b2", 4096), ("b4", 4096), ("mesh", 64)];
    for (name, batch) in all {
        if args[1] != "all" && args[1] != name { continue; }
        let scene = match name { "b1" => tube_scene(&B1_P10), "b1l" => tube_scene(&B1_P100), "b2" => rod_scene(&B2), "b4" => rod_scene(&B4), _ => mesh_scene(&B2, Mesh::new(&rod_mesh(1.5, 60.0, 316, 158), &Frame::WORLD)) };
        let plan = RunPlan { estimator: Estimator::Forward, seed: 3, bounce_limit: 100_000, stop: StopRules { paths: Some(128 * batch), ..StopRules::default() } };
        let mut times = vec![];
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        for _ in 0..reps {
            let mut run = Run::new(&scene, &plan);
            let t = pool.install(|| { let t = cpu(); while !run.is_complete() { run.next_wave(); } cpu() - t });
            times.push(t * 1e9 / run.readings().segments as f64);
        }
        times.sort_by(f64::total_cmp);
        print!("{name} {:.1} ns/seg (min {:.1})   ", times[times.len() / 2], times[0]);
    }
    println!();
}
