//! The output of a study: one record, and pure functions that turn it into files.

mod analysis;
mod choices;
mod confirmation;
mod contents;
mod edge;
mod figure;
mod figures;
mod front;
mod html;
mod page;
mod record;
mod sampled;
mod settings;
mod tables;
mod terminal;

pub use analysis::{
    Analysis, Effect, EffectPoint, FailureShare, FrontDesign, LatestGain, Pairing, Ranked,
    Sensitivity, SensitivityIndex, SensitivityMethod, Sharpness, ValueWithError,
};
pub use record::{
    Confirmation, DESIGN_FORMAT, DesignOutcome, DesignRecord, DesignResult, FACTS_FORMAT,
    GainLimit, ParameterFacts, PlanFacts, StudyFacts, StudyReport,
};

pub use front::front_scene_name;
pub use terminal::terminal;

use crate::OutputFile;
use crate::output::LOGO;
use indexmap::IndexMap;
use lumiduct_base::error::Result;
use lumiduct_core::measure::{CheckOutcome, Measure};
use lumiduct_input::Setting;
use serde::Serialize;

/// Name of the file with everything for programs.
pub(crate) const SUMMARY: &str = "study.json";
/// Version of the layout of that file.
pub(crate) const SUMMARY_FORMAT: u32 = 1;

/// All files of a study but its manifest and its records, in the reproducible order; `scenes` are those that a search has found.
///
/// # Errors
///
/// `Error::Output` if a figure cannot be drawn, or a table, a page or the summary cannot be composed.
pub fn study_files(
    report: &StudyReport,
    study_text: &str,
    scenes: Vec<OutputFile>,
) -> Result<Vec<OutputFile>> {
    let mut files = tables::files(report)?;
    let figures = figures::figures(report);
    for figure in &figures {
        files.push(figure.file()?);
    }
    files.push(OutputFile::text(format!("{}.toml", report.facts.name), study_text.to_owned()));
    files.extend(scenes);
    let logo = report.facts.logo.clone();
    files.extend(logo.map(|bytes| OutputFile { name: LOGO.to_owned(), bytes }));
    files.push(OutputFile::text("study.md", page::page(report, &figures)));
    files.push(OutputFile::text("study.html", html::html(report, &figures)?));
    files.push(summary(report, &files)?);
    Ok(files)
}

#[derive(Serialize)]
struct StudySummaryRecord<'a> {
    lumiduct_study_summary: u32,
    #[serde(flatten)]
    facts: StudyFacts,
    rows: Vec<DesignSummaryRow<'a>>,
    analysis: &'a Analysis,
    #[serde(skip_serializing_if = "<[Confirmation]>::is_empty")]
    confirmations: &'a [Confirmation],
    #[serde(skip_serializing_if = "Option::is_none")]
    production: Option<ProductionSummary<'a>>,
    files: Vec<&'a str>,
}

/// The best design of a search as production scatters it.
#[derive(Serialize)]
struct ProductionSummary<'a> {
    seed: u64,
    plan: PlanFacts,
    parameters: &'a [ParameterFacts],
    rows: Vec<DesignSummaryRow<'a>>,
    analysis: &'a Analysis,
}

impl<'a> ProductionSummary<'a> {
    fn of(made: &'a StudyReport) -> Self {
        let StudyFacts { seed, plan, parameters, .. } = &made.facts;
        let rows = made.designs.iter().map(DesignSummaryRow::of).collect();
        Self { seed: *seed, plan: *plan, parameters, rows, analysis: &made.analysis }
    }
}

/// A design without the values of single groups of batches.
#[derive(Serialize)]
struct DesignSummaryRow<'a> {
    design: usize,
    settings: &'a IndexMap<String, Setting>,
    #[serde(skip_serializing_if = "Option::is_none")]
    failed: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    measures: Option<&'a IndexMap<String, Measure>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<CheckOutcome>,
}

impl<'a> DesignSummaryRow<'a> {
    fn of(design: &'a DesignRecord) -> Self {
        Self {
            design: design.design,
            settings: &design.settings,
            failed: match &design.outcome {
                DesignOutcome::Failed(reason) => Some(reason),
                DesignOutcome::Done(_) => None,
            },
            measures: design.outcome.result().map(|result| &result.measures),
            verdict: design.outcome.verdict(),
        }
    }
}

fn summary(report: &StudyReport, files: &[OutputFile]) -> Result<OutputFile> {
    let summary = StudySummaryRecord {
        lumiduct_study_summary: SUMMARY_FORMAT,
        // The logo has a file of its own.
        facts: StudyFacts {
            logo: None,
            production_designs: report.production.as_ref().map(|made| made.designs.len()),
            ..report.facts.clone()
        },
        rows: report.designs.iter().map(DesignSummaryRow::of).collect(),
        analysis: &report.analysis,
        confirmations: &report.confirmations,
        production: report.production.as_deref().map(ProductionSummary::of),
        files: files.iter().map(|file| file.name.as_str()).chain([SUMMARY]).collect(),
    };
    OutputFile::json(SUMMARY, &summary)
}
