//! The search: measure, judge, correct, until the target is reached or nothing more can be done.
//!
//! Every decision follows from the records of the measurements alone.

use crate::optimise::bounds::LengthBounds;
use crate::optimise::end::{Obstacle, SearchStop, reason};
use crate::optimise::feedback::{LARGEST_STEP, ZoneLight, length_after, rounded};
use crate::optimise::judge::{ObjectiveWeights, judge, noise, ratios};
use crate::optimise::law::SizeLaw;
use crate::optimise::least_squares::{StepProblem, best_changes};
use crate::optimise::measure::{DesignToMeasure, MeasureEnd, Measurements};
use crate::optimise::response::{MeasuredOpenings, fit_response};
use lumiduct_base::error::Result;
use lumiduct_base::number::{format_percent, format_with_error};
use lumiduct_input::Vary;
use lumiduct_report::optimise::{Ending, JudgedStep, MeasuredStep, Purpose};

/// Shares of the paths of the last measurements that the first ones have, as divisors.
const PATH_PARTS: [u64; 3] = [16, 4, 1];
/// Steps without a gain beyond the error after which the search ends.
const MOST_STEPS_WITHOUT_GAIN: usize = 3;
/// Errors by which the ratio has to lie above the target, 1.
const SURE: f64 = 2.0;
/// Standard errors by which zones have to deviate beyond noise for a step. Few paths have to show it clearly: more of them, which come
/// anyway, show whether it is real. A step that noise made is taken back later only as far as the later error shows it.
const SEEN_WITH_FEW_PATHS: f64 = 3.0;
const SEEN_WITH_ALL_PATHS: f64 = 2.0;
/// Least share of a correction, after steps that made things worse, 1.
const LEAST_DAMPING: f64 = 0.2;
/// Share of a limit within which it holds a length, 1: damped steps approach it without touching it.
const AT_LIMIT: f64 = 0.01;
/// Factor by which all openings grow at once, for efficiency.
const GROWTH: f64 = 1.3;
/// Most times that they grow.
const MOST_GROWTHS: usize = 12;

/// How a search ended.
pub(crate) struct SearchEnd {
    pub(crate) steps: Vec<JudgedStep>,
    /// Place of the best among the steps.
    pub(crate) best: usize,
    pub(crate) ending: Ending,
    /// Limits that hold at the best, in words.
    pub(crate) active_limits: Vec<String>,
}

/// A search in progress.
pub(crate) struct Search<'a> {
    measurements: &'a Measurements<'a>,
    law: &'a SizeLaw,
    bounds: &'a LengthBounds,
    steps: Vec<JudgedStep>,
    /// Place in [`PATH_PARTS`].
    level: usize,
    damping: f64,
    /// Measurements since the last gain, with this many paths.
    without_gain: usize,
    growths: usize,
    /// Objective of the best before the last growth.
    before_growth: Option<f64>,
}

/// What to do after a measurement.
enum Next {
    /// Measure these lengths.
    Measure(Vec<f64>),
    /// End.
    End(Ending),
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        measurements: &'a Measurements<'a>,
        law: &'a SizeLaw,
        bounds: &'a LengthBounds,
    ) -> Self {
        Self {
            measurements,
            law,
            bounds,
            steps: Vec::new(),
            level: 0,
            damping: measurements.feedback.damping,
            without_gain: 0,
            growths: 0,
            before_growth: None,
        }
    }

    /// Searches from the scene as it is.
    pub(crate) fn run(mut self) -> Result<SearchEnd> {
        let start = &self.measurements.feedback.start;
        let mut values: Vec<f64> =
            self.law.points.iter().map(|point| rounded(start.at(*point))).collect();
        let ending = loop {
            let step = match self.measure(&values)? {
                MeasureEnd::Done(step) => step,
                MeasureEnd::Refused(why) => {
                    break Ending::Refused(format!(
                        "the scene refuses the lengths of step {}: {why}",
                        self.steps.len() + 1
                    ));
                }
                MeasureEnd::Interrupted => break Ending::Interrupted,
            };
            self.judge(*step);
            match self.next() {
                Next::Measure(next) => values = next,
                Next::End(ending) => break ending,
            }
        };
        let best = self.best();
        let active_limits =
            self.steps.get(best).map_or(Vec::new(), |own| self.active_limits(&own.measured.values));
        Ok(SearchEnd { steps: self.steps, best, ending, active_limits })
    }

    fn measure(&self, values: &[f64]) -> Result<MeasureEnd> {
        let feedback = self.measurements.feedback;
        let run = &self.measurements.study.base.run;
        let design = DesignToMeasure {
            purpose: Purpose::Search,
            seed: run.seed,
            estimator: run.estimator,
            paths: (feedback.paths / PATH_PARTS[self.level]).max(1),
            values: values.to_vec(),
            setting: (!self.steps.is_empty()).then(|| self.bounds.table(self.law, values)),
        };
        let best = self.steps.get(self.best()).map(|own| {
            let ratio = own.misfit.min_over_max;
            format!("min/max {}", format_with_error(ratio.value, ratio.std_error))
        });
        self.measurements.measure(self.steps.len() + 1, &design, &best.unwrap_or_default())
    }

    /// Adds a measured design with its judgement: a worse one reduces the damping, one without a gain is counted.
    fn judge(&mut self, measured: MeasuredStep) {
        let misfit = judge(
            &measured,
            &self.measurements.zones.wanted,
            ObjectiveWeights::of(self.measurements.feedback),
        );
        if let Some(last) = self.steps.last() {
            let (old, new) = (&last.misfit.objective, &misfit.objective);
            if new.value > old.value + old.std_error.hypot(new.std_error) {
                let least = LEAST_DAMPING.min(self.measurements.feedback.damping);
                self.damping = (0.7 * self.damping).max(least);
            }
        }
        let gains = |own: &JudgedStep| {
            let (old, new) = (&own.misfit.objective, &misfit.objective);
            new.value + old.std_error.hypot(new.std_error) < old.value
        };
        let is_gain = self.steps.get(self.best()).is_none_or(gains);
        self.without_gain = if is_gain { 0 } else { self.without_gain + 1 };
        self.steps.push(JudgedStep { measured, misfit });
    }

    fn light<'s>(&'s self, step: &'s MeasuredStep) -> ZoneLight<'s> {
        ZoneLight {
            measured: &step.zones,
            wanted: &self.measurements.zones.wanted,
            efficiency: step.efficiency.value.clamp(0.0, 1.0),
        }
    }

    /// A measured design for the fit of the response.
    fn design<'s>(&'s self, step: &'s MeasuredStep) -> MeasuredOpenings<'s> {
        let exponent = exponent(self.measurements.feedback.vary);
        let openings = step.values.iter().map(|value| exponent * value.ln()).collect();
        MeasuredOpenings { openings, light: self.light(step) }
    }

    /// The best step: the one whose objective is surely low; of those that reach the target, if there are any.
    fn best(&self) -> usize {
        let reaches = |own: &JudgedStep| self.reaches(own);
        let any = self
            .steps
            .iter()
            .enumerate()
            .any(|(place, own)| reaches(own) && (place > 0 || self.is_within(0)));
        let bound = |place: &usize| {
            let objective = self.steps[*place].misfit.objective;
            objective.value + objective.std_error
        };
        (0..self.steps.len())
            .filter(|place| !any || reaches(&self.steps[*place]))
            // The scene as it is may lie beyond the limits.
            .filter(|place| *place > 0 || self.steps.len() == 1 || self.is_within(0))
            .min_by(|one, other| bound(one).total_cmp(&bound(other)))
            .unwrap_or(0)
    }

    /// Whether a step reaches the target with all paths.
    fn reaches(&self, step: &JudgedStep) -> bool {
        let feedback = self.measurements.feedback;
        step.measured.paths >= feedback.paths
            && step.misfit.min_over_max.value >= feedback.min_over_max
    }

    /// Whether a step has lengths within their bounds.
    fn is_within(&self, place: usize) -> bool {
        let values = &self.steps[place].measured.values;
        self.clamp_all(values) == *values
    }

    fn next(&mut self) -> Next {
        let feedback = self.measurements.feedback;
        if let Some(why) = self.bounds.contradiction() {
            return Next::End(Ending::ContradictingLimits(why));
        }
        let weights = ObjectiveWeights::of(self.measurements.feedback);
        let wants_light = self.measurements.zones.wanted.iter().any(|wanted| *wanted > 0.0);
        if (weights.uniformity == 0.0 && weights.efficiency == 0.0) || !wants_light {
            let why = "nothing is wanted: the weights of uniformity and efficiency are both 0, or the wanted light is 0 in every \
                       zone; give a weight or the profile a value above 0";
            return Next::End(Ending::ZeroWeight(why.to_owned()));
        }
        let Some(last) = self.steps.last() else {
            return Next::End(Ending::Interrupted);
        };
        let (ratio, is_full) = (last.misfit.min_over_max, self.level + 1 == PATH_PARTS.len());
        let is_reached = ratio.value - SURE * ratio.std_error >= feedback.min_over_max;
        let (next, obstacle) = self.step_from(last);
        let is_moved = next != last.measured.values;
        let scatter = noise(&ratios(&last.measured.zones, &self.measurements.zones.wanted));
        let is_noisy = last.misfit.deviation.value <= 2.0 * scatter;
        let is_over = self.steps.len() >= feedback.steps;
        let is_stuck = self.without_gain >= MOST_STEPS_WITHOUT_GAIN;
        if !is_full && !is_over && (is_reached || is_noisy || is_stuck || !is_moved) {
            (self.level, self.without_gain) = (self.level + 1, 0);
            let same = || self.clamp_all(&last.measured.values);
            return Next::Measure(if is_reached { same() } else { next });
        }
        let is_done = is_reached || !is_moved || is_stuck;
        if is_full
            && is_done
            && !is_over
            && let Some(larger) = self.larger_openings()
        {
            return Next::Measure(larger);
        }
        if (is_full && is_done) || is_over {
            return Next::End(self.ending(obstacle));
        }
        Next::Measure(next)
    }

    /// Lengths clamped to their bounds: those of the scene as it is may lie beyond them.
    fn clamp_all(&self, values: &[f64]) -> Vec<f64> {
        let clamp =
            |(point, value): (usize, &f64)| rounded(self.bounds.clamp(self.law, point, *value));
        values.iter().enumerate().map(clamp).collect()
    }

    /// The lengths after a step, and what keeps points from moving.
    fn step_from(&self, last: &JudgedStep) -> (Vec<f64>, Obstacle) {
        let (feedback, old) = (self.measurements.feedback, &last.measured.values);
        let is_full = self.level + 1 == PATH_PARTS.len();
        let sigmas = if is_full { SEEN_WITH_ALL_PATHS } else { SEEN_WITH_FEW_PATHS };
        let lack = self.light(&last.measured).sure_lack(sigmas);
        let is_noise = lack.iter().flatten().all(|own| *own == 0.0);
        let mut obstacle = Obstacle::default();
        if is_noise {
            obstacle.note_noise();
        }
        if is_noise || feedback.uniformity_weight == 0.0 {
            return (self.clamp_all(old), obstacle);
        }
        let designs: Vec<MeasuredOpenings<'_>> =
            self.steps.iter().map(|own| self.design(&own.measured)).collect();
        let response = fit_response(self.law, &self.measurements.zones.places, &designs);
        let exponent = exponent(feedback.vary);
        let openings: Vec<f64> = old.iter().map(|value| exponent * value.ln()).collect();
        let bounds: Vec<[f64; 2]> = (0..old.len())
            .map(|point| {
                let ends = self.bounds.at(self.law, point);
                let ends = ends.map(|end| exponent * end.ln() - openings[point]);
                let most = exponent.abs() * LARGEST_STEP.ln();
                [ends[0].min(ends[1]), ends[0].max(ends[1])].map(|end| end.clamp(-most, most))
            })
            .collect();
        let problem =
            StepProblem { response: &response, lack: &lack, openings: &openings, bounds: &bounds };
        let found = best_changes(problem).into_iter().zip(old).enumerate();
        let values = found.map(|(point, (own, value))| {
            let wanted = length_after(*value, self.damping * own.change, exponent);
            let next = self.bounds.clamp(self.law, point, wanted);
            let full = length_after(*value, own.change, exponent);
            if own.is_held && !self.bounds.leave_room(self.law, point, full) {
                obstacle.hold(self.law.points[point], next);
            }
            rounded(next)
        });
        let values = values.collect();
        (values, obstacle)
    }

    /// The best lengths with larger openings, where efficiency has a weight, and the last growth paid.
    fn larger_openings(&mut self) -> Option<Vec<f64>> {
        if self.measurements.feedback.efficiency_weight == 0.0 || self.growths >= MOST_GROWTHS {
            return None;
        }
        let best = self.steps.get(self.best())?;
        let objective = best.misfit.objective;
        if self.before_growth.is_some_and(|before| objective.value + objective.std_error >= before)
        {
            return None;
        }
        let factor = GROWTH.powf(1.0 / exponent(self.measurements.feedback.vary));
        let old = &best.measured.values;
        let larger: Vec<f64> = (0..old.len())
            .map(|point| rounded(self.bounds.clamp(self.law, point, factor * old[point])))
            .collect();
        if larger == *old {
            return None;
        }
        self.before_growth = Some(objective.value);
        (self.growths, self.without_gain) = (self.growths + 1, 0);
        Some(larger)
    }

    fn ending(&self, mut obstacle: Obstacle) -> Ending {
        let best = self.best();
        let Some(own) = self.steps.get(best) else { return Ending::Interrupted };
        let goal = self.measurements.feedback.min_over_max;
        if self.reaches(own) {
            return Ending::Reached;
        }
        let is_dark = ratios(&own.measured.zones, &self.measurements.zones.wanted).is_empty();
        if is_dark {
            return Ending::Unreachable(
                "no light reaches the zones of the sensor: place it where the pattern sends its light".to_owned(),
            );
        }
        let found = own.misfit.min_over_max;
        let state = format!(
            "the smallest over the largest ratio is {}, {} is wanted",
            format_with_error(found.value, found.std_error),
            format_percent(goal)
        );
        let scatter = noise(&ratios(&own.measured.zones, &self.measurements.zones.wanted));
        if own.misfit.deviation.value <= 2.0 * scatter {
            obstacle.note_noise();
        }
        let is_over = self.steps.len() >= self.measurements.feedback.steps;
        let stop = match self.without_gain {
            _ if self.measurements.feedback.uniformity_weight == 0.0 => {
                SearchStop::UnweightedDeviations
            }
            0..MOST_STEPS_WITHOUT_GAIN if is_over => SearchStop::OutOfSteps,
            _ => SearchStop::NoGain,
        };
        reason(&state, obstacle, stop, own)
    }

    /// Limits that hold some lengths.
    fn active_limits(&self, values: &[f64]) -> Vec<String> {
        let limit = |(point, value): (usize, &f64)| {
            let ends = self.bounds.at(self.law, point);
            let (end, words) = nearest_limit(*value, ends)?;
            let at = self.law.points[point];
            Some(format!("{at:.4} mm along the face: {} mm is the {words}", rounded(end)))
        };
        values.iter().enumerate().filter_map(limit).collect()
    }
}

/// The limit within [`AT_LIMIT`] of a length, the nearer of both, and what it is in words.
fn nearest_limit(value: f64, [least, greatest]: [f64; 2]) -> Option<(f64, &'static str)> {
    let off = |end: f64| (value / end - 1.0).abs();
    let nearer = if off(least) < off(greatest) { (least, "least") } else { (greatest, "most") };
    (off(nearer.0) <= AT_LIMIT).then_some(nearer)
}

/// Exponent with which the openings follow a length.
fn exponent(vary: Vary) -> f64 {
    match vary {
        Vary::Diameter => 2.0,
        Vary::Radius | Vary::Depth | Vary::Height => 1.0,
        Vary::Pitch => -1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_within_one_percent_holds_a_length_and_of_two_the_nearer_one() {
        let limits = [2.0, 6.0];
        assert_eq!(nearest_limit(2.019, limits), Some((2.0, "least")));
        assert_eq!(nearest_limit(2.021, limits), None);
        assert_eq!(nearest_limit(5.95, limits), Some((6.0, "most")));
        assert_eq!(nearest_limit(5.93, limits), None);
        assert_eq!(nearest_limit(4.03, [4.0, 4.03]), Some((4.03, "most")));
    }
}
