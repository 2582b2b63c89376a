//! `docs/validation.md`, made from the findings.

use crate::formulas::Computed;
use crate::run::{Expected, Finding};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Values that are not checked here, or not at all.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Waiting {
    /// Values that other tests check.
    pub(crate) elsewhere: Vec<Elsewhere>,
    /// Values that nothing in the program gives, nor should.
    pub(crate) formula: Vec<Reason>,
    /// Values of features not yet built.
    pub(crate) waiting: Vec<Reason>,
}

impl Waiting {
    /// All that no test checks.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Reason> {
        self.formula.iter().chain(&self.waiting)
    }
}

/// Values of a case that a unit test checks.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Elsewhere {
    /// Name of the reference case.
    pub(crate) case: String,
    /// Names of the values, and the values.
    pub(crate) values: BTreeMap<String, f64>,
    /// File of the test.
    pub(crate) file: String,
    /// Name of the test.
    pub(crate) test: String,
    /// What it does.
    pub(crate) how: String,
}

/// Values of a case that are not checked, for one reason.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Reason {
    /// Name of the reference case.
    pub(crate) case: String,
    /// Names of the values.
    pub(crate) values: Vec<String>,
    /// Why not.
    pub(crate) why: String,
}

/// Deviations of independent runs, in standard errors.
pub(crate) fn deviations(findings: &[&Finding]) -> Vec<f64> {
    let first = findings.iter().filter(|finding| finding.independent);
    first.filter_map(|finding| finding.deviation).collect()
}

/// Root of the mean square; of a standard normal it is 1.
pub(crate) fn rms(deviations: &[f64]) -> f64 {
    (deviations.iter().map(|z| z * z).sum::<f64>() / deviations.len() as f64).sqrt()
}

/// The whole page.
pub(crate) fn page(findings: &[&Finding], computed: &[Computed], waiting: &Waiting) -> String {
    let mut text = INTRODUCTION.to_owned();
    summary(&mut text, findings, computed, waiting);
    traced(&mut text, findings);
    coarse(&mut text, findings);
    formulas(&mut text, computed);
    elsewhere(&mut text, &waiting.elsewhere);
    let formulas = "Formulas and contrasts";
    reasons(
        &mut text,
        formulas,
        "Nothing in the program gives these; none is tested.",
        &waiting.formula,
    );
    let not_yet = "Not checked yet";
    reasons(&mut text, not_yet, "What they need is not built.", &waiting.waiting);
    text.push_str(BESIDE);
    text
}

const BESIDE: &str = "
## Beside the reference

What the reference has no cases for is held against published values and laws by these tests.

| what | held against | test |
|---|---|---|
| media that scatter | a slab of van de Hulst (0.66096 up, 0.09739 back) and a half space of Giovanelli (0.2600), as in Wang, Jacques & Zheng (1995); mean path 4V/S (Blanco & Fournier 2003); moments of the phase function; luminance in a furnace; all estimators | `tests/agreement/volumes.rs`, `furnace.rs` |
| reliefs | a flank under 45 deg turns light to 1e-12; volumes; flux on every face of a furnace; grooves against the same profile as a sweep; no leak in a million segments | `tests/relief`, `tests/agreement/reliefs.rs` |
| rough surfaces: ggx, abg, harvey | chi-square of samples against the distribution function, reciprocity, no light created, total integrated scatter in closed form; all estimators | `src/optics`, `tests/agreement/finishes.rs` |
| daylight | horizontal illuminance of sun and skies, against integrals of the standard sky | `src/optics`, `tests/agreement/daylight.rs` |
| meshes from CAD | the exact sweep of the same rod, by angle of the mesh | `docs/cad.md` |
";

const INTRODUCTION: &str = "\
# Validation

Values that do not come from this program, and what it makes of them. The page is written by
`UPDATE_GOLDEN=1 cargo test --test validation`; without the variable the same command traces every value anew, holds it
against its reference, and fails when this page is not what comes out: seeds are fixed, and results have the same bits on
any number of threads. Citations stand beside the expected values in the scene files.

A run goes on until the standard error of each of its values is small enough: 0.07 % for fluxes (class F, and M where the
reference itself is a Monte Carlo value), 0.3 % for what is local (I), 0.03 % for invariances (X). The value must then lie
within 4 standard errors or, if that is more, within 0.2 % (F), 1 % (I), 0.1 % (X); for M within 3 errors of both sides
together and 0.3 %; a limit may be exceeded by 4 standard errors at most. In every run no light may leak and the flux
balance must close to 1e-9. Sensors count photons, except in the cases about windows (ES): there they gather, and the
widest window is read, bias and all.
";

fn summary(text: &mut String, findings: &[&Finding], computed: &[Computed], waiting: &Waiting) {
    let deviations = deviations(findings);
    let largest = deviations.iter().fold(0.0, |most: f64, z| most.max(z.abs()));
    let beyond_two = deviations.iter().filter(|z| z.abs() > 2.0).count();
    let count =
        |reasons: &[Reason]| reasons.iter().map(|reason| reason.values.len()).sum::<usize>();
    let elsewhere: usize = waiting.elsewhere.iter().map(|one| one.values.len()).sum();
    let (formulas, waiting) = (count(&waiting.formula), count(&waiting.waiting));
    let line = format!(
        "\n{} values were traced, {} are computed by a function, {elsewhere} are checked by a test beside the code, \
         {formulas} are formulas or contrasts, {waiting} are not checked yet. Of {} independent runs with noise one deviation each was taken, in standard errors: their root \
         mean square is {:.2}, the largest is {largest:.1}, and {beyond_two} are beyond 2 (for a normal distribution \
         {:.0} are expected).\n",
        findings.len(),
        computed.len(),
        deviations.len(),
        rms(&deviations),
        // 4.55 % of a normal distribution lie beyond two standard deviations.
        0.0455 * deviations.len() as f64,
    );
    text.push_str(&line);
}

fn traced(text: &mut String, findings: &[&Finding]) {
    text.push_str("\n## Traced values\n\n");
    text.push_str("| case | value | class | reference | ours | errors off | paths | source |\n");
    text.push_str("|---|---|---|--:|--:|--:|--:|---|\n");
    for finding in findings {
        let Finding { case, name, scene, over, class, expected, ours, deviation, source, .. } =
            finding;
        let expected = match expected {
            Expected::Value(value) => short(*value),
            Expected::Most(most) => format!("at most {}", short(*most)),
        };
        let deviation = deviation.map_or("exact".to_owned(), |z| format!("{z:+.2}"));
        let deviation = if matches!(finding.expected, Expected::Most(_)) { "" } else { &deviation };
        let mean = if over.is_empty() { String::new() } else { format!(", mean: {over}") };
        let paths = millions(ours.paths);
        line(
            text,
            &format!(
                "[{case}](../scenes/validation/{scene}.toml) | {name}{mean} | {class:?} | {expected} | {ours} | \
                 {deviation} | {paths} | {source}"
            ),
        );
    }
}

fn coarse(text: &mut String, findings: &[&Finding]) {
    text.push_str("\n## Known less well than their class asks\n\n| case | value | error | why |\n|---|---|--:|---|\n");
    for finding in findings.iter().filter(|finding| !finding.why.is_empty()) {
        let Finding { case, name, ours, why, .. } = finding;
        line(text, &format!("{case} | {name} | {:.2} % | {why}", 100.0 * ours.relative_error()));
    }
}

fn formulas(text: &mut String, computed: &[Computed]) {
    text.push_str("\n## Computed by a function\n\nWithout noise; met to 1e-6 of the value.\n\n");
    text.push_str("| case | value | reference | ours | off by |\n|---|---|--:|--:|--:|\n");
    for value in computed {
        let Computed { case, name, expected, ours } = value;
        let (expected, ours) = (short(*expected), short(*ours));
        line(text, &format!("{case} | {name} | {expected} | {ours} | {:.0e}", value.deviation()));
    }
}

fn elsewhere(text: &mut String, elsewhere: &[Elsewhere]) {
    text.push_str("\n## Checked by a test beside the code\n\n| case | values | test | how |\n|---|---|---|---|\n");
    for Elsewhere { case, values, file, test, how } in elsewhere {
        let values: Vec<&str> = values.keys().map(String::as_str).collect();
        line(text, &format!("{case} | {} | `{test}` in `{file}` | {how}", values.join("; ")));
    }
}

fn reasons(text: &mut String, heading: &str, words: &str, reasons: &[Reason]) {
    let table = format!("\n## {heading}\n\n{words}\n\n| case | values | why |\n|---|---|---|\n");
    text.push_str(&table);
    for Reason { case, values, why } in reasons {
        line(text, &format!("{case} | {} | {why}", values.join("; ")));
    }
}

fn line(text: &mut String, cells: &str) {
    writeln!(text, "| {cells} |").expect("a text takes what it is given");
}

/// Ten digits, without zeros at the end.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.9e}").parse().expect("it was a number");
    rounded.to_string()
}

fn millions(paths: u64) -> String {
    format!("{:.1} M", paths as f64 / 1e6)
}
