//! `docs/validation.md`, made from the tables of cases and what was traced for them.

use crate::formulas::Computed;
use crate::results::{Cells, Results};
use crate::run::{Expected, Row};
use lumiduct_base::digest::Digest;
use lumiduct_core::plan::NUMERICS;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Values that are not checked here, or not at all.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Unchecked {
    /// Values that other tests check.
    pub(crate) elsewhere: Vec<Elsewhere>,
    /// Values that nothing in the program gives, nor should.
    pub(crate) formula: Vec<Reason>,
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

/// What the page is made of.
pub(crate) struct Contents<'a> {
    /// Values that are traced, in their order.
    pub(crate) rows: &'a [Row],
    /// What came out of them.
    pub(crate) results: &'a Results,
    pub(crate) computed: &'a [Computed],
    pub(crate) unchecked: &'a Unchecked,
    /// Digest of tables and scenes.
    pub(crate) inputs: Digest,
}

/// The whole page.
pub(crate) fn page(contents: &Contents<'_>) -> String {
    let Contents { rows, results, computed, unchecked, .. } = *contents;
    let mut text = INTRODUCTION.to_owned();
    summary(&mut text, contents);
    traced(&mut text, rows, results);
    coarse(&mut text, rows, results);
    formulas(&mut text, computed);
    elsewhere(&mut text, &unchecked.elsewhere);
    let formulas = "Formulas and contrasts";
    reasons(
        &mut text,
        formulas,
        "The program does not compute these; they are not tested.",
        &unchecked.formula,
    );
    text.push_str(BESIDE);
    text
}

const BESIDE: &str = "
## Beside the reference

These tests compare features without reference cases with published values and laws.

| feature | compared with | test |
|---|---|---|
| media that scatter | a slab of van de Hulst (0.66096 up, 0.09739 back) and a half space of Giovanelli (0.2600), as in Wang, Jacques & Zheng (1995); mean path 4V/S (Blanco & Fournier 2003); moments of the phase function; luminance in a furnace; all estimators | `tests/agreement/volumes.rs`, `furnace.rs` |
| reliefs | a flank under 45 deg turns light to 1e-12; volumes; flux on every face of a furnace; grooves against the same profile as a sweep; no leak in a million segments | `tests/relief`, `tests/agreement/reliefs.rs` |
| rough surfaces: ggx, abg, harvey | chi-square of samples against the distribution function, reciprocity, no light created, total integrated scatter in closed form; all estimators | `src/optics`, `tests/agreement/finishes.rs` |
| daylight | horizontal illuminance of sun and skies, against integrals of the standard sky | `src/optics`, `tests/agreement/daylight.rs` |
| polarisation | complex fields traced by hand through metal mirrors in skew planes and through a round rod; gather paths against photons | `tests/polarisation.rs` |
| meshes from CAD | the exact sweep of the same rod, by angle of the mesh | `docs/cad.md` |
";

const INTRODUCTION: &str = "\
# Validation

This page compares results of the program with independent values. `cargo xtask validate` traces every value, compares it
with its reference, and fails if the result differs from this page: seeds are fixed, and results have the same bits on any
number of threads. `cargo xtask validate --write` writes the page. The scene files cite the sources of the expected values.

A run continues until the standard error of each of its values is small enough: 0.07 % for fluxes (class F, and M if the
reference itself is a Monte Carlo value), 0.3 % for local values (I), 0.03 % for invariances (X). The value must then lie
within 4 standard errors or, if that is more, within 0.2 % (F), 1 % (I), 0.1 % (X); for M within 3 combined errors of both
sides and 0.3 %; a limit may be exceeded by 4 standard errors at most. In every run no light may leak and the flux balance
must close to 1e-9. Sensors count photons, except in the cases about windows (ES): there they gather, and the value is that
of the estimate of second order, including its bias.

`cargo test` also compares every value with its reference, with the same limits and errors of 0.15 % (F and M), 0.7 % (I)
and 0.09 % (X), and checks that this page matches the scenes, tables and numerics of the program.
";

fn summary(text: &mut String, contents: &Contents<'_>) {
    let Contents { rows, results, computed, unchecked, inputs } = contents;
    let elsewhere: usize = unchecked.elsewhere.iter().map(|one| one.values.len()).sum();
    let formulas: usize = unchecked.formula.iter().map(|reason| reason.values.len()).sum();
    let (traced, computed) = (rows.len(), computed.len());
    let line = format!(
        "\n{traced} values are traced, {computed} are computed by a function, {elsewhere} are checked by a test beside the code, \
         {formulas} are formulas or contrasts. Numerics {NUMERICS}; digest of tables and scenes {inputs}.\n\n{}\n",
        results.deviations,
    );
    text.push_str(&line);
}

fn traced(text: &mut String, rows: &[Row], results: &Results) {
    text.push_str("\n## Traced values\n\n");
    text.push_str("| case | value | class | reference | ours | errors off | paths | source |\n");
    text.push_str("|---|---|---|--:|--:|--:|--:|---|\n");
    for (row, cells) in rows.iter().zip(&results.cells) {
        let Row { case, name, scene, over, class, expected, source, .. } = row;
        let Cells { ours, deviation, paths, .. } = cells;
        let expected = match expected {
            Expected::Value(value) => short(*value),
            Expected::Most(most) => format!("at most {}", short(*most)),
        };
        let mean = if over.is_empty() { String::new() } else { format!(", mean: {over}") };
        line(
            text,
            &format!(
                "[{case}](../scenes/validation/{scene}.toml) | {name}{mean} | {class:?} | {expected} | {ours} | \
                 {deviation} | {paths} | {source}"
            ),
        );
    }
}

fn coarse(text: &mut String, rows: &[Row], results: &Results) {
    text.push_str(COARSE);
    text.push_str("\n\n| case | value | error | why |\n|---|---|--:|---|\n");
    for (row, cells) in rows.iter().zip(&results.cells).filter(|(row, _)| !row.why.is_empty()) {
        let Row { case, name, why, .. } = row;
        line(text, &format!("{case} | {name} | {} | {why}", cells.error));
    }
}

/// Heading of the values whose table has an error in its third column.
pub(crate) const COARSE: &str = "\n## Larger errors than the class requires";

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
