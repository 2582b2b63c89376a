//! The few lines that a run prints when it is done.

use crate::measure::Outcome;
use crate::report::markdown::quantity;
use crate::report::{Report, Written};
use std::path::Path;

/// Sensors, checks and where the report lies.
pub fn terminal(report: &Report, dir: &Path, written: Written) -> String {
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
    for warning in &report.warnings {
        text += &format!("  note: {warning}\n");
    }
    let remark = match written {
        Written::New => "",
        Written::Same => " (was there already, the same to the byte)",
    };
    text + &format!("report: {}{remark}\n", dir.join("report.md").display())
}
