//! What the latest designs of a search have gained.

use crate::study::analysis::combine::{Term, combine};
use crate::study::score::DesignStanding;
use indexmap::IndexMap;
use lumiduct_input::{Best, Domain, LATEST_PER_RANGE, Ranking, Setting};
use lumiduct_report::study::{DesignRecord, LatestGain, Pairing, ValueWithError};

/// What is needed to judge the gains of a search for the best design.
pub(crate) struct Gains<'a> {
    ranking: &'a Ranking,
    ranges: usize,
    /// Names of the parameters with choices.
    choices: Vec<&'a str>,
}

impl<'a> Gains<'a> {
    /// Those by a measure, with the names and domains of the parameters.
    pub(crate) fn new(
        ranking: &'a Ranking,
        parameters: impl Iterator<Item = (&'a String, &'a Domain)>,
    ) -> Self {
        let (mut ranges, mut choices) = (0, Vec::new());
        for (name, domain) in parameters {
            match domain {
                Domain::Uniform { .. } => ranges += 1,
                Domain::Levels(_) => choices.push(name.as_str()),
                Domain::Normal { .. } | Domain::Listed | Domain::AsInScene => {}
            }
        }
        Self { ranking, ranges, choices }
    }

    /// How much better the best of the designs with the same choices as these settings is than the best without the latest of them;
    /// `None` while none of the others passes.
    pub(crate) fn latest<'r>(
        &self,
        settings: &IndexMap<String, Setting>,
        designs: impl Iterator<Item = &'r DesignRecord>,
    ) -> Option<LatestGain> {
        let is_alike = |design: &&DesignRecord| {
            self.choices.iter().all(|name| design.settings.get(*name) == settings.get(*name))
        };
        let designs: Vec<&DesignRecord> = designs.filter(is_alike).collect();
        let latest = LATEST_PER_RANGE * self.ranges;
        let earlier = designs.get(..designs.len().checked_sub(latest)?)?;
        let (was, is) = (self.best(earlier)?, self.best(&designs)?);
        let sign = match self.ranking.best {
            Best::Highest => 1.0,
            Best::Lowest => -1.0,
        };
        let terms = [Term { weight: sign, design: is }, Term { weight: -sign, design: was }];
        let none = ValueWithError { value: 0.0, std_error: 0.0, evidence: Pairing::Paired };
        let gain = match is.design == was.design {
            true => none,
            false => combine(&terms, &self.ranking.measure)?,
        };
        Some(LatestGain { designs: latest, gain })
    }

    /// The best design that passes.
    fn best<'r>(&self, designs: &[&'r DesignRecord]) -> Option<&'r DesignRecord> {
        let cost = |design: &&'r DesignRecord| {
            let standing = DesignStanding::of(std::slice::from_ref(self.ranking), design);
            Some((standing.costs()?[0], *design))
        };
        let costs = designs.iter().filter_map(cost);
        costs.min_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, design)| design)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::analysis::testing::design;
    use lumiduct_report::study::DesignOutcome;

    fn flux(best: Best) -> Ranking {
        Ranking { measure: "exit.flux".into(), best }
    }

    /// The gain of the first designs of one with the parameter `a` as its only range, and `b` as the choice.
    fn gain(best: Best, designs: &[DesignRecord]) -> Option<LatestGain> {
        let [a, b] = ["a", "b"].map(str::to_owned);
        let domains = [
            (&a, &Domain::Uniform { from: 0.0, to: 1.0 }),
            (&b, &Domain::Levels(vec![Setting::Number(0.0), Setting::Number(1.0)])),
        ];
        let ranking = flux(best);
        Gains::new(&ranking, domains.into_iter()).latest(&designs[0].settings, designs.iter())
    }

    const VALUES: [f64; 12] = [5.0, 3.0, 4.0, 4.5, 6.0, 7.0, 6.5, 2.0, 1.0, 3.0, 3.0, 3.0];

    #[test]
    fn the_latest_designs_gain_what_the_best_of_them_is_better_than_all_before() {
        let numbered = (1..).zip(VALUES);
        let mut designs: Vec<DesignRecord> =
            numbered.map(|(number, value)| design(number, [0.0; 2], value, 0.5)).collect();
        let highest = gain(Best::Highest, &designs).unwrap();
        assert_eq!(highest.designs, 10);
        // 7 after 5, with the same noise.
        assert!((highest.gain.value - 2.0).abs() < 1e-12 && highest.gain.std_error < 1e-12);
        assert!((gain(Best::Lowest, &designs).unwrap().gain.value - 2.0).abs() < 1e-12);
        assert_eq!(gain(Best::Lowest, &designs[..10]), None, "there are none before");
        // Those with another choice do not count.
        designs.extend((13..40).map(|number| design(number, [0.0, 1.0], 9.0, 0.5)));
        assert_eq!(gain(Best::Highest, &designs), Some(highest));
    }

    #[test]
    fn designs_without_a_value_count_for_nothing_and_the_same_best_gains_exactly_nothing() {
        let of = |values: [f64; 12]| -> Vec<DesignRecord> {
            (1..).zip(values).map(|(number, value)| design(number, [0.0; 2], value, 0.5)).collect()
        };
        let mut lost = VALUES;
        (lost[0], lost[1]) = (f64::NAN, f64::INFINITY);
        assert_eq!(gain(Best::Highest, &of(lost)), None);
        let mut early = VALUES;
        early[1] = 8.0;
        let mut designs = of(early);
        // Without groups errors would count as independent.
        let DesignOutcome::Done(result) = &mut designs[1].outcome else { panic!() };
        result.replicates.clear();
        let none = gain(Best::Highest, &designs).unwrap().gain;
        assert_eq!((none.value, none.std_error), (0.0, 0.0));
    }
}
