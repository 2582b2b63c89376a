mod intensity_files;
mod map_files;

use crate::cell_grid::SURFACE;
use crate::measured::*;
use crate::png::{AxisScale, MapCells};
use lumiduct_files::luminaire::{Intensities, PlaneSymmetry};
use std::fmt::Write;

/// A spot on a slope, in a field of 16 by 12 mm: its mean over a cell of 1 mm by Simpson's rule.
fn field(x: f64, y: f64) -> f64 {
    let at = |x: f64, y: f64| {
        let [u, v] = [x - 1.3, y + 0.8];
        100.0 + 3.0 * x + 400.0 * (-(u * u / 18.0 + v * v / 12.0)).exp()
    };
    let rule = [(-0.5, 1.0 / 6.0), (0.0, 4.0 / 6.0), (0.5, 1.0 / 6.0)];
    let points = rule.iter().flat_map(|one| rule.iter().map(move |other| (one, other)));
    points.map(|((dx, a), (dy, b))| a * b * at(x + dx, y + dy)).sum()
}

fn steps(from: f64, to: f64) -> Vec<f64> {
    (0..=(to - from) as usize).map(|n| from + n as f64).collect()
}

fn grid(half: [f64; 2], value: impl Fn(f64, f64) -> f64) -> MeasuredGrid {
    let [x, y] = half.map(|half| steps(-half, half));
    let values = Array2::from_shape_fn((y.len() - 1, x.len() - 1), |(row, column)| {
        value(x[column] + 0.5, y[row] + 0.5)
    });
    MeasuredGrid { x, y, values }
}

fn computed(half: [f64; 2], value: impl Fn(f64, f64) -> f64, error: f64) -> ComputedCells {
    let MeasuredGrid { x, y, values } = grid(half, value);
    let errors = Array2::from_elem(values.dim(), error);
    let sizes = Array2::ones(values.dim());
    let cells = MapCells { x, y, values, errors, biases: None, colours: None };
    let (name, unit) = ("exit.illuminance".to_owned(), "lx".to_owned());
    ComputedCells { name, kind: &SURFACE, unit, cells, sizes }
}

fn report() -> ComparedReport {
    let content = Content::Study(Vec::new());
    let [name, facts] = ["rod", "rod, seed 1"].map(str::to_owned);
    ComparedReport { name, facts, checks: Vec::new(), content }
}

fn outcome(
    computed: ComputedCells,
    grid: &MeasuredGrid,
    options: &MeasuredOptions,
) -> MeasuredDiff {
    compared(&report(), computed, grid, "m.csv", options, Vec::new()).unwrap()
}

#[test]
fn a_map_equals_itself_without_shift_or_scale() {
    let same = outcome(
        computed([8.0, 6.0], field, 2.0),
        &grid([8.0, 6.0], field),
        &MeasuredOptions::default(),
    );
    assert!(same.shift.value.iter().all(|shift| shift.abs() < 1e-6), "{:?}", same.shift);
    assert!((same.scale.unwrap().value - 1.0).abs() < 1e-9);
    assert!(same.after.rms_of_max < 1e-6 && same.after.correlation > 1.0 - 1e-9);
    assert_eq!(same.before.rms, 0.0);
    assert!(same.remarks.is_empty(), "{:?}", same.remarks);
}

#[test]
fn a_shift_of_a_part_of_a_cell_and_a_scale_are_found() {
    let moved = grid([8.0, 6.0], |x, y| 0.9 * field(x - 0.37, y + 0.21));
    let found = outcome(computed([8.0, 6.0], field, 2.0), &moved, &MeasuredOptions::default());
    let FoundShift { value, std_errors, .. } = found.shift;
    // What is left is the blur of averaging measured cells of the same size.
    assert!((value[0] - 0.37).abs() < 0.01 && (value[1] + 0.21).abs() < 0.01, "{value:?}");
    assert!(std_errors.iter().all(|error| (1e-4..0.1).contains(error)), "{std_errors:?}");
    let scale = found.scale.unwrap();
    assert!((scale.value - 0.9).abs() < 2e-3 && (1e-4..0.01).contains(&scale.std_error));
    assert!(found.before.rms_of_max > 10.0 * found.after.rms_of_max, "{:?}", found.after);
    assert!(found.after.rms_of_max < 3e-3, "{:?}", found.after);
}

#[test]
fn the_errors_of_shift_and_scale_are_those_of_many_noisy_maps() {
    let mut seed = 1u64;
    // Uniform noise of standard deviation 5 by a linear congruential generator (Knuth, MMIX).
    let mut noise = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        5.0 * 12f64.sqrt() * ((seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
    };
    let mut scores = [0.0; 3];
    const RUNS: f64 = 30.0;
    for _ in 0..RUNS as u32 {
        let mut own = computed([8.0, 6.0], field, 5.0);
        own.cells.values.iter_mut().for_each(|value| *value += noise());
        // Noise of the measured map counts by what is left.
        let mut measured = grid([10.0, 8.0], |x, y| field(x - 0.3, y + 0.2));
        measured.values.iter_mut().for_each(|value| *value += noise());
        let found = outcome(own, &measured, &MeasuredOptions::default());
        let (shift, scale) = (found.shift, found.scale.unwrap());
        let z = [
            (shift.value[0] - 0.3) / shift.std_errors[0],
            (shift.value[1] + 0.2) / shift.std_errors[1],
            (scale.value - 1.0) / scale.std_error,
        ];
        scores.iter_mut().zip(z).for_each(|(sum, z)| *sum += z * z / RUNS);
    }
    // The mean square of 30 standard normal numbers is 1 ± 0.26.
    assert!(scores.iter().all(|mean| (0.3..2.0).contains(mean)), "{scores:?}");
}

#[test]
fn a_shift_within_its_error_is_not_applied() {
    let moved = grid([10.0, 8.0], |x, y| field(x - 0.02, y + 0.4));
    let found = outcome(computed([8.0, 6.0], field, 25.0), &moved, &MeasuredOptions::default());
    assert!(!found.shift.is_found(0) && found.shift.is_found(1), "{:?}", found.shift);
    assert_eq!(found.shift.value[0], 0.0);
    let remarks = found.remarks.join("\n");
    assert!(remarks.contains("along u is less than two standard errors from 0"), "{remarks}");
}

#[test]
fn options_switch_alignment_and_scale_off_and_wrong_directions_are_remarked() {
    let flipped = grid([8.0, 6.0], |x, y| 0.9 * field(x, -y));
    let off = MeasuredOptions { no_align: true, no_scale: true, ..Default::default() };
    let found = outcome(computed([8.0, 6.0], field, 2.0), &flipped, &off);
    assert_eq!((found.shift.value, found.scale), ([0.0; 2], None));
    assert_eq!(found.before, found.after);
    let remarks = found.remarks.join("\n");
    assert!(remarks.contains("upside down"), "{remarks}");
    // A shift to the limit of the search is not the reason.
    let shifted = outcome(computed([8.0, 6.0], field, 2.0), &flipped, &Default::default());
    assert!(shifted.remarks[0].contains("upside down"), "{:?}", shifted.remarks);
    let limit = MeasuredOptions { limit: Some(0.01), ..off };
    assert!(!outcome(computed([8.0, 6.0], field, 2.0), &flipped, &limit).is_within());
}

#[test]
fn a_shift_that_nothing_determines_is_left_alone_and_small_maps_are_not_aligned() {
    let slope = |x: f64, _: f64| 10.0 + (0.3 * x).sin();
    let moved = |by: f64| grid([8.0, 6.0], move |x, y| slope(x - by, y));
    let found = outcome(computed([8.0, 6.0], slope, 1e-3), &moved(0.4), &Default::default());
    assert!(found.shift.is_found(0) && !found.shift.is_found(1));
    assert!(found.remarks.join("\n").contains("no shift is determined along v"));
    let found =
        outcome(computed([2.0, 2.0], field, 1.0), &grid([2.0, 2.0], field), &Default::default());
    assert!(found.remarks.join("\n").contains("4 cells are too few"), "{:?}", found.remarks);
    let small = grid([2.0, 2.0], field);
    let said = compared(
        &report(),
        computed([8.0, 6.0], field, 1.0),
        &small,
        "m.csv",
        &Default::default(),
        Vec::new(),
    );
    assert!(said.unwrap_err().to_string().contains("check its size"), "too little is covered");
}

/// A beam that leans to C = 30°, from a table.
fn beam(turned: f64) -> Intensities {
    let planes: Vec<f64> = (0..36).map(|n| 10.0 * f64::from(n)).collect();
    let angles: Vec<f64> = (0..=36).map(|n| 5.0 * f64::from(n)).collect();
    let value = |c: f64, gamma: f64| {
        let lean = (c - 30.0 - turned).to_radians().cos();
        1000.0 * (-(gamma / 40.0).powi(2)).exp() * (1.0 + 0.5 * lean * gamma.to_radians().sin())
    };
    let candela = planes.iter().flat_map(|c| angles.iter().map(move |gamma| value(*c, *gamma)));
    Intensities::new(PlaneSymmetry::None, planes.clone(), angles.clone(), candela.collect())
        .unwrap()
}

/// The cells of a goniometer that sees it, from the table in the form of a report.
fn goniometer() -> ComputedCells {
    let mut text =
        "c_from_deg,c_to_deg,gamma_from_deg,gamma_to_deg,intensity_cd,std_error_cd\n".to_owned();
    for (c, gamma) in (0..36).flat_map(|c| (0..36).map(move |g| (10 * c, 5 * g))) {
        _ = writeln!(text, "{c},{},{gamma},{},0,1", c + 10, gamma + 5);
    }
    let mut own = ComputedCells::of(&MapTable::parse("far.intensity", &text).unwrap().unwrap());
    let sphere = measured_sphere(&beam(0.0), &own);
    own.cells.values = resample::resampled(&sphere, own.edges(), [0.0; 2]);
    own
}

#[test]
fn a_turned_luminaire_is_turned_back_and_its_figures_are_kept() {
    let sphere = measured_sphere(&beam(23.4), &goniometer());
    let found = outcome(goniometer(), &sphere, &MeasuredOptions::default());
    assert!((found.shift.value[0] - 23.4).abs() < 0.05, "{:?}", found.shift);
    assert!(found.shift.std_errors[0] < 2.0 && !found.shift.is_found(1));
    assert!((found.scale.unwrap().value - 1.0).abs() < 1e-3);
    let [before, after] = [&found.before, &found.after].map(|own| own.rms_of_max);
    assert!(after < 2e-3 && before > 5.0 * after, "{before} {after}");
    let [own, measured] = found.sides;
    let flux = beam(0.0).flux();
    for side in [own, measured] {
        assert!((side.flux_lm.unwrap() / flux - 1.0).abs() < 1e-3, "{side:?} {flux}");
    }
    // Without the lean half of the intensity lies at 40° √ln 2 = 33.3° on both sides.
    assert!((own.beams_deg[0].unwrap() - 66.6).abs() < 3.0, "{own:?}");
    // A quarter turn is not searched, but remarked.
    let sphere = measured_sphere(&beam(90.0), &goniometer());
    let found = outcome(goniometer(), &sphere, &MeasuredOptions::default());
    let remarks = found.remarks.join("\n");
    assert!(
        remarks.contains("at the limit of the search") || remarks.contains("a further"),
        "{remarks}"
    );
}

#[test]
fn lamps_of_another_flux_are_remarked() {
    use lumiduct_files::luminaire::LampFlux;
    let lamps = LampFlux::Relative { count: 1, flux_lm: 1000.0 };
    let said = lamp_remark(lamps, Some(80.0)).unwrap();
    assert!(said.contains("1000 lm") && said.contains("80 lm") && said.contains("12.5"), "{said}");
    assert_eq!(lamp_remark(lamps, Some(1000.2)), None);
    assert_eq!(lamp_remark(LampFlux::Absolute, Some(80.0)), None);
}

#[test]
fn the_table_of_a_report_has_the_sizes_of_its_cells() {
    let own = goniometer();
    assert!((own.sizes.sum() - 4.0 * std::f64::consts::PI).abs() < 1e-9);
    assert_eq!(own.edges().map(|edges| [edges[0], edges[36]]), [[0.0, 360.0], [0.0, 180.0]]);
    let text = "u_mm,v_mm,e_lx,std_error_lx\n0,0,1,1\n2,0,1,1\n0,3,1,1\n2,3,1,1\n";
    let table = MapTable::parse("exit.e", text).unwrap().unwrap();
    assert_eq!(table.cells(AxisScale::Linear).x, [-1.0, 1.0, 3.0]);
    assert_eq!(ComputedCells::of(&table).sizes.sum(), 24.0);
}
