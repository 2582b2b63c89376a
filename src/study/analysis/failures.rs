//! How many designs of a tolerance run fail, and what that implies for all of production.

use lumiduct_core::measure::CheckOutcome;
use lumiduct_core::plan::Check;
use lumiduct_report::study::{DesignRecord, FailureShare, PlanFacts, StudyFacts};
use statrs::distribution::{Beta, ContinuousCDF};

/// Share of cases in which an interval misses the truth, 1.
const MISSED: f64 = 0.05;

/// One for all demands together, then one for each; none without demands, or for designs that are
/// not random samples.
pub(super) fn failures(facts: &StudyFacts, designs: &[DesignRecord]) -> Vec<FailureShare> {
    match facts.plan {
        PlanFacts::Tolerance(_) => {}
        PlanFacts::Grid
        | PlanFacts::OneAtATime
        | PlanFacts::List
        | PlanFacts::LatinHypercube(_)
        | PlanFacts::Sobol(_)
        | PlanFacts::Search(_) => return Vec::new(),
    }
    if facts.checks.is_empty() {
        return Vec::new();
    }
    // A design that makes no scene cannot be made, so it fails.
    let all = designs.iter().map(|design| design.outcome.verdict().unwrap_or(CheckOutcome::Failed));
    let mut shares = vec![share("all checks together".into(), all)];
    for (place, check) in facts.checks.iter().enumerate() {
        let outcomes = designs.iter().map(|design| {
            let own = design.outcome.result().and_then(|result| result.checks.get(place));
            own.map_or(CheckOutcome::Failed, |own| own.verdict.outcome)
        });
        shares.push(share(demand(check), outcomes));
    }
    shares
}

/// A demand in words: "exit.efficiency, at least 0.6".
fn demand(check: &Check) -> String {
    let parts = [
        check.min.map(|min| format!("at least {min}")),
        check.max.map(|max| format!("at most {max}")),
        check.equals.map(|equals| format!("equal to {equals}")),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    format!("{}, {}", check.measure, parts.join(" and "))
}

fn share(demand: String, outcomes: impl Iterator<Item = CheckOutcome>) -> FailureShare {
    let [mut passed, mut failed, mut undecided] = [0usize; 3];
    for outcome in outcomes {
        match outcome {
            CheckOutcome::Passed => passed += 1,
            CheckOutcome::Undecided => undecided += 1,
            CheckOutcome::Failed | CheckOutcome::Unknown => failed += 1,
        }
    }
    let count = passed + failed + undecided;
    let of = |part: usize| part as f64 / count.max(1) as f64;
    FailureShare {
        demand,
        passed,
        failed,
        undecided,
        least: of(failed),
        most: of(failed + undecided),
        interval: [interval(failed, count)[0], interval(failed + undecided, count)[1]],
    }
}

/// Confidence interval of the probability of an event seen in `hits` of `count` trials (Clopper &
/// Pearson, Biometrika 26 (1934) 404): it covers the truth in 95 % of cases or more.
fn interval(hits: usize, count: usize) -> [f64; 2] {
    let quantile = |a: usize, b: usize, share: f64| {
        // Both are at least 1, where the distribution exists.
        Beta::new(a as f64, b as f64).map_or(f64::NAN, |beta| beta.inverse_cdf(share))
    };
    let low = if hits == 0 { 0.0 } else { quantile(hits, count - hits + 1, MISSED / 2.0) };
    let high =
        if hits == count { 1.0 } else { quantile(hits + 1, count - hits, 1.0 - MISSED / 2.0) };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_of_clopper_and_pearson() {
        // 0 of n: 1 - 0.025^(1/n). Values for 10 of 100: Brown, Cai & DasGupta, Stat. Sci. 16
        // (2001) 101, by the F distribution: 0.04900 to 0.17622.
        let [low, high] = interval(0, 20);
        assert_eq!(low, 0.0);
        assert!((high - (1.0 - 0.025f64.powf(0.05))).abs() < 1e-6, "{high}");
        let [low, high] = interval(10, 100);
        assert!((low - 0.049_005).abs() < 1e-5 && (high - 0.176_223).abs() < 1e-5, "{low} {high}");
        assert_eq!(interval(20, 20)[1], 1.0);
        assert_eq!(interval(0, 0), [0.0, 1.0]);
    }

    #[test]
    fn undecided_designs_widen_the_share_to_both_sides() {
        let outcomes = [
            CheckOutcome::Passed,
            CheckOutcome::Undecided,
            CheckOutcome::Failed,
            CheckOutcome::Passed,
        ];
        let share = share("all".into(), outcomes.into_iter());
        assert_eq!((share.least, share.most), (0.25, 0.5));
        assert!(share.interval[0] < 0.25 && share.interval[1] > 0.5);
    }
}
