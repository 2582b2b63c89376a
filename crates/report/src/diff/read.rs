//! Reports read back from their folders.

use crate::diff::maps::MapTable;
use crate::output::SUMMARY;
use crate::{Manifest, study, summary};
use indexmap::IndexMap;
use lumiduct_base::error::{Error, Result};
use lumiduct_core::measure::Measure;
use lumiduct_input::Setting;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// One of the two reports compared.
#[derive(Debug)]
pub struct ComparedReport {
    /// Name of the scene or the study.
    pub name: String,
    /// Its facts in a line: name, hash, seed and paths.
    pub facts: String,
    /// Names of the measures that its checks judge.
    pub checks: Vec<String>,
    /// Its numbers.
    pub content: Content,
}

/// The numbers of a report.
#[derive(Debug)]
pub enum Content {
    /// Numbers of a run.
    Run(RunFiles),
    /// Numbers of the designs of a study.
    Study(Vec<DesignRow>),
}

/// The numbers of a run.
#[derive(Debug)]
pub struct RunFiles {
    /// All measures by their dotted names.
    pub measures: IndexMap<String, Measure>,
    /// Its maps and intensities.
    pub maps: Vec<MapTable>,
}

/// The numbers of a design.
#[derive(Debug, Deserialize)]
pub struct DesignRow {
    /// Its number, from 1.
    pub design: usize,
    /// What its parameters are set to.
    pub settings: IndexMap<String, Setting>,
    /// The recorded measures by their dotted names; none for a design that makes no scene.
    #[serde(default)]
    pub measures: IndexMap<String, Measure>,
}

impl DesignRow {
    /// Prefix of the names of its measures: "design 3 (leg 5, radius 8): ".
    pub(crate) fn prefix(&self) -> String {
        let words = self.settings.iter().map(|(name, setting)| match setting {
            Setting::Number(_) | Setting::Choice(_) => format!("{name} {setting}"),
            Setting::AsInScene => format!("{name} as in the scene"),
        });
        format!("design {} ({}): ", self.design, words.collect::<Vec<_>>().join(", "))
    }
}

/// Format of a file, which is read before the rest.
#[derive(Deserialize)]
struct Format {
    #[serde(alias = "lumiduct_study_summary")]
    lumiduct_summary: u32,
}

#[derive(Deserialize)]
struct RunSummary {
    scene: SceneWords,
    run: RunWords,
    paths: u64,
    measures: IndexMap<String, Measure>,
    checks: Vec<CheckWords>,
    files: Vec<String>,
}

#[derive(Deserialize)]
struct CheckWords {
    check: CheckedMeasure,
}

#[derive(Deserialize)]
struct CheckedMeasure {
    measure: String,
}

#[derive(Deserialize)]
struct SceneWords {
    name: String,
    hash: String,
    overrides: Vec<String>,
}

#[derive(Deserialize)]
struct RunWords {
    seed: u64,
    partial: bool,
}

#[derive(Deserialize)]
struct StudySummary {
    name: String,
    hash: String,
    seed: u64,
    checks: Vec<CheckedMeasure>,
    rows: Vec<DesignRow>,
}

/// Reads the report of a run or the results of a study from their folder.
///
/// # Errors
///
/// [`Error::Usage`] if the folder holds no whole report, the report has the layout of another version, or a file
/// was changed after it was written; [`Error::Io`] if a file cannot be read.
pub fn read(folder: &Path) -> Result<ComparedReport> {
    if !folder.is_dir() {
        return Err(Error::Usage(format!(
            "{} is not a folder; name the folder of a report, such as reports/NAME, and as the \
             second also a measured .ies, .ldt or .csv file",
            folder.display()
        )));
    }
    if let Some((found, manifest)) = summary_in(folder, SUMMARY, summary::FORMAT)? {
        return run_side(folder, found, &manifest);
    }
    match summary_in(folder, study::SUMMARY, study::SUMMARY_FORMAT)? {
        Some((found, _)) => Ok(study_side(found)),
        None => Err(Error::Usage(format!(
            "{} holds no report: neither summary.json of a run nor study.json of a complete study",
            folder.display()
        ))),
    }
}

/// The summary in a folder, if there is one, and the manifest of its report, which must be whole.
fn summary_in<T: DeserializeOwned>(
    folder: &Path,
    name: &str,
    known: u32,
) -> Result<Option<(T, Manifest)>> {
    let path = folder.join(name);
    let bytes = match fs::read(&path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        other => other.map_err(|source| Error::io(&path, source))?,
    };
    let wrong = |reason: serde_json::Error| {
        Error::Usage(format!("{} cannot be read as a report: {reason}", path.display()))
    };
    let Format { lumiduct_summary: format } = serde_json::from_slice(&bytes).map_err(wrong)?;
    if format != known {
        return Err(Error::Usage(format!(
            "{} has format {format}, but this version of the program reads {known}; run it again",
            path.display()
        )));
    }
    let found = serde_json::from_slice(&bytes).map_err(wrong)?;
    let manifest = Manifest::expect(folder)?;
    manifest.expect_file(&path, &bytes)?;
    Ok(Some((found, manifest)))
}

fn run_side(folder: &Path, found: RunSummary, manifest: &Manifest) -> Result<ComparedReport> {
    let RunSummary { scene, run, paths, measures, checks, files } = found;
    let SceneWords { name, hash, overrides } = scene;
    let seed = run.seed;
    let mut facts = format!("{name}, scene {hash}, seed {seed}, {paths} paths");
    if !overrides.is_empty() {
        facts += &format!(", with {}", overrides.join(", "));
    }
    if run.partial {
        facts += ", partial: the run was interrupted";
    }
    let mut maps = Vec::new();
    // A report refers only to files in its own folder; anything elsewhere is not part of it.
    let own = |file: &&String| file.ends_with(".csv") && !file.contains(['/', '\\']);
    for file in files.iter().filter(own) {
        let path = folder.join(file);
        let text = match fs::read_to_string(&path) {
            // The summary may be kept without its tables.
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            Err(error) if error.kind() == ErrorKind::InvalidData => {
                let path = path.display();
                return Err(Error::Usage(format!(
                    "{path}: not UTF-8 text, so not a table of a report"
                )));
            }
            other => other.map_err(|source| Error::io(&path, source))?,
        };
        manifest.expect_file(&path, text.as_bytes())?;
        let name = file.trim_end_matches(".csv");
        let table = MapTable::parse(name, &text)
            .map_err(|reason| Error::Usage(format!("{}: {reason}", path.display())))?;
        // All values of a sensor come from the same batches.
        let sensor = name.split_inclusive('.').next().unwrap_or(name);
        let mut of_sensor = measures.iter().filter(|(measure, _)| measure.starts_with(sensor));
        let batches = of_sensor.next().map(|(_, measure)| measure.batches);
        maps.extend(table.map(|table| table.with_batches(batches)));
    }
    let checks = checks.into_iter().map(|own| own.check.measure).collect();
    Ok(ComparedReport { name, facts, checks, content: Content::Run(RunFiles { measures, maps }) })
}

fn study_side(found: StudySummary) -> ComparedReport {
    let StudySummary { name, hash, seed, checks, rows } = found;
    let facts = format!("{name}, study {hash}, seed {seed}, {} designs", rows.len());
    let checks = checks.into_iter().map(|own| own.measure).collect();
    ComparedReport { name, facts, checks, content: Content::Study(rows) }
}
