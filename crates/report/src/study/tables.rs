//! `study.csv`, and `production.csv` of a search: a row for each design, units in the header.

use crate::OutputFile;
use crate::csv::table;
use crate::study::{Analysis, DesignOutcome, DesignRecord, StudyReport};
use crate::words::{numbered, outcome_word};
use lumiduct_base::error::Result;
use lumiduct_input::{DESIGN_COLUMN, OTHER_COLUMNS};

/// All tables of a study.
pub(super) fn files(report: &StudyReport) -> Result<Vec<OutputFile>> {
    let made = report.production.iter().map(|made| designs(made, "production.csv"));
    [designs(report, "study.csv")].into_iter().chain(made).collect()
}

fn designs(report: &StudyReport, name: &str) -> Result<OutputFile> {
    let facts = &report.facts;
    let mut header = vec![DESIGN_COLUMN.to_owned()];
    header.extend(facts.parameters.iter().map(|parameter| parameter.column()));
    for measure in &facts.measures {
        let unit = match report.unit(measure) {
            "1" => String::new(),
            unit => format!("_{unit}"),
        };
        header.extend(["", ".std_error", ".bias"].map(|part| format!("{measure}{part}{unit}")));
    }
    let checked: Vec<&str> = facts.checks.iter().map(|check| check.measure.as_str()).collect();
    header.extend(numbered(&checked).into_iter().map(|name| format!("check {name}")));
    header.extend(OTHER_COLUMNS.map(str::to_owned));
    let names: Vec<&str> = header.iter().map(String::as_str).collect();
    table(name.to_owned(), &names, report.designs.iter().map(|design| row(report, design)))
}

fn row(report: &StudyReport, design: &DesignRecord) -> Vec<String> {
    let facts = &report.facts;
    let mut cells = vec![design.design.to_string()];
    for parameter in &facts.parameters {
        cells.push(parameter.setting_in(design).to_string());
    }
    for measure in &facts.measures {
        let found = design.measure(measure);
        let number =
            |number: Option<f64>| number.map_or(String::new(), |number| number.to_string());
        cells.push(number(found.map(|found| found.value)));
        cells.push(number(found.map(|found| found.std_error)));
        cells.push(number(found.and_then(|found| found.bias)));
    }
    let result = design.outcome.result();
    for place in 0..facts.checks.len() {
        let verdict = result.and_then(|result| result.checks.get(place));
        cells.push(verdict.map_or("", |own| outcome_word(own.verdict.outcome)).to_owned());
    }
    let Analysis { ranked, front, .. } = &report.analysis;
    let mut order = ranked.iter().map(|own| own.design).chain(front.iter().map(|own| own.design));
    let rank = order.position(|number| number == design.design);
    cells.push(rank.map_or(String::new(), |rank| (rank + 1).to_string()));
    cells.push(result.map_or(String::new(), |result| result.paths.to_string()));
    cells.push(result.map_or("", |result| result.stopped.as_str()).to_owned());
    cells.push(match &design.outcome {
        DesignOutcome::Done(_) => String::new(),
        DesignOutcome::Failed(reason) => reason.clone(),
    });
    cells
}
