//! The few lines that a run prints when it is done.

use crate::measure::{Measures, Outcome};
use crate::report::words::quantity;
use crate::report::{Report, Written};
use crate::scene::plan::Estimator;
use std::path::Path;

/// The estimator that a pilot has taken, where it is not the plain one.
fn choice(measures: &Measures, sensor: &str) -> String {
    let chosen = measures.choices.get(sensor).map(|choice| choice.chosen);
    let told = chosen.filter(|chosen| *chosen != Estimator::Forward);
    told.map_or(String::new(), |chosen| format!(", by `{}` (chosen by a pilot)", chosen.name()))
}

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
            "  {}: flux {}, efficiency {}{}\n",
            paths.sensor,
            value("flux"),
            value("efficiency"),
            choice(measures, &paths.sensor)
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
