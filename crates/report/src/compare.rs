//! The comparison of estimators: one record, and pure functions that turn it into a page, a table and a plot.
//!
//! Errors here are actual deviations: how far runs of one length are from an independent truth. The
//! errors that runs report play no part. Times depend on the machine, so these files are outside
//! the reproducible set.

use crate::OutputFile;
use crate::csv::table;
use crate::png::{
    AxisScale, ErrorForm, LinePlot, Look, PlotSeries, SeriesForm, SeriesPoint, line_plot,
};
use lumiduct_base::error::Result;
use lumiduct_base::number::{format_percent, format_value, format_with_error};
use lumiduct_base::text::markdown_page;
use lumiduct_core::tally::Tally;
use std::fmt::Write;

/// A comparison of estimators on one sensor.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Title of the scene.
    pub title: String,
    /// Name and hash of the scene file, and its command-line overrides.
    pub scene: String,
    /// The program, its seed and its threads.
    pub program: String,
    /// Dotted name of the measure that is compared.
    pub measure: String,
    /// Its unit.
    pub unit: String,
    /// Its true value.
    pub truth: Truth,
    /// Independent runs of each estimator.
    pub repetitions: u32,
    /// Time limit of a run, s.
    pub run_time: f64,
    /// The estimators in the order of the request.
    pub contestants: Vec<Contestant>,
}

/// The true value of a measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// In the unit of the measure; not 0.
    pub value: f64,
    /// Standard error, in the same unit.
    pub std_error: f64,
    /// Where it comes from.
    pub origin: String,
}

/// The results of an estimator.
#[derive(Debug, Clone)]
pub struct Contestant {
    /// Its name.
    pub name: String,
    /// For each run its sample at each checkpoint, `None` where it had no value yet.
    pub runs: Vec<Vec<Option<CheckpointSample>>>,
    /// Share of the throughput of its gather paths that it cut off, 1.
    pub cut: f64,
}

/// The state of a run at a checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckpointSample {
    /// Time spent, s.
    pub seconds: f64,
    /// Segments traced: the work, independent of any clock.
    pub segments: u64,
    /// The value, in the unit of the measure.
    pub value: f64,
}

/// The errors of an estimator at a checkpoint, over its runs. In the unit of the measure, except
/// time and work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorRow {
    /// Mean time of a run, s.
    pub seconds: f64,
    /// Mean number of segments.
    pub segments: f64,
    /// Mean of the runs.
    pub value: f64,
    /// Standard error of that mean.
    pub std_error: f64,
    /// Standard deviation of a run: noise.
    pub noise: f64,
    /// Mean less truth.
    pub bias: f64,
    /// Standard error of the bias, including that of the truth.
    pub bias_std_error: f64,
    /// Root mean square deviation of a run from the truth: noise and bias together.
    pub total_error: f64,
}

impl ErrorRow {
    /// Whether the bias is more than noise: beyond two of its standard errors.
    pub(crate) fn is_biased(&self) -> bool {
        self.bias.abs() > 2.0 * self.bias_std_error
    }
}

/// The errors of an estimator at all checkpoints that every run has reached.
pub fn rows(contestant: &Contestant, truth: &Truth) -> Vec<ErrorRow> {
    let checkpoints = contestant.runs.iter().map(Vec::len).min().unwrap_or(0);
    let at = |place: usize| -> Option<Vec<CheckpointSample>> {
        contestant.runs.iter().map(|run| run[place]).collect()
    };
    (0..checkpoints).filter_map(at).map(|samples| row(&samples, truth)).collect()
}

fn row(samples: &[CheckpointSample], truth: &Truth) -> ErrorRow {
    let mean = |of: fn(&CheckpointSample) -> f64| Tally::of(samples.iter().map(of)).mean();
    let values = Tally::of(samples.iter().map(|sample| sample.value));
    let squares = samples.iter().map(|sample| (sample.value - truth.value).powi(2));
    ErrorRow {
        seconds: mean(|sample| sample.seconds),
        segments: mean(|sample| sample.segments as f64),
        value: values.mean(),
        std_error: values.std_error(),
        noise: values.std_error() * (samples.len() as f64).sqrt(),
        bias: values.mean() - truth.value,
        bias_std_error: values.std_error().hypot(truth.std_error),
        total_error: Tally::of(squares).mean().sqrt(),
    }
}

/// All files of a comparison: `compare.csv`, `compare.png`, `compare.md`, and `truth.csv` for
/// reuse.
///
/// # Errors
///
/// `Error::Output` if the picture cannot be drawn or a table cannot be written as CSV.
pub fn comparison_files(comparison: &Comparison) -> Result<Vec<OutputFile>> {
    Ok(vec![
        csv(comparison)?,
        OutputFile { name: "compare.png".into(), bytes: picture(comparison)? },
        truth_table(comparison)?,
        OutputFile::text("compare.md", page(comparison)),
    ])
}

fn csv(comparison: &Comparison) -> Result<OutputFile> {
    let unit = &comparison.unit;
    let of_unit = ["value", "std_error", "noise", "bias", "bias_std_error", "total_error"]
        .map(|name| format!("{name}_{unit}"));
    let [value, std_error, noise, bias, bias_error, total] = of_unit.each_ref().map(String::as_str);
    let header =
        ["estimator", "seconds", "segments", value, std_error, noise, bias, bias_error, total];
    let lines = comparison.contestants.iter().flat_map(|contestant| {
        rows(contestant, &comparison.truth).into_iter().map(|row| {
            vec![
                contestant.name.clone(),
                format!("{:.4}", row.seconds),
                format!("{:.0}", row.segments),
                row.value.to_string(),
                row.std_error.to_string(),
                row.noise.to_string(),
                row.bias.to_string(),
                row.bias_std_error.to_string(),
                row.total_error.to_string(),
            ]
        })
    });
    table("compare.csv".into(), &header, lines)
}

fn truth_table(comparison: &Comparison) -> Result<OutputFile> {
    let Truth { value, std_error, .. } = &comparison.truth;
    let (measure, unit) = (comparison.measure.clone(), comparison.unit.clone());
    let row = vec![measure, value.to_string(), std_error.to_string(), unit];
    table("truth.csv".into(), &["measure", "value", "std_error", "unit"], std::iter::once(row))
}

fn page(comparison: &Comparison) -> String {
    let Comparison { title, measure, unit, truth, .. } = comparison;
    let mut page = format!("# Comparison of estimators: {title}\n\n");
    page += "Times depend on the machine and its load: this page is not one of the reproducible reports.\n\n";
    _ = writeln!(page, "* `{measure}` of {}", comparison.scene);
    let exact = format_with_error(truth.value, truth.std_error);
    _ = writeln!(page, "* truth: {exact} {unit}, {}", truth.origin);
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
        of a run from the truth. The last column is total error² × time, relative to the lowest.\n";
    for contestant in comparison.contestants.iter().filter(|contestant| contestant.cut > 0.0) {
        _ = writeln!(
            page,
            "\n`{}` cut off {} of the throughput of its gather paths; the light on these paths is missing.",
            contestant.name,
            format_percent(contestant.cut)
        );
    }
    page += "\n![Total error against time](compare.png)\n";
    markdown_page(&page)
}

/// The errors of all estimators at the end of their runs, as a table in Markdown.
pub fn comparison_table(comparison: &Comparison) -> String {
    let Comparison { unit, truth, contestants, .. } = comparison;
    let mut text = format!(
        "| estimator | time, s | segments | value, {unit} | noise | bias | total error | cost |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|\n"
    );
    let last = |contestant: &Contestant| rows(contestant, truth).pop();
    let cost = |row: &ErrorRow| row.total_error.powi(2) * row.seconds;
    let costs = contestants.iter().filter_map(last).map(|row| cost(&row));
    let least = costs.fold(f64::INFINITY, f64::min);
    for contestant in contestants {
        let Some(row) = last(contestant) else { continue };
        let percent = |error: f64| format_percent(error / truth.value.abs());
        _ = writeln!(
            text,
            "| {} | {} | {:.2e} | {} | {} | {} ± {} | {} | {} |",
            contestant.name,
            format_value(row.seconds),
            row.segments,
            format_with_error(row.value, row.std_error),
            percent(row.noise),
            percent(row.bias),
            percent(row.bias_std_error),
            percent(row.total_error),
            if least > 0.0 { format!("{:.3}", cost(&row) / least) } else { "n/a".into() },
        );
    }
    text
}

/// Total error against time, one colour for each estimator; its bias dashed where it is more than noise.
fn picture(comparison: &Comparison) -> Result<Vec<u8>> {
    let Comparison { truth, contestants, .. } = comparison;
    let mut series = Vec::new();
    let (mut earliest, mut latest) = (f64::INFINITY, 0.0f64);
    for (number, contestant) in contestants.iter().enumerate() {
        let rows = rows(contestant, truth);
        for row in &rows {
            (earliest, latest) = (earliest.min(row.seconds), latest.max(row.seconds));
        }
        let curve = |name: &str, form, look, error: fn(&ErrorRow) -> f64| PlotSeries {
            name: name.to_owned(),
            points: rows
                .iter()
                .map(|row| point(row.seconds, error(row) / truth.value.abs()))
                .collect(),
            form,
            errors: ErrorForm::Hidden,
            look,
        };
        let bias = |row: &ErrorRow| if row.is_biased() { row.bias.abs() } else { f64::NAN };
        let (solid, dashed) = (Look::Solid(number), Look::Dashed(number));
        series.push(curve(&contestant.name, SeriesForm::Line, solid, |row| row.total_error));
        series.push(curve("", SeriesForm::Dots, solid, |row| row.total_error));
        series.push(curve("", SeriesForm::Line, dashed, bias));
    }
    if truth.std_error > 0.0 && earliest < latest {
        let error = truth.std_error / truth.value.abs();
        series.push(PlotSeries {
            name: "error of the truth".into(),
            points: [earliest, latest].map(|seconds| point(seconds, error)).into(),
            form: SeriesForm::Line,
            errors: ErrorForm::Hidden,
            look: Look::Bound,
        });
    }
    line_plot(&LinePlot {
        title: format!("{}: {}", comparison.title, comparison.measure),
        subtitle: format!(
            "total error of a run, from {} runs of each estimator; dashed: its bias, where beyond two standard errors",
            comparison.repetitions
        ),
        x_label: "time of a run in s".into(),
        y_label: "error over the truth".into(),
        scale: AxisScale::Log,
        series,
    })
}

fn point(x: f64, y: f64) -> SeriesPoint {
    SeriesPoint { x, y, std_error: 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(seconds: f64, value: f64) -> Option<CheckpointSample> {
        Some(CheckpointSample { seconds, segments: (1e6 * seconds) as u64, value })
    }

    fn comparison() -> Comparison {
        let fair = Contestant {
            name: "fair".into(),
            runs: vec![vec![None, sample(1.0, 2.1)], vec![sample(0.5, 3.0), sample(1.2, 1.9)]],
            cut: 0.0,
        };
        let biased = Contestant {
            name: "biased".into(),
            runs: vec![
                vec![sample(0.1, 1.5), sample(1.0, 1.69)],
                vec![sample(0.1, 1.6), sample(1.0, 1.71)],
            ],
            cut: 0.004,
        };
        Comparison {
            title: "Tube <b>".into(),
            scene: "tube.toml (e9a5)".into(),
            program: "seed 1".into(),
            measure: "cell.flux".into(),
            unit: "lm".into(),
            truth: Truth { value: 2.0, std_error: 0.01, origin: "by hand".into() },
            repetitions: 2,
            run_time: 1.0,
            contestants: vec![fair, biased],
        }
    }

    #[test]
    fn noise_and_bias_are_told_apart_and_make_the_total_error() {
        let Comparison { contestants, truth, .. } = comparison();
        let [fair] = rows(&contestants[0], &truth)[..] else { panic!("one checkpoint is common") };
        assert!((fair.seconds - 1.1).abs() < 1e-12 && (fair.segments - 1.1e6).abs() < 1.0);
        assert!((fair.noise - 0.02f64.sqrt()).abs() < 1e-12 && fair.bias.abs() < 1e-12);
        assert!((fair.total_error - 0.1).abs() < 1e-12 && !fair.is_biased());
        let biased = rows(&contestants[1], &truth)[1];
        assert!((biased.bias + 0.3).abs() < 1e-12 && biased.is_biased());
        assert!((biased.bias_std_error - 0.01 * 2f64.sqrt()).abs() < 1e-12);
        assert!((biased.total_error - (0.09f64 + 0.0001).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn the_page_tells_what_it_is_and_what_was_cut_off() {
        let files = comparison_files(&comparison()).unwrap();
        let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["compare.csv", "compare.png", "truth.csv", "compare.md"]);
        let text = |place: usize| String::from_utf8(files[place].bytes.clone()).unwrap();
        let page = text(3);
        for words in [
            "# Comparison of estimators: Tube &lt;b>",
            "not one of the reproducible reports",
            "2.000 ± 0.010 lm, by hand",
            "| biased | 1 | 1.00e6 | 1.700 ± 0.010 |",
            "| 15.01 % |",
            "`biased` cut off 0.40 %",
        ] {
            assert!(page.contains(words), "no {words} in {page}");
        }
        assert!(!page.contains("`fair` cut off"));
        assert!(text(0).starts_with("estimator,seconds,segments,value_lm,std_error_lm,noise_lm"));
        assert_eq!(text(0).lines().count(), 4);
        assert_eq!(text(2).lines().nth(1), Some("cell.flux,2,0.01,lm"));
    }
}
