//! Slices of a run: some of its batches, traced elsewhere and merged to the same bits.
//!
//! The batches of a run are the leaves of one binary tree over their index. A slice keeps the sums
//! of the largest nodes of this tree that lie in it; all slices together contain the same sums as
//! the run itself.

use crate::transport::run::rounds::{BlockCounts, Run};
use crate::transport::run::shard::Shard;
use crate::transport::run::state::RunState;
use crate::transport::tally::Counts;
use crate::transport::tally::sums::fold_aligned;
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
    photons: Vec<Counts>,
    /// The same for each of the other estimators.
    others: Vec<Vec<Counts>>,
}

/// Why a run cannot be cut into slices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unsliceable {
    /// Its end depends on the findings, or on the clock.
    OpenEnd,
    /// The next stage of an estimator depends on the findings.
    Stages,
}

impl Run<'_> {
    /// Batches of the whole run, where those of a slice are known in advance.
    ///
    /// # Errors
    ///
    /// [`Unsliceable::Stages`] if gathering chooses its windows from the findings, [`Unsliceable::OpenEnd`] if the
    /// run has no number of paths.
    pub fn sliceable_batches(&self) -> Result<u64, Unsliceable> {
        if self.can_reduce_bias() {
            return Err(Unsliceable::Stages);
        }
        let asked = self.paths_asked.ok_or(Unsliceable::OpenEnd)?;
        if let Some(batches) = self.batches_asked {
            return Ok(batches);
        }
        Ok(asked.div_ceil(self.wave_batches * self.batch_paths()) * self.wave_batches)
    }

    /// The batches of a part of a run that has `of` in all: whole blocks.
    pub fn batches_of_part(&self, part: Shard, of: u64) -> Range<u64> {
        let blocks = part.of(of.div_ceil(self.block_batches));
        let edge = |block: u64| (block * self.block_batches).min(of);
        edge(blocks.start)..edge(blocks.end)
    }

    /// Traces some batches, whole blocks, of a run that has `of` in all. `watch` receives the number of finished
    /// ones. `None` if the signal stopped it.
    pub fn slice(&self, batches: Range<u64>, of: u64, watch: &mut dyn FnMut(u64)) -> Option<Slice> {
        let mut slice = Slice {
            batches: batches.clone(),
            of,
            photons: Vec::new(),
            others: vec![Vec::new(); self.others.len()],
        };
        let piece = self.piece();
        let mut first = batches.start;
        while first < batches.end {
            let end = (first + piece).min(batches.end);
            let blocks = self.blocks(first..end).into_par_iter();
            let traced: Option<Vec<BlockCounts>> =
                blocks.map(|block| self.block(block, &self.signal)).collect();
            traced?.into_iter().for_each(|block| slice.add(block));
            first = end;
            watch(first - batches.start);
        }
        Some(slice)
    }

    /// The state of the whole run from all of its slices, in their order.
    pub fn state_of_slices(&self, slices: Vec<Slice>) -> RunState {
        let batches = slices.last().map_or(0, |slice| slice.of);
        let (mut photons, mut others) = (Vec::new(), vec![Vec::new(); self.others.len()]);
        for slice in slices {
            photons.extend(slice.photons);
            for (own, nodes) in others.iter_mut().zip(slice.others) {
                own.extend(nodes);
            }
        }
        self.state_after(batches, photons, others)
    }
}

impl Slice {
    fn add(&mut self, block: BlockCounts) {
        fold_aligned(&mut self.photons, block.photons);
        for (nodes, counts) in self.others.iter_mut().zip(block.others) {
            fold_aligned(nodes, counts);
        }
    }
}
