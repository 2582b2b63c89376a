//! One timed run of one method.

use crate::pipeline::compare::bench::Bench;
use crate::pipeline::compare::method::Method;
use lumiduct_base::error::{Error, Result};
use lumiduct_baselines::BaselineRun;
use lumiduct_core::measure;
use lumiduct_core::plan::Request;
use lumiduct_core::transport::{Findings, Run, StopSignal};
use lumiduct_report::{CheckpointSample, TrueCells};
use std::time::{Duration, Instant};

/// A run to do.
pub(super) struct Stint<'a> {
    pub(super) method: Method,
    /// Number of the run: its seed.
    pub(super) run: u64,
    /// When it is sampled; the last is its end.
    pub(super) checkpoints: &'a [Duration],
    /// What its cells are compared with, where that is known.
    pub(super) cells: Option<&'a TrueCells>,
}

/// A run that was done.
pub(super) struct TracedRun {
    /// Its sample at each checkpoint, `None` where it had no value yet.
    pub(super) samples: Vec<Option<CheckpointSample>>,
    /// Its final value, with its own error.
    pub(super) last: Option<ReportedValue>,
    /// Throughput of gather paths that it cut off, 1.
    pub(super) cut: f64,
}

/// A value with the error that the run reports.
#[derive(Debug, Clone)]
pub(super) struct ReportedValue {
    pub(super) value: f64,
    pub(super) std_error: f64,
    /// Flux and standard error of each cell.
    pub(super) cells: Vec<(f64, f64)>,
}

/// Traces one run until its last checkpoint. Its preparation counts toward its time, sampling it
/// does not.
pub(super) fn trace(bench: &Bench<'_>, stint: &Stint<'_>) -> Result<TracedRun> {
    let Stint { method, run, checkpoints, cells } = *stint;
    let start = Instant::now();
    let interrupted = || Error::Usage("interrupted: nothing was written".into());
    let mut samples: Vec<Option<CheckpointSample>> = vec![None; checkpoints.len()];
    let end = checkpoints.last().and_then(|end| start.checked_add(*end));
    let Some(mut runner) = Runner::new(bench, (method, run), end) else {
        // The time ended before anything was counted.
        let nothing = TracedRun { samples, last: None, cut: 0.0 };
        return if bench.interrupt.is_raised() { Err(interrupted()) } else { Ok(nothing) };
    };
    let mut spent = start.elapsed();
    let mut last: Option<(CheckpointSample, ReportedValue)> = None;
    loop {
        let start = Instant::now();
        runner.next_piece();
        spent += start.elapsed();
        if bench.interrupt.is_raised() {
            return Err(interrupted());
        }
        let is_over = checkpoints.last().is_none_or(|end| spent >= *end);
        let place = checkpoints.iter().rposition(|checkpoint| *checkpoint <= spent);
        let is_due = is_over || place.is_some_and(|place| samples[place].is_none());
        if runner.is_readable() && (is_due || runner.is_rarely_readable()) {
            last = runner.look(bench, spent, cells);
            if let (Some(place), Some((sample, _))) = (place, &last) {
                samples[place].get_or_insert(*sample);
            }
        }
        if is_over {
            break;
        }
    }
    if let (Some(end), Some((sample, _))) = (samples.last_mut(), &last) {
        *end = Some(*sample);
    }
    Ok(TracedRun { samples, last: last.map(|(_, estimate)| estimate), cut: runner.cut() })
}

/// A running method.
enum Runner<'s> {
    Run {
        run: Box<Run<'s>>,
        /// Waves after which a stage may end.
        round_end: u64,
    },
    Baseline(Box<BaselineRun<'s>>),
}

impl<'s> Runner<'s> {
    /// `None` if it was interrupted, or not prepared by its end.
    fn new(bench: &Bench<'s>, (method, run): (Method, u64), end: Option<Instant>) -> Option<Self> {
        Some(match method {
            Method::Run(request) => {
                // Pilot and passes fit the time of the run; it then goes on while it is being sampled.
                let limit = StopSignal::new(bench.interrupt, end);
                let plan = bench.plan(request, run);
                let mut run = Run::start(&bench.job.scene, &plan, &limit, &mut |_| ())?;
                run.stop_by(StopSignal::new(bench.interrupt, None));
                Self::Run { round_end: run.round_end(), run: Box::new(run) }
            }
            Method::Baseline(baseline) => {
                let plan = bench.plan(Request::Forward, run);
                let run = BaselineRun::new(&bench.job.scene, bench.id, &plan, baseline);
                Self::Baseline(Box::new(run))
            }
        })
    }

    fn next_piece(&mut self) {
        match self {
            Self::Run { run, round_end } => {
                if run.is_between_waves() && run.waves() >= *round_end {
                    *round_end = run.end_round(None);
                }
                run.next_piece();
            }
            Self::Baseline(run) => run.next_piece(),
        }
    }

    /// Whether its readings include all its work: waves of passes are included only when complete.
    fn is_readable(&self) -> bool {
        match self {
            Self::Run { run, .. } => {
                !run.has_passes() || run.waves() == 0 || run.is_between_waves()
            }
            Self::Baseline(_) => true,
        }
    }

    /// Whether it must be sampled whenever it is readable.
    fn is_rarely_readable(&self) -> bool {
        match self {
            Self::Run { run, .. } => run.has_passes() && run.waves() > 0,
            Self::Baseline(_) => false,
        }
    }

    /// Its results so far.
    fn look(
        &self,
        bench: &Bench<'_>,
        spent: Duration,
        truth: Option<&TrueCells>,
    ) -> Option<(CheckpointSample, ReportedValue)> {
        let (findings, segments) = match self {
            Self::Run { run, .. } => {
                let findings = run.findings();
                let segments = findings.segments();
                (findings, segments)
            }
            Self::Baseline(run) => {
                let readings = run.readings()?;
                let segments = readings.segments;
                (Findings::forward(readings), segments)
            }
        };
        let measure = measure::value_of(&bench.job.scene, &findings, &bench.measure())?;
        let (value, std_error) = (measure.value, measure.std_error);
        let cells = measure::cell_fluxes(&bench.job.scene, &findings, bench.id);
        // Only the error is kept of the cells, which may be many.
        let cell_error = truth.map(|truth| {
            truth.error_of(&cells.iter().map(|(flux, _)| *flux).collect::<Vec<f64>>())
        });
        let seconds = spent.as_secs_f64();
        let sample = CheckpointSample { seconds, segments, value, cell_error };
        Some((sample, ReportedValue { value, std_error, cells }))
    }

    fn cut(&self) -> f64 {
        match self {
            Self::Run { .. } => 0.0,
            Self::Baseline(run) => run.cut(),
        }
    }
}
