//! The counts of an estimator: one set of readings, or several of the same batches.
//!
//! Only the estimator knows what each of its readings means.

use crate::transport::Readings;
use crate::transport::tally::sums::{Merge, Sums};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Readings of the same batches, at least one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Counts(Vec<Readings>);

impl Counts {
    /// One set of readings, of a batch that has ended.
    pub(crate) fn one(readings: Readings) -> Self {
        Self(vec![readings])
    }

    /// The counts of a batch that ends now.
    pub(crate) fn closed(readings: impl IntoIterator<Item = Readings>) -> Self {
        let mut all: Vec<Readings> = readings.into_iter().collect();
        all.iter_mut().for_each(Readings::close_batch);
        Self(all)
    }

    /// The first readings.
    pub fn first(&self) -> &Readings {
        &self.0[0]
    }

    /// All readings.
    pub(crate) fn all(&self) -> &[Readings] {
        &self.0
    }

    /// The batches.
    pub(crate) fn batches(&self) -> &Range<u64> {
        &self.first().batches
    }
}

impl Merge for Counts {
    fn batch_count(&self) -> u64 {
        self.first().batch_count()
    }

    fn first_batch(&self) -> u64 {
        self.batches().start
    }

    fn merge(self, later: &Self) -> Self {
        let both = self.0.into_iter().zip(&later.0);
        Self(both.map(|(own, later)| own.merge(later)).collect())
    }
}

/// Counts of batches that follow each other, at least one.
pub(crate) fn merged(batches: impl IntoIterator<Item = Counts>) -> Counts {
    batches.into_iter().reduce(|all, own| all.merge(&own)).expect("there is a batch")
}

/// Counts of a stage: batches with the same settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Number of the stage, from 0.
    pub number: u32,
    /// Its counts.
    pub counts: Counts,
    /// Segments traced in it and in all stages before it.
    pub segments: u64,
}

/// Stages that a report has: two that may give the value, and one before them.
const KEPT: usize = 3;

/// What an estimator has counted so far, stage by stage. Most estimators have only one stage.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Series {
    stage: u32,
    sums: Sums<Counts>,
    /// The last finished stages, at most [`KEPT`].
    finished: Vec<Stage>,
    /// Segments of all finished stages.
    segments_before: u64,
}

impl Series {
    /// The first stage, from the nodes of the tree over all batches in their order.
    pub(crate) fn of_nodes(nodes: Vec<Counts>) -> Self {
        Self { sums: Sums::of_nodes(nodes), ..Self::default() }
    }

    /// Number of the stage in progress, from 0.
    pub(crate) fn stage(&self) -> u32 {
        self.stage
    }

    /// Batches of the stage in progress.
    pub(crate) fn batches(&self) -> u64 {
        self.sums.batches()
    }

    /// Adds the next batch.
    pub(crate) fn push(&mut self, batch: Counts) {
        self.sums.push(batch);
    }

    /// Starts a later stage. The stage that ends here is kept: it gives the values until the next one has no
    /// larger error.
    pub(crate) fn begin_stage(&mut self, stage: u32) {
        let ends = self.in_progress();
        self.segments_before = ends.as_ref().map_or(self.segments_before, |ends| ends.segments);
        self.finished.drain(..self.finished.len().saturating_sub(KEPT - 1));
        self.finished.extend(ends);
        self.stage = stage;
        self.sums = Sums::default();
    }

    /// The last [`KEPT`] stages, the one in progress among them if it has a batch: a run that is stopped as it starts one
    /// reports the same as a run that ends there.
    pub(crate) fn stages(&self) -> Vec<Stage> {
        let new = self.in_progress();
        let kept = KEPT - new.iter().count();
        let skipped = self.finished.len().saturating_sub(kept);
        self.finished.iter().skip(skipped).cloned().chain(new).collect()
    }

    /// The stage in progress; `None` before its first batch.
    pub(crate) fn in_progress(&self) -> Option<Stage> {
        let counts = self.sums.total()?;
        let segments = self.segments_before + counts.first().segments;
        Some(Stage { number: self.stage, counts, segments })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::tally::readings::Group;

    fn batch(number: u64, segments: u64) -> Counts {
        let group = Group { group: number, batches: 1, sums: vec![1.0] };
        Counts::one(Readings { segments, ..Readings::of_groups(vec![group]) })
    }

    #[test]
    fn the_last_stage_knows_the_segments_of_all_before_it() {
        let mut series = Series::default();
        for stage in 1..=5 {
            series.push(batch(0, 10));
            series.push(batch(1, 3));
            assert_eq!(series.stages().last().unwrap().segments, 13 * u64::from(stage));
            series.begin_stage(stage);
        }
        let kept = series.stages();
        assert_eq!((kept.len(), kept.last().unwrap().segments), (KEPT, 65));
    }
}
