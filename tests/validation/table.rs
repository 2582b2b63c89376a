//! The tables of cases next to this file: which scene with which overrides gives which reference
//! values.
//!
//! The value and its citation are in the scene file, as the check at the same place; a variant
//! overrides them together with the geometry.

use serde::Deserialize;

/// A table of cases.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Table {
    /// The cases, in the order of the page.
    pub(crate) case: Vec<Case>,
}

/// A scene and the values read from it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Case {
    /// Name of the reference case.
    pub(crate) id: String,
    /// Scene file in `scenes/validation`, without its ending.
    pub(crate) scene: String,
    /// The values read from it, by default one for each check of the scene.
    pub(crate) values: Vec<Value>,
    /// What reads them.
    #[serde(default)]
    pub(crate) by: By,
    /// Keys of the scene that the variants set.
    #[serde(default)]
    pub(crate) keys: Vec<String>,
    /// Runs of the scene; without any, it is run once as it is.
    #[serde(default)]
    variants: Vec<Variant>,
}

/// What reads the values of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum By {
    /// Photons in the cells of the sensors.
    #[default]
    Photons,
    /// The estimate of second order of gathering, E1, whose bias is known: cases about
    /// windows.
    SecondOrder,
}

/// A reference value.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Value {
    /// Name of the reference case, where it is not that of the table's entry.
    id: Option<String>,
    /// Name in the reference; `{}` is replaced by the name of the variant.
    name: String,
    /// Tolerance class.
    pub(crate) class: Class,
    /// Number of its check in the scene, from 0. Omitted: its own place in the list.
    pub(crate) check: Option<usize>,
    /// The reference divides the measure by this.
    #[serde(default = "one")]
    pub(crate) per: f64,
    /// What errors are relative to. Omitted: the value.
    pub(crate) scale: Option<f64>,
    /// Standard error to reach in place of that of its class, relative.
    pub(crate) reach: Option<f64>,
    /// The reason for `reach`.
    #[serde(default)]
    pub(crate) why: String,
    /// What the mean is taken over, where the reference states a point value; the scene says how.
    #[serde(default)]
    pub(crate) over: String,
    /// Standard error of the reference.
    #[serde(default)]
    unc: f64,
}

/// A run of a scene.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Variant {
    /// Name in the reference.
    name: String,
    /// What the keys are set to.
    #[serde(default)]
    set: Vec<toml::Value>,
    /// Standard error of the reference.
    #[serde(default)]
    unc: f64,
}

/// How long values are traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Precision {
    /// Until the standard error is below the tolerance of the class, so that a wrong formula is
    /// seen: `cargo test`.
    Quick,
    /// As docs/validation.md has them: `cargo xtask validate`.
    Page,
}

/// How accurate a value must be and how well it must be met, relative to the value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub(crate) enum Class {
    /// Flux.
    F,
    /// Local illuminance or intensity.
    I,
    /// Flux that the reference has computed by Monte Carlo, too.
    M,
    /// Invariance.
    X,
}

impl Class {
    /// Standard error that a run must reach.
    fn std_error(self, precision: Precision) -> f64 {
        match (self, precision) {
            (Self::F | Self::M, Precision::Page) => 0.0007,
            (Self::I, Precision::Page) => 0.003,
            (Self::X, Precision::Page) => 0.0003,
            (Self::F | Self::M, Precision::Quick) => 0.0015,
            (Self::I, Precision::Quick) => 0.007,
            (Self::X, Precision::Quick) => 0.0009,
        }
    }

    /// Deviation that is allowed, however small the standard error is; for M in addition to three errors.
    pub(crate) fn limit(self) -> f64 {
        match self {
            Self::F => 0.002,
            Self::I => 0.01,
            Self::M => 0.003,
            Self::X => 0.001,
        }
    }
}

impl Table {
    /// Reads a table and checks it against its own rules.
    pub(crate) fn parse(text: &str) -> Self {
        let table: Self = toml::from_str(text).expect("the tables beside this file are valid");
        for case in &table.case {
            for value in &case.values {
                assert_eq!(
                    value.reach.is_some(),
                    !value.why.is_empty(),
                    "{} {}",
                    case.id,
                    value.name
                );
            }
            for variant in &case.variants {
                assert_eq!(variant.set.len(), case.keys.len(), "{} {}", case.id, variant.name);
            }
        }
        table
    }
}

impl Case {
    /// The runs.
    pub(crate) fn variants(&self) -> Vec<&Variant> {
        const AS_IT_IS: &Variant = &Variant { name: String::new(), set: Vec::new(), unc: 0.0 };
        if self.variants.is_empty() { vec![AS_IT_IS] } else { self.variants.iter().collect() }
    }

    /// The overrides as after `-D` on the command line.
    pub(crate) fn overrides(&self, variant: &Variant) -> Vec<String> {
        self.keys.iter().zip(&variant.set).map(|(key, value)| format!("{key}={value}")).collect()
    }
}

impl Value {
    /// Name of its reference case.
    pub(crate) fn case<'a>(&'a self, case: &'a Case) -> &'a str {
        self.id.as_deref().unwrap_or(&case.id)
    }

    /// Its name in a variant.
    pub(crate) fn name(&self, variant: &Variant) -> String {
        self.name.replace("{}", &variant.name)
    }

    /// Standard error to reach, relative.
    pub(crate) fn std_error(&self, precision: Precision) -> f64 {
        self.reach.unwrap_or(0.0).max(self.class.std_error(precision))
    }

    /// Standard error of the reference.
    pub(crate) fn uncertainty(&self, variant: &Variant) -> f64 {
        self.unc.max(variant.unc)
    }
}

fn one() -> f64 {
    1.0
}
