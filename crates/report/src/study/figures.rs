//! The pictures of a study and their contents.

use crate::png::{
    AxisScale, Bar, BarChart, ErrorForm, LinePlot, Look, PlotSeries, ScatterColumn, ScatterMatrix,
    SeriesForm, SeriesPoint,
};
use crate::study::edge::numbers_of;
use crate::study::figure::{Figure, StudyDrawing, measure_label};
use crate::study::front::front_figures;
use crate::study::settings::setting_word;
use crate::study::{DesignRecord, Effect, ParameterFacts, PlanFacts, StudyReport};
use lumiduct_base::number::format_value;
use lumiduct_core::measure::CheckOutcome;
use lumiduct_input::Best;

/// Most curves of a response plot; more cannot be distinguished.
const MOST_CURVES: usize = 12;
/// Approximate bins of a histogram over the square root of the number of designs.
const BINS_PER_ROOT: f64 = 1.2;

/// All pictures of a study.
pub(super) fn figures(report: &StudyReport) -> Vec<Figure> {
    let mut figures = Vec::new();
    for measure in &report.facts.measures {
        let unit = report.unit(measure).to_owned();
        if let Some(plot) = response(report, measure) {
            figures.push(Figure {
                file: format!("response.{measure}.png"),
                label: format!("response of {measure}"),
                drawing: StudyDrawing::Curves(plot, unit),
            });
        }
        if let Some(plot) = distribution(report, measure) {
            figures.push(Figure {
                file: format!("distribution.{measure}.png"),
                label: format!("distribution of {measure}"),
                drawing: StudyDrawing::Curves(plot, "1".into()),
            });
        }
    }
    figures.extend(history(report));
    figures.extend(front_figures(report));
    figures.extend(report.production.iter().flat_map(|made| production(made)));
    for effect in &report.analysis.effects {
        figures.push(Figure {
            file: format!("effect.{}.{}.png", effect.measure, effect.parameter),
            label: format!("main effect of {} on {}", effect.parameter, effect.measure),
            drawing: effect_drawing(report, effect),
        });
    }
    if report.designs.len() > 2 {
        figures.push(Figure {
            file: "scatter.png".into(),
            label: "scatter matrix of all parameters and measures".into(),
            drawing: StudyDrawing::Scatter(scatter(report)),
        });
    }
    figures
}

/// A measure over the parameter with the most levels, a curve for each setting of all others; for
/// grids and tables.
fn response(report: &StudyReport, measure: &str) -> Option<LinePlot> {
    match report.facts.plan {
        PlanFacts::Grid | PlanFacts::List => {}
        PlanFacts::OneAtATime
        | PlanFacts::LatinHypercube(_)
        | PlanFacts::Sobol(_)
        | PlanFacts::Tolerance(_)
        | PlanFacts::Search(_) => return None,
    }
    let levels = |parameter: &&ParameterFacts| numbers_of(parameter, &report.designs).len();
    let parameters = &report.facts.parameters;
    // Among parameters with equally many levels, the first.
    let across = parameters.iter().rev().max_by_key(levels).filter(|own| levels(own) > 1)?;
    let others: Vec<&ParameterFacts> =
        parameters.iter().filter(|own| own.name != across.name).collect();
    let mut curves: Vec<(String, Vec<SeriesPoint>)> = Vec::new();
    for design in &report.designs {
        let (Some(found), Some(x)) = (design.measure(measure), across.setting_in(design).number())
        else {
            continue;
        };
        let name =
            others.iter().map(|own| setting_words(own, design)).collect::<Vec<_>>().join(", ");
        let point = SeriesPoint { x, y: found.value, std_error: found.total_error() };
        match curves.iter_mut().find(|(own, _)| *own == name) {
            Some((_, points)) => points.push(point),
            None => curves.push((name, vec![point])),
        }
    }
    let left_out = curves.len().saturating_sub(MOST_CURVES);
    let more = if left_out > 0 {
        format!("; {left_out} more curves are not drawn")
    } else {
        String::new()
    };
    let series = curves.into_iter().take(MOST_CURVES).map(|(name, mut points)| {
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        PlotSeries::new(name, points, SeriesForm::Line, ErrorForm::Bars)
    });
    Some(LinePlot {
        title: format!("{measure} over {}", across.name),
        subtitle: format!("bars: one standard error, with bias where there is one{more}"),
        x_label: across.label(),
        y_label: measure_label(report, measure),
        scale: AxisScale::Linear,
        series: series.collect(),
    })
}

/// The measure that decides over the designs of a search, and the best so far.
fn history(report: &StudyReport) -> Option<Figure> {
    report.best_passing()?;
    let (measure, best) = report.leading();
    let point = |design: &DesignRecord| {
        let found = design.measure(measure)?;
        let (x, y) = (design.design as f64, found.value);
        y.is_finite().then_some(SeriesPoint { x, y, std_error: found.total_error() })
    };
    let (good, bad): (Vec<&DesignRecord>, Vec<&DesignRecord>) =
        report.designs.iter().partition(|design| design.passes());
    let [good, bad] =
        [good, bad].map(|own| own.into_iter().filter_map(point).collect::<Vec<SeriesPoint>>());
    let mut lead: Vec<SeriesPoint> = Vec::new();
    for point in &good {
        let is_ahead = |last: &SeriesPoint| match best {
            Best::Highest => point.y > last.y,
            Best::Lowest => point.y < last.y,
        };
        match lead.last().copied() {
            Some(last) if !is_ahead(&last) => {}
            Some(last) => lead.extend([SeriesPoint { x: point.x, ..last }, *point]),
            None => lead.push(*point),
        }
    }
    let end = report.designs.len() as f64;
    lead.extend(lead.last().copied().map(|last| SeriesPoint { x: end, ..last }));
    let series = [
        // In the colours of the scatter matrix.
        ("passes all checks", good, SeriesForm::Dots, ErrorForm::Bars),
        ("fails or undecided", bad, SeriesForm::Dots, ErrorForm::Bars),
        ("best so far", lead, SeriesForm::Line, ErrorForm::Hidden),
    ];
    let series = series.into_iter().filter(|(_, points, ..)| !points.is_empty());
    let plot = LinePlot {
        title: format!("{measure} in the search"),
        subtitle: "bars: one standard error, with bias where there is one".to_owned(),
        x_label: "design".to_owned(),
        y_label: measure_label(report, measure),
        scale: AxisScale::Linear,
        series: series
            .map(|(name, points, form, errors)| {
                PlotSeries::new(name.to_owned(), points, form, errors)
            })
            .collect(),
    };
    Some(Figure {
        file: "history.png".to_owned(),
        label: format!("{measure} of the designs in the order of the search"),
        drawing: StudyDrawing::Curves(plot, report.unit(measure).to_owned()),
    })
}

/// Distributions of the measures of the best design of a search, in production.
fn production(made: &StudyReport) -> Vec<Figure> {
    let figure = |measure: &String| {
        let plot = distribution(made, measure)?;
        Some(Figure {
            file: format!("production.{measure}.png"),
            label: format!("distribution of {measure} in production"),
            drawing: StudyDrawing::Curves(plot, "1".into()),
        })
    };
    made.facts.measures.iter().filter_map(figure).collect()
}

/// A parameter with its setting in a design: "leg 5 mm".
pub(super) fn setting_words(parameter: &ParameterFacts, design: &DesignRecord) -> String {
    let unit = parameter.unit.as_ref().map_or(String::new(), |unit| format!(" {unit}"));
    let found = parameter.setting_in(design);
    let unit = if found.number().is_some() { unit } else { String::new() };
    format!("{} {}{unit}", parameter.name, setting_word(found))
}

/// Histogram of a measure with the limits of its checks; for samples.
fn distribution(report: &StudyReport, measure: &str) -> Option<LinePlot> {
    match report.facts.plan {
        PlanFacts::LatinHypercube(_) | PlanFacts::Sobol(_) | PlanFacts::Tolerance(_) => {}
        PlanFacts::Grid | PlanFacts::OneAtATime | PlanFacts::List | PlanFacts::Search(_) => {
            return None;
        }
    }
    let values: Vec<f64> = report
        .designs
        .iter()
        .filter_map(|design| Some(design.measure(measure)?.value))
        .filter(|value| value.is_finite())
        .collect();
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Too few or equal values have no distribution to draw.
    if values.len() < 10 || low >= high {
        return None;
    }
    let bins = (BINS_PER_ROOT * (values.len() as f64).sqrt()).ceil() as usize;
    let width = (high - low) / bins as f64;
    let mut counts = vec![0.0f64; bins];
    for value in &values {
        counts[(((value - low) / width) as usize).min(bins - 1)] += 1.0;
    }
    let most = counts.iter().copied().fold(0.0, f64::max);
    let points = counts.iter().enumerate().map(|(bin, count)| SeriesPoint {
        x: low + (bin as f64 + 0.5) * width,
        y: *count,
        std_error: count.sqrt(),
    });
    let (form, errors) = (SeriesForm::Steps, ErrorForm::Hidden);
    let mut series = vec![PlotSeries::new("designs", points.collect(), form, errors)];
    let own = report.facts.checks.iter().filter(|check| check.measure == measure);
    for limit in own.flat_map(|check| [check.min, check.max].into_iter().flatten()) {
        let at = |y| SeriesPoint { x: limit, y, std_error: 0.0 };
        series.push(PlotSeries {
            name: format!("limit {}", format_value(limit)),
            points: vec![at(0.0), at(most)],
            form: SeriesForm::Line,
            errors: ErrorForm::Hidden,
            look: Look::Dashed(1),
        });
    }
    Some(LinePlot {
        title: format!("Distribution of {measure}"),
        subtitle: format!("{} designs", values.len()),
        x_label: measure_label(report, measure),
        y_label: "designs".into(),
        scale: AxisScale::Linear,
        series,
    })
}

fn effect_drawing(report: &StudyReport, effect: &Effect) -> StudyDrawing {
    let title = format!("{}: main effect of {}", effect.measure, effect.parameter);
    let used: usize = effect.points.iter().map(|point| point.designs).sum();
    let subtitle = if report.facts.plan == PlanFacts::OneAtATime {
        "all other parameters as in the scene"
    } else if used == report.designs.len() {
        "mean over all designs with the same setting"
    } else {
        "mean over designs that differ only in this parameter"
    };
    let points: Option<Vec<SeriesPoint>> = effect
        .points
        .iter()
        .map(|point| {
            let (y, std_error) = (point.mean.value, point.mean.std_error);
            Some(SeriesPoint { x: point.setting.number()?, y, std_error })
        })
        .collect();
    let facts = report.facts.parameters.iter().find(|own| own.name == effect.parameter);
    match points {
        Some(points) => StudyDrawing::Curves(
            LinePlot {
                title,
                subtitle: subtitle.into(),
                x_label: facts.map_or(effect.parameter.clone(), ParameterFacts::label),
                y_label: measure_label(report, &effect.measure),
                scale: AxisScale::Linear,
                series: vec![PlotSeries::new("", points, SeriesForm::Line, ErrorForm::Bars)],
            },
            report.unit(&effect.measure).to_owned(),
        ),
        // Choices have no place on an axis.
        None => StudyDrawing::Bars(BarChart {
            title,
            subtitle: subtitle.into(),
            unit: match report.unit(&effect.measure) {
                "1" => String::new(),
                unit => unit.to_owned(),
            },
            whole: None,
            bars: effect
                .points
                .iter()
                .map(|point| Bar {
                    name: point.setting.to_string(),
                    value: point.mean.value,
                    std_error: Some(point.mean.std_error),
                    colour: 0,
                })
                .collect(),
        }),
    }
}

/// All parameters that are numbers and all measures, each against each.
fn scatter(report: &StudyReport) -> ScatterMatrix {
    let designs = &report.designs;
    let of_parameter = |own: &ParameterFacts| {
        let values: Vec<f64> = designs
            .iter()
            .map(|design| own.setting_in(design).number().unwrap_or(f64::NAN))
            .collect();
        values
            .iter()
            .any(|value| value.is_finite())
            .then(|| ScatterColumn { label: own.label(), values })
    };
    let of_measure = |name: &String| {
        let value = |design: &DesignRecord| design.measure(name).map_or(f64::NAN, |own| own.value);
        let values = designs.iter().map(value).collect();
        ScatterColumn { label: measure_label(report, name), values }
    };
    let measures = report.facts.measures.iter().map(of_measure);
    let columns: Vec<ScatterColumn> =
        report.facts.varied().filter_map(of_parameter).chain(measures).collect();
    let (kinds, kind_of) = if report.facts.checks.is_empty() {
        (vec!["designs".to_owned()], vec![0; designs.len()])
    } else {
        let kind = |design: &DesignRecord| match design.outcome.verdict() {
            Some(CheckOutcome::Passed) => 0,
            Some(CheckOutcome::Failed | CheckOutcome::Unknown) | None => 1,
            Some(CheckOutcome::Undecided) => 2,
        };
        let kinds = ["passes all checks", "fails", "undecided"].map(str::to_owned).to_vec();
        (kinds, designs.iter().map(kind).collect())
    };
    ScatterMatrix {
        title: "Parameters and measures".into(),
        subtitle: format!("{} designs", designs.len()),
        columns,
        kind_of,
        kinds,
    }
}
