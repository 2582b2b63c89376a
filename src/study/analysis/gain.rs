//! What the latest designs of a search have gained.

use crate::study::analysis::combine::{Term, combine};
use crate::study::score::{DesignStanding, Goal};
use lumiduct_input::{Best, Ranking};
use lumiduct_report::study::{DesignRecord, LatestGain};

/// Latest designs for each range: a simplex has usually converged after as many.
const LATEST_PER_RANGE: usize = 10;

/// How much better the best of some designs is than the best without the latest of them; `None` while none of the others passes.
pub(crate) fn latest_gain(
    ranking: &Ranking,
    ranges: usize,
    designs: &[&DesignRecord],
) -> Option<LatestGain> {
    let latest = LATEST_PER_RANGE * ranges;
    let earlier = designs.get(..designs.len().checked_sub(latest)?)?;
    let (was, is) = (best(ranking, earlier)?, best(ranking, designs)?);
    let sign = match ranking.best {
        Best::Highest => 1.0,
        Best::Lowest => -1.0,
    };
    let terms = [Term { weight: sign, design: is }, Term { weight: -sign, design: was }];
    Some(LatestGain { designs: latest, gain: combine(&terms, &ranking.measure)? })
}

/// The best design that passes.
fn best<'r>(ranking: &Ranking, designs: &[&'r DesignRecord]) -> Option<&'r DesignRecord> {
    let score = |design: &DesignRecord| {
        DesignStanding::of(std::slice::from_ref(ranking), design).score(&Goal::One(0))
    };
    let passing = designs.iter().filter(|design| design.passes());
    passing.min_by(|one, other| score(one).total_cmp(&score(other))).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::analysis::testing::design;

    #[test]
    fn the_latest_designs_gain_what_the_best_of_them_is_better_than_all_before() {
        let flux = |best| Ranking { measure: "exit.flux".into(), best };
        let values = [5.0, 3.0, 4.0, 4.5, 6.0, 7.0, 6.5, 2.0, 1.0, 3.0, 3.0, 3.0];
        let designs: Vec<DesignRecord> =
            (1..).zip(values).map(|(number, value)| design(number, [0.0; 2], value, 0.5)).collect();
        let designs: Vec<&DesignRecord> = designs.iter().collect();
        let gain = |best, count: usize| latest_gain(&flux(best), 1, &designs[..count]);
        let highest = gain(Best::Highest, 12).unwrap();
        assert_eq!(highest.designs, 10);
        // 7 after 5, with the same noise.
        assert!((highest.gain.value - 2.0).abs() < 1e-12 && highest.gain.std_error < 1e-12);
        assert!((gain(Best::Lowest, 12).unwrap().gain.value - 2.0).abs() < 1e-12);
        assert_eq!(gain(Best::Lowest, 10), None, "there are none before");
    }
}
