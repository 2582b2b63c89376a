//! Rounds of work: bounded waves of batches over all threads, summed in a fixed order.
//!
//! A batch holds photon paths and, where sensors are estimated backward or by gathering, gather
//! paths. A thread traces one batch at a time or, with gathering, a block of passes that share photons
//! and records. A wave is one batch of each group, or four passes; waves are traced in pieces. A signal stops a run at any time: the batches before the first unfinished one then
//! count, so that a run of that many batches reproduces it.

use crate::plan::Estimator;
use crate::transport::connect::weights::Sharing;
use crate::transport::estimators::{BatchBlock, Observers, Portion, Prepared};
use crate::transport::forward::Forward;
use crate::transport::run::findings::Findings;
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::readings::MIN_LIT_GROUPS;
use crate::transport::tally::sums::Merge;
use crate::transport::tally::{Counts, Series, merged};
use crate::transport::task::Task;
use crate::transport::{EstimatorChoice, Unobserved};
use rayon::prelude::*;
use std::fmt;
use std::ops::Range;

/// Batches of a piece per thread: threads wait for the last batch of a piece.
pub(super) const PIECE_BATCHES: u64 = 4;
/// Activity of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// An estimator is tried before the run.
    Pilot(Estimator),
    /// Batches of photon paths, of gather paths, or of both.
    Batches(Estimator),
    /// A pass of gathering, counted from 1.
    Pass {
        /// Gather, or mis.
        estimator: Estimator,
        /// Number of the pass.
        number: u64,
    },
}

impl fmt::Display for Phase {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pilot(estimator) => write!(out, "pilot of {}", estimator.name()),
            Self::Batches(estimator) => out.write_str(estimator.name()),
            Self::Pass { estimator, number } => write!(out, "{} pass {number}", estimator.name()),
        }
    }
}

/// A run in progress.
#[derive(Debug)]
pub struct Run<'s> {
    pub(super) estimators: Vec<Estimator>,
    pub(super) choices: Vec<EstimatorChoice>,
    pub(super) forward: Forward<'s>,
    pub(super) photons: Series,
    /// The other estimators, and what they have counted.
    pub(super) others: Vec<(Prepared<'s>, Series)>,
    pub(super) signal: StopSignal,
    /// Batches or passes so far.
    pub(super) batches: u64,
    /// Batches of a wave.
    pub(super) wave_batches: u64,
    /// Batches that a thread traces together.
    pub(super) block_batches: u64,
    /// Paths so far.
    pub(super) paths: u64,
    pub(super) paths_asked: Option<u64>,
    /// Batches into which the paths are divided; `None` for whole waves.
    pub(super) batches_asked: Option<u64>,
    /// Paths for which stages are planned; `None` where the end is not known.
    pub(super) paths_planned: Option<u64>,
}

/// Counts of a block of batches: by photons, and by each of the other estimators.
pub(super) struct BlockCounts {
    pub(super) photons: Counts,
    pub(super) others: Vec<Counts>,
}

impl<'s> Run<'s> {
    /// Divides the light of paths among the techniques of `mix` and `mis` in another way, before anything is traced: to
    /// compare what each finds alone.
    pub fn share_by(&mut self, sharing: Sharing) {
        self.others.iter_mut().for_each(|(own, _)| own.share_by(sharing));
    }

    /// Lets another signal stop the run from now on.
    pub fn stop_by(&mut self, signal: StopSignal) {
        self.signal = signal;
    }

    /// Traces the next piece of a round: a few batches for each thread. If the signal stops it, the
    /// batches before the first unfinished one count, and the others are dropped.
    pub fn next_piece(&mut self) {
        self.trace_piece(self.piece_limit());
    }

    /// Traces a piece that ends at this batch at most.
    fn trace_piece(&mut self, limit: u64) {
        let end = (self.batches + self.piece()).min(limit);
        let signal = match self.batches {
            0 => self.signal.with_grace(),
            _ => self.signal.clone(),
        };
        let blocks = self.blocks(self.batches..end);
        // Threads take blocks in their order: where a stop leaves one unfinished, few later ones are lost.
        let traced = blocks.into_iter().enumerate().par_bridge();
        let mut traced: Vec<(usize, Option<BlockCounts>)> =
            traced.map(|(place, block)| (place, self.block(block, &signal))).collect();
        traced.sort_unstable_by_key(|(place, _)| *place);
        traced.into_iter().map_while(|(_, block)| block).for_each(|block| self.add(block));
    }

    /// The blocks of some batches. Apart from the last of a run, all are whole.
    pub(super) fn blocks(&self, batches: Range<u64>) -> Vec<Range<u64>> {
        let first = batches.clone().step_by(self.block_batches as usize);
        first.map(|first| first..(first + self.block_batches).min(batches.end)).collect()
    }

    /// Batches up to which a piece may go: to the end of a wave, or, with passes, of all waves before the next decision.
    fn piece_limit(&self) -> u64 {
        let round = if self.has_passes() { self.round_end() } else { 0 };
        let waves = round.max(self.waves() + 1);
        let planned = self.planned_paths().map_or(u64::MAX, |paths| {
            self.batches
                .saturating_add(paths.saturating_sub(self.paths).div_ceil(self.batch_paths()))
        });
        // A run that is complete goes on by whole waves.
        let planned = if planned > self.batches { planned } else { u64::MAX };
        (waves * self.wave_batches).min(planned).min(self.batches_asked.unwrap_or(u64::MAX))
    }

    /// Whether some of its batches are passes, which count evenly only after a whole wave.
    pub fn has_passes(&self) -> bool {
        self.others.iter().any(|(own, _)| own.portion() == Portion::Pass)
    }

    /// Batches that are traced together: a few for each thread.
    pub(super) fn piece(&self) -> u64 {
        let per_thread = if self.has_passes() { self.block_batches } else { PIECE_BATCHES };
        per_thread * rayon::current_num_threads() as u64
    }

    /// Traces one block: the gather paths of all estimators, then photons past them, batch by batch. `None` if it was
    /// stopped.
    pub(super) fn block(&self, batches: Range<u64>, signal: &StopSignal) -> Option<BlockCounts> {
        let pace = Pace::new(signal);
        let photon_fluxes = self.forward.photon_fluxes();
        let task =
            Task { batch: batches.start, stage: 0, photon_fluxes: &photon_fluxes, pace: &pace };
        let count = batches.end - batches.start;
        let begun = self
            .others
            .iter()
            .map(|(own, series)| own.begin(Task { stage: series.stage(), ..task }, count));
        let mut others: Vec<BatchBlock<'_, 's>> = begun.collect::<Option<_>>()?;
        let mut photons = Vec::with_capacity(count as usize);
        for batch in batches {
            for own in &mut others {
                own.begin_photons(batch)?;
            }
            let traced = if others.iter().any(BatchBlock::observes) {
                self.forward.batch_observed(batch, &mut Observers(&mut others), &pace)?
            } else {
                self.forward.batch_observed(batch, &mut Unobserved, &pace)?
            };
            photons.push(Counts::one(traced));
        }
        let others: Vec<Counts> = others.into_iter().map(BatchBlock::finish).collect();
        let counts = BlockCounts { photons: merged(photons), others };
        (!pace.is_stopped()).then_some(counts)
    }

    pub(super) fn add(&mut self, block: BlockCounts) {
        let batches = block.photons.batch_count();
        self.batches += batches;
        self.paths += batches * self.batch_paths();
        for ((_, series), counts) in self.others.iter_mut().zip(block.others) {
            series.push(counts);
        }
        self.photons.push(block.photons);
    }

    /// Traces the rest of a wave, or a whole one.
    pub fn next_wave(&mut self) {
        let wave_end = (self.waves() + 1) * self.wave_batches;
        let end = wave_end.min(self.batches_asked.unwrap_or(u64::MAX));
        self.trace_piece(end);
        while !self.is_between_waves() && !self.is_complete() {
            self.trace_piece(end);
        }
    }

    /// Waves after which the next test of the stop rules is due: where an estimator next decides
    /// how to go on; else rounds grow by a quarter.
    pub fn round_end(&self) -> u64 {
        let waves = self.waves();
        let of_estimator = |(own, series): &(Prepared<'_>, Series)| {
            let left = own.next_decision(series)? - series.batches();
            Some(waves + left.div_ceil(self.wave_batches))
        };
        self.others.iter().filter_map(of_estimator).min().unwrap_or_else(|| {
            let next = (waves + 1).max(waves * 5 / 4);
            let wave = self.wave_batches * self.batch_paths();
            // Batches that were asked for may have more paths than that.
            let last = self.paths_asked.map_or(next, |paths| paths.div_ceil(wave));
            next.min(last.max(waves + 1))
        })
    }

    /// Whole waves traced so far.
    pub fn waves(&self) -> u64 {
        self.batches / self.wave_batches
    }

    /// Batches or passes traced so far.
    pub fn batches(&self) -> u64 {
        self.batches
    }

    /// The current activity.
    pub fn phase(&self) -> Phase {
        let Some((own, _)) = self.others.last() else { return Phase::Batches(Estimator::Forward) };
        let estimator = own.estimator();
        match own.portion() {
            Portion::Batch => Phase::Batches(estimator),
            Portion::Pass => Phase::Pass { estimator, number: self.batches + 1 },
        }
    }

    /// Photon paths of a batch, or of a pass.
    pub fn photons_per_batch(&self) -> u64 {
        self.forward.shares.iter().sum()
    }

    /// Whether no wave is in progress.
    pub fn is_between_waves(&self) -> bool {
        self.batches.is_multiple_of(self.wave_batches)
    }

    /// Whether all requested paths have been traced: the batches they are divided into, or whole
    /// waves.
    pub fn is_complete(&self) -> bool {
        match self.batches_asked {
            Some(asked) => self.batches >= asked,
            None => {
                let is_dark = self.batches > 0 && self.paths == 0;
                let is_enough = |asked| self.paths >= asked || is_dark;
                self.is_between_waves() && self.paths_asked.is_some_and(is_enough)
            }
        }
    }

    /// Paths traced so far, including those of a wave in progress.
    pub fn paths(&self) -> u64 {
        self.paths
    }

    /// Requested paths, rounded up to whole waves if their batches were not given; `None` without
    /// such a rule.
    pub fn planned_paths(&self) -> Option<u64> {
        let batch = self.batch_paths();
        if let Some(batches) = self.batches_asked {
            return Some(
                self.paths
                    .saturating_add(batches.saturating_sub(self.batches).saturating_mul(batch)),
            );
        }
        let in_wave = self.batches % self.wave_batches;
        let before = self.paths - in_wave * batch;
        let wave = self.wave_batches * batch;
        let left = |asked: u64| asked.saturating_sub(before).div_ceil(wave).saturating_mul(wave);
        self.paths_asked.map(|asked| before.saturating_add(left(asked)))
    }

    /// Whether an estimator can reduce its bias in further stages.
    pub fn can_reduce_bias(&self) -> bool {
        self.others.iter().any(|(own, _)| own.has_stages())
    }

    /// Whether a stage with less bias may follow now.
    pub fn may_end_stage(&self) -> bool {
        self.others.iter().any(|(own, series)| own.may_end_stage(series))
    }

    /// Starts the next stage of every estimator whose stage may end, if the paths that are left suffice for it.
    pub fn next_stage(&mut self) {
        self.begin_stages(&vec![0; self.others.len()]);
    }

    /// Lets the estimators decide after a round how to go on: where bias limits the run, a stage
    /// with less bias follows. If the run has a target, the caller knows whether bias limits that one. Returns the waves
    /// after which the next round ends.
    pub fn end_round(&mut self, limits_target: Option<bool>) -> u64 {
        let ahead = self.stages_ahead();
        let is_limited = ahead.iter().any(|&stages| stages > 0);
        let is_due = match limits_target {
            Some(limits) => limits && (is_limited || self.may_end_stage()),
            None => is_limited,
        };
        if is_due {
            self.begin_stages(&ahead);
        }
        self.round_end()
    }

    /// By how many stages each estimator should go on; 0 where noise limits it.
    fn stages_ahead(&self) -> Vec<u32> {
        let Some(photons) = self.photons.in_progress() else { return vec![0; self.others.len()] };
        let photons = photons.counts.first();
        self.others.iter().map(|(own, series)| own.stages_ahead(series, photons)).collect()
    }

    /// Starts a stage of every estimator whose bias limits the flux of a sensor; where bias limits none, a target may still
    /// ask for less, and all whose stage may end go on to the next. The stage is one for which the paths that are left are
    /// enough; without one, the stage in progress goes on.
    fn begin_stages(&mut self, ahead: &[u32]) {
        let is_limited = ahead.iter().any(|&stages| stages > 0);
        for (place, &stages) in ahead.iter().enumerate() {
            let (own, series) = &self.others[place];
            if stages > 0 || (!is_limited && own.may_end_stage(series)) {
                let next = (1..=stages.max(1)).map(|stages| series.stage() + stages);
                if let Some(stage) = next.rev().find(|&stage| self.has_paths_for(place, stage)) {
                    self.others[place].1.begin_stage(stage);
                }
            }
        }
    }

    /// Whether the paths that are left make passes enough for an error in this stage of an estimator.
    fn has_paths_for(&self, place: usize, stage: u32) -> bool {
        let stages = self.others.iter().enumerate().map(|(other, (own, series))| {
            own.batch_paths(if other == place { stage } else { series.stage() })
        });
        let pass = self.photons_per_batch() + stages.sum::<u64>();
        self.paths_planned.is_none_or(|planned| {
            let waves = planned.saturating_sub(self.paths).div_ceil(self.wave_batches * pass);
            waves * self.wave_batches >= MIN_LIT_GROUPS as u64
        })
    }

    /// Everything counted so far. At least one batch has been traced.
    pub fn findings(&self) -> Findings {
        let photons = self.photons.in_progress().expect("a batch has been traced");
        Findings {
            photons: photons.counts.first().clone().adjusted(self.forward.scene),
            others: self.others.iter().map(|(own, series)| own.found(series)).collect(),
            estimators: self.estimators.clone(),
            choices: self.choices.clone(),
            paths: self.paths,
        }
    }

    pub(super) fn batch_paths(&self) -> u64 {
        let others = self.others.iter().map(|(own, series)| own.batch_paths(series.stage()));
        self.photons_per_batch() + others.sum::<u64>()
    }
}
