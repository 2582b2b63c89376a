//! Sensors that see nothing: no gather path from them could find light.
//!
//! What a sensor sees is sampled, not proved. Whether the light of a source reaches it is not
//! checked.

use crate::rng::{Sampler, stream};
use crate::scene::{Arrivals, Scene, SensorId};
use crate::transport::walk::emitters::Emitters;
use crate::transport::walk::follow::{Gathering, follow};
use crate::transport::{Event, Path};
use std::ops::ControlFlow;

/// Gather paths tried from a sensor.
pub const BLIND_PATHS: u64 = 1000;

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
    for index in 0..BLIND_PATHS {
        let mut sampler = Sampler::for_path(seed, stream::BLIND + sensor.index() as u64, index);
        if let Some(arrival) = arrivals.draw(&mut sampler) {
            let mut sees = false;
            let mut look = |_: &Path, event: Event<'_>| {
                sees |= matches!(event, Event::Meet(_) | Event::Arrive(_));
                if sees { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            follow(gathering, &arrival, &mut sampler, &mut look);
            if sees {
                return true;
            }
        }
    }
    false
}
