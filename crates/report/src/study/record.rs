//! What is known of a study: its facts, a record of every design, and what follows from all of them together.

use crate::base64;
use crate::{CheckResult, TargetFacts};
use indexmap::IndexMap;
use lumiduct_core::measure::{Measure, Outcome, Replicates};
use lumiduct_core::plan::Check;
use lumiduct_input::{Best, Domain, Keep, Project, Ranking, Setting, column};
use serde::{Deserialize, Serialize};

/// Format of the manifest of a study.
pub const FACTS_FORMAT: u32 = 2;
/// Format of the record of a design.
pub const DESIGN_FORMAT: u32 = 2;

/// What a study is, without its results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyFacts {
    /// Format of these facts, [`FACTS_FORMAT`].
    pub lumiduct_batch: u32,
    /// Version of the program.
    pub version: String,
    /// Name: that of the study file without its ending.
    pub name: String,
    /// Title.
    pub title: String,
    /// What it is for.
    pub description: Option<String>,
    /// Whom the study is for, and by whom: the project of its scene, without the logo.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub project: Option<Project>,
    /// The logo of the project, a PNG file, byte for byte.
    #[serde(default, skip_serializing_if = "Option::is_none", with = "base64")]
    pub logo: Option<Vec<u8>>,
    /// Identifies study, scene, files that they name, overrides and numerics.
    pub hash: String,
    /// Name of the scene that is varied.
    pub scene: String,
    /// Overrides that all designs have in common.
    pub overrides: Vec<String>,
    /// Which designs are made of the parameters.
    pub plan: PlanFacts,
    /// Number of designs.
    pub designs: usize,
    /// Seed of the random numbers of light.
    pub seed: u64,
    /// How flux was to be estimated.
    pub estimator: String,
    /// Stop rules of a design, in words.
    pub asked: String,
    /// What is varied.
    pub parameters: Vec<ParameterFacts>,
    /// Dotted names of the measures that are recorded.
    pub measures: Vec<String>,
    /// What the best design is.
    pub ranking: Option<Ranking>,
    /// What every design has to meet.
    pub checks: Vec<Check>,
    /// What is kept of each design.
    pub keep: Keep,
}

impl StudyFacts {
    /// The project with its logo.
    pub(crate) fn whole_project(&self) -> Option<Project> {
        let project = self.project.clone()?;
        Some(Project { logo: self.logo.clone(), ..project })
    }

    /// Whether these are of the same study, so that their designs go together.
    pub fn is_same_study(&self, other: &Self) -> bool {
        (&self.name, &self.hash, self.designs) == (&other.name, &other.hash, other.designs)
    }
}

/// Which designs are made of the parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlanFacts {
    /// Every combination of all levels.
    Grid,
    /// The scene as it is, then one parameter after the other.
    OneAtATime,
    /// Those of a table.
    List,
    /// Samples that fill the range of each parameter evenly; their seed.
    LatinHypercube(u64),
    /// Samples that fill all ranges together evenly; their seed.
    Sobol(u64),
    /// Independent random samples; their seed.
    Tolerance(u64),
}

/// A quantity that is varied.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterFacts {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: Option<String>,
    /// The keys that it sets.
    pub keys: Vec<String>,
    /// What it may be set to.
    pub domain: Domain,
    /// What the scene says without it.
    pub nominal: Setting,
}

impl ParameterFacts {
    /// What it is set to in a design; what the scene says, where that is known.
    pub fn setting_in<'a>(&'a self, design: &'a DesignRecord) -> &'a Setting {
        match design.settings.get(&self.name) {
            Some(own @ (Setting::Number(_) | Setting::Choice(_))) => own,
            Some(Setting::AsInScene) | None => &self.nominal,
        }
    }

    /// Name and unit, as for an axis: "length in mm".
    pub fn label(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} in {unit}", self.name),
            None => self.name.clone(),
        }
    }

    /// Name and unit, as for a column: "`length_mm`"; the name alone if it ends so.
    pub fn column(&self) -> String {
        column(&self.name, self.unit.as_deref())
    }
}

/// What is known of one design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignRecord {
    /// Format of the record, [`DESIGN_FORMAT`].
    pub lumiduct_design: u32,
    /// The exact build of the program that traced it.
    pub build: String,
    /// Hash of the study that it is a design of.
    pub study: String,
    /// Its number, from 1.
    pub design: usize,
    /// What the parameters were set to, by their names.
    pub settings: IndexMap<String, Setting>,
    /// What came of it.
    pub outcome: DesignOutcome,
}

/// What came of a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DesignOutcome {
    /// It was traced.
    Done(Box<DesignResult>),
    /// It makes no scene that can be traced, and why.
    Failed(String),
}

/// What tracing a design gave.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignResult {
    /// Identifies the design's scene with everything in it.
    pub scene_hash: String,
    /// The recorded measures by their dotted names.
    pub measures: IndexMap<String, Measure>,
    /// What single groups of batches say of them, where it is known.
    pub replicates: IndexMap<String, Replicates>,
    /// What was demanded, and what came of it.
    pub checks: Vec<CheckResult>,
    /// The target, and whether it was reached.
    pub target: Option<TargetFacts>,
    /// Why it ended.
    pub stopped: String,
    /// Photon and gather paths.
    pub paths: u64,
    /// Remarks on scene and results.
    pub warnings: Vec<String>,
}

impl DesignRecord {
    /// What tracing gave; `None` of a design that makes no scene.
    pub fn result(&self) -> Option<&DesignResult> {
        match &self.outcome {
            DesignOutcome::Done(result) => Some(result),
            DesignOutcome::Failed(_) => None,
        }
    }

    /// A recorded measure, if the design was traced.
    pub fn measure(&self, name: &str) -> Option<&Measure> {
        self.result()?.measures.get(name)
    }

    /// The worst outcome of its checks: failed before undecided before passed; `None` without checks or a result.
    pub fn verdict(&self) -> Option<Outcome> {
        self.result()?.checks.iter().map(|check| check.verdict.outcome).max()
    }
}

/// A value with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
    /// What the error was told from.
    pub evidence: Pairing,
}

/// What the error of a function of several designs was told from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pairing {
    /// Group by group, for the designs have the same random numbers.
    Paired,
    /// From the errors of the single designs, as if they were independent; too large where they err alike.
    Independent,
}

/// What follows from all designs together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// All designs that were traced, the best first; empty without a ranking.
    pub ranked: Vec<Ranked>,
    /// Main effects of the parameters on the measures.
    pub effects: Vec<Effect>,
    /// How much of the variance of a measure comes from each parameter.
    pub sensitivities: Vec<Sensitivity>,
    /// Share of the designs that fail; of tolerance runs alone.
    pub failures: Vec<FailureShare>,
    /// How much sharper differences between designs are than if each had random numbers of its own.
    pub sharpness: Vec<Sharpness>,
}

/// A design's place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranked {
    /// Its number.
    pub design: usize,
    /// How much it is behind the best, in the unit of the measure; nothing for the best itself.
    pub behind: Option<Estimate>,
}

/// The mean of a measure over all designs with the same setting of one parameter, setting by setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Effect {
    /// The parameter.
    pub parameter: String,
    /// The measure.
    pub measure: String,
    /// In the order of the levels.
    pub points: Vec<EffectPoint>,
}

/// The mean of a measure over all designs with one setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectPoint {
    /// The setting.
    pub setting: Setting,
    /// Number of designs behind it.
    pub designs: usize,
    /// The mean, in the unit of the measure.
    pub mean: Estimate,
    /// How much it is above that of the first setting; nothing for the first itself.
    pub from_first: Option<Estimate>,
}

/// How much of the variance of a measure comes from each parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivity {
    /// The measure.
    pub measure: String,
    /// How it was found.
    pub method: SensitivityMethod,
    /// Share of the variance that these tell, 1: the sum of first-order indices, or R² of the regression.
    pub explained: f64,
    /// One for each parameter that can be judged.
    pub indices: Vec<SensitivityIndex>,
}

/// How sensitivities were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensitivityMethod {
    /// First-order Sobol indices of a full grid: variance of the level means over that of all designs.
    FirstOrder,
    /// Coefficients of a linear regression, all quantities over their standard deviations.
    Regression,
}

/// The sensitivity to one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensitivityIndex {
    /// The parameter.
    pub parameter: String,
    /// The index, 1.
    pub value: f64,
    /// Its standard error, 1.
    pub std_error: f64,
}

/// How many designs of a tolerance run meet a demand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FailureShare {
    /// The demand: a measure with its limit, or all of them.
    pub demand: String,
    /// Designs that meet it.
    pub passed: usize,
    /// Designs that do not.
    pub failed: usize,
    /// Designs whose error bar leaves it open.
    pub undecided: usize,
    /// Share that fails if those that are undecided pass, 1.
    pub least: f64,
    /// Share that fails if those that are undecided fail, 1.
    pub most: f64,
    /// 95 % interval of the share of all that are ever made: its low end from `least`, its high end from `most`, 1.
    pub interval: [f64; 2],
}

/// How much sharper differences are than if each design had random numbers of its own.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sharpness {
    /// The measure.
    pub measure: String,
    /// Median over neighbouring designs of the error as if independent over the error that is told, 1.
    pub factor: f64,
    /// Pairs of designs behind it.
    pub pairs: usize,
}

/// Everything that the files of a study say.
#[derive(Debug, Clone)]
pub struct StudyReport {
    /// What it is.
    pub facts: StudyFacts,
    /// All designs in the order of their numbers.
    pub designs: Vec<DesignRecord>,
    /// What follows from them.
    pub analysis: Analysis,
}

impl StudyReport {
    /// The measure that decides and which end of it is the best: the ranking, or the first measure at its highest.
    pub fn leading(&self) -> (&str, Best) {
        match &self.facts.ranking {
            Some(ranking) => (&ranking.measure, ranking.best),
            None => (self.facts.measures.first().map_or("", String::as_str), Best::Highest),
        }
    }

    /// Unit of a measure, as the designs have it; `1` where none was traced.
    pub fn unit(&self, measure: &str) -> &str {
        let found = self.designs.iter().find_map(|design| design.measure(measure));
        found.map_or("1", |measure| &measure.unit)
    }

    /// Designs that make no scene, fail a check, and are undecided.
    pub fn counts(&self) -> StudyCounts {
        let verdicts = || self.designs.iter().map(|design| (design.result(), design.verdict()));
        let count =
            |wanted: Outcome| verdicts().filter(|(_, verdict)| *verdict == Some(wanted)).count();
        StudyCounts {
            broken: verdicts().filter(|(result, _)| result.is_none()).count(),
            failed: count(Outcome::Failed) + count(Outcome::Unknown),
            undecided: count(Outcome::Undecided),
            off_target: self.designs.iter().filter(|design| is_off_target(design)).count(),
        }
    }
}

fn is_off_target(design: &DesignRecord) -> bool {
    let target = design.result().and_then(|result| result.target.as_ref());
    target.is_some_and(|target| !target.is_reached())
}

/// How many designs are not what was wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StudyCounts {
    /// They make no scene.
    pub broken: usize,
    /// They fail a check.
    pub failed: usize,
    /// Their error bar leaves a check open.
    pub undecided: usize,
    /// Their target error was not reached.
    pub off_target: usize,
}

impl StudyCounts {
    /// Whether every design is what was wanted.
    pub fn is_clean(self) -> bool {
        let Self { broken, failed, undecided, off_target } = self;
        broken + failed + undecided + off_target == 0
    }
}
