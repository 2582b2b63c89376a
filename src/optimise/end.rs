//! Why a search ended without its target, in words that say what to change.

use lumiduct_base::number::format_percent;
use lumiduct_report::optimise::{Ending, JudgedStep};

/// What keeps the lengths of a step from changing.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Obstacle {
    /// Every deviation lies within its error.
    is_noise: bool,
    /// Points at a bound that had to go further: place and length, mm.
    held: Vec<[f64; 2]>,
}

impl Obstacle {
    /// Notes that noise is as large as the deviations.
    pub(crate) fn note_noise(&mut self) {
        self.is_noise = true;
    }

    /// Notes a point that is held at a length.
    pub(crate) fn hold(&mut self, place: f64, length: f64) {
        self.held.push([place, length]);
    }
}

/// What ends a search without its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SearchStop {
    /// All steps are made.
    OutOfSteps,
    /// Lengths move no more, or their steps gain nothing.
    NoGain,
    /// Deviations have no weight: no step makes the light more even.
    UnweightedDeviations,
}

/// The ending of a search that did not reach its target.
pub(crate) fn reason(
    state: &str,
    obstacle: Obstacle,
    stop: SearchStop,
    best: &JudgedStep,
) -> Ending {
    let Obstacle { is_noise, held } = obstacle;
    if stop == SearchStop::OutOfSteps {
        return Ending::OutOfSteps(format!(
            "the steps were not enough to reach the target with all paths: {state}; raise `steps`"
        ));
    }
    if stop == SearchStop::UnweightedDeviations {
        return Ending::NoProgress(format!(
            "no step makes the light more even, as `uniformity_weight` is 0: {state}; give it a value above 0, or lower `min_over_max`"
        ));
    }
    if let [first, ..] = held.as_slice() {
        let [place, length] = first;
        let more = match held.len() {
            1 => String::new(),
            2 => " and 1 more point".to_owned(),
            count => format!(" and {} more points", count - 1),
        };
        return Ending::Unreachable(format!(
            "the target is out of reach within the limits: {state}; {length} mm holds at {place:.4} mm along the face{more}; change \
             `limits`, `bridge_mm` or the guide"
        ));
    }
    if is_noise {
        return Ending::HiddenByNoise(format!(
            "noise hides every step: {state}, and the deviations are at most twice their noise at {} paths; the deviation beyond noise is {}; \
             raise `run.paths`, or give the sensor fewer cells along the face",
            best.measured.paths,
            format_percent(best.misfit.deviation.value)
        ));
    }
    Ending::NoProgress(format!(
        "steps improve nothing beyond the error: {state}; the law cannot follow the light more closely: give a spline more knots, use a \
         `table`, or move the sensor nearer to the elements"
    ))
}
