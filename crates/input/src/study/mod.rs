//! From a study file to a study: what is varied in which scene, and what every design must meet.
//!
//! This module does not expand the plan into designs, and computes nothing.

mod cost;
mod file;
mod list;
mod optimisation;
mod parameters;
mod rules;
mod search_rules;

pub use cost::Cost;
pub use optimisation::feedback::{LawKind, LightTarget, PatternFeedback};
pub use optimisation::{Optimisation, OptimisationKind, load_optimisation};
pub use parameters::{DESIGN_COLUMN, Domain, OTHER_COLUMNS, Parameter, Setting, Tie, column};
pub use search_rules::LATEST_PER_RANGE;

use crate::keys::{Key, Places};
use crate::lower::plan;
use crate::problems::Problems;
use crate::spec::solid::{ShapedSolidSpec, SolidSpec};
use crate::spec::study::{Keep, PlanSpec, Ranking, Samples, SearchPlan, StudyRunSpec, StudySpec};
use crate::study::file::{StudyDraft, read};
use crate::texts::argument_label;
use crate::{Draft, Job, Settings, draft, load};
use indexmap::IndexMap;
use lumiduct_base::digest::Digest;
use lumiduct_base::error::{Diagnostic, DiagnosticKind, Error, Result};
use lumiduct_base::text::visible;
use lumiduct_core::plan::{Check, NUMERICS};
use serde::Serialize;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Simulated parts around the best design of a search, where no number is given.
const PRODUCTION_SAMPLES: u32 = 100;

/// Command-line settings in addition to the study file. The field names are part of the identity of
/// a study.
#[derive(Debug, Clone, Default, Serialize)]
pub struct StudySettings {
    /// `key=value` for keys of the scene, set for all designs after those of the study.
    #[serde(rename = "overrides")]
    pub overrides: Vec<String>,
    /// Relative error of the target measure of a design.
    #[serde(rename = "target")]
    pub target: Option<f64>,
    /// Number of paths of a design.
    #[serde(rename = "paths")]
    pub paths: Option<u64>,
    /// Seed of the random numbers of light.
    #[serde(rename = "seed")]
    pub seed: Option<u64>,
}

/// How designs are made from the parameters.
#[derive(Debug, Clone, PartialEq)]
pub enum Plan {
    /// Every combination of all levels.
    Grid,
    /// The scene as it is, then every level of every parameter with the others as in the scene.
    OneAtATime,
    /// These, a setting for each parameter.
    List(Vec<Vec<Setting>>),
    /// Samples that fill the range of each parameter evenly.
    LatinHypercube(Samples),
    /// Samples that fill all ranges together evenly.
    Sobol(Samples),
    /// Independent random samples.
    Tolerance(Samples),
    /// Designs that a search proposes one after the other.
    Search(SearchPlan),
}

impl Plan {
    /// The search, if it is one.
    pub fn search(&self) -> Option<&SearchPlan> {
        match self {
            Self::Search(plan) => Some(plan),
            Self::Grid
            | Self::OneAtATime
            | Self::List(_)
            | Self::LatinHypercube(_)
            | Self::Sobol(_)
            | Self::Tolerance(_) => None,
        }
    }
}

/// A study to run.
#[derive(Debug)]
pub struct Study {
    /// Name: that of the file without its extension.
    pub name: String,
    /// Title for reports.
    pub title: String,
    /// The purpose of the study.
    pub description: Option<String>,
    /// The scene that is varied, without any parameter set.
    pub base: Job,
    /// Its file.
    pub scene: PathBuf,
    /// Settings common to all designs; overrides of a design come after these.
    pub common: Settings,
    /// What is varied.
    pub parameters: Vec<Parameter>,
    /// How designs are made from the parameters.
    pub plan: Plan,
    /// How the best design of a search is scattered as in production, if any parameter has a tolerance.
    pub production: Option<Samples>,
    /// Dotted names of the measures that are recorded.
    pub measures: Vec<String>,
    /// What the best design is.
    pub ranking: Option<Ranking>,
    /// What designs cost, if that decides.
    pub cost: Option<Cost>,
    /// What every design has to meet.
    pub checks: Vec<Check>,
    /// What is kept of each design.
    pub keep: Keep,
    /// The places of the keys in the study file.
    pub places: Places,
    /// The study file, byte for byte.
    pub text: String,
    /// Identifies study, scene, files referenced by them and by all choices, and overrides: 64-bit
    /// FNV-1a, in hexadecimal.
    pub hash: String,
    /// Remarks on study and scene.
    pub warnings: Vec<Diagnostic>,
}

impl Study {
    /// The objectives of a front; none for any other study.
    pub fn objectives(&self) -> &[Ranking] {
        self.plan.search().map_or(&[], |plan| &plan.objectives)
    }

    /// Whether its result is a front.
    pub fn is_front(&self) -> bool {
        !self.objectives().is_empty()
    }
}

/// Loads a study file, its scene and everything they refer to.
///
/// # Errors
///
/// [`Error::Input`] with all problems of the study, or of its scene and the files that they refer to;
/// [`Error::Usage`] as [`load`].
pub fn load_study(path: &Path, settings: &StudySettings) -> Result<Study> {
    let StudyDraft { spec, places, table, mut problems } = read(path)?;
    let scene = path.parent().unwrap_or(Path::new("")).join(&spec.scene);
    let common = common_settings(&spec, settings, &mut problems);
    rules::check(&spec, &places, &settings.overrides, &mut problems);
    plan::checks(&spec.check, &mut problems);
    if !scene.is_file() {
        let message = format!("there is no file {}", scene.display());
        problems.error(&Key::of(&["scene"]), message);
    }
    if !problems.is_free_of_errors() {
        return Err(Error::Input(problems.into_diagnostics(&places)));
    }
    let base = load(&scene, &common).map_err(|error| of_set(error, &spec.set, &places))?;
    let parameters = parameters::lower(&spec, &base, &mut problems);
    rules::check_levels(&parameters, &places, &mut problems);
    search_rules::check_centers(&parameters, &mut problems);
    rules::check_keys(&parameters, &scene, &common, &mut problems);
    rules::check_clock(&base, &mut problems);
    let rows = table.map(|table| list::rows(&places, table, &parameters, &mut problems));
    let plan = lower_plan(&spec.plan, rows.unwrap_or_default());
    let mut hash = Digest::default();
    places.sources().iter().for_each(|source| hash.add(source.text().as_bytes()));
    hash.add(base.hash.as_bytes());
    if problems.is_free_of_errors() {
        add_choices(&parameters, (&scene, &common), &mut hash, &mut problems);
    }
    let warnings = problems.finish(&places)?;
    let identity = serde_json::to_string(&(NUMERICS, &base.run, settings));
    hash.add(identity.expect("numbers and texts always have a form in JSON").as_bytes());
    let warnings = warnings.into_iter().chain(base.warnings.iter().cloned()).collect();
    let cost = plan.search().and_then(|own| Cost::new(&own.cost, &parameters));
    let is_single = plan.search().is_none_or(|own| own.objectives.is_empty());
    let of_cost = cost.as_ref().filter(|_| is_single).map(|_| Cost::ranking());
    let ranking = of_cost.or(spec.ranking);
    let is_scattered = parameters.iter().any(|own| own.tolerance.is_some());
    let production = plan.search().filter(|_| is_scattered);
    let production = production
        .map(|own| Samples { count: own.samples.unwrap_or(PRODUCTION_SAMPLES), seed: own.seed });
    Ok(Study {
        name: visible(&path.file_stem().unwrap_or_default().to_string_lossy()),
        title: spec.title,
        description: spec.description,
        base,
        scene,
        common,
        parameters,
        plan,
        production,
        measures: spec.measures,
        ranking,
        cost,
        checks: spec.check.clone(),
        keep: spec.keep,
        text: places.root_text().to_owned(),
        places,
        hash: hash.to_string(),
        warnings,
    })
}

/// Adds the scene of every choice: a choice may refer to a file that the scene alone does not. Notes those that make no scene.
fn add_choices(
    parameters: &[Parameter],
    (scene, common): (&Path, &Settings),
    hash: &mut Digest,
    problems: &mut Problems,
) {
    for parameter in parameters {
        for name in parameter.choices.keys() {
            let own = parameter.overrides(&Setting::Choice(name.clone()));
            let settings = common.with(own);
            match load(scene, &settings) {
                Ok(job) => hash.add(job.hash.as_bytes()),
                Err(error) => {
                    // With other parameters it may become valid, so its files count all the same.
                    add_files(scene, &settings, hash);
                    let key = Key::of(&["parameters", &parameter.name, "choices", name]);
                    warn_of_choice(&key, error, problems);
                }
            }
        }
    }
}

/// Notes why a choice makes no scene, where all else is as in the scene.
fn warn_of_choice(key: &Key, error: Error, problems: &mut Problems) {
    let Error::Input(found) = error else { return };
    let is_error = |own: &Diagnostic| own.kind == DiagnosticKind::Error;
    let Some(Diagnostic { key: at, message, hint, .. }) = found.into_iter().find(is_error) else {
        return;
    };
    let message = format!("makes no valid scene, with all else as in the scene: {at}: {message}");
    let warning = problems.warning(key, message);
    if let Some(hint) = hint {
        warning.hint(hint);
    }
}

/// Adds the files that a scene refers to, as far as it can be read.
fn add_files(scene: &Path, settings: &Settings, hash: &mut Digest) {
    let Ok(Draft { spec, places, .. }) = draft(scene, &settings.overrides) else { return };
    places.sources().iter().for_each(|source| hash.add(source.text().as_bytes()));
    let folder = scene.parent().unwrap_or(Path::new(""));
    for solid in spec.solids.values() {
        if let SolidSpec::Mesh(ShapedSolidSpec { shape, .. }) = solid {
            hash.add(&fs::read(folder.join(&shape.file)).unwrap_or_default());
        }
    }
}

/// The problems of the scene of a study; those from its `set` are reported at their place there.
fn of_set(error: Error, set: &IndexMap<String, Value>, places: &Places) -> Error {
    let Error::Input(found) = error else { return error };
    let (mut own, mut rest) = (Problems::default(), Vec::new());
    for diagnostic in found {
        let set = set.iter().find(|(key, value)| {
            let line = parameters::toml_text(value).map(|text| format!("{key}={text}"));
            line.is_some_and(|line| {
                diagnostic.file.as_deref() == Some(Path::new(&argument_label(&line)))
            })
        });
        match set {
            Some((key, _)) => {
                let problem = own.error(&Key::of(&["set", key]), diagnostic.message);
                if let Some(hint) = diagnostic.hint {
                    problem.hint(hint);
                }
            }
            None => rest.push(diagnostic),
        }
    }
    let own = own.into_diagnostics(places);
    Error::Input(own.into_iter().chain(rest).collect())
}

/// Settings common to all designs: keys and stop rules of the study, overridden by those of the
/// command line.
fn common_settings(
    spec: &StudySpec,
    settings: &StudySettings,
    problems: &mut Problems,
) -> Settings {
    let StudyRunSpec { paths, target, seed, estimator } = &spec.run;
    let (from_command, from_study) = (
        (settings.paths, settings.target),
        (*paths, target.as_ref().map(|target| target.relative_error)),
    );
    let is_asked = settings.paths.is_some() || settings.target.is_some();
    let (paths, error) = if is_asked { from_command } else { from_study };
    let measure = target.as_ref().map(|target| target.measure.clone());
    let overrides = overrides_of(&spec.set, settings, problems);
    Settings {
        overrides,
        estimator: *estimator,
        target: error,
        target_measure: measure,
        paths,
        seed: settings.seed.or(*seed),
        ..Settings::default()
    }
}

/// Keys of the scene that a study sets, then those of the command line.
fn overrides_of(
    set: &IndexMap<String, Value>,
    settings: &StudySettings,
    problems: &mut Problems,
) -> Vec<String> {
    let mut overrides = Vec::new();
    for (key, value) in set {
        match parameters::toml_text(value) {
            Some(text) => overrides.push(format!("{key}={text}")),
            None => {
                let message = "cannot be a value of a scene";
                problems.error(&Key::of(&["set", key]), message);
            }
        }
    }
    overrides.extend(settings.overrides.iter().cloned());
    overrides
}

/// The plan; `rows` are those of its table, if it has one.
fn lower_plan(spec: &PlanSpec, rows: Vec<Vec<Setting>>) -> Plan {
    match spec {
        PlanSpec::Grid => Plan::Grid,
        PlanSpec::OneAtATime => Plan::OneAtATime,
        PlanSpec::LatinHypercube(own) => Plan::LatinHypercube(own.clone()),
        PlanSpec::Sobol(own) => Plan::Sobol(own.clone()),
        PlanSpec::Tolerance(own) => Plan::Tolerance(own.clone()),
        PlanSpec::Search(own) => Plan::Search(own.clone()),
        PlanSpec::List(_) => Plan::List(rows),
    }
}
