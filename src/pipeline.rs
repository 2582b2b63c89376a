//! The flow, one call per step: a scene file becomes a report.

use crate::error::Result;
use crate::input::{self, Job, Settings};
use crate::measure::{self, Measure};
use crate::report::{self, Report};
use crate::scene::plan::RunPlan;
use crate::transport::{Interrupt, Run};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Where the report goes, and whether one that is there may be replaced.
#[derive(Debug, Clone)]
pub struct Output {
    /// The folder of the report; `reports/NAME` when none is given.
    pub dir: Option<PathBuf>,
    /// What to do with a report that is there.
    pub existing: Existing,
}

/// What to do with a report that is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// Refuse to run.
    Keep,
    /// Replace its files when the new ones are complete.
    Replace,
}

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// All paths that were asked for are traced.
    Paths,
    /// The time is up.
    Time,
    /// The target is met.
    Target,
    /// The user asked to stop.
    Interrupted,
}

impl Stop {
    /// A sentence for the report. It names no time: reports do not depend on the clock.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Paths => "all requested paths were traced",
            Self::Time => "the time limit was reached",
            Self::Target => "the target error was reached",
            Self::Interrupted => "interrupted: this report is partial",
        }
    }
}

/// How far a run has come: for progress displays.
#[derive(Debug, Clone)]
pub struct Progress {
    /// Paths traced.
    pub paths: u64,
    /// Paths asked for, when that is a stop rule.
    pub planned_paths: Option<u64>,
    /// Time since the start of tracing.
    pub elapsed: Duration,
    /// The time asked for, when that is a stop rule.
    pub time_limit: Option<Duration>,
    /// The target: name, value, relative error reached and wanted; at the end of a round.
    pub target: Option<TargetProgress>,
}

/// How well the target measure is known.
#[derive(Debug, Clone)]
pub struct TargetProgress {
    /// Dotted name.
    pub measure: String,
    /// Its value and error.
    pub reached: Measure,
    /// The relative error wanted, 1.
    pub wanted: f64,
}

impl Progress {
    /// How much of the work is done, by the rule that is nearest to its end; 0..=1.
    pub fn fraction(&self) -> f64 {
        let paths = self.planned_paths.map_or(0.0, |planned| self.paths as f64 / planned as f64);
        let time = self.time_limit.map_or(0.0, |limit| self.elapsed.as_secs_f64() / limit.as_secs_f64());
        // The error falls as one over the square root of the paths.
        let target = self.target.as_ref().map_or(0.0, |target| (target.wanted / target.relative_error()).powi(2));
        paths.max(time).max(target).min(1.0)
    }

    /// Paths per second, the target's value and error, and the time left.
    pub fn sentence(&self) -> String {
        let seconds = self.elapsed.as_secs_f64();
        let mut text = format!("{:.3e} paths, {:.2e} paths/s", self.paths as f64, self.paths as f64 / seconds);
        if let Some(target) = &self.target {
            let (reached, error) = (&target.reached, 100.0 * target.relative_error());
            let wanted = 100.0 * target.wanted;
            text += &format!(", {} {:.4} ± {error:.3} % of {wanted:.3} %", target.measure, reached.value);
        }
        let fraction = self.fraction();
        if fraction > 0.0 {
            text += &format!(", {:.0} s left", seconds * (1.0 - fraction) / fraction);
        }
        text
    }
}

impl TargetProgress {
    /// Standard error over value; infinite without a value.
    pub fn relative_error(&self) -> f64 {
        if self.reached.value == 0.0 { f64::INFINITY } else { (self.reached.std_error / self.reached.value).abs() }
    }
}

/// Runs a scene file and writes its report.
pub fn run_one(
    scene: &Path,
    settings: &Settings,
    output: &Output,
    interrupt: &Interrupt,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Finished> {
    let job = input::load(scene, settings)?;
    let folder = report::Folder::open(&output_dir(scene, output), output.existing == Existing::Replace)?;
    let (readings, stop, elapsed) = trace(&job, interrupt, watch);
    let measures = measure::measure(&job.scene, &readings);
    let report = Report::new(&job, measures, stop);
    report::write(&report, &job, &folder, elapsed)?;
    Ok(Finished { report, dir: folder.path().to_path_buf(), warnings: job.warnings })
}

/// A run that has written its report.
#[derive(Debug)]
pub struct Finished {
    /// What the report says.
    pub report: Report,
    /// Where it lies.
    pub dir: PathBuf,
    /// Remarks on the scene file.
    pub warnings: Vec<crate::error::Diagnostic>,
}

/// Traces rounds until a stop rule holds.
fn trace(
    job: &Job,
    interrupt: &Interrupt,
    watch: &mut dyn FnMut(&Progress),
) -> (crate::transport::Readings, Stop, Duration) {
    let start = Instant::now();
    let mut run = Run::new(&job.scene, &job.run);
    let stop = loop {
        let round_end = run.round_end();
        let mut early = None;
        while run.waves() < round_end && early.is_none() {
            run.next_wave();
            early = stop_between_waves(&job.run, &run, start.elapsed(), interrupt);
            watch(&progress(&job.run, &run, start.elapsed(), None));
        }
        if let Some(stop) = early {
            break stop;
        }
        if let Some(target) = target_progress(job, &run) {
            let met = target.relative_error() <= target.wanted;
            watch(&progress(&job.run, &run, start.elapsed(), Some(target)));
            if met {
                break Stop::Target;
            }
        }
    };
    (run.readings(), stop, start.elapsed())
}

/// The rules that may end a run after any wave.
fn stop_between_waves(plan: &RunPlan, run: &Run<'_>, elapsed: Duration, interrupt: &Interrupt) -> Option<Stop> {
    if interrupt.is_raised() {
        return Some(Stop::Interrupted);
    }
    if run.is_complete() {
        return Some(Stop::Paths);
    }
    plan.stop.time.is_some_and(|limit| elapsed >= limit).then_some(Stop::Time)
}

fn target_progress(job: &Job, run: &Run<'_>) -> Option<TargetProgress> {
    let target = job.run.stop.target.as_ref()?;
    let reached = measure::value_of(&job.scene, &run.readings(), &target.measure)?;
    Some(TargetProgress { measure: target.measure.clone(), reached, wanted: target.relative_error })
}

fn progress(plan: &RunPlan, run: &Run<'_>, elapsed: Duration, target: Option<TargetProgress>) -> Progress {
    Progress {
        paths: run.paths(),
        planned_paths: run.planned_paths(),
        elapsed,
        time_limit: plan.stop.time,
        target,
    }
}

/// `reports/NAME` after the scene file, unless told otherwise.
fn output_dir(scene: &Path, output: &Output) -> PathBuf {
    output.dir.clone().unwrap_or_else(|| Path::new("reports").join(scene.file_stem().unwrap_or_default()))
}
