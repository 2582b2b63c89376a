//! `summary.json`: the record for programs. `measures` maps dotted names to numbers with their errors.

use crate::Report;
use crate::output::{OutputFile, SUMMARY};
use lumiduct_base::error::Result;
use serde_json::{Value, json};

/// Version of the layout of this file.
pub(crate) const FORMAT: u32 = 1;

/// The record as JSON. `files` are all files of the report, including this one.
pub(crate) fn file(report: &Report, files: &[&str]) -> Result<OutputFile> {
    let measures = &report.measures;
    // A single weather is not a sum.
    let weathers = if measures.weathers.len() > 1 { &measures.weathers[..] } else { &[] };
    let mut summary = json!({
        "lumiduct_summary": FORMAT,
        "scene": report.scene,
        "run": report.run,
        "unit": measures.unit,
        "source_flux": measures.source_flux,
        "light_groups": measures.light_groups,
        "sum_over_weathers": weathers,
        "paths": measures.paths,
        "batches": measures.batches,
        "segments": measures.segments,
        "estimators": measures.estimators,
        "choices": measures.choices,
        "accounts": measures.accounts,
        "measures": measures.values,
        "checks": report.checks,
        "paths_to_sensors": measures.sensor_paths,
        "warnings": report.warnings,
        "files": files,
    });
    if let Value::Object(entries) = &mut summary {
        let optional = ["light_groups", "sum_over_weathers", "choices"];
        entries.retain(|name, value| {
            let is_empty = *value == json!([]) || *value == json!({});
            !(is_empty && optional.contains(&name.as_str()))
        });
    }
    OutputFile::json(SUMMARY, &summary)
}
