use super::*;

fn circles(diameter: f64) -> ElementOutline {
    ElementOutline::Circle { diameter: TableAlong::constant(diameter) }
}

fn grid(shift: f64, period: Option<f64>) -> ElementField {
    ElementField {
        rows: RowPositions::Even { first: 5.0, pitch: 4.0, count: 10 },
        columns: Columns { first: 3.0, pitch: 6.0, count: 5, shift },
        outline: circles(2.0),
        period,
    }
}

/// The share of a rectangle that elements cover, by a fine grid of points.
fn covered(field: &ElementField, rect: ChartRect) -> f64 {
    let n = 700;
    let size = rect.max - rect.min;
    let inside = (0..n * n)
        .filter(|i| {
            let at = DVec2::new(f64::from(i % n) + 0.5, f64::from(i / n) + 0.5) / f64::from(n);
            field.contains(rect.min + at * size)
        })
        .count();
    inside as f64 / f64::from(n * n) * size.element_product()
}

#[test]
fn points_in_elements_cover_the_area_of_all_elements() {
    let rect = ChartRect { min: DVec2::new(-10.0, 0.0), max: DVec2::new(50.0, 60.0) };
    let graded = Graded::new(&TableAlong::table(vec![[5.0, 6.0], [55.0, 2.5]]).unwrap(), 5.0, 55.0);
    let fields = [
        grid(0.0, None),
        grid(3.0, None),
        ElementField { rows: RowPositions::Graded(graded), ..grid(3.0, None) },
        ElementField {
            outline: ElementOutline::Circle {
                diameter: TableAlong::table(vec![[5.0, 0.5], [41.0, 3.0]]).unwrap(),
            },
            ..grid(0.0, None)
        },
        ElementField {
            outline: ElementOutline::Rectangle { width: 4.0, length: 1.5 },
            rows: RowPositions::Listed(vec![3.0, 9.0, 30.0]),
            columns: Columns { first: 20.0, pitch: 1.0, count: 1, shift: 0.0 },
            period: None,
        },
    ];
    for field in fields {
        let (found, area) = (covered(&field, rect), field.area());
        // Elements are about ten points wide.
        assert!((found / area - 1.0).abs() < 0.02, "{field:?}: {found}, {area}");
        assert_eq!((field.first_overlap(), field.first_outside(rect)), (None, None));
    }
}

#[test]
fn a_field_on_a_part_of_a_closed_face_stays_there() {
    let partial = ElementField { period: Some(40.0), ..grid(3.0, None) };
    let rect = ChartRect { min: DVec2::new(0.0, 0.0), max: DVec2::new(40.0, 50.0) };
    let (found, area) = (covered(&partial, rect), partial.area());
    assert!((found / area - 1.0).abs() < 0.02, "{found}, {area}");
}

#[test]
fn light_does_not_go_from_one_hole_into_another_inside_the_wall() {
    let mut pattern = hole(1.0);
    pattern.field.columns = Columns { first: 0.0, pitch: 4.0, count: 3, shift: 0.0 };
    let part = |u: f64, slope: f64| pattern.part(0, DVec2::new(u, 0.0), || DVec2::new(slope, 0.0));
    // Half way between two holes both ends lie in holes.
    assert_eq!(part(2.0, 4.0), None);
    assert_eq!(part(0.0, 8.0), Some(ActingPart::Bore(0)));
    assert_eq!(part(4.0, 0.5), Some(ActingPart::Element(0)));
}

#[test]
fn a_field_around_a_closed_face_goes_on_over_its_seam() {
    let field = ElementField {
        columns: Columns { first: 0.0, ..grid(0.0, None).columns },
        ..grid(0.0, Some(30.0))
    };
    for u in [0.0, 0.9, 29.1, 30.0, -0.9, 6.0, 24.0] {
        assert!(field.contains(DVec2::new(u, 5.0)), "{u}");
    }
    for u in [1.1, 28.9, 3.0, 27.0] {
        assert!(!field.contains(DVec2::new(u, 5.0)), "{u}");
    }
}

#[test]
fn elements_that_overlap_or_leave_the_face_are_told_with_their_row() {
    let wide = ElementField { outline: circles(6.5), ..grid(0.0, None) };
    assert_eq!(wide.first_overlap(), Some(0));
    // Staggered by 3 at a row distance of 4, they touch at 5.
    assert_eq!(ElementField { outline: circles(4.9), ..grid(3.0, None) }.first_overlap(), None);
    assert_eq!(ElementField { outline: circles(5.1), ..grid(3.0, None) }.first_overlap(), Some(0));
    let growing = TableAlong::table(vec![[5.0, 1.0], [41.0, 5.0]]).unwrap();
    let growing =
        ElementField { outline: ElementOutline::Circle { diameter: growing }, ..grid(0.0, None) };
    assert_eq!(growing.first_overlap(), Some(7));
    let rect = ChartRect { min: DVec2::new(0.0, 0.0), max: DVec2::new(40.0, 41.5) };
    let (row, beyond) = grid(0.0, None).first_outside(rect).unwrap();
    assert!(row == 9 && (beyond - 0.5).abs() < 1e-12);
}

#[test]
fn ten_million_elements_take_no_more_room_than_ten() {
    let many = ElementField {
        rows: RowPositions::Even { first: 0.5, pitch: 0.01, count: 5000 },
        columns: Columns { first: 0.0, pitch: 0.01, count: 2000, shift: 0.0 },
        outline: circles(0.005),
        period: None,
    };
    assert_eq!(many.count(), 10_000_000);
    assert!(many.contains(DVec2::new(19.99, 50.49)) && !many.contains(DVec2::new(19.985, 50.485)));
}

#[test]
fn a_hole_through_a_wall_passes_what_does_not_meet_its_side() {
    let pattern = hole(1.0);
    let part = |u: f64, slope: f64| pattern.part(0, DVec2::new(u, 0.0), || DVec2::new(slope, 0.0));
    assert_eq!(part(0.0, 0.0), Some(ActingPart::Element(0)));
    assert_eq!(part(0.8, 1.0), Some(ActingPart::Bore(0)));
    // The same path from the other side, and light that meets the face next to the hole.
    assert_eq!(part(0.8, -1.0), Some(ActingPart::Bore(0)));
    assert_eq!((part(1.1, 1.0), part(1.1, -1.0)), (None, None));
    assert_eq!(part(0.2, 1.5), Some(ActingPart::Element(0)));
    assert_eq!(part(0.2, -1.5), Some(ActingPart::Element(0)));
    // The share that passes a bore at a slope: two circles shifted by the slope.
    let (n, slope) = (2000, 0.7f64);
    let passed = (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .filter(|(i, j)| {
            let at =
                DVec2::new(f64::from(*i) + 0.5, f64::from(*j) + 0.5) / f64::from(n) * 4.0 - 2.0;
            pattern.part(0, at, || DVec2::new(slope, 0.0)) == Some(ActingPart::Element(0))
        })
        .count();
    let half = 0.5 * slope;
    let lens = 2.0 * half.acos() - slope * (1.0 - half * half).sqrt();
    let found = passed as f64 * 16.0 / f64::from(n * n);
    assert!((found - lens).abs() < 2e-3, "{found}, {lens}");
}

/// One hole of 2 mm through a wall.
fn hole(thickness: f64) -> Pattern {
    Pattern {
        name: "holes".into(),
        face: FaceId::new(0),
        field: ElementField {
            rows: RowPositions::Listed(vec![0.0]),
            columns: Columns { first: 0.0, pitch: 1.0, count: 1, shift: 0.0 },
            outline: circles(2.0),
            period: None,
        },
        front: FinishId::new(0),
        back: FinishId::new(0),
        wall: Some(HoleWall { thickness, bore: FinishId::new(1) }),
    }
}
