//! Measurements: a design is traced, and the light of its zones is read; or its record is there already.

use crate::optimise::store::StepStore;
use crate::optimise::zones::Zones;
use crate::pipeline::{self, Stop};
use lumiduct_base::error::{Diagnostic, DiagnosticKind, Error, Result};
use lumiduct_core::measure::{self, Measures};
use lumiduct_core::plan::Request;
use lumiduct_core::transport::{Interrupt, batch_paths};
use lumiduct_input::{Job, Optimisation, PatternFeedback, Settings};
use lumiduct_report::optimise::{MeasuredStep, OPTIMISATION_FORMAT, Purpose, Uncertain};
use std::time::{Duration, Instant};

/// A batch contains this fraction of the paths of those of a run of the scene alone: measurements are short, and end between
/// waves of 128 batches.
const BATCH_PARTS: u64 = 8;

/// Progress of an optimisation.
#[derive(Debug, Clone)]
pub struct OptimisationProgress {
    /// The measurement at work, from 1.
    pub step: usize,
    /// What it is for.
    pub purpose: Purpose,
    /// Its share that is done, 0..=1.
    pub fraction: f64,
    /// The best so far, in words; empty before the first.
    pub best: String,
    /// Time since the start.
    pub elapsed: Duration,
}

impl OptimisationProgress {
    /// In a sentence.
    pub fn sentence(&self) -> String {
        let what = match self.purpose {
            Purpose::Search => "step",
            Purpose::CheckBefore | Purpose::CheckAfter => "check",
        };
        let best =
            if self.best.is_empty() { String::new() } else { format!(", best: {}", self.best) };
        format!("{what} {}: {:.0} %{best}", self.step, 100.0 * self.fraction)
    }
}

/// A design to measure.
#[derive(Debug, Clone)]
pub(crate) struct DesignToMeasure {
    pub(crate) purpose: Purpose,
    pub(crate) seed: u64,
    pub(crate) estimator: Request,
    pub(crate) paths: u64,
    /// The lengths at the points of the law, mm.
    pub(crate) values: Vec<f64>,
    /// The value of the key that varies; `None` for the scene as it is.
    pub(crate) setting: Option<String>,
}

impl DesignToMeasure {
    /// Whether a record is that of this design.
    fn is_of(&self, found: &MeasuredStep) -> bool {
        found.purpose == self.purpose
            && found.values == self.values
            && found.paths_asked == self.paths
            && found.seed == self.seed
            && found.estimator == self.estimator
    }
}

/// How a measurement ended.
#[derive(Debug)]
pub(crate) enum MeasureEnd {
    /// It has its record.
    Done(Box<MeasuredStep>),
    /// The scene refuses the design.
    Refused(String),
    /// The user stopped it.
    Interrupted,
}

/// What all measurements share.
pub(crate) struct Measurements<'a> {
    pub(crate) study: &'a Optimisation,
    pub(crate) feedback: &'a PatternFeedback,
    pub(crate) zones: &'a Zones,
    pub(crate) store: &'a StepStore,
    pub(crate) interrupt: &'a Interrupt,
    pub(crate) watch: &'a dyn Fn(&OptimisationProgress),
    pub(crate) start: Instant,
}

impl Measurements<'_> {
    /// Reads the record of a design, or measures it. Records are read even after Ctrl-C, so that the best of them is not lost.
    pub(crate) fn measure(
        &self,
        step: usize,
        design: &DesignToMeasure,
        best: &str,
    ) -> Result<MeasureEnd> {
        if let Some(found) = self.store.step(step)? {
            return if design.is_of(&found) {
                Ok(MeasureEnd::Done(Box::new(found)))
            } else {
                Err(self.store.misplaced(step))
            };
        }
        if self.interrupt.is_raised() {
            return Ok(MeasureEnd::Interrupted);
        }
        let job = match pipeline::prepare(&self.study.scene, &self.settings(design)) {
            Ok(job) => job,
            Err(Error::Input(found)) => return Ok(MeasureEnd::Refused(sentences(&found))),
            Err(error) => return Err(error),
        };
        self.expect_unchanged(&job)?;
        let watch = |fraction: f64| {
            (self.watch)(&OptimisationProgress {
                step,
                purpose: design.purpose,
                fraction,
                best: best.to_owned(),
                elapsed: self.start.elapsed(),
            });
        };
        let traced =
            pipeline::trace(&job, self.interrupt, &mut |progress| watch(progress.fraction()));
        let traced = match traced {
            Err(_) if self.interrupt.is_raised() => return Ok(MeasureEnd::Interrupted),
            traced => traced?,
        };
        if traced.stop == Stop::Interrupted {
            return Ok(MeasureEnd::Interrupted);
        }
        match self.record(step, design, &measure::measure(&job.scene, &traced.findings)) {
            Ok(record) => Ok(MeasureEnd::Done(Box::new(self.store.write(&record)?))),
            Err(why) => Ok(MeasureEnd::Refused(why)),
        }
    }

    /// Refuses a scene that is another one than at the start, or that reads other files.
    pub(crate) fn expect_unchanged(&self, job: &Job) -> Result<()> {
        if job.files_hash == self.study.base.files_hash {
            return Ok(());
        }
        Err(Error::Usage(format!(
            "{} or a file that it reads changed while the optimisation ran; start again with --overwrite",
            self.study.scene.display()
        )))
    }

    /// The record of a traced design, or why there is none.
    fn record(
        &self,
        step: usize,
        design: &DesignToMeasure,
        measures: &Measures,
    ) -> std::result::Result<MeasuredStep, String> {
        let sensor = &self.study.base.scene.sensors[self.feedback.sensor.index()].name;
        let map = measures.maps.iter().find(|map| {
            map.sensor == *sensor && map.view == self.feedback.view && map.light.is_none()
        });
        let efficiency = measures.values.get(&self.feedback.efficiency);
        let (Some(map), Some(efficiency)) = (map, efficiency) else {
            return Err(format!(
                "the scene of this step has no map of `{sensor}` or no `{}`",
                self.feedback.efficiency
            ));
        };
        Ok(MeasuredStep {
            lumiduct_step: OPTIMISATION_FORMAT,
            hash: self.study.hash.clone(),
            step,
            purpose: design.purpose,
            seed: design.seed,
            estimator: design.estimator,
            paths_asked: design.paths,
            is_start: design.setting.is_none(),
            values: design.values.clone(),
            zones: self.zones.read(map),
            efficiency: Uncertain { value: efficiency.value, std_error: efficiency.std_error },
            paths: measures.paths,
        })
    }

    fn settings(&self, design: &DesignToMeasure) -> Settings {
        let base = &self.study.base;
        let usual = batch_paths(&base.scene, &base.run);
        let line = design.setting.iter().map(|setting| format!("{}={setting}", self.feedback.key));
        Settings {
            estimator: Some(design.estimator),
            seed: Some(design.seed),
            paths: Some(design.paths),
            batch_paths: Some(usual.div_ceil(BATCH_PARTS)),
            ..self.study.common.with(line)
        }
    }
}

/// Errors of a scene in a sentence.
fn sentences(diagnostics: &[Diagnostic]) -> String {
    let errors = diagnostics.iter().filter(|own| own.kind == DiagnosticKind::Error);
    let sentence = |own: &Diagnostic| {
        let key = if own.key.is_empty() { String::new() } else { format!("`{}`: ", own.key) };
        format!("{key}{}", own.message)
    };
    errors.map(sentence).collect::<Vec<_>>().join("; ")
}
