//! Tables for spreadsheets: the measures, and each map and intensity distribution as a matrix.
//!
//! They begin with a UTF-8 byte-order mark, without which Excel misreads units such as `mm²`. All
//! other tables have none; this program reads both.

use crate::cell_grid::CellGrid;
use crate::csv::{intensity_name, map_name, table};
use crate::{OutputFile, Report};
use lumiduct_base::error::Result;

/// First character of a UTF-8 file for a spreadsheet.
const BYTE_ORDER_MARK: &str = "\u{feff}";

/// All tables for spreadsheets of a report. A map of a single cell has no matrix.
pub(crate) fn files(report: &Report) -> Result<Vec<OutputFile>> {
    let measures = &report.measures;
    let mut files = vec![values(report)?];
    for map in measures.maps.iter().filter(|map| map.values.len() > 1) {
        files.push(matrix(&map_name(map), &map.into())?);
    }
    for table in measures.intensities.iter().filter(|table| table.values.len() > 1) {
        files.push(matrix(&intensity_name(table), &table.into())?);
    }
    Ok(files)
}

/// Every measure with its error and remarks.
fn values(report: &Report) -> Result<OutputFile> {
    let rows = report.measures.values.iter().map(|(name, measure)| {
        let bias = measure.bias.map_or(String::new(), |bias| bias.to_string());
        let [value, std_error] =
            [measure.value, measure.std_error].map(|number| number.to_string());
        let (status, estimator) = (measure.status.name(), measure.estimator.name());
        let words = [measure.unit.as_str(), status, estimator].map(str::to_owned);
        [name.clone(), value, std_error, bias].into_iter().chain(words).collect()
    });
    let header = ["measure", "value", "std_error", "bias", "unit", "status", "estimator"];
    Ok(marked(table("measures.csv".into(), &header, rows)?))
}

fn marked(mut file: OutputFile) -> OutputFile {
    file.bytes.splice(..0, BYTE_ORDER_MARK.bytes());
    file
}

/// Values in rows and columns; the cell edges fill two columns on the left and two rows at the top.
fn matrix(name: &str, grid: &CellGrid<'_>) -> Result<OutputFile> {
    let CellGrid { kind, x, y, values, .. } = grid;
    let cells = |label: [String; 2], edges: &[f64]| -> Vec<String> {
        label.into_iter().chain(edges.iter().map(f64::to_string)).collect()
    };
    let label = |axis: usize, end: &str| {
        format!("{} {end} in {}", kind.heads[axis], kind.places.units[axis])
    };
    let (count, columns) = values.dim();
    let quantity = format!("{} in {}", grid.quantity, grid.unit);
    let header = cells([quantity, label(0, "from")], &x[..columns]);
    let lower = cells([String::new(), label(0, "to")], &x[1..]);
    let mut labels = vec![label(1, "from"), label(1, "to")];
    labels.resize(columns + 2, String::new());
    let row = |place: usize| -> Vec<String> {
        let row = if kind.is_rising { count - 1 - place } else { place };
        let cell = |value: &f64| if value.is_finite() { value.to_string() } else { String::new() };
        let edges = y[row..row + 2].iter().map(f64::to_string);
        edges.chain(values.row(row).into_iter().map(cell)).collect()
    };
    let rows = [lower, labels].into_iter().chain((0..count).map(row));
    Ok(marked(table(format!("{name}.matrix.csv"), &header, rows)?))
}
