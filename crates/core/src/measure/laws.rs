//! Laws that hold for every map, whatever its cells: extremes enclose the average, the middle, the points and every
//! cell that counts.

use crate::measure::samples::{add, disk, image, readings, rectangle, rings, scene};
use crate::measure::{Measures, SensorMap, Status, measure};
use crate::rng::{Dimension, Sampler};
use crate::scene::{Grid, Pixels, Scene, Seeing, SensorId, SensorKind, SourceId, SurfaceSensor};
use crate::transport::Findings;
use glam::DVec2;
use lumiduct_base::math::Frame;

/// Position of a cell from the middle of its map, in half-widths.
fn place(grid: &Grid, cell: usize) -> DVec2 {
    let at = grid.center(cell);
    match grid {
        Grid::Cartesian { rect, .. } => {
            let half = 0.5 * (rect.max - rect.min);
            (at - rect.min - half) / half
        }
        Grid::Polar { radius, .. } => DVec2::from_angle(at.y) * at.x / radius,
    }
}

fn sensor(scene: &Scene) -> &SurfaceSensor {
    match &scene.sensors[0].kind {
        SensorKind::Surface(sensor) => sensor,
        SensorKind::Goniometer(_) => panic!("no surface"),
    }
}

/// Areas of the cells, or areas times projected solid angles of the pixels, and their grid.
fn extents(sensor: &SurfaceSensor) -> (Vec<f64>, Grid) {
    match &sensor.seeing {
        Seeing::All | Seeing::Views(_) => (sensor.areas.clone(), sensor.grid.clone()),
        Seeing::Pixels(pixels) => (pixels.projected.clone(), pixels.grid.clone()),
    }
}

/// Readings of a field in 128 batches, each cell with noise of so many counts per unit of flux;
/// `None` gives no noise.
fn lit(scene: &Scene, counts: Option<f64>, seed: u64, field: &dyn Fn(DVec2) -> f64) -> Findings {
    let (extents, grid) = extents(sensor(scene));
    let whole: f64 = extents.iter().sum();
    readings(scene, 128, |index, layout, batch| {
        let mut sampler = Sampler::for_path(seed, 7, index);
        let mut total = 0.0;
        for (cell, extent) in extents.iter().enumerate() {
            let flux = field(place(&grid, cell)) * extent / whole;
            let swing = counts.map_or(0.0, |counts| {
                // Uniform with the variance of Poisson counts.
                (sampler.one(Dimension::Resampling) - 0.5) * (12.0 * flux * 128.0 / counts).sqrt()
            });
            batch.sensors[0].cells.add(cell, flux + swing);
            total += flux + swing;
        }
        add(batch, layout.sensor_flux(SensorId::new(0), SourceId::new(0)), total);
    })
}

/// An image that reaches 50 degrees to the right, where a pixel is six times smaller than in the middle.
fn wide_image() -> SensorKind {
    match image(40, 30) {
        SensorKind::Surface(mut sensor) => {
            sensor.seeing = Seeing::Pixels(Box::new(Pixels::new(&Frame::WORLD, [40, 30], 0.06)));
            SensorKind::Surface(sensor)
        }
        SensorKind::Goniometer(_) => panic!("no surface"),
    }
}

fn kinds() -> [(&'static str, SensorKind); 5] {
    [
        ("square", rectangle(2.0, 12, 12)),
        ("disk", disk(1.0, 15)),
        ("rings", rings(1.0, 12, 1)),
        ("sectors", rings(1.0, 8, 5)),
        ("image", wide_image()),
    ]
}

/// Light per area, by the position from the middle.
type Light = Box<dyn Fn(DVec2) -> f64>;

fn fields() -> Vec<(&'static str, Light)> {
    vec![
        ("flat", Box::new(|_| 1.0)),
        ("hot spot", Box::new(|p: DVec2| if p.length() < 0.2 { 20.0 } else { 1.0 })),
        ("dark spot", Box::new(|p: DVec2| if p.length() < 0.2 { 0.1 } else { 1.0 })),
        ("rim", Box::new(|p: DVec2| if p.length() > 0.93 { 5.0 } else { 1.0 })),
        ("slope", Box::new(|p: DVec2| 1.0 + 0.9 * p.x)),
        ("lamp aside", Box::new(|p: DVec2| if p.x > 0.9 { 100.0 } else { 0.0 })),
    ]
}

/// Asserts the laws of a map within 4 errors of both sides.
fn assert_laws(what: &str, measures: &Measures, map: &SensorMap) {
    let all = &map.summary.all;
    let error =
        |value: &crate::measure::Statistic| value.std_error.hypot(value.bias.unwrap_or(0.0));
    let below = |law: &str, low: (f64, f64), high: (f64, f64)| {
        let room = 4.0 * low.1.hypot(high.1) + 1e-9 * low.0.abs().max(high.0.abs());
        assert!(low.0 <= high.0 + room, "{what}: {law}: {low:?} above {high:?}");
    };
    let [min, max, avg] = [&all.min, &all.max, &all.avg].map(|one| (one.value, error(one)));
    below("min and avg", min, avg);
    below("avg and max", avg, max);
    let center = &measures.values[&format!("exit.{}_center", map.quantity)];
    below("min and centre", min, (center.value, center.std_error));
    below("centre and max", (center.value, center.std_error), max);
    for set in [&map.summary.nine, &map.summary.thirteen].into_iter().flatten() {
        below("min and points", min, (set.min.value, error(&set.min)));
        below("points and max", (set.max.value, error(&set.max)), max);
    }
    for statistic in [&all.min_avg, &all.min_max, &map.summary.cv] {
        let [low, high] = statistic.interval;
        let rounding = 1e-9 * statistic.value;
        let inside = low <= statistic.value + rounding && statistic.value <= high + rounding;
        assert!(inside, "{what}: {statistic:?}");
    }
}

#[test]
fn extremes_enclose_the_average_the_middle_and_the_points_of_every_map() {
    for (kind, sensor_kind) in kinds() {
        let scene = scene(&[("led", 1.0)], vec![("exit", sensor_kind)]);
        for (name, field) in fields() {
            for counts in [None, Some(3e5), Some(3e3)] {
                for seed in 1..=3 {
                    let measures = measure(&scene, &lit(&scene, counts, seed, &field));
                    let what = format!("{name} on {kind}, counts {counts:?}, seed {seed}");
                    assert_laws(&what, &measures, &measures.maps[0]);
                }
            }
        }
    }
}

#[test]
fn every_cell_without_noise_lies_between_the_extremes() {
    for (kind, sensor_kind) in kinds() {
        let scene = scene(&[("led", 1.0)], vec![("exit", sensor_kind)]);
        let covered = match &sensor(&scene).seeing {
            Seeing::All | Seeing::Views(_) => sensor(&scene).covered.clone(),
            Seeing::Pixels(pixels) => vec![1.0; pixels.count()],
        };
        for (name, field) in fields() {
            let measures = measure(&scene, &lit(&scene, None, 1, &field));
            let map = &measures.maps[0];
            let (least, most) = (map.summary.all.min.value, map.summary.all.max.value);
            for (value, cover) in map.values.iter().zip(&covered) {
                let counts = *cover >= 0.5;
                let inside = *value >= least * (1.0 - 1e-9) && *value <= most * (1.0 + 1e-9);
                assert!(!counts || inside, "{name} on {kind}: {value} not in {least}..{most}");
            }
        }
    }
}

#[test]
fn a_hot_spot_is_as_bright_on_rings_as_on_squares() {
    let spot = |p: DVec2| if p.length() < 0.24 { 20.0 } else { 1.0 };
    let [square, round] = [disk(1.0, 33), rings(1.0, 25, 1)].map(|kind| {
        let scene = scene(&[("led", 1.0)], vec![("exit", kind)]);
        measure(&scene, &lit(&scene, Some(1e8), 1, &spot)).maps[0].summary.all
    });
    assert_eq!([square.max.status, round.max.status], [Status::Ok; 2]);
    for (square, round) in [(square.max, round.max), (square.min, round.min)] {
        assert!((square.value / round.value - 1.0).abs() < 0.02, "{square:?} and {round:?}");
    }
}

#[test]
fn a_lamp_far_off_the_axis_of_an_image_is_its_maximum() {
    let scene = scene(&[("led", 1.0)], vec![("exit", wide_image())]);
    let lamp = |p: DVec2| if p.x > 0.9 && p.y > 0.9 { 100.0 } else { 1.0 };
    let found = measure(&scene, &lit(&scene, None, 1, &lamp)).maps[0].summary.all;
    assert!((found.max.value / found.min.value / 100.0 - 1.0).abs() < 1e-9, "{found:?}");
}
