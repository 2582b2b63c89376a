//! Rounds of work: bounded waves of batches over all threads, folded in a fixed order.
//!
//! A wave is one batch of each group. Batches are folded in a binary tree over their index, whatever thread traced
//! them and in whatever waves they came, so the result has the same bits for any number of threads. Only the partial
//! sums of that tree are kept: memory does not grow with the number of paths.

use crate::scene::Scene;
use crate::scene::plan::RunPlan;
use crate::transport::Readings;
use crate::transport::forward::Forward;
use crate::transport::readings::GROUPS;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Paths in a batch, unless fewer were asked for.
const BATCH_PATHS: u64 = 4096;

/// A flag that asks a run to stop after the wave it is in.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Asks the run to stop.
    pub fn raise(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the run was asked to stop.
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A run in progress.
#[derive(Debug)]
pub struct Run<'s> {
    forward: Forward<'s>,
    /// Partial sums of the tree: each covers a power of two of batches, larger ones first.
    partial: Vec<Readings>,
    waves: u64,
    last_wave: Option<u64>,
}

impl<'s> Run<'s> {
    /// Prepares a run; nothing is traced yet.
    pub fn new(scene: &'s Scene, plan: &RunPlan) -> Self {
        let waves = plan.stop.paths.map(|paths| paths.div_ceil(GROUPS * BATCH_PATHS).max(1));
        let batch_paths = match (plan.stop.paths, waves) {
            (Some(paths), Some(waves)) => paths.div_ceil(GROUPS * waves).max(1),
            _ => BATCH_PATHS,
        };
        Self {
            forward: Forward::new(scene, plan.seed, plan.bounce_limit, batch_paths),
            partial: Vec::new(),
            waves: 0,
            last_wave: waves,
        }
    }

    /// Traces one wave.
    pub fn next_wave(&mut self) {
        let first = self.waves * GROUPS;
        let batches: Vec<Readings> = (first..first + GROUPS)
            .into_par_iter()
            .map(|batch| self.forward.batch(batch))
            .collect();
        for batch in batches {
            self.fold(batch);
        }
        self.waves += 1;
    }

    /// Waves after which the next test of the stop rules is due: rounds grow by a quarter.
    pub fn round_end(&self) -> u64 {
        let next = (self.waves + 1).max(self.waves * 5 / 4);
        self.last_wave.map_or(next, |last| next.min(last))
    }

    /// Waves traced so far.
    pub fn waves(&self) -> u64 {
        self.waves
    }

    /// Whether all paths that were asked for have been traced.
    pub fn is_complete(&self) -> bool {
        self.last_wave.is_some_and(|last| self.waves >= last)
    }

    /// Paths traced so far.
    pub fn paths(&self) -> u64 {
        self.waves * GROUPS * self.forward.shares.iter().sum::<u64>()
    }

    /// Paths asked for, rounded up to whole batches; `None` without such a rule.
    pub fn planned_paths(&self) -> Option<u64> {
        let batch: u64 = self.forward.shares.iter().sum();
        self.last_wave.map(|last| last * GROUPS * batch)
    }

    /// Everything counted so far. At least one wave has been traced.
    pub fn readings(&self) -> Readings {
        let mut partial = self.partial.iter().rev();
        let mut sum = partial.next().expect("a wave has been traced").clone();
        // The right edge of the tree: smaller subtrees join the larger ones on their left.
        for left in partial {
            sum = left.clone().merge(&sum);
        }
        sum
    }

    /// Adds a batch as a leaf of the tree; neighbours that cover equally many batches become one.
    fn fold(&mut self, batch: Readings) {
        let mut node = batch;
        while let Some(left) = self.partial.pop_if(|left| left.batch_count() == node.batch_count())
        {
            node = left.merge(&node);
        }
        self.partial.push(node);
    }
}
