//! The best design of a search, traced again with random numbers that the search has not used.

use crate::page::{Block, PagePart, table};
use crate::study::{Confirmation, DesignOutcome, DesignRecord, StudyReport};
use crate::words::{measured, outcome_word};
use lumiduct_core::measure::{CheckOutcome, Measure};

/// The part of the page with every measure as the search found it and as it was found again.
pub(super) fn traced_again(report: &StudyReport) -> Option<PagePart> {
    let best = report.best_passing().filter(|_| !report.confirmations.is_empty())?;
    let result = best.outcome.result()?;
    let by_another =
        if report.confirmations.len() > 1 { ", and by a second estimator" } else { "" };
    let words = format!(
        "The best of many noisy designs is partly luck. It was traced again with random numbers that the search has not used{by_another}."
    );
    let own = report.confirmations.iter();
    let head = own.clone().map(|own| format!("seed {}, {}", own.seed, own.estimator));
    let head: Vec<String> =
        ["measure".to_owned(), "in the search".to_owned()].into_iter().chain(head).collect();
    // A cost is exact.
    let names = result.measures.iter().filter(|(_, found)| found.batches > 0).map(|own| own.0);
    let cell = |found: Option<&Measure>| found.map_or(String::new(), measured);
    let rows = names.map(|name| {
        let again = own
            .clone()
            .map(|own| cell(own.outcome.result().and_then(|own| own.measures.get(name))));
        [name.clone(), cell(best.measure(name))].into_iter().chain(again).collect()
    });
    let mut blocks = vec![Block::Words { text: words }, table(&head, rows.collect())];
    let lines = own.map(|own| Block::Words { text: sentence(own) });
    blocks.extend(lines);
    Some(PagePart::new("Traced again", blocks))
}

/// A measure of the best design with random numbers that the search has not used.
pub(super) fn of_best<'a>(report: &'a StudyReport, measure: &str) -> Option<&'a Measure> {
    report.confirmations.first()?.outcome.result()?.measures.get(measure)
}

/// The words of a confirmation as a sentence.
fn sentence(own: &Confirmation) -> String {
    let words = words(own);
    format!("T{}.", words.strip_prefix('t').unwrap_or(&words))
}

/// What confirmations say of the best design, to follow its number in a sentence.
pub(super) fn standing(best: &DesignRecord, own: &[Confirmation]) -> String {
    let is_refuted = own.iter().any(Confirmation::refutes);
    let traced = own.iter().filter_map(|own| own.outcome.verdict());
    let is_open = traced.clone().any(|worst| worst != CheckOutcome::Passed);
    let words = match (traced.count() == 0 || best.outcome.verdict().is_none(), is_refuted, is_open)
    {
        (true, _, _) => return String::new(),
        (false, true, _) => "; traced again, it fails a check",
        (false, false, true) => "; traced again, a check is undecided",
        (false, false, false) => "; traced again, it passes",
    };
    words.to_owned()
}

/// What a confirmation says, for a list.
pub(super) fn words(own: &Confirmation) -> String {
    let found = match (&own.outcome, own.outcome.verdict()) {
        (DesignOutcome::Failed(reason), _) => format!("not possible: {reason}"),
        (DesignOutcome::Done(_), None) => "without checks".to_owned(),
        (DesignOutcome::Done(_), Some(CheckOutcome::Passed)) => "all checks pass".to_owned(),
        (DesignOutcome::Done(_), Some(worst)) => format!("a check is {}", outcome_word(worst)),
    };
    let which = own.design.map_or(String::new(), |number| format!("design {number} "));
    format!("{which}traced again with seed {} by `{}`: {found}", own.seed, own.estimator)
}
