//! What random designs say: which share fails, and on what their measures depend.

use crate::page::{Block, PagePart, table};
use crate::study::confirmation::of_best;
use crate::study::figure::measure_label;
use crate::study::settings::domain_words;
use crate::study::{
    DesignOutcome, ParameterFacts, Sensitivity, SensitivityIndex, SensitivityMethod, StudyReport,
};
use lumiduct_base::number::{format_percent, format_value, format_with_error};
use lumiduct_core::tally::Tally;
use lumiduct_input::Domain;

/// Which share of the designs fails.
pub(super) fn failures(report: &StudyReport) -> Option<PagePart> {
    let shares = &report.analysis.failures;
    let words = "The 95 % interval (Clopper and Pearson) is for the share of all parts produced with these \
        tolerances. A design that is undecided within its error bar counts as passed for the low end and as \
        failed for the high end.";
    let head = ["demand", "passed", "failed", "undecided", "fails", "interval"];
    let rows = shares.iter().map(|own| {
        let [low, high] = own.interval.map(format_percent);
        let share = if own.undecided == 0 {
            format_percent(own.least)
        } else {
            format!("{} to {}", format_percent(own.least), format_percent(own.most))
        };
        let counts = [own.passed, own.failed, own.undecided].map(|count| count.to_string());
        let row = [own.demand.clone()].into_iter().chain(counts);
        row.chain([share, format!("{low} to {high}")]).collect()
    });
    let blocks = vec![Block::Words { text: words.into() }, table(&head, rows.collect())];
    (!shares.is_empty()).then(|| PagePart::new("Share of designs that fail", blocks))
}

/// On what the measures depend.
pub(super) fn sensitivities(report: &StudyReport) -> Option<PagePart> {
    let all = &report.analysis.sensitivities;
    let first = all.first()?;
    let (words, sum) = match first.method {
        SensitivityMethod::FirstOrder => (
            "First-order Sobol indices: the share of the variance over the grid that a parameter causes on \
                its own. The rest, up to 1, comes from interactions between parameters.",
            "sum",
        ),
        SensitivityMethod::Regression => (
            "Standardised regression coefficients: how many standard deviations the measure changes when \
                the parameter changes by one standard deviation. R² is the share of the variance that the \
                regression explains; where it is small, the coefficients mean little.",
            "R²",
        ),
    };
    let names = first.indices.iter().map(|index| index.parameter.clone());
    let head = ["measure".to_owned()].into_iter().chain(names).chain([sum.to_owned()]);
    let head: Vec<String> = head.collect();
    let row = |Sensitivity { measure, indices, explained, .. }: &Sensitivity| {
        let indices = indices.iter().map(|index| match index.std_error.is_finite() {
            true => format_with_error(index.value, index.std_error),
            false => format!("{} (error not known)", format_value(index.value)),
        });
        [measure.clone()].into_iter().chain(indices).chain([format_value(*explained)]).collect()
    };
    let rows = all.iter().map(row).collect();
    let mut blocks = vec![Block::Words { text: words.into() }, table(&head, rows)];
    blocks.extend(slopes(report).into_iter().flatten());
    Some(PagePart::new("Sensitivity", blocks))
}

/// By how much the measures change per unit of each parameter, from regressions.
fn slopes(report: &StudyReport) -> Option<[Block; 2]> {
    let all = &report.analysis.sensitivities;
    let slope = |index: &SensitivityIndex| {
        index.slope.map(|[value, error]| format_with_error(value, error))
    };
    let row = |own: &Sensitivity| -> Option<Vec<String>> {
        let slopes: Option<Vec<String>> = own.indices.iter().map(slope).collect();
        Some([measure_label(report, &own.measure)].into_iter().chain(slopes?).collect())
    };
    let rows: Option<Vec<Vec<String>>> = all.iter().map(row).collect();
    let label = |index: &SensitivityIndex| {
        let facts = report.facts.parameters.iter().find(|own| own.name == index.parameter);
        match facts.and_then(|own| own.unit.as_ref()) {
            Some(unit) => format!("per {unit} of {}", index.parameter),
            None => format!("per unit of {}", index.parameter),
        }
    };
    let labels = all.first()?.indices.iter().map(label);
    let head: Vec<String> = ["measure".to_owned()].into_iter().chain(labels).collect();
    let words =
        "Slopes of the same regression: the change of the measure per unit of the parameter.";
    Some([Block::Words { text: words.into() }, table(&head, rows?)])
}

/// The best design of a search as production scatters it.
pub(super) fn produced(report: &StudyReport) -> Option<PagePart> {
    let made = report.production.as_deref()?;
    let facts = &made.facts;
    let is_scattered = |own: &&ParameterFacts| match own.domain {
        Domain::Uniform { .. } | Domain::Normal { .. } => true,
        Domain::Levels(_) | Domain::Listed | Domain::AsInScene => false,
    };
    let scattered = facts.parameters.iter().filter(is_scattered);
    let scattered: Vec<String> =
        scattered.map(|own| format!("{}: {}", own.label(), domain_words(&own.domain))).collect();
    let words = format!(
        "{} simulated parts around the best design, each parameter on its own: {}. All are traced with seed {}, which the search \
            has not used, so their tracing errors are alike. A part fails if it fails any check, so the rows below do not add up.",
        facts.designs,
        scattered.join("; "),
        facts.seed
    );
    let mut blocks = vec![Block::Words { text: words }];
    blocks.extend(broken(made).map(|text| Block::Words { text: format!("{text}.") }));
    blocks.extend(failures(made).into_iter().flat_map(|part| part.blocks));
    blocks.extend(spread(report, made));
    blocks.extend(sensitivities(made).into_iter().flat_map(|part| part.blocks));
    let caution = "An effect that is the same in both directions, as of an LED that leaves the axis, has no slope; it makes other slopes less \
        certain than their errors say.";
    let has_slopes = !made.analysis.sensitivities.is_empty();
    blocks.extend(has_slopes.then(|| Block::Words { text: caution.to_owned() }));
    Some(PagePart::new("In production", blocks))
}

/// How the measures scatter, beside their values for the nominal design.
fn spread(report: &StudyReport, made: &StudyReport) -> [Block; 2] {
    let words = "How measures scatter, with what the noise of tracing adds; 5 % of the parts have less than the value below 5 %.";
    let head = ["measure", "nominal", "mean", "standard deviation", "minimum"];
    let head = head.into_iter().chain(["5 %", "median", "95 %", "maximum"]);
    let head: Vec<String> = head.map(str::to_owned).collect();
    let rows = made.facts.measures.iter().filter_map(|measure| {
        let values = made.designs.iter().filter_map(|design| Some(design.measure(measure)?.value));
        let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let (least, greatest) = (*values.first()?, *values.last()?);
        let tally = Tally::of(values.iter().copied());
        let deviation = tally.std_error() * (values.len() as f64).sqrt();
        let [low, median, high] = [0.05, 0.5, 0.95].map(|share| quantile(&values, share));
        let nominal = of_best(report, measure)
            .map_or(String::new(), |own| format_with_error(own.value, own.total_error()));
        let numbers = [tally.mean(), deviation, least, low, median, high, greatest];
        let row = [measure_label(made, measure), nominal].into_iter();
        Some(row.chain(numbers.map(format_value)).collect())
    });
    [Block::Words { text: words.to_owned() }, table(&head, rows.collect())]
}

/// The value that this share of sorted values does not reach, between neighbours by a straight line.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let [below, above] = [place.floor(), place.ceil()].map(|place| sorted[place as usize]);
    below + (above - below) * place.fract()
}

/// How many of the simulated parts give no scene, and the first reason; `None` if all do.
pub(super) fn broken(made: &StudyReport) -> Option<String> {
    let mut reasons = made.designs.iter().filter_map(|design| match &design.outcome {
        DesignOutcome::Failed(reason) => Some(reason),
        DesignOutcome::Done(_) => None,
    });
    let first = reasons.next()?;
    let (count, all) = (1 + reasons.count(), made.designs.len());
    Some(format!(
        "{count} of {all} simulated parts give no valid scene and count as failed, the first by {first}"
    ))
}

/// How many parts of the best design fail in production, to follow a sentence on it.
pub(super) fn expected_failures(report: &StudyReport) -> String {
    let made = report.production.as_ref();
    let Some(own) = made.and_then(|made| made.analysis.failures.first()) else {
        return String::new();
    };
    let [low, high] = own.interval.map(format_percent);
    format!("; in production {low} to {high} of its parts fail a check (95 % interval)")
}
