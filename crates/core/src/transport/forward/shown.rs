//! Single photons to look at, with the sensors that count them. They do not affect the readings of
//! a run.

use crate::rng::Sampler;
use crate::scene::{SensorId, SourceId};
use crate::transport::forward::counter::Counter;
use crate::transport::forward::{Detected, Forward, PhotonWatcher};
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::{Event, Path, Readings, Vertex, Visitor, walk};
use std::ops::ControlFlow;

/// Remembers the sensors that have counted a photon, ordered by their latest count.
#[derive(Default)]
struct Met(Vec<SensorId>);

impl PhotonWatcher for Met {
    fn arrive(&mut self, _: &Path, _: &Vertex<'_>, _: f64, _: SourceId) {}

    fn detect(&mut self, _: &Path, light: &Detected, mut cells: impl Iterator<Item = usize>) {
        if cells.next().is_some() {
            self.0.retain(|sensor| *sensor != light.sensor);
            self.0.push(light.sensor);
        }
    }
}

/// Counts a photon and passes it to a watcher.
struct Shown<'a, 'r, 's> {
    counter: Counter<'r, 's, Met>,
    see: &'a mut dyn FnMut(&Path, &Event<'_>),
}

impl Visitor for Shown<'_, '_, '_> {
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        (self.see)(path, &event);
        self.counter.see(path, event)
    }
}

impl Forward<'_> {
    /// Follows a photon that `source` has emitted: the sensors that count it, the latest last.
    pub(crate) fn show(
        &self,
        source: SourceId,
        path: Path,
        sampler: &mut Sampler,
        see: &mut dyn FnMut(&Path, &Event<'_>),
    ) -> Vec<SensorId> {
        let mut met = Met::default();
        let readings = Readings::of_batch(self.scene, &self.layout, self.seed, 1, 0);
        let signal = StopSignal::default();
        let pace = Pace::new(&signal);
        let mut counter = Counter::new(self, readings, &mut met, &pace);
        counter.source = source;
        walk(self.scene, path, self.bounce_limit, sampler, &mut Shown { counter, see });
        met.0
    }
}
