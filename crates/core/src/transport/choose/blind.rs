//! Sensors that see nothing: no gather path from them could find light.
//!
//! What a sensor sees is sampled, not proved. Whether the light of a source reaches it is not
//! checked.

use crate::rng::Sampler;
use crate::scene::{Arrivals, Scene, SensorId};
use crate::transport::walk::emitters::{Emitters, Met};
use crate::transport::walk::follow::{Collector, Gathering, follow};
use crate::transport::{Path, Vertex};
use std::ops::ControlFlow;

/// Gather paths tried from a sensor.
pub const BLIND_PATHS: u64 = 1000;
/// Stream of random numbers of these.
const STREAM: u64 = 10 << 32;

/// The sensors for which none of [`BLIND_PATHS`] gather paths meets a surface or a source (beyond
/// its aim, if it has one).
pub fn blind_sensors(scene: &Scene, sensors: &[SensorId], seed: u64) -> Vec<SensorId> {
    let emitters = Emitters::new(scene);
    let sensors = sensors.iter().copied();
    sensors.filter(|&sensor| !sees(scene, &emitters, sensor, seed)).collect()
}

fn sees<'s>(scene: &'s Scene, emitters: &Emitters<'s>, sensor: SensorId, seed: u64) -> bool {
    let arrivals = Arrivals::new(scene, sensor);
    let gathering = Gathering { scene, emitters, sensor, bounce_limit: u32::MAX, pace: None };
    let mut look = Look { sees: false };
    for index in 0..BLIND_PATHS {
        let mut sampler = Sampler::for_path(seed, STREAM + sensor.index() as u64, index);
        if let Some(arrival) = arrivals.draw(&mut sampler) {
            follow(gathering, &arrival, &mut sampler, &mut look);
        }
        if look.sees {
            return true;
        }
    }
    false
}

/// Notes whether anything is met, and then stops.
struct Look {
    sees: bool,
}

impl Collector for Look {
    fn meet(&mut self, _: &Path, _: Met) {
        self.sees = true;
    }

    fn arrive(&mut self, _: &Path, _: &Vertex<'_>) -> ControlFlow<()> {
        self.sees = true;
        ControlFlow::Break(())
    }
}
