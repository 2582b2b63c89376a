//! Tracing until a stop rule holds, the clock runs out, or the user stops it.

use crate::pipeline::checkpoint::{Checkpoint, Follows, Pause};
use crate::pipeline::progress::{Progress, TargetProgress, gathering};
use crate::pipeline::stop::{Stop, by_target, is_limited_by_bias};
use lumiduct_base::error::{Error, Result};
use lumiduct_core::plan::RunPlan;
use lumiduct_core::transport::{
    Activity, FIRST_BATCH_GRACE, Findings, Interrupt, Phase, Run, StopSignal,
};
use lumiduct_input::Job;
use std::time::{Duration, Instant};

/// The outcome of tracing.
#[derive(Debug)]
pub struct Traced {
    /// Everything that was counted.
    pub findings: Findings,
    /// Why it ended.
    pub stop: Stop,
    /// How long it took.
    pub elapsed: Duration,
}

/// Traces rounds until a stop rule holds.
///
/// # Errors
///
/// [`Error::Usage`] if the user stops it, or its time runs out, before anything is counted.
pub fn trace(job: &Job, interrupt: &Interrupt, watch: &mut dyn FnMut(&Progress)) -> Result<Traced> {
    trace_from(job, None, &mut |_| Ok(()), interrupt, watch)
}

/// Traces rounds, from a checkpoint if there is one, until a stop rule holds; `save` may save a
/// checkpoint at every pause.
pub(super) fn trace_from(
    job: &Job,
    checkpoint: Option<Checkpoint>,
    save: &mut dyn FnMut(&Pause<'_>) -> Result<()>,
    interrupt: &Interrupt,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Traced> {
    interrupt.begin(Activity::Tracing);
    let mut tracing = Tracing::start(job, checkpoint, interrupt, watch)?;
    let stop = loop {
        if let Some(stop) = tracing.trace_round(save, watch)? {
            break stop;
        }
        if let Some(stop) = tracing.end_round(watch) {
            break stop;
        }
    };
    Ok(Traced { findings: tracing.run.findings(), stop, elapsed: tracing.clock.elapsed() })
}

/// The time of a run.
struct Clock<'a> {
    plan: &'a RunPlan,
    start: Instant,
    /// Time taken before it was resumed.
    before: Duration,
    interrupt: &'a Interrupt,
}

impl Clock<'_> {
    fn elapsed(&self) -> Duration {
        self.before + self.start.elapsed()
    }

    fn signal(&self) -> StopSignal {
        let left = self.plan.stop.time.map(|limit| limit.saturating_sub(self.before));
        StopSignal::new(self.interrupt, left.and_then(|left| self.start.checked_add(left)))
    }

    /// Whether the time of a run that has traced something is up.
    fn is_up(&self, run: &Run<'_>) -> bool {
        let grace = if run.paths() == 0 { FIRST_BATCH_GRACE } else { Duration::ZERO };
        self.plan.stop.time.is_some_and(|limit| self.elapsed() >= limit.saturating_add(grace))
    }
}

/// A run, its clock, and when its stop rules are checked next.
struct Tracing<'j> {
    job: &'j Job,
    run: Run<'j>,
    clock: Clock<'j>,
    /// Waves after which the round ends.
    round_end: u64,
    target: Option<TargetProgress>,
    is_gathering_reported: bool,
}

impl<'j> Tracing<'j> {
    /// Prepares a run, new or resumed.
    fn start(
        job: &'j Job,
        checkpoint: Option<Checkpoint>,
        interrupt: &'j Interrupt,
        watch: &mut dyn FnMut(&Progress),
    ) -> Result<Self> {
        let before = checkpoint.as_ref().map_or(Duration::ZERO, |checkpoint| checkpoint.elapsed);
        let clock = Clock { plan: &job.run, start: Instant::now(), before, interrupt };
        let resumed = checkpoint.as_ref().map(|checkpoint| checkpoint.state.plan(&job.run));
        let plan = resumed.as_ref().unwrap_or(&job.run);
        let run = Run::start(&job.scene, plan, &clock.signal(), &mut |phase| {
            watch(&Progress::before(&job.run, phase, clock.elapsed()));
        });
        let mut run = run.ok_or_else(|| nothing_to_report("the pilot", interrupt))?;
        let mut round_end = run.round_end();
        if let Some(checkpoint) = checkpoint {
            run.restore(checkpoint.state);
            round_end = checkpoint.round_end;
        }
        Ok(Self { job, run, clock, round_end, target: None, is_gathering_reported: false })
    }

    /// Traces until the round is over, or until something ends the run before.
    fn trace_round(
        &mut self,
        save: &mut dyn FnMut(&Pause<'_>) -> Result<()>,
        watch: &mut dyn FnMut(&Progress),
    ) -> Result<Option<Stop>> {
        let mut early = self.early_stop();
        while self.run.waves() < self.round_end && early.is_none() {
            self.run.next_piece();
            early = self.early_stop();
            if self.run.paths() > 0 {
                save(&self.pause(Follows::Work))?;
                watch(&self.progress());
            }
        }
        if early.is_some() && self.run.paths() == 0 {
            return Err(nothing_to_report(first_work(self.run.phase()), self.clock.interrupt));
        }
        if early == Some(Stop::Interrupted) {
            save(&self.pause(Follows::End))?;
        }
        Ok(early)
    }

    /// Checks the target, and lets the estimators decide how to go on.
    fn end_round(&mut self, watch: &mut dyn FnMut(&Progress)) -> Option<Stop> {
        self.target = TargetProgress::of(self.job, &self.run);
        watch(&self.progress());
        let stop = self.target.as_ref().and_then(|target| by_target(target, self.run.paths()));
        let may_help = stop == Some(Stop::Bias) && self.run.can_reduce_bias();
        if stop.is_some() && !may_help {
            return stop;
        }
        self.round_end = self.run.end_round(self.target.as_ref().map(is_limited_by_bias));
        None
    }

    /// What ends the run before its round is over.
    fn early_stop(&self) -> Option<Stop> {
        if self.run.is_complete() {
            Some(Stop::complete(&self.clock.plan.stop))
        } else if self.clock.interrupt.is_raised() {
            Some(Stop::Interrupted)
        } else {
            self.clock.is_up(&self.run).then_some(Stop::Time)
        }
    }

    fn pause(&self, follows: Follows) -> Pause<'_> {
        let Self { run, round_end, .. } = self;
        Pause { run, round_end: *round_end, elapsed: self.clock.elapsed(), follows }
    }

    fn progress(&mut self) -> Progress {
        let elapsed = self.clock.elapsed();
        let mut progress = Progress::of(&self.job.run, &self.run, elapsed, self.target.clone());
        if !self.is_gathering_reported {
            progress.gathering = gathering(&self.job.scene, &self.run.findings());
            self.is_gathering_reported = true;
        }
        progress
    }
}

/// What a run does first.
fn first_work(phase: Phase) -> &'static str {
    match phase {
        Phase::Pilot(_) => "the pilot",
        Phase::Batches(_) => "the first batch",
        Phase::Pass { .. } => "the first pass of gathering",
    }
}

/// A run was stopped before its first batch was done.
fn nothing_to_report(during: &str, interrupt: &Interrupt) -> Error {
    Error::Usage(if interrupt.is_raised() {
        format!(
            "interrupted during {during}: nothing was counted yet, so there is nothing to report"
        )
    } else {
        format!(
            "the time ran out during {during}: nothing was counted yet, so there is nothing to report; give \
                more time, smaller --photons and --records, or --estimator forward, whose batches are short"
        )
    })
}
