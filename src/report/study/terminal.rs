//! What a batch prints when it has ended.

use crate::input::Setting;
use crate::measure::Outcome;
use crate::number::format_percent;
use crate::report::study::contents::setting;
use crate::report::study::{DesignOutcome, DesignRecord, StudyReport};

/// Designs that are named one by one.
const DESIGNS_SHOWN: usize = 5;

/// A few lines: how many designs pass, which are the best, what failed.
pub fn terminal(report: &StudyReport) -> String {
    let counts = report.counts();
    let count = report.designs.len();
    let designs = if count == 1 { "design" } else { "designs" };
    let mut text = format!("{}\n{count} {designs}", report.facts.title);
    if !report.facts.checks.is_empty() {
        let passed =
            report.designs.iter().filter(|own| own.verdict() == Some(Outcome::Passed)).count();
        text += &format!(
            ": {passed} pass all checks, {} fail, {} are undecided",
            counts.failed, counts.undecided
        );
    }
    if counts.off_target > 0 {
        text += &format!("; {} have not reached their target error", counts.off_target);
    }
    text += "\n";
    let ranked = &report.analysis.ranked;
    let shown: Vec<usize> = match ranked.is_empty() {
        true => report.designs.iter().map(|design| design.design).collect(),
        false => ranked.iter().map(|own| own.design).collect(),
    };
    let (measure, _) = report.leading();
    for number in shown.iter().take(DESIGNS_SHOWN) {
        let design = report.designs.iter().find(|design| design.design == *number);
        if let Some((design, found)) = design.and_then(|own| Some((own, own.measure(measure)?))) {
            text +=
                &format!("  design {number}: {measure} {found} ({})\n", settings(report, design));
        }
    }
    if shown.len() > DESIGNS_SHOWN {
        let words = if ranked.is_empty() { "more" } else { "behind them" };
        text += &format!("  and {} {words}\n", shown.len() - DESIGNS_SHOWN);
    }
    for own in &report.analysis.failures {
        let [low, high] = own.interval.map(format_percent);
        text += &format!(
            "  fails {}: {} of {}, {low} to {high} with 95 %\n",
            own.demand,
            own.failed,
            report.designs.len()
        );
    }
    let broken = report.designs.iter().filter_map(|design| match &design.outcome {
        DesignOutcome::Failed(reason) => Some((design.design, reason)),
        DesignOutcome::Done(_) => None,
    });
    for (number, reason) in broken.take(DESIGNS_SHOWN) {
        text += &format!("  design {number} makes no scene: {reason}\n");
    }
    if counts.broken > DESIGNS_SHOWN {
        text += &format!("  and {} more make none\n", counts.broken - DESIGNS_SHOWN);
    }
    text
}

fn settings(report: &StudyReport, design: &DesignRecord) -> String {
    let words = report.facts.parameters.iter().map(|parameter| {
        let unit = match (design.settings.get(&parameter.name), &parameter.unit) {
            (Some(Setting::Number(_)), Some(unit)) => format!(" {unit}"),
            (Some(_) | None, _) => String::new(),
        };
        format!("{} {}{unit}", parameter.name, setting(parameter, design))
    });
    words.collect::<Vec<_>>().join(", ")
}
