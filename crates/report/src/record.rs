//! The one record that all formats of a report are made from.

use crate::by_light::remark_on_weathers;
use crate::{Drawing, Inventory, Recipe};
use glam::DVec3;
use lumiduct_base::number::{format_exact, format_percent, format_with_error};
use lumiduct_core::measure::{self, GatheredFacts, LostPaths, Measures, Status, Verdict};
use lumiduct_core::plan::{Check, GatherPlan, Request, Schedule, StopRules, Target};
use lumiduct_core::scene::{Counts, Place, Scene, Seeing, Sensor, SensorKind};
use lumiduct_core::transport::{GROUPS, GatherSettings, Leak};
use lumiduct_input::Project;
use serde::{Deserialize, Serialize};

/// Everything a report says.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// The scene.
    pub scene: SceneFacts,
    /// How it was run.
    pub run: RunFacts,
    /// What was measured.
    pub measures: Measures,
    /// What was expected, and what came of it.
    pub checks: Vec<CheckResult>,
    /// Remarks on the scene and on the results.
    pub warnings: Vec<String>,
    /// The scene to look at: pictures alone, and no part of the record for programs.
    #[serde(skip)]
    pub drawing: Drawing,
    /// What is in the scene: for pages alone, likewise.
    #[serde(skip)]
    pub inventory: Inventory,
}

/// The scene of a report.
#[derive(Debug, Clone, Serialize)]
pub struct SceneFacts {
    /// Name: that of the file without its ending.
    pub name: String,
    /// Title.
    pub title: String,
    /// What it is for.
    pub description: Option<String>,
    /// Whom the report is for, and by whom.
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
    /// How flux was to be estimated.
    pub estimator: Request,
    /// Wishes for the gather estimator, in words: see [`wishes`]. Empty without any.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub gather: String,
    /// How gathering was set, in words: see [`settled`]. Empty where nothing was gathered.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub gathering: String,
    /// Whether the run ended by itself, or the user ended it.
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
    /// What came of it.
    pub verdict: Verdict,
}

/// Whether a run is what its scene asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// No check was missed.
    Good,
    /// A check was missed, or the run is partial or off its target while there are checks.
    Missed,
}

impl Report {
    /// Whether the run is what its scene asked for.
    pub fn outcome(&self) -> Outcome {
        let missed =
            self.checks.iter().any(|result| result.verdict.outcome != measure::Outcome::Passed);
        let off_target = self.run.target.as_ref().is_some_and(|target| !target.is_reached());
        let incomplete = !self.checks.is_empty() && (self.run.partial || off_target);
        if missed || incomplete { Outcome::Missed } else { Outcome::Good }
    }
}

impl TargetFacts {
    /// The target of a plan, held against what was measured.
    pub fn new(target: &Target, measures: &Measures) -> Self {
        let reached =
            measure::relative_error(measures, &target.measure).filter(|error| error.is_finite());
        Self { measure: target.measure.clone(), wanted: target.relative_error, reached }
    }

    /// What was wanted, and what was reached.
    pub fn sentence(&self) -> String {
        let reached = self.reached.map_or("unknown".into(), format_percent);
        format!(
            "target {}: wanted {}, reached {reached}",
            self.measure,
            format_percent(self.wanted)
        )
    }

    /// Whether the error is as small as wanted.
    pub fn is_reached(&self) -> bool {
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

/// Wishes for the gather estimator in words: "depth 8, radius 0.5 mm, angle 0.15 deg".
pub fn wishes(gather: &GatherPlan) -> String {
    let schedule = match gather.schedule {
        Schedule::Stages => None,
        other @ Schedule::PerPass => Some(format!("schedule {}", other.name())),
    };
    let all = [
        gather.depth.map(|depth| format!("depth {depth}")),
        gather.radius.map(|radius| format!("radius {radius} mm")),
        // Nine digits hide that degrees came by way of radians.
        gather.theta_max.map(|angle| format!("angle {} deg", format_exact(angle.to_degrees()))),
        gather.records.map(|records| format!("{records} records")),
        gather.photons.map(|photons| format!("{photons} photons")),
        schedule,
    ];
    all.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Settings of the gather estimator in words, those that were asked for and those that were chosen.
pub fn settled(settings: &GatherSettings) -> String {
    let GatherSettings { depth, window, gather_paths, photons, schedule, inradius: _ } = settings;
    let schedule = match schedule {
        Schedule::Stages => "in stages",
        Schedule::PerPass => "from pass to pass",
    };
    format!(
        "depth {depth}, windows from {} mm and {} deg shrinking {schedule}, {photons} photons and {gather_paths} gather \
         paths from each sensor in the first passes",
        format_exact(window.radius),
        format_exact(window.theta_max.to_degrees())
    )
}

/// Places of leaks in the user's coordinates, mm.
pub fn leak_places(leaks: &[Leak], origin: DVec3) -> Vec<DVec3> {
    leaks.iter().map(|leak| leak.point + origin).collect()
}

/// Share of the flux cut by the bounce limit that is worth a remark, 1.
const CUT_SHARE: f64 = 1e-3;
/// Errors between a gathered flux and that counted by photons that are worth a remark, 1.
const CONTRADICTED: f64 = 4.0;

/// Remarks that the results ask for.
pub fn remarks(measures: &Measures, scene: &Scene) -> Vec<String> {
    let mut remarks = Vec::new();
    let value = |name: &str| measures.values.get(name).map_or(0.0, |measure| measure.value);
    if value("balance.leaked") > 0.0 {
        remarks.push("light leaked through holes in the geometry: see balance.leaked".to_owned());
    }
    let cut = value("balance.cut") / measures.source_flux;
    if cut > CUT_SHARE {
        remarks.push(format!(
            "{} of the light was still on its way at the bounce limit: see balance.cut; raise run.bounce_limit, or \
             give walls and media their losses",
            format_percent(cut)
        ));
    }
    for paths in &measures.sensor_paths {
        let sensor = &paths.sensor;
        remarks.extend(paths.lost.and_then(|lost| remark_on_lost_paths(sensor, lost)));
        let (flux, other) =
            (value(&format!("{sensor}.flux")), value(&format!("{sensor}.flux_other_side")));
        let outside = value(&format!("{sensor}.flux_outside_aim"));
        if flux == 0.0 && outside == 0.0 && other > 0.0 {
            remarks.push(remark_on_other_side(sensor, scene));
        }
        if outside > flux {
            remarks.push(format!(
                "sensor `{sensor}` counts the light of its aim alone, and more reaches it from elsewhere: see \
                 {sensor}.flux_outside_aim; aim at all that lights it"
            ));
        }
        let own = measures.values.get(&format!("{sensor}.flux"));
        if own.is_some_and(|own| own.status == Status::Contradicted) {
            remarks.push(format!(
                "photons of the same run found more light on sensor `{sensor}` than its gather paths, which hardly ever \
                 meet one of the sources: use `--estimator forward` or `mix`"
            ));
        }
    }
    remarks.extend(remark_on_weathers(measures));
    remarks.extend(measures.gathered.iter().filter_map(remark_on_gathering));
    remarks
}

/// Errors by which more light than was emitted, or than entered, has to be counted for a remark, 1.
const CLEARLY: f64 = 4.0;
/// By how much it has to be more in any case, 1: rounding of sums.
const ROUNDING: f64 = 1e-9;

/// Remarks on sensors that count more light than there is, as it passes them more than once.
pub fn remarks_on_passages(scene: &Scene, measures: &Measures) -> Vec<String> {
    let remark = |sensor: &Sensor| {
        let name = &sensor.name;
        let is_above = |what: &&str| {
            measures.values.get(&format!("{name}.{what}")).is_some_and(|share| {
                share.value > 1.0 + ROUNDING && share.value - 1.0 > CLEARLY * share.total_error()
            })
        };
        let what = ["efficiency", "transmission"].into_iter().find(is_above)?;
        let way_out = match &sensor.kind {
            SensorKind::Surface(surface)
                if matches!(surface.seeing, Seeing::All) && sensor.aim.is_empty() =>
            {
                format!("; to count each path once, write passage = \"first\" in sensors.{name}")
            }
            SensorKind::Surface(_) | SensorKind::Goniometer(_) => String::new(),
        };
        let value = &measures.values[&format!("{name}.{what}")];
        Some(format!(
            "the {what} of sensor `{name}` is {}, above 1: light passes it more than once and counts each time{way_out}",
            format_with_error(value.value, value.std_error)
        ))
    };
    scene.sensors.iter().filter_map(remark).collect()
}

/// A remark on a sensor that counted nothing while light met its other side. Light that leaves a solid inward was reflected or let
/// in there: that is no light from the other side.
fn remark_on_other_side(name: &str, scene: &Scene) -> String {
    let kind = scene.sensors.iter().find(|sensor| sensor.name == name).map(|sensor| &sensor.kind);
    match kind {
        Some(SensorKind::Surface(surface))
            if surface.counts == Counts::Leaving && surface.place == Place::Face =>
        {
            format!(
                "no light left the side of sensor `{name}` that counts: all that met its face was reflected or let in there; \
                 see {name}.flux_other_side"
            )
        }
        Some(SensorKind::Surface(_) | SensorKind::Goniometer(_)) | None => {
            format!("sensor `{name}` was lit on its other side only: turn its axis, or set `side`")
        }
    }
}

/// A remark where more than next to nothing of the gather paths of a sensor was lost.
fn remark_on_lost_paths(sensor: &str, lost: LostPaths) -> Option<String> {
    let LostPaths { cut, leaked } = lost;
    (cut + leaked > CUT_SHARE).then(|| {
        format!(
            "{} of the throughput of gather paths from sensor `{sensor}` was cut by the bounce limit and {} lost through \
             holes in the geometry, and with it their share of the light they would have met; raise run.bounce_limit, or \
             mend the geometry",
            format_percent(cut),
            format_percent(leaked)
        )
    })
}

/// A remark where the photons of a run do not agree with what was gathered from them.
fn remark_on_gathering(facts: &GatheredFacts) -> Option<String> {
    let off = facts.off.filter(|off| off.abs() > CONTRADICTED)?;
    let [flux, error] = facts.by_photons;
    Some(format!(
        "the gathered flux of sensor `{}` is {:.1} errors {} what photons of the same run counted there ({}): a feature \
         of the light is smaller than the windows; take a smaller radius_mm or angle_deg, or another estimator",
        facts.sensor,
        off.abs(),
        if off > 0.0 { "above" } else { "below" },
        format_with_error(flux, error)
    ))
}

/// A remark where a run had to trace noticeably more paths than it was asked for.
pub fn remark_on_paths(asked: Option<u64>, traced: u64) -> Option<String> {
    let asked = asked.filter(|&asked| traced > asked + asked / 10)?;
    Some(format!(
        "{traced} paths were traced where {asked} were asked for: a run ends with a whole wave, of {GROUPS} batches with at \
         least one path of each source, or of passes with all of their photons and gather paths"
    ))
}
