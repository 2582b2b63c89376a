//! The directions in which a search looks for a front. Each direction, a set of weights of the objectives, has a search of its
//! own for the least of their mixture. `benches/search` compares it with other methods.

use crate::study::score::{DesignStanding, Goal, GoalMixture, unbeaten};
use lumiduct_input::SearchPlan;

/// Mean number of designs of a direction for each corner of a simplex, at least, where there are more directions than the fewest.
const DESIGNS_PER_CORNER: usize = 4;
/// Steps from one objective to another, at least: with the middle between them.
const LEAST_STEPS: usize = 2;

/// The weights of the objectives in all directions: first each objective alone, then from the middle outward. They lie evenly, on the lattice of Das and
/// Dennis (SIAM J. Optim. 8 (1998) 631), and are as many as `designs` allow.
pub(crate) fn directions(plan: &SearchPlan, ranges: usize, designs: usize) -> Vec<Vec<f64>> {
    let objectives = plan.objectives.len();
    let most = designs / (DESIGNS_PER_CORNER * (ranges + 1));
    let fits = |steps: &usize| lattice(objectives, *steps).len() <= most;
    let steps = (LEAST_STEPS + 1..).take_while(fits).last().unwrap_or(LEAST_STEPS);
    let mut all = lattice(objectives, steps);
    let largest = |own: &Vec<usize>| own.iter().copied().max().unwrap_or(0);
    all.sort_by_key(|own| if largest(own) == steps { 0 } else { largest(own) });
    let share = |part: &usize| *part as f64 / steps as f64;
    all.iter().map(|own| own.iter().map(share).collect()).collect()
}

/// All ways to divide `steps` among some objectives, those with more for the first of them first.
fn lattice(objectives: usize, steps: usize) -> Vec<Vec<usize>> {
    if objectives == 1 {
        return vec![vec![steps]];
    }
    let with = |own: usize| {
        let rest = lattice(objectives - 1, steps - own).into_iter();
        rest.map(move |rest| std::iter::once(own).chain(rest).collect())
    };
    (0..=steps).rev().flat_map(with).collect()
}

/// Whether a direction has one objective alone: an end of the front. Its search starts at the scene as it is, since the best designs for another
/// objective may lie where this one only becomes worse at first.
pub(crate) fn is_end(weights: &[f64]) -> bool {
    weights.contains(&1.0)
}

/// The weight of a direction when it is given its share of the designs, 1: the ends of the front scale all others.
pub(crate) fn share_weight(weights: &[f64]) -> usize {
    if is_end(weights) { 2 } else { 1 }
}

/// The goal of a direction, on the scales of the designs known so far.
pub(crate) fn goal(weights: Vec<f64>, known: &[&DesignStanding]) -> Goal {
    let costs: Vec<&[f64]> = known.iter().filter_map(|own| own.costs()).collect();
    if costs.is_empty() {
        return Goal::One(weights.iter().position(|weight| *weight == 1.0).unwrap_or(0));
    }
    // One end of the front alone has no span.
    let scaling = if is_end(&weights) { (0..costs.len()).collect() } else { unbeaten(&costs) };
    let scale = |place: usize| {
        let own = scaling.iter().map(|design| costs[*design][place]);
        let low = own.clone().fold(f64::INFINITY, f64::min);
        let span = own.fold(f64::NEG_INFINITY, f64::max) - low;
        [low, if span > 0.0 { span } else { 1.0 }]
    };
    let scales = (0..weights.len()).map(scale).collect();
    Goal::Mixed(GoalMixture { weights, scales })
}

#[cfg(test)]
mod tests {
    use super::*;
    use indexmap::IndexMap;
    use lumiduct_input::{Best, Ranking};

    fn of(objectives: usize, ranges: usize, designs: usize) -> Vec<Vec<f64>> {
        let objective = |number: usize| Ranking { measure: number.to_string(), best: Best::Lowest };
        let plan = SearchPlan {
            designs: designs as u32,
            seed: 1,
            cost: IndexMap::new(),
            objectives: (0..objectives).map(objective).collect(),
            least_gain: None,
            samples: None,
        };
        let all = directions(&plan, ranges, designs);
        assert!(all.iter().map(|own| share_weight(own)).sum::<usize>() >= plan.least_shares());
        all
    }

    #[test]
    fn directions_begin_at_the_objectives_and_go_outward_from_the_middle() {
        let few = [[1.0, 0.0], [0.0, 1.0], [0.5, 0.5]];
        assert_eq!(of(2, 3, 20), few);
        assert_eq!(of(2, 3, 63), few);
        let many = [[1.0, 0.0], [0.0, 1.0], [0.5, 0.5], [0.75, 0.25], [0.25, 0.75]];
        assert_eq!(of(2, 3, 80), many);
        let three = of(3, 2, 72);
        assert_eq!(three[..3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(three[3..], [[0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]]);
        assert_eq!(of(3, 2, 120).len(), 10);
        assert!(of(3, 2, 120).iter().all(|own| (own.iter().sum::<f64>() - 1.0).abs() < 1e-12));
    }

    #[test]
    fn scales_are_those_of_the_front_and_at_its_ends_of_all_that_pass() {
        let passing = [[1.0, 5.0], [4.0, 1.0], [100.0, 100.0]];
        let known: Vec<DesignStanding> =
            passing.map(|own| DesignStanding::Passes(own.to_vec())).to_vec();
        let known: Vec<&DesignStanding> =
            known.iter().chain([&DesignStanding::Fails(0.1)]).collect();
        let Goal::Mixed(GoalMixture { scales, .. }) = goal(vec![0.5, 0.5], &known) else {
            panic!()
        };
        assert_eq!(scales, [[1.0, 3.0], [1.0, 4.0]]);
        let Goal::Mixed(GoalMixture { scales, .. }) = goal(vec![0.0, 1.0], &known) else {
            panic!()
        };
        assert_eq!(scales, [[1.0, 99.0], [1.0, 99.0]]);
        assert_eq!(goal(vec![0.0, 1.0], &known[3..]), Goal::One(1));
    }
}
