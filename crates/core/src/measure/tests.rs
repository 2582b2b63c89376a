use super::*;
use crate::measure::samples::{
    add, disk, goniometer, image, luminance, readings, rectangle, rings, scene,
};
use crate::optics::Medium;
use crate::plan::{GatherPlan, Request, RunPlan, StopRules};
use crate::scene::shape::{Flat, Region, Shape};
use crate::scene::{
    Builder, Emission, EmitSide, Emitter, FacePiece, FaceSpec, Owner, Sensor, SensorKind, Sides,
    Source, StartSolids,
};
use crate::transport::estimators::EstimatorFindings;
use crate::transport::{Counts, Run, Stage};
use glam::DVec3;
use lumiduct_base::math::Frame;
use std::f64::consts::TAU;

fn many_sensors() -> Scene {
    scene(
        &[("led", 3.0), ("lamp", 1.0)],
        vec![
            ("exit", rectangle(2.0, 6, 4)),
            ("port", disk(1.0, 32)),
            ("rings", rings(1.0, 5, 6)),
            ("eye", luminance(1.0, 3, 3, &[0.1, 0.2])),
            ("camera", image(4, 3)),
            ("far", goniometer(8, 36)),
        ],
    )
}

/// Uneven light everywhere, different in every batch.
fn some_light(scene: &Scene) -> Findings {
    readings(scene, 128, |index, layout, batch| {
        for (place, sum) in batch.groups[0].sums.iter_mut().enumerate() {
            *sum = 1e-3 * ((place % 7 + 1) as f64 + (index % 5) as f64);
        }
        assert!(layout.len() > 50);
        for sensor in &mut batch.sensors {
            for cell in 0..sensor.cells.count() {
                sensor.cells.add(cell, 1e-4 * ((cell % 3 + 2) as f64 + (index % 2) as f64));
            }
        }
    })
}

#[test]
fn the_names_depend_on_the_scene_alone() {
    let scene = many_sensors();
    let lit = measure(&scene, &some_light(&scene));
    assert_eq!(names(&scene), lit.values.keys().cloned().collect::<Vec<_>>());
    for name in [
        "exit.flux",
        "exit.flux.from.led",
        "exit.efficiency.from.lamp",
        "exit.transmission",
        "exit.flux_outside_aim",
        "exit.flux_other_side",
        "exit.illuminance_avg",
        "exit.illuminance_center",
        "exit.cell.5.3",
        "exit.uniformity13_min_max",
        "exit.share_deeper_than_1000",
        "port.uniformity9_min_avg",
        "rings.ring.4",
        "eye.luminance_avg.1",
        "eye.cell.2.2.0",
        "eye.uniformity_min_avg.1",
        "camera.luminance_avg",
        "camera.uniformity9_min_avg",
        "camera.cell.3.2",
        "far.beam_angle.c90",
        "far.zonal_flux.170-180",
        "far.ring.35",
        "balance.absorbed.wall.surface",
        "balance.absorbed_medium.air",
        "balance.emitted.lamp",
        "balance.residual",
    ] {
        assert!(lit.values.contains_key(name), "{name} is missing");
    }
    // The corners of a square about a disk are not on it, and 32 x 32 cells are too many to be named.
    assert!(!lit.values.contains_key("port.uniformity13_min_avg"));
    assert!(!lit.values.contains_key("port.cell.16.16"));
    assert!(!lit.values.contains_key("eye.illuminance_avg"));
    assert!(!lit.values.contains_key("camera.illuminance_avg"));
}

#[test]
fn one_measure_alone_is_the_same_as_among_all() {
    let scene = many_sensors();
    let readings = some_light(&scene);
    for (name, measure) in measure(&scene, &readings).values {
        assert_eq!(value_of(&scene, &readings, &name), Some(measure), "{name}");
    }
    for name in ["exit", "exit.", "exit.nothing", "nothing.flux", "balance.absorbed.exit", ""] {
        assert_eq!(value_of(&scene, &readings, name), None, "{name}");
    }
}

#[test]
fn everything_can_be_written_as_json() {
    let scene = many_sensors();
    let json = serde_json::to_value(measure(&scene, &some_light(&scene))).unwrap();
    assert_eq!(json["values"]["exit.flux"]["unit"], "lm");
    assert_eq!(json["unit"], "lumen");
    assert!(json["maps"].as_array().is_some_and(|maps| maps.len() == 6));
}

#[test]
fn the_target_of_a_run_is_error_over_value() {
    let scene = scene(&[("led", 2.0)], vec![("exit", rectangle(1.0, 1, 1))]);
    let readings = readings(&scene, 128, |index, layout, batch| {
        let slot = layout.sensor_flux(SensorId::new(0), SourceId::new(0));
        add(batch, slot, if index % 2 == 0 { 0.9 } else { 1.1 });
    });
    let measures = measure(&scene, &readings);
    // Standard deviation 0.1 √(128/127), over √128.
    let error = relative_error(&measures, "exit.flux").unwrap();
    assert!((error - 0.1 / 127f64.sqrt()).abs() < 1e-12, "{error}");
    assert_eq!(relative_error(&measures, "exit.uniformity_min_avg"), Some(f64::INFINITY));
    assert_eq!(relative_error(&measures, "exit.flus"), None);
}

/// A Lambertian disk of radius 1 facing a square of side 2 at distance 1 in free space.
fn facing_square(cells: usize) -> Scene {
    let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
    let at = |z: f64| Frame::WORLD.shifted(DVec3::new(0.0, 0.0, z));
    let disk = Shape::Flat(Flat::new(at(0.0), Region::Annulus { inner: 0.0, outer: 1.0 }));
    let square = Region::Rectangle { half_x: 1.0, half_y: 1.0 };
    let port = builder.add_face(FaceSpec {
        name: "exit".into(),
        owner: Owner::Port,
        front: None,
        back: None,
        pieces: vec![FacePiece::whole(Shape::Flat(Flat::new(at(1.0), square)))],
    });
    builder.add_source(Source {
        name: "led".into(),
        flux: 1.0,
        emitter: Emitter::surface(vec![disk], EmitSide::Front, None),
        emission: Emission::Lambertian,
        start: StartSolids::Outside,
        on: Vec::new(),
        spectrum: None,
        elevation: None,
        sun: None,
    });
    let SensorKind::Surface(mut sensor) = rectangle(2.0, cells, cells) else { unreachable!() };
    (sensor.faces, sensor.sides) = (vec![port], Sides::Back);
    builder.add_sensor(Sensor {
        name: "exit".into(),
        kind: SensorKind::Surface(sensor),
        aim: Vec::new(),
        entering: None,
    });
    builder.build()
}

/// Illuminance [lx] at `r` mm from the axis: E = M/2 (1 - (r² + h² - a²)/√((r² + h² + a²)² - 4 r² a²)) under a
/// Lambertian disk of radius a = 1 mm at h = 1 mm with exitance M = 1/π lm/mm² (Foote, Bull. Bureau of
/// Standards 12 (1915) 583).
fn under_disk(r2: f64) -> f64 {
    1e6 / TAU * (1.0 - r2 / ((r2 + 2.0).powi(2) - 4.0 * r2).sqrt())
}

#[test]
fn errors_of_a_traced_field_are_what_they_say() {
    let cells = 5;
    let scene = facing_square(cells);
    // Mean over a cell by the midpoint rule; its error is below 1e-4.
    let mean = |column: usize, row: usize| {
        let place = |cell: usize, i: usize| (cell as f64 + (i as f64 + 0.5) / 40.0) * 0.4 - 1.0;
        let at = |i: usize| place(column, i % 40).powi(2) + place(row, i / 40).powi(2);
        (0..1600).map(|i| under_disk(at(i))).sum::<f64>() / 1600.0
    };
    let exact: Vec<f64> = (0..25).map(|i| mean(i % 5, i / 5)).collect();
    let avg = exact.iter().sum::<f64>() / 25.0;
    let cv = (exact.iter().map(|e| (e - avg).powi(2)).sum::<f64>() / 25.0).sqrt() / avg;
    let mut squares = IndexMap::<&str, f64>::new();
    let seeds = 40;
    for seed in 1..=seeds {
        let plan = RunPlan {
            estimator: Request::Forward,
            sensor_estimators: Vec::new(),
            gather: GatherPlan::default(),
            seed,
            bounce_limit: 10,
            batch_paths: None,
            stop: StopRules { paths: Some(40_000), ..StopRules::default() },
        };
        let mut run = Run::new(&scene, &plan);
        while !run.is_complete() {
            run.next_wave();
        }
        let measures = measure(&scene, &run.findings());
        for (name, expected) in [
            ("exit.illuminance_avg", avg),
            ("exit.efficiency", avg * 4e-6),
            ("exit.cell.0.0", exact[0]),
            ("exit.cell.2.1", exact[7]),
            ("exit.uniformity_min_avg", exact[0] / avg),
            ("exit.uniformity9_min_avg", 9.0 * exact[0] / nine_of(&exact).sum::<f64>()),
            ("exit.illuminance_max", exact[12]),
            ("exit.cv", cv),
        ] {
            let found = &measures.values[name];
            assert_eq!(found.status, Status::Ok, "{name}");
            let z = (found.value - expected) / found.total_error();
            assert!(z.abs() < 4.0, "seed {seed}: {name} = {found}, not {expected}");
            *squares.entry(name).or_default() += z * z / seeds as f64;
        }
    }
    for (name, square) in squares {
        // Mean square of 40 normal numbers: 1 ± 0.22; extremes get more room than they need.
        let least = if name.contains("min") || name.contains("max") { 0.1 } else { 0.4 };
        assert!(square > least && square < 1.9, "{name}: {square}");
    }
}

fn nine_of(cells: &[f64]) -> impl Iterator<Item = f64> {
    [0, 2, 4, 10, 12, 14, 20, 22, 24].into_iter().map(|cell| cells[cell])
}

#[test]
fn photons_contradict_gather_paths_beyond_noise_and_rounding() {
    let scene = scene(&[("led", 1.0)], vec![("exit", rectangle(1.0, 1, 1))]);
    let every_batch = |flux: f64| {
        readings(&scene, 128, |_, layout, batch| {
            add(batch, layout.sensor_flux(SensorId::new(0), SourceId::new(0)), flux);
        })
    };
    let status = |photons: f64, gather_paths: f64| {
        let counts = Counts::one(every_batch(gather_paths).photons);
        let stages = vec![Stage { number: 0, counts, segments: 0 }];
        let others = vec![EstimatorFindings {
            estimator: Estimator::Backward,
            sensors: vec![SensorId::new(0)],
            settings: None,
            stages,
        }];
        let estimators = vec![Estimator::Backward];
        let findings = Findings { others, estimators, ..every_batch(photons) };
        measure(&scene, &findings).values["exit.flux"].status
    };
    // Found in a lossless duct, where sums over both kinds of paths have no noise.
    assert_eq!(status(1.000_000_000_000_000_7, 0.999_999_999_999_971_8), Status::Ok);
    assert_eq!(status(1.001, 1.0), Status::Contradicted);
}
