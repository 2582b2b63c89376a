//! Gather paths start in every cell equally often: errors of cells and of sums stay honest.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod traced;

use lumiduct_core::measure::{MapAxes, Measures};
use lumiduct_core::plan::Request;
use lumiduct_core::rng::Sampler;
use lumiduct_core::scene::{Arrivals, PolarLaw, SensorId, SensorKind};
use lumiduct_input::Settings;
use std::f64::consts::PI;

/// A short mirror tube with sensors of all kinds whose cells are strata.
const TUBE: &str = r#"
[finishes.mirror]
specular = { reflectance = 0.9 }
[sheets.tube.tube]
profile = { circle = { radius_mm = 5 } }
path = [{ straight_mm = 20 }]
finish = "mirror"
[sources.lamp.disk]
radius_mm = 4
at = { position_mm = [0.5, 0, 0] }
flux_lm = 10
[sensors]
exit = { plane = { cells = [7, 7] }, on = "tube.exit", counts = "leaving" }
rings = { plane = { rings = 3, sectors = 4 }, on = "tube.exit", counts = "leaving" }
wall = { plane = { cells = [3, 2] }, on = "tube.wall", counts = "incident", side = "back" }
views = { luminance = { cells = [4, 4], acceptance_half_angle_deg = 20, directions = [{ theta_deg = 0, phi_deg = 0 }, { theta_deg = 30, phi_deg = 0 }] }, on = "tube.exit", counts = "leaving" }
far = { goniometer = { c_step_deg = 90, gamma_step_deg = 15 }, at = { face = "tube.exit" } }
near = { goniometer = { c_step_deg = 90, gamma_step_deg = 15, radius_mm = 60 }, at = { face = "tube.exit" } }
"#;

/// At least 64 batches, sized by this many photons.
fn measures(text: &str, estimator: Request, (seed, photons): (u64, u64)) -> Measures {
    let settings = Settings {
        paths: Some(64 * photons),
        estimator: Some(estimator),
        seed: Some(seed),
        ..Settings::default()
    };
    let mut job = traced::load(text, &settings);
    job.run.batch_paths = Some(photons);
    traced::measures(&job)
}

/// Values of all cells that are lit, and of the fluxes, with their errors.
fn estimates(found: &Measures) -> Vec<(f64, f64)> {
    let maps = found.maps.iter().flat_map(|map| map.values.iter().zip(&map.std_errors));
    let tables = found.intensities.iter().flat_map(|own| own.values.iter().zip(&own.std_errors));
    let cells = maps.chain(tables).map(|(value, error)| (*value, *error));
    let fluxes = found.values.iter().filter(|(name, _)| name.ends_with(".flux"));
    cells.chain(fluxes.map(|(_, own)| (own.value, own.std_error))).collect()
}

/// Root mean square of the deviations from the mean over seeds in standard errors, for each estimate that
/// all runs know.
fn spreads(text: &str, (seeds, photons): (u64, u64)) -> Vec<f64> {
    let runs: Vec<Vec<(f64, f64)>> = (0..seeds)
        .map(|seed| estimates(&measures(text, Request::Backward, (seed, photons))))
        .collect();
    let count = runs.len() as f64;
    let of = |place: usize| {
        let all = runs.iter().map(|run| run[place]);
        let mean = all.clone().map(|(value, _)| value).sum::<f64>() / count;
        let squares = all.map(|(value, error)| ((value - mean) / error).powi(2)).sum::<f64>();
        (squares / (count - 1.0)).sqrt()
    };
    let is_known = |place: &usize| runs.iter().all(|run| is_known(run[*place]));
    (0..runs[0].len()).filter(is_known).map(of).collect()
}

/// Whether an estimate has more than ten counts: the error of fewer is not trustworthy.
fn is_known((value, error): (f64, f64)) -> bool {
    error > 0.0 && error < 0.32 * value
}

fn root_mean_square(all: &[f64]) -> f64 {
    (all.iter().map(|one| one * one).sum::<f64>() / all.len() as f64).sqrt()
}

#[test]
fn errors_of_cells_and_of_fluxes_are_those_found_over_seeds() {
    // Batches with many paths a cell, and with fewer paths than cells.
    for photons in [1024, 128] {
        let spreads = spreads(TUBE, (60, photons));
        assert!(spreads.len() > 50, "{photons}: {}", spreads.len());
        let all = root_mean_square(&spreads);
        assert!((0.9..1.1).contains(&all), "{photons}: {all}");
    }
}

#[test]
fn cells_add_up_to_the_flux() {
    let found = measures(TUBE, Request::Backward, (1, 1024));
    let exit = &found.values["exit.flux"];
    assert_eq!(exit.paths % (45 * exit.batches), 0, "{} paths", exit.paths);
    for map in found.maps.iter().filter(|map| map.sensor != "views") {
        let (rows, columns) = map.values.dim();
        let area = |row: usize, column: usize| match &map.axes {
            MapAxes::Cartesian { u_mm, v_mm } => {
                (u_mm[column + 1] - u_mm[column]) * (v_mm[row + 1] - v_mm[row])
            }
            MapAxes::Polar { radius_mm, sector_deg } => {
                let turn = (sector_deg[column + 1] - sector_deg[column]).to_radians();
                0.5 * turn * (radius_mm[row + 1].powi(2) - radius_mm[row].powi(2))
            }
            MapAxes::Angular { .. } => panic!("no image"),
        };
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let fluxes = places
            .filter(|place| map.on_sensor[*place] > 0.0)
            .map(|place| map.values[place] * area(place.0, place.1) * map.on_sensor[place]);
        let sum = 1e-6 * fluxes.sum::<f64>();
        let flux = found.values[&format!("{}.flux", map.sensor)].value;
        assert!((sum / flux - 1.0).abs() < 1e-9, "{}: {sum}, {flux}", map.sensor);
    }
}

#[test]
fn cells_have_the_light_that_photons_find_there() {
    const SEEDS: u64 = 12;
    let photons = estimates(&measures(TUBE, Request::Forward, (7, 65_536)));
    let mut sigmas = Vec::new();
    for seed in 0..SEEDS {
        let paths = estimates(&measures(TUBE, Request::Backward, (seed, 2048)));
        let both = photons.iter().zip(&paths).filter(|(a, b)| is_known(**a) && is_known(**b));
        sigmas.extend(both.map(|(a, b)| (a.0 - b.0) / a.1.hypot(b.1)));
    }
    assert!(sigmas.len() > 100 * SEEDS as usize, "{}", sigmas.len());
    // Cells of a run share their points, so that one run alone may be 1.3.
    let spread = root_mean_square(&sigmas);
    assert!((0.9..1.1).contains(&spread), "{spread}");
    assert!(sigmas.iter().all(|own| own.abs() < 5.0), "{sigmas:?}");
}

#[test]
fn more_cells_than_a_batch_has_paths_are_one_stratum() {
    for (cells, strata) in [("[300, 200]", 300 * 200), ("[400, 400]", 1)] {
        let text = format!(
            "{TUBE}[sensors.fine]\nplane = {{ cells = {cells} }}\non = \"tube.wall\"\ncounts = \"incident\"\nside = \"back\"\n"
        );
        let job = traced::load(&text, &Settings::default());
        let fine = job.scene.sensors.iter().position(|own| own.name == "fine").unwrap();
        let arrivals = Arrivals::new(&job.scene, SensorId::new(fine));
        assert_eq!(arrivals.strata().count(), strata);
    }
}

/// Adds a number to a sum and its square to a sum of squares.
fn add([sum, squares]: &mut [f64; 2], number: f64) {
    *sum += number;
    *squares += number * number;
}

/// Mean of so many numbers, from the sums of themselves and their squares, with its standard error.
fn mean(sums: [f64; 2], numbers: u64) -> [f64; 2] {
    let [mean, squares] = sums.map(|sum| sum / numbers as f64);
    [mean, ((squares - mean * mean).max(0.0) / numbers as f64).sqrt()]
}

#[test]
fn starts_lie_in_their_cells_and_represent_the_whole_of_them() {
    const DRAWS: u64 = 4096;
    let job = traced::load(TUBE, &Settings::default());
    for (id, sensor) in job.scene.sensors.iter().enumerate() {
        let arrivals = Arrivals::new(&job.scene, SensorId::new(id));
        let strata = arrivals.strata();
        let count = strata.count();
        // Corners of the square around the disk of the exit have no cells.
        let expected = match sensor.name.as_str() {
            "exit" => 45,
            "views" => 2 * 16,
            _ => sensor.cells(),
        };
        assert_eq!(count, expected, "{}", sensor.name);
        let mut etendues = vec![[0.0; 2]; sensor.cells()];
        // Of second and of first order.
        let mut totals = [[0.0; 2]; 2];
        for stratum in 0..count {
            let mut cells = Vec::new();
            let mut moments = [[0.0; 2]; 2];
            for draw in 0..DRAWS {
                let mut sampler = Sampler::for_path(id as u64, stratum as u64, draw);
                let Some(start) = arrivals.draw_in((&strata, stratum), &mut sampler) else {
                    continue;
                };
                for cell in &start.cells {
                    add(&mut etendues[*cell], start.extent / count as f64);
                }
                let at = start.ray.origin();
                let extent = start.extent / count as f64;
                add(&mut moments[0], extent * (at.x * at.x + at.y * at.y));
                add(&mut moments[1], extent * (at.x + at.y));
                cells.extend(start.cells);
            }
            for ([total, variance], sums) in totals.iter_mut().zip(moments) {
                let [mean, std_error] = mean(sums, DRAWS);
                (*total, *variance) = (*total + mean, *variance + std_error * std_error);
            }
            cells.sort_unstable();
            cells.dedup();
            // Acceptance cones of two views overlap.
            let most = if sensor.name == "views" { 2 } else { 1 };
            assert!((1..=most).contains(&cells.len()), "{} {stratum}: {cells:?}", sensor.name);
        }
        let SensorKind::Surface(surface) = &sensor.kind else { continue };
        match sensor.name.as_str() {
            "views" => continue,
            // Starts are even within the cells, too: π times ∫ r² dA = π R⁴/2 of the disk, and ∫ x + y dA = 0, in which faults at
            // opposite rims do not cancel.
            "exit" => {
                let [second, first] = totals.map(|[total, variance]| (total, variance.sqrt()));
                let off = (second.0 - 0.5 * PI * PI * 625.0).abs();
                assert!(off < 4.0 * second.1, "{} ± {}", second.0, second.1);
                assert!(second.1 < 1e-3 * second.0);
                assert!(first.0.abs() < 4.0 * first.1, "{} ± {}", first.0, first.1);
            }
            _ => {}
        }
        for (cell, area) in surface.areas.iter().enumerate() {
            let expected = PI * area;
            // Only points of cells that a rim cuts have different densities.
            let [mean, std_error] = mean(etendues[cell], DRAWS);
            let error = (mean - expected).abs();
            let most = 4.0 * std_error + 1e-9 * expected.max(1.0);
            assert!(error < most, "{} {cell}: {mean} for {expected}", sensor.name);
            let is_cut = surface.covered[cell] < 1.0;
            assert!(is_cut || std_error < 1e-6 * expected, "{} {cell}", sensor.name);
        }
    }
}

#[test]
fn starts_at_learned_angles_represent_half_spaces() {
    const DRAWS: u64 = 40_000;
    let text = format!(
        "{TUBE}both = {{ plane = {{ cells = [3, 2] }}, on = \"tube.wall\", counts = \"incident\", side = \"both\" }}\n\
         leaving = {{ plane = {{ cells = [3, 2] }}, on = \"tube.wall\", counts = \"leaving\", side = \"back\" }}\n"
    );
    let job = traced::load(&text, &Settings::default());
    let beam = std::array::from_fn(|bin| 0.5f64.powi(bin as i32));
    let learned = PolarLaw::learned(&[beam; 2]);
    assert!(matches!(learned, PolarLaw::Learned(_)));
    for (id, sensor) in job.scene.sensors.iter().enumerate() {
        for law in [PolarLaw::EvenBins, learned.clone()] {
            let mut arrivals = Arrivals::new(&job.scene, SensorId::new(id));
            arrivals.set_polar(law);
            let sees_half_spaces = !["views", "far"].contains(&sensor.name.as_str());
            assert_eq!(arrivals.see_half_spaces(), sees_half_spaces, "{}", sensor.name);
            if !sees_half_spaces {
                continue;
            }
            let area = match &sensor.kind {
                SensorKind::Surface(surface) => surface.areas.iter().sum::<f64>(),
                SensorKind::Goniometer(_) => 4.0 * PI * 60.0f64.powi(2),
            };
            let sides = if sensor.name == "both" { 2.0 } else { 1.0 };
            // ∫ cos θ dω = π and ∫ cos³ θ dω = π/2 over a half space.
            let mut sums = [[0.0; 2]; 2];
            for draw in 0..DRAWS {
                let mut sampler = Sampler::for_path(id as u64, 0, draw);
                let Some(start) = arrivals.draw(&mut sampler) else { continue };
                let cos = start.ray.dir().dot(start.normal);
                add(&mut sums[0], start.extent);
                add(&mut sums[1], start.extent * cos * cos);
            }
            for (sums, expected) in sums.into_iter().zip([PI, 0.5 * PI]) {
                let expected = sides * area * expected;
                let [mean, std_error] = mean(sums, DRAWS);
                assert!((mean - expected).abs() < 4.0 * std_error, "{}: {mean}", sensor.name);
                assert!(std_error < 0.02 * expected, "{}: ± {std_error}", sensor.name);
            }
        }
    }
}

/// A mirror tube of aspect 100 behind a disk that fills its entry.
const LONG_TUBE: &str = r#"
[finishes.mirror]
specular = { reflectance = 0.95 }
[sheets.duct.tube]
profile = { circle = { radius_mm = 5 } }
path = [{ straight_mm = 1000 }]
finish = "mirror"
[sources.led.disk]
radius_mm = 5
at = { face = "duct.entry" }
flux_lm = 1
[sensors]
exit = { plane = { cells = [4, 4] }, on = "duct.exit", counts = "leaving" }
"#;
/// Its exit flux, lm: closed form after Swift & Smith, Sol. Energy Mater. Sol. Cells 36 (1995) 159.
const LONG_TUBE_FLUX: f64 = 0.044_426_15;

#[test]
fn gather_paths_learn_at_which_angles_light_leaves_a_long_tube() {
    const SEEDS: u64 = 30;
    let (mut sigmas, mut of_flux, mut of_cells) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 0..SEEDS {
        let settings = Settings {
            paths: Some(65_536),
            estimator: Some(Request::Backward),
            seed: Some(seed),
            ..Settings::default()
        };
        let mut job = traced::load(LONG_TUBE, &settings);
        job.run.stop.batches = Some(64);
        let found = traced::measures(&job);
        let flux = &found.values["exit.flux"];
        sigmas.push((flux.value - LONG_TUBE_FLUX) / flux.std_error);
        of_flux.push(flux.std_error / flux.value);
        let map = &found.maps[0];
        let [errors, values] = [&map.std_errors, &map.values]
            .map(|all| root_mean_square(&all.iter().copied().collect::<Vec<f64>>()));
        of_cells.push(errors / values);
    }
    let [of_flux, of_cells] = [of_flux, of_cells].map(|errors: Vec<f64>| root_mean_square(&errors));
    // By the cosine law they are 7.5e-4 and 4.5e-3.
    assert!(of_flux < 4e-4 && of_cells < 2e-3, "{of_flux}, {of_cells}");
    let spread = root_mean_square(&sigmas);
    assert!((0.7..1.3).contains(&spread), "{spread}: {sigmas:?}");
}

#[test]
fn what_gather_paths_learn_is_the_same_on_any_number_of_threads() {
    let found = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| estimates(&measures(LONG_TUBE, Request::Backward, (1, 1024))))
    });
    assert_eq!(found[0], found[1]);
}
