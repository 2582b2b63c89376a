//! Reruns committed reports and compares them byte by byte.

use crate::{Share, commits, root};
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Files next to a report that depend on the build or on time.
const BESIDE: [&str; 2] = ["timing.csv", "designs"];

/// A scene or a study with the folder of its report, from the root of the repository.
struct VerifiedReport {
    file: PathBuf,
    command: &'static str,
    report: PathBuf,
}

/// Runs scenes and studies and prints what differs; returns whether nothing does. Without a program
/// it builds one.
pub(crate) fn verify(share: Share, program: Option<PathBuf>) -> io::Result<bool> {
    let program = match program {
        Some(program) => program.canonicalize()?,
        None => build()?,
    };
    let mut jobs = jobs("scenes", "run", "reports")?;
    jobs.extend(self::jobs("scenes/studies", "batch", "reports/studies")?);
    jobs.extend(self::jobs("scenes/optimisations", "optimise", "reports/optimisations")?);
    let (step, first) = match share {
        Share::All => (1, 0),
        Share::Tenth => (10, commits()? % 10),
    };
    let mut is_same = true;
    for job in jobs.iter().skip(first).step_by(step) {
        let differences = differences(&program, job)?;
        let verdict = if differences.is_empty() { "the same" } else { "DIFFERS" };
        println!("{}: {verdict} {}", job.report.display(), differences.join(", "));
        is_same &= differences.is_empty();
    }
    Ok(is_same)
}

fn jobs(folder: &str, command: &'static str, reports: &str) -> io::Result<Vec<VerifiedReport>> {
    let mut jobs = Vec::new();
    for entry in fs::read_dir(root().join(folder))? {
        let file = entry?.path();
        if let (Some(name), Some("toml")) =
            (file.file_stem(), file.extension().and_then(|extension| extension.to_str()))
        {
            jobs.push(VerifiedReport { report: Path::new(reports).join(name), file, command });
        }
    }
    jobs.sort_by(|one, other| one.file.cmp(&other.file));
    Ok(jobs)
}

/// Files that differ between the committed report and a new one.
fn differences(program: &Path, job: &VerifiedReport) -> io::Result<Vec<String>> {
    let folder = tempfile::tempdir()?;
    let anew = folder.path().join("report");
    let output = Command::new(program)
        .args([job.command.as_ref(), job.file.as_os_str(), "-o".as_ref(), anew.as_os_str()])
        .current_dir(root())
        .output()?;
    if !anew.is_dir() {
        return Ok(vec![String::from_utf8_lossy(&output.stderr).into_owned()]);
    }
    let committed = root().join(&job.report);
    let names: BTreeSet<PathBuf> = files(&anew)?.into_iter().chain(files(&committed)?).collect();
    let differs = |name: &PathBuf| match (fs::read(anew.join(name)), fs::read(committed.join(name)))
    {
        (Ok(new), Ok(old)) => new != old,
        _ => true,
    };
    let names = names.into_iter().filter(differs);
    Ok(names.map(|name| name.display().to_string()).collect())
}

/// Files of a report by their paths in its folder.
fn files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = PathBuf::from(path.file_name().unwrap_or_default());
        if BESIDE.iter().any(|beside| name.as_os_str() == *beside) {
            continue;
        }
        if path.is_dir() {
            found.extend(files(&path)?.into_iter().map(|below| name.join(below)));
        } else {
            found.push(name);
        }
    }
    Ok(found)
}

/// Builds the program as the README does.
pub(crate) fn build() -> io::Result<PathBuf> {
    let arguments = ["build", "--release", "--locked", "--package", "lumiduct"];
    let status = Command::new(env!("CARGO")).args(arguments).current_dir(root()).status()?;
    if !status.success() {
        return Err(io::Error::other("the program does not build"));
    }
    Ok(root().join("target/release/lumiduct"))
}
