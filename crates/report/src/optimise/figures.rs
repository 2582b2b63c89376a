//! The pictures of an optimisation: light along the face, lengths along the face, and the history.

use crate::OutputFile;
use crate::optimise::tables::light_columns;
use crate::optimise::{JudgedStep, OptimisationReport, Purpose};
use crate::png::{
    AxisScale, ErrorForm, LinePlot, Look, PlotSeries, SeriesForm, SeriesPoint, line_plot,
};
use lumiduct_base::error::Result;

const ALONG: &str = "position along the face in mm";

/// A picture.
pub(super) struct OptimisationFigure {
    /// Its file.
    file: &'static str,
    /// Its contents.
    pub(super) plot: LinePlot,
    /// Unit of its values.
    pub(super) unit: String,
}

impl OptimisationFigure {
    /// Name of its file.
    pub(super) fn name(&self) -> String {
        self.file.to_owned()
    }

    /// The picture as a file.
    pub(super) fn file(&self) -> Result<OutputFile> {
        Ok(OutputFile { name: self.name(), bytes: line_plot(&self.plot)? })
    }
}

/// All pictures.
pub(super) fn figures(report: &OptimisationReport) -> Vec<OptimisationFigure> {
    vec![
        OptimisationFigure { file: "light.png", plot: light(report), unit: report.unit.clone() },
        OptimisationFigure { file: "lengths.png", plot: lengths(report), unit: "mm".into() },
        OptimisationFigure { file: "history.png", plot: history(report), unit: "1".into() },
    ]
}

/// Light of the zones before and after; of the checks where there are any.
fn light(report: &OptimisationReport) -> LinePlot {
    let all = light_columns(report);
    let is_check = |own: &(String, &JudgedStep)| own.1.measured.purpose != Purpose::Search;
    let any = all.iter().any(is_check);
    let shown = all.into_iter().filter(|own| is_check(own) == any);
    let curve = |(name, step): (String, &JudgedStep)| {
        let pairs = report.zones.iter().zip(&step.measured.zones);
        let points = pairs
            .map(|(zone, light)| SeriesPoint {
                x: zone.along_mm,
                y: light.value,
                std_error: light.std_error,
            })
            .collect();
        PlotSeries::new(name, points, SeriesForm::Line, ErrorForm::Bars)
    };
    let mut series: Vec<PlotSeries> = shown.map(curve).collect();
    series.extend(wanted(report));
    let found = if any { "checked with fresh random numbers" } else { "as found in the search" };
    LinePlot {
        title: format!("{} along the face", report.quantity),
        subtitle: format!("sensor {}, {found}; bars: one standard error", report.sensor),
        x_label: ALONG.into(),
        y_label: format!("{} in {}", report.quantity, report.unit),
        scale: AxisScale::Linear,
        series,
    }
}

/// The wanted light, at the mean of the result.
fn wanted(report: &OptimisationReport) -> Option<PlotSeries> {
    let best = report.best_step()?;
    let pairs = report.zones.iter().zip(&best.measured.zones);
    let counted: Vec<(f64, f64)> = pairs
        .filter(|(zone, _)| zone.wanted > 0.0)
        .map(|(zone, light)| (zone.wanted, light.value))
        .collect();
    let mean = |sum: f64| sum / counted.len().max(1) as f64;
    let factor = mean(counted.iter().map(|(wanted, light)| light / wanted).sum());
    let points = report
        .zones
        .iter()
        .filter(|zone| zone.wanted > 0.0)
        .map(|zone| SeriesPoint { x: zone.along_mm, y: factor * zone.wanted, std_error: 0.0 })
        .collect();
    Some(PlotSeries {
        name: "wanted".into(),
        points,
        form: SeriesForm::Line,
        errors: ErrorForm::Hidden,
        look: Look::Bound,
    })
}

/// Lengths at the points of the law, before and after.
fn lengths(report: &OptimisationReport) -> LinePlot {
    let curve = |(name, step): (&str, &JudgedStep)| {
        let pairs = report.points_mm.iter().zip(&step.measured.values);
        let points = pairs.map(|(x, y)| SeriesPoint { x: *x, y: *y, std_error: 0.0 }).collect();
        PlotSeries::new(name, points, SeriesForm::Line, ErrorForm::Hidden)
    };
    let pairs = [("before", report.steps.first()), ("after", report.best_step())];
    let pairs = pairs.into_iter().filter_map(|(name, own)| Some((name, own?)));
    LinePlot {
        title: format!("{} of {} along the face", report.length, report.pattern),
        subtitle: "at the points of the law".into(),
        x_label: ALONG.into(),
        y_label: format!("{} in mm", report.length),
        scale: AxisScale::Linear,
        series: pairs.map(curve).collect(),
    }
}

/// Ratio, deviation and efficiency by step.
fn history(report: &OptimisationReport) -> LinePlot {
    let curve = |name: &str, read: &dyn Fn(&JudgedStep) -> crate::optimise::Uncertain| {
        let points = report
            .steps
            .iter()
            .map(|own| {
                let read = read(own);
                let x = own.measured.step as f64;
                SeriesPoint { x, y: read.value, std_error: read.std_error }
            })
            .collect();
        PlotSeries::new(name, points, SeriesForm::Line, ErrorForm::Bars)
    };
    let goal = PlotSeries {
        name: "target".into(),
        points: [1.0, report.steps.len().max(2) as f64]
            .map(|x| SeriesPoint { x, y: report.goal, std_error: 0.0 })
            .into(),
        form: SeriesForm::Line,
        errors: ErrorForm::Hidden,
        look: Look::Bound,
    };
    LinePlot {
        title: "Steps of the search".into(),
        subtitle: "bars: one standard error; the first step is the scene as it was".into(),
        x_label: "step".into(),
        y_label: "ratio, 1".into(),
        scale: AxisScale::Linear,
        series: vec![
            curve("smallest over largest", &|own| own.misfit.min_over_max),
            curve("deviation beyond noise", &|own| own.misfit.deviation),
            curve("efficiency", &|own| own.measured.efficiency),
            goal,
        ],
    }
}
