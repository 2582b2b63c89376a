//! Main effects: what a parameter does to a measure on the average over all others.

use crate::input::Setting;
use crate::report::study::{
    DesignRecord, Effect, EffectPoint, ParameterFacts, PlanFacts, StudyFacts,
};
use crate::study::analysis::combine::{Term, combine};
use indexmap::IndexMap;
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
            points: points(designs, parameter, measure),
        })
        .filter(|effect| effect.points.len() > 1)
        .collect()
}

/// A design, with its setting of the parameter that is looked at.
type Own<'a> = (Setting, &'a DesignRecord);

/// The mean at every setting, over the same blocks for all settings: so that nothing but the parameter differs between
/// them, where a design of a grid has failed and in a list, too. None where no block has every setting.
fn points(designs: &[DesignRecord], parameter: &ParameterFacts, measure: &str) -> Vec<EffectPoint> {
    let own: Vec<Own<'_>> =
        designs.iter().filter_map(|design| Some((setting(design, parameter)?, design))).collect();
    let settings = in_order(&own);
    let blocks: Vec<Vec<Own<'_>>> = blocks(&own, parameter)
        .into_iter()
        .map(|block| block.into_iter().filter(|(_, own)| own.measure(measure).is_some()).collect())
        .filter(|block: &Vec<Own<'_>>| {
            settings.iter().all(|setting| block.iter().any(|(own, _)| own == setting))
        })
        .collect();
    let point = |setting: Setting| {
        let mut terms = Vec::new();
        for block in &blocks {
            let same = block.iter().filter(|(own, _)| *own == setting);
            let weight = 1.0 / (blocks.len() * same.clone().count()) as f64;
            terms.extend(same.map(|(_, design)| Term { weight, design }));
        }
        let mean = combine(&terms, measure).filter(|_| !terms.is_empty())?;
        Some(EffectPoint { setting, designs: terms.len(), mean })
    };
    settings.into_iter().filter_map(point).collect()
}

/// What a parameter is set to in a design, where that is known: what the scene says has its place among the others.
fn setting(design: &DesignRecord, parameter: &ParameterFacts) -> Option<Setting> {
    match design.settings.get(&parameter.name)? {
        Setting::AsInScene => Some(parameter.nominal.clone()),
        own @ (Setting::Number(_) | Setting::Choice(_)) => Some(own.clone()),
    }
    .filter(|setting| *setting != Setting::AsInScene)
}

/// All settings, each once: numbers in their order, then choices as they came.
fn in_order(own: &[Own<'_>]) -> Vec<Setting> {
    let mut settings: Vec<Setting> = Vec::new();
    for (setting, _) in own {
        if !settings.contains(setting) {
            settings.push(setting.clone());
        }
    }
    settings.sort_by(|a, b| match (a.number(), b.number()) {
        (Some(a), Some(b)) => a.total_cmp(&b),
        (Some(_), None) => Ordering::Less,
        (None, Some(_)) => Ordering::Greater,
        (None, None) => Ordering::Equal,
    });
    settings
}

/// Groups of designs that are the same but for a parameter.
fn blocks<'a>(own: &[Own<'a>], parameter: &ParameterFacts) -> Vec<Vec<Own<'a>>> {
    let mut blocks: IndexMap<String, Vec<Own<'a>>> = IndexMap::new();
    for (setting, design) in own {
        let others = design.settings.iter().filter(|(name, _)| **name != parameter.name);
        let key: String = others.map(|(name, other)| format!("{name}={other:?};")).collect();
        blocks.entry(key).or_default().push((setting.clone(), design));
    }
    blocks.into_values().collect()
}
