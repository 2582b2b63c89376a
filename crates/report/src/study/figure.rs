//! A picture of a study.

use crate::OutputFile;
use crate::png::{BarChart, LinePlot, ScatterMatrix, bar_chart, line_plot, scatter_matrix};
use crate::study::StudyReport;
use lumiduct_base::error::Result;

/// A picture of a study.
pub(super) struct Figure {
    /// Its file.
    pub(super) file: String,
    /// What it shows, in words.
    pub(super) label: String,
    /// Its contents.
    pub(super) drawing: StudyDrawing,
}

/// Contents of a picture.
pub(super) enum StudyDrawing {
    /// Curves; the unit is that of their values.
    Curves(LinePlot, String),
    /// Bars.
    Bars(BarChart),
    /// Everything against everything.
    Scatter(ScatterMatrix),
}

impl Figure {
    /// The picture as a file.
    pub(super) fn file(&self) -> Result<OutputFile> {
        let bytes = match &self.drawing {
            StudyDrawing::Curves(plot, _) => line_plot(plot)?,
            StudyDrawing::Bars(chart) => bar_chart(chart)?,
            StudyDrawing::Scatter(matrix) => scatter_matrix(matrix)?,
        };
        Ok(OutputFile { name: self.file.clone(), bytes })
    }
}

/// The label of a measure with its unit.
pub(super) fn measure_label(report: &StudyReport, measure: &str) -> String {
    match report.unit(measure) {
        "1" => measure.to_owned(),
        unit => format!("{measure} in {unit}"),
    }
}
