//! Gathering merged with forward, backward and their joins: photons that find light in all these ways.
//!
//! Photons and gather paths find light as in a mix (`backward/mix`); pairs of photons and records are
//! one more technique. All belong to the same passes, and the readings of each order contain all
//! light of a sensor. This module does not know how paths are traced.

use crate::transport::backward::mix::Mixing;
use crate::transport::backward::paths::SharedBatches;
use crate::transport::gather::block::CrossedCounts;
use crate::transport::gather::estimator::Gather;
use crate::transport::gather::stream::PhotonStream;
use crate::transport::tally::Counts;
use crate::transport::tally::work::RecordWork;
use crate::transport::task::Task;
use crate::transport::{Event, Observer, Path, Readings};
use std::ops::ControlFlow;

/// Photons that stream past the records, are counted by sensors, and are joined to them.
pub(crate) struct MergedStream<'p, 's> {
    stream: PhotonStream<'p, 's>,
    gather: &'p Gather<'s>,
    task: Task<'p>,
    /// The pass whose photons are traced, and its counts.
    current: Option<(usize, Mixing<'p, 's>)>,
    /// Counts of the others without pairs, not closed.
    without_pairs: Vec<Option<Readings>>,
}

impl<'p, 's> MergedStream<'p, 's> {
    /// Traces the gather paths of a block of passes, from the task's batch on; `None` if stopped.
    pub(crate) fn begin(gather: &'p Gather<'s>, task: Task<'p>, passes: u64) -> Option<Self> {
        let (stream, met) = gather.trace_records(task, passes)?;
        let without_pairs = met.into_iter().map(Some).collect();
        Some(Self { stream, gather, task, current: None, without_pairs })
    }

    /// The photons that follow are those of another pass of the block.
    pub(crate) fn begin_pass(&mut self, place: usize) {
        self.end_pass();
        self.stream.begin_pass(place);
        let readings = self.without_pairs.get_mut(place).and_then(Option::take);
        if let (Some(backward), Some(readings)) = (&self.gather.merging, readings) {
            let task = Task { batch: self.task.batch + place as u64, ..self.task };
            let paths = self.stream.first.gather_paths;
            let together = SharedBatches {
                batches: self.without_pairs.len() as f64,
                places: Some(self.gather.record_places(self.stream.first)),
            };
            self.current = Some((place, Mixing::new(backward, (task, paths), together, readings)));
        }
    }

    fn end_pass(&mut self) {
        if let Some((place, mixing)) = self.current.take() {
            self.without_pairs[place] = Some(mixing.into_readings());
        }
    }

    /// The counts after all photons, and the work in addition to tracing.
    pub(super) fn finish(mut self) -> (CrossedCounts, RecordWork) {
        self.end_pass();
        let (mut counts, work) = self.stream.finish();
        for (place, own) in self.without_pairs.iter().enumerate() {
            own.iter().for_each(|own| counts.add(place, own));
        }
        (counts, work)
    }

    /// The counts of all passes, after their photons.
    pub(crate) fn into_counts(self) -> Counts {
        self.finish().0.into_counts()
    }
}

impl Observer for MergedStream<'_, '_> {
    fn roulette_below(&self) -> f64 {
        let current = self.current.as_ref();
        current.map_or_else(|| self.stream.roulette_below(), |(_, own)| own.roulette_below())
    }

    #[inline(always)]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        let Some((_, mixing)) = &mut self.current else { return ControlFlow::Continue(()) };
        self.stream.offer(path, event, |dir| Some(mixing.photon(dir)));
        mixing.see(path, event)
    }
}
