//! The best design of each combination of choices of a search.

use crate::page::{Block, PagePart, table};
use crate::study::settings::{setting, setting_word};
use crate::study::{DesignRecord, ParameterFacts, StudyReport};
use crate::words::{measured, outcome_word};
use lumiduct_input::{Domain, Setting};

/// A combination of choices, its best design, and how many were tried.
struct ChoiceBest<'a> {
    choices: Vec<&'a Setting>,
    best: Option<&'a DesignRecord>,
    tried: usize,
}

/// The table of a search with choices; `None` for other studies.
pub(super) fn best_of_choices(report: &StudyReport) -> Option<PagePart> {
    let ranking = report.facts.ranking.as_ref().filter(|_| report.facts.plan.is_search())?;
    let is_choice = |own: &&ParameterFacts| matches!(own.domain, Domain::Levels(_));
    let (chosen, ranges): (Vec<_>, Vec<_>) = report.facts.varied().partition(is_choice);
    if chosen.is_empty() {
        return None;
    }
    let words = "In every lap all combinations that are still in the race are tried equally often, then the better half goes on. \
        Those that fell behind were tried less often, so their best designs are not necessarily the best they allow.";
    let labels = chosen.iter().chain(&ranges).map(|own| own.label());
    let rest =
        [ranking.measure.as_str(), "checks", "best design", "designs tried"].map(str::to_owned);
    let head: Vec<String> = labels.chain(rest).collect();
    let row = |own: &ChoiceBest<'_>| {
        let best = own.best;
        let values =
            ranges.iter().map(|range| best.map_or(String::new(), |best| setting(range, best)));
        let value = best.and_then(|best| best.measure(&ranking.measure));
        let verdict = best.map(|best| best.outcome.verdict().map_or("", outcome_word));
        let choices = own.choices.iter().map(|choice| setting_word(choice));
        let rest = [
            value.map_or(String::new(), measured),
            verdict.unwrap_or("none could be measured").to_owned(),
            best.map_or(String::new(), |best| best.design.to_string()),
            own.tried.to_string(),
        ];
        choices.chain(values).chain(rest).collect()
    };
    let rows = combinations(report, &chosen).iter().map(row).collect();
    let blocks = vec![Block::Words { text: words.to_owned() }, table(&head, rows)];
    Some(PagePart::new("Best of each combination of choices", blocks))
}

/// In the order of their best designs, then those without any.
fn combinations<'a>(report: &'a StudyReport, chosen: &[&'a ParameterFacts]) -> Vec<ChoiceBest<'a>> {
    let choices_of = |design: &'a DesignRecord| -> Vec<&'a Setting> {
        chosen.iter().map(|own| own.setting_in(design)).collect()
    };
    let mut all: Vec<ChoiceBest<'a>> = Vec::new();
    for design in report.analysis.ranked.iter().filter_map(|own| report.design(own.design)) {
        let choices = choices_of(design);
        if all.iter().all(|own| own.choices != choices) {
            all.push(ChoiceBest { choices, best: Some(design), tried: 0 });
        }
    }
    for design in &report.designs {
        let choices = choices_of(design);
        match all.iter_mut().find(|own| own.choices == choices) {
            Some(known) => known.tried += 1,
            None => all.push(ChoiceBest { choices, best: None, tried: 1 }),
        }
    }
    all
}
