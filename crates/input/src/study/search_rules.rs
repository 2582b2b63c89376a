//! Rules of a search: what is best, and what scatters in production.

use crate::keys::Key;
use crate::problems::{Problems, name_hint};
use crate::spec::study::{ParameterSpec, PlanSpec, SearchPlan, StudySpec, Tolerance};
use crate::study::cost::Cost;
use crate::study::parameters::{Domain, Parameter};

/// Notes a search that does not say what is best, or says it twice.
pub(super) fn check_search(spec: &StudySpec, problems: &mut Problems) {
    let PlanSpec::Search(plan) = &spec.plan else { return };
    let key = Key::of(&["plan", "search"]);
    match (&spec.ranking, plan.cost.is_empty()) {
        (Some(_), true) | (None, false) => {}
        (None, true) => {
            problems
                .error(&key, "a search needs to know which design is the best")
                .hint("add `[ranking]` with a `measure`, or `cost` with factors of parameters");
        }
        (Some(_), false) => {
            problems
                .error(&key.field("cost"), "`ranking` already says which design is the best")
                .hint("leave out `cost`, or replace `[ranking]` by a `[[check]]` on its measure");
        }
    }
    for (name, factor) in
        plan.cost.iter().filter(|(_, factor)| **factor == 0.0 || !factor.is_finite())
    {
        let message = format!("the factor {factor} leaves nothing to compare");
        problems.error(&key.field("cost").field(name), message).hint("leave it out");
    }
    if plan.samples.is_some() && spec.parameters.values().all(|own| own.tolerance.is_none()) {
        problems
            .error(&key.field("samples"), "no parameter has a `tolerance`, so nothing scatters")
            .hint("give one to the parameters that production scatters, or leave it out");
    }
    if !plan.cost.is_empty() && spec.measures.iter().any(|name| name == Cost::NAME) {
        problems
            .error(&Key::of(&["measures"]), "`cost` is recorded by itself")
            .hint("leave it out");
    }
    for name in plan.cost.keys() {
        let (key, names) = (key.field("cost").field(name), spec.parameters.keys());
        match spec.parameters.get(name) {
            Some(own) if own.choices.is_some() => {
                problems.error(&key, "its choices are no numbers").hint("leave it out");
            }
            Some(own) if own.range.is_none() => {
                problems.error(&key, "the search does not change it").hint("leave it out");
            }
            Some(_) => {}
            None => {
                let message = format!("there is no parameter `{name}`");
                problems.error(&key, message).hint(name_hint(name, names.map(String::as_str)));
            }
        }
    }
    let ranges = spec.parameters.values().filter(|own| own.range.is_some()).count();
    let is_complete = |own: &ParameterSpec| own.tolerance.is_some() || own.choices.is_some();
    if !spec.parameters.is_empty() && ranges == 0 && spec.parameters.values().all(is_complete) {
        let key = Key::of(&["parameters"]);
        problems
            .error(&key, "there is nothing to search: no parameter has a `range`")
            .hint("the plan `grid` tries every choice");
    }
    check_race(spec, (plan, ranges), problems);
}

/// Notes a search with too few designs to compare its choices.
fn check_race(spec: &StudySpec, (plan, ranges): (&SearchPlan, usize), problems: &mut Problems) {
    let counts = spec.parameters.values().filter_map(|own| Some(own.choices.as_ref()?.len()));
    let combinations = counts.fold(1_usize, usize::saturating_mul);
    // A simplex of each, and a design more.
    let least = combinations.saturating_mul(ranges + 2);
    if combinations > 1 && least > plan.designs as usize {
        let message = format!("too few for {combinations} combinations of choices");
        problems
            .error(&Key::of(&["plan", "search", "designs"]), message)
            .hint(format!("give {least} or more, or fewer choices"));
    }
}

/// Notes a tolerance where there is no best design, or of a whole number.
pub(super) fn check_tolerance(
    spec: &ParameterSpec,
    plan: &PlanSpec,
    key: &Key,
    problems: &mut Problems,
) {
    let Some(Tolerance::PlusMinus(most) | Tolerance::StdDev(most)) = spec.tolerance else { return };
    let key = key.field("tolerance");
    match plan {
        PlanSpec::Search(_) if spec.choices.is_some() => {
            problems.error(&key, "a choice does not scatter").hint("leave it out");
        }
        PlanSpec::Search(_) if spec.whole => {
            problems.error(&key, "a whole number does not scatter").hint("leave one of them out");
        }
        // Ends and tails are to be numbers, too.
        PlanSpec::Search(_) if (most * 100.0).is_finite() => {}
        PlanSpec::Search(_) => _ = problems.error(&key, format!("{most} is no width")),
        PlanSpec::Tolerance(_) => {
            problems.error(&key, "is for a search").hint("the plan `tolerance` takes `spread`");
        }
        PlanSpec::Grid
        | PlanSpec::OneAtATime
        | PlanSpec::List(_)
        | PlanSpec::LatinHypercube(_)
        | PlanSpec::Sobol(_) => {
            problems.error(&key, "is for a search, whose best design it scatters").hint(
                "for designs about the scene as it is, use the plan `tolerance` with `spread`",
            );
        }
    }
}

/// Notes parameters that only scatter, about a value that the scene does not give.
pub(super) fn check_centers(parameters: &[Parameter], problems: &mut Problems) {
    for own in parameters.iter().filter(|own| own.domain == Domain::AsInScene) {
        if own.nominal.number().is_none() {
            problems
                .error(
                    &Key::of(&["parameters", &own.name]),
                    "its keys have no common number in the scene around which it could scatter",
                )
                .hint("set them in the scene, or under `set` here, or give it a `range`");
        }
    }
}
