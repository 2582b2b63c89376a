//! `study.html`: the results of a study for a browser, in one file with nothing to load.

use crate::html::data::chart;
use crate::html::frame::{Page, render};
use crate::html::masthead;
use crate::page::{Block, PagePart, Plots, Standing};
use crate::png::{
    AxisScale, ErrorForm, LinePlot, PlotSeries, ScatterMatrix, SeriesForm, SeriesPoint,
};
use crate::study::StudyReport;
use crate::study::contents::{parts, verdict};
use crate::study::figure::{Figure, StudyDrawing};
use lumiduct_base::error::Result;

/// Tables with more rows than this are folded away.
const ROWS_SHOWN: usize = 60;

/// The whole page.
pub(super) fn html(report: &StudyReport, figures: &[Figure]) -> Result<String> {
    let mut plots = Plots::default();
    let facts = &report.facts;
    let [before, after] = parts(report).map(|parts| parts.into_iter().map(folded));
    let drawn: Vec<Block> =
        figures.iter().flat_map(|figure| blocks(report, figure, &mut plots)).collect();
    // Where all parameters are choices there is nothing to plot.
    let pictures = (!drawn.is_empty()).then(|| PagePart { title: "Plots".into(), blocks: drawn });
    let page = Page {
        title: facts.title.clone(),
        masthead: masthead(facts.whole_project().as_ref()),
        description: facts.description.as_ref().map(|text| text.trim().to_owned()),
        verdict: verdict(report),
        standing: match (facts.checks.is_empty(), report.is_good()) {
            (_, false) => Standing::Bad,
            (true, true) => Standing::Open,
            (false, true) => Standing::Good,
        },
        parts: before.chain(pictures).chain(after).collect(),
        footer: format!("lumiduct {}, study {}", facts.version, facts.name),
    };
    render(&page, &plots)
}

/// Folds long tables away.
fn folded(mut part: PagePart) -> PagePart {
    for block in &mut part.blocks {
        if let Block::Table { rows, folded, .. } = block
            && rows.len() > ROWS_SHOWN
        {
            *folded = Some(format!("{} rows", rows.len()));
        }
    }
    part
}

fn blocks(report: &StudyReport, figure: &Figure, plots: &mut Plots) -> Vec<Block> {
    let picture = Some(figure.file.clone());
    match &figure.drawing {
        StudyDrawing::Curves(plot, unit) => {
            vec![plots.add(figure.label.clone(), chart(plot, unit), picture)]
        }
        // Choices have no place on an axis: the table of main effects shows the same.
        StudyDrawing::Bars(_) => Vec::new(),
        StudyDrawing::Scatter(matrix) => {
            let pairs = scatter_plots(report, matrix).into_iter();
            pairs
                .map(|(plot, unit)| plots.add(plot.title.clone(), chart(&plot, &unit), None))
                .collect()
        }
    }
}

/// Every measure against every parameter that is a number, a dot for each design, and the unit of the measure.
fn scatter_plots(report: &StudyReport, matrix: &ScatterMatrix) -> Vec<(LinePlot, String)> {
    let measures = &report.facts.measures;
    let (parameters, found) = matrix.columns.split_at(matrix.columns.len() - measures.len());
    let mut plots = Vec::new();
    for (measure, values) in measures.iter().zip(found) {
        for parameter in parameters {
            let series = |kind: usize| {
                let designs = report.designs.iter().enumerate();
                let points = designs
                    .filter(|(place, _)| matrix.kind_of[*place] == kind)
                    .map(|(place, design)| SeriesPoint {
                        x: parameter.values[place],
                        y: values.values[place],
                        std_error: design.measure(measure).map_or(0.0, |own| own.total_error()),
                    })
                    .filter(|point| point.x.is_finite() && point.y.is_finite())
                    .collect();
                let name = &matrix.kinds[kind];
                PlotSeries::new(name, points, SeriesForm::Dots, ErrorForm::Bars)
            };
            let kinds = (0..matrix.kinds.len()).map(series);
            let plot = LinePlot {
                title: format!("{measure} against {}", parameter.label),
                subtitle: String::new(),
                x_label: parameter.label.clone(),
                y_label: values.label.clone(),
                scale: AxisScale::Linear,
                series: kinds.filter(|series| !series.points.is_empty()).collect(),
            };
            plots.push((plot, report.unit(measure).to_owned()));
        }
    }
    plots
}
