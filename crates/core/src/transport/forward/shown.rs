//! Single photons to look at, with the sensors that count them. They do not affect the readings of
//! a run.

use crate::rng::Sampler;
use crate::scene::{SensorId, SourceId};
use crate::transport::forward::Forward;
use crate::transport::forward::counter::PhotonCounter;
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::{Event, Observer, Path, Readings, walk};
use std::ops::ControlFlow;

/// Counts a photon and passes it to another observer.
struct Shown<'a, 'r, 's, O> {
    counter: PhotonCounter<'r, 's, O>,
    see: &'a mut dyn FnMut(&Path, &Event<'_>),
}

impl<O: Observer> Observer for Shown<'_, '_, '_, O> {
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
        let mut counted_by = Vec::new();
        let mut note = |_: &Path, event: Event<'_>| {
            if let Event::Detect(light) = event {
                counted_by.retain(|sensor| *sensor != light.sensor);
                counted_by.push(light.sensor);
            }
            ControlFlow::Continue(())
        };
        let readings = Readings::of_batch(self.scene, &self.layout, self.seed, 1, 0);
        let signal = StopSignal::default();
        let pace = Pace::new(&signal);
        let mut counter = PhotonCounter::new(self, readings, &mut note, &pace);
        counter.source = source;
        walk(self.scene, path, self.bounce_limit, sampler, &mut Shown { counter, see });
        counted_by
    }
}
