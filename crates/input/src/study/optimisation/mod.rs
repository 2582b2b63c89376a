//! From a study file with a table `optimise` to an optimisation: what is to be found in which scene, and for which light.
//!
//! This module traces nothing, and chooses no sizes.

pub(super) mod feedback;
mod profile;
mod rules;

use crate::keys::Places;
use crate::lower::names::check_title;
use crate::problems::Problems;
use crate::spec::optimise::{OptimisationRunSpec, OptimisationSpec, OptimiseSpec};
use crate::study::file::{StudyDraft, read_optimisation};
use crate::study::optimisation::feedback::{LightTarget, PatternFeedback};
use crate::study::{StudySettings, of_set, overrides_of};
use crate::{Job, Settings, load};
use lumiduct_base::digest::Digest;
use lumiduct_base::error::{Diagnostic, Error, Result};
use lumiduct_base::text::visible;
use lumiduct_core::plan::NUMERICS;
use std::path::{Path, PathBuf};

/// An optimisation to run.
#[derive(Debug)]
pub struct Optimisation {
    /// Name: that of the file without its extension.
    pub name: String,
    /// Title for reports.
    pub title: String,
    /// The purpose of the study.
    pub description: Option<String>,
    /// The scene to start from.
    pub base: Job,
    /// Its file.
    pub scene: PathBuf,
    /// Settings common to all measurements; overrides of a step come after these.
    pub common: Settings,
    /// What is to be found.
    pub kind: OptimisationKind,
    /// The places of the keys in the study file.
    pub places: Places,
    /// The study file, byte for byte.
    pub text: String,
    /// Identifies study, scene, files referenced by them, and overrides: 64-bit FNV-1a, in hexadecimal.
    pub hash: String,
    /// Remarks on study and scene.
    pub warnings: Vec<Diagnostic>,
}

/// What is to be found, and how.
#[derive(Debug, Clone, PartialEq)]
pub enum OptimisationKind {
    /// Sizes or pitches along a face, by feedback from the light of zones.
    PatternFeedback(Box<PatternFeedback>),
}

/// Loads an optimisation, its scene and everything they refer to.
///
/// # Errors
///
/// [`Error::Input`] with all problems of the study, or of its scene and the files that they refer to;
/// [`Error::Usage`] as [`load`].
pub fn load_optimisation(path: &Path, settings: &StudySettings) -> Result<Optimisation> {
    let StudyDraft { spec, places, table, mut problems } = read_optimisation(path)?;
    let scene = path.parent().unwrap_or(Path::new("")).join(&spec.scene);
    check_title(&spec.title, &mut problems);
    rules::check(&spec, &scene, &mut problems);
    let profile = table.map(|table| profile::rows(&places, table, &mut problems));
    let common = common_settings(&spec, settings, &mut problems);
    if !problems.is_free_of_errors() {
        return Err(Error::Input(problems.into_diagnostics(&places)));
    }
    let base = load(&scene, &common).map_err(|error| of_set(error, &spec.set, &places))?;
    let target = profile.flatten().map_or(LightTarget::Uniform, LightTarget::Profile);
    let OptimiseSpec::PatternFeedback(feedback) = &spec.optimise;
    let kind = rules::feedback(feedback, &base, target, &mut problems);
    let warnings = problems.finish(&places)?;
    let Some(kind) = kind else { return Err(Error::Input(warnings)) };
    let mut hash = Digest::default();
    places.sources().iter().for_each(|source| hash.add(source.text().as_bytes()));
    hash.add(base.hash.as_bytes());
    let identity = serde_json::to_string(&(NUMERICS, &base.run, settings));
    hash.add(identity.expect("numbers and texts always have a form in JSON").as_bytes());
    let warnings = warnings.into_iter().chain(base.warnings.iter().cloned()).collect();
    Ok(Optimisation {
        name: visible(&path.file_stem().unwrap_or_default().to_string_lossy()),
        title: spec.title,
        description: spec.description,
        base,
        scene,
        common,
        kind: OptimisationKind::PatternFeedback(Box::new(kind)),
        text: places.root_text().to_owned(),
        places,
        hash: hash.to_string(),
        warnings,
    })
}

/// Settings common to all measurements.
fn common_settings(
    spec: &OptimisationSpec,
    settings: &StudySettings,
    problems: &mut Problems,
) -> Settings {
    let OptimisationRunSpec { paths, seed, estimator } = spec.run;
    Settings {
        overrides: overrides_of(&spec.set, settings, problems),
        estimator,
        paths: settings.paths.or(paths),
        seed: settings.seed.or(seed),
        ..Settings::default()
    }
}
