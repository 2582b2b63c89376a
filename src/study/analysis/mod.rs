//! What follows from all designs of a study together. Pure functions of its facts and records.

mod combine;
mod effects;
mod failures;
mod front;
mod gain;
mod ranking;
mod sensitivity;

pub(crate) use gain::Gains;

use combine::{Term, combine};
use lumiduct_report::study::{
    Analysis, DesignRecord, LatestGain, Pairing, Sharpness, StudyFacts, StudyReport,
};

/// A study whose designs all have records, with what follows from them.
pub(crate) fn analysed(facts: StudyFacts, designs: Vec<DesignRecord>) -> StudyReport {
    let analysis = analysis(&facts, &designs);
    StudyReport { facts, designs, analysis, confirmations: Vec::new(), production: None }
}

/// Everything that follows.
fn analysis(facts: &StudyFacts, designs: &[DesignRecord]) -> Analysis {
    Analysis {
        ranked: ranking::ranked(facts, designs),
        front: front::front(facts, designs),
        latest_gain: gain_of(facts, designs),
        effects: effects::effects(facts, designs),
        sensitivities: sensitivity::sensitivities(facts, designs),
        failures: failures::failures(facts, designs),
        sharpness: facts.measures.iter().filter_map(|name| sharpness(name, designs)).collect(),
    }
}

/// What the latest designs with the choices of the best design have gained, if that ends the search.
fn gain_of(facts: &StudyFacts, designs: &[DesignRecord]) -> Option<LatestGain> {
    let ranking = facts.ranking.as_ref().filter(|_| facts.gain_limit.is_some())?;
    let best = ranking::ranked(facts, designs).first()?.design;
    let best = designs.iter().find(|own| own.design == best)?;
    let parameters = facts.parameters.iter().map(|own| (&own.name, &own.domain));
    Gains::new(ranking, parameters).latest(&best.settings, designs.iter())
}

/// How much sharper the difference of neighbouring designs is than if they were independent.
fn sharpness(measure: &str, designs: &[DesignRecord]) -> Option<Sharpness> {
    let mut factors: Vec<f64> = designs
        .windows(2)
        .filter_map(|pair| {
            let terms =
                [Term { weight: 1.0, design: &pair[0] }, Term { weight: -1.0, design: &pair[1] }];
            let difference = combine(&terms, measure)?;
            let alone = combine::independent_error(&terms, measure)?;
            let is_told = difference.evidence == Pairing::Paired && difference.std_error > 0.0;
            (is_told && alone.is_finite()).then(|| alone / difference.std_error)
        })
        .collect();
    factors.sort_by(f64::total_cmp);
    let last = factors.len().checked_sub(1)?;
    // An even number of factors has two in the middle.
    let factor = (factors[last / 2] + factors[last.div_ceil(2)]) / 2.0;
    Some(Sharpness { measure: measure.to_owned(), factor, pairs: factors.len() })
}

#[cfg(test)]
pub(crate) mod testing {
    use indexmap::IndexMap;
    use lumiduct_core::measure::{Measure, Replicates, Status};
    use lumiduct_core::plan::Estimator;
    use lumiduct_input::{Best, Domain, Keep, Ranking, Setting};
    use lumiduct_report::study::{
        DESIGN_FORMAT, DesignOutcome, DesignRecord, DesignResult, FACTS_FORMAT, ParameterFacts,
        PlanFacts, StudyFacts,
    };

    /// A study of two parameters.
    pub(super) fn facts(plan: PlanFacts) -> StudyFacts {
        let parameter = |name: &str| ParameterFacts {
            name: name.into(),
            unit: None,
            keys: Vec::new(),
            domain: Domain::Listed,
            nominal: Setting::AsInScene,
            choices: IndexMap::new(),
        };
        StudyFacts {
            lumiduct_batch: FACTS_FORMAT,
            version: String::new(),
            name: "study".into(),
            title: "Study".into(),
            description: None,
            project: None,
            logo: None,
            hash: String::new(),
            scene: "scene".into(),
            overrides: Vec::new(),
            plan,
            designs: 0,
            production_designs: None,
            seed: 1,
            estimator: "forward".into(),
            asked: String::new(),
            parameters: vec![parameter("a"), parameter("b")],
            measures: vec!["exit.flux".into()],
            ranking: Some(Ranking { measure: "exit.flux".into(), best: Best::Highest }),
            objectives: Vec::new(),
            gain_limit: None,
            checks: Vec::new(),
            keep: Keep::Records,
        }
    }

    /// A design with a value and four groups of batches: the value plus the noise of each group.
    pub(crate) fn design(
        number: usize,
        settings: [f64; 2],
        value: f64,
        noise: f64,
    ) -> DesignRecord {
        let groups = [-1.0, 1.0, -1.0, 1.0].map(|sign| value + noise * sign);
        let measure = Measure {
            value,
            std_error: noise / 3f64.sqrt(),
            bias: None,
            unit: "lm".into(),
            batches: 4,
            paths: 4,
            estimator: Estimator::Forward,
            status: Status::Ok,
        };
        let replicates = Replicates((0..4).zip(groups).collect());
        let of = |setting: f64| Setting::Number(setting);
        DesignRecord {
            lumiduct_design: DESIGN_FORMAT,
            build: String::new(),
            study: String::new(),
            design: number,
            settings: IndexMap::from([
                ("a".to_owned(), of(settings[0])),
                ("b".to_owned(), of(settings[1])),
            ]),
            outcome: DesignOutcome::Done(Box::new(DesignResult {
                scene_hash: String::new(),
                measures: IndexMap::from([("exit.flux".to_owned(), measure)]),
                replicates: IndexMap::from([("exit.flux".to_owned(), replicates)]),
                checks: Vec::new(),
                target: None,
                stopped: String::new(),
                paths: 4,
                warnings: Vec::new(),
            })),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::{design, facts};
    use super::*;
    use lumiduct_report::study::{DesignOutcome, Effect, PlanFacts, SensitivityMethod};

    /// 3 a + b on a grid of a and b in -1, 0, 1, with common noise.
    fn grid() -> Vec<DesignRecord> {
        let pairs = (0..9).map(|i| [f64::from(i / 3) - 1.0, f64::from(i % 3) - 1.0]);
        let numbered = pairs.enumerate();
        numbered.map(|(i, [a, b])| design(i + 1, [a, b], 10.0 + 3.0 * a + b, 0.5)).collect()
    }

    #[test]
    fn what_designs_have_in_common_cancels_in_their_differences() {
        let found = analysis(&facts(PlanFacts::Grid), &grid());
        assert_eq!(found.ranked[0].design, 9);
        let behind = found.ranked[1].behind.unwrap();
        assert!((behind.value - 1.0).abs() < 1e-12 && behind.std_error < 1e-12, "{behind:?}");
        assert_eq!(behind.evidence, Pairing::Paired);
        // A design with other groups counts as independent.
        let mut other = grid();
        let DesignOutcome::Done(result) = &mut other[8].outcome else { panic!("no result") };
        result.replicates["exit.flux"].0.pop();
        let behind = analysis(&facts(PlanFacts::Grid), &other).ranked[1].behind.unwrap();
        assert_eq!(behind.evidence, Pairing::Independent);
        assert!((behind.std_error - (2.0f64 / 3.0).sqrt() * 0.5).abs() < 1e-12);
    }

    #[test]
    fn the_indices_of_a_sum_are_the_shares_of_its_terms() {
        let found = analysis(&facts(PlanFacts::Grid), &grid());
        let [sensitivity] = &found.sensitivities[..] else { panic!("not one") };
        assert_eq!(sensitivity.method, SensitivityMethod::FirstOrder);
        // Variances 9 and 1 out of 10.
        assert!((sensitivity.indices[0].value - 0.9).abs() < 1e-12);
        assert!((sensitivity.indices[1].value - 0.1).abs() < 1e-12);
        assert!((sensitivity.explained - 1.0).abs() < 1e-12);
        assert!(sensitivity.indices[0].std_error < 1e-12, "common noise moves no index");
    }

    #[test]
    fn a_main_effect_is_the_mean_over_all_other_settings() {
        let found = analysis(&facts(PlanFacts::Grid), &grid());
        let effect = &found.effects[0];
        let means: Vec<f64> = effect.points.iter().map(|point| point.mean.value).collect();
        assert!(means.iter().zip([7.0, 10.0, 13.0]).all(|(a, b)| (a - b).abs() < 1e-12));
        // Common noise does not average out.
        assert!((effect.points[0].mean.std_error - 0.5 / 3f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_main_effect_compares_designs_that_differ_in_nothing_else() {
        // The design of the highest value is missing: its two neighbours with the same b drop out
        // of the means, too.
        let mut designs = grid();
        designs[8].outcome = DesignOutcome::Failed("no scene".into());
        let found = analysis(&facts(PlanFacts::Grid), &designs);
        let a = &found.effects[0];
        assert_eq!(a.points.iter().map(|point| point.designs).collect::<Vec<_>>(), [2, 2, 2]);
        let whole = analysis(&facts(PlanFacts::Grid), &grid());
        let step = |effect: &Effect| effect.points[1].mean.value - effect.points[0].mean.value;
        assert!((step(a) - step(&whole.effects[0])).abs() < 1e-12);
        // Common noise cancels in the step, though not in the means.
        let told = a.points[2].from_first.unwrap();
        assert!((told.value - 6.0).abs() < 1e-12 && told.std_error < 1e-12, "{told:?}");
        assert!(a.points[0].from_first.is_none() && a.points[2].mean.std_error > 0.1);
        // A level that makes no scene does not change the others.
        let mut designs = grid();
        (6..9).for_each(|place| designs[place].outcome = DesignOutcome::Failed("no".into()));
        let found = analysis(&facts(PlanFacts::Grid), &designs);
        assert_eq!(found.effects[0].points.len(), 2);
        assert_eq!(found.effects[1].points.iter().map(|own| own.designs).sum::<usize>(), 6);
        // A list of designs without a pair that differs in one parameter alone has none.
        let list: Vec<DesignRecord> = [0, 4, 8].map(|place| grid()[place].clone()).to_vec();
        assert!(analysis(&facts(PlanFacts::List), &list).effects.is_empty());
    }

    #[test]
    fn a_regression_finds_the_slopes_of_samples() {
        let found = analysis(&facts(PlanFacts::Sobol(1)), &grid());
        let [sensitivity] = &found.sensitivities[..] else { panic!("not one") };
        assert!((sensitivity.indices[0].value - 0.9f64.sqrt()).abs() < 1e-12);
        assert!((sensitivity.indices[1].value - 0.1f64.sqrt()).abs() < 1e-12);
        assert!((sensitivity.explained - 1.0).abs() < 1e-12);
        assert!(found.effects.is_empty());
    }

    #[test]
    fn a_design_without_a_result_is_in_no_ranking_and_stops_no_analysis() {
        let mut designs = grid();
        designs[8].outcome = DesignOutcome::Failed("no scene".into());
        let found = analysis(&facts(PlanFacts::Grid), &designs);
        assert_eq!((found.ranked.len(), found.ranked[0].design), (8, 8));
        assert!(found.sensitivities.is_empty(), "a grid with a hole has no indices");
    }
}
