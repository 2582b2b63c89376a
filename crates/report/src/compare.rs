//! The comparison of estimators: one record, and pure functions that turn it into a page, a table and a plot.
//!
//! Errors here are actual deviations: how far runs of one length are from an independent truth. The
//! errors that runs report play no part. Times depend on the machine, so these files are outside
//! the reproducible set.

pub(crate) mod cells;
pub(crate) mod comparison;
pub(crate) mod errors;
pub(crate) mod page;
mod picture;
#[cfg(test)]
mod tests;

use crate::OutputFile;
use crate::compare::cells::TrueCells;
use crate::compare::comparison::{Comparison, Truth};
use crate::compare::errors::rows;
use crate::compare::page::page;
use crate::compare::picture::picture;
use crate::csv::table;
use lumiduct_base::error::Result;

/// How the rows of cells begin in `truth.csv`; their numbers follow, from 0.
pub fn cell_prefix(sensor: &str) -> String {
    format!("{sensor}.cell_flux.")
}

/// All files of a comparison: `compare.csv`, `compare.png`, `compare.md`, and `truth.csv` for
/// reuse.
///
/// # Errors
///
/// `Error::Output` if the picture cannot be drawn or a table cannot be written as CSV.
pub fn comparison_files(comparison: &Comparison) -> Result<Vec<OutputFile>> {
    Ok(vec![
        csv(comparison)?,
        OutputFile { name: "compare.png".into(), bytes: picture(comparison)? },
        truth_table(comparison)?,
        OutputFile::text("compare.md", page(comparison)),
    ])
}

fn csv(comparison: &Comparison) -> Result<OutputFile> {
    let unit = &comparison.unit;
    let of_unit = ["value", "std_error", "noise", "bias", "bias_std_error", "total_error"]
        .map(|name| format!("{name}_{unit}"));
    let [value, std_error, noise, bias, bias_error, total] = of_unit.each_ref().map(String::as_str);
    let header = [
        "estimator",
        "seconds",
        "segments",
        value,
        std_error,
        noise,
        bias,
        bias_error,
        total,
        "error_per_cell",
    ];
    let lines = comparison.contestants.iter().flat_map(|contestant| {
        rows(contestant, &comparison.truth).into_iter().map(|row| {
            vec![
                contestant.name.clone(),
                format!("{:.4}", row.seconds),
                format!("{:.0}", row.segments),
                row.value.to_string(),
                row.std_error.to_string(),
                row.noise.to_string(),
                row.bias.to_string(),
                row.bias_std_error.to_string(),
                row.total_error.to_string(),
                row.cell_error.map_or(String::new(), |error| error.to_string()),
            ]
        })
    });
    table("compare.csv".into(), &header, lines)
}

fn truth_table(comparison: &Comparison) -> Result<OutputFile> {
    let Truth { value, std_error, cells, .. } = &comparison.truth;
    let row = |name: String, value: f64, std_error: f64| {
        vec![name, value.to_string(), std_error.to_string(), comparison.unit.clone()]
    };
    let flux = row(comparison.measure.clone(), *value, *std_error);
    let cells = cells.iter().flat_map(TrueCells::cells).enumerate().map(|(cell, (flux, error))| {
        row(format!("{}{cell}", cell_prefix(&comparison.sensor)), *flux, *error)
    });
    let header = ["measure", "value", "std_error", "unit"];
    table("truth.csv".into(), &header, std::iter::once(flux).chain(cells))
}
