//! How sensors that want different estimators share the work of a run.
//!
//! Every sensor uses the photons of a run, but each gather path serves only one sensor. So a sensor takes longer than it would in a
//! run of its own. The chosen set of estimators keeps the largest of these slowdowns as small as possible.

use crate::plan::Estimator;
use crate::transport::batches::{EQUAL_SHARE, LEAST_SHARE};
use crate::transport::choose::choice::EstimatorChoice;

/// The best for a sensor alone.
pub(crate) struct Wanted {
    pub(crate) choice: EstimatorChoice,
    /// The relative error to reach, if anything was found, 1.
    pub(crate) error: Option<f64>,
    /// Whether the plan demands it.
    pub(crate) is_given: bool,
}

impl Wanted {
    /// Time with another estimator over that with the chosen one, each in a run of its own, 1; infinite if it is not permitted.
    fn longer(&self, estimator: Estimator) -> f64 {
        let Self { choice, error, is_given } = self;
        if choice.chosen == estimator {
            return 1.0;
        }
        let mut fit = choice.tried.iter().filter(|own| own.objection.is_none());
        match fit.find(|own| own.estimator == estimator) {
            Some(own) if !is_given => {
                let best = error.and_then(|error| Some((error, choice.time(error)?)));
                // In the dark all are equal.
                best.map_or(1.0, |(error, best)| match own.time(error) {
                    None => f64::INFINITY,
                    // Neither may need any.
                    Some(time) if time == best => 1.0,
                    Some(time) => time / best,
                })
            }
            Some(_) | None => f64::INFINITY,
        }
    }

    /// The best of some estimators, and its time over that of the chosen one, 1.
    fn best_of(&self, some: &[Estimator]) -> (Estimator, f64) {
        let times = some.iter().map(|one| (*one, self.longer(*one)));
        times.min_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap_or((self.choice.chosen, 1.0))
    }
}

/// The choices: the best of that set of estimators with which the largest slowdown of a sensor is least, and then their sum.
pub(crate) fn in_common(wanted: Vec<Wanted>) -> Vec<EstimatorChoice> {
    let mut all = Estimator::TRIED.to_vec();
    for Wanted { choice, .. } in &wanted {
        if !all.contains(&choice.chosen) {
            all.push(choice.chosen);
        }
    }
    let slowdown = |set: &[Estimator]| {
        let taken: Vec<_> = wanted.iter().map(|own| own.best_of(set)).collect();
        let shares = WorkShares::of(taken.iter().map(|(own, _)| *own).collect());
        let longer = taken.into_iter().map(|(own, longer)| longer * shares.slowdown(own));
        longer.fold((1.0, 0.0), |(most, sum), own| (own.max(most), sum + own))
    };
    let sets = (1..1usize << all.len()).map(|members| {
        let is_member =
            |(place, one): (usize, &Estimator)| (members >> place & 1 == 1).then_some(*one);
        all.iter().enumerate().filter_map(is_member).collect::<Vec<_>>()
    });
    let known = sets.map(|set| (slowdown(&set), set));
    let least = known
        .min_by(|(a, _): &((f64, f64), _), (b, _)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let set = least.map(|(_, set)| set).unwrap_or_default();
    let choice = |own: Wanted| EstimatorChoice { chosen: own.best_of(&set).0, ..own.choice };
    wanted.into_iter().map(choice).collect()
}

/// How a run divides its work.
struct WorkShares {
    /// Estimators of all sensors.
    taken: Vec<Estimator>,
    /// Share of the photons in the work of photons and gather paths, 1.
    photons: f64,
    /// Sensors whose gather paths are followed to the sources.
    followed: f64,
}

impl WorkShares {
    fn of(taken: Vec<Estimator>) -> Self {
        let count = |wanted| taken.iter().filter(|own| **own == wanted).count();
        let followed = count(Estimator::Backward) + count(Estimator::Mix);
        let photons = match followed {
            0 => 1.0,
            _ if count(Estimator::Backward) == taken.len() => LEAST_SHARE,
            _ => EQUAL_SHARE,
        };
        Self { photons, followed: followed as f64, taken }
    }

    /// Time that a sensor needs with an estimator over that in a run of its own, 1.
    fn slowdown(&self, estimator: Estimator) -> f64 {
        let Self { taken, photons, followed } = self;
        let is_new = |place: usize| !taken[..place].contains(&taken[place]);
        let used = (0..taken.len()).filter(|place| is_new(*place)).count() as f64;
        if taken.contains(&Estimator::Gather) || taken.contains(&Estimator::Mis) {
            // The others have about as much work as passes of gathering.
            return used;
        }
        match estimator {
            Estimator::Forward => 1.0 / photons,
            Estimator::Backward => followed * (1.0 - LEAST_SHARE) / (1.0 - photons),
            // Alone, photons and gather paths would have half each.
            Estimator::Mix => 2.0 * followed / (followed + 1.0),
            Estimator::Gather | Estimator::Mis => used,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::trial::{Objection, Trial};

    const FORWARD: Estimator = Estimator::Forward;
    const BACKWARD: Estimator = Estimator::Backward;
    const MIX: Estimator = Estimator::Mix;

    /// What a sensor wants that costs this much forward, backward and by the mix.
    fn wanted(costs: [Option<f64>; 3]) -> Wanted {
        let trial =
            |(estimator, cost)| Trial { estimator, cost, bias: None, least: 0.0, objection: None };
        let tried: Vec<Trial> =
            [FORWARD, BACKWARD, MIX].into_iter().zip(costs).map(trial).collect();
        let known = tried.iter().filter_map(|own| Some((own.cost?, own.estimator)));
        let best = known.min_by(|(a, _), (b, _)| a.total_cmp(b));
        let choice = EstimatorChoice { chosen: best.map_or(FORWARD, |(_, one)| one), tried };
        Wanted { choice, error: best.map(|_| 0.01), is_given: false }
    }

    fn chosen(all: Vec<Wanted>) -> Vec<Estimator> {
        in_common(all).iter().map(|own| own.chosen).collect()
    }

    #[test]
    fn a_sensor_that_gains_little_leaves_the_gather_paths_to_another() {
        let map = || wanted([Some(2e-3), Some(3e-5), Some(2e-3)]);
        let wall = |by_mix| wanted([Some(5e-7), Some(1e-5), Some(by_mix)]);
        assert_eq!(chosen(vec![map(), wall(4e-7)]), [BACKWARD, FORWARD]);
        assert_eq!(chosen(vec![map(), wall(4e-8)]), [BACKWARD, MIX], "ten times is not little");
        let desk = |backward| wanted([Some(2.5e-4), Some(backward), Some(8e-5)]);
        let lit = || wanted([Some(2e-11), None, Some(1e-10)]);
        assert_eq!(chosen(vec![desk(2e-4), lit()]), [MIX, FORWARD], "its photons are for both");
        assert_eq!(chosen(vec![desk(7e-5), lit()]), [MIX, FORWARD], "which photons slow anyway");
    }

    #[test]
    fn gather_paths_of_several_sensors_share_their_work() {
        let cell = || wanted([Some(1.2e-4), Some(1e-4), None]);
        assert_eq!(chosen(vec![cell()]), [BACKWARD]);
        assert_eq!(chosen(vec![cell(), cell()]), [FORWARD; 2], "photons are for both");
    }

    #[test]
    fn estimators_share_a_run_only_where_each_gains_more_than_it_loses() {
        let gathered = |forward, by_gathering| {
            let mut own = wanted([Some(forward), None, None]);
            let (estimator, cost) = (Estimator::Gather, Some(by_gathering));
            own.choice.tried.push(Trial { estimator, cost, ..own.choice.tried[0].clone() });
            if by_gathering < forward {
                own.choice.chosen = estimator;
            }
            own
        };
        let remote = || gathered(1e-3, 1e-5);
        assert_eq!(chosen(vec![remote(), gathered(1e-6, 1e-4)]), [Estimator::Gather, FORWARD]);
        assert_eq!(chosen(vec![remote(), gathered(1e-6, 1.5e-6)]), [Estimator::Gather; 2]);
    }

    #[test]
    fn in_the_dark_and_without_noise_any_estimator_will_do() {
        let map = || wanted([Some(2e-3), Some(3e-5), None]);
        for other in [wanted([None; 3]), wanted([Some(0.0); 3])] {
            assert_eq!(chosen(vec![map(), other])[0], BACKWARD);
        }
        assert_eq!(chosen(vec![wanted([None; 3]), wanted([None; 3])]), [FORWARD; 2]);
    }

    #[test]
    fn what_is_rejected_or_not_tried_is_not_taken_for_all() {
        let map = || wanted([Some(2e-3), Some(3e-5), Some(1e-5)]);
        let mut rejected = wanted([Some(1e-2), None, Some(1e-6)]);
        rejected.choice.tried[2].objection = Some(Objection::Contradicted);
        rejected.choice.chosen = FORWARD;
        assert_eq!(chosen(vec![rejected, map()])[0], FORWARD);
        let mut dark = wanted([None; 3]);
        dark.choice.tried.truncate(1);
        assert_eq!(chosen(vec![dark, map()])[0], FORWARD, "nothing else is possible there");
    }

    #[test]
    fn an_estimator_that_the_plan_demands_stays() {
        for given in [FORWARD, MIX, Estimator::Mis] {
            let mut own = wanted([Some(1e-6); 3]);
            own.choice.chosen = given;
            own.is_given = true;
            let map = wanted([Some(2e-3), Some(3e-5), Some(1e-5)]);
            assert_eq!(chosen(vec![own, map])[0], given);
        }
    }
}
