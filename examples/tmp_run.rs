//! tmp
#![allow(clippy::all, clippy::print_stdout, clippy::unwrap_used)]
use lumiduct::{input, transport::*, scene::*, tally::sigmas};
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let mut s = input::Settings::default();
    s.paths = std::env::args().nth(2).map(|p| p.parse().unwrap());
    let job = match input::load(path.as_ref(), &s) { Ok(j) => j, Err(e) => { println!("{e}"); return } };
    let t = std::time::Instant::now();
    let mut run = Run::new(&job.scene, &job.run);
    while !run.is_complete() { run.next_wave(); }
    let r = run.readings();
    let l = Layout::new(&job.scene);
    println!("{} paths {} segments {:.2} s {:.1} Mseg/s", r.paths(), r.segments, t.elapsed().as_secs_f64(), r.segments as f64/t.elapsed().as_secs_f64()/1e6);
    for (i, sensor) in job.scene.sensors.iter().enumerate() {
        let f = r.scalar(l.sensor_flux(SensorId::new(i), SourceId::new(0)));
        println!("{} {:.6} +- {:.6}", sensor.name, f.mean(), f.std_error());
    }
    for (i, f) in job.scene.faces.iter().enumerate() {
        println!("{} absorbed {:.6} escaped {:.6}", f.name, r.scalar(l.absorbed_by_face(FaceId::new(i))).mean(), r.scalar(l.escaped(Some(FaceId::new(i)))).mean());
    }
    println!("direct {:.6} cut {} roulette {:.2e} leaked {:.2e} {:?}", r.scalar(l.escaped(None)).mean(), r.scalar(l.cut()).mean(), r.scalar(l.roulette()).mean(), r.scalar(l.leaked()).mean(), r.leaks);
    let _ = sigmas(0.0,1.0,0.0);
}
