#[path = "../benches/guides.rs"]
mod guides;
use guides::*;
use lumiduct::rng::Sampler;
use lumiduct::scene::*;
use lumiduct::transport::*;
use std::ops::ControlFlow;
fn cpu() -> f64 { std::fs::read_to_string("/proc/thread-self/schedstat").unwrap().split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9 }
fn count() -> u64 { std::env::args().nth(2).map_or(400_000, |a| a.parse().unwrap()) }
fn main() {
    for (name, scene) in [("b1", tube_scene(&B1_P10)), ("b2", rod_scene(&B2)), ("b4", rod_scene(&B4))] {
        if std::env::args().nth(1).is_some_and(|a| a != name) { continue; } let mut times = vec![];
        for _ in 0..(if count() < 100_000 { 1 } else { 5 }) {
            let t = cpu();
            let mut segments = 0u64;
            for index in 0..count() {
                let mut sampler = Sampler::for_path(3, 1, index);
                let emitted = scene.sources[0].emit(&scene, &mut sampler);
                let path = Path::emitted(&scene, SourceId::new(0), emitted);
                walk(&scene, path, 100_000, &mut sampler, |_, event| { if let Event::Travel(_) = event { segments += 1; } ControlFlow::Continue(()) });
            }
            print!("[{segments} segments] "); times.push((cpu() - t) * 1e9 / segments as f64);
        }
        times.sort_by(f64::total_cmp);
        print!("{name} walk {:.1} ns/seg   ", times[times.len() / 2]);
    }
    println!();
}
