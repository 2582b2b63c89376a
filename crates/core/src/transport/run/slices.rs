//! Slices of a run: some of its batches, traced elsewhere and merged to the same bits.
//!
//! The batches of a run are the leaves of one binary tree over their index. A slice keeps the sums
//! of the largest nodes of this tree that lie in it; all slices together contain the same sums as
//! the run itself.

use crate::plan::Schedule;
use crate::transport::run::rounds::{Batch, PIECE_BATCHES, Run};
use crate::transport::run::state::State;
use crate::transport::tally::sums::fold_aligned;
use crate::transport::{Readings, Windows};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Counts of some of the batches of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Slice {
    /// The batches.
    pub batches: Range<u64>,
    /// Batches of the whole run.
    pub of: u64,
    /// Nodes of the tree over all batches, in their order.
    photons: Vec<Readings>,
    backward: Vec<Readings>,
    windows: Vec<Windows>,
}

/// Why a run cannot be cut into slices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unsliceable {
    /// Its end depends on the findings, or on the clock.
    OpenEnd,
    /// The next, smaller windows of gathering depend on the findings.
    Stages,
}

impl Run<'_> {
    /// Batches of the whole run; an error if the batches of a slice are not known in advance.
    pub fn sliceable_batches(&self) -> Result<u64, Unsliceable> {
        let has_stages =
            self.stages.as_ref().is_some_and(|own| own.settings.schedule == Schedule::Stages);
        if has_stages {
            return Err(Unsliceable::Stages);
        }
        let asked = self.paths_asked.ok_or(Unsliceable::OpenEnd)?;
        if let Some(batches) = self.batches_asked {
            return Ok(batches);
        }
        Ok(asked.div_ceil(self.wave_batches * self.batch_paths()) * self.wave_batches)
    }

    /// Traces some batches of a run that has `of` in all. `watch` receives the number of finished
    /// ones. `None` if the signal stopped it.
    pub fn slice(&self, batches: Range<u64>, of: u64, watch: &mut dyn FnMut(u64)) -> Option<Slice> {
        let mut slice = Slice {
            batches: batches.clone(),
            of,
            photons: Vec::new(),
            backward: Vec::new(),
            windows: Vec::new(),
        };
        let per_thread = if self.stages.is_some() { 1 } else { PIECE_BATCHES };
        let piece = per_thread * rayon::current_num_threads() as u64;
        let mut first = batches.start;
        while first < batches.end {
            let end = (first + piece).min(batches.end);
            let traced: Option<Vec<Batch>> =
                (first..end).into_par_iter().map(|batch| self.batch(batch, &self.signal)).collect();
            traced?.into_iter().for_each(|batch| slice.add(batch));
            first = end;
            watch(first - batches.start);
        }
        Some(slice)
    }

    /// The state of the whole run from all of its slices, in their order.
    pub fn state_of_slices(&self, slices: Vec<Slice>) -> State {
        let batches = slices.last().map_or(0, |slice| slice.of);
        let (mut photons, mut backward, mut windows) = (Vec::new(), Vec::new(), Vec::new());
        for slice in slices {
            photons.extend(slice.photons);
            backward.extend(slice.backward);
            windows.extend(slice.windows);
        }
        self.state_after(batches, photons, backward, windows)
    }

    /// Paths of this many batches.
    pub fn paths_of(&self, batches: u64) -> u64 {
        batches * self.batch_paths()
    }
}

impl Slice {
    fn add(&mut self, batch: Batch) {
        fold_aligned(&mut self.photons, batch.photons);
        if let Some(backward) = batch.backward {
            fold_aligned(&mut self.backward, backward);
        }
        if let Some(windows) = batch.windows {
            fold_aligned(&mut self.windows, Windows::closed(windows));
        }
    }
}
