//! Tracing the designs of a study.
//!
//! A few designs are in flight at once, each managed by its own thread, which feeds one common
//! pool. So all threads are busy whether designs are many and small or few and large: while one
//! design is read, judged or written, batches of another are traced.

use crate::pipeline::{self, BUILD, Stop};
use crate::study::board::{BatchEvent, Board};
use crate::study::designs::Design;
use crate::study::store::Store;
use indexmap::IndexMap;
use lumiduct_base::error::{Diagnostic, DiagnosticKind, Error, Result};
use lumiduct_core::measure;
use lumiduct_core::transport::{Interrupt, batch_paths};
use lumiduct_input::{Job, Keep, Setting, Settings, Study};
use lumiduct_report::study::{DESIGN_FORMAT, DesignOutcome, DesignRecord, DesignResult};
use lumiduct_report::{self as report, Existing, Folder, FolderLock, Pictures};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// A batch contains the same paths in all designs, and this fraction of those of a run of the scene
/// alone: designs are small, and end between waves of 128 batches.
const BATCH_PARTS: u64 = 8;

/// A batch in progress.
pub(crate) struct DesignBatch<'a> {
    pub(crate) study: &'a Study,
    pub(crate) store: &'a Store,
    /// Seed of the random numbers of light in place of that of the study.
    pub(crate) seed: Option<u64>,
    /// Designs in flight at once.
    pub(crate) jobs: usize,
    pub(crate) interrupt: &'a Interrupt,
    pub(crate) watch: &'a (dyn Fn(BatchEvent<'_>) + Sync),
}

/// Traces those of the wanted designs that have no record yet. All designs are numbered from that of the first without a gap;
/// records before it are not looked at. Ends at the first file system error or when interrupted; designs finished by then have
/// their records.
pub(crate) fn execute(batch: &DesignBatch<'_>, designs: &[Design], wanted: &[usize]) -> Result<()> {
    let first = designs.first().map_or(1, |design| design.number);
    let numbered = |number: usize| designs.get(number.checked_sub(first)?);
    let records = batch.store.records()?.split_off(&first);
    for (number, record) in &records {
        expect_design(batch, numbered(*number), record)?;
    }
    let pending: Vec<&Design> = wanted
        .iter()
        .filter(|number| !records.contains_key(number))
        .filter_map(|number| numbered(*number))
        .collect();
    let (next, trouble) = (AtomicUsize::new(0), Mutex::new(None));
    let tracing = DesignTracing::new(batch, [wanted.len(), pending.len()])?;
    std::thread::scope(|scope| {
        for _ in 0..batch.jobs.min(pending.len()) {
            scope.spawn(|| {
                while let Some(design) = pending.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if batch.interrupt.is_raised() {
                        return;
                    }
                    if let Err(error) = tracing.trace_timed(design) {
                        // The others end, too, and lose their unfinished work, which can be
                        // recomputed.
                        batch.interrupt.raise();
                        if let Ok(mut trouble) = trouble.lock() {
                            trouble.get_or_insert(error);
                        }
                    }
                }
            });
        }
    });
    match trouble.into_inner() {
        Ok(Some(error)) => Err(error),
        Ok(None) | Err(_) => Ok(()),
    }
}

/// Checks that a record belongs to the design of its number.
pub(crate) fn expect_design(
    batch: &DesignBatch<'_>,
    design: Option<&Design>,
    record: &DesignRecord,
) -> Result<()> {
    let own = design.map(|design| settings(batch.study, design));
    if own.as_ref() == Some(&record.settings) {
        Ok(())
    } else {
        Err(batch.store.no_record(record.design, "its design has other settings"))
    }
}

/// What the parameters are set to in a design, by their names.
pub(crate) fn settings(study: &Study, design: &Design) -> IndexMap<String, Setting> {
    let names = study.parameters.iter().map(|parameter| parameter.name.clone());
    names.zip(design.settings.iter().cloned()).collect()
}

/// Designs that are being traced.
pub(crate) struct DesignTracing<'a> {
    batch: &'a DesignBatch<'a>,
    /// Settings common to all designs.
    pub(crate) common: Settings,
    pub(crate) board: Board<'a>,
}

/// How a design ended.
pub(crate) enum DesignEnd {
    /// With this record.
    Recorded(Box<DesignRecord>),
    /// The user stopped it, and nothing was written.
    Stopped,
}

impl<'a> DesignTracing<'a> {
    /// Begins; `counts` are the designs that are wanted, and those of them without a record.
    pub(crate) fn new(batch: &'a DesignBatch<'a>, counts: [usize; 2]) -> Result<Self> {
        let study = batch.study;
        let usual = batch_paths(&study.base.scene, &study.base.run);
        let common = Settings {
            batch_paths: Some(usual.div_ceil(BATCH_PARTS)),
            seed: batch.seed.or(study.common.seed),
            ..study.common.clone()
        };
        batch.store.begin_timing()?;
        let board = Board::new(counts, batch.watch);
        board.show();
        Ok(Self { batch, common, board })
    }

    /// Traces a design, and notes how long it took.
    pub(crate) fn trace_timed(&self, design: &Design) -> Result<DesignEnd> {
        let start = Instant::now();
        let end = self.trace(design)?;
        match &end {
            DesignEnd::Stopped => {}
            DesignEnd::Recorded(_) => {
                self.board.end(design.number);
                let seconds = start.elapsed().as_secs_f64();
                self.batch.store.note_seconds(design.number, seconds)?;
            }
        }
        Ok(end)
    }

    /// Traces a design and writes its record, unless it is interrupted.
    fn trace(&self, design: &Design) -> Result<DesignEnd> {
        let Self { batch, common, .. } = self;
        let study = batch.study;
        let Some(outcome) = self.outcome(design, common, study.keep)? else {
            return Ok(DesignEnd::Stopped);
        };
        let record = DesignRecord {
            lumiduct_design: DESIGN_FORMAT,
            build: BUILD.to_owned(),
            study: study.hash.clone(),
            design: design.number,
            settings: settings(study, design),
            outcome,
        };
        batch.store.write(&record)?;
        Ok(DesignEnd::Recorded(Box::new(record)))
    }

    /// What a design gives with these common settings; `None` if it is interrupted.
    pub(crate) fn outcome(
        &self,
        design: &Design,
        common: &Settings,
        keep: Keep,
    ) -> Result<Option<DesignOutcome>> {
        let study = self.batch.study;
        let own = study.parameters.iter().zip(&design.settings);
        let own = own.flat_map(|(parameter, setting)| parameter.overrides(setting));
        Ok(Some(match pipeline::prepare(&study.scene, &common.with(own)) {
            Ok(job) => match self.trace_job(design, job, keep) {
                Ok(Some(result)) => DesignOutcome::Done(Box::new(result)),
                Ok(None) => return Ok(None),
                // Its time was up before anything was counted.
                Err(Error::Usage(message)) => DesignOutcome::Failed(message),
                Err(error) => return Err(error),
            },
            Err(Error::Input(diagnostics)) => DesignOutcome::Failed(sentences(&diagnostics)),
            Err(Error::Usage(message)) => DesignOutcome::Failed(message),
            Err(error @ (Error::Io { .. } | Error::Output { .. })) => return Err(error),
        }))
    }

    /// The result of tracing; `None` if interrupted.
    fn trace_job(&self, design: &Design, mut job: Job, keep: Keep) -> Result<Option<DesignResult>> {
        let Self { batch, board, .. } = self;
        let study = batch.study;
        job.checks.clone_from(&study.checks);
        let traced = pipeline::trace(&job, batch.interrupt, &mut |progress| {
            board.go_on(design.number, progress.fraction());
        });
        let traced = match traced {
            Err(_) if batch.interrupt.is_raised() => return Ok(None),
            traced => traced?,
        };
        if traced.stop == Stop::Interrupted {
            return Ok(None);
        }
        let report = pipeline::compose(&job, &traced.findings, traced.stop)?;
        match keep {
            Keep::Records => {}
            Keep::Reports => {
                let path = batch.store.report_of(design.number);
                let folder = Folder::open(FolderLock::take(&path)?, Existing::Replace, None)?;
                folder.write(&report::files(&report, &job.text, Pictures::Drawn)?)?;
            }
        }
        let names = study.measures.iter().chain(study.checks.iter().map(|check| &check.measure));
        let cost = study.cost.as_ref().map(|own| own.measure(&study.parameters, &design.settings));
        let measures =
            cost.into_iter()
                .chain(names.filter_map(|name| {
                    Some((name.clone(), report.measures.values.get(name)?.clone()))
                }))
                .collect();
        let replicates = study.measures.iter().filter_map(|name| {
            Some((name.clone(), measure::replicates(&job.scene, &traced.findings, name)?))
        });
        Ok(Some(DesignResult {
            scene_hash: job.hash,
            measures,
            replicates: replicates.collect(),
            checks: report.checks,
            target: report.run.target,
            stopped: report.run.stopped,
            paths: report.measures.paths,
            warnings: report.warnings,
        }))
    }
}

/// The problems of a scene without file locations, which differ between machines.
fn sentences(diagnostics: &[Diagnostic]) -> String {
    let errors = diagnostics.iter().filter(|diagnostic| match diagnostic.kind {
        DiagnosticKind::Error => true,
        DiagnosticKind::Warning => false,
    });
    let sentence = |diagnostic: &Diagnostic| {
        let key = if diagnostic.key.is_empty() {
            String::new()
        } else {
            format!("`{}`: ", diagnostic.key)
        };
        format!("{key}{}", diagnostic.message)
    };
    errors.map(sentence).collect::<Vec<_>>().join("; ")
}
