use super::*;
use crate::diff::maps::MapTable;
use crate::diff::read::RunFiles;
use lumiduct_core::measure::Status;
use lumiduct_core::plan::Estimator;
use lumiduct_input::Setting;

const LIMITS: Limits = Limits { sigmas: 4.0, relative: None, maps: MapLimit::Told };

fn measure(value: f64, std_error: f64) -> Measure {
    Measure {
        value,
        std_error,
        bias: None,
        unit: "lm".to_owned(),
        batches: 128,
        paths: 1_000_000,
        estimator: Estimator::Forward,
        status: Status::Ok,
    }
}

fn with_status(value: f64, std_error: f64, status: Status) -> Measure {
    Measure { status, ..measure(value, std_error) }
}

fn judged(a: Measure, b: Measure, limits: Limits) -> DiffRow {
    let scale = a.value.abs().max(b.value.abs());
    let (name, measure) = ("exit.flux".to_owned(), "exit.flux".to_owned());
    measures::judge(Pair { name, measure, values: [a, b], scale }, limits)
}

fn run(measures: &[(&str, Measure)], maps: Vec<MapTable>) -> ComparedReport {
    let measures = measures.iter().map(|(name, own)| ((*name).to_owned(), own.clone())).collect();
    let content = Content::Run(RunFiles { measures, maps });
    ComparedReport {
        name: "rod".to_owned(),
        facts: "rod, seed 1".to_owned(),
        checks: Vec::new(),
        content,
    }
}

fn study(designs: &[(usize, f64, f64)]) -> ComparedReport {
    let design = |&(design, length, value): &(usize, f64, f64)| DesignRow {
        design,
        settings: [("length".to_owned(), Setting::Number(length))].into_iter().collect(),
        measures: [("exit.flux".to_owned(), measure(value, 0.1))].into_iter().collect(),
    };
    let content = Content::Study(designs.iter().map(design).collect());
    ComparedReport {
        name: "lengths".to_owned(),
        facts: "lengths, seed 1".to_owned(),
        checks: Vec::new(),
        content,
    }
}

fn options(only: &[&str]) -> DiffOptions {
    DiffOptions { limits: LIMITS, only: only.iter().map(|&name| name.to_owned()).collect() }
}

#[test]
fn the_error_of_a_difference_has_noise_and_bias_of_both() {
    let a = Measure { bias: Some(0.4), ..measure(10.0, 0.3) };
    let row = judged(a, measure(16.5, 1.2), LIMITS);
    assert_eq!(row.difference, 6.5);
    assert!((row.error - 1.3).abs() < 1e-12 && (row.sigmas - 5.0).abs() < 1e-9);
    assert_eq!(row.judgement, Judgement::Beyond);
    assert!((row.relative().unwrap() - 0.65).abs() < 1e-12);
    let row = judged(measure(10.0, 0.3), measure(8.5, 0.4), LIMITS);
    assert!((row.sigmas + 3.0).abs() < 1e-9 && row.judgement == Judgement::Within);
}

#[test]
fn a_relative_limit_tolerates_what_is_significant_and_small() {
    let limits = |share| Limits { relative: Some(share), ..LIMITS };
    let judgement = |share| judged(measure(10.0, 0.01), measure(10.2, 0.01), limits(share));
    assert_eq!(judgement(0.03).judgement, Judgement::Tolerated);
    assert_eq!(judgement(0.01).judgement, Judgement::Beyond);
    // A difference that is large but not significant is within.
    let noisy = judged(measure(10.0, 2.0), measure(13.0, 2.0), limits(0.01));
    assert_eq!(noisy.judgement, Judgement::Within);
    assert_eq!(limits(0.01).words(), "4 sigmas and 1 %");
}

#[test]
fn exact_values_differ_by_more_than_rounding_or_not_at_all() {
    let row = judged(measure(1.0, 0.0), measure(1.0 + 1e-12, 0.0), LIMITS);
    assert!(row.judgement == Judgement::Within && !row.is_noisy);
    let row = judged(measure(0.0, 0.0), measure(0.0, 0.0), LIMITS);
    assert_eq!((row.sigmas, row.judgement), (0.0, Judgement::Within));
    for (a, b) in [(0.0, 1e-6), (1.0, 1.001)] {
        let row = judged(measure(a, 0.0), measure(b, 0.0), LIMITS);
        assert_eq!(row.judgement, Judgement::Beyond, "{a} {b}");
    }
}

#[test]
fn the_residual_of_the_balance_is_rounding_of_what_was_emitted() {
    let side = |residual| {
        run(
            &[
                ("balance.residual", measure(residual, 1e-16)),
                ("balance.emitted", measure(3.0, 0.0)),
            ],
            Vec::new(),
        )
    };
    let rounding = diff(&[side(1e-13), side(-2e-13)], &options(&[])).unwrap();
    assert!(rounding.is_within());
    let leak = diff(&[side(1e-13), side(1e-6)], &options(&[])).unwrap();
    assert_eq!(leak.rows[0].name, "balance.residual");
    assert!(!leak.is_within());
}

#[test]
fn what_cannot_be_relied_on_is_never_beyond() {
    for doubtful in [
        with_status(1.0, 0.01, Status::TooFew),
        with_status(1.0, 0.01, Status::NoiseLimited),
        with_status(1.0, 0.01, Status::BiasNotResolved),
        with_status(1.0, 0.01, Status::Contradicted),
        measure(1.0, f64::INFINITY),
        measure(f64::INFINITY, 0.01),
        Measure { unit: "W".to_owned(), ..measure(1.0, 0.01) },
    ] {
        let row = judged(measure(10.0, 0.01), doubtful.clone(), LIMITS);
        assert_eq!(row.judgement, Judgement::Unknown, "{doubtful:?}");
        assert!(row.doubt.is_some());
    }
    assert!(
        diff(
            &[
                run(&[("exit.flux", with_status(1.0, 0.1, Status::TooFew))], Vec::new()),
                run(&[("exit.flux", measure(2.0, 0.1))], Vec::new())
            ],
            &options(&[])
        )
        .unwrap_err()
        .to_string()
        .contains("trace more paths")
    );
}

#[test]
fn light_that_is_gone_is_a_difference_beyond_what_three_paths_may_hide() {
    let dark = with_status(0.0, 1e-4, Status::NoSignal);
    let row = judged(measure(1.0, 0.01), dark.clone(), LIMITS);
    assert_eq!(row.judgement, Judgement::Beyond);
    let row = judged(measure(1e-3, 1e-4), dark, LIMITS);
    assert_eq!(row.judgement, Judgement::Within);
}

#[test]
fn the_worst_comes_first_and_what_is_unknown_last() {
    let a = run(
        &[
            ("a", with_status(1.0, 0.1, Status::TooFew)),
            ("b", measure(1.0, 0.1)),
            ("c", measure(1.0, 0.1)),
            ("d", measure(1.0, 0.1)),
            ("gone", measure(1.0, 0.1)),
        ],
        Vec::new(),
    );
    let b = run(
        &[
            ("a", measure(9.0, 0.1)),
            ("b", measure(1.1, 0.1)),
            ("c", measure(-9.0, 0.1)),
            ("d", measure(3.0, 0.1)),
            ("new", measure(1.0, 0.1)),
        ],
        Vec::new(),
    );
    let found = diff(&[a, b], &options(&[])).unwrap();
    let names: Vec<&str> = found.rows.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names, ["c", "d", "b", "a"]);
    assert_eq!(found.only_in, [["gone"], ["new"]].map(|names| names.map(str::to_owned).to_vec()));
    assert_eq!(found.count(Judgement::Beyond), 2);
    let text = diff_table(&found, ShownRows::All);
    for words in [
        "4 measures compared, 3 of them with noise: 2 beyond 3 sigmas, 0.01 expected by chance",
        "1 measure cannot be judged: a (has too few counts in A)",
        "only A has 1 measure: gone",
        "only B has 1 measure: new",
        "2 measures are beyond the limit of 4 sigmas",
    ] {
        assert!(text.contains(words), "no {words} in {text}");
    }
}

#[test]
fn designs_are_paired_by_their_settings() {
    let [a, b] = [study(&[(1, 5.0, 1.0), (2, 8.0, 2.0)]), study(&[(1, 8.0, 2.0), (2, 9.0, 7.0)])];
    let found = diff(&[a, b], &options(&["exit."])).unwrap();
    let names: Vec<&str> = found.rows.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names, ["design 2 (length 8): exit.flux"]);
    assert!(found.is_within());
    assert_eq!(found.only_in[0], ["design 1 (length 5): exit.flux"]);
    assert_eq!(found.only_in[1], ["design 2 (length 9): exit.flux"]);
    let mixed = [study(&[(1, 5.0, 1.0)]), run(&[("exit.flux", measure(1.0, 0.1))], Vec::new())];
    assert!(diff(&mixed, &options(&[])).unwrap_err().to_string().contains("two reports of runs"));
}

fn map(values: [f64; 4], error: f64) -> MapTable {
    let [a, b, c, d] = values;
    let text = format!(
        "u_mm,v_mm,illuminance_lx,std_error_lx\n-1,-1,{a},{error}\n1,-1,{b},{error}\n-1,1,{c},{error}\n1,1,{d},{error}\n"
    );
    MapTable::parse("exit.illuminance", &text).unwrap().unwrap()
}

#[test]
fn maps_are_compared_cell_by_cell() {
    let a = map([10.0, 20.0, 3.0, 40.0], 0.3);
    let b = map([10.5, 20.0, 9.0, 38.0], 0.4);
    let maps = maps::compare(&[a], &[b]);
    let MapOutcome::Compared { judged, rms, largest, bound, .. } = &maps[0].outcome else {
        panic!("the cells are the same")
    };
    // The third cell of the first map has too few counts.
    assert_eq!(*judged, 3);
    assert!((rms - (17.0f64 / 3.0).sqrt()).abs() < 1e-9 && (largest - 4.0).abs() < 1e-9);
    assert!((bound - (2.0 * 3000.0f64.ln()).sqrt()).abs() < 1e-12);
    // Noise exceeds 4.0 (of 3 cells) more often than once in a thousand maps.
    assert!(maps[0].is_noise());
    assert!(!maps::compare(&[map([10.0; 4], 0.3)], &[map([12.5; 4], 0.4)])[0].is_noise());
    // With seven degrees of freedom noise goes further than 5.0.
    let few = || [10.0, 12.4].map(|value| map([value; 4], 0.34).with_batches(Some(8)));
    let [a, b] = few();
    assert!(maps::compare(&[a], &[b])[0].is_noise());
    let [a, b] = few().map(|map| map.with_batches(Some(1000)));
    assert!(!maps::compare(&[a], &[b])[0].is_noise());
    let files = maps::pictures(&maps).unwrap();
    assert_eq!(files[0].name, "exit.illuminance.difference.png");
    assert!(files[0].bytes.starts_with(b"\x89PNG"));
}

#[test]
fn the_share_of_a_cell_on_the_sensor_is_no_error() {
    let z = |columns: &str, numbers: &str| {
        let [a, b] = ["100,3", "105,4"].map(|cell| {
            let text = format!("u_mm,v_mm,e_lx,std_error_lx{columns}\n0,0,{cell}{numbers}\n");
            MapTable::parse("exit.illuminance", &text).unwrap().unwrap()
        });
        match maps::compare(&[a], &[b])[0].outcome {
            MapOutcome::Compared { largest, .. } => largest,
            MapOutcome::OtherCells => panic!("the cells are the same"),
        }
    };
    assert_eq!(z("", ""), 1.0);
    assert_eq!(z(",on_sensor", ",1"), 1.0);
    let biased = 5.0 / (9.0f64 + 16.0 + 2.0 * 16.0).sqrt();
    assert!((z(",bias_lx,on_sensor", ",4,1") - biased).abs() < 1e-12);
}

#[test]
fn maps_of_other_cells_are_told_and_other_tables_are_no_maps() {
    let text = "u_mm,v_mm,illuminance_lx,std_error_lx\n-1,-1,1,0.1\n";
    let other = MapTable::parse("exit.illuminance", text).unwrap().unwrap();
    let maps = maps::compare(&[map([1.0; 4], 0.1)], &[other]);
    assert!(matches!(maps[0].outcome, MapOutcome::OtherCells) && !maps[0].is_noise());
    assert!(maps::pictures(&maps).unwrap().is_empty());
    let bounces = "bounces_from,bounces_to,flux_lm,std_error_lm\n0,0,1,2\n";
    assert!(MapTable::parse("exit.bounces", bounces).unwrap().is_none());
    for wrong in [
        "u_mm,v_mm\n1,2\n",
        "u_mm,v_mm,e_lx,std_error_lx\n1,2,x,4\n",
        "u_mm,v_mm,e_lx,std_error_lx\n1\n",
    ] {
        assert!(MapTable::parse("exit.illuminance", wrong).is_err(), "{wrong}");
    }
}
