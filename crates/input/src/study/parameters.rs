//! The parameters of a study: values, and the scene overrides they make.

use crate::Job;
use crate::keys::Key;
use crate::overrides::parse_key;
use crate::problems::Problems;
use crate::spec::study::{
    NormalSpec, ParameterSpec, PlanSpec, SpreadSpec, StudySpec, TiedKeySpec, Tolerance, UniformSpec,
};
use crate::tree::Value;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The setting of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Setting {
    /// A number, in the unit of the parameter.
    Number(f64),
    /// One of the choices of the parameter, by name.
    Choice(String),
    /// Unset: the value of the scene applies.
    AsInScene,
}

impl Setting {
    /// The nearest whole number. Zero has no sign, so that there is only one setting 0.
    pub fn whole(number: f64) -> Self {
        Self::Number(number.round() + 0.0)
    }

    /// The number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Choice(_) | Self::AsInScene => None,
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(out, "{number}"),
            Self::Choice(name) => write!(out, "{name}"),
            Self::AsInScene => Ok(()),
        }
    }
}

/// A key of the scene that takes `factor` times the value of a parameter plus `offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// The dotted key.
    pub key: String,
    /// What a number is multiplied by, 1.
    pub factor: f64,
    /// What is added to the product, in the unit of the key.
    pub offset: f64,
}

/// The domain of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Domain {
    /// One of these.
    Levels(Vec<Setting>),
    /// Any number between two, all equally likely.
    Uniform {
        /// The least.
        from: f64,
        /// The greatest.
        to: f64,
    },
    /// A number about a mean, within limits.
    Normal {
        /// Mean before truncation.
        mean: f64,
        /// Standard deviation before truncation.
        std_dev: f64,
        /// The least.
        from: Option<f64>,
        /// The greatest.
        to: Option<f64>,
    },
    /// The values of a table.
    Listed,
    /// The value of the scene alone.
    AsInScene,
}

/// A quantity that is varied.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its unit, if it has one.
    pub unit: Option<String>,
    /// The keys it sets.
    pub ties: Vec<Tie>,
    /// Its domain.
    pub domain: Domain,
    /// The values of the choices, as TOML.
    pub choices: IndexMap<String, String>,
    /// Its value in the scene, if that is a number on which all keys agree.
    pub nominal: Setting,
    /// Whether numbers are rounded to whole ones.
    pub whole: bool,
    /// How production scatters it, if a search is to find that out.
    pub tolerance: Option<Tolerance>,
}

impl Parameter {
    /// The overrides of the scene that a setting makes, each `key=value`.
    pub fn overrides(&self, setting: &Setting) -> Vec<String> {
        self.ties.iter().filter_map(|tie| self.line(tie, setting)).collect()
    }

    /// The override of one of its keys, `key=value`.
    pub(super) fn line(&self, tie: &Tie, setting: &Setting) -> Option<String> {
        let value = match setting {
            Setting::Number(number) => (tie.factor * number + tie.offset).to_string(),
            Setting::Choice(name) => self.choices.get(name)?.clone(),
            Setting::AsInScene => return None,
        };
        Some(format!("{}={value}", tie.key))
    }

    /// Settings to try the keys with.
    pub(super) fn samples(&self) -> Vec<Setting> {
        match &self.domain {
            Domain::Levels(levels) => levels.clone(),
            Domain::Uniform { from, to } => [*from, *to].map(Setting::Number).to_vec(),
            Domain::Normal { mean, from, to, .. } => {
                let (from, to) = (from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY));
                vec![Setting::Number(mean.max(from).min(to))]
            }
            // The values of the table are not known yet: the value of the scene will do.
            Domain::Listed | Domain::AsInScene => vec![self.nominal.clone()],
        }
    }

    /// Itself as production scatters it about a setting; without a tolerance it has that setting alone.
    pub fn scattered(&self, about: &Setting) -> Self {
        let center = about.number().or(self.nominal.number());
        let domain = match (center, self.tolerance) {
            (Some(center), Some(Tolerance::PlusMinus(most))) => {
                Domain::Uniform { from: center - most, to: center + most }
            }
            (Some(mean), Some(Tolerance::StdDev(std_dev))) => {
                Domain::Normal { mean, std_dev, from: None, to: None }
            }
            (_, None) | (None, Some(_)) => Domain::Levels(vec![about.clone()]),
        };
        Self { domain, ..self.clone() }
    }
}

/// The column of the table of results before those of parameters and measures.
pub const DESIGN_COLUMN: &str = "design";
/// The columns after them.
pub const OTHER_COLUMNS: [&str; 4] = ["rank", "paths", "ended", "error"];

/// The column of a parameter in the table of results: "`length_mm`"; the name alone if it has this
/// ending.
pub fn column(name: &str, unit: Option<&str>) -> String {
    match unit {
        Some(unit) if !name.ends_with(&format!("_{unit}")) => format!("{name}_{unit}"),
        Some(_) | None => name.to_owned(),
    }
}

/// The parameters of a study.
pub(super) fn lower(spec: &StudySpec, base: &Job, problems: &mut Problems) -> Vec<Parameter> {
    let lowered = spec.parameters.iter().map(|(name, parameter)| {
        let key = Key::of(&["parameters", name]);
        let ties: Vec<Tie> = parameter.keys.iter().map(tie).collect();
        Parameter {
            name: name.clone(),
            unit: parameter.unit.clone(),
            nominal: nominal(&ties, base),
            domain: domain(parameter, &spec.plan),
            choices: choices(parameter, &key.field("choices"), problems),
            whole: parameter.whole,
            tolerance: parameter.tolerance,
            ties,
        }
    });
    lowered.collect()
}

fn tie(spec: &TiedKeySpec) -> Tie {
    match spec {
        TiedKeySpec::Same(key) => Tie { key: key.clone(), factor: 1.0, offset: 0.0 },
        TiedKeySpec::Scaled(own) => {
            Tie { key: own.key.clone(), factor: own.factor, offset: own.offset }
        }
    }
}

/// The common value of all keys of a parameter in the scene.
fn nominal(ties: &[Tie], base: &Job) -> Setting {
    let value = |tie: &Tie| {
        let node = base.places.node(&parse_key(&tie.key)?)?;
        let number = match node.value {
            Value::Integer(number) => number as f64,
            Value::Float(number) => number,
            Value::Table(_)
            | Value::Array(_)
            | Value::String(_)
            | Value::Boolean(_)
            | Value::Datetime
            | Value::Unreadable => return None,
        };
        (tie.factor != 0.0).then(|| (number - tie.offset) / tie.factor)
    };
    let values: Option<Vec<f64>> = ties.iter().map(value).collect();
    // Offsets and factors cause rounding.
    let agrees = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs().max(b.abs());
    match values.as_deref() {
        Some([first, rest @ ..]) if rest.iter().all(|other| agrees(*first, *other)) => {
            Setting::Number(*first)
        }
        Some(_) | None => Setting::AsInScene,
    }
}

/// The domain of a parameter. Checks have ensured that it is given once and fits the plan.
fn domain(spec: &ParameterSpec, plan: &PlanSpec) -> Domain {
    let is_stepped = match plan {
        PlanSpec::Grid | PlanSpec::OneAtATime => true,
        PlanSpec::LatinHypercube(_)
        | PlanSpec::Sobol(_)
        | PlanSpec::Tolerance(_)
        | PlanSpec::Search(_) => false,
        PlanSpec::List(_) => return Domain::Listed,
    };
    let level =
        |value: f64| if spec.whole { Setting::whole(value) } else { Setting::Number(value) };
    if let Some(values) = &spec.values {
        return Domain::Levels(values.iter().map(|value| level(*value)).collect());
    }
    if let Some(choices) = &spec.choices {
        return Domain::Levels(choices.keys().cloned().map(Setting::Choice).collect());
    }
    if let Some(range) = &spec.range {
        let (from, to, last) = (range.from, range.to, f64::from(range.count - 1));
        if !is_stepped {
            return Domain::Uniform { from, to };
        }
        let step = |index| level(rounded(from + (to - from) * f64::from(index) / last));
        return Domain::Levels((0..range.count).map(step).collect());
    }
    match &spec.spread {
        Some(SpreadSpec::Uniform(UniformSpec { from, to })) => {
            Domain::Uniform { from: *from, to: *to }
        }
        Some(SpreadSpec::Normal(NormalSpec { mean, std_dev, from, to })) => {
            Domain::Normal { mean: *mean, std_dev: *std_dev, from: *from, to: *to }
        }
        None => Domain::AsInScene,
    }
}

/// A number with twelve digits: sums of decimal fractions are slightly inexact.
fn rounded(number: f64) -> f64 {
    format!("{number:.11e}").parse().unwrap_or(number)
}

fn choices(spec: &ParameterSpec, key: &Key, problems: &mut Problems) -> IndexMap<String, String> {
    let mut made = IndexMap::new();
    for (name, value) in spec.choices.iter().flatten() {
        match toml_text(value) {
            Some(text) => _ = made.insert(name.clone(), text),
            None => _ = problems.error(&key.field(name), "cannot be a value of a scene"),
        }
    }
    made
}

/// A value as TOML in one line; `None` for what TOML does not have.
pub(super) fn toml_text(value: &serde_json::Value) -> Option<String> {
    Some(toml::Value::try_from(value).ok()?.to_string())
}
