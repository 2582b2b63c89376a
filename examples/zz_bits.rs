#[path = "../benches/guides.rs"]
mod guides;
use guides::*;
use lumiduct::math::Frame;
use lumiduct::scene::mesh::Mesh;
use lumiduct::scene::plan::*;
use lumiduct::scene::Scene;
use lumiduct::transport::*;
fn hash(bytes: &[u8]) -> u64 { bytes.iter().fold(0xcbf29ce484222325, |h, b| (h ^ *b as u64).wrapping_mul(0x100000001b3)) }
fn main() {
    let absorbing = { let mut s = rod_scene(&B2); s.media[1] = lumiduct::optics::Medium::new("pmma", 1.49, 0.001); s };
    let scenes: Vec<(&str, Scene, u64)> = vec![
        ("B1p10", tube_scene(&B1_P10), 200_000), ("B1p100", tube_scene(&B1_P100), 100_000), ("B2", rod_scene(&B2), 200_000), ("B2abs", absorbing, 200_000),
        ("B4", rod_scene(&B4), 200_000), ("mesh", mesh_scene(&B2, Mesh::new(&rod_mesh(1.5, 60.0, 64, 30), &Frame::WORLD)), 20_000)];
    for (name, scene, paths) in &scenes {
        let plan = RunPlan { estimator: Estimator::Forward, seed: 3, bounce_limit: 100_000, stop: StopRules { paths: Some(*paths), ..StopRules::default() } };
        let mut run = Run::new(scene, &plan);
        while !run.is_complete() { run.next_wave(); }
        let r = run.readings();
        let json = serde_json::to_vec(&r).unwrap();
        let slot = Layout::new(scene).sensor_flux(lumiduct::scene::SensorId::new(0), lumiduct::scene::SourceId::new(0));
        println!("{name} {:016x} segments {} flux {:.17} leaks {}", hash(&json), r.segments, r.scalar(slot).mean(), r.leaks.len());
    }
}
