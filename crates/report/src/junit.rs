//! JUnit XML: checks and differences as test cases, for machines that run them.
//!
//! It holds neither times nor identifiers: the same results give the same bytes. Only this file names `quick_junit`.

use crate::diff::{Diff, DiffRow, Judgement, sentence};
use crate::measured::{MeasuredDiff, verdict};
use crate::study::{DesignOutcome, StudyReport};
use crate::words::numbered;
use crate::{CheckResult, Existing, Report, TargetFacts, expect_file, write_whole};
use lumiduct_base::error::{Error, Result};
use lumiduct_core::measure::CheckOutcome;
use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus, TestSuite};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The beginning of the files that this program writes.
const HEAD: &str = r#"<testsuites name="lumiduct""#;
/// Bytes within which that must occur.
const HEAD_BYTES: u64 = 200;

/// Where JUnit XML goes.
#[derive(Debug)]
pub struct JunitFile(PathBuf);

impl JunitFile {
    /// Checks, before any work is done, that the file can be written. A file written by this
    /// program or an empty one is replaced; any other only where permitted.
    ///
    /// # Errors
    ///
    /// [`Error::Usage`] if no regular file can be there, or another kind of file is there and is to be kept;
    /// [`Error::Io`] if it cannot be read or nothing can be written beside it.
    pub fn open(path: &Path, existing: Existing) -> Result<Self> {
        let failed = |why: &str| Error::Usage(format!("--junit {why}"));
        match expect_file(path) {
            Err(Error::Usage(why)) => return Err(failed(&why)),
            other => other?,
        }
        if path.exists() && existing == Existing::Keep && !is_ours(path)? {
            let file = path.display();
            return Err(failed(&format!(
                "{file}: is not a JUnit file; use --overwrite to replace it, or name another file"
            )));
        }
        Ok(Self(path.to_path_buf()))
    }

    /// Writes it, whole or not at all.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] if the file cannot be written.
    pub fn write(&self, xml: &str) -> Result<()> {
        write_whole(&self.0, xml.as_bytes(), Existing::Replace)
    }
}

/// Whether a file is empty or written by this program.
fn is_ours(path: &Path) -> Result<bool> {
    let failed = |source| Error::io(path, source);
    let mut head = Vec::new();
    let file = File::open(path).map_err(failed)?;
    file.take(HEAD_BYTES).read_to_end(&mut head).map_err(failed)?;
    Ok(head.is_empty() || String::from_utf8_lossy(&head).contains(HEAD))
}

/// The checks of a run. A run with checks that is partial or misses its target is not as requested;
/// each gets a case.
///
/// # Errors
///
/// [`Error::Output`] if the cases cannot be written as XML.
pub fn run_junit(report: &Report) -> Result<String> {
    let name = &report.scene.name;
    let mut suite = TestSuite::new(name.as_str());
    check_cases(name, &report.checks).for_each(|case| _ = suite.add_test_case(case));
    if let Some(target) = report.run.target.as_ref().filter(|_| !report.checks.is_empty()) {
        suite.add_test_case(target_case(name, target));
    }
    if report.run.partial {
        let status = error("partial", &report.run.stopped);
        suite.add_test_case(case(name, "whole run", status));
    }
    written(suite)
}

/// The checks of every design of a study. A design that makes no scene is an error.
///
/// # Errors
///
/// [`Error::Output`] if the cases cannot be written as XML.
pub fn study_junit(report: &StudyReport) -> Result<String> {
    let name = &report.facts.name;
    let mut suite = TestSuite::new(name.as_str());
    for design in &report.designs {
        let class = format!("{name}.design {}", design.design);
        match &design.outcome {
            DesignOutcome::Failed(reason) => {
                suite.add_test_case(case(&class, "scene", error("no scene", reason)));
            }
            DesignOutcome::Done(result) => {
                check_cases(&class, &result.checks).for_each(|case| _ = suite.add_test_case(case));
                if let Some(target) = &result.target {
                    suite.add_test_case(target_case(&class, target));
                }
            }
        }
    }
    written(suite)
}

/// The measures of a comparison. One that cannot be judged counts as skipped.
///
/// # Errors
///
/// [`Error::Output`] if the cases cannot be written as XML.
pub fn diff_junit(diff: &Diff) -> Result<String> {
    let [a, b] = &diff.names;
    let name = if a == b { format!("diff {a}") } else { format!("diff {a} {b}") };
    let mut suite = TestSuite::new(name.as_str());
    for row in &diff.rows {
        suite.add_test_case(case(&name, &row.name, diff_status(diff, row)));
    }
    for map in diff.maps_that_count() {
        let status = match map.is_noise() {
            true => TestCaseStatus::success(),
            false => failure("beyond noise", &map.sentence()),
        };
        suite.add_test_case(case(&name, &format!("map {}", map.name), status));
    }
    written(suite)
}

/// The rms difference of a measured file. Without a limit it counts as skipped.
///
/// # Errors
///
/// [`Error::Output`] if the case cannot be written as XML.
pub fn measured_junit(diff: &MeasuredDiff) -> Result<String> {
    let name = format!("diff {}", diff.scene);
    let status = match diff.limit {
        None => {
            let mut status = TestCaseStatus::skipped();
            status.set_message(verdict(diff));
            status
        }
        Some(_) if diff.is_within() => TestCaseStatus::success(),
        Some(_) => failure("beyond", &verdict(diff)),
    };
    let mut suite = TestSuite::new(name.as_str());
    suite.add_test_case(case(&name, &format!("{} rms difference", diff.name), status));
    written(suite)
}

fn diff_status(diff: &Diff, row: &DiffRow) -> TestCaseStatus {
    match row.judgement {
        Judgement::Within | Judgement::Tolerated => TestCaseStatus::success(),
        Judgement::Beyond => {
            failure("beyond", &format!("{}; the limit is {}", sentence(row), diff.limits.words()))
        }
        Judgement::Unknown => {
            let mut status = TestCaseStatus::skipped();
            let doubt = row.doubt.as_deref().unwrap_or_default();
            status.set_message(format!("cannot be judged: {doubt}"));
            status
        }
    }
}

/// The cases of checks; each is named after its measure.
fn check_cases(class: &str, all: &[CheckResult]) -> impl Iterator<Item = TestCase> {
    let measures: Vec<&str> = all.iter().map(|result| result.check.measure.as_str()).collect();
    let named = numbered(&measures).into_iter().zip(all);
    named.map(move |(name, result)| case(class, &name, check_status(result)))
}

fn check_status(result: &CheckResult) -> TestCaseStatus {
    let reason = &result.verdict.reason;
    match result.verdict.outcome {
        CheckOutcome::Passed => TestCaseStatus::success(),
        CheckOutcome::Undecided => failure("undecided", reason),
        CheckOutcome::Failed => failure("failed", reason),
        CheckOutcome::Unknown => error("unknown measure", reason),
    }
}

fn target_case(class: &str, target: &TargetFacts) -> TestCase {
    let status = if target.is_reached() {
        TestCaseStatus::success()
    } else {
        failure("off target", &target.sentence())
    };
    case(class, "target error", status)
}

fn case(class: &str, name: &str, status: TestCaseStatus) -> TestCase {
    let mut case = TestCase::new(name, status);
    case.set_classname(class);
    case
}

fn failure(kind: &str, reason: &str) -> TestCaseStatus {
    unsuccessful(NonSuccessKind::Failure, kind, reason)
}

fn error(kind: &str, reason: &str) -> TestCaseStatus {
    unsuccessful(NonSuccessKind::Error, kind, reason)
}

fn unsuccessful(of: NonSuccessKind, kind: &str, reason: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(of);
    status.set_type(kind).set_message(reason);
    status
}

fn written(suite: TestSuite) -> Result<String> {
    let mut report = quick_junit::Report::new("lumiduct");
    report.add_test_suite(suite);
    report
        .to_string()
        .map_err(|reason| Error::Output { what: "JUnit XML".into(), reason: reason.to_string() })
}
