//! Tables for spreadsheets: the measures, and each map and intensity distribution as a matrix.
//!
//! They begin with a UTF-8 byte-order mark, without which Excel misreads units such as `mm²`. All
//! other tables have none; this program reads both.

use crate::csv::{intensity_name, map_name, table};
use crate::{OutputFile, Report};
use lumiduct_base::error::Result;
use lumiduct_core::measure::{IntensityTable, MapAxes, SensorMap};
use ndarray::Array2;

/// First character of a UTF-8 file for a spreadsheet.
const BYTE_ORDER_MARK: &str = "\u{feff}";

/// All tables for spreadsheets of a report. A map of a single cell has no matrix.
pub(crate) fn files(report: &Report) -> Result<Vec<OutputFile>> {
    let measures = &report.measures;
    let mut files = vec![values(report)?];
    let matrices = measures.maps.iter().map(map_matrix);
    for matrix in matrices.chain(measures.intensities.iter().map(intensity_matrix)) {
        if matrix.values.len() > 1 {
            files.push(matrix.file()?);
        }
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
struct SpreadsheetMatrix<'a> {
    /// File name without its extension.
    name: String,
    /// What is shown, with its unit: `illuminance in lx`.
    quantity: String,
    /// Coordinate of the rows, with its unit: `v`, `mm`.
    rows: [&'static str; 2],
    row_edges: &'a [f64],
    /// The same of the columns.
    columns: [&'static str; 2],
    column_edges: &'a [f64],
    /// Rows by columns; NaN where there is none.
    values: &'a Array2<f64>,
    /// Which row is on top.
    top: Top,
}

/// Which row of a matrix is on top.
#[derive(Clone, Copy)]
enum Top {
    /// That of the greatest values, as in a picture.
    Last,
    /// That of the least values.
    First,
}

fn map_matrix(map: &SensorMap) -> SpreadsheetMatrix<'_> {
    let (rows, row_edges, columns, column_edges, top) = match &map.axes {
        MapAxes::Cartesian { u_mm, v_mm } => (["v", "mm"], v_mm, ["u", "mm"], u_mm, Top::Last),
        MapAxes::Angular { u_deg, v_deg } => {
            (["up", "deg"], v_deg, ["right", "deg"], u_deg, Top::Last)
        }
        MapAxes::Polar { radius_mm, sector_deg } => {
            (["radius", "mm"], radius_mm, ["sector", "deg"], sector_deg, Top::First)
        }
    };
    let name = map_name(map);
    let quantity = format!("{} in {}", map.quantity, map.unit);
    SpreadsheetMatrix {
        name,
        quantity,
        rows,
        row_edges,
        columns,
        column_edges,
        values: &map.values,
        top,
    }
}

fn intensity_matrix(intensity: &IntensityTable) -> SpreadsheetMatrix<'_> {
    SpreadsheetMatrix {
        name: intensity_name(intensity),
        quantity: format!("intensity in {}", intensity.unit),
        rows: ["gamma", "deg"],
        row_edges: &intensity.gamma_deg,
        columns: ["c", "deg"],
        column_edges: &intensity.c_deg,
        values: &intensity.values,
        top: Top::First,
    }
}

impl SpreadsheetMatrix<'_> {
    fn file(&self) -> Result<OutputFile> {
        let cells = |label: [String; 2], edges: &[f64]| -> Vec<String> {
            label.into_iter().chain(edges.iter().map(f64::to_string)).collect()
        };
        let [from, to] = ["from", "to"]
            .map(|end| [self.rows, self.columns].map(|[of, unit]| format!("{of} {end} in {unit}")));
        let columns = self.values.ncols();
        let header = cells([self.quantity.clone(), from[1].clone()], &self.column_edges[..columns]);
        let lower = cells([String::new(), to[1].clone()], &self.column_edges[1..]);
        let mut labels = vec![from[0].clone(), to[0].clone()];
        labels.resize(columns + 2, String::new());
        let row = |row: usize| -> Vec<String> {
            let values = self.values.row(row).into_iter().copied();
            let cell =
                |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
            let edges = self.row_edges[row..row + 2].iter().map(f64::to_string);
            edges.chain(values.map(cell)).collect()
        };
        let count = self.values.nrows();
        let order = (0..count).map(|place| match self.top {
            Top::Last => count - 1 - place,
            Top::First => place,
        });
        let rows = [lower, labels].into_iter().chain(order.map(row));
        Ok(marked(table(format!("{}.matrix.csv", self.name), &header, rows)?))
    }
}
