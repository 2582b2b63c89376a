//! The front of a search with several objectives: designs for which no other is as good in every objective and better in one.

use crate::page::{Block, PagePart, table};
use crate::png::{AxisScale, ErrorForm, LinePlot, Look, PlotSeries, SeriesForm, SeriesPoint};
use crate::study::confirmation::words;
use crate::study::edge::edges_of_front;
use crate::study::figure::{Figure, StudyDrawing, measure_label};
use crate::study::settings::settings;
use crate::study::{Confirmation, DesignRecord, FrontDesign, ParameterFacts, StudyReport};
use crate::words::{measured, outcome_word};
use lumiduct_base::number::format_value;
use lumiduct_core::measure::{CheckOutcome, Measure};
use lumiduct_core::plan::Check;
use lumiduct_input::{Best, Ranking};

impl StudyReport {
    /// The designs on the front of a search, the best by the first objective first.
    pub fn front(&self) -> impl Iterator<Item = &DesignRecord> + Clone {
        self.analysis.front.iter().filter_map(|own| self.design(own.design))
    }
}

/// The name of the scene of a design on the front.
pub fn front_scene_name(scene: &str, design: usize) -> String {
    format!("{scene}_design_{design}.toml")
}

/// The front in a few words, to follow those of all designs; `None` where it is empty.
pub(super) fn front_words(report: &StudyReport) -> Option<String> {
    let count = report.analysis.front.len();
    if count == 0 {
        return None;
    }
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
    Some(words + &standing_again(report))
}

/// What tracing the front again says of it, to follow it in a sentence.
fn standing_again(report: &StudyReport) -> String {
    let all = &report.confirmations;
    let designs = |is_counted: fn(&Confirmation) -> bool| {
        let of = |design: &&DesignRecord| again(report, design).any(is_counted);
        report.front().filter(of).count()
    };
    let refused = designs(|own| own.outcome.result().is_none());
    let failed = designs(Confirmation::refutes);
    let open = designs(|own| own.outcome.verdict() == Some(CheckOutcome::Undecided));
    if all.is_empty() || refused == 0 && all.iter().all(|own| own.outcome.verdict().is_none()) {
        return String::new();
    }
    let found = [(failed, "fail a check"), (open, "undecided"), (refused, "not possible")];
    let found = found.into_iter().filter(|(count, _)| *count > 0);
    let found: Vec<String> = found.map(|(count, what)| format!("{count} {what}")).collect();
    match found.is_empty() {
        true => "; traced again, all pass".to_owned(),
        false => format!("; traced again, {}", found.join(", ")),
    }
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
    report.front().next()?;
    let facts = &report.facts;
    let passing = if facts.checks.is_empty() { "" } else { " that passes every check" };
    let mut words = format!(
        "The aim is {}. A design is on the front if no other of those traced{passing} is as good in every objective and better in one.",
        goals(&facts.objectives)
    );
    if report.analysis.front.iter().any(|own| own.rival.is_some()) {
        words += " “May be beaten” names the first other design that would keep it off the front if differences within three standard errors counted for nothing.";
    }
    let labels = facts.varied().map(ParameterFacts::label);
    let checked = checked(report);
    let head = ["design".to_owned()].into_iter().chain(labels);
    let head = head.chain(facts.objectives.iter().map(|own| own.measure.clone()));
    let head = head.chain(checked.iter().map(|own| limit_words(own)));
    let head: Vec<String> = head.chain(["may be beaten".to_owned(), "scene".to_owned()]).collect();
    let row = |own: &FrontDesign| -> Option<Vec<String>> {
        let design = report.design(own.design)?;
        let found = facts.objectives.iter().map(|own| &own.measure);
        let found = found.chain(checked.iter().map(|own| &own.measure));
        let found = found.map(|name| cell(design.measure(name)));
        let rival = own.rival.map_or(String::new(), |rival| format!("by {rival}"));
        let row = [own.design.to_string()].into_iter().chain(settings(report, design));
        let row = row.chain(found);
        Some(row.chain([rival, front_scene_name(&facts.scene, own.design)]).collect())
    };
    let rows = report.analysis.front.iter().filter_map(row).collect();
    let mut blocks = vec![Block::Words { text: words }, table(&head, rows)];
    blocks.extend(edges_of_front(report).map(|text| Block::Words { text }));
    Some(PagePart::new("Front", blocks))
}

/// The table of the front traced again.
pub(super) fn front_again(report: &StudyReport) -> Option<PagePart> {
    let first = report.front().next()?;
    let runs: Vec<&Confirmation> = again(report, first).collect();
    if runs.is_empty() {
        return None;
    }
    let text = "The best of many noisy results are partly luck, so every design of the front was traced again with random numbers that the search has not used. A sensor with an estimator of its own keeps it.";
    // What is exact is the same again.
    let is_noisy = |name: &&String| first.measure(name).is_some_and(|own| own.batches > 0);
    let checked = checked(report);
    let names = report.facts.objectives.iter().map(|own| &own.measure).filter(is_noisy);
    let names: Vec<&String> = names.chain(checked.iter().map(|own| &own.measure)).collect();
    let has_checks = !report.facts.checks.is_empty();
    let columns = |run: &&Confirmation| -> Vec<String> {
        let of = format!("seed {}, {}", run.seed, run.estimator);
        let measures = names.iter().map(|name| format!("{name}, {of}"));
        measures.chain(has_checks.then(|| format!("checks, {of}"))).collect()
    };
    let head: Vec<String> =
        std::iter::once("design".to_owned()).chain(runs.iter().flat_map(columns)).collect();
    let row = |design: &DesignRecord| -> Vec<String> {
        let cells = again(report, design).flat_map(|run| {
            let found = |name: &&String| {
                cell(run.outcome.result().and_then(|own| own.measures.get(name.as_str())))
            };
            let verdict = match run.outcome.result() {
                Some(_) => run.outcome.verdict().map_or("", outcome_word),
                None => "not possible",
            };
            let cells = names.iter().map(found).collect::<Vec<_>>().into_iter();
            cells.chain(has_checks.then(|| verdict.to_owned())).collect::<Vec<_>>()
        });
        std::iter::once(design.design.to_string()).chain(cells).collect()
    };
    let rows = report.front().map(row).collect();
    let mut blocks = vec![Block::Words { text: text.to_owned() }, table(&head, rows)];
    let refused = report.confirmations.iter().filter(|own| own.outcome.result().is_none());
    let items: Vec<String> = refused.map(words).collect();
    if !items.is_empty() {
        blocks.push(Block::List { items });
    }
    Some(PagePart::new("Front traced again", blocks))
}

/// The objectives in words.
fn goals(objectives: &[Ranking]) -> String {
    let goal = |own: &Ranking| match own.best {
        Best::Highest => format!("the highest {}", own.measure),
        Best::Lowest => format!("the lowest {}", own.measure),
    };
    let goals: Vec<String> = objectives.iter().map(goal).collect();
    match goals.as_slice() {
        [all @ .., last] if !all.is_empty() => format!("{} and {last}", all.join(", ")),
        all => all.join(", "),
    }
}

/// The checks of recorded measures that are no objectives.
fn checked(report: &StudyReport) -> Vec<&Check> {
    let facts = &report.facts;
    let is_other = |own: &&Check| {
        facts.measures.contains(&own.measure)
            && facts.objectives.iter().all(|objective| objective.measure != own.measure)
    };
    facts.checks.iter().filter(is_other).collect()
}

/// A checked measure with its limits: "exit.flux, at least 0.6".
fn limit_words(check: &Check) -> String {
    let limits = [
        check.min.map(|min| format!("at least {}", format_value(min))),
        check.max.map(|max| format!("at most {}", format_value(max))),
        check.equals.map(|value| format!("wanted {}", format_value(value))),
    ];
    let limits = limits.into_iter().flatten();
    std::iter::once(check.measure.clone()).chain(limits).collect::<Vec<_>>().join(", ")
}

fn cell(found: Option<&Measure>) -> String {
    found.map_or(String::new(), measured)
}

/// The objectives of all designs, one against another, with the front.
pub(super) fn front_figures(report: &StudyReport) -> Vec<Figure> {
    if report.analysis.front.is_empty() {
        return Vec::new();
    }
    let objectives = &report.facts.objectives;
    let pairs = objectives
        .iter()
        .enumerate()
        .flat_map(|(place, one)| objectives[..place].iter().map(move |other| [other, one]));
    pairs.map(|pair| figure(report, pair)).collect()
}

fn figure(report: &StudyReport, [one, other]: [&Ranking; 2]) -> Figure {
    // Error bars are vertical, so the noisier measure goes upward.
    let [across, up] = match noise(report, one) > noise(report, other) {
        true => [other, one],
        false => [one, other],
    };
    let point = |design: &DesignRecord| {
        let (x, found) = (design.measure(&across.measure)?.value, design.measure(&up.measure)?);
        let point = SeriesPoint { x, y: found.value, std_error: found.total_error() };
        (x.is_finite() && point.y.is_finite()).then_some(point)
    };
    let (good, bad): (Vec<&DesignRecord>, Vec<&DesignRecord>) =
        report.designs.iter().partition(|design| design.passes());
    let [good, bad] = [good, bad].map(|own| own.into_iter().filter_map(point).collect::<Vec<_>>());
    let front: Vec<SeriesPoint> = report.front().filter_map(point).collect();
    // Of three objectives any two show a shadow of the front.
    let (front, form, errors) = match report.facts.objectives.len() {
        2 => (steps(front, across.best), SeriesForm::Line, ErrorForm::Hidden),
        _ => (front, SeriesForm::Dots, ErrorForm::Bars),
    };
    let series = [
        ("passes all checks", good, SeriesForm::Dots, ErrorForm::Bars),
        ("fails or undecided", bad, SeriesForm::Dots, ErrorForm::Bars),
        ("front", front, form, errors),
    ];
    let series = series.into_iter().enumerate().map(|(number, (name, points, form, errors))| {
        let look = Look::Solid(number);
        PlotSeries { look, ..PlotSeries::new(name.to_owned(), points, form, errors) }
    });
    let [across, up] = [&across.measure, &up.measure];
    let [all, on] = [report.designs.len(), report.analysis.front.len()];
    let plot = LinePlot {
        title: format!("{up} against {across}"),
        subtitle: format!("{all} designs, {on} on the front; bars: one standard error"),
        x_label: measure_label(report, across),
        y_label: measure_label(report, up),
        scale: AxisScale::Linear,
        series: series.filter(|own| !own.points.is_empty()).collect(),
    };
    Figure {
        file: format!("front.{up}.{across}.png"),
        label: format!("{up} against {across}, with the front"),
        drawing: StudyDrawing::Curves(plot, report.unit(up).to_owned()),
    }
}

/// The border of what the designs of a front beat: from each straight to the next, where the first is better.
fn steps(mut front: Vec<SeriesPoint>, best: Best) -> Vec<SeriesPoint> {
    front.sort_by(|one, other| match best {
        Best::Lowest => one.x.total_cmp(&other.x),
        Best::Highest => other.x.total_cmp(&one.x),
    });
    let mut border: Vec<SeriesPoint> = Vec::new();
    for point in front {
        let corner = border.last().map(|last| SeriesPoint { x: point.x, ..*last });
        border.extend(corner.into_iter().chain([point]));
    }
    border
}

/// The mean error of an objective over the span of its values, 1.
fn noise(report: &StudyReport, objective: &Ranking) -> f64 {
    let found = report.designs.iter().filter_map(|own| own.measure(&objective.measure));
    let found: Vec<&Measure> = found.filter(|own| own.value.is_finite()).collect();
    let values = found.iter().map(|own| own.value);
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    let errors: f64 = found.iter().map(|own| own.total_error()).filter(|own| own.is_finite()).sum();
    if errors > 0.0 { errors / found.len() as f64 / (high - low) } else { 0.0 }
}
