//! Optimisations: a design of a scene is found by repeated measurement, and checked.
//!
//! ```text
//! study file -> scene as it is -> measure, judge, correct ... -> best -> check by fresh numbers -> report
//! ```
//!
//! Each kind of optimisation is a variant of `OptimisationKind`. Results are written from the records of the measurements alone, so that
//! an optimisation that was killed and resumed ends with the same bytes.

mod bounds;
mod check;
mod compose;
mod end;
mod feedback;
mod judge;
mod law;
mod least_squares;
mod measure;
mod response;
mod search;
mod store;
mod zones;

pub use measure::OptimisationProgress;

use crate::optimise::bounds::LengthBounds;
use crate::optimise::check::check;
use crate::optimise::compose::{Found, found_scene, report};
use crate::optimise::law::SizeLaw;
use crate::optimise::measure::Measurements;
use crate::optimise::search::Search;
use crate::optimise::store::StepStore;
use crate::optimise::zones::Zones;
use crate::pipeline;
use crate::study::OnExisting;
use lumiduct_base::error::{Diagnostic, Result};
use lumiduct_core::transport::{Activity, Interrupt};
use lumiduct_input::keys::Key;
use lumiduct_input::problems::Problems;
use lumiduct_input::{
    Optimisation, OptimisationKind, PatternFeedback, StudySettings, load_optimisation,
};
use lumiduct_report::optimise::{
    OPTIMISATION_FORMAT, OptimisationIdentity, OptimisationReport, optimisation_files,
};
use lumiduct_report::{Existing, Folder, Written};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// How to run an optimisation.
#[derive(Debug, Clone)]
pub struct OptimisationOptions {
    /// Command-line settings for all measurements.
    pub settings: StudySettings,
    /// The folder of the results; `reports/optimisations/NAME` when none is given.
    pub dir: Option<PathBuf>,
    /// What to do with existing results.
    pub existing: OnExisting,
}

/// An optimisation that has ended.
#[derive(Debug)]
pub struct FinishedOptimisation {
    /// What was found.
    pub report: OptimisationReport,
    /// Whether the files existed before.
    pub written: Written,
    /// Folder of the results.
    pub dir: PathBuf,
    /// Remarks on study and scene.
    pub warnings: Vec<Diagnostic>,
}

/// Runs an optimisation and writes its results.
///
/// # Errors
///
/// [`lumiduct_base::error::Error::Input`] or `Usage` as [`load_optimisation`], and if the scene lacks the measure of efficiency; `Usage`
/// if the folder is not free or holds results that cannot be resumed; `Io` or `Output` if a record or a report cannot be written. A
/// target that is not reached is a result, not an error.
pub fn run_optimisation(
    path: &Path,
    options: &OptimisationOptions,
    interrupt: &Interrupt,
    watch: &dyn Fn(&OptimisationProgress),
) -> Result<FinishedOptimisation> {
    let study = load_optimisation(path, &options.settings)?;
    let OptimisationKind::PatternFeedback(feedback) = &study.kind;
    expect_efficiency(&study, feedback)?;
    let default = || Path::new("reports/optimisations").join(&study.name);
    let dir = options.dir.clone().unwrap_or_else(default);
    let identity = OptimisationIdentity {
        lumiduct_optimisation: OPTIMISATION_FORMAT,
        name: study.name.clone(),
        hash: study.hash.clone(),
    };
    let store = StepStore::open(&dir, &identity, options.existing)?;
    let zones = Zones::of(feedback);
    let bounds = LengthBounds::of(feedback, &study.base.scene);
    let law = SizeLaw::over(feedback.law, &zones.places, bounds.ends());
    let start = Instant::now();
    let measurements = Measurements {
        study: &study,
        feedback,
        zones: &zones,
        store: &store,
        interrupt,
        watch,
        start,
    };
    let mut end = Search::new(&measurements, &law, &bounds).run()?;
    let checks = check(&measurements, &mut end, |values| bounds.table(&law, values))?;
    let setting = end
        .steps
        .get(end.best)
        .filter(|own| !own.measured.is_start)
        .map(|own| bounds.table(&law, &own.measured.values));
    interrupt.begin(Activity::Computing);
    let found = Found { identity, end, checks, setting };
    let scene_setting = found.setting.clone();
    let report = report(&measurements, found, &law)?;
    let scene = found_scene(&measurements, &report, scene_setting.as_deref())?;
    let files = optimisation_files(&report, &study.text, scene)?;
    // Results follow from the records: older ones of the same optimisation may be replaced.
    let folder = Folder::open(store.lock(), Existing::Replace, None)?;
    interrupt.begin(Activity::Writing);
    let written = folder.write(&files)?;
    Ok(FinishedOptimisation { report, written, dir, warnings: study.warnings })
}

/// Refuses a measure of efficiency that the scene does not have, before any work is done.
fn expect_efficiency(study: &Optimisation, feedback: &PatternFeedback) -> Result<()> {
    let key = Key::of(&["optimise", "pattern_feedback", "efficiency"]);
    let mut problems = Problems::default();
    let own = &feedback.efficiency;
    let is_radiant = own.ends_with(".radiant_efficiency");
    if !is_radiant && !own.ends_with(".efficiency") {
        let message = format!("`{own}` is no efficiency, the share of the light of all sources");
        problems.error(&key, message).hint("name the `.efficiency` of a sensor");
    } else if !is_radiant && study.base.scene.fluoresces() {
        let message = format!(
            "`{own}` compares lumens, and fluorescence may emit more of them than it absorbs"
        );
        problems.error(&key, message).hint("name the `.radiant_efficiency` of a sensor");
    }
    let wanted = [(key, &feedback.efficiency)].into_iter();
    pipeline::expect_measures(&study.base.scene, wanted, &mut problems);
    problems.finish(&study.places).map(|_| ())
}
