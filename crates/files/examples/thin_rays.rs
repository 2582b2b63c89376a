//! Draws some rays of a ray file into another: `cargo run -p lumiduct-files --example thin_rays led.tm25ray few.csv 10000 1`.
//!
//! Each ray is kept with the same probability n/N, and its flux is multiplied by N/n, so that the expected flux in any
//! direction and place is that of the whole file: no bias, only noise. The last argument is the seed. No file is replaced.

#![allow(clippy::print_stdout, reason = "a program for the command line")]

use lumiduct_files::rays::{RayFormat, RaySample, sample, write};
use std::error::Error;
use std::fs::File;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [from, to, count, seed] = &words[..] else {
        return Err("usage: thin_rays FROM TO COUNT SEED, of .tm25ray, .dat, .sdf or .csv".into());
    };
    let most: usize = count.parse().map_err(|_| format!("`{count}` is not a number of rays"))?;
    let seed: u64 = seed.parse().map_err(|_| format!("`{seed}` is not a seed"))?;
    if most == 0 {
        return Err("at least one ray must be kept".into());
    }
    let format = RayFormat::of(Path::new(to)).map_err(|error| format!("{to}: {error}"))?;
    let found = sample(Path::new(from), most, seed).map_err(|error| format!("{from}: {error}"))?;
    let RaySample { mut rays, mut info, remarks } = found;
    let (all, whole_flux, unit) = (info.count, info.flux, info.unit.flux());
    let factor = all as f64 / rays.len() as f64;
    for ray in &mut rays {
        ray.flux = (f64::from(ray.flux) * factor) as f32;
    }
    info.count = rays.len() as u64;
    info.flux = rays.iter().map(|ray| f64::from(ray.flux)).sum();
    let mut out = File::create_new(to).map_err(|error| format!("{to}: {error}"))?;
    let lost = write(&mut out, format, &info, rays.into_iter().map(Ok))?;
    for remark in remarks.iter().chain(&lost) {
        println!("remark: {remark}");
    }
    println!("{from}: {all} rays with {whole_flux:.4} {unit}");
    println!("{to}: {} rays with {:.4} {unit}", info.count, info.flux);
    Ok(())
}
