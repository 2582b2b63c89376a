//! `summary.json`: the record for programs. `measures` maps dotted names to numbers with their errors.

use crate::Report;
use crate::output::SUMMARY;
use lumiduct_base::error::{Error, Result};
use serde::Serialize;

/// Version of the layout of this file.
pub(crate) const FORMAT: u32 = 1;

#[derive(Serialize)]
struct SummaryRecord<'r> {
    lumiduct_summary: u32,
    scene: &'r crate::SceneFacts,
    run: &'r crate::RunFacts,
    unit: lumiduct_base::units::FluxUnit,
    source_flux: f64,
    #[serde(skip_serializing_if = "indexmap::IndexMap::is_empty")]
    light_groups: &'r indexmap::IndexMap<String, Vec<String>>,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    sum_over_weathers: &'r [String],
    paths: u64,
    batches: u64,
    segments: u64,
    estimators: &'r indexmap::IndexMap<String, lumiduct_core::plan::Estimator>,
    #[serde(skip_serializing_if = "indexmap::IndexMap::is_empty")]
    choices: &'r indexmap::IndexMap<String, lumiduct_core::transport::EstimatorChoice>,
    accounts: &'r [lumiduct_core::transport::Account],
    measures: &'r indexmap::IndexMap<String, lumiduct_core::measure::Measure>,
    checks: &'r [crate::CheckResult],
    paths_to_sensors: &'r [lumiduct_core::measure::SensorPaths],
    warnings: &'r [String],
    files: &'r [&'r str],
}

/// The record as JSON. `files` are all files of the report, including this one.
pub(crate) fn json(report: &Report, files: &[&str]) -> Result<String> {
    let measures = &report.measures;
    let summary = SummaryRecord {
        lumiduct_summary: FORMAT,
        scene: &report.scene,
        run: &report.run,
        unit: measures.unit,
        source_flux: measures.source_flux,
        light_groups: &measures.light_groups,
        // A single weather is not a sum.
        sum_over_weathers: if measures.weathers.len() > 1 { &measures.weathers } else { &[] },
        paths: measures.paths,
        batches: measures.batches,
        segments: measures.segments,
        estimators: &measures.estimators,
        choices: &measures.choices,
        accounts: &measures.accounts,
        measures: &measures.values,
        checks: &report.checks,
        paths_to_sensors: &measures.sensor_paths,
        warnings: &report.warnings,
        files,
    };
    serde_json::to_string_pretty(&summary)
        .map(|text| text + "\n")
        .map_err(|reason| Error::Output { what: SUMMARY.into(), reason: reason.to_string() })
}
