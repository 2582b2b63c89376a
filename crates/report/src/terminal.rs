//! The lines that a run prints at its end.

use crate::by_light::{LightShare, shares, sum_over_weathers};
use crate::key_figures::key_figures;
use crate::words::quantity;
use crate::{Report, Written};
use lumiduct_core::measure::{CheckOutcome, Measures};
use lumiduct_core::plan::Estimator;
use std::path::Path;

/// The sensors for which a pilot chose an estimator other than forward.
fn choices(measures: &Measures) -> Option<String> {
    let chosen = measures.choices.iter().map(|(sensor, choice)| (sensor, choice.chosen));
    let told: Vec<String> = chosen
        .filter(|(_, chosen)| *chosen != Estimator::Forward)
        .map(|(sensor, chosen)| format!("{sensor} by `{}`", chosen.name()))
        .collect();
    (!told.is_empty()).then(|| format!("  computed {} (chosen by a pilot)\n", told.join(", ")))
}

/// The reading of a sensor, in a line.
fn reading(measures: &Measures, sensor: &str) -> String {
    let figures: Vec<String> = key_figures(measures, sensor)
        .iter()
        .filter(|figure| figure.is_brief)
        .map(|figure| format!("{} {}", figure.label, quantity(figure.measure)))
        .collect();
    let words = sum_over_weathers(measures.weathers.len());
    let sum = words.map_or(String::new(), |words| format!(" ({words})"));
    format!("  {sensor}: {}{sum}\n", figures.join(", "))
}

/// Sources and light groups that are printed for a sensor.
const SHOWN: usize = 8;

/// The contribution of each source or light group to a sensor.
fn by_source(measures: &Measures, sensor: &str) -> String {
    let shares = shares(measures, sensor);
    let line = |part: &LightShare<'_>| {
        let of_all = part.share.map_or(String::new(), |share| {
            format!(", {} of the light on {sensor}", quantity(share))
        });
        format!("    from {}: efficiency {}{of_all}\n", part.name, quantity(part.efficiency))
    };
    let mut text: String = shares.iter().take(SHOWN).map(line).collect();
    if shares.len() > SHOWN {
        text += &format!("    and {} more sources: see the report\n", shares.len() - SHOWN);
    }
    text
}

/// Sensors, checks, remarks on the results and the folder of the report. Those on the scene file come first in the report, as many
/// as `on_scene`, and are left out.
pub fn terminal(report: &Report, on_scene: usize, dir: &Path, written: &Written) -> String {
    let measures = &report.measures;
    let mut text =
        format!("{}\n{} paths, {}\n", report.scene.title, measures.paths, report.run.stopped);
    for paths in &measures.sensor_paths {
        text += &reading(measures, &paths.sensor);
        text += &by_source(measures, &paths.sensor);
    }
    for result in &report.checks {
        let word = match result.verdict.outcome {
            CheckOutcome::Passed => "passed",
            CheckOutcome::Undecided => "UNDECIDED",
            CheckOutcome::Failed => "FAILED",
            CheckOutcome::Unknown => "UNKNOWN MEASURE",
        };
        text += &format!("  check {}: {word}, {}\n", result.check.measure, result.verdict.reason);
    }
    if let Some(target) = report.run.target.as_ref().filter(|target| !target.is_reached()) {
        text += &format!("  note: {}\n", target.sentence());
    }
    for warning in report.warnings.iter().skip(on_scene) {
        text += &format!("  note: {warning}\n");
    }
    text.extend(choices(measures));
    let page = dir.join("report.html");
    let page = page.display();
    text + &match written {
        Written::New => format!("report: {page}\n"),
        Written::Same => format!("report: {page} (already there, identical to the byte)\n"),
        Written::Nothing { differing } => format!(
            "no report written: {} holds one that differs in {}; it is kept; use --overwrite to replace it, \
                or -o for another folder\n",
            dir.display(),
            differing.join(", ")
        ),
    }
}
