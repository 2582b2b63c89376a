//! `study.md`: what came of a study, for people.

use crate::input::{Best, Domain, Setting};
use crate::measure::Outcome;
use crate::number::{format_percent, format_value, format_with_error};
use crate::report::study::figures::picture_words;
use crate::report::study::{
    DesignOutcome, DesignRecord, Estimate, Pairing, ParameterFacts, PlanFacts, Sensitivity,
    SensitivityMethod, StudyReport,
};
use crate::report::words::quantity;
use std::fmt::Write;

/// Designs that are listed one by one; `study.csv` has all.
const DESIGNS_SHOWN: usize = 60;
/// Places of the ranking that are listed.
const PLACES_SHOWN: usize = 20;
/// Errors of a difference from which on a design is told to be behind the best, 1.
const BEHIND_ERRORS: f64 = 3.0;

/// The whole page. `files` are the other files of the study.
pub(super) fn page(report: &StudyReport, files: &[String]) -> String {
    let facts = &report.facts;
    let mut page = format!("# {}\n\n", facts.title);
    if let Some(description) = &facts.description {
        page += &format!("{}\n\n", description.trim());
    }
    page += &verdict(report);
    page += &failures(report);
    page += &ranking(report);
    page += &sensitivities(report);
    for file in files.iter().filter(|file| file.ends_with(".png")) {
        _ = write!(page, "![{}]({file})\n\n", picture_words(file));
    }
    page += &designs(report);
    page += &parameters(report);
    page += &remarks(report);
    page + &run(report)
}

fn verdict(report: &StudyReport) -> String {
    let (count, bad) = (report.designs.len(), report.counts());
    let mut text = format!("{count} designs of the scene `{}`", report.facts.scene);
    if report.facts.checks.is_empty() {
        text += ", without checks";
    } else {
        let passed =
            report.designs.iter().filter(|own| own.verdict() == Some(Outcome::Passed)).count();
        _ = write!(
            text,
            ": {passed} pass all checks, {} fail, {} are undecided",
            bad.failed, bad.undecided
        );
    }
    if bad.broken > 0 {
        _ = write!(text, "; **{} make no scene that can be traced**", bad.broken);
    }
    if bad.off_target > 0 {
        _ = write!(text, "; {} have not reached their target error", bad.off_target);
    }
    text + ".\n\n"
}

fn failures(report: &StudyReport) -> String {
    let shares = &report.analysis.failures;
    if shares.is_empty() {
        return String::new();
    }
    let mut text = "## Share of designs that fail\n\nThe interval holds the share of all that are ever made so with 95 % \
                    (Clopper and Pearson); where the error bar of a design leaves a check open, it counts as passed for the \
                    low end and as failed for the high end.\n\n| demand | passed | failed | undecided | fails | interval |\n\
                    |---|--:|--:|--:|---|---|\n"
        .to_owned();
    for own in shares {
        let [low, high] = own.interval.map(format_percent);
        let share = if own.undecided == 0 {
            format_percent(own.least)
        } else {
            format!("{} to {}", format_percent(own.least), format_percent(own.most))
        };
        _ = writeln!(
            text,
            "| {} | {} | {} | {} | {share} | {low} to {high} |",
            own.demand, own.passed, own.failed, own.undecided
        );
    }
    text + "\n"
}

fn ranking(report: &StudyReport) -> String {
    let ranked = &report.analysis.ranked;
    let Some(ranking) = &report.facts.ranking else { return String::new() };
    let word = match ranking.best {
        Best::Highest => "highest",
        Best::Lowest => "lowest",
    };
    let mut text = format!(
        "## Ranking\n\nThe {word} `{}` is the best. How much a design is behind is known better than the values, for all \
         designs are traced with the same random numbers.\n\n| place | design | {} | {} | behind the best |\n|--:|--:|{}---|---|\n",
        ranking.measure,
        report.facts.parameters.iter().map(ParameterFacts::label).collect::<Vec<_>>().join(" | "),
        ranking.measure,
        "---|".repeat(report.facts.parameters.len())
    );
    for (place, own) in ranked.iter().take(PLACES_SHOWN).enumerate() {
        let Some(design) = report.designs.iter().find(|design| design.design == own.design) else {
            continue;
        };
        let value = design.measure(&ranking.measure).map_or(String::new(), quantity);
        let behind = own.behind.map_or("the best".into(), |behind| difference(&behind));
        let settings = settings(report, design);
        _ = writeln!(text, "| {} | {} | {settings} | {value} | {behind} |", place + 1, own.design);
    }
    if ranked.len() > PLACES_SHOWN {
        _ = write!(text, "\n{} more are in `study.csv`.\n", ranked.len() - PLACES_SHOWN);
    }
    text + "\n"
}

fn difference(behind: &Estimate) -> String {
    let number = format_with_error(behind.value, behind.std_error);
    let told = match behind.evidence {
        Pairing::Paired => "",
        Pairing::Independent => " (as if independent)",
    };
    let close =
        if behind.value.abs() < BEHIND_ERRORS * behind.std_error { ", not told apart" } else { "" };
    format!("{number}{told}{close}")
}

fn sensitivities(report: &StudyReport) -> String {
    let all = &report.analysis.sensitivities;
    let Some(first) = all.first() else { return String::new() };
    let what = match first.method {
        SensitivityMethod::FirstOrder => {
            "First-order Sobol indices: the share of the variance over the grid that a parameter makes on its own. What is \
             missing to 1 is made by parameters together."
        }
        SensitivityMethod::Regression => {
            "Standardised regression coefficients: by how many standard deviations the measure moves when the parameter \
             moves by one of its own. R² is the share of the variance that the regression tells."
        }
    };
    let mut text = format!("## Sensitivity\n\n{what}\n\n| measure |");
    for index in &first.indices {
        _ = write!(text, " {} |", index.parameter);
    }
    let sum = match first.method {
        SensitivityMethod::FirstOrder => "sum",
        SensitivityMethod::Regression => "R²",
    };
    _ = write!(text, " {sum} |\n|---|{}---|\n", "---|".repeat(first.indices.len()));
    for Sensitivity { measure, indices, explained, .. } in all {
        _ = write!(text, "| {measure} |");
        for index in indices {
            _ = write!(text, " {} |", format_with_error(index.value, index.std_error));
        }
        _ = writeln!(text, " {} |", format_value(*explained));
    }
    text + "\n"
}

fn designs(report: &StudyReport) -> String {
    let facts = &report.facts;
    let labels = facts.parameters.iter().map(ParameterFacts::label);
    let columns: Vec<String> = labels.chain(facts.measures.iter().cloned()).collect();
    let mut text = format!(
        "## Designs\n\n| design | {} | checks |\n|--:|{}---|\n",
        columns.join(" | "),
        "---|".repeat(columns.len())
    );
    for design in report.designs.iter().take(DESIGNS_SHOWN) {
        let values = match &design.outcome {
            DesignOutcome::Done(result) => {
                let value =
                    |name: &String| result.measures.get(name).map_or(String::new(), quantity);
                facts.measures.iter().map(value).collect::<Vec<_>>().join(" | ")
            }
            DesignOutcome::Failed(reason) => {
                let rest = " |".repeat(facts.measures.len() - 1);
                format!("**no scene:** {}{rest}", reason.replace('|', "\\|"))
            }
        };
        let verdict = match design.verdict() {
            Some(Outcome::Passed) => "passed",
            Some(Outcome::Undecided) => "**undecided**",
            Some(Outcome::Failed) => "**failed**",
            Some(Outcome::Unknown) => "**unknown measure**",
            None => "",
        };
        let settings = settings(report, design);
        _ = writeln!(text, "| {} | {settings} | {values} | {verdict} |", design.design);
    }
    if report.designs.len() > DESIGNS_SHOWN {
        _ = write!(text, "\n{} more are in `study.csv`.\n", report.designs.len() - DESIGNS_SHOWN);
    }
    text + "\n"
}

/// The settings of a design as cells of a table.
fn settings(report: &StudyReport, design: &DesignRecord) -> String {
    let cell = |parameter: &ParameterFacts| match design.settings.get(&parameter.name) {
        Some(Setting::Number(number)) => format_value(*number),
        Some(Setting::Choice(name)) => name.clone(),
        Some(Setting::AsInScene) | None => match parameter.nominal {
            Setting::Number(number) => format!("{} (scene)", format_value(number)),
            Setting::Choice(_) | Setting::AsInScene => "as in the scene".into(),
        },
    };
    report.facts.parameters.iter().map(cell).collect::<Vec<_>>().join(" | ")
}

fn parameters(report: &StudyReport) -> String {
    let mut text =
        "## Parameters\n\n| parameter | values | keys of the scene |\n|---|---|---|\n".to_owned();
    for parameter in &report.facts.parameters {
        let keys: Vec<String> = parameter.keys.iter().map(|key| format!("`{key}`")).collect();
        let values = domain_words(&parameter.domain);
        _ = writeln!(text, "| {} | {values} | {} |", parameter.label(), keys.join(", "));
    }
    text + "\n"
}

/// What a parameter may be set to, in words.
fn domain_words(domain: &Domain) -> String {
    match domain {
        Domain::Levels(levels) => {
            let word = |level: &Setting| match level {
                Setting::Number(number) => format_value(*number),
                Setting::Choice(name) => name.clone(),
                Setting::AsInScene => "as in the scene".into(),
            };
            levels.iter().map(word).collect::<Vec<_>>().join(", ")
        }
        Domain::Uniform { from, to } => {
            format!("uniform from {} to {}", format_value(*from), format_value(*to))
        }
        Domain::Normal { mean, std_dev, from, to } => {
            let mut text = format!(
                "normal, mean {}, standard deviation {}",
                format_value(*mean),
                format_value(*std_dev)
            );
            if let Some(from) = from {
                _ = write!(text, ", not below {}", format_value(*from));
            }
            if let Some(to) = to {
                _ = write!(text, ", not above {}", format_value(*to));
            }
            text
        }
        Domain::Listed => "by the table".into(),
    }
}

/// Remarks of the designs, each told once.
fn remarks(report: &StudyReport) -> String {
    let mut told: Vec<(&str, Vec<usize>)> = Vec::new();
    for design in &report.designs {
        for warning in design.result().into_iter().flat_map(|result| &result.warnings) {
            match told.iter_mut().find(|(text, _)| text == warning) {
                Some((_, designs)) => designs.push(design.design),
                None => told.push((warning, vec![design.design])),
            }
        }
    }
    if told.is_empty() {
        return String::new();
    }
    let mut text = "## Remarks\n\n".to_owned();
    for (warning, designs) in told {
        let which = match designs.as_slice() {
            all if all.len() == report.designs.len() => "all designs".to_owned(),
            [one] => format!("design {one}"),
            [first, .., last] => format!("{} designs from {first} to {last}", designs.len()),
            [] => continue,
        };
        _ = writeln!(text, "- {which}: {warning}");
    }
    text + "\n"
}

fn run(report: &StudyReport) -> String {
    let facts = &report.facts;
    let plan = match facts.plan {
        PlanFacts::Grid => "grid of all combinations".to_owned(),
        PlanFacts::OneAtATime => "one parameter at a time".into(),
        PlanFacts::List => "designs of a table".into(),
        PlanFacts::LatinHypercube(seed) => format!("Latin hypercube, seed {seed}"),
        PlanFacts::Sobol(seed) => format!("scrambled Sobol sequence, seed {seed}"),
        PlanFacts::Tolerance(seed) => format!("independent random samples, seed {seed}"),
    };
    let mut lines = vec![
        format!("study `{}`, hash {}", facts.name, facts.hash),
        format!("plan: {plan}, {} designs", facts.designs),
        format!(
            "lumiduct {}, estimator {}, seed {} for all designs",
            facts.version, facts.estimator, facts.seed
        ),
        format!("each design was asked for {}", facts.asked),
    ];
    for own in &report.analysis.sharpness {
        lines.push(format!(
            "differences of {} between neighbouring designs have errors {} times smaller than with random numbers of \
             their own (median of {} pairs)",
            own.measure,
            format_value(own.factor),
            own.pairs
        ));
    }
    if !facts.overrides.is_empty() {
        lines.push(format!("set for all designs: {}", facts.overrides.join(", ")));
    }
    let list: String = lines.iter().map(|line| format!("- {line}\n")).collect();
    format!("## Run\n\n{list}")
}
