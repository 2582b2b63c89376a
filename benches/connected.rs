//! The truth of `remote_cell_scatter` by an independent method: every photon is connected to the
//! cell from every wall it meets.
//!
//! `cargo bench --bench connected`. The scattering toward a point of the cell is weighted by the
//! BSDF of the wall, so that the estimate has neither window nor bias and uses no gather path.
//! Backward paths carry ratios of cosines whose variance is unbounded where they meet the first
//! wall at grazing incidence; these photons do not.
#![allow(clippy::print_stdout, reason = "a bench prints its result")]

use glam::DVec3;
use lumiduct_core::optics::{Finish, FinishModel, Incidence, REFERENCE_WAVELENGTH, Spread};
use lumiduct_core::rng::{Dimension, Sampler};
use lumiduct_core::scene::shape::Toward;
use lumiduct_core::scene::{
    DrawnWavelength, FaceArea, Ray, Scene, SensorKind, SourceId, StartSurfaces,
};
use lumiduct_core::tally::Tally;
use lumiduct_core::transport::{Event, Path, Vertex, walk};
use lumiduct_input::{self as input, Settings};
use rayon::prelude::*;
use std::ops::ControlFlow;

const SEED: u64 = 20261;
const STREAM: u64 = 1;
const BATCHES: u64 = 512;
const PATHS: u64 = 100_000;
const BOUNCE_LIMIT: u32 = 100_000;

fn main() {
    let path = std::path::Path::new("scenes/remote_cell_scatter.toml");
    let job = input::load(path, &Settings::default()).expect("the scene is valid");
    let batches: Vec<f64> =
        (0..BATCHES).into_par_iter().map(|batch| flux(&job.scene, batch)).collect();
    let flux = Tally::of(batches);
    println!("cell.flux {:.7} ± {:.7} lm, seed {SEED}", flux.mean(), flux.std_error());
}

/// Flux on the cell from the photons of a batch, lm.
fn flux(scene: &Scene, batch: u64) -> f64 {
    let wall = scene
        .finishes
        .iter()
        .find(|named| matches!(named.finish.spread(), Spread::Narrow(_)))
        .expect("the wall of the scene scatters");
    let SensorKind::Surface(sensor) = &scene.sensors[0].kind else {
        panic!("the sensor of the scene is a cell");
    };
    let cell = FaceArea::new(scene, &sensor.faces);
    let axis = sensor.frame.expect("a cell is flat").z;
    let source = &scene.sources[0];
    let mut sum = 0.0;
    for index in batch * PATHS..(batch + 1) * PATHS {
        let mut sampler = Sampler::for_path(SEED, STREAM, index);
        let emitted = source.emit(scene, DrawnWavelength::REFERENCE, &mut sampler);
        let path = Path::emitted(scene, SourceId::new(0), emitted);
        let mut places = Sampler::for_path(SEED, STREAM + 1, index);
        let mut join = |path: &Path, event: Event<'_>| {
            if let Event::Arrive(vertex) = event {
                let place = cell.sample(places.pair(Dimension::GatherPosition));
                let place = place.expect("a cell has an area").point;
                sum += joined(scene, &wall.finish, path, vertex, place, axis) * cell.area();
            }
            ControlFlow::Continue(())
        };
        walk(scene, path, BOUNCE_LIMIT, &mut sampler, &mut join);
    }
    sum * source.flux / PATHS as f64
}

/// Throughput per area that the wall at a vertex scatters to a point of the cell, 1/mm².
fn joined(
    scene: &Scene,
    wall: &Finish,
    path: &Path,
    vertex: &Vertex<'_>,
    place: DVec3,
    axis: DVec3,
) -> f64 {
    let way = place - vertex.point;
    let (dir, distance) = (way.normalize(), way.length());
    let outward = scene.normal(vertex.interface.acting.prim, vertex.point);
    let normal = match vertex.interface.acting.toward {
        Toward::Front => -outward,
        Toward::Back => outward,
    };
    let (cos_wall, cos_cell) = (dir.dot(normal), -dir.dot(axis));
    if cos_wall <= 0.0 || cos_cell <= 0.0 {
        return 0.0;
    }
    let incidence = Incidence {
        dir: vertex.dir,
        normal,
        index_from: 1.0,
        index_to: 1.0,
        wavelength: REFERENCE_WAVELENGTH,
        grain: DVec3::ZERO,
        s_share: Incidence::UNPOLARISED,
    };
    let value = wall.evaluate(&incidence, dir);
    if value == 0.0 {
        return 0.0;
    }
    let ray = Ray::new(vertex.point, dir);
    let blocked = scene
        .find_next(&ray, &StartSurfaces::hits(vertex.hits), &path.inside)
        .is_some_and(|hits| hits.distance() < distance);
    if blocked {
        return 0.0;
    }
    vertex.throughput * value * cos_wall * cos_cell / (distance * distance)
}
