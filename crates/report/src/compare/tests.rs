use super::*;
use crate::compare::errors::rows;
use crate::compare::page::comparison_table;
use comparison::{CheckpointSample, Contestant, MethodOrigin};

fn sample(seconds: f64, value: f64) -> Option<CheckpointSample> {
    Some(CheckpointSample { seconds, segments: (1e6 * seconds) as u64, value, cell_error: None })
}

fn comparison() -> Comparison {
    let fair = Contestant {
        name: "fair".into(),
        label: "fair (path tracing)".into(),
        origin: MethodOrigin::Literature,
        runs: vec![vec![None, sample(1.0, 2.1)], vec![sample(0.5, 3.0), sample(1.2, 1.9)]],
        cut: 0.0,
    };
    let biased = Contestant {
        name: "biased".into(),
        label: "biased".into(),
        origin: MethodOrigin::Own,
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
        sensor: "cell".into(),
        cells: 1,
        measure: "cell.flux".into(),
        unit: "lm".into(),
        truth: Truth { value: 2.0, std_error: 0.01, origin: "by hand".into(), cells: None },
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
        "| fair (path tracing) | 1.1 |",
        // 0.1² × 1.1 s over (0.3² + 0.01²) × 1 s.
        "Best rival for the flux: fair (path tracing), 0.12 times the cost of biased.",
    ] {
        assert!(page.contains(words), "no {words} in {page}");
    }
    assert!(!page.contains("`fair` cut off"));
    assert!(text(0).starts_with("estimator,seconds,segments,value_lm,std_error_lm,noise_lm"));
    assert_eq!(text(0).lines().count(), 4);
    assert_eq!(text(2).lines().nth(1), Some("cell.flux,2,0.01,lm"));
}

/// Two cells: those of one run are wrong by 3 and 4 of 5, those of the other by 0.
fn with_cells() -> Comparison {
    let mut comparison = comparison();
    comparison.cells = 2;
    comparison.truth.cells = TrueCells::new(vec![(1.2, 0.03), (1.6, 0.04)]);
    let errors = [[0.5, 1.0], [0.5, 0.0]];
    for (run, errors) in comparison.contestants[1].runs.iter_mut().zip(errors) {
        for (sample, error) in run.iter_mut().zip(errors) {
            sample.as_mut().unwrap().cell_error = Some(error);
        }
    }
    comparison
}

#[test]
fn the_error_per_cell_of_several_runs_is_the_root_of_its_mean_square() {
    let Comparison { contestants, truth, .. } = with_cells();
    assert_eq!(rows(&contestants[0], &truth)[0].cell_error, None);
    let [first, last] = rows(&contestants[1], &truth)[..] else { panic!("two checkpoints") };
    assert!((first.cell_error.unwrap() - 0.5).abs() < 1e-15);
    assert!((last.cell_error.unwrap() - 0.5f64.sqrt()).abs() < 1e-15);
}

#[test]
fn errors_per_cell_are_shown_with_that_of_the_truth() {
    let files = comparison_files(&with_cells()).unwrap();
    let text = |place: usize| String::from_utf8(files[place].bytes.clone()).unwrap();
    let page = text(3);
    for words in [
        "* 2 cells, which the truth gives with an error of 2.50 %",
        "| total error | cost | error per cell | cost of cells |",
        "| 70.71 % | 1.000 |",
        "| truth | | | 2.000 ± 0.010 | | | 0.50 % | | 2.50 % | |",
    ] {
        assert!(page.contains(words), "no {words} in {page}");
    }
    assert!(!page.contains("are not known"), "{page}");
    // Only one of the two has cells.
    assert!(!page.contains("Best rival for the cells"), "{page}");
    let table = text(0);
    assert!(table.lines().next().unwrap().ends_with(",error_per_cell"), "{table}");
    assert!(table.lines().nth(1).unwrap().ends_with(','), "{table}");
    assert!(table.lines().nth(2).unwrap().ends_with(",0.5"), "{table}");
    let rows: Vec<String> = text(2).lines().skip(2).map(str::to_owned).collect();
    assert_eq!(rows, ["cell.cell_flux.0,1.2,0.03,lm", "cell.cell_flux.1,1.6,0.04,lm"]);
}

#[test]
fn rivals_are_named_as_far_as_the_truth_is_known() {
    let mut comparison = comparison();
    let mut sentence = |std_error| {
        comparison.truth.std_error = std_error;
        comparison_table(&comparison).lines().last().unwrap().to_owned()
    };
    assert!(sentence(0.01).ends_with("fair (path tracing), 0.12 times the cost of biased."));
    // The total error of the rival is 0.1.
    assert!(sentence(0.07).contains("not known well enough to name a rival for the flux"));
    let runs = &mut comparison.contestants[1].runs;
    runs.iter_mut().for_each(|run| run[1] = sample(1.0, 2.01));
    comparison.truth.std_error = 0.05;
    // 0.1² × 1.1 s over 0.05² × 1 s, as 0.01 is below the error of the truth.
    let table = comparison_table(&comparison);
    assert!(table.contains("(path tracing), at least 4.40 times the cost of biased."), "{table}");
}

#[test]
fn a_page_says_why_it_has_no_errors_per_cell() {
    let mut comparison = comparison();
    let table = comparison_table(&comparison);
    assert!(!table.contains("per cell"), "{table}");
    comparison.cells = 64;
    let table = comparison_table(&comparison);
    assert!(table.contains("the truth is a flux without the 64 cells of `cell`"), "{table}");
}
