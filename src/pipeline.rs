//! The flow, one call per step: a scene file becomes a report.

mod check;
mod checkpoint;
mod compare;
mod luminaire;
mod output;
mod parts;
mod progress;
mod rays;
mod repeat;
mod sense;
mod snapshot;
mod stop;
#[cfg(test)]
mod stop_tests;
#[cfg(test)]
mod tests;
mod timing;
mod tracing;
mod version;

pub use check::{CheckPage, CheckPictures, Checked, check};
pub use compare::{CompareOptions, Compared, Method, TruthOption, compare};
pub use luminaire::WrittenFile;
pub use output::{Output, RunStart};
pub use parts::{SliceOptions, SliceWritten, has_slice, merge_slices, run_slice};
pub use progress::{Progress, TargetProgress};
pub(crate) use sense::expect_measures;
pub use stop::Stop;
pub use tracing::{Traced, trace};
pub(crate) use version::{BUILD, VERSION};

use crate::pipeline::checkpoint::{CheckpointFile, Pause};
use crate::pipeline::luminaire::{LuminaireFile, luminaires};
use crate::pipeline::output::output_dir;
use crate::pipeline::progress::gathering;
use crate::pipeline::rays::rays;
use crate::pipeline::sense::expect_sense;
use crate::pipeline::tracing::trace_from;
use lumiduct_base::error::{Diagnostic, Result};
use lumiduct_core::measure;
use lumiduct_core::plan::Request;
use lumiduct_core::transport::{Activity, Findings, Interrupt, Track, tracks};
use lumiduct_input::{self as input, Job, Outline, Settings};
use lumiduct_report::{
    self as report, CheckResult, Existing, Folder, FolderLock, Inventory, Recipe, Report, RunFacts,
    SceneFacts, TargetFacts, Written,
};
use std::path::{Path, PathBuf};

/// Runs a scene file and writes its report.
///
/// # Errors
///
/// As [`prepare`] and [`trace`]. Also `Error::Usage` if another program uses the folder of the report, if its files
/// are to be kept and belong to another run, or if its checkpoint cannot be resumed; `Error::Output` or `Error::Io`
/// if the report cannot be composed or written.
pub fn run_one(
    scene: &Path,
    settings: &Settings,
    output: &Output,
    interrupt: &Interrupt,
    watch: &mut dyn FnMut(&Progress),
) -> Result<FinishedRun> {
    let mut job = prepare(scene, settings)?;
    let luminaire = output.luminaire.as_ref();
    let luminaire =
        luminaire.map(|path| LuminaireFile::open(&mut job, path, output.existing)).transpose()?;
    let dir = output_dir(scene, output);
    let lock = FolderLock::take(&dir)?;
    let (mut checkpoints, checkpoint) = CheckpointFile::open(&dir, recipe(&job), output)?;
    // A partial report that a stopped run left in its own folder may be replaced by the whole
    // report.
    let existing = if checkpoint.is_some() { Existing::Replace } else { output.existing };
    let folder = Folder::open(lock, existing, repeatable(&job).as_ref())?;
    let mut save = |pause: &Pause<'_>| checkpoints.save(pause);
    let traced = trace_from(&job, checkpoint, &mut save, interrupt, watch)?;
    interrupt.begin(Activity::Computing);
    let report = compose(&job, &traced.findings, traced.stop)?;
    let files = report::files(&report, &job.text, output.pictures)?;
    interrupt.begin(Activity::Writing);
    let written = folder.write(&files)?;
    timing::write(&folder, &traced)?;
    if traced.stop != Stop::Interrupted {
        checkpoints.remove()?;
    }
    let luminaire = luminaire.map(|file| file.write(&report)).transpose()?.flatten();
    Ok(FinishedRun {
        report,
        luminaire,
        written,
        stop: traced.stop,
        dir: folder.path().to_path_buf(),
        warnings: job.warnings,
    })
}

/// Loads a scene that can be traced.
///
/// # Errors
///
/// As [`input::load`]. Also `Error::Input` if nothing emits light, a check or the target names no measure of the
/// scene, or an estimator that was asked for cannot work on the scene.
pub fn prepare(scene: &Path, settings: &Settings) -> Result<Job> {
    let mut job = input::load(scene, settings)?;
    job.warnings.extend(expect_sense(&job)?);
    Ok(job)
}

/// A run that has written its report.
#[derive(Debug)]
pub struct FinishedRun {
    /// What the report says.
    pub report: Report,
    /// Whether it was there before.
    pub written: Written,
    /// Why the run ended.
    pub stop: Stop,
    /// Folder of the report.
    pub dir: PathBuf,
    /// The luminaire file that was asked for beside the report.
    pub luminaire: Option<WrittenFile>,
    /// Remarks on the scene file.
    pub warnings: Vec<Diagnostic>,
}

/// What identifies a run.
fn recipe(job: &Job) -> Recipe {
    Recipe::new(&job.hash, &job.run)
}

/// What determines the bytes of a job's report; `None` where the clock stops the run.
fn repeatable(job: &Job) -> Option<Recipe> {
    job.run.stop.time.is_none().then(|| recipe(job))
}

/// The report of what was counted.
///
/// # Errors
///
/// `Error::Output` if what a goniometer has counted makes no luminaire.
pub fn compose(job: &Job, findings: &Findings, stop: Stop) -> Result<Report> {
    let measures = measure::measure(&job.scene, findings);
    let checks = job
        .checks
        .iter()
        .map(|check| CheckResult {
            check: check.clone(),
            verdict: measure::verdict(check, &measures),
        })
        .collect();
    let mut warnings: Vec<String> = job
        .warnings
        .iter()
        .map(|warning| format!("`{}` {}", warning.key, warning.message))
        .collect();
    warnings.extend(report::remarks(&measures, &job.scene));
    warnings.extend(report::remarks_on_passages(&job.scene, &measures));
    warnings.extend(report::remarks_on_ray_sets(&job.scene, &measures));
    warnings.extend(report::remark_on_paths(job.run.stop.paths, measures.paths));
    let is_chosen =
        (0..job.scene.sensors.len()).any(|sensor| job.run.request(sensor) == Request::Auto);
    if is_chosen && findings.choices.is_empty() {
        warnings.push(
            "half of the time limit passed before the pilot had tried all estimators: sensors without their \
                own estimator are estimated forward"
                .to_owned(),
        );
    }
    let target = job.run.stop.target.as_ref().map(|target| TargetFacts::new(target, &measures));
    let luminaires = luminaires(job, &measures)?;
    warnings.extend(luminaires.iter().flat_map(|found| found.remarks.iter().cloned()));
    let (rays, remarks) = match stop {
        // The user wants it to end.
        Stop::Interrupted => (Vec::new(), Vec::new()),
        _ => rays(job, &measures),
    };
    warnings.extend(remarks);
    Ok(Report {
        scene: SceneFacts {
            name: job.name.clone(),
            title: job.title.clone(),
            description: job.description.clone(),
            project: job.project.clone(),
            hash: job.hash.clone(),
            overrides: job.overrides.clone(),
        },
        run: RunFacts {
            version: VERSION.to_owned(),
            identity: recipe(job),
            seed: job.run.seed,
            estimator: job.run.estimator,
            gather: report::requested_gathering(&job.run.gather),
            gathering: gathering(&job.scene, findings),
            partial: stop == Stop::Interrupted,
            asked: report::asked(&job.run.stop),
            stopped: stop.reason().to_owned(),
            repeat: repeat::command(job, findings, stop),
            target,
            bounce_limit: job.run.bounce_limit,
            polarisation: job.scene.polarisation,
            leaks: report::leak_places(&findings.photons.leaks, job.scene.origin),
        },
        measures,
        checks,
        luminaires,
        rays,
        warnings,
        drawing: report::drawing(&job.scene, &shown_tracks(job, REPORT_PATHS)),
        inventory: inventory_of(job),
    })
}

/// What is in the scene of a job.
fn inventory_of(job: &Job) -> Inventory {
    Inventory::of(&job.scene, &Outline::of(job.places.root()))
}

/// Number of paths that a report draws.
const REPORT_PATHS: usize = 60;

fn shown_tracks(job: &Job, count: usize) -> Vec<Track> {
    tracks(&job.scene, job.run.seed, job.run.bounce_limit, count)
}
