//! Main effects: what a parameter does to a measure on the average over all others.

use crate::input::Setting;
use crate::report::study::{
    DesignRecord, Effect, EffectPoint, ParameterFacts, PlanFacts, StudyFacts,
};
use crate::study::analysis::combine::{Term, combine};
use std::cmp::Ordering;

/// The effects of all parameters on all measures. Samples have as many settings as designs, and none.
pub(super) fn effects(facts: &StudyFacts, designs: &[DesignRecord]) -> Vec<Effect> {
    match facts.plan {
        PlanFacts::Grid | PlanFacts::OneAtATime | PlanFacts::List => {}
        PlanFacts::LatinHypercube(_) | PlanFacts::Sobol(_) | PlanFacts::Tolerance(_) => {
            return Vec::new();
        }
    }
    let pairs = facts
        .measures
        .iter()
        .flat_map(|measure| facts.parameters.iter().map(move |parameter| (measure, parameter)));
    pairs
        .map(|(measure, parameter)| Effect {
            parameter: parameter.name.clone(),
            measure: measure.clone(),
            points: points(facts, designs, parameter, measure),
        })
        .filter(|effect| effect.points.len() > 1)
        .collect()
}

fn points(
    facts: &StudyFacts,
    designs: &[DesignRecord],
    parameter: &ParameterFacts,
    measure: &str,
) -> Vec<EffectPoint> {
    let is_alone = |design: &DesignRecord| {
        let others = design.settings.iter().filter(|(name, _)| **name != parameter.name);
        others.into_iter().all(|(_, setting)| *setting == Setting::AsInScene)
    };
    let taken: Vec<(&DesignRecord, Setting)> = designs
        .iter()
        .filter(|design| facts.plan != PlanFacts::OneAtATime || is_alone(design))
        .filter_map(|design| {
            let setting = match design.settings.get(&parameter.name)? {
                // What the scene says has its place among the others where it is known.
                Setting::AsInScene => parameter.nominal.clone(),
                own @ (Setting::Number(_) | Setting::Choice(_)) => own.clone(),
            };
            Some((design, setting))
        })
        .collect();
    let mut settings: Vec<Setting> = Vec::new();
    for (_, setting) in &taken {
        if *setting != Setting::AsInScene && !settings.contains(setting) {
            settings.push(setting.clone());
        }
    }
    // Numbers in their order, then choices as they came.
    settings.sort_by(|a, b| match (a.number(), b.number()) {
        (Some(a), Some(b)) => a.total_cmp(&b),
        (Some(_), None) => Ordering::Less,
        (None, Some(_)) => Ordering::Greater,
        (None, None) => Ordering::Equal,
    });
    settings
        .into_iter()
        .filter_map(|setting| {
            let own: Vec<&DesignRecord> = taken
                .iter()
                .filter(|(design, other)| *other == setting && design.measure(measure).is_some())
                .map(|(design, _)| *design)
                .collect();
            let weight = 1.0 / own.len() as f64;
            let terms: Vec<Term<'_>> = own.iter().map(|design| Term { weight, design }).collect();
            let mean = combine(&terms, measure).filter(|_| !own.is_empty())?;
            Some(EffectPoint { setting, designs: own.len(), mean })
        })
        .collect()
}
