//! A search for the best design: Nelder and Mead's simplex within the ranges of the parameters, restarted where it has converged (Luersen
//! and Le Riche, Comput. Struct. 82 (2004) 2251). `docs/study_format.md` compares it with other methods. Combinations of choices race
//! each other, each with a simplex of its own.
//!
//! A resumed search proposes the same designs again and takes their records.

use crate::study::designs::Design;
use crate::study::execute::{BestDesign, DesignBatch, DesignEnd, DesignTracing, expect_design};
use crate::study::race::{ChoiceSet, Race, ScoredDesign};
use crate::study::sampling::quantile;
use crate::study::score::score;
use basin::{
    BoxBounds, ConstraintDescription, ConstraintSet, ConstraintSolveError, Constraints,
    CostFunction, Executor, Gbnm, PointState,
};
use lumiduct_base::error::{Error, Result};
use lumiduct_input::{Domain, Parameter, Ranking, SearchPlan, Setting};
use lumiduct_report::study::DesignRecord;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Edge of the first simplex, as a share of the ranges, 1.
const FIRST_EDGE: f64 = 0.25;
/// Steps of a range, 1: finer than results are known, and coarse enough to be the same on every machine.
const STEPS: f64 = 1e4;
/// Most proposals for each design, 1: those that round to an earlier design are no new ones.
const MOST_PROPOSALS: u64 = 50;

/// How a search ended.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ProposalEnd {
    /// With this many designs: those of the plan, or fewer if whole numbers leave no others.
    Complete(usize),
    /// It was interrupted.
    Stopped,
}

/// Why a search ends before its method does.
enum ProposalStop {
    /// It has all designs.
    Full,
    Interrupted,
    Failed(Error),
}

/// Searches: every design that it proposes gets its record.
pub(crate) fn search(
    batch: &DesignBatch<'_>,
    plan: &SearchPlan,
    ranking: &Ranking,
) -> Result<ProposalEnd> {
    let mut records = batch.store.records()?;
    let most = plan.designs as usize;
    // Those after them are of production.
    drop(records.split_off(&(most + 1)));
    let pending = most.saturating_sub(records.len());
    let tracing = DesignTracing::new(batch, [most, pending])?;
    let mut least = f64::INFINITY;
    let measured = |design: &Design| {
        let record = recorded(batch, &tracing, design, &mut records)?;
        let score = score(ranking, record);
        if score < least
            && let Some(found) = record.measure(&ranking.measure)
        {
            least = score;
            let (value, error, passes) = (found.value, found.total_error(), record.passes());
            tracing.board.show_best(BestDesign { number: design.number, value, error, passes });
        }
        Ok(score)
    };
    let end = propose(&batch.study.parameters, plan, measured)?;
    let further = match end {
        ProposalEnd::Complete(designs) => records.range(designs + 1..).next(),
        ProposalEnd::Stopped => None,
    };
    match further {
        Some((number, _)) => {
            Err(batch.store.no_record(*number, "the search ends before this design"))
        }
        None => Ok(end),
    }
}

/// Proposes designs; `measured` returns the score of each.
fn propose(
    parameters: &[Parameter],
    plan: &SearchPlan,
    measured: impl FnMut(&Design) -> std::result::Result<f64, ProposalStop>,
) -> Result<ProposalEnd> {
    let most = plan.designs as usize;
    let (measured, known) = (RefCell::new(measured), RefCell::new(Vec::new()));
    let searched = parameters.iter().filter(|own| is_searched(own)).count();
    // A simplex has a design more than there are ranges.
    let mut race = Race::new(parameters, most, searched + 1);
    loop {
        let designs = known.borrow().len();
        let Some(lap) = race.next_lap(designs) else { return Ok(ProposalEnd::Complete(designs)) };
        for (entrant, most) in lap {
            let proposed = Proposed {
                parameters,
                combination: race.combination(entrant),
                most,
                sides: [0.0, 1.0].map(|side| vec![side; searched]),
                measured: &measured,
                known: &known,
            };
            if !propose_within(proposed, plan)? {
                return Ok(ProposalEnd::Stopped);
            }
        }
        race.end_lap(&known.borrow());
    }
}

/// Proposes designs of one combination of choices; `false` if it was interrupted. Designs that are known cost nothing: the
/// simplex takes the same way again.
fn propose_within<Measured>(proposed: Proposed<'_, Measured>, plan: &SearchPlan) -> Result<bool>
where
    Measured: FnMut(&Design) -> std::result::Result<f64, ProposalStop>,
{
    let most = MOST_PROPOSALS * u64::from(plan.designs);
    let searched = proposed.parameters.iter().filter(|own| is_searched(own));
    let start: Vec<f64> = searched.map(|own| nominal_share(own).unwrap_or(0.5)).collect();
    // The first design is the scene as it is, as far as it lies within the ranges.
    let first = proposed.cost(&start).map(|_| ()).map_err(ConstraintSolveError::Evaluation);
    let method = Gbnm::new(plan.seed).with_initial_simplex_fraction(FIRST_EDGE);
    let ended = first.and_then(|()| {
        let executor = Executor::new(proposed, method, PointState::new(start));
        executor.max_cost_evals(most).run().map(|_| ())
    });
    match ended {
        Ok(()) | Err(ConstraintSolveError::Evaluation(ProposalStop::Full)) => Ok(true),
        Err(ConstraintSolveError::Evaluation(ProposalStop::Interrupted)) => Ok(false),
        Err(ConstraintSolveError::Evaluation(ProposalStop::Failed(error))) => Err(error),
        // Bounds that are none; those of shares are 0 and 1.
        Err(_) => Err(Error::Usage("the ranges cannot be searched".to_owned())),
    }
}

/// The record of a design, which is traced if it has none.
fn recorded<'r>(
    batch: &DesignBatch<'_>,
    tracing: &DesignTracing<'_>,
    design: &Design,
    records: &'r mut BTreeMap<usize, DesignRecord>,
) -> std::result::Result<&'r DesignRecord, ProposalStop> {
    let record = match records.entry(design.number) {
        Entry::Occupied(known) => known.into_mut(),
        Entry::Vacant(place) => {
            if batch.interrupt.is_raised() {
                return Err(ProposalStop::Interrupted);
            }
            match tracing.trace_timed(design).map_err(ProposalStop::Failed)? {
                DesignEnd::Stopped => return Err(ProposalStop::Interrupted),
                DesignEnd::Recorded(record) => place.insert(*record),
            }
        }
    };
    expect_design(batch, Some(design), record).map_err(ProposalStop::Failed)?;
    Ok(record)
}

/// Whether a simplex varies a parameter.
fn is_searched(parameter: &Parameter) -> bool {
    match parameter.domain {
        Domain::Uniform { .. } => true,
        Domain::Levels(_) | Domain::Normal { .. } | Domain::Listed | Domain::AsInScene => false,
    }
}

/// Where the value of the scene lies in the range of a parameter, 0..=1; `None` if it is not known or outside.
fn nominal_share(parameter: &Parameter) -> Option<f64> {
    match (&parameter.domain, parameter.nominal.number()) {
        (Domain::Uniform { from, to }, Some(value)) if (*from..=*to).contains(&value) => {
            Some((value - from) / (to - from))
        }
        (
            Domain::Uniform { .. }
            | Domain::Levels(_)
            | Domain::Normal { .. }
            | Domain::Listed
            | Domain::AsInScene,
            _,
        ) => None,
    }
}

/// What a parameter is set to at a share of its range, in whole steps; the value of the scene where it lies within the same step.
fn setting(parameter: &Parameter, share: f64) -> Setting {
    let step = |share: f64| (share.clamp(0.0, 1.0) * STEPS).round();
    match nominal_share(parameter) {
        Some(nominal) if step(nominal) == step(share) => parameter.nominal.clone(),
        Some(_) | None => quantile(parameter, step(share) / STEPS),
    }
}

/// Designs of a combination of choices, as a function of the shares of the ranges of all else.
struct Proposed<'a, Measured> {
    parameters: &'a [Parameter],
    combination: &'a ChoiceSet,
    /// Most designs of this combination.
    most: usize,
    /// The lowest and the highest shares.
    sides: [Vec<f64>; 2],
    measured: &'a RefCell<Measured>,
    /// The designs so far, of any combination.
    known: &'a RefCell<Vec<ScoredDesign>>,
}

impl<Measured> Proposed<'_, Measured>
where
    Measured: FnMut(&Design) -> std::result::Result<f64, ProposalStop>,
{
    /// The score of a design with these settings, which is measured if it is a new one.
    fn score_of(&self, settings: Vec<Setting>) -> std::result::Result<f64, ProposalStop> {
        let mut known = self.known.borrow_mut();
        if let Some(known) = known.iter().find(|own| own.settings == settings) {
            return Ok(known.score);
        }
        if known.iter().filter(|own| self.combination.is_of(&own.settings)).count() >= self.most {
            return Err(ProposalStop::Full);
        }
        let design = Design { number: known.len() + 1, settings };
        let score = (self.measured.borrow_mut())(&design)?;
        known.push(ScoredDesign { settings: design.settings, score });
        Ok(score)
    }
}

impl<Measured> Constraints for Proposed<'_, Measured> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        let [low, high] = &self.sides;
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(low), Some(high)))
    }
}

impl<Measured> CostFunction for Proposed<'_, Measured>
where
    Measured: FnMut(&Design) -> std::result::Result<f64, ProposalStop>,
{
    type Param = Vec<f64>;
    type Output = f64;
    type Error = ProposalStop;

    fn cost(&self, shares: &Vec<f64>) -> std::result::Result<f64, ProposalStop> {
        let mut shares = shares.iter();
        let setting = |parameter: &Parameter| match is_searched(parameter) {
            true => shares.next().map_or(Setting::AsInScene, |share| setting(parameter, *share)),
            false => Setting::AsInScene,
        };
        let mut settings: Vec<Setting> = self.parameters.iter().map(setting).collect();
        self.combination.set(&mut settings);
        self.score_of(settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use indexmap::IndexMap;
    use rand_core::{Rng, SeedableRng};
    use rand_xoshiro::SplitMix64;

    fn parameter(name: &str, [from, to]: [f64; 2], nominal: f64) -> Parameter {
        Parameter {
            name: name.to_owned(),
            unit: None,
            ties: Vec::new(),
            domain: Domain::Uniform { from, to },
            choices: IndexMap::new(),
            nominal: Setting::Number(nominal),
            whole: false,
            tolerance: None,
        }
    }

    fn plan(designs: u32, seed: u64) -> SearchPlan {
        SearchPlan { designs, seed, cost: IndexMap::new(), samples: None }
    }

    /// The designs of a search for the least of a function, in their order.
    fn searched(
        parameters: &[Parameter],
        plan: &SearchPlan,
        mut of: impl FnMut(&[f64]) -> f64,
    ) -> Vec<Vec<f64>> {
        let mut designs = Vec::new();
        let end = propose(parameters, plan, |design| {
            let settings: Vec<f64> =
                design.settings.iter().map(|own| own.number().unwrap()).collect();
            designs.push(settings.clone());
            Ok(of(&settings))
        });
        let ProposalEnd::Complete(count) = end.unwrap_or_else(|error| panic!("{error}")) else {
            panic!("it was not stopped")
        };
        assert_eq!(count, designs.len());
        designs
    }

    #[test]
    fn a_curved_valley_is_followed_in_spite_of_noise() {
        // Rosenbrock, Comput. J. 3 (1960) 175: 0 at (1, 1). Here with noise of 0.01, which the search does not see as such.
        let valley =
            |x: &[f64]| ((1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2)).ln_1p();
        let sides = [parameter("x", [-2.0, 2.0], -1.2), parameter("y", [-1.0, 3.0], 1.0)];
        for seed in 1..=5 {
            let mut random = SplitMix64::seed_from_u64(seed);
            // Variance 1 by the sum of twelve.
            let mut noise =
                || (0..12).map(|_| random.next_u64() as f64 / 2f64.powi(64)).sum::<f64>() - 6.0;
            let mut values = Vec::new();
            let designs = searched(&sides, &plan(160, seed), |x| {
                values.push(valley(x) + 0.01 * noise());
                *values.last().unwrap()
            });
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            let best = values.iter().position(|value| *value == least).unwrap();
            assert!(valley(&designs[best]) < 0.3, "seed {seed}: {:?}", designs[best]);
            assert!((designs[0][0] + 1.2).abs() < 1e-9, "it begins at the scene");
            assert!(designs.iter().all(|own| own[0].abs() <= 2.0 && (own[1] - 1.0).abs() <= 2.0));
        }
    }

    #[test]
    fn the_second_design_is_not_the_first_again() {
        // 10 is no whole step of this range.
        let length = parameter("length", [1.0, 20.0], 10.0);
        let designs = searched(&[length], &plan(6, 1), |x| (x[0] - 4.0).powi(2));
        assert_eq!(designs[0], [10.0]);
        assert!((designs[1][0] - 10.0).abs() > 0.1, "{designs:?}");
    }

    #[test]
    fn whole_numbers_are_each_tried_once_and_then_it_ends() {
        let whole = Parameter { whole: true, ..parameter("n", [1.0, 5.0], 4.0) };
        let mut designs = searched(&[whole], &plan(50, 1), |x| (x[0] - 2.0).powi(2));
        assert_eq!(designs[0], [4.0]);
        designs.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert!(designs.windows(2).all(|pair| pair[0] != pair[1]) && designs.len() <= 5);
        assert!(designs.contains(&vec![2.0]), "{designs:?}");
    }

    #[test]
    fn the_best_choice_is_found_and_gets_most_of_the_designs() {
        let colours = ["red", "green", "blue"];
        let levels = colours.map(|own| Setting::Choice(own.to_owned())).to_vec();
        let choice = Parameter {
            domain: Domain::Levels(levels),
            nominal: Setting::AsInScene,
            ..parameter("colour", [0.0, 1.0], 0.5)
        };
        let mut designs = Vec::new();
        let end = propose(&[choice, parameter("x", [0.0, 1.0], 0.5)], &plan(60, 1), |design| {
            let [Setting::Choice(colour), Setting::Number(x)] = &design.settings[..] else {
                panic!("{:?}", design.settings)
            };
            designs.push(colour.clone());
            let least = [("red", 0.5), ("green", 0.0), ("blue", 0.2)];
            Ok(least.iter().find(|own| own.0 == colour).unwrap().1 + (x - 0.3).powi(2))
        });
        assert!(matches!(end, Ok(ProposalEnd::Complete(60))));
        // Three laps of 20 designs: of 6, 10 and 20 each, as far as they divide.
        let of = |colour: &str| designs.iter().filter(|own| *own == colour).count();
        assert_eq!(colours.map(of), [6, 38, 16]);
    }
}
