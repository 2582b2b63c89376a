//! The front of a search with several objectives: designs that no other beats in all of them.

use crate::page::{Block, PagePart, table};
use crate::png::{AxisScale, ErrorForm, LinePlot, PlotSeries, SeriesForm, SeriesPoint};
use crate::study::figure::{Figure, StudyDrawing, measure_label};
use crate::study::settings::settings;
use crate::study::{Confirmation, DesignRecord, ParameterFacts, StudyReport};
use crate::words::{measured, outcome_word};
use lumiduct_base::number::format_value;
use lumiduct_core::measure::{CheckOutcome, Measure};
use lumiduct_input::{Best, Ranking};

impl StudyReport {
    /// The designs on the front of a search, the best by the first objective first.
    pub fn front(&self) -> impl Iterator<Item = &DesignRecord> + Clone {
        self.analysis.front.iter().filter_map(|number| self.design(*number))
    }
}

/// The front in a few words, to follow those of all designs; `None` where it is empty.
pub(super) fn front_words(report: &StudyReport) -> Option<String> {
    let count = report.analysis.front.len();
    let range = |own: &Ranking| {
        let values = report.front().filter_map(|design| Some(design.measure(&own.measure)?.value));
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.fold(f64::NEG_INFINITY, f64::max);
        let unit = match report.unit(&own.measure) {
            "1" => String::new(),
            unit => format!(" {unit}"),
        };
        let [low, high] = [low, high].map(format_value);
        let values = if low == high { low } else { format!("{low} to {high}") };
        format!("{} {values}{unit}", own.measure)
    };
    let ranges: Vec<String> = report.facts.objectives.iter().map(range).collect();
    let designs = if count == 1 { "one design" } else { &format!("{count} designs") };
    let words = format!("; the front has {designs}: {}", ranges.join(", "));
    let count = |is_counted: fn(CheckOutcome) -> bool| {
        let of = |design: &DesignRecord| {
            let mut again = again(report, design).filter_map(|own| own.outcome.verdict());
            again.any(is_counted)
        };
        report.front().filter(|design| of(design)).count()
    };
    let failed = count(CheckOutcome::is_failure);
    let open = count(|own| own == CheckOutcome::Undecided);
    let is_checked = report.confirmations.iter().any(|own| own.outcome.verdict().is_some());
    let standing = match (is_checked, failed, open) {
        (false, _, _) => String::new(),
        (true, 0, 0) => "; traced again, all pass".to_owned(),
        (true, 0, open) => format!("; traced again, {open} undecided"),
        (true, failed, _) => format!("; traced again, {failed} of them fail a check"),
    };
    (!report.analysis.front.is_empty()).then_some(words + &standing)
}

/// A design of the front traced again.
fn again<'a>(
    report: &'a StudyReport,
    design: &DesignRecord,
) -> impl Iterator<Item = &'a Confirmation> + Clone {
    let number = design.design;
    report.confirmations.iter().filter(move |own| own.design == Some(number))
}

/// The table of the front.
pub(super) fn front_part(report: &StudyReport) -> Option<PagePart> {
    let first = report.front().next()?;
    let objectives = &report.facts.objectives;
    let goal = |own: &Ranking| match own.best {
        Best::Highest => format!("the highest {}", own.measure),
        Best::Lowest => format!("the lowest {}", own.measure),
    };
    let goals: Vec<String> = objectives.iter().map(goal).collect();
    let mut words = format!(
        "The aim is {}. No design that passes every check beats one of these in all of them.",
        goals.join(" and ")
    );
    let runs: Vec<&Confirmation> = again(report, first).collect();
    if !runs.is_empty() {
        words += " Designs that stand out among many noisy ones are partly lucky, so all were traced again with random numbers that the search has not used.";
    }
    // What is exact is the same again.
    let is_noisy = |own: &&Ranking| first.measure(&own.measure).is_some_and(|own| own.batches > 0);
    let noisy: Vec<&Ranking> = objectives.iter().filter(is_noisy).collect();
    let labels = report.facts.varied().map(ParameterFacts::label);
    let head = ["design".to_owned()].into_iter().chain(labels);
    let head = head.chain(objectives.iter().map(|own| own.measure.clone()));
    let column = |own: &&Ranking| {
        let measure = own.measure.clone();
        let name =
            move |run: &Confirmation| format!("{measure}, seed {}, {}", run.seed, run.estimator);
        runs.iter().map(|run| name(run)).collect::<Vec<_>>()
    };
    let head = head.chain(noisy.iter().flat_map(column));
    let has_checks = !runs.is_empty() && !report.facts.checks.is_empty();
    let head: Vec<String> = head.chain(has_checks.then(|| "checks then".to_owned())).collect();
    let cell = |found: Option<&Measure>| found.map_or(String::new(), measured);
    let row = |design: &DesignRecord| -> Vec<String> {
        let found = objectives.iter().map(|own| cell(design.measure(&own.measure)));
        let then = noisy.iter().flat_map(|own| {
            again(report, design).map(|run| {
                cell(run.outcome.result().and_then(|run| run.measures.get(&own.measure)))
            })
        });
        let worst = again(report, design).map(|run| run.outcome.verdict());
        // A scene that an estimator refuses has no verdict.
        let worst = match worst.clone().any(|own| own.is_none()) {
            true => "not possible",
            false => worst.flatten().max().map_or("", outcome_word),
        };
        let row = [design.design.to_string()].into_iter().chain(settings(report, design));
        row.chain(found).chain(then).chain(has_checks.then(|| worst.to_owned())).collect()
    };
    let rows = report.front().map(row).collect();
    Some(PagePart::new("Front", vec![Block::Words { text: words }, table(&head, rows)]))
}

/// The objectives of all designs, one against another, with the front.
pub(super) fn front_figures(report: &StudyReport) -> Vec<Figure> {
    if report.analysis.front.is_empty() {
        return Vec::new();
    }
    let objectives = report.facts.objectives.iter().enumerate();
    let pairs = objectives.clone().flat_map(|(place, one)| {
        report.facts.objectives[..place].iter().map(move |other| [one, other])
    });
    pairs.map(|pair| figure(report, pair)).collect()
}

fn figure(report: &StudyReport, [across, up]: [&Ranking; 2]) -> Figure {
    let [across, up] = [&across.measure, &up.measure];
    let is_exact = |measure: &String| {
        report.front().all(|design| design.measure(measure).is_some_and(|own| own.batches == 0))
    };
    // Error bars are vertical.
    let [across, up] = if is_exact(up) { [up, across] } else { [across, up] };
    let point = |design: &DesignRecord| {
        let (x, found) = (design.measure(across)?.value, design.measure(up)?);
        let point = SeriesPoint { x, y: found.value, std_error: found.total_error() };
        (x.is_finite() && point.y.is_finite()).then_some(point)
    };
    let (good, bad): (Vec<&DesignRecord>, Vec<&DesignRecord>) =
        report.designs.iter().partition(|design| design.passes());
    let [good, bad] = [good, bad].map(|own| own.into_iter().filter_map(point).collect::<Vec<_>>());
    let mut front: Vec<SeriesPoint> = report.front().filter_map(point).collect();
    front.sort_by(|one, other| one.x.total_cmp(&other.x));
    // Of three objectives any two show a shadow of the front.
    let form = if report.facts.objectives.len() == 2 { SeriesForm::Line } else { SeriesForm::Dots };
    let series = [
        ("passes all checks", good, SeriesForm::Dots),
        ("fails or undecided", bad, SeriesForm::Dots),
        ("front", front, form),
    ];
    let plot = LinePlot {
        title: format!("{up} against {across}"),
        subtitle: format!(
            "{} designs, {} on the front",
            report.designs.len(),
            report.analysis.front.len()
        ),
        x_label: measure_label(report, across),
        y_label: measure_label(report, up),
        scale: AxisScale::Linear,
        series: series
            .into_iter()
            .filter(|(_, points, _)| !points.is_empty())
            .map(|(name, points, form)| {
                PlotSeries::new(name.to_owned(), points, form, ErrorForm::Bars)
            })
            .collect(),
    };
    Figure {
        file: format!("front.{up}.{across}.png"),
        label: format!("{up} against {across}, with the front"),
        drawing: StudyDrawing::Curves(plot, report.unit(up).to_owned()),
    }
}
