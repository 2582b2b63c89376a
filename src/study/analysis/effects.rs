//! Main effects: the effect of a parameter on a measure, averaged over all others.

use crate::study::analysis::combine::{Term, combine};
use indexmap::IndexMap;
use lumiduct_input::Setting;
use lumiduct_report::study::{
    DesignRecord, Effect, EffectPoint, ParameterFacts, PlanFacts, StudyFacts,
};
use std::cmp::Ordering;

/// The effects of all parameters on all measures. Samples have none: every design has its own
/// settings.
pub(super) fn effects(facts: &StudyFacts, designs: &[DesignRecord]) -> Vec<Effect> {
    match facts.plan {
        PlanFacts::Grid | PlanFacts::OneAtATime | PlanFacts::List => {}
        PlanFacts::LatinHypercube(_)
        | PlanFacts::Sobol(_)
        | PlanFacts::Tolerance(_)
        | PlanFacts::Search(_) => {
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

/// A design, with its setting of the parameter under study.
type Own<'a> = (Setting, &'a DesignRecord);

/// The mean at every setting, over the same blocks for all settings, so that only the parameter
/// differs between them, even in a list or where a design of a grid has failed. Settings without
/// partners, such as one that makes no scene, are left out.
fn points(
    facts: &StudyFacts,
    designs: &[DesignRecord],
    parameter: &ParameterFacts,
    measure: &str,
) -> Vec<EffectPoint> {
    let own: Vec<Own<'_>> = designs
        .iter()
        .map(|design| (parameter.setting_in(design).clone(), design))
        .filter(|(setting, own)| *setting != Setting::AsInScene && own.measure(measure).is_some())
        .collect();
    let all = blocks(facts, &own, parameter);
    // The settings of the block with the most; among equals, the first.
    let settings = all
        .iter()
        .map(|block| in_order(block))
        .reduce(|most, own| if own.len() > most.len() { own } else { most })
        .unwrap_or_default();
    let has_all = |block: &Vec<Own<'_>>| {
        settings.iter().all(|setting| block.iter().any(|(own, _)| own == setting))
    };
    let blocks: Vec<Vec<Own<'_>>> = all.into_iter().filter(has_all).collect();
    let Some(first) = settings.first() else { return Vec::new() };
    let point = |setting: &Setting| {
        let terms = mean_of(&blocks, setting, 1.0);
        let mean = combine(&terms, measure).filter(|_| !terms.is_empty())?;
        let step: Vec<Term<'_>> = [terms.clone(), mean_of(&blocks, first, -1.0)].concat();
        let from_first = combine(&step, measure).filter(|_| setting != first);
        Some(EffectPoint { setting: setting.clone(), designs: terms.len(), mean, from_first })
    };
    settings.iter().filter_map(point).collect()
}

/// The terms of `sign` times the mean at a setting, to which every block contributes alike.
fn mean_of<'a>(blocks: &[Vec<Own<'a>>], setting: &Setting, sign: f64) -> Vec<Term<'a>> {
    let mut terms = Vec::new();
    for block in blocks {
        let same = block.iter().filter(|(own, _)| own == setting);
        let weight = sign / (blocks.len() * same.clone().count()) as f64;
        terms.extend(same.map(|(_, design)| Term { weight, design }));
    }
    terms
}

/// All settings, each once: numbers in ascending order, then choices in order of appearance.
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

/// Groups of designs that differ in one parameter only.
fn blocks<'a>(
    facts: &StudyFacts,
    own: &[Own<'a>],
    parameter: &ParameterFacts,
) -> Vec<Vec<Own<'a>>> {
    let others: Vec<&ParameterFacts> =
        facts.parameters.iter().filter(|other| other.name != parameter.name).collect();
    let mut blocks: IndexMap<String, Vec<Own<'a>>> = IndexMap::new();
    for (setting, design) in own {
        let key: String =
            others.iter().map(|other| format!("{:?};", other.setting_in(design))).collect();
        blocks.entry(key).or_default().push((setting.clone(), design));
    }
    blocks.into_values().collect()
}
