//! The page of a comparison, and its table.

use crate::compare::cells::TrueCells;
use crate::compare::comparison::{Comparison, Contestant, MethodOrigin};
use crate::compare::errors::{ErrorRow, last_rows};
use lumiduct_base::number::{format_percent, format_value, format_with_error};
use lumiduct_base::text::markdown_page;
use std::fmt::Write;

/// Errors from this many errors of the truth on are compared.
const RESOLVED: f64 = 1.5;

/// The page.
pub(crate) fn page(comparison: &Comparison) -> String {
    let Comparison { title, measure, unit, truth, .. } = comparison;
    let mut page = format!("# Comparison of estimators: {title}\n\n");
    page += "Times depend on the machine and its load: this page is not one of the reproducible reports.\n\n";
    _ = writeln!(page, "* `{measure}` of {}", comparison.scene);
    let exact = format_with_error(truth.value, truth.std_error);
    _ = writeln!(page, "* truth: {exact} {unit}, {}", truth.origin);
    if let Some(cells) = &truth.cells {
        let error = format_percent(cells.own_error());
        _ = writeln!(
            page,
            "* {} cells, which the truth gives with an error of {error}",
            comparison.cells
        );
    }
    _ = writeln!(
        page,
        "* {} independent runs of {} s for each estimator; {}\n",
        comparison.repetitions,
        format_value(comparison.run_time),
        comparison.program
    );
    page += &comparison_table(comparison);
    page += "\nErrors are relative to the truth. Noise is the standard deviation of a run, bias is the mean \
        of the runs minus the truth with its standard error, total error is the root mean square deviation \
        of a run from the truth. Cost is total error² × time, relative to the lowest. The best rival is the well-known method of the lowest cost.\n";
    if truth.cells.is_some() {
        page += "\nThe error per cell is the root of the sum over cells of squared deviations from the truth, \
            over the root of the sum of the squares of the truth; cost of cells is its square × time, relative \
            to the lowest. No error is found to be much less than that of the truth, in the last row.\n";
    }
    for contestant in comparison.contestants.iter().filter(|contestant| contestant.cut > 0.0) {
        _ = writeln!(
            page,
            "\n`{}` cut off {} of the throughput of its gather paths; the light on these paths is missing.",
            contestant.name,
            format_percent(contestant.cut)
        );
    }
    page += "\n![Errors against time](compare.png)\n";
    markdown_page(&page)
}

/// The errors of all estimators at the end of their runs and that of the truth, as a table in Markdown; below it the best
/// rivals, and why there are no errors per cell.
pub fn comparison_table(comparison: &Comparison) -> String {
    let Comparison { unit, truth, .. } = comparison;
    let mut text = format!(
        "| estimator | time, s | segments | value, {unit} | noise | bias | total error | cost |{}\n\
         |---|--:|--:|--:|--:|--:|--:|--:|{}\n",
        if truth.cells.is_some() { " error per cell | cost of cells |" } else { "" },
        if truth.cells.is_some() { "--:|--:|" } else { "" },
    );
    let lasts = last_rows(comparison);
    let least = |cost: fn(&ErrorRow) -> Option<f64>| {
        lasts.iter().filter_map(|(_, row)| cost(row)).fold(f64::INFINITY, f64::min)
    };
    let [least_cost, least_cost_of_cells] = [least(ErrorRow::cost), least(ErrorRow::cost_of_cells)];
    for (contestant, row) in &lasts {
        let percent = |error: f64| format_percent(error / truth.value.abs());
        _ = write!(
            text,
            "| {} | {} | {:.2e} | {} | {} | {} ± {} | {} | {} |",
            contestant.label,
            format_value(row.seconds),
            row.segments,
            format_with_error(row.value, row.std_error),
            percent(row.noise),
            percent(row.bias),
            percent(row.bias_std_error),
            percent(row.total_error),
            relative_cost(row.cost(), least_cost),
        );
        if truth.cells.is_some() {
            let error = row.cell_error.map_or_else(unknown, format_percent);
            let cost = relative_cost(row.cost_of_cells(), least_cost_of_cells);
            _ = write!(text, " {error} | {cost} |");
        }
        text.push('\n');
    }
    let exact = format_with_error(truth.value, truth.std_error);
    let own_error = format_percent(truth.std_error / truth.value.abs());
    _ = write!(text, "| truth | | | {exact} | | | {own_error} | |");
    if let Some(cells) = &truth.cells {
        _ = write!(text, " {} | |", format_percent(cells.own_error()));
    }
    text.push('\n');
    let total_error: ErrorOf = |row| Some(row.total_error);
    let own_error_of_cells = truth.cells.as_ref().map_or(0.0, TrueCells::own_error);
    let limited = [
        ("flux", total_error, truth.std_error),
        ("cells", |row| row.cell_error, own_error_of_cells),
    ];
    let rivals = limited
        .into_iter()
        .filter_map(|(what, error, floor)| best_rival(&lasts, what, (error, floor)));
    let rivals = rivals.collect::<Vec<String>>().join(" ");
    if !rivals.is_empty() {
        _ = writeln!(text, "\n{rivals}");
    }
    if truth.cells.is_none() && comparison.cells > 1 {
        _ = writeln!(
            text,
            "\nErrors per cell are not known: the truth is a flux without the {} cells of `{}`. A run for the \
             truth gives them, and so does the truth.csv of such a comparison.",
            comparison.cells, comparison.sensor
        );
    }
    text
}

/// An error of an estimator; `None` where it is not known.
type ErrorOf = fn(&ErrorRow) -> Option<f64>;

/// A sentence on the cheapest method of the literature, beside the cheapest of this program; `floor` is the error of
/// the truth.
fn best_rival(
    lasts: &[(&Contestant, ErrorRow)],
    what: &str,
    (error, floor): (ErrorOf, f64),
) -> Option<String> {
    let best = |origin: MethodOrigin| {
        let able = lasts.iter().filter(|(contestant, _)| contestant.origin == origin);
        able.filter_map(|(contestant, row)| Some((&contestant.label, error(row)?, row.seconds)))
            .min_by(|a, b| (a.1.powi(2) * a.2).total_cmp(&(b.1.powi(2) * b.2)))
    };
    let (rival, own) = (best(MethodOrigin::Literature)?, best(MethodOrigin::Own)?);
    if rival.1 < RESOLVED * floor {
        return Some(format!("The truth is not known well enough to name a rival for the {what}."));
    }
    let bound = if own.1 < RESOLVED * floor { "at least " } else { "" };
    let times = (rival.1 / own.1.max(floor)).powi(2) * rival.2 / own.2;
    times.is_finite().then(|| {
        format!(
            "Best rival for the {what}: {}, {bound}{times:.2} times the cost of {}.",
            rival.0, own.0
        )
    })
}

/// A cost over the least.
fn relative_cost(cost: Option<f64>, least: f64) -> String {
    cost.filter(|_| least > 0.0).map_or_else(unknown, |cost| format!("{:.3}", cost / least))
}

fn unknown() -> String {
    "n/a".into()
}
