//! Whether measures meet the demands of the scene.
//!
//! A demand that the error bar leaves open is undecided, which counts as missed: more paths are
//! needed.

use crate::measure::{Measure, Measures, Status};
use crate::plan::Check;
use crate::tally::sigmas;
use lumiduct_base::number::format_value;
use serde::{Deserialize, Serialize};

/// A limit nearer to the value than this many total errors is undecided.
const LIMIT_ERRORS: f64 = 3.0;
/// From this many errors on, the exact number does not matter.
const FAR_ERRORS: f64 = 100.0;
/// Possible relative rounding of a value without noise: sums over many paths keep 12 digits or
/// more.
const ROUNDING: f64 = 1e-9;
/// Deviation from `equals` that passes, in total errors, where the check names neither `sigmas` nor `within`.
const DEFAULT_SIGMAS: f64 = 4.0;
/// Number of known names suggested for an unknown one.
const SUGGESTIONS: usize = 3;

/// The outcome of a check and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Verdict {
    /// The outcome.
    pub outcome: CheckOutcome,
    /// A sentence: value, demand, and by how much.
    pub reason: String,
}

/// The outcome of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CheckOutcome {
    /// The demand is met.
    Passed,
    /// The error bar leaves it open.
    Undecided,
    /// It is not met.
    Failed,
    /// There is no such measure.
    Unknown,
}

impl CheckOutcome {
    /// Whether a check counts as failed: its demand is not met, or nothing can ever meet it.
    pub fn is_failure(self) -> bool {
        match self {
            Self::Failed | Self::Unknown => true,
            Self::Passed | Self::Undecided => false,
        }
    }
}

/// Judges a check. All of its demands must be met; the worst of them decides.
///
/// * `min` and `max`: undecided within 3 total errors (noise and bias) of the limit.
/// * A value without noise meets a limit or an expected value if it differs from it only by
///   rounding, a relative 1e-9.
/// * `equals`: passes within `within`, or within `sigmas` total errors; either suffices. Without both, 4 total errors. With
///   `within` alone, undecided up to 3 total errors beyond it.
/// * `max_std_error`: a larger standard error leaves a check undecided that would pass.
/// * A value that cannot be relied on is undecided, with one exception: nothing counted is at most
///   three paths' flux.
pub fn verdict(check: &Check, measures: &Measures) -> Verdict {
    match measures.values.get(&check.measure) {
        Some(measure) => judge(check, measure),
        None => unknown(check, measures.values.keys().map(String::as_str)),
    }
}

/// How far a measure is from passing a check, relative to what is asked for: 0 if it passes, infinite where it is not known.
pub fn shortfall(check: &Check, measure: &Measure) -> f64 {
    if judge(check, measure).outcome == CheckOutcome::Passed {
        return 0.0;
    }
    let relative = |lack: f64, wanted: f64| {
        let scale = if wanted == 0.0 { 1.0 } else { wanted.abs() };
        if lack.is_nan() { f64::INFINITY } else { lack.max(0.0) / scale }
    };
    let (value, margin) = (measure.value, LIMIT_ERRORS * measure.total_error());
    let min = check.min.map(|min| relative(min + margin - value, min));
    let max = check.max.map(|max| relative(value + margin - max, max));
    let equals = check.equals.map(|expected| {
        let [allowed, open] = tolerance(check, measure);
        relative((value - expected).abs() + open - allowed, expected)
    });
    let noise = check.max_std_error.map(|most| relative(measure.std_error - most, most));
    // What cannot be relied on is worse than any number.
    let doubt = doubt(measure).map(|_| 1.0);
    [min, max, equals, noise, doubt].into_iter().flatten().sum()
}

fn judge(check: &Check, measure: &Measure) -> Verdict {
    let mut findings: Vec<(CheckOutcome, String)> = Vec::new();
    findings.extend(check.min.map(|min| limit(measure, min, Bound::Least)));
    findings.extend(check.max.map(|max| limit(measure, max, Bound::Greatest)));
    findings.extend(check.equals.map(|expected| equality(check, measure, expected)));
    if let Some(wanted) = check.max_std_error
        && (measure.std_error > wanted || measure.std_error.is_nan())
    {
        let text = format!("its standard error is not below {wanted}");
        findings.push((CheckOutcome::Undecided, text));
    }
    if let Some(doubt) = doubt(measure) {
        // A numerical failure cannot be relied on either.
        findings.retain(|(outcome, _)| *outcome == CheckOutcome::Undecided);
        findings.push((CheckOutcome::Undecided, doubt.to_owned()));
    }
    let outcome =
        findings.iter().map(|(outcome, _)| *outcome).max().unwrap_or(CheckOutcome::Passed);
    // Of several demands, only the deciding ones are reported.
    let told: Vec<&str> =
        findings.iter().filter(|(own, _)| *own == outcome).map(|(_, text)| text.as_str()).collect();
    Verdict { outcome, reason: format!("{} = {measure}: {}", check.measure, told.join("; ")) }
}

/// Why a measure cannot be judged at all. A count of nothing can be judged: its error is the flux
/// of a path, or infinite.
fn doubt(measure: &Measure) -> Option<&'static str> {
    match measure.status {
        Status::Ok | Status::BiasInNoise | Status::NoSignal => None,
        Status::TooFew => Some("too little was counted to rely on it"),
        Status::NoiseLimited => Some("it is mostly noise"),
        Status::Undefined => Some("light of this colour has no such value"),
        Status::BiasNotResolved => Some("its bias is not resolved"),
        Status::Contradicted => {
            Some("photons of the same run found more light there; use `forward` or `mix`")
        }
    }
}

#[derive(Clone, Copy)]
enum Bound {
    Least,
    Greatest,
}

fn limit(measure: &Measure, limit: f64, bound: Bound) -> (CheckOutcome, String) {
    let (room, word) = match bound {
        Bound::Least => (measure.value - limit, "least"),
        Bound::Greatest => (limit - measure.value, "most"),
    };
    let unit = if measure.unit == "1" { "" } else { &measure.unit };
    let wanted = format!("at {word} {limit} {unit}");
    let wanted = wanted.trim_end();
    let error = measure.total_error();
    if !room.is_finite() || !error.is_finite() {
        return (
            CheckOutcome::Undecided,
            format!("{wanted} is required, but the value is not known"),
        );
    }
    if room.abs() <= rounding(measure, limit) {
        return (CheckOutcome::Passed, format!("{wanted} is required, met to rounding"));
    }
    if room.abs() < LIMIT_ERRORS * error {
        return (
            CheckOutcome::Undecided,
            format!("{wanted} is required, and the value is within {LIMIT_ERRORS} errors of it"),
        );
    }
    // Infinite for a value without noise.
    let errors = room.abs() / error;
    let apart =
        if errors < FAR_ERRORS { format!(", {errors:.1} errors away") } else { String::new() };
    if room >= 0.0 {
        (CheckOutcome::Passed, format!("{wanted} is required{apart}"))
    } else {
        (
            CheckOutcome::Failed,
            format!("{wanted} is required, missed by {}{apart}", format_value(-room)),
        )
    }
}

/// Deviation from an expected number that is due to rounding: only for values without noise.
fn rounding(measure: &Measure, expected: f64) -> f64 {
    let room = ROUNDING * measure.value.abs().max(expected.abs());
    if measure.total_error() <= room { room } else { 0.0 }
}

/// The deviation from `equals` that passes, and how far beyond it a check is undecided.
fn tolerance(check: &Check, measure: &Measure) -> [f64; 2] {
    let error = measure.total_error();
    let default = if check.within.is_some() { 0.0 } else { DEFAULT_SIGMAS };
    let wanted = check.sigmas.unwrap_or(default);
    // Zero errors allow nothing, even where the error is not known.
    let by_error = if wanted > 0.0 { wanted * error } else { 0.0 };
    let open =
        if check.within.is_some() && check.sigmas.is_none() { LIMIT_ERRORS * error } else { 0.0 };
    [by_error.max(check.within.unwrap_or(0.0)), open]
}

fn equality(check: &Check, measure: &Measure, expected: f64) -> (CheckOutcome, String) {
    let deviation = measure.value - expected;
    let error = measure.total_error();
    let [allowed, open] = tolerance(check, measure);
    let rounding = rounding(measure, expected);
    let allowed = allowed.max(rounding);
    let z = sigmas(measure.value, error, expected);
    let errors =
        if rounding == 0.0 && z.is_finite() { format!(" ({z:.1} errors)") } else { String::new() };
    let text = format!(
        "{expected} is expected; the deviation is {}{errors}, {} is allowed",
        format_value(deviation),
        format_value(allowed)
    );
    if measure.status == Status::NoSignal
        && expected != 0.0
        && deviation.abs() > check.within.unwrap_or(0.0)
    {
        (CheckOutcome::Undecided, format!("{expected} is expected, but nothing was counted"))
    } else if !deviation.is_finite() || !allowed.is_finite() {
        (
            CheckOutcome::Undecided,
            format!("{expected} is expected, but the error of the value is not known"),
        )
    } else if deviation.abs() <= allowed {
        (CheckOutcome::Passed, text)
    } else if deviation.abs() < allowed + open {
        (CheckOutcome::Undecided, format!("{text}, and {LIMIT_ERRORS} errors leave it open"))
    } else {
        (CheckOutcome::Failed, text)
    }
}

fn unknown<'a>(check: &Check, names: impl Iterator<Item = &'a str>) -> Verdict {
    let nearest = nearest(&check.measure, names);
    let hint = if nearest.is_empty() {
        String::new()
    } else {
        format!("; nearest names: {}", nearest.join(", "))
    };
    let reason = format!("there is no measure `{}`{hint}", check.measure);
    Verdict { outcome: CheckOutcome::Unknown, reason }
}

/// The known names nearest to a word, the nearest first.
pub fn nearest<'a>(word: &str, names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut scored: Vec<(f64, &str)> =
        names.map(|name| (strsim::jaro_winkler(word, name), name)).collect();
    // A stable sort: equally near names keep the order of the measures.
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    scored.into_iter().take(SUGGESTIONS).map(|(_, name)| name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::value::tests::measure;

    fn check() -> Check {
        Check {
            measure: "exit.flux".into(),
            min: None,
            max: None,
            equals: None,
            within: None,
            sigmas: None,
            max_std_error: None,
            source: None,
        }
    }

    fn outcome(check: &Check, measure: &Measure) -> CheckOutcome {
        judge(check, measure).outcome
    }

    #[test]
    fn limits_within_three_errors_are_undecided() {
        let least = Check { min: Some(0.60), ..check() };
        assert_eq!(outcome(&least, &measure(0.635, 0.01, "lm")), CheckOutcome::Passed);
        assert_eq!(outcome(&least, &measure(0.625, 0.01, "lm")), CheckOutcome::Undecided);
        assert_eq!(outcome(&least, &measure(0.575, 0.01, "lm")), CheckOutcome::Undecided);
        assert_eq!(outcome(&least, &measure(0.565, 0.01, "lm")), CheckOutcome::Failed);
        let most = Check { max: Some(0.60), ..check() };
        assert_eq!(outcome(&most, &measure(0.635, 0.01, "lm")), CheckOutcome::Failed);
        assert_eq!(outcome(&most, &measure(0.565, 0.01, "lm")), CheckOutcome::Passed);
        let mut biased = measure(0.565, 0.01, "lm");
        biased.bias = Some(0.01);
        assert_eq!(outcome(&most, &biased), CheckOutcome::Undecided);
    }

    #[test]
    fn a_shortfall_is_0_only_where_the_check_passes() {
        let least = Check { min: Some(0.5), ..check() };
        assert_eq!(shortfall(&least, &measure(0.54, 0.01, "lm")), 0.0);
        let open = shortfall(&least, &measure(0.52, 0.01, "lm"));
        assert!((open - 0.02).abs() < 1e-12, "{open}");
        let failed = shortfall(&least, &measure(0.25, 0.0, "lm"));
        assert_eq!(failed, 0.5);
        let exact = Check { equals: Some(2.0), within: Some(0.1), ..check() };
        assert_eq!(shortfall(&exact, &measure(2.05, 0.0, "lm")), 0.0);
        let off = shortfall(&exact, &measure(3.1, 0.0, "lm"));
        assert!((off - 0.5).abs() < 1e-12, "{off}");
        let sharp = Check { max_std_error: Some(0.01), ..check() };
        assert_eq!(shortfall(&sharp, &measure(1.0, 0.02, "lm")), 1.0);
        // What is not known is never better than a number.
        assert_eq!(shortfall(&least, &measure(f64::NAN, 0.01, "lm")), f64::INFINITY);
        let few = Measure { status: Status::TooFew, ..measure(0.9, 0.01, "lm") };
        assert_eq!(shortfall(&least, &few), 1.0);
    }

    #[test]
    fn a_value_without_error_may_touch_its_limit() {
        let none = Check { max: Some(0.0), ..check() };
        assert_eq!(outcome(&none, &measure(0.0, 0.0, "lm")), CheckOutcome::Passed);
        assert_eq!(outcome(&none, &measure(1e-12, 0.0, "lm")), CheckOutcome::Failed);
    }

    #[test]
    fn a_value_without_noise_is_judged_up_to_rounding() {
        let lossless = measure(1.0 + 4.5e-16, 0.0, "1");
        let most = Check { max: Some(1.0), ..check() };
        assert_eq!(outcome(&most, &lossless), CheckOutcome::Passed);
        assert_eq!(outcome(&most, &measure(1.0 + 1e-8, 0.0, "1")), CheckOutcome::Failed);
        let rounded = measure(1.0 + 4.5e-16, 1e-17, "1");
        assert_eq!(outcome(&most, &rounded), CheckOutcome::Passed);
        let exact = Check { equals: Some(1.0), sigmas: Some(4.0), ..check() };
        assert_eq!(outcome(&exact, &lossless), CheckOutcome::Passed);
        assert_eq!(outcome(&exact, &rounded), CheckOutcome::Passed);
        assert_eq!(outcome(&exact, &measure(1.0 + 1e-8, 0.0, "1")), CheckOutcome::Failed);
        for value in [1.0 + 4.5e-16, 1.0 + 1e-8, 0.0, 2.0] {
            for check in [&most, &exact] {
                let reason = judge(check, &measure(value, 0.0, "1")).reason;
                assert!(!reason.contains("inf"), "{reason}");
            }
        }
        // Noise is not rounding.
        assert_eq!(outcome(&most, &measure(1.0 + 1e-10, 1e-6, "1")), CheckOutcome::Undecided);
    }

    #[test]
    fn equality_passes_by_errors_or_by_an_absolute_deviation() {
        let value = measure(0.530, 0.01, "lm");
        let equals = |within, sigmas| Check { equals: Some(0.5), within, sigmas, ..check() };
        assert_eq!(outcome(&equals(None, None), &value), CheckOutcome::Passed);
        assert_eq!(outcome(&equals(None, Some(2.0)), &value), CheckOutcome::Failed);
        assert_eq!(outcome(&equals(Some(0.02), None), &value), CheckOutcome::Undecided);
        assert_eq!(outcome(&equals(Some(0.001), None), &value), CheckOutcome::Undecided);
        let off = measure(0.535, 0.01, "lm");
        assert_eq!(outcome(&equals(Some(0.001), None), &off), CheckOutcome::Failed);
        assert_eq!(outcome(&equals(Some(0.031), None), &value), CheckOutcome::Passed);
        assert_eq!(outcome(&equals(Some(0.02), Some(4.0)), &value), CheckOutcome::Passed);
        let exact = Check { equals: Some(0.0), ..check() };
        assert_eq!(outcome(&exact, &measure(0.0, 0.0, "lm")), CheckOutcome::Passed);
        assert_eq!(outcome(&exact, &measure(0.0, f64::INFINITY, "lm")), CheckOutcome::Undecided);
    }

    #[test]
    fn an_error_above_its_limit_leaves_the_check_undecided() {
        let strict = Check { equals: Some(0.5), max_std_error: Some(0.001), ..check() };
        assert_eq!(outcome(&strict, &measure(0.5, 0.01, "lm")), CheckOutcome::Undecided);
        assert_eq!(outcome(&strict, &measure(0.5, 0.001, "lm")), CheckOutcome::Passed);
        assert_eq!(outcome(&strict, &measure(0.6, 0.001, "lm")), CheckOutcome::Failed);
    }

    #[test]
    fn what_cannot_be_relied_on_is_undecided_and_darkness_is_a_small_flux() {
        let least = Check { min: Some(0.1), ..check() };
        let mut few = measure(0.9, 0.01, "lm");
        few.status = Status::TooFew;
        assert_eq!(outcome(&least, &few), CheckOutcome::Undecided);
        let mut dark = measure(0.0, 1e-6, "lm");
        dark.status = Status::NoSignal;
        assert_eq!(outcome(&least, &dark), CheckOutcome::Failed);
        let stray = |max| Check { max: Some(max), ..check() };
        assert_eq!(outcome(&stray(1e-3), &dark), CheckOutcome::Passed);
        assert_eq!(outcome(&stray(2e-6), &dark), CheckOutcome::Undecided);
        dark.std_error = f64::INFINITY;
        assert_eq!(outcome(&stray(1e-3), &dark), CheckOutcome::Undecided);
    }

    #[test]
    fn the_reason_tells_value_demand_and_distance() {
        let least = Check { min: Some(0.6), max: Some(0.9), ..check() };
        let verdict = judge(&least, &measure(0.5, 0.01, "lm"));
        assert_eq!(
            verdict.reason,
            "exit.flux = 0.500 ± 0.010 lm: at least 0.6 lm is required, missed by 0.1, 10.0 errors away"
        );
    }

    #[test]
    fn an_unknown_measure_is_answered_with_the_nearest_names() {
        let verdict =
            unknown(&check(), ["far.flux", "exit.flux.from.led", "balance.cut"].into_iter());
        assert_eq!(verdict.outcome, CheckOutcome::Unknown);
        assert!(verdict.reason.contains("nearest names: exit.flux.from.led"), "{}", verdict.reason);
    }
}
