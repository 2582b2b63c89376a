//! Tables of an optimisation: sizes for the workshop, light of the zones, and the history. Units in the header.

use crate::OutputFile;
use crate::csv::table;
use crate::optimise::{ElementShape, JudgedStep, OptimisationReport, Purpose};
use lumiduct_base::error::Result;

/// All tables.
pub(super) fn files(report: &OptimisationReport) -> Result<Vec<OutputFile>> {
    Ok(vec![sizes(report)?, zones(report)?, history(report)?])
}

/// Every element of the result.
fn sizes(report: &OptimisationReport) -> Result<OutputFile> {
    let rows = report.elements.iter().enumerate().map(|(place, own)| {
        let number = (place + 1).to_string();
        let middle = [own.across_mm, own.along_mm].map(|length| length.to_string());
        let sizes = match report.shape {
            ElementShape::Circle => vec![own.length_mm],
            ElementShape::Rectangle => vec![own.width_mm, own.length_mm],
            ElementShape::Relief => vec![own.width_mm, own.length_mm, own.height_mm],
        };
        let sizes = sizes.into_iter().map(|length| length.to_string());
        std::iter::once(number).chain(middle).chain(sizes).collect()
    });
    let head: &[&str] = match report.shape {
        ElementShape::Circle => &["element", "across_mm", "along_mm", "diameter_mm"],
        ElementShape::Rectangle => &["element", "across_mm", "along_mm", "width_mm", "length_mm"],
        ElementShape::Relief => {
            &["element", "across_mm", "along_mm", "width_mm", "length_mm", "height_mm"]
        }
    };
    table("sizes.csv".into(), head, rows)
}

/// Light of the zones of the start and of the result, as searched and as checked.
fn zones(report: &OptimisationReport) -> Result<OutputFile> {
    let columns = light_columns(report);
    let mut head = vec!["along_mm".to_owned(), "wanted".to_owned()];
    for (name, _) in &columns {
        let name = name.replace(' ', "_");
        head.extend([
            format!("{name}_{}", report.unit),
            format!("{name}.std_error_{}", report.unit),
        ]);
    }
    let rows = report.zones.iter().enumerate().map(|(place, zone)| {
        let mut row = vec![zone.along_mm.to_string(), zone.wanted.to_string()];
        for (_, step) in &columns {
            let light = step.measured.zones.get(place);
            row.extend(
                [light.map(|own| own.value), light.map(|own| own.std_error)]
                    .map(|number| number.map_or(String::new(), |number| number.to_string())),
            );
        }
        row
    });
    let names: Vec<&str> = head.iter().map(String::as_str).collect();
    table("zones.csv".into(), &names, rows)
}

/// Designs whose light is shown, with their names.
pub(super) fn light_columns(report: &OptimisationReport) -> Vec<(String, &JudgedStep)> {
    let searched = [("before", report.steps.first()), ("after", report.best_step())];
    let searched = searched.into_iter().filter_map(|(name, own)| Some((name.to_owned(), own?)));
    let checked = |word: &'static str, purpose: Purpose| {
        report
            .checks_of(purpose)
            .map(move |own| (format!("{word} check {}", own.measured.estimator.name()), own))
    };
    searched
        .chain(checked("before", Purpose::CheckBefore))
        .chain(checked("after", Purpose::CheckAfter))
        .collect()
}

/// Every step, with its lengths.
fn history(report: &OptimisationReport) -> Result<OutputFile> {
    let mut head: Vec<String> = [
        "step",
        "paths",
        "min_over_max",
        "min_over_max.std_error",
        "deviation",
        "deviation.std_error",
        "efficiency",
        "efficiency.std_error",
        "objective",
        "objective.std_error",
    ]
    .map(str::to_owned)
    .to_vec();
    let points = report.points_mm.iter();
    head.extend(points.map(|point| format!("{}_at_{point:.4}_mm", report.length)));
    let rows = report.steps.iter().map(|own| {
        let misfit = &own.misfit;
        let pairs =
            [misfit.min_over_max, misfit.deviation, own.measured.efficiency, misfit.objective];
        let numbers = pairs.iter().flat_map(|own| [own.value, own.std_error]);
        let first = [own.measured.step.to_string(), own.measured.paths.to_string()];
        let lengths = own.measured.values.iter().map(f64::to_string);
        first.into_iter().chain(numbers.map(|number| number.to_string())).chain(lengths).collect()
    });
    let names: Vec<&str> = head.iter().map(String::as_str).collect();
    table("history.csv".into(), &names, rows)
}
