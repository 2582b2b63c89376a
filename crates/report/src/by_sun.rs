//! Transmission by the elevation of the sun: a table, a plot and numbers, for scenes with several suns.
//!
//! This is the tube transmission efficiency of CIE 173:2012: flux that leaves a tube over flux that
//! enters it. Skies of the scene are listed with the suns.

use crate::csv::table;
use crate::png::{
    AxisScale, ErrorForm, LinePlot, Look, PlotSeries, SeriesForm, SeriesPoint, line_plot,
};
use crate::words::quantity;
use crate::{OutputFile, Pictures, Report};
use lumiduct_base::error::Result;
use lumiduct_core::measure::Measure;

/// Least number of suns for a table.
const SEVERAL: usize = 2;

/// A sun or another source.
struct SunLine<'a> {
    source: &'a str,
    /// Elevation of a sun, deg.
    elevation: Option<f64>,
    transmission: &'a Measure,
}

/// Suns from the zenith down, then all other sources; empty unless there are several suns and an
/// entry port.
fn lines<'a>(report: &'a Report, sensor: &str) -> Vec<SunLine<'a>> {
    let measures = &report.measures;
    let prefix = format!("{sensor}.transmission.from.");
    let mut lines: Vec<SunLine<'a>> = measures
        .values
        .iter()
        .filter_map(|(name, transmission)| {
            let source = name.strip_prefix(&prefix)?;
            let elevation = measures.sun_elevations_deg.get(source).copied();
            Some(SunLine { source, elevation, transmission })
        })
        .collect();
    if lines.iter().filter(|line| line.elevation.is_some()).count() < SEVERAL {
        return Vec::new();
    }
    let from_zenith = |line: &SunLine<'_>| -line.elevation.unwrap_or(f64::NEG_INFINITY);
    lines.sort_by(|a, b| from_zenith(a).total_cmp(&from_zenith(b)));
    lines
}

/// Numbers and a plot for each sensor that has them.
pub(crate) fn files(report: &Report, pictures: Pictures) -> Result<Vec<OutputFile>> {
    let mut files = Vec::new();
    for paths in &report.measures.sensor_paths {
        let lines = lines(report, &paths.sensor);
        if !lines.is_empty() {
            files.push(numbers(&paths.sensor, &lines)?);
            match pictures {
                Pictures::Drawn => {
                    let name = format!("{}.transmission.png", paths.sensor);
                    files
                        .push(OutputFile { name, bytes: line_plot(&plot(&paths.sensor, &lines))? });
                }
                Pictures::LeftOut => {}
            }
        }
    }
    Ok(files)
}

/// Text before the rows of [`BySun`].
pub(crate) const HEAD: &str = "Transmission is the flux that leaves over the flux that enters: the tube \
    transmission efficiency of CIE 173:2012.";

/// The transmission of a sensor by the elevation of the sun.
pub(crate) struct BySun {
    /// Source, elevation and transmission.
    pub(crate) rows: Vec<[String; 3]>,
    /// The same as a plot.
    pub(crate) plot: LinePlot,
}

/// The transmission of a sensor; `None` unless there are several suns.
pub(crate) fn by_sun(report: &Report, sensor: &str) -> Option<BySun> {
    let lines = lines(report, sensor);
    let row = |SunLine { source, elevation, transmission }: &SunLine<'_>| {
        let elevation = elevation.map_or(String::new(), |degrees| format!("{degrees:.2}°"));
        [(*source).to_owned(), elevation, quantity(transmission)]
    };
    (!lines.is_empty())
        .then(|| BySun { rows: lines.iter().map(row).collect(), plot: plot(sensor, &lines) })
}

fn numbers(sensor: &str, lines: &[SunLine<'_>]) -> Result<OutputFile> {
    let rows = lines.iter().map(|SunLine { source, elevation, transmission }| {
        let elevation = elevation.map_or(String::new(), |degrees| degrees.to_string());
        let [value, error] = [transmission.value, transmission.std_error].map(|x| x.to_string());
        vec![(*source).to_owned(), elevation, value, error]
    });
    let header = ["source", "elevation_deg", "transmission", "std_error"];
    table(format!("{sensor}.transmission.csv"), &header, rows)
}

/// Suns as dots with error bars on a line, all other sources as a horizontal dashed line.
fn plot(sensor: &str, lines: &[SunLine<'_>]) -> LinePlot {
    let point = |x: f64, line: &SunLine<'_>| SeriesPoint {
        x,
        y: line.transmission.value,
        std_error: line.transmission.std_error,
    };
    let suns: Vec<SeriesPoint> =
        lines.iter().filter_map(|line| Some(point(line.elevation?, line))).collect();
    let elevations = || suns.iter().map(|sun| sun.x);
    let ends = [
        elevations().fold(f64::INFINITY, f64::min),
        elevations().fold(f64::NEG_INFINITY, f64::max),
    ];
    let others = lines.iter().filter(|line| line.elevation.is_none()).enumerate();
    let others: Vec<PlotSeries> = others
        .map(|(place, line)| PlotSeries {
            name: line.source.to_owned(),
            points: ends.map(|end| point(end, line)).to_vec(),
            form: SeriesForm::Line,
            errors: ErrorForm::Band,
            look: Look::Dashed(place + 1),
        })
        .collect();
    let curve = PlotSeries {
        name: "suns".into(),
        points: suns.clone(),
        form: SeriesForm::Line,
        errors: ErrorForm::Bars,
        look: Look::Solid(0),
    };
    let dots = PlotSeries { name: String::new(), form: SeriesForm::Dots, ..curve.clone() };
    LinePlot {
        title: format!("{sensor}: transmission by the elevation of the sun"),
        subtitle: "flux that leaves over flux that enters (CIE 173), with standard errors".into(),
        x_label: "elevation of the sun in deg".into(),
        y_label: "transmission".into(),
        scale: AxisScale::Linear,
        series: [curve, dots].into_iter().chain(others).collect(),
    }
}
