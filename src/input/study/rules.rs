//! Rules of a study that span several keys, or that need its scene.

use crate::error::{Diagnostic, DiagnosticKind};
use crate::input::keys::{Key, Places};
use crate::input::overrides::parse_key;
use crate::input::problems::Problems;
use crate::input::spec::study::{
    MOST_DESIGNS, MOST_PARAMETERS, NormalSpec, ParameterSpec, PlanSpec, SpreadSpec, StudySpec,
    UniformSpec,
};
use crate::input::study::{Parameter, problems_of_scene};
use crate::input::{Job, Settings};
use std::path::Path;

/// Notes what cannot be meant, whatever the scene.
pub(super) fn check(spec: &StudySpec, places: &Places, problems: &mut Problems) {
    if spec.parameters.is_empty() && places.has(&Key::of(&["parameters"])) {
        let message = "nothing is varied: there is no parameter";
        problems.error(&Key::of(&["parameters"]), message);
    }
    if spec.parameters.len() > MOST_PARAMETERS {
        let message = format!("more than {MOST_PARAMETERS} parameters");
        problems.error(&Key::of(&["parameters"]), message);
    }
    for (name, parameter) in &spec.parameters {
        let key = Key::of(&["parameters", name]);
        check_source(places, &spec.plan, &key, problems);
        check_spread(parameter, &key, problems);
        for (index, tied) in parameter.keys.iter().enumerate() {
            check_key(tied.key(), &key.field("keys").index(index), problems);
        }
    }
    check_shared_keys(spec, problems);
    check_set(spec, problems);
    check_count(spec, problems);
}

/// Notes a parameter whose values are not given, or twice, or not as the plan needs them.
fn check_source(places: &Places, plan: &PlanSpec, key: &Key, problems: &mut Problems) {
    // One that cannot be read is given, too.
    let given: Vec<&str> = ["values", "range", "choices", "spread"]
        .into_iter()
        .filter(|name| places.has(&key.field(name)))
        .collect();
    let (plan, taken): (&str, &[&str]) = match plan {
        PlanSpec::Grid => ("grid", &["values", "range", "choices"]),
        PlanSpec::OneAtATime => ("one_at_a_time", &["values", "range", "choices"]),
        PlanSpec::LatinHypercube(_) => {
            ("latin_hypercube", &["values", "range", "choices", "spread"])
        }
        PlanSpec::Sobol(_) => ("sobol", &["values", "range", "choices", "spread"]),
        PlanSpec::Tolerance(_) => ("tolerance", &["choices", "spread"]),
        PlanSpec::List(_) => ("list", &["choices"]),
    };
    let needs = format!("the plan `{plan}` takes one of `{}`", taken.join("`, `"));
    match given.as_slice() {
        [one] if taken.contains(one) => {}
        [] if plan == "list" => {}
        [] => _ = problems.error(key, "has no values").hint(needs),
        [one] if plan == "list" => {
            problems.error(&key.field(one), "the table of the plan gives the values");
        }
        [one] => {
            problems.error(&key.field(one), format!("is not for the plan `{plan}`")).hint(needs);
        }
        [_, second, ..] => _ = problems.error(&key.field(second), "the values are given twice"),
    }
}

/// Notes ranges and spreads without room.
fn check_spread(spec: &ParameterSpec, key: &Key, problems: &mut Problems) {
    if let Some(SpreadSpec::Normal(own)) = &spec.spread {
        check_limits(own, &key.field("spread").field("normal"), problems);
    }
    let mut ordered = |from: f64, to: f64, key: &Key| {
        if from >= to {
            let message = format!("{from} is not below `to`, which is {to}");
            problems.error(&key.field("from"), message);
        }
    };
    let spread = key.field("spread");
    match &spec.spread {
        Some(SpreadSpec::Uniform(UniformSpec { from, to })) => {
            ordered(*from, *to, &spread.field("uniform"));
        }
        Some(SpreadSpec::Normal(NormalSpec { from: Some(from), to: Some(to), .. })) => {
            ordered(*from, *to, &spread.field("normal"));
        }
        Some(SpreadSpec::Normal(_)) | None => {}
    }
    if let Some(range) = &spec.range {
        ordered(range.from, range.to, &key.field("range"));
    }
    if let Some(choices) = &spec.choices
        && choices.is_empty()
    {
        problems.error(&key.field("choices"), "there is nothing to choose from");
    }
}

fn check_key(text: &str, key: &Key, problems: &mut Problems) {
    if parse_key(text).is_none() {
        problems
            .error(key, format!("`{text}` is no dotted key"))
            .hint("write it as after -D, such as solids.rod.cylinder.length_mm");
    }
}

/// Notes a normal spread of which its limits leave next to nothing.
fn check_limits(spec: &NormalSpec, key: &Key, problems: &mut Problems) {
    let NormalSpec { mean, std_dev, from, to } = spec;
    let far = FARTHEST_LIMIT * std_dev;
    if from.is_some_and(|from| from > mean + far) || to.is_some_and(|to| to < mean - far) {
        let message = format!(
            "the limits leave nothing of the curve: they lie more than {FARTHEST_LIMIT} standard deviations beside its mean"
        );
        problems.error(key, message);
    }
}

/// Standard deviations beside the mean beyond which less than a millionth of a normal curve lies, 1.
const FARTHEST_LIMIT: f64 = 4.75;

/// Notes keys that are set twice, or lie in one another: the later would win without a word.
fn check_shared_keys(spec: &StudySpec, problems: &mut Problems) {
    let mut known: Vec<(Key, String)> = Vec::new();
    for (name, parameter) in &spec.parameters {
        for (index, tied) in parameter.keys.iter().enumerate() {
            let Some(own) = parse_key(tied.key()) else { continue };
            let other = known.iter().find(|(key, _)| key.is_within(&own) || own.is_within(key));
            if let Some((_, other)) = other {
                let key = Key::of(&["parameters", name, "keys"]).index(index);
                problems
                    .error(&key, format!("the parameter `{other}` sets this key, or a part of it"))
                    .hint("let each parameter have keys of its own");
            }
            known.push((own, name.clone()));
        }
    }
}

/// Notes keys under `set` that a study has other words for.
fn check_set(spec: &StudySpec, problems: &mut Problems) {
    for name in spec.set.keys() {
        let key = Key::of(&["set", name]);
        check_key(name, &key, problems);
        let own = ["run.paths", "run.time_s", "run.target", "run.seed", "run.estimator"];
        if own.iter().any(|own| name == own || name.starts_with(&format!("{own}."))) {
            problems.error(&key, "is set for all designs under `run` of the study");
        }
    }
}

/// Notes grids that are too large.
fn check_count(spec: &StudySpec, problems: &mut Problems) {
    match &spec.plan {
        PlanSpec::Grid => {}
        PlanSpec::OneAtATime
        | PlanSpec::List(_)
        | PlanSpec::LatinHypercube(_)
        | PlanSpec::Sobol(_)
        | PlanSpec::Tolerance(_) => return,
    }
    let levels = |own: &ParameterSpec| {
        let values = own.values.as_ref().map(Vec::len);
        let choices = own.choices.as_ref().map(indexmap::IndexMap::len);
        values.or(choices).or(own.range.as_ref().map(|range| range.count as usize)).unwrap_or(1)
    };
    let count =
        spec.parameters.values().fold(1usize, |count, own| count.saturating_mul(levels(own)));
    if count > MOST_DESIGNS {
        let message = format!("a grid of {count} designs is too large, at most {MOST_DESIGNS}");
        problems.error(&Key::of(&["plan"]), message).hint("use `sobol` or `latin_hypercube`");
    }
}

/// Notes keys that the scene does not have, or that take no value of their parameter. Where they take some, designs with
/// the others say what is wrong with them.
pub(super) fn check_keys(
    parameters: &[Parameter],
    scene: &Path,
    common: &Settings,
    problems: &mut Problems,
) {
    for parameter in parameters {
        for (index, tie) in parameter.ties.iter().enumerate() {
            let mut found = Vec::new();
            for setting in parameter.samples() {
                let Some(line) = parameter.line(tie, &setting) else { continue };
                let own = problems_of_override(scene, common, line);
                if own.is_empty() {
                    found.clear();
                    break;
                }
                found.push(own);
            }
            let key = Key::of(&["parameters", &parameter.name, "keys"]).index(index);
            for Diagnostic { message, hint, .. } in found.into_iter().next().into_iter().flatten() {
                let problem = problems.error(&key, message);
                if let Some(hint) = hint {
                    problem.hint(hint);
                }
            }
        }
    }
}

/// What is wrong with an override of a scene.
fn problems_of_override(scene: &Path, common: &Settings, line: String) -> Vec<Diagnostic> {
    let label = format!("-D {}", line.escape_debug());
    let mut found = problems_of_scene(scene, &common.with([line]));
    found.retain(|own| is_about(own, &label));
    found
}

fn is_about(found: &Diagnostic, label: &str) -> bool {
    let is_error = match found.kind {
        DiagnosticKind::Error => true,
        DiagnosticKind::Warning => false,
    };
    is_error && found.file.as_deref() == Some(Path::new(label))
}

/// Notes a scene that stops by the clock.
pub(super) fn check_clock(base: &Job, problems: &mut Problems) {
    if base.run.stop.time.is_some() {
        problems
            .error(&Key::of(&["run"]), "the scene stops by the clock, which no design repeats")
            .hint("give the study `paths` or `target` under [run]");
    }
}
