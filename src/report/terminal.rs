//! The few lines that a run prints when it is done.

use crate::measure::Outcome;
use crate::report::markdown::quantity;
use crate::report::{Report, Written};
use std::path::Path;

/// Sensors, checks and where the report lies.
pub fn terminal(report: &Report, dir: &Path, written: &Written) -> String {
    let measures = &report.measures;
    let mut text =
        format!("{}\n{} paths, {}\n", report.scene.title, measures.paths, report.run.stopped);
    for paths in &measures.sensor_paths {
        let value = |name: &str| {
            measures.values.get(&format!("{}.{name}", paths.sensor)).map_or("".into(), quantity)
        };
        text += &format!(
            "  {}: flux {}, efficiency {}\n",
            paths.sensor,
            value("flux"),
            value("efficiency")
        );
    }
    for result in &report.checks {
        let word = match result.verdict.outcome {
            Outcome::Passed => "passed",
            Outcome::Undecided => "UNDECIDED",
            Outcome::Failed => "FAILED",
            Outcome::Unknown => "UNKNOWN MEASURE",
        };
        text += &format!("  check {}: {word}, {}\n", result.check.measure, result.verdict.reason);
    }
    if let Some(target) = report.run.target.as_ref().filter(|target| !target.is_reached()) {
        text += &format!("  note: {}\n", target.sentence());
    }
    for warning in &report.warnings {
        text += &format!("  note: {warning}\n");
    }
    let page = dir.join("report.md");
    let page = page.display();
    text + &match written {
        Written::New => format!("report: {page}\n"),
        Written::Same => format!("report: {page} (was there already, the same to the byte)\n"),
        Written::Nothing { differing } => format!(
            "no report: {} holds one that differs in {}, which is kept; use --overwrite to replace it, or -o for \
             another folder\n",
            dir.display(),
            differing.join(", ")
        ),
    }
}
