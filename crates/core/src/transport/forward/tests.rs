//! The forward estimator on a tube whose transmission is known.

use crate::optics::{Finish, Medium};
use crate::plan::{GatherPlan, Request, RunPlan, StopRules};
use crate::scene::shape::{Cylinder, Flat, Region, Shape};
use crate::scene::{
    Builder, CountedLight, Emission, EmitSide, Emitter, FacePiece, FaceSpec, Grid, Owner, Passage,
    Place, Scene, Seeing, Sensor, SensorId, SensorKind, Sides, Source, SourceId, StartSolids,
    SurfaceSensor,
};
use crate::tally::sigmas;
use crate::transport::forward::Forward;
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::sensor_reading::Trail;
use crate::transport::{Event, Observer, Path, Readings, Run};
use glam::DVec3;
use lumiduct_base::math::{Aabb, Frame};
use lumiduct_base::units::FluxUnit;
use std::ops::ControlFlow;

/// A mirror tube of radius 5 with a Lambertian disk in its entry and a sensor in its exit.
fn mirror_tube(reflectance: f64, length: f64) -> Scene {
    let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
    let mirror = builder.add_finish("mirror", Finish::Specular { reflectance, transmittance: 0.0 });
    let black = builder.add_finish("black", Finish::Absorber);
    builder.add_face(FaceSpec {
        name: "tube.wall".into(),
        owner: Owner::Sheet,
        front: Some(black),
        back: Some(mirror),
        pieces: vec![FacePiece::whole(Shape::Cylinder(Cylinder::new(Frame::WORLD, 5.0, length)))],
    });
    let disk = |z: f64| {
        Shape::Flat(Flat::new(
            Frame::WORLD.shifted(DVec3::new(0.0, 0.0, z)),
            Region::Annulus { inner: 0.0, outer: 5.0 },
        ))
    };
    let port = builder.add_face(FaceSpec {
        name: "exit".into(),
        owner: Owner::Port,
        front: None,
        back: None,
        pieces: vec![FacePiece::whole(disk(length))],
    });
    builder.add_source(Source {
        name: "led".into(),
        flux: 1.0,
        emitter: Emitter::surface(vec![disk(0.0)], EmitSide::Front, None),
        emission: Emission::Lambertian,
        start: StartSolids::Outside,
        on: Vec::new(),
        spectrum: None,
        elevation: None,
        sun: None,
    });
    let grid = Grid::Cartesian { rect: disk(0.0).chart_bounds(), nu: 32, nv: 32 };
    let area_in = |rect| builder.scene().face_area_in(port, rect);
    let areas = grid.cell_areas(area_in);
    let covered = grid.cell_cover(|rect| builder.scene().face_charted_in(port, rect));
    builder.add_sensor(Sensor {
        name: "exit".into(),
        kind: SensorKind::Surface(SurfaceSensor {
            faces: vec![port],
            place: Place::Port,
            counts: CountedLight::Incident,
            sides: Sides::Back,
            passage: Passage::Every,
            grid,
            areas,
            covered,
            seeing: Seeing::All,
            frame: None,
        }),
        aim: Vec::new(),
        entering: None,
    });
    let scene = builder.build();
    assert!(scene.bounds.overlaps(&Aabb::of([DVec3::ZERO])));
    scene
}

fn run(scene: &Scene, paths: u64) -> Readings {
    let plan = RunPlan {
        estimator: Request::Forward,
        sensor_estimators: Vec::new(),
        gather: GatherPlan::default(),
        seed: 1,
        bounce_limit: 100_000,
        batch_paths: None,
        stop: StopRules { paths: Some(paths), ..StopRules::default() },
    };
    let mut run = Run::new(scene, &plan);
    while !run.is_complete() {
        run.next_wave();
    }
    run.findings().photons
}

#[test]
fn a_mirror_tube_passes_what_the_closed_form_says_and_the_balance_closes() {
    // DESIGN section 6, B1: aspect 10 and 100 at R 0.95.
    for (length, expected) in [(100.0, 0.51084474), (1000.0, 0.04442615)] {
        let scene = mirror_tube(0.95, length);
        let readings = run(&scene, 500_000);
        let layout = crate::transport::Layout::new(&scene);
        let flux = readings.scalar(layout.sensor_flux(SensorId::new(0), SourceId::new(0)));
        let z = sigmas(flux.mean(), flux.std_error(), expected);
        assert!(z.abs() < 4.0, "{} ± {}, expected {expected}", flux.mean(), flux.std_error());
        let (first, lines) = (
            layout.emitted(SourceId::new(0)),
            layout.emitted(SourceId::new(0)) + 1..=layout.leaked(),
        );
        let lost =
            readings.function(|sums| lines.clone().map(sums).sum::<f64>() - sums(first)).mean();
        assert!(lost.abs() < 1e-9, "balance is open by {lost}");
        assert_eq!(readings.scalar(layout.leaked()).mean(), 0.0);
    }
}

#[test]
fn path_classes_are_a_fair_sample() {
    // Light that meets no wall: the form factor of equal coaxial disks, their radius half of their distance
    // (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-41).
    let x = 2.0 + 1.0 / 0.25;
    let direct = 0.5 * (x - (x * x - 4.0_f64).sqrt());
    let scene = mirror_tube(0.95, 10.0);
    let layout = crate::transport::Layout::new(&scene);
    let forward = Forward::new(&scene, 1, 1000, 1 << 15);
    for batch in 0..4 {
        let readings = forward.batch(batch, &StopSignal::default()).unwrap();
        let flux = readings.scalar(layout.sensor_flux(SensorId::new(0), SourceId::new(0))).mean();
        let classes = &readings.sensors[0].classes;
        let all: f64 = classes.values().map(|class| class.flux).sum();
        let share = classes[&Trail::new()].flux / all;
        assert!((share / (direct / flux) - 1.0).abs() < 0.02, "{share}, not {}", direct / flux);
    }
}

#[test]
fn readings_have_the_same_bits_on_any_number_of_threads() {
    let scene = mirror_tube(0.95, 100.0);
    let on = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| run(&scene, 20_000))
    };
    let one = on(1);
    for threads in [2, 3, 8] {
        assert!(one == on(threads), "{threads} threads differ");
    }
}

/// Counts the events it sees.
#[derive(Debug, Default, PartialEq)]
struct Onlooker {
    started: usize,
    arrived: usize,
    departed: usize,
    detected: usize,
}

impl Observer for Onlooker {
    fn see(&mut self, _: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Start(_) => self.started += 1,
            Event::Arrive(_) => self.arrived += 1,
            Event::Depart(..) => self.departed += 1,
            Event::Detect(light) => self.detected += light.cells.len(),
            Event::Travel(_)
            | Event::Jump(_)
            | Event::Convert(_)
            | Event::Collide(_)
            | Event::Absorbed(_)
            | Event::Meet(_)
            | Event::Roulette(_)
            | Event::Escaped(_)
            | Event::Cut(_)
            | Event::Leaked(..) => {}
        }
        ControlFlow::Continue(())
    }
}

#[test]
fn two_observers_of_the_same_photons_see_the_same() {
    let scene = mirror_tube(0.95, 20.0);
    let (mut first, mut second) = (Onlooker::default(), Onlooker::default());
    let signal = StopSignal::default();
    let pace = Pace::new(&signal);
    let forward = Forward::new(&scene, 1, 1000, 500);
    forward.batch_observed(0, &mut (&mut first, &mut second), &pace).unwrap();
    assert_eq!(first, second);
    assert_eq!(first.started, 500);
    assert!(first.detected > 100 && first.arrived > 500 && first.departed > 500, "{first:?}");
}

#[test]
fn sources_share_a_batch_by_flux_and_none_goes_without() {
    let mut scene = mirror_tube(0.95, 10.0);
    let fluxes = [1.0, 1.0, 0.5, 1e-6];
    let source = scene.sources[0].clone();
    scene.sources = fluxes.map(|flux| crate::scene::Source { flux, ..source.clone() }).to_vec();
    for batch_paths in [4, 5, 37, 100, 4096] {
        let shares = crate::transport::forward::estimator::shares(&scene, batch_paths);
        assert_eq!(shares.iter().sum::<u64>(), batch_paths);
        assert!(shares.iter().all(|share| *share > 0), "{shares:?}");
        assert!(shares[0].abs_diff(shares[1]) <= 1, "{shares:?}");
    }
    assert_eq!(crate::transport::forward::estimator::shares(&scene, 1), [1; 4]);
    scene.sources[1].flux = 0.0;
    let forward = Forward::new(&scene, 1, 10, 100);
    assert_eq!((forward.shares[1], forward.shares.iter().sum::<u64>()), (0, 100));
    assert_eq!(forward.photon_fluxes()[1], 0.0);
}
