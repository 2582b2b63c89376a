//! Which design is the best, and with what certainty.

use crate::study::analysis::combine::{Term, combine};
use crate::study::score::DesignStanding;
use lumiduct_input::Best;
use lumiduct_report::study::{DesignRecord, Ranked, StudyFacts};

/// All traced designs, the best first; ties in the order of their numbers. Of a search those that fail a check come last, by their shortfall.
pub(super) fn ranked(facts: &StudyFacts, designs: &[DesignRecord]) -> Vec<Ranked> {
    let Some(ranking) = &facts.ranking else { return Vec::new() };
    let value = |design: &DesignRecord| {
        let value = design.measure(&ranking.measure)?.value;
        value.is_finite().then_some(value)
    };
    let score = |design: &DesignRecord| DesignStanding::score_of(ranking, design);
    let mut order: Vec<(f64, &DesignRecord)> =
        designs.iter().filter_map(|design| Some((value(design)?, design))).collect();
    order.sort_by(|(a, one), (b, other)| match (facts.plan.is_search(), ranking.best) {
        (true, _) => score(one).total_cmp(&score(other)),
        (false, Best::Highest) => b.total_cmp(a),
        (false, Best::Lowest) => a.total_cmp(b),
    });
    let Some(&(_, best)) = order.first() else { return Vec::new() };
    let sign = match ranking.best {
        Best::Highest => 1.0,
        Best::Lowest => -1.0,
    };
    let place = |(_, design): &(f64, &DesignRecord)| {
        let terms = [Term { weight: sign, design: best }, Term { weight: -sign, design }];
        let behind = combine(&terms, &ranking.measure).filter(|_| design.design != best.design);
        Ranked { design: design.design, behind }
    };
    order.iter().map(place).collect()
}
