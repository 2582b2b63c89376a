//! The lines that a batch prints at its end.

use crate::study::confirmation::words;
use crate::study::contents::verdict;
use crate::study::figures::setting_words;
use crate::study::sampled::broken;
use crate::study::{Confirmation, DesignOutcome, DesignRecord, StudyReport};
use crate::words::measured;
use lumiduct_base::number::format_percent;

/// Designs that are named one by one.
const DESIGNS_SHOWN: usize = 5;
/// Designs of a front that are named.
const FRONT_SHOWN: usize = 20;

/// A few lines: how many designs pass, which are the best, what failed.
pub fn terminal(report: &StudyReport) -> String {
    let counts = report.counts();
    let mut text = format!("{}\n{}\n", report.facts.title, verdict(report));
    let (ranked, front) = (&report.analysis.ranked, &report.analysis.front);
    let (shown, most, rest): (Vec<usize>, _, _) = match (ranked.is_empty(), front.is_empty()) {
        (_, false) => {
            let numbers = front.iter().map(|own| own.design).collect();
            (numbers, FRONT_SHOWN, "more on the front")
        }
        (false, true) => {
            let numbers = ranked.iter().map(|own| own.design).collect();
            (numbers, DESIGNS_SHOWN, "designs ranked lower")
        }
        (true, true) => {
            (report.designs.iter().map(|own| own.design).collect(), DESIGNS_SHOWN, "more")
        }
    };
    for design in shown.iter().take(most).filter_map(|number| report.design(*number)) {
        if let Some(values) = leading_values(report, design) {
            let settings = settings(report, design);
            text += &format!("  design {}: {values} ({settings})\n", design.design);
        }
    }
    if shown.len() > most {
        text += &format!("  and {} {rest}\n", shown.len() - most);
    }
    // Of a front those alone that do not confirm it.
    let is_told = |own: &&Confirmation| {
        own.design.is_none() || own.refutes() || own.outcome.result().is_none()
    };
    for own in report.confirmations.iter().filter(is_told) {
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

/// The measures of a design that decide; `None` if one is missing.
fn leading_values(report: &StudyReport, design: &DesignRecord) -> Option<String> {
    let objectives = report.facts.objectives.iter().map(|own| own.measure.as_str());
    let leading = report.facts.objectives.is_empty().then(|| report.leading().0);
    let value = |name: &str| Some(format!("{name} {}", measured(design.measure(name)?)));
    let values: Option<Vec<String>> = objectives.chain(leading).map(value).collect();
    Some(values?.join(", "))
}

fn settings(report: &StudyReport, design: &DesignRecord) -> String {
    let words = report.facts.varied().map(|parameter| setting_words(parameter, design));
    words.collect::<Vec<_>>().join(", ")
}
