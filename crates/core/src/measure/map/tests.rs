use crate::measure::samples::{add, disk, luminance, readings, rectangle, rings, scene};
use crate::measure::{Measures, Status, measure};
use crate::scene::{Scene, SensorId, SensorKind, SourceId};
use crate::transport::Findings;
use glam::DVec2;

/// Readings without noise of a field over the first sensor: illuminance at the middle of each cell, lm/mm².
fn exactly(scene: &Scene, field: impl Fn(DVec2) -> f64) -> Findings {
    let SensorKind::Surface(sensor) = &scene.sensors[0].kind else { panic!("no surface") };
    // The sums over two equal batches are exact.
    readings(scene, 2, |_, layout, batch| {
        for (cell, area) in sensor.areas.iter().enumerate() {
            let flux = field(sensor.grid.center(cell)) * area;
            batch.sensors[0].cells.add(cell, flux);
            add(batch, layout.sensor_flux(SensorId::new(0), SourceId::new(0)), flux);
        }
    })
}

fn assert_value(measures: &Measures, name: &str, expected: f64, tolerance: f64) {
    let found = &measures.values[name];
    assert!((found.value - expected).abs() <= tolerance, "{name}: {found}, not {expected}");
}

#[test]
fn cos4_on_25_cells_has_the_reference_statistics() {
    // Reference case PH-07 (b): Lambertian point at height 1 over the unit square, 5 x 5 points.
    let scene = scene(&[("led", 1.0)], vec![("exit", rectangle(1.0, 5, 5))]);
    let cos4 = |p: DVec2| 1e-6 / (1.0 + p.length_squared()).powi(2);
    let measures = measure(&scene, &exactly(&scene, cos4));
    assert_value(&measures, "exit.illuminance_avg", 0.758_058_856_3, 1e-9);
    assert_value(&measures, "exit.uniformity_min_avg", 0.757_092_966_7, 1e-9);
    assert_value(&measures, "exit.uniformity_min_max", 0.573_921_028_5, 1e-9);
    assert_value(&measures, "exit.cv", 0.162_151_587, 1e-9);
    assert_value(&measures, "exit.illuminance_center", 1.0, 1e-12);
    assert_value(&measures, "exit.illuminance_min", 1.0 / 1.32f64.powi(2), 1e-12);
    // Corner, edge and middle points of nine: r² of 0.32, 0.16 and 0.
    let (corner, edge) = (1.0 / 1.32f64.powi(2), 1.0 / 1.16f64.powi(2));
    let mean = (4.0 * corner + 4.0 * edge + 1.0) / 9.0;
    assert_value(&measures, "exit.uniformity9_min_avg", corner / mean, 1e-12);
    assert_value(&measures, "exit.uniformity9_max_min", 1.0 / corner, 1e-12);
    let mean = (8.0 * corner + 4.0 * edge + 1.0) / 13.0;
    assert_value(&measures, "exit.uniformity13_min_avg", corner / mean, 1e-12);
    assert_eq!(measures.maps[0].summary.cell_size, [0.2, 0.2]);
}

#[test]
fn cells_cut_by_the_rim_are_taken_together_for_the_extremes() {
    let scene = scene(&[("led", 1.0)], vec![("exit", disk(2.0, 20))]);
    let even = |_: DVec2| 3e-6;
    let measures = measure(&scene, &exactly(&scene, even));
    for name in ["min", "max", "avg", "center"] {
        assert_value(&measures, &format!("exit.illuminance_{name}"), 3.0, 1e-9);
    }
    assert_value(&measures, "exit.cv", 0.0, 1e-7);
    let map = &measures.maps[0];
    assert!(map.values[[0, 0]].is_nan(), "a corner of the square is off the disk");
    let on = map.values.iter().filter(|value| !value.is_nan()).count();
    assert!(map.summary.cells < on, "{} of {on}", map.summary.cells);
    assert!((map.area_mm2 - std::f64::consts::PI * 4.0).abs() < 1e-9);
    // Light on cells whose middle is off the disk is light of the sensor.
    let bright = |p: DVec2| if p.length() > 2.0 { 30e-6 } else { 3e-6 };
    let measures = measure(&scene, &exactly(&scene, bright));
    assert_value(&measures, "exit.illuminance_max", 30.0, 1e-9);
    assert_value(&measures, "exit.illuminance_min", 3.0, 1e-9);
    assert!(measures.values["exit.illuminance_avg"].value > 3.01);
}

#[test]
fn what_negative_weights_make_negative_has_an_error_that_reaches_zero_and_is_no_extreme() {
    let dim = |p: DVec2| if p.x < -0.3 && p.y < -0.3 { -2e-6 } else { 3e-6 };
    let planes = [rectangle(1.0, 5, 5), luminance(1.0, 5, 5, &[1.0])];
    for (kind, quantity) in planes.into_iter().zip(["illuminance", "luminance"]) {
        let scene = scene(&[("led", 1.0)], vec![("exit", kind)]);
        let measures = measure(&scene, &exactly(&scene, dim));
        let map = &measures.maps[0];
        assert_eq!(map.quantity, quantity);
        assert!((map.values[[0, 0]] + 2.0).abs() < 1e-9 && map.std_errors[[0, 0]] >= 2.0 - 1e-9);
        assert!((map.values[[2, 2]] - 3.0).abs() < 1e-9 && map.std_errors[[2, 2]] == 0.0);
        let view = if quantity == "luminance" { ".0" } else { "" };
        let least = &measures.values[&format!("exit.{quantity}_min{view}")];
        assert!((0.0..=3.0).contains(&least.value), "{quantity}: {least}");
        assert!(least.std_error >= 0.0 && least.value - least.std_error < 1e-9, "{least}");
        for name in ["uniformity_min_avg", "uniformity_min_max"] {
            let own = &measures.values[&format!("exit.{name}{view}")];
            assert!((0.0..=1.0).contains(&own.value), "{quantity} {name}: {own}");
        }
        if quantity == "illuminance" {
            let cell = &measures.values["exit.cell.0.0"];
            assert!((cell.value + 2.0).abs() < 1e-9 && cell.std_error >= 2.0 - 1e-9, "{cell}");
        }
    }
}

#[test]
fn rings_have_their_mean_illuminance() {
    let scene = scene(&[("led", 1.0)], vec![("exit", rings(1.0, 4, 6))]);
    // The middle of a polar cell is given as radius and angle.
    let cone = |p: DVec2| 1e-6 * (1.0 - 0.5 * p.x) * (1.0 + 0.1 * p.y.cos());
    let measures = measure(&scene, &exactly(&scene, cone));
    for ring in 0..4 {
        let expected = 1.0 - 0.5 * (f64::from(ring) + 0.5) / 4.0;
        assert_value(&measures, &format!("exit.ring.{ring}"), expected, 1e-12);
    }
    assert_value(&measures, "exit.illuminance_center", 0.9375, 1e-12);
    let angle = 30f64.to_radians().cos();
    assert_value(&measures, "exit.cell.0.3", 0.5625 * (1.0 + 0.1 * angle), 1e-12);
}

#[test]
fn luminance_is_flux_over_area_and_projected_solid_angle() {
    let scene = scene(&[("led", 1.0)], vec![("eye", luminance(2.0, 2, 2, &[0.02, 0.05]))]);
    let readings = readings(&scene, 128, |_, _, batch| {
        for cell in 0..4 {
            batch.sensors[0].cells.add(cell, 1e-6 * (cell + 1) as f64);
            batch.sensors[0].cells.add(4 + cell, 1e-6);
        }
    });
    let measures = measure(&scene, &readings);
    // Cells of 1 mm²: 1e-6 lm / (1e-6 m² 0.02 sr) = 50 cd/m².
    assert_value(&measures, "eye.luminance_min.0", 50.0, 1e-6);
    assert_value(&measures, "eye.luminance_avg.0", 125.0, 1e-6);
    assert_value(&measures, "eye.cell.1.1.0", 200.0, 1e-6);
    assert_value(&measures, "eye.luminance_avg.1", 20.0, 1e-6);
    assert_value(&measures, "eye.uniformity_min_avg.1", 1.0, 1e-6);
    assert_eq!(measures.values["eye.luminance_avg.1"].unit, "cd/m²");
    assert_eq!(measures.maps.len(), 2);
}

#[test]
fn cells_have_the_error_of_the_mean_over_batches() {
    let scene = scene(&[("led", 1.0)], vec![("exit", rectangle(2.0, 2, 1))]);
    let readings = readings(&scene, 128, |index, _, batch| {
        batch.sensors[0].cells.add(0, if index % 2 == 0 { 1e-6 } else { 3e-6 });
        if index == 7 {
            batch.sensors[0].cells.add(1, 1e-6);
        }
    });
    let measures = measure(&scene, &readings);
    // 2e-6 lm on 2 mm²; standard deviation 1e-6 √(128/127), over √128.
    let cell = &measures.values["exit.cell.0.0"];
    assert!((cell.value - 1.0).abs() < 1e-12);
    assert!((cell.std_error - 0.5 / 127f64.sqrt()).abs() < 1e-12);
    assert_eq!(measures.values["exit.cell.1.0"].status, Status::TooFew);
}

#[test]
fn a_dark_map_has_no_signal_and_says_what_one_path_would_be() {
    let scene = scene(&[("led", 5.0)], vec![("exit", rectangle(2.0, 3, 3))]);
    let measures = measure(&scene, &readings(&scene, 128, |_, _, _| {}));
    for (name, measure) in measures.values.iter().filter(|(name, _)| name.starts_with("exit")) {
        assert_eq!(measure.status, Status::NoSignal, "{name}");
    }
    let path = 5.0 / 128_000.0;
    assert!((measures.values["exit.flux"].std_error - path).abs() < 1e-18);
    let cell = measures.values["exit.cell.1.1"].std_error;
    assert!((cell - path / (4.0 / 9.0) * 1e6).abs() < 1e-9);
}
