//! Rules of a search: what is best, and what scatters in production.

use crate::keys::Key;
use crate::problems::{Problems, name_hint};
use crate::spec::study::{
    Best, ParameterSpec, PlanSpec, Ranking, SearchPlan, StudySpec, Tolerance,
};
use crate::study::cost::Cost;
use crate::study::parameters::{Domain, Parameter};

/// Latest designs of a search for each range: a simplex has usually converged after as many.
pub const LATEST_PER_RANGE: usize = 10;

/// Notes a search that does not say what is best, or says it twice.
pub(super) fn check_search(spec: &StudySpec, problems: &mut Problems) {
    let PlanSpec::Search(plan) = &spec.plan else { return };
    let key = Key::of(&["plan", "search"]);
    let is_costed = !plan.cost.is_empty();
    match (&spec.ranking, is_costed, plan.objectives.is_empty()) {
        (Some(_), false, true) | (None, true, true) | (None, _, false) => {}
        (None, false, true) => {
            problems
                .error(&key, "a search needs to know which design is the best")
                .hint("add `[ranking]` with a `measure`, `cost` with factors of parameters, or `objectives`");
        }
        (Some(_), true, true) => {
            problems
                .error(&key.field("cost"), "`ranking` already says which design is the best")
                .hint("leave out `cost`, or replace `[ranking]` by a `[[check]]` on its measure");
        }
        (Some(_), _, false) => {
            problems
                .error(&key.field("objectives"), "`ranking` already says which design is the best")
                .hint("leave out `[ranking]`, or list its measure among the objectives");
        }
    }
    check_objectives(spec, plan, problems);
    check_cost(spec, plan, problems);
    if plan.samples.is_some()
        && plan.objectives.is_empty()
        && spec.parameters.values().all(|own| own.tolerance.is_none())
    {
        problems
            .error(&key.field("samples"), "no parameter has a `tolerance`, so nothing scatters")
            .hint("give one to the parameters that production scatters, or leave it out");
    }
    let ranges = spec.parameters.values().filter(|own| own.range.is_some()).count();
    let is_complete = |own: &ParameterSpec| own.tolerance.is_some() || own.choices.is_some();
    if !spec.parameters.is_empty() && ranges == 0 && spec.parameters.values().all(is_complete) {
        let key = Key::of(&["parameters"]);
        problems
            .error(&key, "there is nothing to search: no parameter has a `range`")
            .hint("the plan `grid` tries every choice");
    }
    check_designs(spec, (plan, ranges), problems);
}

/// Notes objectives that cannot be compared, or that contradict other keys.
fn check_objectives(spec: &StudySpec, plan: &SearchPlan, problems: &mut Problems) {
    let search = Key::of(&["plan", "search"]);
    let (objectives, is_costed) = (&plan.objectives, !plan.cost.is_empty());
    if objectives.is_empty() {
        return;
    }
    for (place, own) in objectives.iter().enumerate() {
        let key = search.field("objectives").index(place);
        check_objective(spec, (own, &objectives[..place]), is_costed, &key, problems);
    }
    if is_costed && objectives.iter().all(|own| own.measure != Cost::NAME) {
        problems
            .error(&search.field("cost"), "it is none of the `objectives`")
            .hint("list it there as `{ measure = \"cost\", best = \"lowest\" }`, or leave it out");
    }
    if plan.least_gain.is_some() {
        problems
            .error(
                &search.field("least_gain"),
                "it follows a single best design, and a front has none",
            )
            .hint("leave it out");
    }
    let scatter = "production scatters a single best design, and a front has none";
    if plan.samples.is_some() {
        problems.error(&search.field("samples"), scatter).hint("leave it out");
    }
    for (name, _) in spec.parameters.iter().filter(|(_, own)| own.tolerance.is_some()) {
        problems
            .error(&Key::of(&["parameters", name, "tolerance"]), scatter)
            .hint("choose a design of the front, and trace its scene with the plan `tolerance`");
    }
}

/// Notes an objective that is no measure, or is listed before.
fn check_objective(
    spec: &StudySpec,
    (Ranking { measure, best }, before): (&Ranking, &[Ranking]),
    is_costed: bool,
    key: &Key,
    problems: &mut Problems,
) {
    let names = spec.measures.iter().map(String::as_str);
    let names = names.chain(is_costed.then_some(Cost::NAME));
    let at = key.field("measure");
    if before.iter().any(|own| own.measure == *measure) {
        problems.error(&at, format!("`{measure}` is listed twice")).hint("leave one out");
    } else if names.clone().all(|own| own != measure) {
        let hint = match measure == Cost::NAME {
            true => "say what a design costs: `cost = { PARAMETER = factor }` beside `objectives`"
                .to_owned(),
            false => name_hint(measure, names),
        };
        problems.error(&at, format!("`{measure}` is not one of `measures`")).hint(hint);
    } else if measure == Cost::NAME && *best == Best::Highest {
        problems
            .error(key, "the lowest cost is the best")
            .hint("add `best = \"lowest\"`; a negative factor rewards larger values");
    }
}

/// Notes costs that leave nothing to compare.
fn check_cost(spec: &StudySpec, plan: &SearchPlan, problems: &mut Problems) {
    let key = Key::of(&["plan", "search", "cost"]);
    for (name, factor) in
        plan.cost.iter().filter(|(_, factor)| **factor == 0.0 || !factor.is_finite())
    {
        let message = format!("the factor {factor} leaves nothing to compare");
        problems.error(&key.field(name), message).hint("leave it out");
    }
    if !plan.cost.is_empty() && spec.measures.iter().any(|name| name == Cost::NAME) {
        problems
            .error(&Key::of(&["measures"]), "`cost` is recorded by itself")
            .hint("leave it out");
    }
    for name in plan.cost.keys() {
        let (key, names) = (key.field(name), spec.parameters.keys());
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
}

/// Notes a search with too few designs to compare its choices, or for a front.
fn check_designs(spec: &StudySpec, (plan, ranges): (&SearchPlan, usize), problems: &mut Problems) {
    let counts = spec.parameters.values().filter_map(|own| Some(own.choices.as_ref()?.len()));
    let combinations = counts.fold(1_usize, usize::saturating_mul);
    let shares = if plan.objectives.is_empty() { 1 } else { plan.least_shares() };
    // A simplex of each, and a design more.
    let least = combinations.saturating_mul(shares).saturating_mul(ranges + 2);
    if (combinations > 1 || shares > 1) && least > plan.designs as usize {
        let what = match (combinations, shares) {
            (1, _) => "a front".to_owned(),
            (_, 1) => format!("{combinations} combinations of choices"),
            (_, _) => format!("a front with {combinations} combinations of choices"),
        };
        let fewer = if combinations > 1 { ", or fewer choices" } else { "" };
        let why = if shares > 1 { ", so that each direction has a simplex" } else { "" };
        problems
            .error(&Key::of(&["plan", "search", "designs"]), format!("too few for {what}"))
            .hint(format!("give {least} or more{why}{fewer}"));
    }
    let latest = LATEST_PER_RANGE * ranges;
    if plan.least_gain.is_some() && latest >= plan.designs as usize {
        let message = format!(
            "it compares the latest {latest} designs, 10 for each range, with those before, and there are none"
        );
        problems
            .error(&Key::of(&["plan", "search", "least_gain"]), message)
            .hint("leave it out, or give more `designs`");
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
