//! Prints which shares of light a sheet reflects and transmits, by angle of incidence:
//! `cargo run -p lumiduct-files --example describe_bsdf glazing.xml`.

#![allow(clippy::print_stdout, reason = "a program for the command line")]

use glam::DVec2;
use lumiduct_files::scatter::{BsdfMatrix, read};
use std::error::Error;
use std::path::Path;

/// Angles of incidence, deg.
const ANGLES_DEG: [u32; 6] = [0, 15, 30, 45, 60, 75];
/// Azimuths of incidence over which shares are averaged.
const AZIMUTHS: u32 = 24;

fn main() -> Result<(), Box<dyn Error>> {
    let name = std::env::args().nth(1).ok_or("usage: describe_bsdf FILE.xml|csv")?;
    let file = read(Path::new(&name)).map_err(|error| format!("{name}: {error}"))?;
    let angles = ANGLES_DEG.map(|angle| format!("{angle:>7}°"));
    let title = "share of light, %";
    println!("{title:<18} {}", angles.join(" "));
    for (side, sheet) in [("front", &file.front), ("back", &file.back)] {
        for (what, matrix) in [("reflect", &sheet.reflection), ("transmit", &sheet.transmission)] {
            let Some(matrix) = matrix else { continue };
            let percent = |angle: u32| 100.0 * share(matrix, f64::from(angle));
            let shares = ANGLES_DEG.map(|angle| format!("{:>8.2}", percent(angle)));
            println!("{side:<6} {what:<11} {}", shares.join(" "));
        }
    }
    file.remarks.iter().for_each(|remark| println!("remark: {remark}"));
    Ok(())
}

/// Light that leaves as a share of light that arrives at this polar angle, the mean over azimuths, 1.
fn share(matrix: &BsdfMatrix, polar_deg: f64) -> f64 {
    let [_, leaving] = matrix.pairs.counts();
    let at_azimuth = |number: u32| -> f64 {
        let (y, x) = f64::from(number * 360 / AZIMUTHS).to_radians().sin_cos();
        let patch = matrix.pairs.incident(polar_deg.to_radians().sin() * DVec2::new(x, y));
        let values = &matrix.values[patch * leaving..(patch + 1) * leaving];
        values.iter().zip(0..).map(|(value, to)| value * matrix.pairs.leaving_projected(to)).sum()
    };
    (0..AZIMUTHS).map(at_azimuth).sum::<f64>() / f64::from(AZIMUTHS)
}
