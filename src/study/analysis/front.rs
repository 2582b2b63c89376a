//! Which designs of a search are on the front, and with what certainty.

use crate::study::analysis::combine::{Term, combine};
use crate::study::score::{DesignStanding, unbeaten};
use lumiduct_input::{Best, Ranking};
use lumiduct_report::study::{DesignRecord, FrontDesign, StudyFacts};

/// Errors of a difference up to which it may be noise, 1.
const WITHIN_ERRORS: f64 = 3.0;

/// The designs on the front, the best by the first objective first.
pub(super) fn front(facts: &StudyFacts, designs: &[DesignRecord]) -> Vec<FrontDesign> {
    let objectives = &facts.objectives;
    if objectives.is_empty() {
        return Vec::new();
    }
    let standings: Vec<DesignStanding> =
        designs.iter().map(|own| DesignStanding::of(objectives, own)).collect();
    let passing: Vec<(&DesignRecord, &[f64])> = designs
        .iter()
        .zip(&standings)
        .filter_map(|(own, found)| Some((own, found.costs()?)))
        .collect();
    let costs: Vec<&[f64]> = passing.iter().map(|own| own.1).collect();
    let mut places = unbeaten(&costs);
    places.sort_by(|one, other| costs[*one][0].total_cmp(&costs[*other][0]));
    let of_front = |place: usize| {
        let (own, _) = passing[place];
        let mut others = passing.iter().map(|(other, _)| *other);
        let rival =
            others.find(|other| other.design != own.design && may_beat(objectives, other, own));
        FrontDesign { design: own.design, rival: rival.map(|other| other.design) }
    };
    places.into_iter().map(of_front).collect()
}

/// Whether a design beats another one if differences within their errors count for nothing.
fn may_beat(objectives: &[Ranking], one: &DesignRecord, other: &DesignRecord) -> bool {
    let lead = |Ranking { measure, best }: &Ranking| {
        let sign = match best {
            Best::Highest => 1.0,
            Best::Lowest => -1.0,
        };
        let terms = [Term { weight: sign, design: one }, Term { weight: -sign, design: other }];
        combine(&terms, measure).map(|own| (own.value, WITHIN_ERRORS * own.std_error))
    };
    let leads: Option<Vec<(f64, f64)>> = objectives.iter().map(lead).collect();
    leads.is_some_and(|leads| {
        leads.iter().all(|(lead, noise)| *lead >= -noise)
            && leads.iter().any(|(lead, noise)| lead > noise)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::analysis::testing::{design, facts};
    use lumiduct_core::measure::Measure;
    use lumiduct_report::study::{DesignOutcome, PlanFacts};

    /// A design with a flux, its noise, and an exact cost.
    fn costed(number: usize, flux: f64, noise: f64, cost: f64) -> DesignRecord {
        let mut own = design(number, [0.0; 2], flux, noise);
        let DesignOutcome::Done(result) = &mut own.outcome else { panic!() };
        // Without groups, so that errors are independent.
        result.replicates.clear();
        let exact = Measure { value: cost, std_error: 0.0, ..result.measures["exit.flux"].clone() };
        result.measures.insert("cost".into(), exact);
        own
    }

    fn found(designs: &[DesignRecord]) -> Vec<(usize, Option<usize>)> {
        let objectives = vec![
            Ranking { measure: "cost".into(), best: Best::Lowest },
            Ranking { measure: "exit.flux".into(), best: Best::Highest },
        ];
        let facts = StudyFacts { objectives, ranking: None, ..facts(PlanFacts::Search(1)) };
        front(&facts, designs).into_iter().map(|own| (own.design, own.rival)).collect()
    }

    #[test]
    fn designs_that_another_may_beat_are_marked() {
        let sure = [costed(1, 5.0, 0.1, 1.0), costed(2, 9.0, 0.1, 3.0), costed(3, 4.0, 0.1, 2.0)];
        assert_eq!(found(&sure), [(1, None), (2, None)]);
        // Design 2 costs more and gives no more light than noise explains.
        let close =
            [costed(1, 8.9, 0.1, 1.0), costed(2, 9.0, 0.1, 3.0), costed(3, f64::NAN, 0.1, 0.0)];
        assert_eq!(found(&close), [(1, None), (2, Some(1))]);
        // Equal designs are both on it.
        let equal = [costed(1, 5.0, 0.0, 1.0), costed(2, 5.0, 0.0, 1.0)];
        assert_eq!(found(&equal), [(1, None), (2, None)]);
    }
}
