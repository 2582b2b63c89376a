//! Reference values that do not come from this program: every value is traced until its error is
//! small enough, and must be met.
//!
//! `cargo test` needs coarser errors than docs/validation.md, which `cargo xtask validate` traces
//! anew; with `UPDATE_GOLDEN=1` this rewrites it.

#![allow(
    clippy::print_stdout,
    reason = "a line for each value, shown by --nocapture and on failure"
)]

mod formulas;
mod page;
mod results;
mod run;
mod scope;
mod table;

use crate::page::{Contents, Elsewhere, Unchecked};
use crate::results::Results;
use crate::run::{Finding, Row};
use crate::scope::Scope;
use crate::table::{Case, Table, Variant};
use lumiduct_base::digest::Digest;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::{Mutex, OnceLock};

/// A table of cases with its results.
struct Family {
    name: &'static str,
    table: &'static str,
    findings: OnceLock<Vec<Finding>>,
}

impl Family {
    const fn new(name: &'static str, table: &'static str) -> Self {
        Self { name, table, findings: OnceLock::new() }
    }
}

static FAMILIES: [Family; 10] = [
    Family::new("benchmarks", include_str!("benchmarks.toml")),
    Family::new("photometry", include_str!("photometry.toml")),
    Family::new("fresnel", include_str!("fresnel.toml")),
    Family::new("mirror_tubes", include_str!("mirror_tubes.toml")),
    Family::new("ducts", include_str!("ducts.toml")),
    Family::new("rods", include_str!("rods.toml")),
    Family::new("diffuse", include_str!("diffuse.toml")),
    Family::new("windows", include_str!("windows.toml")),
    Family::new("daylight", include_str!("daylight.toml")),
    Family::new("colour", include_str!("colour.toml")),
];

/// Seeds of a family start at its number times this.
const SEEDS: u64 = 1000;

/// The findings of a family's runs. They are made once, and one family at a time, as each run takes
/// all threads.
fn findings(number: usize) -> &'static [Finding] {
    static TRACING: Mutex<()> = Mutex::new(());
    let scope = Scope::demanded();
    let runs_before: usize =
        (0..number).map(|before| each_run(&FAMILIES[before], |_, _| ()).len()).sum();
    FAMILIES[number].findings.get_or_init(|| {
        let _alone = TRACING.lock();
        let mut run = 0;
        let findings = each_run(&FAMILIES[number], |case, variant| {
            run += 1;
            if !scope.has(runs_before + run) {
                return Vec::new();
            }
            let seed = number as u64 * SEEDS + run as u64;
            let found = run::run(case, variant, seed, scope.precision());
            found.iter().for_each(|finding| println!("{}", line(finding)));
            found
        });
        findings.into_iter().flatten().collect()
    })
}

/// Does something for each run of a family, in their order.
fn each_run<T>(family: &Family, mut what: impl FnMut(&Case, &Variant) -> T) -> Vec<T> {
    let mut done = Vec::new();
    for case in &Table::parse(family.table).case {
        done.extend(case.variants().into_iter().map(|variant| what(case, variant)));
    }
    done
}

fn line(finding: &Finding) -> String {
    let Finding { row: Row { case, name, expected, .. }, ours, deviation, faults, .. } = finding;
    let deviation = deviation.map_or("-".to_owned(), |z| format!("{z:+.2}"));
    let (paths, faults) = (ours.paths, faults.join("; "));
    format!(
        "{case} {name}: {ours}, expected {expected:?}, {deviation} sigmas, {paths} paths {faults}"
    )
}

/// All findings, in the order of the page.
fn all_findings() -> Vec<&'static Finding> {
    (0..FAMILIES.len()).flat_map(findings).collect()
}

/// All rows of the page, and a digest of what they depend on: the tables and the scenes.
fn all_rows() -> (Vec<Row>, Digest) {
    let (mut rows, mut digest) = (Vec::new(), Digest::default());
    for family in &FAMILIES {
        for (mut found, scene) in each_run(family, run::rows) {
            rows.append(&mut found);
            digest.add(scene.as_bytes());
        }
        digest.add(format!("{:?}", Table::parse(family.table)).as_bytes());
    }
    (rows, digest)
}

fn unchecked() -> Unchecked {
    toml::from_str(include_str!("unchecked.toml")).expect("the list beside this file is valid")
}

/// Asserts that all values of a family are met.
fn check(name: &str) {
    let number = FAMILIES.iter().position(|family| family.name == name).expect("a known family");
    let wrong: Vec<String> =
        findings(number).iter().filter(|finding| !finding.faults.is_empty()).map(line).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn benchmarks() {
    check("benchmarks");
}

#[test]
fn photometry() {
    check("photometry");
}

#[test]
fn fresnel() {
    check("fresnel");
}

#[test]
fn mirror_tubes() {
    check("mirror_tubes");
}

#[test]
fn ducts() {
    check("ducts");
}

#[test]
fn rods() {
    check("rods");
}

#[test]
fn diffuse() {
    check("diffuse");
}

#[test]
fn windows() {
    check("windows");
}

#[test]
fn daylight() {
    check("daylight");
}

#[test]
fn functions_give_the_values_of_the_formulas() {
    for value in formulas::computed() {
        assert!(value.deviation().abs() <= formulas::LIMIT, "{value:?}");
    }
}

#[test]
fn deviations_look_like_a_standard_normal() {
    let deviations = results::deviations(&all_findings());
    let (count, rms) = (deviations.len(), results::rms(&deviations));
    // The root mean square of n deviations has a standard error of 1/√(2n).
    let error = (2.0 * count as f64).sqrt().recip();
    println!("rms {rms:.3} of {count} runs, expected 1 ± {error:.3}");
    assert!(count >= 10, "{count} runs are too few to tell");
    assert!((rms - 1.0).abs() < 4.0 * error, "rms {rms} of {count} runs");
}

/// Benchmark scenes (B1 to B4), daylight (DL) and elements (EL: films as planes, holes as
/// patterns): cases that are not in the reference.
fn is_our_own(id: &str) -> bool {
    id.starts_with("DL") || id.starts_with("EL") || id.starts_with('B') && !id.starts_with("BD")
}

/// Number of values in the reference, without our own cases.
const REFERENCE_VALUES: usize = 444;

#[test]
fn no_value_of_the_reference_is_forgotten() {
    let mut names = BTreeSet::new();
    let mut add = |case: &str, name: &str| {
        assert!(names.insert(format!("{case} {name}")), "{case} {name} is listed twice");
    };
    for family in &FAMILIES {
        for case in Table::parse(family.table).case.iter().filter(|case| !is_our_own(&case.id)) {
            for variant in case.variants() {
                case.values.iter().for_each(|value| add(value.case(case), &value.name(variant)));
            }
        }
    }
    formulas::computed().iter().for_each(|value| add(value.case, &value.name));
    for elsewhere in &unchecked().elsewhere {
        elsewhere.values.keys().for_each(|name| add(&elsewhere.case, name));
    }
    for reason in unchecked().formula {
        reason.values.iter().for_each(|name| add(&reason.case, name));
    }
    assert_eq!(names.len(), REFERENCE_VALUES);
}

#[test]
fn tests_that_are_named_are_there_and_hold_the_values() {
    for Elsewhere { file, test, values, .. } in unchecked().elsewhere {
        let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(&file));
        let text = text.unwrap_or_else(|error| panic!("{file}: {error}"));
        let (before, body) =
            text.split_once(&format!("fn {test}() {{")).expect("a test of that name");
        assert!(before.trim_end().ends_with("#[test]"), "{test} is no test");
        let body = body.split("#[test]").next().expect("a first piece");
        for (name, value) in values {
            assert!(body.contains(&format!("{value:?}")), "{test}: no {value:?} for {name}");
        }
    }
}

#[test]
fn every_scene_is_used() {
    let used: BTreeSet<String> = FAMILIES
        .iter()
        .flat_map(|family| Table::parse(family.table).case)
        .map(|case| case.scene)
        .collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join("validation");
    let there: BTreeSet<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    assert_eq!(used, there);
}

/// Quickly this needs no tracing: the page belongs to the tables and scenes if it is made of them
/// and of the results that it has itself.
#[test]
fn the_page_of_results_is_current() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join("validation.md");
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    let (rows, inputs) = all_rows();
    let mut results = Results::read(&written, &rows);
    match Scope::demanded() {
        Scope::Quick => {}
        Scope::Part { .. } => results.replace(&rows, &all_findings()),
        Scope::Page => results = Results::of(&all_findings()),
    }
    let (computed, unchecked) = (formulas::computed(), unchecked());
    let contents = Contents {
        rows: &rows,
        results: &results,
        computed: &computed,
        unchecked: &unchecked,
        inputs,
    };
    let page = page::page(&contents);
    if std::env::var_os("UPDATE_GOLDEN").is_some() && Scope::demanded() == Scope::Page {
        std::fs::write(&path, &page).unwrap();
        return;
    }
    let differs = page.lines().zip(written.lines()).find(|(new, old)| new != old);
    assert!(
        page == written,
        "docs/validation.md is not what comes out, first at {differs:?}; `cargo xtask validate --write` traces it anew"
    );
}
