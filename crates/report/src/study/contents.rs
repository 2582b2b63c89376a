//! The contents of the report of a study, part by part, for any page format.

use crate::page::{Block, PagePart, table};
use crate::study::choices::best_of_choices;
use crate::study::confirmation::{standing, traced_again};
use crate::study::edge::edge_remark;
use crate::study::front::{front_again, front_part, front_words};
use crate::study::sampled::{expected_failures, failures, produced, sensitivities};
use crate::study::settings::{domain_words, setting_word, settings, settings_words};
use crate::study::{
    DesignOutcome, DesignRecord, GainLimit, LatestGain, Pairing, ParameterFacts, PlanFacts,
    StudyReport, ValueWithError,
};
use crate::words::{measured, outcome_word};
use lumiduct_base::number::{format_value, format_with_error};
use lumiduct_core::measure::CheckOutcome;
use lumiduct_input::{Best, Domain};
use std::fmt::Write;

/// Errors of a difference above which a design counts as behind the best, 1.
const BEHIND_ERRORS: f64 = 3.0;

/// All parts except the pictures, in order: those before them, up to the first table, and those
/// after.
pub(super) fn parts(report: &StudyReport) -> [Vec<PagePart>; 2] {
    let mut before: Vec<PagePart> = [
        failures(report),
        best_of_choices(report),
        front_part(report),
        front_again(report),
        ranking(report),
        traced_again(report),
        produced(report),
        sensitivities(report),
        effects(report),
        Some(designs(report)),
        Some(parameters(report)),
        remarks(report),
        Some(run(report)),
    ]
    .into_iter()
    .flatten()
    .collect();
    let has_table =
        |part: &PagePart| part.blocks.iter().any(|block| matches!(block, Block::Table { .. }));
    let first = before.iter().position(has_table).map_or(0, |place| place + 1);
    let after = before.split_off(first);
    [before, after]
}

/// The outcome, in a sentence.
pub(super) fn verdict(report: &StudyReport) -> String {
    let (count, bad) = (report.designs.len(), report.counts());
    let designs = if count == 1 { "design" } else { "designs" };
    let mut text = format!("{count} {designs} of the scene “{}”", report.facts.scene);
    if report.facts.checks.is_empty() {
        text += ", without checks";
    } else {
        let passed = |own: &&DesignRecord| own.outcome.verdict() == Some(CheckOutcome::Passed);
        let passed = report.designs.iter().filter(passed).count();
        let (failed, undecided) = (bad.failed, bad.undecided);
        _ = write!(text, ": {passed} pass all checks, {failed} fail, {undecided} undecided");
    }
    if bad.broken > 0 {
        _ = write!(text, "; {} do not give a valid scene", bad.broken);
    }
    if bad.off_target > 0 {
        _ = write!(text, "; {} did not reach their target error", bad.off_target);
    }
    match report.best_passing() {
        Some(best) => {
            let again = standing(best, &report.confirmations);
            let settings = settings_words(report, best);
            _ = write!(
                text,
                "; the best that passes is design {} ({settings}){again}",
                best.design
            );
            text += &expected_failures(report);
        }
        None if report.facts.plan.is_search() => {
            let none = "; no design passes, so the search found none";
            text += &front_words(report).unwrap_or_else(|| none.to_owned());
        }
        None => {}
    }
    text
}

fn ranking(report: &StudyReport) -> Option<PagePart> {
    let ranking = report.facts.ranking.as_ref()?;
    let word = match ranking.best {
        Best::Highest => "highest",
        Best::Lowest => "lowest",
    };
    let words = format!(
        "The {word} {} is the best. All designs are traced with the same random numbers, so their \
            differences are known more precisely than their values.",
        ranking.measure
    );
    let labels = report.facts.varied().map(ParameterFacts::label);
    let head = ["place".to_owned(), "design".to_owned()].into_iter().chain(labels);
    let has_checks = !report.facts.checks.is_empty();
    let checks = has_checks.then(|| "checks".to_owned());
    let head = head.chain([ranking.measure.clone(), "behind the best".to_owned()]).chain(checks);
    let head: Vec<String> = head.collect();
    let rows = report.analysis.ranked.iter().enumerate().filter_map(|(place, own)| {
        let design = report.design(own.design)?;
        let value = design.measure(&ranking.measure).map_or(String::new(), measured);
        // Of a search, what does not pass may have a better value than the best.
        let is_beside = report.best_passing().is_some() && !design.passes();
        let behind = match &own.behind {
            None => "the best".to_owned(),
            Some(_) if is_beside => String::new(),
            Some(behind) => difference(behind),
        };
        let verdict = design.outcome.verdict().map_or("", outcome_word).to_owned();
        let row = [(place + 1).to_string(), own.design.to_string()].into_iter();
        let row = row.chain(settings(report, design)).chain([value, behind]);
        Some(row.chain(has_checks.then_some(verdict)).collect())
    });
    let mut blocks = vec![Block::Words { text: words }, table(&head, rows.collect())];
    let last = "Designs that fail a check come last, by their shortfall.";
    blocks.extend(report.best_passing().map(|_| Block::Words { text: last.to_owned() }));
    let is_found = !report.facts.plan.is_search() || report.best_passing().is_some();
    blocks.extend(edge_remark(report).filter(|_| is_found).map(|text| Block::Words { text }));
    Some(PagePart::new("Ranking", blocks))
}

fn difference(behind: &ValueWithError) -> String {
    // What a design costs has no noise.
    if behind.std_error == 0.0 && behind.value != 0.0 {
        return format_value(behind.value);
    }
    let number = format_with_error(behind.value, behind.std_error);
    let told = match behind.evidence {
        Pairing::Paired => "",
        Pairing::Independent => " (as if independent)",
    };
    let is_close = behind.value.abs() <= BEHIND_ERRORS * behind.std_error;
    format!("{number}{told}{}", if is_close { ", difference within error" } else { "" })
}

fn effects(report: &StudyReport) -> Option<PagePart> {
    let words = "The mean of a measure over designs with the same setting of a parameter. All designs are \
        traced with the same random numbers, so the difference from the first setting is known more \
        precisely than the means. Only designs that have a partner at every other setting, with all other \
        parameters equal, are included.";
    let head = ["measure", "parameter", "setting", "designs", "mean", "difference from the first"];
    let mut rows = Vec::new();
    for effect in &report.analysis.effects {
        let label = report.facts.parameters.iter().find(|own| own.name == effect.parameter);
        for point in &effect.points {
            rows.push(vec![
                effect.measure.clone(),
                label.map_or(effect.parameter.clone(), ParameterFacts::label),
                setting_word(&point.setting),
                point.designs.to_string(),
                format_with_error(point.mean.value, point.mean.std_error),
                point.from_first.map_or(String::new(), |step| difference(&step)),
            ]);
        }
    }
    let blocks = vec![Block::Words { text: words.into() }, table(&head, rows)];
    (!report.analysis.effects.is_empty()).then(|| PagePart::new("Main effects", blocks))
}

fn designs(report: &StudyReport) -> PagePart {
    let facts = &report.facts;
    let labels = facts.varied().map(ParameterFacts::label);
    let head = ["design".to_owned()].into_iter().chain(labels);
    let head = head.chain(facts.measures.iter().cloned()).chain(["checks".to_owned()]);
    let row = |design: &DesignRecord| {
        let values: Vec<String> = match &design.outcome {
            DesignOutcome::Done(result) => {
                let value =
                    |name: &String| result.measures.get(name).map_or(String::new(), measured);
                facts.measures.iter().map(value).collect()
            }
            DesignOutcome::Failed(reason) => {
                let rest = vec![String::new(); facts.measures.len().saturating_sub(1)];
                [format!("no valid scene: {reason}")].into_iter().chain(rest).collect()
            }
        };
        let verdict = design.outcome.verdict().map_or("", outcome_word).to_owned();
        let row = [design.design.to_string()].into_iter().chain(settings(report, design));
        row.chain(values).chain([verdict]).collect()
    };
    let rows = report.designs.iter().map(row).collect();
    PagePart::new("Designs", vec![table(&head.collect::<Vec<_>>(), rows)])
}

fn parameters(report: &StudyReport) -> PagePart {
    let head = ["parameter", "values", "keys of the scene"];
    let row = |own: &ParameterFacts| {
        let choices = own.choices.iter().map(|(name, value)| format!("{name}: {value}"));
        let values = match (own.choices.is_empty(), &own.domain) {
            (false, _) => choices.collect::<Vec<_>>().join("; "),
            // A search does not draw its values.
            (true, Domain::Uniform { from, to }) if report.facts.plan.is_search() => {
                format!("{} to {}", format_value(*from), format_value(*to))
            }
            (true, domain) => domain_words(domain),
        };
        vec![own.label(), values, own.keys.join(", ")]
    };
    let rows = report.facts.parameters.iter().map(row).collect();
    PagePart::new("Parameters", vec![table(&head, rows)])
}

/// Remarks of the designs, each listed once.
fn remarks(report: &StudyReport) -> Option<PagePart> {
    let mut told: Vec<(&str, Vec<usize>)> = Vec::new();
    for design in &report.designs {
        for warning in design.outcome.result().into_iter().flat_map(|result| &result.warnings) {
            match told.iter_mut().find(|(text, _)| text == warning) {
                Some((_, designs)) => designs.push(design.design),
                None => told.push((warning, vec![design.design])),
            }
        }
    }
    let line = |(warning, designs): &(&str, Vec<usize>)| {
        let which = match designs.as_slice() {
            all if all.len() == report.designs.len() => "all designs".to_owned(),
            [first, .., last] => format!("{} designs from {first} to {last}", designs.len()),
            [.., one] => format!("design {one}"),
            [] => String::new(),
        };
        format!("{which}: {warning}")
    };
    let items = told.iter().map(line).collect();
    (!told.is_empty()).then(|| PagePart::new("Remarks", vec![Block::List { items }]))
}

fn run(report: &StudyReport) -> PagePart {
    let facts = &report.facts;
    let plan = match facts.plan {
        PlanFacts::Grid => "grid of all combinations".to_owned(),
        PlanFacts::OneAtATime => "one parameter at a time".into(),
        PlanFacts::List => "designs of a table".into(),
        PlanFacts::LatinHypercube(seed) => format!("Latin hypercube, seed {seed}"),
        PlanFacts::Sobol(seed) => format!("scrambled Sobol sequence, seed {seed}"),
        PlanFacts::Tolerance(seed) => format!("independent random samples, seed {seed}"),
        PlanFacts::Search(seed) => {
            let front = match facts.objectives.is_empty() {
                true => "",
                false => " for a front, in several directions",
            };
            format!("search{front} by Nelder and Mead's simplex with restarts, seed {seed}")
        }
    };
    let mut lines = vec![
        format!("study {}, hash {}", facts.name, facts.hash),
        format!("plan: {plan}, {} designs", facts.designs),
        format!(
            "lumiduct {}, estimator {}, seed {} for all designs",
            facts.version, facts.estimator, facts.seed
        ),
        format!("requested for each design: {}", facts.asked),
    ];
    lines.extend(gain_words(report));
    for own in &report.analysis.sharpness {
        lines.push(format!(
            "differences of {} between neighbouring designs have errors {} times smaller than with \
                independent random numbers (median of {} pairs)",
            own.measure,
            format_value(own.factor),
            own.pairs
        ));
    }
    if !facts.overrides.is_empty() {
        lines.push(format!("set for all designs: {}", facts.overrides.join(", ")));
    }
    PagePart::new("Run", vec![Block::List { items: lines }])
}

/// What the latest designs have gained, if that ends a search.
fn gain_words(report: &StudyReport) -> Option<String> {
    let GainLimit { least, designs: all } = report.facts.gain_limit?;
    let count = report.designs.len();
    let Some(LatestGain { designs, gain }) = report.analysis.latest_gain else {
        return Some(
            "no design passed early enough to judge what the latest ones gained".to_owned(),
        );
    };
    let gained = match gain.std_error > 0.0 {
        true => format_with_error(gain.value, gain.std_error),
        false => format_value(gain.value),
    };
    let is_early = count < all && gain.value <= least.max(gain.std_error);
    let end = match is_early {
        true => format!("so it ended after {count} of {all} designs"),
        false => format!("and it had {count} of {all} designs"),
    };
    Some(format!(
        "the latest {designs} designs with the choices of the best gained {gained}, `least_gain` is {}, {end}",
        format_value(least)
    ))
}
