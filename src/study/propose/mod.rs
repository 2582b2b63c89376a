//! Which designs a search traces: those of Nelder and Mead's simplex within the ranges of the parameters, restarted where it has converged (Luersen
//! and Le Riche, Comput. Struct. 82 (2004) 2251). `docs/study_format.md` compares it with other methods. Combinations of choices race
//! each other, each with a simplex of its own; a front has a simplex for each direction.

#[cfg(test)]
mod tests;

use crate::study::designs::Design;
use crate::study::front::{directions, goal, is_end, share_weight};
use crate::study::race::{ChoiceSet, KnownDesign, Race};
use crate::study::sampling::quantile;
use crate::study::score::{DesignStanding, Goal};
use basin::{
    BoxBounds, ConstraintDescription, ConstraintSet, ConstraintSolveError, Constraints,
    CostFunction, Executor, Gbnm, PointState,
};
use lumiduct_base::error::{Error, Result};
use lumiduct_input::{Domain, Parameter, SearchPlan, Setting};
use std::cell::RefCell;

/// Edge of the first simplex, as a share of the ranges, 1.
const FIRST_EDGE: f64 = 0.25;
/// Steps of a range, 1: finer than results are known, and coarse enough to be the same on every machine.
const STEPS: f64 = 1e4;
/// Most proposals for each design, 1: those that round to an earlier design are no new ones.
const MOST_PROPOSALS: u64 = 50;

/// How a search ended.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ProposalEnd {
    /// With this many designs: those of the plan, or fewer if whole numbers leave no others or nothing more is gained.
    Complete(usize),
    /// It was interrupted.
    Stopped,
}

/// Why a search ends before its method does.
pub(crate) enum ProposalStop {
    /// It has all designs.
    Full,
    Interrupted,
    Failed(Error),
}

/// What measures the designs that are proposed.
pub(crate) trait DesignMeter {
    /// What is known of a design.
    fn measure(&mut self, design: &Design) -> std::result::Result<DesignStanding, ProposalStop>;

    /// Whether a design and further ones with the same choices are unlikely to gain anything.
    fn is_settled(&self, next: &Design) -> bool;
}

/// Proposes designs until there are as many as the plan has.
pub(crate) fn propose<Meter: DesignMeter>(
    parameters: &[Parameter],
    plan: &SearchPlan,
    meter: Meter,
) -> Result<(ProposalEnd, Meter)> {
    let search = DesignSearch {
        parameters,
        plan,
        sides: [0.0, 1.0].map(|side| vec![side; count_searched(parameters)]),
        meter: RefCell::new(meter),
        known: RefCell::default(),
    };
    let end = if plan.objectives.is_empty() { search.race() } else { search.find_front() }?;
    Ok((end, search.meter.into_inner()))
}

/// How many parameters a simplex varies.
pub(crate) fn count_searched(parameters: &[Parameter]) -> usize {
    parameters.iter().filter(|own| is_searched(own)).count()
}

/// A search with the designs that it knows.
struct DesignSearch<'a, Meter> {
    parameters: &'a [Parameter],
    plan: &'a SearchPlan,
    /// The lowest and the highest shares of the ranges.
    sides: [Vec<f64>; 2],
    meter: RefCell<Meter>,
    /// The designs so far.
    known: RefCell<Vec<KnownDesign>>,
}

/// A part of a search: a simplex.
struct Part<'a> {
    combination: &'a ChoiceSet,
    goal: Goal,
    /// Where it starts, as shares of the ranges.
    start: Vec<f64>,
    /// Most designs of its combination.
    most: usize,
    /// Of its restarts.
    seed: u64,
    /// Whether it may end before it has them.
    may_settle: bool,
}

impl<Meter: DesignMeter> DesignSearch<'_, Meter> {
    /// Looks for the best design, with a simplex for each combination of choices.
    fn race(&self) -> Result<ProposalEnd> {
        let most = self.plan.designs as usize;
        // A simplex has a design more than there are ranges.
        let mut race = Race::new(self.parameters, most, self.sides[0].len() + 1);
        loop {
            let designs = self.known.borrow().len();
            let Some(lap) = race.next_lap(designs) else {
                return Ok(ProposalEnd::Complete(designs));
            };
            for (entrant, most) in lap {
                let part = Part {
                    combination: race.combination(entrant),
                    goal: Goal::One(0),
                    start: self.nominal_start(),
                    most,
                    seed: self.plan.seed,
                    may_settle: race.is_last_lap(),
                };
                if !self.follow(part)? {
                    return Ok(ProposalEnd::Stopped);
                }
            }
            race.end_lap(&self.known.borrow());
        }
    }

    /// Looks for a front, with a simplex for each direction and combination of choices.
    fn find_front(&self) -> Result<ProposalEnd> {
        let combinations = ChoiceSet::all(self.parameters);
        let most = self.plan.designs as usize / combinations.len();
        let directions = directions(self.plan, self.sides[0].len(), most);
        for combination in &combinations {
            let weight = |own: &Vec<f64>| share_weight(own);
            let mut weight_left: usize = directions.iter().map(weight).sum();
            for (place, weights) in directions.iter().enumerate() {
                let own = self.count(combination);
                let part = Part {
                    combination,
                    most: own + (most - own) * share_weight(weights) / weight_left,
                    seed: self.plan.seed.wrapping_add(place as u64),
                    ..self.toward(weights, combination)
                };
                weight_left -= share_weight(weights);
                if !self.follow(part)? {
                    return Ok(ProposalEnd::Stopped);
                }
            }
        }
        Ok(ProposalEnd::Complete(self.known.borrow().len()))
    }

    /// The part of a combination of choices in a direction, with all designs of the plan.
    fn toward<'c>(&self, weights: &[f64], combination: &'c ChoiceSet) -> Part<'c> {
        let known = self.known.borrow();
        let standings: Vec<&DesignStanding> = known.iter().map(|own| &own.standing).collect();
        let goal = goal(weights.to_vec(), &standings);
        let score = |design: &KnownDesign| design.standing.score(&goal);
        let own = known.iter().filter(|own| combination.is_of(&own.settings));
        let best = own.min_by(|one, other| score(one).total_cmp(&score(other)));
        let start = match best {
            Some(best) if !is_end(weights) => self.shares(best),
            Some(_) | None => self.nominal_start(),
        };
        let (most, seed) = (self.plan.designs as usize, self.plan.seed);
        Part { combination, goal, start, most, seed, may_settle: false }
    }

    /// How many designs of a combination there are.
    fn count(&self, combination: &ChoiceSet) -> usize {
        self.known.borrow().iter().filter(|own| combination.is_of(&own.settings)).count()
    }

    /// Proposes the designs of a part; `false` if it was interrupted. Designs that are known cost nothing: in a later lap the
    /// simplex takes the same way again.
    fn follow(&self, part: Part<'_>) -> Result<bool> {
        let most = MOST_PROPOSALS * u64::from(self.plan.designs);
        let start = part.start.clone();
        let method = Gbnm::new(part.seed).with_initial_simplex_fraction(FIRST_EDGE);
        let proposed = ProposedPart { search: self, part };
        // The first design is the scene as it is, as far as it lies within the ranges.
        let first = proposed.cost(&start).map(|_| ()).map_err(ConstraintSolveError::Evaluation);
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

    /// The score of a design of a part with these settings, which is measured if it is a new one.
    fn score_of(
        &self,
        part: &Part<'_>,
        settings: Vec<Setting>,
    ) -> std::result::Result<f64, ProposalStop> {
        let mut known = self.known.borrow_mut();
        if let Some(known) = known.iter().find(|own| own.settings == settings) {
            return Ok(known.standing.score(&part.goal));
        }
        let (combination, mut meter) = (part.combination, self.meter.borrow_mut());
        let count = known.iter().filter(|own| combination.is_of(&own.settings)).count();
        let design = Design { number: known.len() + 1, settings };
        if count >= part.most || part.may_settle && meter.is_settled(&design) {
            return Err(ProposalStop::Full);
        }
        let standing = meter.measure(&design)?;
        let score = standing.score(&part.goal);
        known.push(KnownDesign { settings: design.settings, standing });
        Ok(score)
    }

    /// The scene as it is, or the middle of a range that it does not lie in, as shares.
    fn nominal_start(&self) -> Vec<f64> {
        let searched = self.parameters.iter().filter(|own| is_searched(own));
        searched.map(|own| share(own, &own.nominal).unwrap_or(0.5)).collect()
    }

    /// The settings of a design as shares of the ranges.
    fn shares(&self, design: &KnownDesign) -> Vec<f64> {
        let own = self.parameters.iter().zip(&design.settings);
        let searched = own.filter(|(parameter, _)| is_searched(parameter));
        searched.map(|(parameter, setting)| start_share(parameter, setting)).collect()
    }
}

/// A share of the range of a parameter at which it has a setting, 0..=1; the middle where that is no number of the range.
fn start_share(parameter: &Parameter, setting: &Setting) -> f64 {
    let share = match (&parameter.domain, setting.number()) {
        // Each whole number has a part of the range, as in `quantile`.
        (Domain::Uniform { from, to }, Some(value)) if parameter.whole => {
            let first = from.ceil();
            Some(((value - first + 0.5) / (to.floor() - first + 1.0)).clamp(0.0, 1.0))
        }
        (_, _) => share(parameter, setting),
    };
    share.unwrap_or(0.5)
}

/// Whether a simplex varies a parameter.
fn is_searched(parameter: &Parameter) -> bool {
    match parameter.domain {
        Domain::Uniform { .. } => true,
        Domain::Levels(_) | Domain::Normal { .. } | Domain::Listed | Domain::AsInScene => false,
    }
}

/// Where a setting lies in the range of a parameter, 0..=1; `None` if it is no number or outside.
fn share(parameter: &Parameter, setting: &Setting) -> Option<f64> {
    match (&parameter.domain, setting.number()) {
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
fn setting(parameter: &Parameter, own: f64) -> Setting {
    let step = |share: f64| (share.clamp(0.0, 1.0) * STEPS).round();
    match share(parameter, &parameter.nominal) {
        Some(nominal) if step(nominal) == step(own) => parameter.nominal.clone(),
        Some(_) | None => quantile(parameter, step(own) / STEPS),
    }
}

/// Designs of a part as a function of the shares of the ranges.
struct ProposedPart<'a, Meter> {
    search: &'a DesignSearch<'a, Meter>,
    part: Part<'a>,
}

impl<Meter> Constraints for ProposedPart<'_, Meter> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        let [low, high] = &self.search.sides;
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(low), Some(high)))
    }
}

impl<Meter: DesignMeter> CostFunction for ProposedPart<'_, Meter> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = ProposalStop;

    fn cost(&self, shares: &Vec<f64>) -> std::result::Result<f64, ProposalStop> {
        let mut shares = shares.iter();
        let setting = |parameter: &Parameter| match is_searched(parameter) {
            true => shares.next().map_or(Setting::AsInScene, |share| setting(parameter, *share)),
            false => Setting::AsInScene,
        };
        let mut settings: Vec<Setting> = self.search.parameters.iter().map(setting).collect();
        self.part.combination.set(&mut settings);
        self.search.score_of(&self.part, settings)
    }
}
