//! How good a design is for a search.

use lumiduct_core::measure::shortfall;
use lumiduct_core::plan::Check;
use lumiduct_input::{Best, Ranking};
use lumiduct_report::study::DesignRecord;

/// The objective to minimise: below 1 for a design that passes every check, in the order of the ranking; above 1 for others, by their
/// shortfall (Deb, Comput. Methods Appl. Mech. Eng. 186 (2000) 311); infinite where nothing could be measured.
pub(crate) fn score(ranking: &Ranking, record: &DesignRecord) -> f64 {
    let Some(result) = record.outcome.result() else { return f64::INFINITY };
    if !record.passes() {
        let of = |check: &Check| {
            result
                .measures
                .get(&check.measure)
                .map_or(f64::INFINITY, |found| shortfall(check, found))
        };
        return 1.0 + result.checks.iter().map(|own| of(&own.check)).sum::<f64>();
    }
    let value = record.measure(&ranking.measure).map_or(f64::NAN, |own| own.value);
    let cost = match ranking.best {
        Best::Highest => -value,
        Best::Lowest => value,
    };
    if cost.is_nan() { f64::INFINITY } else { cost / (1.0 + cost.abs()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::analysis::testing::design;

    #[test]
    fn designs_that_pass_come_before_all_others_whatever_their_values() {
        let ranking = |best| Ranking { measure: "exit.flux".to_owned(), best };
        let value = |flux: f64| design(1, [0.0; 2], flux, 0.0);
        let [low, high] = [1.0, 1e6].map(value);
        assert!(score(&ranking(Best::Highest), &high) < score(&ranking(Best::Highest), &low));
        assert!(score(&ranking(Best::Lowest), &low) < score(&ranking(Best::Lowest), &high));
        assert!(score(&ranking(Best::Lowest), &high) < 1.0);
    }
}
