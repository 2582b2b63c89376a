//! Progress of a run.

use lumiduct_core::measure::{self, Measure};
use lumiduct_core::plan::RunPlan;
use lumiduct_core::scene::{Scene, SensorId};
use lumiduct_core::transport::{Findings, GatherSettings, Phase, Run};
use lumiduct_input::Job;
use std::time::Duration;

/// Progress of a run, for displays.
#[derive(Debug, Clone)]
pub struct Progress {
    /// What the run is doing.
    pub phase: Phase,
    /// Paths traced.
    pub paths: u64,
    /// Paths requested, where that is a stop rule.
    pub planned_paths: Option<u64>,
    /// Time since the start of tracing.
    pub elapsed: Duration,
    /// Time requested, where that is a stop rule.
    pub time_limit: Option<Duration>,
    /// Gather settings in words, once at the start; else empty.
    pub gathering: String,
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

impl TargetProgress {
    /// How well the target of a job is known; `None` without one.
    pub(super) fn of(job: &Job, run: &Run<'_>) -> Option<Self> {
        let target = job.run.stop.target.as_ref()?;
        let reached = measure::value_of(&job.scene, &run.findings(), &target.measure)?;
        Some(Self { measure: target.measure.clone(), reached, wanted: target.relative_error })
    }
}

impl Progress {
    /// Progress after `elapsed`; `target` is that at the end of the last round.
    pub(super) fn of(
        plan: &RunPlan,
        run: &Run<'_>,
        elapsed: Duration,
        target: Option<TargetProgress>,
    ) -> Self {
        Self {
            phase: run.phase(),
            paths: run.paths(),
            planned_paths: run.planned_paths(),
            elapsed,
            time_limit: plan.stop.time,
            gathering: String::new(),
            target,
        }
    }

    /// A run that has not begun, after `elapsed`.
    pub(super) fn before(plan: &RunPlan, phase: Phase, elapsed: Duration) -> Self {
        Self {
            phase,
            paths: 0,
            planned_paths: None,
            elapsed,
            time_limit: plan.stop.time,
            gathering: String::new(),
            target: None,
        }
    }

    /// How much of the work is done, by the rule that is nearest to its end; 0..=1.
    pub fn fraction(&self) -> f64 {
        let paths = self.planned_paths.map_or(0.0, |planned| self.paths as f64 / planned as f64);
        let time =
            self.time_limit.map_or(0.0, |limit| self.elapsed.as_secs_f64() / limit.as_secs_f64());
        // The error falls as one over the square root of the paths.
        let target = self
            .target
            .as_ref()
            .map_or(0.0, |target| (target.wanted / target.reached.relative_error()).powi(2));
        paths.max(time).max(target).min(1.0)
    }

    /// The phase, paths per second, the target's value and error, and the time left.
    pub fn sentence(&self) -> String {
        let seconds = self.elapsed.as_secs_f64();
        let mut text = format!("{}: ", self.phase);
        match self.phase {
            Phase::Pilot(_) => {
                text += &format!("{seconds:.1} s");
                return text;
            }
            Phase::Batches(_) | Phase::Pass { .. } => {
                let paths = self.paths as f64;
                text += &format!("{paths:.3e} paths, {:.2e} paths/s", paths / seconds);
            }
        }
        if let Some(target) = &self.target {
            let (reached, error) = (&target.reached, 100.0 * target.reached.relative_error());
            let wanted = 100.0 * target.wanted;
            text += &format!(
                ", {} {:.4} ± {error:.3} % of {wanted:.3} %",
                target.measure, reached.value
            );
        }
        let fraction = self.fraction();
        if fraction > 0.0 {
            text += &format!(", {:.0} s left", seconds * (1.0 - fraction) / fraction);
        }
        text
    }
}

/// Settings of gathering in words, for each group of sensors; empty where nothing is gathered.
pub(super) fn gathering(scene: &Scene, findings: &Findings) -> String {
    let groups: Vec<_> = findings.gathering().collect();
    match &groups[..] {
        [(_, settings)] => settings.to_string(),
        all => {
            let of_group = |(sensors, settings): &(&[SensorId], &GatherSettings)| {
                let names = sensors.iter().map(|id| scene.sensors[id.index()].name.as_str());
                format!("{}: {settings}", names.collect::<Vec<_>>().join(", "))
            };
            all.iter().map(of_group).collect::<Vec<_>>().join("; ")
        }
    }
}
