//! From a scene file to a job: read, lowered, with the command-line settings applied.

use crate::export::Exports;
use crate::gather::{check_radius, check_use};
use crate::keys::{Key, Places};
use crate::lower::Lowered;
use crate::lower::context::Scope;
use crate::problems::Problems;
use crate::project::{Project, project};
use crate::texts::SourceText;
use crate::{Draft, draft};
use lumiduct_base::digest::Digest;
use lumiduct_base::error::{Diagnostic, Error, Result};
use lumiduct_base::text::visible;
use lumiduct_core::plan::{Check, GatherPlan, Request, RunPlan, StopRules, Target};
use lumiduct_core::scene::Scene;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Duration;

/// Command-line settings in addition to the scene file.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Settings {
    /// `key=value` for keys of the scene.
    pub overrides: Vec<String>,
    /// Estimator of flux.
    pub estimator: Option<Request>,
    /// Gather settings.
    pub gather: GatherPlan,
    /// Relative error of the target measure.
    pub target: Option<f64>,
    /// The target measure; by default that of the file.
    pub target_measure: Option<String>,
    /// Number of paths.
    pub paths: Option<u64>,
    /// Time of the run.
    pub time: Option<Duration>,
    /// Seed of the random numbers.
    pub seed: Option<u64>,
    /// Photon paths of a batch, so that batches of several scenes contain the same paths.
    pub batch_paths: Option<u64>,
}

impl Settings {
    /// The same with further overrides, which take precedence.
    pub fn with(&self, further: impl IntoIterator<Item = String>) -> Self {
        let overrides = self.overrides.iter().cloned().chain(further).collect();
        Self { overrides, ..self.clone() }
    }
}

/// A scene to run.
#[derive(Debug)]
pub struct Job {
    /// Name: that of the file without its extension.
    pub name: String,
    /// Title for reports.
    pub title: String,
    /// The purpose of the scene.
    pub description: Option<String>,
    /// The project of the report.
    pub project: Option<Project>,
    /// The scene to trace.
    pub scene: Scene,
    /// How to trace it, and when to stop.
    pub run: RunPlan,
    /// The checks.
    pub checks: Vec<Check>,
    /// Luminaire files that goniometers are to write.
    pub exports: Exports,
    /// The scene file, byte for byte.
    pub text: String,
    /// The places of its keys in the files.
    pub places: Places,
    /// Overrides of the command line, as given.
    pub overrides: Vec<String>,
    /// All command-line settings.
    pub settings: Settings,
    /// Identifies scene file, included files, meshes and overrides: 64-bit FNV-1a, in hexadecimal.
    pub hash: String,
    /// The same without the overrides: it changes only where a file does.
    pub files_hash: String,
    /// Remarks on the scene.
    pub warnings: Vec<Diagnostic>,
}

/// Loads a scene file and everything it refers to.
///
/// # Errors
///
/// [`Error::Input`] with all problems of the scene file and of the files that it refers to. [`Error::Usage`] if the
/// settings have a target but the scene no sensor, or if the file divides a number of paths that the run does not
/// have.
pub fn load(path: &Path, settings: &Settings) -> Result<Job> {
    let mut draft = draft(path, &settings.overrides)?;
    let mut lowered = draft.lower(Scope::Scene);
    let Draft { spec, places, text, mut problems, .. } = draft;
    if let Some(Lowered { scene, run, .. }) = &mut lowered {
        apply_method(settings, scene, run, &mut problems);
    }
    let project = project(&spec, &places, &mut problems);
    let warnings = problems.finish(&places)?;
    // If there is no error there is a scene.
    let Some(Lowered { scene, mut run, checks, meshes, exports }) = lowered else {
        return Err(Error::Input(warnings));
    };
    let logo = project.as_ref().and_then(|project| project.logo.as_ref());
    let digest = |is_counted: fn(&SourceText) -> bool| {
        let mut hash = Digest::default();
        let sources = places.sources().iter().filter(|source| is_counted(source));
        sources.for_each(|source| hash.add(source.text().as_bytes()));
        hash.add(meshes.to_string().as_bytes());
        logo.into_iter().for_each(|png| hash.add(png));
        hash.to_string()
    };
    let (hash, files_hash) = (digest(|_| true), digest(SourceText::is_file));
    apply(settings, &scene, &mut run)?;
    Ok(Job {
        name: visible(&path.file_stem().unwrap_or_default().to_string_lossy()),
        title: spec.title,
        description: spec.description,
        project,
        scene,
        run,
        checks,
        exports,
        text,
        places,
        overrides: settings.overrides.clone(),
        settings: settings.clone(),
        hash,
        files_hash,
        warnings,
    })
}

/// The estimator and gather settings of the command line override those of the file.
fn apply_method(settings: &Settings, scene: &Scene, run: &mut RunPlan, problems: &mut Problems) {
    run.estimator = settings.estimator.unwrap_or(run.estimator);
    check_estimators(run, scene, problems);
    let mut requests = (0..scene.sensors.len()).map(|sensor| run.request(sensor));
    let may_gather = run.estimator.may_gather() || requests.any(Request::may_gather);
    if !may_gather {
        check_use(run.estimator, &run.gather, &settings.gather, problems);
    }
    run.gather = settings.gather.or(&run.gather);
    if may_gather {
        check_radius(&run.gather, &settings.gather, scene, problems);
    }
}

/// Refuses merged sensors together with others that may be gathered alone: photons pass one set of
/// records.
fn check_estimators(run: &RunPlan, scene: &Scene, problems: &mut Problems) {
    let request = |sensor: usize| run.request(sensor);
    let is_alone =
        |sensor: &usize| request(*sensor).may_gather() && request(*sensor) != Request::Mis;
    let Some(alone) = (0..scene.sensors.len()).find(is_alone) else { return };
    for (index, sensor) in scene.sensors.iter().enumerate() {
        if request(index) != Request::Mis {
            continue;
        }
        let (other, wish) = (&scene.sensors[alone].name, request(alone).name());
        let message =
            format!("`mis` here cannot be combined with `{wish}` for the sensor `{other}`");
        problems.error(&Key::of(&["sensors", &sensor.name, "estimator"]), message).hint(
            "use `mis` for every sensor, or one of `forward`, `backward` and `mix` for the others",
        );
    }
}

/// The stop rules of the command line replace those of the file, all together.
fn apply(settings: &Settings, scene: &Scene, run: &mut RunPlan) -> Result<()> {
    if let Some(seed) = settings.seed {
        run.seed = seed;
    }
    run.batch_paths = settings.batch_paths;
    if settings.paths.is_none() && settings.time.is_none() && settings.target.is_none() {
        return check_batches(&run.stop);
    }
    let of_file = run.stop.target.as_ref().map(|target| target.measure.clone());
    let measure = settings.target_measure.clone().or(of_file);
    let measure =
        measure.or_else(|| scene.sensors.first().map(|sensor| format!("{}.flux", sensor.name)));
    let target = match (settings.target, measure) {
        (Some(relative_error), Some(measure)) => Some(Target { measure, relative_error }),
        (Some(_), None) => {
            return Err(Error::Usage("--target needs a sensor, and the scene has none".into()));
        }
        (None, _) => None,
    };
    let (paths, time) = (settings.paths, settings.time);
    // The batches of the file divide the paths of the command line as they do those of the file.
    run.stop = StopRules { paths, time, target, ..run.stop };
    check_batches(&run.stop)
}

/// Refuses batches without paths, and what belongs to batches without them.
fn check_batches(stop: &StopRules) -> Result<()> {
    let refuse = |why: &str| Err(Error::Usage(why.to_owned()));
    match stop {
        StopRules { paths: None, batches: Some(_), .. } => refuse(
            "`run.batches` divides a number of paths, which this run does not have: give --paths, or remove the key",
        ),
        StopRules { batches: None, planned_paths: Some(_), .. } => refuse(
            "`run.planned_paths` is for runs that are repeated with `run.batches`: give it, or remove the key",
        ),
        _ => Ok(()),
    }
}
