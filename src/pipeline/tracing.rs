//! Tracing until a stop rule holds, the clock runs out, or the user stops it.

use crate::pipeline::checkpoint::Checkpoint;
use crate::pipeline::progress::{Progress, TargetProgress, gathering};
use lumiduct_base::error::{Error, Result};
use lumiduct_core::measure::{self, Status};
use lumiduct_core::plan::RunPlan;
use lumiduct_core::transport::{
    Activity, FIRST_BATCH_GRACE, Findings, Interrupt, Phase, Run, StopSignal,
};
use lumiduct_input::Job;
use std::time::{Duration, Instant};

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// All requested paths are traced.
    Paths,
    /// The time is up.
    Time,
    /// The target is met.
    Target,
    /// The noise is well below the target; what remains is a bias that more paths do not reduce.
    Bias,
    /// Nothing of the target's measure was found in very many paths.
    Dark,
    /// The user asked to stop.
    Interrupted,
}

impl Stop {
    /// A sentence for the report, without times, as reports do not depend on the clock.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Paths => "all requested paths were traced",
            Self::Time => "the time limit was reached",
            Self::Target => "the target error was reached",
            Self::Bias => "more paths would not help: the target is below the bias of its measure",
            Self::Dark => "more paths would hardly help: the target's measure is still nothing",
            Self::Interrupted => "interrupted: this report is partial",
        }
    }
}

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

/// Traces rounds until a stop rule holds; an error if it was stopped before there was anything to
/// report.
pub fn trace(job: &Job, interrupt: &Interrupt, watch: &mut dyn FnMut(&Progress)) -> Result<Traced> {
    trace_kept(job, None, &mut |_, _| Ok(()), interrupt, watch)
}

/// A moment at which a checkpoint may be kept.
pub(super) enum Pause {
    /// The run continues.
    Between { round_end: u64, elapsed: Duration },
    /// The user has stopped it.
    Last { round_end: u64, elapsed: Duration },
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

/// Traces rounds from the state of a run until a stop rule holds; `keep` may save a checkpoint at
/// every pause.
pub(super) fn trace_kept(
    job: &Job,
    checkpoint: Option<Checkpoint>,
    keep: &mut dyn FnMut(&Run<'_>, Pause) -> Result<()>,
    interrupt: &Interrupt,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Traced> {
    interrupt.begin(Activity::Tracing);
    let before = checkpoint.as_ref().map_or(Duration::ZERO, |checkpoint| checkpoint.elapsed);
    let clock = Clock { plan: &job.run, start: Instant::now(), before, interrupt };
    let (mut run, mut round_end) = started(job, checkpoint, &clock, watch)?;
    let elapsed = || clock.elapsed();
    let (mut target, mut is_gathering_reported) = (None, false);
    let stop = loop {
        let mut early = early_stop(&run, &clock);
        while run.waves() < round_end && early.is_none() {
            run.next_piece();
            early = early_stop(&run, &clock);
            if run.paths() == 0 {
                continue;
            }
            keep(&run, Pause::Between { round_end, elapsed: elapsed() })?;
            let mut progress = Progress::of(&job.run, &run, elapsed(), target.clone());
            if !is_gathering_reported {
                progress.gathering = gathering(&run.findings());
                is_gathering_reported = true;
            }
            watch(&progress);
        }
        if let Some(stop) = early {
            if run.paths() == 0 {
                return Err(nothing_to_report(first_work(run.phase()), interrupt));
            }
            if stop == Stop::Interrupted {
                keep(&run, Pause::Last { round_end, elapsed: elapsed() })?;
            }
            break stop;
        }
        target = TargetProgress::of(job, &run);
        watch(&Progress::of(&job.run, &run, elapsed(), target.clone()));
        let stop = target.as_ref().and_then(|target| target_stop(target, run.paths()));
        // Smaller windows reduce the bias.
        if let Some(stop) = stop.filter(|stop| *stop != Stop::Bias || !run.shrinks()) {
            break stop;
        }
        let is_held = || match &target {
            Some(target) => is_held_by_bias(target),
            None => measure::is_held_by_bias(&job.scene, &run.findings()),
        };
        if run.may_end_stage() && is_held() {
            run.next_stage();
        }
        round_end = run.round_end();
    };
    Ok(Traced { findings: run.findings(), stop, elapsed: elapsed() })
}

/// A prepared run, new or resumed, and the waves after which its stop rules are checked next.
fn started<'j>(
    job: &'j Job,
    checkpoint: Option<Checkpoint>,
    clock: &Clock<'_>,
    watch: &mut dyn FnMut(&Progress),
) -> Result<(Run<'j>, u64)> {
    let resumed = checkpoint.as_ref().map(|checkpoint| checkpoint.state.plan(&job.run));
    let plan = resumed.as_ref().unwrap_or(&job.run);
    let run = Run::start(&job.scene, plan, &clock.signal(), &mut |phase| {
        watch(&Progress::before(&job.run, phase, clock.elapsed()));
    });
    let mut run = run.ok_or_else(|| nothing_to_report("the pilot", clock.interrupt))?;
    let Some(checkpoint) = checkpoint else {
        let round_end = run.round_end();
        return Ok((run, round_end));
    };
    run.restore(checkpoint.state);
    Ok((run, checkpoint.round_end))
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
            "interrupted during {during}: nothing is counted yet, and there is nothing to report"
        )
    } else {
        format!(
            "the time was up during {during}: nothing is counted yet, and there is nothing to report; give more time, passes of \
             fewer --photons and --records, or --estimator forward, whose batches are short"
        )
    })
}

/// A run gives up on a target that its bias prevents once the noise is this share of the wanted
/// error, 1.
const NOISE_DONE: f64 = 0.3;
/// Paths after which a run to a target gives up on a measure that is still zero.
const DARK_PATHS: u64 = 200_000_000;

/// Whether the target ends the run, and why.
fn target_stop(target: &TargetProgress, paths: u64) -> Option<Stop> {
    let (reached, wanted) = (&target.reached, target.wanted);
    if reached.relative_error() <= wanted {
        return Some(Stop::Target);
    }
    let noise_done = NOISE_DONE * wanted * reached.value.abs();
    if reached.value != 0.0 && reached.std_error <= noise_done {
        return Some(Stop::Bias);
    }
    (reached.value == 0.0 && paths >= DARK_PATHS).then_some(Stop::Dark)
}

/// Whether a smaller window reduces the error more than more paths would.
fn is_held_by_bias(target: &TargetProgress) -> bool {
    let reached = &target.reached;
    reached.status == Status::BiasNotResolved
        || reached.bias.is_some_and(|bias| bias > reached.std_error)
}

/// What ends a run before its round is over.
fn early_stop(run: &Run<'_>, clock: &Clock<'_>) -> Option<Stop> {
    if run.is_complete() {
        Some(Stop::Paths)
    } else if clock.interrupt.is_raised() {
        Some(Stop::Interrupted)
    } else {
        clock.is_up(run).then_some(Stop::Time)
    }
}
