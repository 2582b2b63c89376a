//! The record of a study: its facts, a record of every design, and all of it together.

use crate::base64;
use crate::study::Analysis;
use crate::{CheckResult, TargetFacts};
use indexmap::IndexMap;
use lumiduct_core::measure::{CheckOutcome, Measure, Replicates};
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
    /// Name: that of the study file without its extension.
    pub name: String,
    /// Title.
    pub title: String,
    /// Its purpose.
    pub description: Option<String>,
    /// Client and author of the study: the project of its scene, without the logo.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub project: Option<Project>,
    /// The logo of the project, a PNG file, byte for byte.
    #[serde(default, skip_serializing_if = "Option::is_none", with = "base64")]
    pub logo: Option<Vec<u8>>,
    /// Identifies study, scene, referenced files, overrides and numerics.
    pub hash: String,
    /// Name of the scene that is varied.
    pub scene: String,
    /// Overrides common to all designs.
    pub overrides: Vec<String>,
    /// How designs are made from the parameters.
    pub plan: PlanFacts,
    /// Number of designs.
    pub designs: usize,
    /// Number of designs scattered as in production about the best of a search.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub production_designs: Option<usize>,
    /// Seed of the random numbers of light.
    pub seed: u64,
    /// The requested estimator of flux.
    pub estimator: String,
    /// Stop rules of a design, in words.
    pub asked: String,
    /// What is varied.
    pub parameters: Vec<ParameterFacts>,
    /// Dotted names of the measures that are recorded.
    pub measures: Vec<String>,
    /// What the best design is.
    pub ranking: Option<Ranking>,
    /// The measures of a search for a front.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objectives: Vec<Ranking>,
    /// When a search ends early.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_limit: Option<GainLimit>,
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

    /// Most records that there can be.
    pub fn records(&self) -> usize {
        self.designs + self.production_designs.unwrap_or(0)
    }

    /// The parameters that differ between designs.
    pub(crate) fn varied(&self) -> impl Iterator<Item = &ParameterFacts> {
        self.parameters.iter().filter(|own| own.domain != Domain::AsInScene)
    }

    /// Whether both belong to the same study, so that their designs can be merged.
    pub fn is_same_study(&self, other: &Self) -> bool {
        (&self.name, &self.hash, self.designs) == (&other.name, &other.hash, other.designs)
    }
}

/// When a search ends before it has all its designs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GainLimit {
    /// When its latest designs gain no more than this, in the unit of the measure that decides.
    pub least: f64,
    /// All its designs.
    pub designs: usize,
}

/// How designs are made from the parameters.
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
    /// Designs that a search proposes one after the other; its seed.
    Search(u64),
}

impl PlanFacts {
    /// Whether designs follow from the results of those before.
    pub fn is_search(self) -> bool {
        match self {
            Self::Search(_) => true,
            Self::Grid
            | Self::OneAtATime
            | Self::List
            | Self::LatinHypercube(_)
            | Self::Sobol(_)
            | Self::Tolerance(_) => false,
        }
    }
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
    /// Its domain.
    pub domain: Domain,
    /// Its value in the scene.
    pub nominal: Setting,
    /// The value behind each name of a choice, as TOML.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub choices: IndexMap<String, String>,
}

impl ParameterFacts {
    /// Its setting in a design; its value in the scene where that is known.
    pub fn setting_in<'a>(&'a self, design: &'a DesignRecord) -> &'a Setting {
        match design.settings.get(&self.name) {
            Some(own @ (Setting::Number(_) | Setting::Choice(_))) => own,
            Some(Setting::AsInScene) | None => &self.nominal,
        }
    }

    /// Name and unit, as for an axis: "length in mm".
    pub(crate) fn label(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} in {unit}", self.name),
            None => self.name.clone(),
        }
    }

    /// Name and unit, as for a column: "`length_mm`"; the name alone if it has this ending.
    pub fn column(&self) -> String {
        column(&self.name, self.unit.as_deref())
    }
}

/// The record of one design.
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
    /// The settings of the parameters, by name.
    pub settings: IndexMap<String, Setting>,
    /// Its outcome.
    pub outcome: DesignOutcome,
}

/// The outcome of a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DesignOutcome {
    /// It was traced.
    Done(Box<DesignResult>),
    /// It makes no scene that can be traced, and why.
    Failed(String),
}

/// The result of tracing a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignResult {
    /// Identifies the design's scene with everything in it.
    pub scene_hash: String,
    /// The recorded measures by their dotted names.
    pub measures: IndexMap<String, Measure>,
    /// Their values by group of batches, where known.
    pub replicates: IndexMap<String, Replicates>,
    /// The checks and their verdicts.
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

impl DesignOutcome {
    /// The result of tracing; `None` for a design that makes no scene.
    pub fn result(&self) -> Option<&DesignResult> {
        match self {
            Self::Done(result) => Some(result),
            Self::Failed(_) => None,
        }
    }

    /// The worst outcome of its checks: failed before undecided before passed; `None` without checks or a result.
    pub fn verdict(&self) -> Option<CheckOutcome> {
        self.result()?.checks.iter().map(|check| check.verdict.outcome).max()
    }
}

impl DesignRecord {
    /// A recorded measure, if the design was traced.
    pub fn measure(&self, name: &str) -> Option<&Measure> {
        self.outcome.result()?.measures.get(name)
    }

    /// Whether it was traced and passes every check.
    pub fn passes(&self) -> bool {
        let outcome = &self.outcome;
        outcome.result().is_some()
            && outcome.verdict().is_none_or(|own| own == CheckOutcome::Passed)
    }
}

/// The best design of a search, or one of a front, traced again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Confirmation {
    /// The number of a design of a front.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub design: Option<usize>,
    /// Seed of the random numbers of light.
    pub seed: u64,
    /// The requested estimator of flux.
    pub estimator: String,
    /// What was found.
    pub outcome: DesignOutcome,
}

impl Confirmation {
    /// Whether a check fails.
    pub(crate) fn refutes(&self) -> bool {
        self.outcome.verdict().is_some_and(CheckOutcome::is_failure)
    }
}

/// Everything in the files of a study.
#[derive(Debug, Clone)]
pub struct StudyReport {
    /// Its facts.
    pub facts: StudyFacts,
    /// All designs in the order of their numbers.
    pub designs: Vec<DesignRecord>,
    /// Their joint analysis.
    pub analysis: Analysis,
    /// What a search has found, traced again.
    pub confirmations: Vec<Confirmation>,
    /// That best design as production scatters it, as a study of its own.
    pub production: Option<Box<StudyReport>>,
}

impl StudyReport {
    /// The measure that decides and its best end: from the ranking, or the highest value of the
    /// first measure.
    pub(crate) fn leading(&self) -> (&str, Best) {
        match &self.facts.ranking {
            Some(ranking) => (&ranking.measure, ranking.best),
            None => (self.facts.measures.first().map_or("", String::as_str), Best::Highest),
        }
    }

    /// The best design of a search, if any passes every check.
    pub fn best_passing(&self) -> Option<&DesignRecord> {
        if !self.facts.plan.is_search() {
            return None;
        }
        let best = self.design(self.analysis.ranked.first()?.design)?;
        best.passes().then_some(best)
    }

    /// What a search has found: the best design that passes every check, or those of the front.
    pub fn found(&self) -> impl Iterator<Item = &DesignRecord> {
        self.best_passing().into_iter().chain(self.front())
    }

    /// The design of a number.
    pub(crate) fn design(&self, number: usize) -> Option<&DesignRecord> {
        self.designs.iter().find(|design| design.design == number)
    }

    /// Whether every design is as requested or, of a search, one is found and not refuted.
    pub fn is_good(&self) -> bool {
        if self.facts.plan.is_search() {
            self.found().next().is_some() && !self.confirmations.iter().any(Confirmation::refutes)
        } else {
            self.counts().is_clean()
        }
    }

    /// Unit of a measure, as the designs have it; `1` where none was traced.
    pub(crate) fn unit(&self, measure: &str) -> &str {
        let found = self.designs.iter().find_map(|design| design.measure(measure));
        found.map_or("1", |measure| &measure.unit)
    }

    /// Designs that make no scene, fail a check, and are undecided.
    pub fn counts(&self) -> StudyCounts {
        let count = |is_counted: fn(&DesignOutcome) -> bool| {
            self.designs.iter().filter(|design| is_counted(&design.outcome)).count()
        };
        StudyCounts {
            broken: count(|own| own.result().is_none()),
            failed: count(|own| own.verdict().is_some_and(CheckOutcome::is_failure)),
            undecided: count(|own| own.verdict() == Some(CheckOutcome::Undecided)),
            off_target: self.designs.iter().filter(|design| is_off_target(design)).count(),
        }
    }
}

fn is_off_target(design: &DesignRecord) -> bool {
    let target = design.outcome.result().and_then(|result| result.target.as_ref());
    target.is_some_and(|target| !target.is_reached())
}

/// How many designs are not as requested.
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
    /// Whether every design is as requested.
    fn is_clean(self) -> bool {
        let Self { broken, failed, undecided, off_target } = self;
        broken + failed + undecided + off_target == 0
    }
}
