//! Maps and intensities by light group, from traced light, by every estimator.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod traced;

use lumiduct_core::measure::{Measures, SensorMap, Status};
use lumiduct_core::plan::Request;
use lumiduct_input::Settings;
use std::f64::consts::PI;

fn measures(estimator: Request, paths: u64, text: &str) -> Measures {
    let settings =
        Settings { paths: Some(paths), estimator: Some(estimator), ..Settings::default() };
    traced::measures(&traced::load(text, &settings))
}

/// A short rod, lit by three LEDs in two groups.
const ROD: &str = r#"
[media]
pmma = { index = 1.49 }
[solids.rod.box]
size_mm = [6, 4, 12]
medium = "pmma"
[sources]
a.disk = { radius_mm = 0.8, flux_lm = 3, at = { position_mm = [-1.5, 0, -0.2] }, group = "outer" }
b.disk = { radius_mm = 0.8, flux_lm = 1, at = { position_mm = [1.5, 0, -0.2] }, group = "outer" }
c.disk = { radius_mm = 0.8, flux_lm = 2, at = { position_mm = [0, 0, -0.2] }, group = "middle" }
[sensors]
exit = { plane = { cells = [6, 4] }, on = "rod.exit", counts = "leaving" }
far = { goniometer = { c_step_deg = 45, gamma_step_deg = 15 }, at = { face = "rod.exit" }, aim = ["rod.exit"] }
"#;

/// Asserts that the maps of the groups add to that of all light, and returns the number of cells.
fn assert_sums(what: &str, measures: &Measures) -> usize {
    let tables = measures.intensities.iter().map(|own| (&own.sensor, &own.light, &own.values));
    let maps = measures.maps.iter().map(|own| (&own.sensor, &own.light, &own.values));
    let all: Vec<_> = maps.chain(tables).collect();
    let mut cells = 0;
    for (sensor, _, whole) in all.iter().filter(|(_, light, _)| light.is_none()) {
        let parts: Vec<_> = all.iter().filter(|own| own.0 == *sensor && own.1.is_some()).collect();
        assert_eq!(parts.len(), 2, "{what}: {sensor}");
        let most = whole.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        assert!(most > 0.0, "{what}: {sensor} is dark");
        for (cell, value) in whole.indexed_iter() {
            let sum: f64 = parts.iter().map(|(_, _, values)| values[cell]).sum();
            assert!((sum - value).abs() < 1e-9 * most, "{what}: {sensor} {cell:?}: {sum} {value}");
            cells += 1;
        }
    }
    cells
}

#[test]
fn maps_of_groups_add_to_the_map_of_all_light_cell_by_cell_by_every_estimator() {
    for estimator in [
        Request::Forward,
        Request::Backward,
        Request::Mix,
        Request::Gather,
        Request::Mis,
        Request::Auto,
    ] {
        let measures = measures(estimator, 20_000, ROD);
        let what = format!("{estimator:?}");
        assert_eq!(assert_sums(&what, &measures), 24 + 96, "{what}");
        for name in ["flux", "illuminance_avg"] {
            let of = |light: &str| measures.values[&format!("exit.{name}{light}")].value;
            let sum = of(".from.outer") + of(".from.middle");
            assert!((sum / of("") - 1.0).abs() < 1e-9, "{what}: {name}");
        }
        let is_biased = |map: &&SensorMap| map.biases.is_some();
        let biased = measures.maps.iter().filter(is_biased).count();
        assert!([0, measures.maps.len()].contains(&biased), "{what}: {biased} with a bias");
    }
}

/// Two Lambertian disks of one radius at different heights over a plane, 30 mm aside of each other.
const LAMPS: &str = r#"
[sources]
near.disk = { radius_mm = 10, flux_lm = 50, at = { position_mm = [0, 0, 40], axis = [0, 0, -1] }, group = "near_lamp" }
high.disk = { radius_mm = 10, flux_lm = 200, at = { position_mm = [30, 0, 100], axis = [0, 0, -1] }, group = "high_lamp" }
[sensors]
floor = { plane = { rectangle = { width_mm = 60, height_mm = 40 }, cells = [6, 4] }, at = { position_mm = [0, 0, 0] }, side = "front" }
"#;

/// Illuminance [lx] of a plane at `aside` mm from the axis of a parallel Lambertian disk of radius `a` mm at `h` mm: with
/// its exitance M, E = M/2 (1 - (r² + h² - a²)/√((r² + h² + a²)² - 4 r² a²)) (Foote, Bull. Bureau of Standards 12
/// (1915) 583); on the axis π L sin² of the disk's half angle.
fn under_disk(flux: f64, a: f64, h: f64, aside: f64) -> f64 {
    let (a2, h2, r2) = (a * a, h * h, aside * aside);
    let exitance = 1e6 * flux / (PI * a2);
    let root = ((r2 + h2 + a2).powi(2) - 4.0 * r2 * a2).sqrt();
    0.5 * exitance * (1.0 - (r2 + h2 - a2) / root)
}

#[test]
fn each_of_two_lamps_obeys_the_law_of_the_disk_in_the_map_of_its_group() {
    for (estimator, paths) in [(Request::Forward, 2_000_000), (Request::Backward, 8_000_000)] {
        let measures = measures(estimator, paths, LAMPS);
        for (light, flux, h, x) in
            [("near_lamp", 50.0, 40.0, 0.0), ("high_lamp", 200.0, 100.0, 30.0)]
        {
            // Mean over a cell by the midpoint rule.
            let mean = |row: usize, column: usize| {
                let at = |cell: usize, i: usize| 10.0 * cell as f64 + (i as f64 + 0.5) / 2.0;
                let place = |i: usize| (at(column, i % 20) - 30.0, at(row, i / 20) - 20.0);
                let one = |i: usize| {
                    let (u, v) = place(i);
                    under_disk(flux, 10.0, h, (u - x).hypot(v))
                };
                (0..400).map(one).sum::<f64>() / 400.0
            };
            let map = measures.maps.iter().find(|map| map.light.as_deref() == Some(light)).unwrap();
            let mut expected = Vec::new();
            for ((row, column), value) in map.values.indexed_iter() {
                let law = mean(row, column);
                let error = map.std_errors[[row, column]];
                let what = format!("{estimator:?} {light} {row} {column}");
                assert!(error < 0.03 * law, "{what}: {error} of {law} lx");
                let room = 4.5 * error + 1e-4 * law;
                assert!((value - law).abs() < room, "{what}: {value} ± {error}, not {law}");
                expected.push(law);
            }
            let least = expected.iter().copied().fold(f64::INFINITY, f64::min);
            let avg = expected.iter().sum::<f64>() / expected.len() as f64;
            let even = &measures.values[&format!("floor.uniformity_min_avg.from.{light}")];
            assert_eq!(even.status, Status::Ok, "{light}: {even}");
            let off = (even.value - least / avg).abs() / even.total_error();
            assert!(off < 4.0, "{estimator:?} {light}: {even}, not {}", least / avg);
        }
    }
}
