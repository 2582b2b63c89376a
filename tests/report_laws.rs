//! Committed reports belong to their scenes, and every map obeys these laws: the extremes enclose
//! the average, the middle, the points of a uniformity and every cell that counts for itself.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

use lumiduct_input::{Settings, StudySettings, load, load_study};
use lumiduct_report::Recipe;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Errors by which two numbers of one report may violate a law.
const SIGMAS: f64 = 4.0;
/// Probability that the noise of any cell of a map breaks a law.
const CHANCE: f64 = 1e-3;
/// Least share of a cell on the sensor for it to count for itself.
const WHOLE: f64 = 0.5;

/// A value with its total error.
#[derive(Debug, Clone, Copy)]
struct Reading {
    value: f64,
    error: f64,
}

impl Reading {
    /// Asserts that this is no larger than another, within this many errors of both.
    fn assert_below(self, other: Self, sigmas: f64, law: &str) {
        let room = sigmas * self.error.hypot(other.error) + 1e-9 * self.value.abs();
        assert!(self.value <= other.value + room, "{law}: {self:?} above {other:?}");
    }
}

/// A report's folder with the measures of its summary.
struct Report {
    folder: PathBuf,
    measures: Value,
}

impl Report {
    /// A measure that is known.
    fn measure(&self, name: &str) -> Option<Reading> {
        let measure = self.measures.get(name)?;
        let bias = measure["bias"].as_f64().unwrap_or(0.0);
        let (value, error) = (measure["value"].as_f64()?, measure["std_error"].as_f64()?);
        Some(Reading { value, error: error.hypot(bias) })
    }

    /// The maps: sensor, quantity, and the view and light group with their dots.
    fn maps(&self) -> Vec<(String, String, String)> {
        let names = self.measures.as_object().unwrap().keys();
        let map = |name: &String| {
            let (sensor, rest) = name.split_once('.')?;
            let (quantity, view) = rest.split_once("_max")?;
            let is_map = ["illuminance", "irradiance", "luminance", "radiance"].contains(&quantity);
            is_map.then(|| (sensor.to_owned(), quantity.to_owned(), view.to_owned()))
        };
        names.filter_map(map).collect()
    }

    /// The cells that count for themselves.
    fn cells(&self, sensor: &str, quantity: &str, view: &str) -> Vec<Reading> {
        let (view, light) = view.split_once(".from.").map_or((view, None), |(v, l)| (v, Some(l)));
        let view = view.strip_prefix('.').map_or(String::new(), |view| format!(".view{view}"));
        let light = light.map_or(String::new(), |light| format!(".from_{light}"));
        let path = self.folder.join(format!("{sensor}.{quantity}{view}{light}.csv"));
        let mut reader = csv::Reader::from_path(&path).unwrap();
        let header = reader.headers().unwrap().clone();
        let column = |name: &str| header.iter().position(|title| title.starts_with(name));
        let value = column(&format!("{quantity}_")).unwrap();
        let (error, bias) = (column("std_error_").unwrap(), column("bias_"));
        let on_sensor = column("on_sensor").unwrap();
        let cells = reader.records().map(|record| {
            let numbers: Vec<f64> = record.unwrap().iter().map(|it| it.parse().unwrap()).collect();
            let bias = bias.map_or(0.0, |bias| numbers[bias]);
            let read = Reading { value: numbers[value], error: numbers[error].hypot(bias) };
            (read, numbers[on_sensor])
        });
        cells.filter(|(_, share)| *share >= WHOLE).map(|(read, _)| read).collect()
    }
}

/// The reports of scenes in a folder and below it.
fn reports(folder: &Path) -> Vec<Report> {
    let mut found = Vec::new();
    if let Ok(text) = std::fs::read_to_string(folder.join("summary.json")) {
        let mut summary: Value = serde_json::from_str(&text).unwrap();
        let measures = summary["measures"].take();
        found.push(Report { folder: folder.to_owned(), measures });
    }
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(reports(&path));
        }
    }
    found
}

#[test]
fn every_committed_report_is_of_its_scene_and_of_these_numerics() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    if !root.join("reports").exists() {
        // The package has no reports.
        return;
    }
    let read = |path: PathBuf| -> Value {
        serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap()
    };
    let mut found = 0;
    for entry in std::fs::read_dir(root.join("scenes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let job = load(&path, &Settings::default()).unwrap();
            let summary = read(root.join("reports").join(&job.name).join("summary.json"));
            let identity = serde_json::to_value(Recipe::new(&job.hash, &job.run)).unwrap();
            assert_eq!(summary["run"]["identity"], identity, "{}", path.display());
            found += 1;
        }
    }
    for entry in std::fs::read_dir(root.join("scenes/studies")).unwrap() {
        let path = entry.unwrap().path();
        let study = load_study(&path, &StudySettings::default()).unwrap();
        let summary = read(root.join("reports/studies").join(&study.name).join("study.json"));
        assert_eq!(summary["hash"], *study.hash, "{}", path.display());
        found += 1;
    }
    assert!(found > 30, "{found} reports");
}

#[test]
fn extremes_of_committed_reports_enclose_averages_points_and_cells() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports");
    if !folder.exists() {
        // The package has no reports.
        return;
    }
    let mut maps = 0;
    for report in reports(&folder) {
        for (sensor, quantity, view) in report.maps() {
            maps += 1;
            let name = |what: &str| format!("{sensor}.{what}{view}");
            let of = |what: &str| report.measure(&name(&format!("{quantity}_{what}")));
            let what = format!("{}: {}", report.folder.display(), name(&quantity));
            let (Some(least), Some(most)) = (of("min"), of("max")) else { continue };
            for (inner, value) in ["avg", "center"].map(|it| (it, of(it))) {
                let Some(value) = value else { continue };
                least.assert_below(value, SIGMAS, &format!("{what}, min and {inner}"));
                value.assert_below(most, SIGMAS, &format!("{what}, {inner} and max"));
            }
            for ratio in ["min_avg", "min_max"] {
                let all = report.measure(&name(&format!("uniformity_{ratio}")));
                for points in [9, 13] {
                    let set = report.measure(&name(&format!("uniformity{points}_{ratio}")));
                    let (Some(all), Some(set)) = (all, set) else { continue };
                    all.assert_below(set, SIGMAS, &format!("{what}, {ratio} of {points} points"));
                }
            }
            let cells = report.cells(&sensor, &quantity, &view);
            let sigmas = (2.0 * (cells.len() as f64 / CHANCE).ln()).sqrt();
            for cell in cells {
                least.assert_below(cell, sigmas, &format!("{what}, min and a cell"));
                cell.assert_below(most, sigmas, &format!("{what}, a cell and max"));
            }
        }
    }
    assert!(maps > 20, "only {maps} maps");
}
