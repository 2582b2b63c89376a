//! How good a design is for a search.

use lumiduct_core::measure::shortfall;
use lumiduct_core::plan::Check;
use lumiduct_input::{Best, Ranking};
use lumiduct_report::study::DesignRecord;

/// What a search knows of a design.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum DesignStanding {
    /// It passes every check. What it costs by each objective, the lower the better: finite numbers.
    Passes(Vec<f64>),
    /// By how much it falls short of its checks, relative to their limits; infinite where nothing could be measured.
    Fails(f64),
}

impl DesignStanding {
    /// That of a record.
    pub(crate) fn of(objectives: &[Ranking], record: &DesignRecord) -> Self {
        let Some(result) = record.outcome.result() else { return Self::Fails(f64::INFINITY) };
        if !record.passes() {
            let of = |check: &Check| {
                result
                    .measures
                    .get(&check.measure)
                    .map_or(f64::INFINITY, |found| shortfall(check, found))
            };
            return Self::Fails(result.checks.iter().map(|own| of(&own.check)).sum());
        }
        let cost = |Ranking { measure, best }: &Ranking| {
            let value = record.measure(measure).map_or(f64::NAN, |own| own.value);
            match best {
                Best::Highest => -value,
                Best::Lowest => value,
            }
        };
        let costs: Vec<f64> = objectives.iter().map(cost).collect();
        match costs.iter().all(|cost| cost.is_finite()) {
            true => Self::Passes(costs),
            false => Self::Fails(f64::INFINITY),
        }
    }

    /// The score by a single objective.
    pub(crate) fn score_of(ranking: &Ranking, record: &DesignRecord) -> f64 {
        Self::of(std::slice::from_ref(ranking), record).score(&Goal::One(0))
    }

    /// What it costs by each objective, if it passes.
    pub(crate) fn costs(&self) -> Option<&[f64]> {
        match self {
            Self::Passes(costs) => Some(costs),
            Self::Fails(_) => None,
        }
    }

    /// What a search minimises: below 1 for a design that passes every check, in the order of its goal; above 1 for others, by their shortfall
    /// (Deb, Comput. Methods Appl. Mech. Eng. 186 (2000) 311).
    pub(crate) fn score(&self, goal: &Goal) -> f64 {
        match self {
            Self::Passes(costs) => {
                let cost = goal.cost(costs);
                cost / (1.0 + cost.abs())
            }
            Self::Fails(shortfall) => 1.0 + shortfall,
        }
    }
}

/// The places of the designs that no other beats: that is as good by every objective, and better by one.
pub(crate) fn unbeaten(costs: &[&[f64]]) -> Vec<usize> {
    let beats = |one: &[f64], other: &[f64]| {
        let mut pairs = one.iter().zip(other);
        one != other && pairs.all(|(one, other)| one <= other)
    };
    let is_beaten = |own: &&[f64]| costs.iter().any(|other| beats(other, own));
    (0..costs.len()).filter(|place| !is_beaten(&costs[*place])).collect()
}

/// What a search makes small.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Goal {
    /// The cost by the objective of this number.
    One(usize),
    /// A mixture of all.
    Mixed(GoalMixture),
}

/// The augmented Chebyshev function of several objectives (Steuer and Choo, Math. Program. 26 (1983) 326), which reaches the hollow parts of a
/// front, too.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GoalMixture {
    /// Of each objective, 1; their sum is 1.
    pub(crate) weights: Vec<f64>,
    /// The lowest cost by each objective, and by how much the highest of the front is above it.
    pub(crate) scales: Vec<[f64; 2]>,
}

/// Weight of the sum of all objectives, 1: of two designs that are as good by the worst objective the better one is preferred (Knowles, IEEE Trans.
/// Evol. Comput. 10 (2006) 50).
const SUM_WEIGHT: f64 = 0.05;

impl Goal {
    fn cost(&self, costs: &[f64]) -> f64 {
        match self {
            Self::One(place) => costs[*place],
            Self::Mixed(GoalMixture { weights, scales }) => {
                let scaled =
                    costs.iter().zip(scales).map(|(cost, [low, span])| (cost - low) / span);
                let worst = scaled.clone().zip(weights).map(|(cost, weight)| weight * cost);
                worst.fold(f64::NEG_INFINITY, f64::max) + SUM_WEIGHT * scaled.sum::<f64>()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::analysis::testing::design;

    #[test]
    fn designs_that_pass_come_before_all_others_whatever_their_values() {
        let score = |best, flux: f64| {
            let ranking = Ranking { measure: "exit.flux".to_owned(), best };
            DesignStanding::of(&[ranking], &design(1, [0.0; 2], flux, 0.0)).score(&Goal::One(0))
        };
        assert!(score(Best::Highest, 1e6) < score(Best::Highest, 1.0));
        assert!(score(Best::Lowest, 1.0) < score(Best::Lowest, 1e6));
        assert!(score(Best::Lowest, 1e6) < DesignStanding::Fails(0.0).score(&Goal::One(0)));
        assert_eq!(score(Best::Lowest, f64::NAN), f64::INFINITY);
    }

    #[test]
    fn the_front_has_all_designs_that_no_other_beats() {
        let costs = [[1.0, 5.0], [2.0, 3.0], [2.0, 4.0], [4.0, 1.0], [4.0, 1.0], [5.0, 1.0]];
        let costs: Vec<&[f64]> = costs.iter().map(|own| &own[..]).collect();
        assert_eq!(unbeaten(&costs), [0, 1, 3, 4]);
        assert_eq!(unbeaten(&[]), [0_usize; 0]);
    }

    #[test]
    fn a_mixture_prefers_the_worst_objective_and_then_the_sum() {
        let weights = vec![0.5, 0.5];
        let goal = Goal::Mixed(GoalMixture { weights, scales: vec![[0.0, 1.0], [10.0, 5.0]] });
        // Scaled: (0.4, 0.4), (0.2, 0.5), (0.2, 0.4).
        let costs = [[0.4, 12.0], [0.2, 12.5], [0.2, 12.0]].map(|costs| goal.cost(&costs));
        let expected = [0.2 + 0.05 * 0.8, 0.25 + 0.05 * 0.7, 0.2 + 0.05 * 0.6];
        assert!(costs.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{costs:?}");
    }
}
