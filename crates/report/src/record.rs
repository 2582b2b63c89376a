//! The record from which all formats of a report are made.

use crate::{Inventory, MeasuredLuminaire, MeasuredRays, Recipe, SceneDrawing};
use glam::DVec3;
use lumiduct_base::number::{format_exact, format_percent};
use lumiduct_core::measure::{self, Measures, Verdict};
use lumiduct_core::plan::{Check, GatherPlan, Polarisation, Request, Schedule, StopRules, Target};
use lumiduct_core::transport::Leak;
use lumiduct_input::Project;
use serde::{Deserialize, Serialize};

/// Everything a report says.
#[derive(Debug, Clone)]
pub struct Report {
    /// The scene.
    pub scene: SceneFacts,
    /// How it was run.
    pub run: RunFacts,
    /// What was measured.
    pub measures: Measures,
    /// The checks and their verdicts.
    pub checks: Vec<CheckResult>,
    /// Luminaires of goniometers that write files.
    pub luminaires: Vec<MeasuredLuminaire>,
    /// Rays of sensors that write files.
    pub rays: Vec<MeasuredRays>,
    /// Remarks on the scene and on the results.
    pub warnings: Vec<String>,
    /// The drawing of the scene, for pictures only.
    pub drawing: SceneDrawing,
    /// The contents of the scene, for pages only.
    pub inventory: Inventory,
}

/// The scene of a report.
#[derive(Debug, Clone, Serialize)]
pub struct SceneFacts {
    /// Name: that of the file without its extension.
    pub name: String,
    /// Title.
    pub title: String,
    /// Its purpose.
    pub description: Option<String>,
    /// Client and author of the report.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub project: Option<Project>,
    /// Identifies scene file, included files, meshes and overrides.
    pub hash: String,
    /// Overrides of the command line.
    pub overrides: Vec<String>,
}

/// How a scene was run.
#[derive(Debug, Clone, Serialize)]
pub struct RunFacts {
    /// Version of the program.
    pub version: String,
    /// What identifies the run.
    pub identity: Recipe,
    /// Seed of the random numbers.
    pub seed: u64,
    /// The requested estimator of flux.
    pub estimator: Request,
    /// Requested gather settings, in words: see [`requested_gathering`]. Empty without any.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub gather: String,
    /// Gather settings used, in words. Empty where nothing was gathered.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub gathering: String,
    /// Whether the user ended the run.
    pub partial: bool,
    /// The stop rules, in words: see [`asked`].
    pub asked: String,
    /// Why it ended.
    pub stopped: String,
    /// The command that repeats a run which the clock or the user has ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeat: Option<String>,
    /// The target, and whether it was reached.
    pub target: Option<TargetFacts>,
    /// Bounce limit.
    pub bounce_limit: u32,
    /// What becomes of polarisation; left out where it is ignored.
    #[serde(default, skip_serializing_if = "Polarisation::is_ignored")]
    pub polarisation: Polarisation,
    /// Places of leaks in the user's coordinates, mm.
    pub leaks: Vec<DVec3>,
}

/// The target of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TargetFacts {
    /// The measure.
    pub measure: String,
    /// The relative error wanted, 1.
    pub wanted: f64,
    /// The relative error reached, 1; `None` when it is unknown.
    pub reached: Option<f64>,
}

/// A check and its verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckResult {
    /// What was expected.
    pub check: Check,
    /// Its verdict.
    pub verdict: Verdict,
}

/// Whether a run meets what its scene asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunOutcome {
    /// No check was missed.
    Good,
    /// A check was missed, or the run has checks and is partial or misses its target.
    Missed,
}

impl Report {
    /// Whether the run meets what its scene asks for.
    pub fn outcome(&self) -> RunOutcome {
        let missed = self
            .checks
            .iter()
            .any(|result| result.verdict.outcome != measure::CheckOutcome::Passed);
        let off_target = self.run.target.as_ref().is_some_and(|target| !target.is_reached());
        let incomplete = !self.checks.is_empty() && (self.run.partial || off_target);
        if missed || incomplete { RunOutcome::Missed } else { RunOutcome::Good }
    }
}

impl TargetFacts {
    /// The target of a plan, compared with the measured error.
    pub fn new(target: &Target, measures: &Measures) -> Self {
        let reached =
            measure::relative_error(measures, &target.measure).filter(|error| error.is_finite());
        Self { measure: target.measure.clone(), wanted: target.relative_error, reached }
    }

    /// The wanted and the reached error.
    pub(crate) fn sentence(&self) -> String {
        let reached = self.reached.map_or("unknown".into(), format_percent);
        format!(
            "target {}: requested {}, reached {reached}",
            self.measure,
            format_percent(self.wanted)
        )
    }

    /// Whether the error is as small as wanted.
    pub(crate) fn is_reached(&self) -> bool {
        self.reached.is_some_and(|reached| reached <= self.wanted)
    }
}

/// Stop rules in words, with all their digits: "2000000 paths or exit.flux to 0.005".
pub fn asked(stop: &StopRules) -> String {
    let paths = stop.paths.map(|paths| format!("{paths} paths"));
    let time = stop.time.map(|time| format!("{} s", time.as_secs_f64()));
    let target = stop
        .target
        .as_ref()
        .map(|target| format!("{} to {}", target.measure, target.relative_error));
    [paths, time, target].into_iter().flatten().collect::<Vec<_>>().join(" or ")
}

/// Requested gather settings in words: "depth 8, radius 0.5 mm, angle 0.15 deg".
pub fn requested_gathering(gather: &GatherPlan) -> String {
    let all = [
        gather.depth.map(|depth| format!("depth {depth}")),
        gather.radius_mm.map(|radius| format!("radius {radius} mm")),
        gather.angle_deg.map(|angle| format!("angle {} deg", format_exact(angle))),
        gather.records.map(|records| format!("{records} records")),
        gather.photons.map(|photons| format!("{photons} photons")),
        gather
            .schedule
            .filter(|own| *own != Schedule::default())
            .map(|own| format!("schedule {}", own.name())),
    ];
    all.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Places of leaks in the user's coordinates, mm.
pub fn leak_places(leaks: &[Leak], origin: DVec3) -> Vec<DVec3> {
    leaks.iter().map(|leak| leak.point + origin).collect()
}
