//! The contents of the report of an optimisation, part by part, for any page format.

use crate::optimise::tables::light_columns;
use crate::optimise::{Ending, JudgedStep, OptimisationReport, Uncertain};
use crate::page::{Block, PagePart, table};
use lumiduct_base::number::{format_percent, format_value, format_with_error};

/// The verdict in words.
pub(super) fn verdict(report: &OptimisationReport) -> String {
    match &report.ending {
        Ending::Reached => format!(
            "The target is reached: smallest over largest ratio of at least {}",
            format_percent(report.goal)
        ),
        Ending::Interrupted => "Stopped before the end: this is the best so far".to_owned(),
        other => format!("The target is not reached: {}", other.words()),
    }
}

/// The result on a terminal.
pub fn terminal(report: &OptimisationReport) -> String {
    let mut text = format!("{}\n{}\n", report.title, verdict(report));
    let columns = light_columns(report);
    let width = columns.iter().map(|own| own.0.len()).max().unwrap_or(0);
    for (name, step) in columns {
        text += &format!(
            "  {name:width$}  min/max {}, deviation {}, efficiency {}, {} paths\n",
            number(step.misfit.min_over_max),
            number(step.misfit.deviation),
            number(step.measured.efficiency),
            step.measured.paths
        );
    }
    let steps = report.steps.len();
    text + &format!("{steps} {}\n", if steps == 1 { "step" } else { "steps" })
}

/// All parts but the pictures: those before them, and those after.
pub(super) fn parts(report: &OptimisationReport) -> [Vec<PagePart>; 2] {
    let before = vec![result(report)];
    let after =
        [limits(report), Some(lengths(report)), Some(steps(report)), Some(settings(report))];
    [before, after.into_iter().flatten().collect()]
}

/// Before and after, as searched and as checked.
fn result(report: &OptimisationReport) -> PagePart {
    let words = if report.checks.is_empty() {
        "The light of the zones before and after. A check with fresh random numbers has not been made."
    } else {
        "The light of the zones before and after: first as the search found it, then as traced again with random numbers that the search \
         has not used, by two estimators. Ratios are those of measured to wanted light; the deviation is their root mean square \
         without the part that noise makes."
    };
    let head = [
        "design",
        "smallest over largest",
        "deviation",
        "efficiency",
        "estimator",
        "seed",
        "paths",
    ];
    let row = |(name, own): (String, &JudgedStep)| {
        let mut row = vec![name];
        row.extend(figures(own));
        row.push(own.measured.estimator.name().to_owned());
        row.push(own.measured.seed.to_string());
        row.push(own.measured.paths.to_string());
        row
    };
    let rows = light_columns(report).into_iter().map(row).collect();
    let files = "`sizes.csv` has every element for the workshop, the scene with the ending `_optimised.toml` is ready to run, and \
                 `zones.csv` has the light of every zone with its errors.";
    let drawing = " `pattern.dxf` and `pattern.svg` draw the unrolled face in millimetres, seen from outside, with its length upward.";
    let is_drawn = report.shape != crate::optimise::ElementShape::Relief;
    let files = if is_drawn { format!("{files}{drawing}") } else { files.to_owned() };
    PagePart::new(
        "Result",
        vec![
            Block::Words { text: words.to_owned() },
            table(&head, rows),
            Block::Words { text: files },
        ],
    )
}

fn figures(own: &JudgedStep) -> [String; 3] {
    [own.misfit.min_over_max, own.misfit.deviation, own.measured.efficiency].map(number)
}

fn number(own: Uncertain) -> String {
    format_with_error(own.value, own.std_error)
}

fn limits(report: &OptimisationReport) -> Option<PagePart> {
    let words = "At these places a limit or a bridge holds the length of the result, within 1 %.";
    let list = Block::List { items: report.active_limits.clone() };
    (!report.active_limits.is_empty()).then(|| {
        PagePart::new("Limits that hold", vec![Block::Words { text: words.to_owned() }, list])
    })
}

fn lengths(report: &OptimisationReport) -> PagePart {
    let of = |step: Option<&JudgedStep>, place: usize| {
        let value = step.and_then(|own| own.measured.values.get(place));
        value.map_or(String::new(), |value| format_value(*value))
    };
    let rows = report.points_mm.iter().enumerate().map(|(place, at)| {
        vec![format_value(*at), of(report.steps.first(), place), of(report.best_step(), place)]
    });
    let head = [
        "along the face, mm".to_owned(),
        format!("{} before, mm", report.length),
        format!("{} after, mm", report.length),
    ];
    PagePart::new("Lengths at the points of the law", vec![table(&head, rows.collect())])
}

fn steps(report: &OptimisationReport) -> PagePart {
    let head =
        ["step", "paths", "smallest over largest", "deviation", "efficiency", "objective", ""];
    let rows = report.steps.iter().enumerate().map(|(place, own)| {
        let mut row = vec![own.measured.step.to_string(), own.measured.paths.to_string()];
        row.extend(figures(own));
        row.push(number(own.misfit.objective));
        row.push(if place == report.best { "the best".into() } else { String::new() });
        row
    });
    let words = "All steps use the same random numbers. The objective is what the search makes small: the deviations and the light that is \
                 lost, each times its weight. The best step is the one whose objective plus its error is least, of those that reach the \
                 target if any does.";
    PagePart::new(
        "Steps",
        vec![Block::Words { text: words.to_owned() }, table(&head, rows.collect())],
    )
}

fn settings(report: &OptimisationReport) -> PagePart {
    let mut items = vec![format!(
        "scene `{}`, sensor `{}`, {} zones",
        report.scene,
        report.sensor,
        report.zones.len()
    )];
    items.extend(report.settings.iter().cloned());
    items.extend(report.overrides.iter().map(|line| format!("set: `{line}`")));
    PagePart::new("Settings", vec![Block::List { items }])
}
