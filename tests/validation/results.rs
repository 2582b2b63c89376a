//! What was traced, as the page prints it: from findings, or from a page that was written before.

use crate::page::COARSE;
use crate::run::{Expected, Finding, Row};

/// What the page prints of all values.
#[derive(Debug, Clone, Default)]
pub(crate) struct Results {
    /// One for each row, in their order.
    pub(crate) cells: Vec<Cells>,
    /// The sentence on the deviations of all runs.
    pub(crate) deviations: String,
}

/// What the page prints of one value.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Cells {
    /// Value with its standard error and unit.
    pub(crate) ours: String,
    /// Deviation from the reference, in standard errors.
    pub(crate) deviation: String,
    /// Paths traced, in millions.
    pub(crate) paths: String,
    /// Relative error, for values known less well than their class asks.
    pub(crate) error: String,
}

impl Results {
    /// Those of all runs.
    pub(crate) fn of(findings: &[&Finding]) -> Self {
        let cells = findings.iter().map(|finding| Cells::of(finding)).collect();
        Self { cells, deviations: sentence(&deviations(findings)) }
    }

    /// Those that a page gives for these rows; nothing where it gives none.
    pub(crate) fn read(page: &str, rows: &[Row]) -> Self {
        let (traced, coarse) = page.split_once(COARSE).unwrap_or((page, ""));
        let coarse = coarse.split("\n## ").next().unwrap_or_default();
        let errors = |row: &Row| {
            let start = format!("| {} | {} | ", row.case, row.name);
            let rest = coarse.lines().find_map(|line| line.strip_prefix(&start));
            rest.and_then(|rest| rest.split(" | ").next()).unwrap_or_default().to_owned()
        };
        let mut lines = traced.lines().filter(|line| line.starts_with("| ["));
        let cells = |row: &Row| {
            let line: Vec<&str> = lines.next().unwrap_or_default().split(" | ").collect();
            let cell = |place: usize| line.get(place).copied().unwrap_or_default().to_owned();
            Cells { ours: cell(4), deviation: cell(5), paths: cell(6), error: errors(row) }
        };
        let deviations = traced.lines().find(|line| line.starts_with(DEVIATIONS));
        Self {
            cells: rows.iter().map(cells).collect(),
            deviations: deviations.unwrap_or_default().to_owned(),
        }
    }

    /// Replaces those of the rows that were traced.
    pub(crate) fn replace(&mut self, rows: &[Row], findings: &[&Finding]) {
        for (row, cells) in rows.iter().zip(&mut self.cells) {
            let is_of = |finding: &&&Finding| {
                (&finding.row.case, &finding.row.name) == (&row.case, &row.name)
            };
            if let Some(finding) = findings.iter().find(is_of) {
                *cells = Cells::of(finding);
            }
        }
    }
}

impl Cells {
    fn of(finding: &Finding) -> Self {
        let Finding { row, ours, deviation, .. } = finding;
        let deviation = match row.expected {
            Expected::Value(_) => deviation.map_or("exact".to_owned(), |z| format!("{z:+.2}")),
            Expected::Most(_) => String::new(),
        };
        Self {
            ours: ours.to_string(),
            deviation,
            paths: format!("{:.1} M", ours.paths as f64 / 1e6),
            error: match row.why.is_empty() {
                true => String::new(),
                false => format!("{:.2} %", 100.0 * ours.relative_error()),
            },
        }
    }
}

/// Deviations of independent runs, in standard errors.
pub(crate) fn deviations(findings: &[&Finding]) -> Vec<f64> {
    let first = findings.iter().filter(|finding| finding.independent);
    first.filter_map(|finding| finding.deviation).collect()
}

/// Root of the mean square; of a standard normal it is 1.
pub(crate) fn rms(deviations: &[f64]) -> f64 {
    (deviations.iter().map(|z| z * z).sum::<f64>() / deviations.len() as f64).sqrt()
}

const DEVIATIONS: &str = "Deviations of independent runs";

fn sentence(deviations: &[f64]) -> String {
    let largest = deviations.iter().fold(0.0, |most: f64, z| most.max(z.abs()));
    let beyond_two = deviations.iter().filter(|z| z.abs() > 2.0).count();
    format!(
        "{DEVIATIONS} with noise, one of each of {} runs, in standard errors: their root mean square is {:.2}, \
         the largest is {largest:.1}, and {beyond_two} are beyond 2 (for a normal distribution {:.0} are expected).",
        deviations.len(),
        rms(deviations),
        // 4.55 % of a normal distribution lie beyond two standard deviations.
        0.0455 * deviations.len() as f64,
    )
}
