//! Rounds of work: bounded waves of batches over all threads, folded in a fixed order.
//!
//! A wave is one batch of each group: stop rules act after whole waves, so that asking for the number of paths that
//! a run did repeats it. Waves are traced in pieces, between which a run can be interrupted. Batches are folded in a binary
//! tree over their index, whatever thread traced them and in whatever pieces they came, so the result has the same
//! bits for any number of threads. Only the partial sums of that tree are kept: memory does not grow with the number
//! of paths.

use crate::scene::Scene;
use crate::scene::plan::RunPlan;
use crate::transport::Readings;
use crate::transport::forward::Forward;
use crate::transport::readings::GROUPS;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Straight pieces that a batch should hold: long enough that summing up costs little, short enough to stop soon.
const BATCH_SEGMENTS: u64 = 1 << 15;
/// Most paths in a batch.
const BATCH_PATHS: u64 = 4096;
/// Paths from which the length of paths is learnt before a run, and bounces of them that are looked at.
const PILOT_PATHS: u64 = 64;
const PILOT_BOUNCES: u32 = 10_000;
/// Batches of a piece per thread: threads wait for the last batch of a piece.
const PIECE_BATCHES: u64 = 4;

/// A flag that asks a run to stop.
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
    /// Partial sums of the tree over whole waves.
    done: Vec<Readings>,
    /// Partial sums of the tree over the batches of the wave in progress.
    wave: Vec<Readings>,
    waves: u64,
    last_wave: Option<u64>,
}

impl<'s> Run<'s> {
    /// Prepares a run; nothing is counted yet.
    pub fn new(scene: &'s Scene, plan: &RunPlan) -> Self {
        let forward = |limit, paths| Forward::new(scene, plan.seed, limit, paths);
        let pilot = forward(plan.bounce_limit.min(PILOT_BOUNCES), PILOT_PATHS).batch(0);
        let segments = pilot.segments.div_ceil(pilot.paths().max(1)).max(1);
        // A path of each source at least.
        let sources = scene.sources.len().max(1) as u64;
        let usual = (BATCH_SEGMENTS / segments).clamp(1, BATCH_PATHS).max(sources);
        let waves = plan.stop.paths.map(|paths| paths.div_ceil(GROUPS * usual).max(1));
        let batch_paths = match (plan.stop.paths, waves) {
            (Some(paths), Some(waves)) => paths.div_ceil(GROUPS * waves).max(sources),
            _ => usual,
        };
        Self {
            forward: forward(plan.bounce_limit, batch_paths),
            done: Vec::new(),
            wave: Vec::new(),
            waves: 0,
            last_wave: waves,
        }
    }

    /// Traces the next piece of a wave: a few batches for each thread.
    pub fn next_piece(&mut self) {
        let first = self.batches_of_wave();
        let piece = PIECE_BATCHES * rayon::current_num_threads() as u64;
        let end = (first + piece).min(GROUPS);
        let before = self.waves * GROUPS;
        let batches: Vec<Readings> = (before + first..before + end)
            .into_par_iter()
            .map(|batch| self.forward.batch(batch))
            .collect();
        batches.into_iter().for_each(|batch| fold(&mut self.wave, batch));
        if end == GROUPS {
            self.wave.drain(..).for_each(|wave| fold(&mut self.done, wave));
            self.waves += 1;
        }
    }

    /// Traces the rest of a wave, or a whole one.
    pub fn next_wave(&mut self) {
        self.next_piece();
        while !self.is_between_waves() {
            self.next_piece();
        }
    }

    /// Waves after which the next test of the stop rules is due: rounds grow by a quarter.
    pub fn round_end(&self) -> u64 {
        let next = (self.waves + 1).max(self.waves * 5 / 4);
        self.last_wave.map_or(next, |last| next.min(last))
    }

    /// Whole waves traced so far.
    pub fn waves(&self) -> u64 {
        self.waves
    }

    /// Whether no wave is in progress.
    pub fn is_between_waves(&self) -> bool {
        self.wave.is_empty()
    }

    /// Whether all paths that were asked for have been traced.
    pub fn is_complete(&self) -> bool {
        self.last_wave.is_some_and(|last| self.waves >= last)
    }

    /// Paths traced so far, those of a wave in progress included.
    pub fn paths(&self) -> u64 {
        (self.waves * GROUPS + self.batches_of_wave()) * self.batch_paths()
    }

    /// Paths asked for, rounded up to whole batches; `None` without such a rule.
    pub fn planned_paths(&self) -> Option<u64> {
        self.last_wave.map(|last| last * GROUPS * self.batch_paths())
    }

    /// Everything counted in whole waves, so that all groups have equally many batches; in a first wave that was
    /// stopped, in all of its batches so far. At least one piece has been traced.
    pub fn readings(&self) -> Readings {
        let partial = if self.done.is_empty() { &self.wave } else { &self.done };
        let mut partial = partial.iter().rev();
        let mut sum = partial.next().expect("a piece has been traced").clone();
        // The right edge of the tree: smaller subtrees join the larger ones on their left.
        for left in partial {
            sum = left.clone().merge(&sum);
        }
        sum
    }

    fn batches_of_wave(&self) -> u64 {
        self.wave.iter().map(Readings::batch_count).sum()
    }

    fn batch_paths(&self) -> u64 {
        self.forward.shares.iter().sum()
    }
}

/// Adds a node to the partial sums of a tree, each of which covers a power of two of batches, larger ones first;
/// neighbours that cover equally many become one.
fn fold(partial: &mut Vec<Readings>, mut node: Readings) {
    while let Some(left) = partial.pop_if(|left| left.batch_count() == node.batch_count()) {
        node = left.merge(&node);
    }
    partial.push(node);
}
