//! Wording shared by all formats of a report: numbers with their errors, verdicts, and rows of
//! tables.

use crate::Report;
use lumiduct_base::number::{format_percent, format_value, format_with_error};
use lumiduct_core::measure::{
    Action, CheckOutcome, ClassExtent, LostPaths, Measure, PathClass, PathStep, SensorMap,
    Statistic, Status, strongest,
};
use lumiduct_core::plan::{Estimator, Polarisation};
use lumiduct_core::transport::{AccountEntry, EstimatorChoice, Objection, Trial};

/// A bias is shown from this share of the standard error on, 1.
const BIAS_TOLD: f64 = 0.3;

/// Path classes that are listed one by one for a sensor.
const CLASSES_SHOWN: usize = 8;

/// Text before the rows of [`class_rows`].
pub(crate) const CLASSES_HEAD: &str =
    "Paths of the photons (R reflected, T transmitted; repeated steps are listed once):";
/// Text before the rows of [`choice_row`].
pub(crate) const CHOICES_HEAD: &str = "A pilot run tried the estimators on each sensor. The table gives the \
    time that one thread would need to know the sensor's flux or map to 1 %, estimated from counted work \
    (docs/method.md; with a time limit, on this machine). All sensors share the work of a run: gather paths that serve one \
    sensor delay the others. The estimators are therefore chosen together, so that the largest delay of any sensor, compared \
    with its best estimator in a run of its own, is as small as possible. Gathering takes at least the time \
    of its first 16 passes. It is rejected if its bias exceeds the target by more than noise or if an unbiased \
    estimator contradicts it. Any estimator is rejected if it found significantly less light from a source \
    than another did.";
/// Text after the results.
pub(crate) const ERRORS: &str = "± is one standard error of the simulation. For fluxes, means and their ratios, the value \
    that infinitely many paths would give lies within one standard error in 68 of 100 runs and within two in 95. \
        Extremes, uniformities and angles are not normally distributed and keep a small bias: an error in \
        addition to the standard error, of which only a bound is known. Uniformities have a 95 % interval \
        in brackets. Values that are limited by noise or have too few counts need more paths. These errors \
        do not include tolerances of parts and materials.";
/// Text after the lines of the balance.
pub(crate) const NO_LINES: &str =
    "Virtual sensors let light pass and do not appear in the balance.";

/// Distinct names: those that several share are numbered.
pub(crate) fn numbered(names: &[&str]) -> Vec<String> {
    let count = |own: &str, of: &[&str]| of.iter().filter(|other| **other == own).count();
    let label = |(index, name): (usize, &&str)| match count(name, names) {
        1 => (*name).to_owned(),
        _ => format!("{name} ({})", count(name, &names[..=index])),
    };
    names.iter().enumerate().map(label).collect()
}

/// A value with its error and unit.
pub(crate) fn quantity(measure: &Measure) -> String {
    let unit = if measure.unit == "1" { String::new() } else { format!(" {}", measure.unit) };
    let (value, error) = (measure.value, measure.std_error);
    if measure.status == Status::NoSignal && value == 0.0 && error.is_finite() {
        // The error of zero is the contribution of a single path or count.
        return format!("0{unit} (nothing counted; one path is {}{unit})", format_value(error));
    }
    if measure.status == Status::NoSignal && error.is_infinite() {
        return NOTHING_COUNTED.into();
    }
    if is_boundless(measure) {
        return BOUNDLESS.into();
    }
    if is_undefined(measure) {
        return format!("undefined{}", remark(measure.status));
    }
    // A bias well below the noise is not shown.
    let bias = measure
        .bias
        .filter(|bias| *bias > BIAS_TOLD * error)
        .map_or(String::new(), |bias| format!(", bias up to {}{unit}", format_value(bias)));
    format!("{}{unit}{bias}{}", format_with_error(value, error), remark(measure.status))
}

/// A beam or field without an edge.
const BOUNDLESS: &str = "none (the intensity never falls below the level)";

/// Whether a measure is the angle of a beam that has no edge in any direction.
fn is_boundless(measure: &Measure) -> bool {
    measure.unit == "deg" && measure.value >= 360.0
}

/// Whether a measure has no value.
fn is_undefined(measure: &Measure) -> bool {
    measure.status == Status::Undefined && !measure.value.is_finite()
}

/// Value with standard error, bias, and remark; each may be empty.
pub(crate) fn measure_cells(measure: &Measure) -> [String; 3] {
    let unit = if measure.unit == "1" { String::new() } else { format!(" {}", measure.unit) };
    // The error of zero needs words.
    if measure.status == Status::NoSignal || is_boundless(measure) || is_undefined(measure) {
        return [quantity(measure), String::new(), String::new()];
    }
    [
        format!("{}{unit}", format_with_error(measure.value, measure.std_error)),
        measure.bias.map_or(String::new(), |bias| format!("{}{unit}", format_value(bias))),
        remark(measure.status).trim_matches([' ', '(', ')']).to_owned(),
    ]
}

/// Text of table cells without a value.
const NOTHING_COUNTED: &str = "unknown (nothing counted)";
const FOUND_NOTHING: &str = "found nothing";
const NOT_POSSIBLE: &str = "not possible";

/// Whether a table cell has no content.
pub(crate) fn is_silent(cell: &str) -> bool {
    ["", FOUND_NOTHING, NOT_POSSIBLE, NOTHING_COUNTED].contains(&cell)
}

/// The remark on an unreliable number.
pub(crate) fn remark(status: Status) -> &'static str {
    match status {
        Status::Ok => "",
        Status::NoSignal => " (nothing counted)",
        Status::TooFew => " (too few counts for an error bar)",
        Status::NoiseLimited => " (a bound: noise hides the value)",
        Status::Undefined => " (light of this colour has no such value)",
        Status::BiasInNoise => " (bias not resolved from noise)",
        Status::BiasNotResolved => " (bias not resolved)",
        Status::Contradicted => " (photons found more)",
    }
}

/// A verdict in words.
pub(crate) fn outcome_word(outcome: CheckOutcome) -> &'static str {
    match outcome {
        CheckOutcome::Passed => "passed",
        CheckOutcome::Undecided => "undecided",
        CheckOutcome::Failed => "failed",
        CheckOutcome::Unknown => "unknown measure",
    }
}

/// The chosen estimator, and the pilot's findings on each.
pub(crate) fn choice_row(choice: &EstimatorChoice) -> Vec<String> {
    let words = Estimator::TRIED.map(|estimator| {
        let trial = choice.tried.iter().find(|trial| trial.estimator == estimator);
        trial.map_or(NOT_POSSIBLE.into(), trial_words)
    });
    std::iter::once(choice.chosen.name().to_owned()).chain(words).collect()
}

fn trial_words(trial: &Trial) -> String {
    let time = trial.time(0.01);
    let is_least = trial.least > 0.0 && time == Some(trial.least);
    let time = time.map_or(FOUND_NOTHING.into(), waiting);
    let time = if is_least { time + " (its first passes)" } else { time };
    match (trial.objection, trial.bias) {
        (Some(Objection::Biased), Some(bias)) => {
            format!("{time} (biased by at least {:.0} %)", 100.0 * bias)
        }
        (Some(Objection::Biased), None) | (None, Some(_) | None) => time,
        (Some(Objection::Contradicted), _) => time + " (contradicted)",
    }
}

/// A time with two digits, the accuracy of a pilot; beyond an hour only its order of magnitude
/// matters.
fn waiting(seconds: f64) -> String {
    const MINUTE: f64 = 60.0;
    const HOUR: f64 = 3600.0;
    const DAY: f64 = 86_400.0;
    let two_digits = |time: f64| {
        let digits = 10f64.powi(1 - time.log10().floor() as i32);
        format_value((time * digits).round() / digits)
    };
    match seconds {
        // A flux that is known without noise costs nothing, and zero has no digits.
        time if time <= 0.0 => "0 s".to_owned(),
        time if time < MINUTE => format!("{} s", two_digits(time)),
        time if time < HOUR => format!("{} min", two_digits(time / MINUTE)),
        time if time < DAY => "hours".to_owned(),
        _ => "not in a day".to_owned(),
    }
}

/// An entry of the table of an account.
pub(crate) fn entry(entry: &AccountEntry) -> String {
    match entry {
        AccountEntry::Count(count) => count.to_string(),
        AccountEntry::Number(number) => format_value(*number),
        AccountEntry::Measured { value, std_error } => format_with_error(*value, *std_error),
    }
}

/// The fate of gather paths that ended prematurely.
pub(crate) fn lost_paths(lost: LostPaths) -> String {
    format!(
        "{} of the throughput of gather paths from the sensor was cut by the bounce limit, and {} was lost \
            through holes in the geometry.",
        format_percent(lost.cut),
        format_percent(lost.leaked)
    )
}

/// The area over which the uniformity of a map was taken; `None` for a single cell.
pub(crate) fn evenness_head(map: &SensorMap) -> Option<String> {
    let summary = &map.summary;
    if summary.cells == 1 {
        return None;
    }
    let ([width, height], unit) = (summary.cell_size, map.axes.unit());
    Some(format!(
        "Uniformity over {} cells of {} {unit} x {} {unit}; extremes are corrected for noise, intervals are 95 %.",
        summary.cells,
        format_value(width),
        format_value(height)
    ))
}

/// Area, and min/avg, min/max, max/min.
pub(crate) fn evenness_rows(map: &SensorMap) -> Vec<(&'static str, [String; 3])> {
    let summary = &map.summary;
    let sets = [
        ("all cells", Some(&summary.all)),
        ("9 points", summary.nine.as_ref()),
        ("13 points", summary.thirteen.as_ref()),
    ];
    let row = |set: &lumiduct_core::measure::Uniformity| {
        [&set.min_avg, &set.min_max, &set.max_min].map(statistic)
    };
    sets.into_iter().filter_map(|(name, set)| Some((name, row(set?)))).collect()
}

/// The coefficient of variation of a map, in a sentence.
pub(crate) fn variation(map: &SensorMap) -> String {
    let cv = statistic(&map.summary.cv);
    format!("CV (standard deviation over mean, corrected for noise): {cv}")
}

fn statistic(value: &Statistic) -> String {
    if value.status == Status::NoSignal {
        return NOTHING_COUNTED.to_owned();
    }
    let [low, high] = value.interval;
    let number = format_with_error(value.value, value.std_error);
    format!("{number} [{}, {}]{}", format_value(low), format_value(high), remark(value.status))
}

/// Share, mean number of bounces and steps of the strongest path classes.
pub(crate) fn class_rows(classes: &[PathClass]) -> Vec<[String; 3]> {
    strongest(classes, CLASSES_SHOWN)
        .iter()
        .map(|class| [format_percent(class.share), format_value(class.bounces_mean), steps(class)])
        .collect()
}

/// The steps of a class: `pipe.entry T, pipe.wall R`.
fn steps(class: &PathClass) -> String {
    let step = |step: &PathStep| match step.action {
        Action::Reflected => format!("{} R", step.face),
        Action::Transmitted => format!("{} T", step.face),
    };
    let text = class.steps.iter().map(step).collect::<Vec<_>>().join(", ");
    match class.extent {
        ClassExtent::Whole if text.is_empty() => "direct".into(),
        ClassExtent::Whole => text,
        ClassExtent::CutOff => text + ", ...",
        ClassExtent::Others => "all weaker classes".into(),
    }
}

/// Name, flux and share of the lines of the balance worth showing; what is not in the unit of flux, such as heat in W, is no
/// share.
pub(crate) fn balance_lines(report: &Report) -> Vec<(&str, String, String)> {
    let (whole, unit) = (report.measures.source_flux, report.measures.unit.flux());
    let share = |own: &Measure| {
        if own.unit == unit { format_percent(own.value / whole) } else { String::new() }
    };
    let lines = report.measures.values.iter().filter(|(name, measure)| {
        let always = name.ends_with(".leaked") || name.ends_with(".residual");
        name.starts_with("balance.") && (measure.value != 0.0 || always)
    });
    lines.map(|(name, measure)| (name.as_str(), quantity(measure), share(measure))).collect()
}

/// What became of the polarisation of light.
fn polarisation(polarisation: Polarisation) -> &'static str {
    match polarisation {
        Polarisation::Ignored => {
            "light is treated as unpolarised at every interface, which makes transmission slightly too low: by \
             0.46 % for a straight round rod with two polished ends under a Lambertian source, by 0.73 % for a plate under the \
             same, by 3.6 % for a plate of index 1.49 at 75° (examples, not this scene; docs/theory.md, eq. 2)"
        }
        Polarisation::Followed => {
            "polarisation is followed from unpolarised sources through smooth interfaces, metals, mirrors and layers; all \
             that scatters, prism film and mixtures of finishes depolarise (docs/theory.md, eq. 38)"
        }
    }
}

/// The facts of a run, a line each.
pub(crate) fn run_lines(report: &Report) -> Vec<String> {
    let (run, measures) = (&report.run, &report.measures);
    let mut lines = vec![
        format!("scene `{}`, hash {}", report.scene.name, report.scene.hash),
        format!("lumiduct {}, estimator {}, seed {}", run.version, run.estimator.name(), run.seed),
        format!(
            "{} paths in {} batches, {} segments",
            measures.paths, measures.batches, measures.segments
        ),
        format!("requested: {}; ended because {}", run.asked, run.stopped),
        format!("bounce limit {}", run.bounce_limit),
        polarisation(run.polarisation).to_owned(),
    ];
    if !run.gather.is_empty() {
        lines.push(format!("settings of gathering: {}", run.gather));
    }
    if !run.gathering.is_empty() {
        lines.push(format!("gathering: {}", run.gathering));
    }
    if let Some(target) = &run.target {
        lines.push(target.sentence());
    }
    if !report.scene.overrides.is_empty() {
        lines.push(format!("overrides: {}", report.scene.overrides.join(", ")));
    }
    if let Some(command) = &run.repeat {
        lines.push(format!(
            "to repeat these numbers, run this in the folder of the scene: {command}"
        ));
    }
    for leak in &run.leaks {
        lines.push(format!("leak at [{}, {}, {}] mm", leak.x, leak.y, leak.z));
    }
    lines
}

/// A measure with its error, if it has one.
pub(crate) fn measured(found: &Measure) -> String {
    match found.unit.as_str() {
        _ if found.std_error > 0.0 || found.bias.is_some() => quantity(found),
        "1" => format_value(found.value),
        unit => format!("{} {unit}", format_value(found.value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_beyond_an_hour_are_words() {
        assert_eq!(waiting(0.0), "0 s");
        assert_eq!(waiting(0.0312), "0.031 s");
        assert_eq!(waiting(59.0), "59 s");
        assert_eq!(waiting(754.0), "13 min");
        assert_eq!(waiting(7200.0), "hours");
        assert_eq!(waiting(3.2e18), "not in a day");
        assert_eq!(waiting(f64::INFINITY), "not in a day");
    }
}
