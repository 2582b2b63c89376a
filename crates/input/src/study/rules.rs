//! Rules of a study that span several keys, or that need its scene.

use crate::keys::{Key, Places};
use crate::lower::context::Scope;
use crate::lower::names::{check_length, check_name, check_title};
use crate::overrides::parse_key;
use crate::problems::Problems;
use crate::spec::study::{
    MOST_DESIGNS, MOST_PARAMETERS, NormalSpec, ParameterSpec, PlanSpec, SpreadSpec, StudySpec,
    TiedKeySpec,
};
use crate::study::parameters::{DESIGN_COLUMN, Domain, OTHER_COLUMNS, Parameter, column};
use crate::study::search_rules;
use crate::texts::argument_label;
use crate::{Job, Settings, draft};
use indexmap::IndexMap;
use lumiduct_base::error::{Diagnostic, DiagnosticKind, Error};
use lumiduct_base::text::is_control;
use std::collections::BTreeSet;
use std::path::Path;

/// Notes what is invalid for any scene.
pub(super) fn check(
    spec: &StudySpec,
    places: &Places,
    overrides: &[String],
    problems: &mut Problems,
) {
    check_title(&spec.title, problems);
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
        check_name(name, &key, problems);
        check_unit(parameter, &key, problems);
        check_source(places, &spec.plan, &key, problems);
        search_rules::check_tolerance(parameter, &spec.plan, &key, problems);
        check_room(parameter, &key, problems);
        for (index, tied) in parameter.keys.iter().enumerate() {
            let key = key.field("keys").index(index);
            check_key(tied.key(), &key, problems);
            check_factor(tied, &key, problems);
        }
    }
    check_columns(spec, problems);
    check_shared_keys(spec, problems);
    check_set(spec, problems);
    check_overrides(spec, overrides, problems);
    check_count(spec, problems);
    search_rules::check_search(spec, problems);
}

/// Notes a unit that is invalid for a column.
fn check_unit(parameter: &ParameterSpec, key: &Key, problems: &mut Problems) {
    let (Some(unit), key) = (&parameter.unit, key.field("unit")) else { return };
    if unit.contains(is_control) {
        problems.error(&key, "a unit is a few letters of one line");
    } else {
        check_length("unit", unit, &key, problems);
    }
}

/// Notes columns of the table of results with the same name.
fn check_columns(spec: &StudySpec, problems: &mut Problems) {
    let mut known: Vec<String> = OTHER_COLUMNS.map(str::to_owned).to_vec();
    known.push(DESIGN_COLUMN.to_owned());
    let mut add = |column: String, key: &Key| {
        if known.contains(&column) {
            let message = format!("there would be two columns `{column}` in the table of results");
            problems.error(key, message).hint("choose another name");
        }
        known.push(column);
    };
    for (name, parameter) in &spec.parameters {
        let key = Key::of(&["parameters", name]);
        add(column(name, parameter.unit.as_deref()), &key);
    }
    for (index, measure) in spec.measures.iter().enumerate() {
        if spec.measures[..index].contains(measure) {
            let key = Key::of(&["measures"]).index(index);
            problems.error(&key, format!("`{measure}` is listed twice")).hint("leave one out");
        }
    }
}

/// Notes a factor that makes a parameter ineffective.
fn check_factor(tied: &TiedKeySpec, key: &Key, problems: &mut Problems) {
    match tied {
        TiedKeySpec::Scaled(own) if own.factor == 0.0 => {
            problems.error(&key.field("factor"), "a factor of 0 leaves nothing to vary");
        }
        TiedKeySpec::Scaled(_) | TiedKeySpec::Same(_) => {}
    }
}

/// Notes a parameter whose values are missing, given twice, or not as the plan needs them.
fn check_source(places: &Places, plan: &PlanSpec, key: &Key, problems: &mut Problems) {
    // An unreadable one counts as given, too.
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
        PlanSpec::Search(_) => ("search", &["range", "choices"]),
        PlanSpec::List(_) => ("list", &["choices"]),
    };
    let needs = format!("the plan `{plan}` takes one of `{}`", taken.join("`, `"));
    match given.as_slice() {
        [one] if taken.contains(one) => {}
        [] if plan == "list" => {}
        [] if plan == "search" && places.has(&key.field("tolerance")) => {}
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

/// Notes empty ranges and spreads.
fn check_room(spec: &ParameterSpec, key: &Key, problems: &mut Problems) {
    if let Some(SpreadSpec::Normal(own)) = &spec.spread {
        check_limits(own, &key.field("spread").field("normal"), problems);
    }
    if let Some((from, to, key)) = ends(spec, key) {
        if from >= to {
            let message = format!("{from} is not below `to`, which is {to}");
            problems.error(&key.field("from"), message);
        } else if spec.whole && from.ceil() > to.floor() {
            problems.error(&key, format!("there is no whole number from {from} to {to}"));
        }
    }
    if spec.choices.as_ref().is_some_and(IndexMap::is_empty) {
        problems.error(&key.field("choices"), "there are no choices");
    }
}

/// The least and the greatest value of a parameter that has them, and their table.
fn ends(spec: &ParameterSpec, key: &Key) -> Option<(f64, f64, Key)> {
    if let Some(own) = &spec.range {
        return Some((own.from, own.to, key.field("range")));
    }
    let spread = key.field("spread");
    match spec.spread.as_ref()? {
        SpreadSpec::Uniform(own) => Some((own.from, own.to, spread.field("uniform"))),
        SpreadSpec::Normal(own) => Some((own.from?, own.to?, spread.field("normal"))),
    }
}

/// Notes duplicate values, also after rounding: their designs would be the same.
pub(super) fn check_levels(parameters: &[Parameter], places: &Places, problems: &mut Problems) {
    for parameter in parameters {
        let Domain::Levels(levels) = &parameter.domain else { continue };
        let mut known = BTreeSet::new();
        let twice = levels.iter().find(|level| !known.insert(level.to_string()));
        if let Some(level) = twice {
            let table = Key::of(&["parameters", &parameter.name]);
            let given = ["values", "range"].map(|name| table.field(name));
            let key = given.into_iter().find(|key| places.has(key)).unwrap_or(table);
            let how = if parameter.whole { ", rounded to whole numbers" } else { "" };
            problems.error(&key, format!("{level} is listed twice{how}")).hint("leave one out");
        }
    }
}

pub(super) fn check_key(text: &str, key: &Key, problems: &mut Problems) {
    if parse_key(text).is_none() {
        problems
            .error(key, format!("`{text}` is not a dotted key"))
            .hint("write it as after -D, such as solids.rod.cylinder.length_mm");
    }
}

/// Notes a normal spread whose limits exclude nearly all of it.
fn check_limits(spec: &NormalSpec, key: &Key, problems: &mut Problems) {
    let NormalSpec { mean, std_dev, from, to } = spec;
    let far = FARTHEST_LIMIT * std_dev;
    if from.is_some_and(|from| from > mean + far) || to.is_some_and(|to| to < mean - far) {
        let message = format!(
            "the limits exclude the whole distribution: they lie more than {FARTHEST_LIMIT} standard \
                deviations from its mean"
        );
        problems.error(key, message);
    }
}

/// Standard deviations from the mean beyond which less than a millionth of a normal distribution
/// lies, 1.
const FARTHEST_LIMIT: f64 = 4.75;

/// Notes keys that are set twice or contain one another: the later would silently win.
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
                    .hint("give each parameter its own keys");
            }
            known.push((own, name.clone()));
        }
    }
}

/// Notes keys under `set` for which a study has its own keys, or that a parameter overrides.
fn check_set(spec: &StudySpec, problems: &mut Problems) {
    for name in spec.set.keys() {
        let key = Key::of(&["set", name]);
        check_key(name, &key, problems);
        let own = ["run.paths", "run.time_s", "run.target", "run.seed", "run.estimator"];
        if own.iter().any(|own| name == own || name.starts_with(&format!("{own}."))) {
            problems.error(&key, "is set for all designs under `run` of the study");
        }
        if let Some(parameter) = parse_key(name).and_then(|set| varied_by(spec, &set)) {
            problems.error(&key, format!("the parameter `{parameter}` sets it in every design"));
        }
    }
}

/// Notes command-line overrides that a parameter overrides in turn.
fn check_overrides(spec: &StudySpec, overrides: &[String], problems: &mut Problems) {
    for line in overrides {
        let key = line.split_once('=').and_then(|(key, _)| parse_key(key.trim()));
        if let Some(parameter) = key.and_then(|key| varied_by(spec, &key)) {
            let message = format!("this parameter sets what `-D {line}` sets, in every design");
            problems
                .error(&Key::of(&["parameters", parameter]), message)
                .hint("remove the -D, or remove the key from the parameter");
        }
    }
}

/// The parameter that sets a key or a table around it.
fn varied_by<'a>(spec: &'a StudySpec, wanted: &Key) -> Option<&'a str> {
    let sets = |parameter: &ParameterSpec| {
        let mut keys = parameter.keys.iter().filter_map(|tied| parse_key(tied.key()));
        keys.any(|own| wanted.is_within(&own))
    };
    spec.parameters.iter().find(|(_, own)| sets(own)).map(|(name, _)| name.as_str())
}

/// Notes grids that are too large.
fn check_count(spec: &StudySpec, problems: &mut Problems) {
    match &spec.plan {
        PlanSpec::Grid => {}
        PlanSpec::OneAtATime
        | PlanSpec::List(_)
        | PlanSpec::LatinHypercube(_)
        | PlanSpec::Sobol(_)
        | PlanSpec::Tolerance(_)
        | PlanSpec::Search(_) => return,
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

/// Notes keys that the scene does not have, or that accept no value of their parameter. Where they
/// accept some, the designs with the others report their problems.
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

/// The problems of an override of a scene.
fn problems_of_override(scene: &Path, common: &Settings, line: String) -> Vec<Diagnostic> {
    let label = argument_label(&line);
    let mut found = problems_of_scene(scene, &common.with([line]));
    found.retain(|own| is_about(own, &label));
    found
}

/// The problems of a scene with some overrides, without those of the scene alone.
fn problems_of_scene(scene: &Path, settings: &Settings) -> Vec<Diagnostic> {
    match draft(scene, &settings.overrides) {
        Ok(mut draft) => {
            _ = draft.lower(Scope::Keys);
            draft.problems.into_diagnostics(&draft.places)
        }
        Err(Error::Input(diagnostics)) => diagnostics,
        // Files that disappeared in between are reported by the designs.
        Err(Error::Usage(_) | Error::Io { .. } | Error::Output { .. }) => Vec::new(),
    }
}

fn is_about(found: &Diagnostic, label: &str) -> bool {
    let is_error = match found.kind {
        DiagnosticKind::Error => true,
        DiagnosticKind::Warning => false,
    };
    is_error && found.file.as_deref() == Some(Path::new(label))
}

/// Notes a scene with a time limit.
pub(super) fn check_clock(base: &Job, problems: &mut Problems) {
    if base.run.stop.time.is_some() {
        problems
            .error(
                &Key::of(&["run"]),
                "the scene stops after a time, which does not repeat from run to run",
            )
            .hint("give the study `paths` or `target` under [run]");
    }
}
