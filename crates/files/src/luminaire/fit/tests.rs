use super::*;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Means over cells of a distribution, each from 32 x 32 points.
fn means(table: &Intensities, rings: usize, sectors: usize) -> Array2<f64> {
    const FINE: usize = 32;
    Array2::from_shape_fn((rings, sectors), |(ring, sector)| {
        let [from, to] = ring_edges(ring, rings);
        let (mut sum, mut weight) = (0.0, 0.0);
        for part in 0..FINE {
            let at = |part: usize| from + (to - from) * part as f64 / FINE as f64;
            let edges = [at(part), at(part + 1)];
            for turn in 0..FINE {
                let plane =
                    360.0 * (sector as f64 + (turn as f64 + 0.5) / FINE as f64) / sectors as f64;
                let ends = edges.map(|angle| table.at(plane, angle.to_degrees()));
                sum += linear_over_ring(edges, ends);
                weight += linear_over_ring(edges, [1.0; 2]);
            }
        }
        sum / weight
    })
}

fn sample(symmetry: PlaneSymmetry, planes: Vec<f64>) -> Intensities {
    let angles: Vec<f64> = (0..=18).map(|place| 10.0 * f64::from(place)).collect();
    let of = |plane: f64, angle: f64| {
        let (bump, turn) = (angle.to_radians().sin(), plane.to_radians());
        200.0 + 50.0 * bump * (turn.cos() + 0.5 * (2.0 * turn).sin())
    };
    let folded = planes.iter().flat_map(|plane| angles.iter().map(|angle| of(*plane, *angle)));
    let candela = folded.collect();
    Intensities::new(symmetry, planes, angles.clone(), candela).unwrap()
}

#[test]
fn a_table_that_is_linear_between_its_nodes_is_found_from_its_cells() {
    let circle: Vec<f64> = (0..12).map(|place| 30.0 * f64::from(place)).collect();
    let quarter: Vec<f64> = circle.iter().copied().filter(|plane| *plane <= 90.0).collect();
    let front: Vec<f64> = circle.iter().copied().filter(|plane| *plane <= 180.0).collect();
    let back: Vec<f64> =
        circle.iter().copied().filter(|plane| (90.0..=270.0).contains(plane)).collect();
    for (symmetry, planes) in [
        (PlaneSymmetry::None, circle),
        (PlaneSymmetry::Quadrants, quarter),
        (PlaneSymmetry::AboutC0, front),
        (PlaneSymmetry::AboutC90, back),
        (PlaneSymmetry::Rotational, vec![0.0]),
    ] {
        let table = sample(symmetry, planes);
        for sectors in [24, 36] {
            let cells = means(&table, 36, sectors);
            let errors = cells.mapv(|value| 0.01 * value);
            let means = CellMeans { candela: cells.view(), std_errors: errors.view() };
            let layout = TableLayout { symmetry, angle_segments: 18, plane_segments: 12 };
            let fit = fit(&means, &layout).unwrap();
            assert_eq!(fit.intensities.planes_deg(), table.planes_deg());
            for plane in 0..table.planes_deg().len() {
                for (own, other) in fit.intensities.plane(plane).iter().zip(table.plane(plane)) {
                    assert!((own / other - 1.0).abs() < 1e-9, "{symmetry:?}: {own} for {other}");
                }
            }
            assert!(fit.added_share.abs() < 1e-12);
            assert!((fit.intensities.flux() / flux_of(&means) - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn errors_are_those_of_the_fit_and_shrink_with_symmetry() {
    // Small noise goes through the fit linearly: the variance is the sum over single cells. Least squares does not know that planes
    // meet at the poles.
    let cells = Array2::from_elem((16, 8), 100.0);
    let errors =
        Array2::from_shape_fn((16, 8), |(ring, sector)| 1e-3 + (ring * 8 + sector) as f64 / 64e3);
    let layout =
        TableLayout { symmetry: PlaneSymmetry::None, angle_segments: 8, plane_segments: 4 };
    let of = |cells: &Array2<f64>, layout: &TableLayout| {
        let means = CellMeans { candela: cells.view(), std_errors: errors.view() };
        fit(&means, layout).unwrap()
    };
    let whole = of(&cells, &layout);
    let mut variance = 0.0;
    for place in 0..128 {
        let mut changed = cells.clone();
        changed[[place / 8, place % 8]] += errors[[place / 8, place % 8]];
        variance += (of(&changed, &layout).intensities.plane(1)[4] - 100.0).powi(2);
    }
    let ratio = whole.std_errors[[1, 4]] / variance.sqrt();
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    let quarters = TableLayout { symmetry: PlaneSymmetry::Quadrants, ..layout };
    assert!(of(&cells, &quarters).std_errors[[1, 4]] < whole.std_errors[[1, 4]]);
}

#[test]
fn a_sharp_edge_keeps_its_flux_and_has_no_negative_light() {
    let cells = Array2::from_shape_fn((36, 1), |(ring, _)| if ring < 5 { 100.0 } else { 0.0 });
    let means = CellMeans { candela: cells.view(), std_errors: cells.view() };
    let layout =
        TableLayout { symmetry: PlaneSymmetry::Rotational, angle_segments: 18, plane_segments: 1 };
    let fit = fit(&means, &layout).unwrap();
    assert!((fit.intensities.flux() / flux_of(&means) - 1.0).abs() < 1e-12);
    let values = fit.intensities.plane(0);
    assert!(values.iter().all(|value| (0.0..150.0).contains(value)), "{values:?}");
    assert!(
        values[..3].iter().all(|value| *value > 80.0)
            && values[4..].iter().all(|value| *value < 1e-3),
        "{values:?}"
    );
}

/// Cells of 1000 cd up to an angle, deg, and of nothing beyond.
fn cut_off(end: f64, rings: usize) -> Array2<f64> {
    Array2::from_shape_fn((rings, 1), |(ring, _)| {
        let [from, to] = ring_edges(ring, rings);
        let lit = linear_over_ring([from, to.min(end.to_radians()).max(from)], [1.0; 2]);
        1000.0 * lit / linear_over_ring([from, to], [1.0; 2])
    })
}

#[test]
fn a_cut_off_neither_rings_nor_loses_light() {
    for (end, rings) in [(60.0, 72), (60.0, 360), (61.0, 72), (62.5, 72), (90.0, 72), (32.0, 144)] {
        let cells = cut_off(end, rings);
        let errors = cells.mapv(|value| 1e-4 * value);
        let means = CellMeans { candela: cells.view(), std_errors: errors.view() };
        let fit = fit(&means, &TableLayout::finest([rings, 1])).unwrap();
        let step = 360.0 / rings as f64;
        for (place, value) in fit.intensities.plane(0).iter().enumerate() {
            let angle = step * place as f64;
            let expected = match angle {
                angle if angle <= end - step => 999.0..1001.0,
                angle if angle >= end + step => 0.0..1e-3,
                _ => 0.0..1001.0,
            };
            assert!(expected.contains(value), "{end}, {rings}: {value} cd at {angle} deg");
        }
        assert!((fit.intensities.flux() / flux_of(&means) - 1.0).abs() < 1e-9, "{end}, {rings}");
        let misfit = fit.misfit.unwrap();
        assert!((misfit.angle_deg - end).abs() < step && misfit.candela > 50.0, "{misfit:?}");
        assert_eq!(means.upward_share(), 0.0);
    }
}

#[test]
fn what_passes_a_rectangle_keeps_within_its_intensity() {
    // 45 deg wide in γ and C, with edges between the nodes and on them.
    let cells = Array2::from_shape_fn((72, 72), |(ring, sector)| {
        if (10..28).contains(&ring) && (5..14).contains(&sector) { 1000.0 } else { 0.0 }
    });
    let errors = cells.mapv(|value| 1e-4 * value);
    let means = CellMeans { candela: cells.view(), std_errors: errors.view() };
    let fit = fit(&means, &TableLayout::finest([72, 72])).unwrap();
    for plane in 0..36 {
        for value in fit.intensities.plane(plane) {
            assert!((0.0..1001.0).contains(value), "{value}");
        }
    }
    assert!((fit.intensities.flux() / flux_of(&means) - 1.0).abs() < 1e-9);
}

#[test]
fn smooth_light_has_no_misfit() {
    // A Lambertian lamp: its table is linear over 5 deg, which is 0.1 % of its peak off.
    let cells = Array2::from_shape_fn((72, 1), |(ring, _)| {
        let [from, to] = ring_edges(ring, 72);
        (0.5 * (from + to)).cos().max(0.0)
    });
    let errors = Array2::zeros((72, 1));
    let means = CellMeans { candela: cells.view(), std_errors: errors.view() };
    assert_eq!(fit(&means, &TableLayout::finest([72, 1])).unwrap().misfit, None);
}

#[test]
fn negative_cells_count_as_dark_and_their_flux_is_told() {
    let cells = Array2::from_shape_fn((4, 1), |(ring, _)| [10.0, 10.0, -1.0, -1.0][ring]);
    let means = CellMeans { candela: cells.view(), std_errors: cells.view() };
    let layout =
        TableLayout { symmetry: PlaneSymmetry::Rotational, angle_segments: 2, plane_segments: 1 };
    let fit = fit(&means, &layout).unwrap();
    // Both hemispheres have the same solid angle.
    assert!((fit.added_share - 1.0 / 9.0).abs() < 1e-12, "{}", fit.added_share);
}

#[test]
fn errors_of_single_batches_are_not_known() {
    let cells = Array2::from_elem((4, 1), 1.0);
    let errors = Array2::from_elem((4, 1), f64::INFINITY);
    let means = CellMeans { candela: cells.view(), std_errors: errors.view() };
    let layout =
        TableLayout { symmetry: PlaneSymmetry::Rotational, angle_segments: 2, plane_segments: 1 };
    let fit = fit(&means, &layout).unwrap();
    assert!(fit.std_errors.iter().all(|error| *error == f64::INFINITY));
}

#[test]
fn a_table_needs_two_cells_a_step_and_planes_of_its_symmetry() {
    let cells = Array2::from_elem((36, 24), 1.0);
    let means = CellMeans { candela: cells.view(), std_errors: cells.view() };
    let of = |symmetry, angle_segments, plane_segments| {
        fit(&means, &TableLayout { symmetry, angle_segments, plane_segments })
    };
    assert!(of(PlaneSymmetry::None, 18, 12).is_ok());
    assert!(of(PlaneSymmetry::Rotational, 18, 0).is_ok());
    let many = Array2::from_elem((2000, 1), 1.0);
    let means = CellMeans { candela: many.view(), std_errors: many.view() };
    let layout = TableLayout {
        symmetry: PlaneSymmetry::Rotational,
        angle_segments: 1000,
        plane_segments: 1,
    };
    assert!(fit(&means, &layout).unwrap_err().to_string().contains("at most 720"));
    for (symmetry, angles, planes) in [
        (PlaneSymmetry::None, 36, 12),
        (PlaneSymmetry::None, 17, 12),
        (PlaneSymmetry::None, 18, 24),
        (PlaneSymmetry::None, 0, 12),
        (PlaneSymmetry::Quadrants, 18, 6),
    ] {
        let error = of(symmetry, angles, planes).unwrap_err().to_string();
        assert!(error.starts_with("no usable distribution"), "{error}");
    }
}

#[test]
fn cells_that_are_no_numbers_are_refused() {
    let cells = Array2::from_shape_fn((4, 1), |(ring, _)| [1.0, f64::NAN, 1.0, 1.0][ring]);
    let means = CellMeans { candela: cells.view(), std_errors: cells.view() };
    let error = fit(&means, &TableLayout::finest([4, 1])).unwrap_err();
    assert!(error.to_string().contains("NaN cd"), "{error}");
}

#[test]
fn the_finest_layout_divides_any_number_of_cells() {
    let of = |rings, sectors| {
        let layout = TableLayout::finest([rings, sectors]);
        layout.expect_cells([rings, sectors]).unwrap();
        (layout.symmetry, layout.angle_segments, layout.plane_segments)
    };
    assert_eq!(of(36, 24), (PlaneSymmetry::None, 18, 12));
    assert_eq!(of(15, 9), (PlaneSymmetry::None, 5, 3));
    assert_eq!(of(7, 1).0, PlaneSymmetry::Rotational);
    assert!(TableLayout::finest([1, 1]).expect_cells([1, 1]).is_err());
}

#[test]
fn values_scatter_by_their_errors_with_noise_of_independent_cells() {
    let table = sample(PlaneSymmetry::Quadrants, vec![0.0, 30.0, 60.0, 90.0]);
    let exact = means(&table, 36, 24);
    let errors = exact.mapv(|value| 0.02 * value);
    let layout =
        TableLayout { symmetry: PlaneSymmetry::Quadrants, angle_segments: 18, plane_segments: 12 };
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
    // The sum of twelve uniform numbers has a variance of 1.
    let mut normal =
        || (0..12).map(|_| f64::from(random.next_u32()) / 2f64.powi(32)).sum::<f64>() - 6.0;
    const RUNS: usize = 40;
    let (mut inner, mut poles) = (0.0, 0.0);
    for _ in 0..RUNS {
        let cells =
            Array2::from_shape_fn(exact.dim(), |cell| exact[cell] + errors[cell] * normal());
        let fit =
            fit(&CellMeans { candela: cells.view(), std_errors: errors.view() }, &layout).unwrap();
        for ((plane, angle), error) in fit.std_errors.indexed_iter() {
            let z = (fit.intensities.plane(plane)[angle] - table.plane(plane)[angle]) / error;
            if angle == 0 || angle == 18 { poles += z * z } else { inner += z * z }
        }
    }
    // 17 angles in four planes; values are correlated, so that some 1000 of them count.
    let mean = inner / (RUNS * 17 * 4) as f64;
    assert!((0.85..1.15).contains(&mean), "{mean}");
    // Two poles in 40 runs, the same in every plane.
    let mean = poles / (RUNS * 2 * 4) as f64;
    assert!((0.5..1.5).contains(&mean), "{mean}");
}
