//! A truth from a table: of the measures of a report, or of a comparison, which has its cells.

use crate::pipeline::compare::bench::Bench;
use lumiduct_base::error::{Error, Result};
use lumiduct_report::{TrueCells, Truth, cell_prefix};
use std::fs::File;
use std::path::Path;

/// The truth of the measure that is compared, and of the cells if the table has them.
pub(super) fn read(path: &Path, bench: &Bench<'_>) -> Result<Truth> {
    let unusable = |why: String| Error::Usage(format!("--truth-file {}: {why}", path.display()));
    let file = File::open(path).map_err(|reason| unusable(format!("cannot be read: {reason}")))?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).flexible(true).from_reader(file);
    let header = reader.headers().map_err(|reason| unusable(reason.to_string()))?.clone();
    let column = |name: &str| {
        let place = header.iter().position(|column| column == name);
        place.ok_or_else(|| unusable(format!("there is no column `{name}`")))
    };
    let (name, value, std_error) = (column("measure")?, column("value")?, column("std_error")?);
    let (measure, prefix) = (bench.measure(), cell_prefix(bench.sensor()));
    let mut flux = None;
    let mut cells = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|reason| unusable(reason.to_string()))?;
        let number = |place: usize| -> Result<f64> {
            let text = record.get(place).unwrap_or_default();
            text.parse().map_err(|_| unusable(format!("`{text}` is not a number")))
        };
        let row = record.get(name).unwrap_or_default();
        if row == measure && flux.is_none() {
            flux = Some((number(value)?, number(std_error)?));
        } else if let Some(cell) = row.strip_prefix(&prefix) {
            let next = cells.len();
            if cell.parse() != Ok(next) {
                return Err(unusable(format!("`{row}` is where `{prefix}{next}` belongs")));
            }
            cells.push((number(value)?, number(std_error)?));
        }
    }
    let Some((value, std_error)) = flux else {
        return Err(unusable(format!("there is no measure `{measure}`")));
    };
    let cells = true_cells(cells, bench).map_err(unusable)?;
    Ok(Truth { value, std_error, origin: format!("from `{}`", path.display()), cells })
}

/// The cells of a table, unless it has none or the sensor has only one; or why they are none of the sensor.
fn true_cells(
    cells: Vec<(f64, f64)>,
    bench: &Bench<'_>,
) -> std::result::Result<Option<TrueCells>, String> {
    let (found, expected, sensor) = (cells.len(), bench.cells(), bench.sensor());
    if found == 0 || expected == 1 {
        return Ok(None);
    }
    if found != expected {
        return Err(format!(
            "it has {found} cells of `{sensor}`, which has {expected}: give a truth with the same cells, or only its              flux with --truth"
        ));
    }
    TrueCells::new(cells).map(Some).ok_or_else(|| {
        format!("the cells of `{sensor}` are dark, or have values or errors that are no numbers")
    })
}
