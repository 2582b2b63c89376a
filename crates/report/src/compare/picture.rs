//! The errors of a comparison against time, as a picture.

use crate::compare::cells::TrueCells;
use crate::compare::comparison::Comparison;
use crate::compare::errors::{ErrorRow, rows};
use crate::png::{
    AxisScale, ErrorForm, LinePlot, Look, PlotSeries, SeriesForm, SeriesPoint, stacked_plots,
};
use lumiduct_base::error::Result;

const X_LABEL: &str = "time of a run in s";

/// Errors of the flux against time, one colour for each estimator, and below them errors per cell where they are known.
pub(crate) fn picture(comparison: &Comparison) -> Result<Vec<u8>> {
    let mut plots = vec![flux_plot(comparison)];
    if let Some(cells) = &comparison.truth.cells {
        plots.push(cell_plot(comparison, cells));
    }
    stacked_plots(&plots)
}

/// Total error of the flux; its bias dashed where it is more than noise.
fn flux_plot(comparison: &Comparison) -> LinePlot {
    let Comparison { truth, contestants, .. } = comparison;
    let relative = |error: f64| error / truth.value.abs();
    let mut series = Vec::new();
    for (number, contestant) in contestants.iter().enumerate() {
        let rows = rows(contestant, truth);
        series.extend(curve(number, &contestant.label, &rows, |row| relative(row.total_error)));
        let bias =
            |row: &ErrorRow| if row.is_biased() { relative(row.bias.abs()) } else { f64::NAN };
        series.push(line("", Look::Dashed(number), &rows, bias));
    }
    series.extend(bound(&series, relative(truth.std_error)));
    LinePlot {
        title: format!("{}: {}", comparison.title, comparison.measure),
        subtitle: format!(
            "total error of a run, from {} runs of each estimator; dashed: its bias, where beyond two standard errors",
            comparison.repetitions
        ),
        x_label: X_LABEL.into(),
        y_label: "error over the truth".into(),
        scale: AxisScale::Log,
        series,
    }
}

/// Error per cell.
fn cell_plot(comparison: &Comparison, cells: &TrueCells) -> LinePlot {
    let Comparison { truth, contestants, .. } = comparison;
    let mut series = Vec::new();
    for (number, contestant) in contestants.iter().enumerate() {
        let rows = rows(contestant, truth);
        let error = |row: &ErrorRow| row.cell_error.unwrap_or(f64::NAN);
        series.extend(curve(number, &contestant.label, &rows, error));
    }
    series.extend(bound(&series, cells.own_error()));
    LinePlot {
        title: format!("{}: {} cells of {}", comparison.title, comparison.cells, comparison.sensor),
        subtitle: format!(
            "error per cell of a run, from {} runs of each estimator",
            comparison.repetitions
        ),
        x_label: X_LABEL.into(),
        y_label: "error per cell".into(),
        scale: AxisScale::Log,
        series,
    }
}

/// A line with dots, in the colour of a number.
fn curve(
    number: usize,
    name: &str,
    rows: &[ErrorRow],
    error: impl Fn(&ErrorRow) -> f64,
) -> [PlotSeries; 2] {
    let line = line(name, Look::Solid(number), rows, error);
    let dots = PlotSeries { name: String::new(), form: SeriesForm::Dots, ..line.clone() };
    [line, dots]
}

fn line(name: &str, look: Look, rows: &[ErrorRow], error: impl Fn(&ErrorRow) -> f64) -> PlotSeries {
    PlotSeries {
        name: name.to_owned(),
        points: rows.iter().map(|row| point(row.seconds, error(row))).collect(),
        form: SeriesForm::Line,
        errors: ErrorForm::Hidden,
        look,
    }
}

/// The error of the truth, over the times of other curves.
fn bound(series: &[PlotSeries], error: f64) -> Option<PlotSeries> {
    let times = || series.iter().flat_map(|one| &one.points).map(|point| point.x);
    let (earliest, latest) = (times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max));
    (error > 0.0 && earliest < latest).then(|| PlotSeries {
        name: "error of the truth".into(),
        points: [earliest, latest].map(|seconds| point(seconds, error)).into(),
        form: SeriesForm::Line,
        errors: ErrorForm::Hidden,
        look: Look::Bound,
    })
}

fn point(x: f64, y: f64) -> SeriesPoint {
    SeriesPoint { x, y, std_error: 0.0 }
}
