//! The lines that a batch prints at its end.

use crate::study::confirmation::words;
use crate::study::contents::verdict;
use crate::study::figures::setting_words;
use crate::study::sampled::broken;
use crate::study::{DesignOutcome, DesignRecord, StudyReport};
use lumiduct_base::number::format_percent;

/// Designs that are named one by one.
const DESIGNS_SHOWN: usize = 5;

/// A few lines: how many designs pass, which are the best, what failed.
pub fn terminal(report: &StudyReport) -> String {
    let counts = report.counts();
    let mut text = format!("{}\n{}\n", report.facts.title, verdict(report));
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
        let words = if ranked.is_empty() { "more" } else { "designs ranked lower" };
        text += &format!("  and {} {words}\n", shown.len() - DESIGNS_SHOWN);
    }
    for own in &report.confirmations {
        text += &format!("  {}\n", words(own));
    }
    let made = report.production.iter().flat_map(|made| &made.analysis.failures);
    for own in report.analysis.failures.iter().chain(made) {
        let [low, high] = own.interval.map(format_percent);
        let open = match own.undecided {
            0 => String::new(),
            count => format!(", {count} undecided"),
        };
        text += &format!(
            "  {}: {} of {} designs fail{open}; expected in production: {low} to {high} (95 %)\n",
            own.demand,
            own.failed,
            own.passed + own.failed + own.undecided
        );
    }
    let parts = report.production.iter().filter_map(|made| broken(made));
    parts.for_each(|words| text += &format!("  {words}\n"));
    let broken = report.designs.iter().filter_map(|design| match &design.outcome {
        DesignOutcome::Failed(reason) => Some((design.design, reason)),
        DesignOutcome::Done(_) => None,
    });
    for (number, reason) in broken.take(DESIGNS_SHOWN) {
        text += &format!("  design {number} gives no valid scene: {reason}\n");
    }
    if counts.broken > DESIGNS_SHOWN {
        text += &format!("  and {} more give none\n", counts.broken - DESIGNS_SHOWN);
    }
    text
}

fn settings(report: &StudyReport, design: &DesignRecord) -> String {
    let words = report.facts.varied().map(|parameter| setting_words(parameter, design));
    words.collect::<Vec<_>>().join(", ")
}
