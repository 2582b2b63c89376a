//! Studies: many designs of one scene, traced with the same random numbers, and their joint
//! analysis.
//!
//! ```text
//! study file -> designs -> a record on disk for each, as soon as it ends -> analysis -> report
//! ```
//!
//! Results are written from the records alone, so that a batch that was killed and resumed, or
//! computed in shards on several machines, ends with the same bytes.

mod analysis;
mod board;
mod confirm;
mod designs;
mod execute;
mod facts;
mod front;
mod production;
mod propose;
mod race;
mod sampling;
mod score;
mod search;
mod store;

pub use board::{BatchEvent, BatchProgress, BestDesign, SearchLead};
pub use store::OnExisting;

use crate::pipeline;
use crate::study::analysis::analysed;
use crate::study::confirm::{CONFIRMATIONS, confirmations};
use crate::study::designs::designs;
use crate::study::execute::{DesignBatch, execute};
use crate::study::facts::facts;
use crate::study::production::production;
use crate::study::propose::ProposalEnd;
use crate::study::search::search;
use crate::study::store::Store;
use lumiduct_base::error::{Error, Result};
use lumiduct_core::transport::{Activity, Interrupt, Shard};
use lumiduct_input::keys::Key;
use lumiduct_input::problems::{Problems, name_hint};
use lumiduct_input::{Move, Study, StudySettings, load_study, rewritten_scene};
use lumiduct_report::study::{
    DesignRecord, StudyFacts, StudyReport, front_scene_name, study_files,
};
use lumiduct_report::{Existing, Folder, OutputFile, Written, is_among};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// How to run a study.
#[derive(Debug, Clone)]
pub struct BatchOptions {
    /// Command-line settings for all designs.
    pub settings: StudySettings,
    /// The folder of the results; `reports/studies/NAME` when none is given.
    pub dir: Option<PathBuf>,
    /// What to do with existing results.
    pub existing: OnExisting,
    /// Designs in flight at once.
    pub jobs: usize,
    /// Which part of the designs is computed.
    pub shard: Shard,
}

/// A batch that has ended.
#[derive(Debug)]
pub struct FinishedStudy {
    /// What the study is.
    pub facts: StudyFacts,
    /// The whole report; `None` for a shard or an interrupted batch.
    pub report: Option<StudyReport>,
    /// Whether the files existed before.
    pub written: Written,
    /// Designs with a record, and designs that need one.
    pub done: [usize; 2],
    /// Folder of the results.
    pub dir: PathBuf,
}

/// Runs a study file and writes its results.
///
/// # Errors
///
/// [`Error::Input`] or [`Error::Usage`] as [`load_study`], and [`Error::Input`] if the scene lacks a measure of the
/// study. [`Error::Usage`] if the folder is not free or holds results that cannot be resumed; [`Error::Io`] or
/// [`Error::Output`] if a record or a report cannot be written. A design that makes no scene is a result, not an
/// error.
pub fn run_study(
    path: &Path,
    options: &BatchOptions,
    interrupt: &Interrupt,
    watch: &(dyn Fn(BatchEvent<'_>) + Sync),
) -> Result<FinishedStudy> {
    let study = load_study(path, &options.settings)?;
    watch(BatchEvent::Read(&study.warnings));
    expect_measures(&study)?;
    if study.plan.search().is_some() && options.shard != Shard::WHOLE {
        let why =
            "a search cannot be split: each design depends on earlier results; leave out --shard";
        return Err(Error::Usage(why.to_owned()));
    }
    let all = designs(&study);
    let planned = study.plan.search().map_or(all.len(), |plan| plan.designs as usize);
    let facts = facts(&study, planned);
    let dir = options.dir.clone().unwrap_or_else(|| default_dir(&study.name));
    let store = Store::open(&dir, &facts, &study.text, options.existing)?;
    let wanted: Vec<usize> =
        options.shard.of(planned as u64).map(|index| index as usize + 1).collect();
    let jobs = options.jobs;
    let batch = DesignBatch { study: &study, store: &store, seed: None, jobs, interrupt, watch };
    // A search that runs out of designs ends with fewer.
    let planned = match study.plan.search() {
        Some(plan) => match search(&batch, plan)? {
            ProposalEnd::Complete(designs) => designs,
            ProposalEnd::Stopped => planned,
        },
        None => {
            execute(&batch, &all, &wanted)?;
            planned
        }
    };
    let facts = StudyFacts { designs: planned, ..facts };
    let records = designs_of(&store, planned)?;
    let wanted = wanted.into_iter().filter(|design| *design <= planned);
    let wanted: Vec<usize> = wanted.collect();
    let done = [wanted.iter().filter(|design| records.contains_key(design)).count(), wanted.len()];
    let unfinished = |done| FinishedStudy {
        facts: facts.clone(),
        report: None,
        written: Written::New,
        done,
        dir: dir.clone(),
    };
    if records.len() < planned {
        if study.plan.search().is_some() && !records.is_empty() {
            let so_far = analysed(facts.clone(), records.into_values().collect());
            write_best_scene(&study, &store, &so_far)?;
        }
        return Ok(unfinished(done));
    }
    let mut report = analysed(facts.clone(), records.into_values().collect());
    if !test_found(&batch, &mut report)? {
        write_best_scene(&study, &store, &report)?;
        // Of the designs that are traced again none is kept.
        let again = report.analysis.front.len() * CONFIRMATIONS;
        let open = facts.production_designs.unwrap_or(again.max(1));
        return Ok(unfinished([store.records()?.len(), done[1] + open]));
    }
    interrupt.begin(Activity::Computing);
    let found = report.found().map(|design| found_scene(&study, &store, design));
    let scenes = found.collect::<Result<_>>()?;
    let written = finish(&store, &report, (&study.text, scenes), interrupt)?;
    Ok(FinishedStudy { report: Some(report), written, ..unfinished(done) })
}

/// The records of the designs up to a number.
fn designs_of(store: &Store, planned: usize) -> Result<BTreeMap<usize, DesignRecord>> {
    let mut records = store.records()?;
    drop(records.split_off(&(planned + 1)));
    Ok(records)
}

/// Traces what a search has found again, and scatters its best design as production does; returns whether it was not interrupted.
fn test_found(batch: &DesignBatch<'_>, report: &mut StudyReport) -> Result<bool> {
    let found: Vec<&DesignRecord> = report.found().collect();
    let (Some(best), Some(plan)) = (found.first(), batch.study.plan.search()) else {
        return Ok(true);
    };
    let Some(again) = confirmations(batch, &found, report.facts.designs)? else {
        return Ok(false);
    };
    let made = batch
        .study
        .production
        .as_ref()
        .map(|samples| production(batch, &report.facts, best, samples, plan.designs as usize));
    let made = match made.transpose()? {
        Some(None) => return Ok(false),
        Some(Some(made)) => Some(Box::new(made)),
        None => None,
    };
    (report.confirmations, report.production) = (again, made);
    Ok(true)
}

/// Whether a folder contains results of a study.
pub fn has_study(dir: &Path) -> bool {
    Store::is_there(dir)
}

/// Merges the parts of a study and writes the results of the whole.
///
/// # Errors
///
/// [`Error::Usage`] if a part holds no results, the parts are of different studies or lack a design, or the folder
/// of the whole is one of them or not free; [`Error::Io`] or [`Error::Output`] if a file cannot be read, composed
/// or written.
pub fn merge_study(
    parts: &[PathBuf],
    dir: Option<&Path>,
    existing: OnExisting,
) -> Result<FinishedStudy> {
    let stores: Vec<Store> = parts.iter().map(|part| Store::read(part)).collect::<Result<_>>()?;
    let Some(first) = stores.first() else {
        return Err(Error::Usage("there are no parts to merge".into()));
    };
    let facts = first.facts().clone();
    if facts.plan.is_search() {
        let why = format!("{} holds a search, which has no parts to merge", first.path().display());
        return Err(Error::Usage(why));
    }
    if let Some(other) = stores.iter().find(|other| !other.facts().is_same_study(&facts)) {
        return Err(Error::Usage(format!(
            "{} and {} hold results of different studies",
            first.path().display(),
            other.path().display()
        )));
    }
    let mut have = BTreeSet::new();
    for store in &stores {
        let records = store.records()?;
        store.expect_whole_reports(records.keys())?;
        have.extend(records.into_keys());
    }
    let missing: Vec<usize> = (1..=facts.designs).filter(|design| !have.contains(design)).collect();
    if let Some(first) = missing.first() {
        return Err(Error::Usage(format!(
            "{} of {} designs are in no part, the first is design {first}: a part is missing or was stopped \
                (batch --resume continues it)",
            missing.len(),
            facts.designs
        )));
    }
    let text = first.text()?;
    let dir = dir.map_or_else(|| default_dir(&facts.name), Path::to_path_buf);
    // Merging into one of the parts would clear it before it is read.
    if is_among(&dir, parts) {
        return Err(Error::Usage(format!(
            "{} is one of the parts; use -o to name another folder for the whole",
            dir.display()
        )));
    }
    let whole = Store::open(&dir, &facts, &text, existing)?;
    for store in &stores {
        whole.take(store)?;
    }
    let records: Vec<DesignRecord> = whole.records()?.into_values().collect();
    let done = [records.len(), facts.designs];
    let report = analysed(facts.clone(), records);
    let written = finish(&whole, &report, (&text, Vec::new()), &Interrupt::default())?;
    Ok(FinishedStudy { facts, report: Some(report), written, done, dir })
}

/// The default folder of the results.
fn default_dir(name: &str) -> PathBuf {
    Path::new("reports/studies").join(name)
}

/// Writes the results of a study, with its file and the scenes that a search has found.
fn finish(
    store: &Store,
    report: &StudyReport,
    (text, scenes): (&str, Vec<OutputFile>),
    interrupt: &Interrupt,
) -> Result<Written> {
    // Results follow from the records: older ones of the same study may be replaced.
    let folder = Folder::open(store.lock()?, Existing::Replace, None)?;
    let files = study_files(report, text, scenes)?;
    interrupt.begin(Activity::Writing);
    folder.write(&files)
}

/// The scene of a design that a search has found, ready to run from the folder of the results.
fn found_scene(study: &Study, store: &Store, found: &DesignRecord) -> Result<OutputFile> {
    let settings = study.parameters.iter().filter_map(|parameter| {
        found.settings.get(&parameter.name).map(|setting| parameter.overrides(setting))
    });
    let way = Move { from: study.scene.parent().unwrap_or(Path::new("")), to: store.path() };
    let comment = [format!(
        "Found by the study `{}` (digest {}): design {} of the scene `{}`.",
        study.name, study.hash, found.design, study.base.name
    )];
    let mut overrides = study.common.with(settings.flatten()).overrides;
    let mut name = format!("{}_best.toml", study.base.name);
    if study.is_front() {
        let title = format!("{}, design {}", study.base.title, found.design);
        overrides.push(format!("title={}", serde_json::Value::from(title)));
        name = front_scene_name(&study.base.name, found.design);
    }
    let text = rewritten_scene(&study.base.text, &overrides, way, &comment)?;
    Ok(OutputFile { name, bytes: text.into_bytes() })
}

/// Writes the scene of the best design of a search that was stopped, if one passes.
fn write_best_scene(study: &Study, store: &Store, so_far: &StudyReport) -> Result<()> {
    let Some(best) = so_far.best_passing() else { return Ok(()) };
    let scene = found_scene(study, store, best)?;
    let folder = Folder::open(store.lock()?, Existing::Replace, None)?;
    folder.write_beside(&scene.name, &scene.bytes)
}

/// Refuses measures that the scene does not have, before any work is done.
fn expect_measures(study: &Study) -> Result<()> {
    let measures = study.measures.iter().enumerate();
    let measures = measures.map(|(index, name)| (Key::of(&["measures"]).index(index), name));
    let check = |index| Key::of(&["check"]).index(index).field("measure");
    let checks = study.checks.iter().enumerate().map(|(index, own)| (check(index), &own.measure));
    let target = study.base.run.stop.target.iter();
    let target = target.map(|own| (Key::of(&["run", "target", "measure"]), &own.measure));
    let mut problems = Problems::default();
    pipeline::expect_measures(
        &study.base.scene,
        measures.chain(checks).chain(target),
        &mut problems,
    );
    if study.cost.is_none()
        && let Some(ranking) = &study.ranking
        && problems.is_free_of_errors()
        && !study.measures.contains(&ranking.measure)
    {
        let hint = name_hint(&ranking.measure, study.measures.iter().map(String::as_str));
        let message = format!("`{}` is not one of `measures`", ranking.measure);
        problems.error(&Key::of(&["ranking", "measure"]), message).hint(hint);
    }
    problems.finish(&study.places).map(|_| ())
}
