//! One run of a scene, until every value is as accurate as its class and the precision demand.

use crate::table::{By, Case, Class, Precision, Value, Variant};
use lumiduct_core::measure::{self, Measure, Status};
use lumiduct_core::plan::{Check, Request, RunPlan, StopRules};
use lumiduct_core::tally::sigmas;
use lumiduct_core::transport::{Findings, Orders, Run};
use lumiduct_input::{self as input, Job, Settings};
use std::path::{Path, PathBuf};

/// Paths after which a run that has not reached its errors has failed.
const MOST_PATHS: u64 = 600_000_000;
/// The flux balance must close to this share of the source flux.
const BALANCE: f64 = 1e-9;
/// Deviation that passes, in standard errors; for class M.
const SIGMAS: f64 = 4.0;
const SIGMAS_MONTE_CARLO: f64 = 3.0;
/// Rounding of values without noise, relative.
const ROUNDING: f64 = 1e-9;

/// A value of the reference, as the page lists it.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) case: String,
    pub(crate) name: String,
    pub(crate) scene: String,
    pub(crate) over: String,
    pub(crate) class: Class,
    /// Why it is less accurate than its class demands; empty where it is not.
    pub(crate) why: String,
    /// The source given by the reference.
    pub(crate) source: String,
    /// The value of the reference.
    pub(crate) expected: Expected,
}

/// The finding of a run for one value.
#[derive(Debug)]
pub(crate) struct Finding {
    /// The value of the reference.
    pub(crate) row: Row,
    /// Ours, normalised as the reference is.
    pub(crate) ours: Measure,
    /// Deviation in standard errors, that of the reference included; `None` for values without noise.
    pub(crate) deviation: Option<f64>,
    /// Whether it is the first value with noise of its run: those of different runs are independent.
    pub(crate) independent: bool,
    /// Its faults.
    pub(crate) faults: Vec<String>,
}

/// The value of the reference.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Expected {
    Value(f64),
    Most(f64),
}

/// The values that a variant of a case is held against, and the hash of its scene.
pub(crate) fn rows(case: &Case, variant: &Variant) -> (Vec<Row>, String) {
    let job = load(case, variant, 0);
    let wanted = wanted(case, variant, &job, Precision::Page);
    (wanted.iter().map(|wanted| row(case, wanted)).collect(), job.hash)
}

/// Runs a variant of a case.
pub(crate) fn run(case: &Case, variant: &Variant, seed: u64, precision: Precision) -> Vec<Finding> {
    let job = load(case, variant, seed);
    let wanted = wanted(case, variant, &job, precision);
    let (findings, reached) = trace(&job, &wanted);
    let mut faults = books(&job, &findings);
    if !reached {
        faults.push("the error of its class was not reached".to_owned());
    }
    let mut findings: Vec<Finding> =
        wanted.iter().map(|wanted| judge(case, &job, &findings, wanted)).collect();
    findings[0].faults.append(&mut faults);
    if let Some(first) = findings.iter_mut().find(|finding| finding.deviation.is_some()) {
        first.independent = true;
    }
    findings
}

fn load(case: &Case, variant: &Variant, seed: u64) -> Job {
    let settings = Settings {
        overrides: case.overrides(variant),
        seed: Some(seed),
        // The other estimators are compared with forward in tests/agreement.
        estimator: Some(match case.by {
            By::Photons => Request::Forward,
            By::SecondOrder => Request::Gather,
        }),
        ..Settings::default()
    };
    match input::load(&scene_file(&case.scene), &settings) {
        Ok(job) => job,
        Err(error) => panic!("{} {settings:?}: {error}", case.id),
    }
}

fn wanted<'a>(
    case: &'a Case,
    variant: &Variant,
    job: &'a Job,
    precision: Precision,
) -> Vec<Wanted<'a>> {
    let values = case.values.iter().enumerate();
    values
        .map(|(place, value)| {
            let check = &job.checks[value.check.unwrap_or(place)];
            assert!(check.source.is_some(), "{}: a check without a source", job.name);
            let std_error = value.std_error(precision) * scale(value, check);
            let (name, uncertainty) = (value.name(variant), value.uncertainty(variant));
            Wanted { value, check, by: case.by, name, uncertainty, std_error }
        })
        .collect()
}

/// What errors of a value are relative to, in the unit of the measure.
fn scale(value: &Value, check: &Check) -> f64 {
    let scale = value.scale.or(check.equals).or(check.max).expect("a value or a limit");
    // Zero is expected: errors are relative to all light of the source.
    if scale == 0.0 { 1.0 } else { scale }
}

/// A scene of the validation.
pub(crate) fn scene_file(name: &str) -> PathBuf {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join("validation");
    scenes.join(name).with_extension("toml")
}

/// A wanted value.
struct Wanted<'a> {
    value: &'a Value,
    check: &'a Check,
    by: By,
    name: String,
    uncertainty: f64,
    /// Standard error that must be reached, in the unit of the measure.
    std_error: f64,
}

impl Wanted<'_> {
    /// The standard error, over the one that must be reached. The spread of a few passes of gathering is none.
    fn error_left(&self, job: &Job, findings: &Findings) -> f64 {
        let measure = self.measure(job, findings);
        let too_few = self.by == By::SecondOrder && measure.status == Status::TooFew;
        let error = measure.total_error();
        if error.is_finite() && !too_few { error / self.std_error } else { f64::INFINITY }
    }

    fn measure(&self, job: &Job, findings: &Findings) -> Measure {
        let name = &self.check.measure;
        let read = |findings: &Findings| measure::value_of(&job.scene, findings, name);
        let found = match self.by {
            By::Photons => read(findings),
            // Photons count as the paths traced; there are few gather paths, and many photons for
            // each.
            By::SecondOrder => read(&second_order(findings))
                .map(|own| Measure { paths: findings.photons.paths(), ..own }),
        };
        found.unwrap_or_else(|| panic!("{}: no measure `{name}`", job.name))
    }
}

/// The gathered light by the estimate of second order, as ordinary readings.
fn second_order(findings: &Findings) -> Findings {
    let gathered = findings.others.first().expect("the case asks for gathering");
    let stage = gathered.stages.last().expect("a wave has been traced");
    Findings::forward(Orders::of(&stage.counts).second.clone())
}

/// Traces whole rounds until all errors are reached, or too many paths are traced.
fn trace(job: &Job, wanted: &[Wanted<'_>]) -> (Findings, bool) {
    // Whether the errors are reached is checked here, not by a rule of the scene.
    let plan = RunPlan { stop: StopRules::default(), ..job.run.clone() };
    let mut run = Run::new(&job.scene, &plan);
    loop {
        run.next_wave();
        let findings = run.findings();
        let most = |most: f64, wanted: &Wanted<'_>| most.max(wanted.error_left(job, &findings));
        let left = wanted.iter().fold(0.0, most);
        if left <= 1.0 || run.paths() > MOST_PATHS {
            return (findings, left <= 1.0);
        }
        // Errors fall as one over the square root of the paths: no check before half of the missing
        // paths are traced.
        let missing = run.waves() as f64 * (left * left - 1.0);
        for _ in 0..(0.5 * missing).min(run.waves() as f64) as u64 {
            run.next_wave();
        }
    }
}

/// Faults in the balance of a run: light lost in the geometry, or a balance that does not close.
fn books(job: &Job, findings: &Findings) -> Vec<String> {
    let balance = measure::measure(&job.scene, findings).balance;
    let mut faults = Vec::new();
    if balance.leaked.value != 0.0 {
        faults.push(format!("leaked {} at {:?}", balance.leaked, findings.photons.leaks));
    }
    if balance.residual.value.abs() > BALANCE * job.scene.source_flux() {
        faults.push(format!("the balance is open by {:e}", balance.residual.value));
    }
    faults
}

fn row(case: &Case, wanted: &Wanted<'_>) -> Row {
    let Wanted { value, check, name, .. } = wanted;
    // Zero within a tolerance is an upper limit for what is never negative.
    let most = check.within.filter(|_| check.equals == Some(0.0)).or(check.max);
    let equals = check.equals.filter(|equals| *equals != 0.0 || most.is_none());
    let expected = match (equals, most) {
        (Some(equals), _) => Expected::Value(equals / value.per),
        (None, Some(most)) => Expected::Most(most / value.per),
        (None, None) => panic!("{} {name}: a check without a value", case.id),
    };
    Row {
        case: value.case(case).to_owned(),
        name: name.clone(),
        scene: case.scene.clone(),
        over: value.over.clone(),
        class: value.class,
        why: value.why.clone(),
        source: check.source.clone().unwrap_or_default(),
        expected,
    }
}

fn judge(case: &Case, job: &Job, findings: &Findings, wanted: &Wanted<'_>) -> Finding {
    let Wanted { value, uncertainty, .. } = wanted;
    let row = row(case, wanted);
    let ours = normalised(wanted.measure(job, findings), value.per);
    let mut faults = Vec::new();
    let mut deviation = None;
    match row.expected {
        Expected::Value(expected) => {
            let error = ours.total_error().hypot(*uncertainty);
            let allowed = allowed(value, expected, ours.total_error(), error);
            let off = ours.value - expected;
            if off.is_nan() || off.abs() > allowed {
                faults.push(format!("off by {off:e}, allowed {allowed:e}"));
            }
            if ours.value != 0.0 && ours.std_error > ROUNDING * ours.value.abs() {
                deviation = Some(sigmas(ours.value, error, expected));
            }
        }
        Expected::Most(most) => {
            let error = ours.total_error();
            let beyond = ours.value - most;
            if beyond.is_nan() || beyond > SIGMAS * error {
                faults.push(format!("beyond {most:e} by {beyond:e}, with an error of {error:e}"));
            }
        }
    }
    Finding { row, ours, deviation, independent: false, faults }
}

/// A measure as the reference states it.
fn normalised(measure: Measure, per: f64) -> Measure {
    let unit = if per == 1.0 { measure.unit.clone() } else { "1".to_owned() };
    let bias = measure.bias.map(|bias| bias / per);
    Measure {
        value: measure.value / per,
        std_error: measure.std_error / per,
        bias,
        unit,
        ..measure
    }
}

/// Deviation that is allowed.
fn allowed(value: &Value, expected: f64, std_error: f64, error: f64) -> f64 {
    let limit = value.class.limit() * value.scale.unwrap_or(expected.abs());
    match value.class {
        Class::M => SIGMAS_MONTE_CARLO * error + limit,
        Class::F | Class::I | Class::X => (SIGMAS * std_error).max(limit),
    }
}
