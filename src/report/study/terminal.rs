//! What a batch prints when it has ended.

use crate::measure::Outcome;
use crate::number::format_percent;
use crate::report::study::{DesignOutcome, DesignRecord, StudyReport};

/// Designs that are named one by one.
const DESIGNS_SHOWN: usize = 5;

/// A few lines: how many designs pass, which are the best, what failed.
pub fn terminal(report: &StudyReport) -> String {
    let counts = report.counts();
    let mut text = format!("{}\n{} designs", report.facts.title, report.designs.len());
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
    let (measure, _) = report.leading();
    for own in report.analysis.ranked.iter().take(DESIGNS_SHOWN) {
        let design = report.designs.iter().find(|design| design.design == own.design);
        if let Some(found) = design.and_then(|design| design.measure(measure)) {
            let settings = design.map_or(String::new(), settings);
            text += &format!("  design {}: {measure} {found} ({settings})\n", own.design);
        }
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

fn settings(design: &DesignRecord) -> String {
    let words = design.settings.iter().map(|(name, setting)| format!("{name} {setting}"));
    words.collect::<Vec<_>>().join(", ")
}
