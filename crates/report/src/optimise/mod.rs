//! The output of an optimisation: one record, and pure functions that turn it into files.

mod contents;
mod figures;
mod html;
mod record;
mod tables;
mod workshop;

pub use contents::terminal;
pub use record::{
    ElementShape, Ending, FoundElement, JudgedStep, LightMisfit, MeasuredStep, OPTIMISATION_FORMAT,
    OptimisationIdentity, OptimisationReport, Purpose, Uncertain, ZonePlace,
};

use crate::OutputFile;
use lumiduct_base::error::Result;

/// Name of the file with everything for programs.
const SUMMARY: &str = "optimised.json";

/// All files of an optimisation but its manifest and its records, in the reproducible order; `scene` is the name and the text of the scene
/// that was found.
///
/// # Errors
///
/// `Error::Output` if a figure cannot be drawn, or a table, a page or the summary cannot be composed.
pub fn optimisation_files(
    report: &OptimisationReport,
    study_text: &str,
    scene: (String, String),
) -> Result<Vec<OutputFile>> {
    let mut files = tables::files(report)?;
    files.extend(workshop::files(report));
    let figures = figures::figures(report);
    for figure in &figures {
        files.push(figure.file()?);
    }
    files.push(OutputFile::text(scene.0, scene.1));
    files.push(OutputFile::text(format!("{}.toml", report.identity.name), study_text.to_owned()));
    files.push(OutputFile::text("report.md", html::markdown(report, &figures)));
    files.push(OutputFile::text("report.html", html::html(report, &figures)?));
    files.push(OutputFile::json(SUMMARY, report)?);
    Ok(files)
}
