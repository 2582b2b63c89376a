use crate::bytes::tests::mutants;
use crate::measured::*;

/// The cells of a map; those of a plain matrix have the size that it states.
fn cells(map: MeasuredMap) -> MeasuredGrid {
    match map.values {
        MeasuredValues::Matrix(own) => {
            let size = [own.width, own.height].map(|size| size.unwrap().size_mm);
            let first = own.first_row.map_or(FirstRow::Top, |own| own.side);
            own.centred(size, first)
        }
        MeasuredValues::Surface(grid)
        | MeasuredValues::Image(grid)
        | MeasuredValues::Sphere(grid) => grid,
        MeasuredValues::Directions(_) => panic!("no cells"),
    }
}

#[test]
fn every_form_of_a_map_gives_the_same_cells() {
    let matrix = "# width_mm = 2\n# height_mm = 4\n# unit = lx\n3 4\n1 2,5\n";
    let forms = [
        matrix.to_owned(),
        matrix.replace("3 4\n1 2,5", "# rows = bottom\n1;2,5\n3;4"),
        "x_mm,y_mm,e_lx\n-0.5,-1,1\n0.5,-1,2.5\n-0.5,1,3\n0.5,1,4\n".to_owned(),
        "u_mm,v_mm,e_lx,std_error_lx\n0.5,1,4,9\n-0.5,1,3,9\n0.5,-1,2.5,9\n-0.5,-1,1,9\n".to_owned(),
        "\u{feff}e in lx,u from in mm,-1,0\n,u to in mm,0,1\nv from in mm,v to in mm,,\n0,2,3,4\n-2,0,1,2.5\n"
            .to_owned(),
    ];
    for text in forms {
        let map = parse(text.as_bytes()).unwrap();
        let unit = map.unit.clone().map(|own| own.unit);
        let grid = cells(map);
        assert_eq!((&grid.x[..], &grid.y[..]), (&[-1.0, 0.0, 1.0][..], &[-2.0, 0.0, 2.0][..]));
        assert_eq!(grid.values, ndarray::array![[1.0, 2.5], [3.0, 4.0]], "{text}");
        assert_eq!(unit.as_deref(), Some("lx"));
    }
}

#[test]
fn what_is_no_map_is_refused_with_its_line() {
    for (text, words) in [
        ("", "line 1: the file ends without values"),
        ("# a\n\n# b\n", "line 3: the file ends without values"),
        ("# width_mm = -1\n# height_mm = 1\n1 2\n3 4\n", "line 1: width_mm is not above 0"),
        ("# width_mm = 1\n# height_mm = 1\n1 2\n3\n", "line 4: 1 cells"),
        ("# width_mm = 1\n# height_mm = 1\n1 2\n3 x\n", "line 4: `x` is not"),
        ("# width_mm = 1\n# height_mm = 1\n# rows = up\n1 2\n3 4\n", "line 3: rows must"),
        (
            "# width_mm = 1\n# height_mm = 1\n0 0\n0 0\n",
            "line 3: all values from here on are zero or missing",
        ),
        ("x_mm,y_mm,e_lx\n0,0,0\n1,1,\n0,1,nan\n", "line 2: all values"),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0,1\n,,,\n0,2,0,0\n-2,0,0,0\n",
            "line 4: all values",
        ),
        (
            "# width_mm = 1\n# height_mm = 1\n1 2\n",
            "line 3: the values from here on make 2 columns and 1 row; expected at least 2 by 2",
        ),
        ("# tall\n1\n2\n3\n", "line 2: the values from here on make 1 column and 3 rows"),
        (
            "x_mm,y_mm,e_lx\n0,0,1\n1,0,2\n2,0,3\n",
            "line 2: the values from here on make 3 columns and 1 row",
        ),
        (
            "x_mm,y_mm,e_lx\n\n0,0,1\n0,1,2\n",
            "line 3: the values from here on make 1 column and 2 rows",
        ),
        ("x_mm,y_mm,e_lx\n", "line 1: the values from here on make 0 columns"),
        ("a,b,c\n1,2,3\n", "line 1: not a map"),
        ("sector_deg,radius_mm,e\n0,0,1\n", "rings"),
        (
            "e in lx,sector from in deg,0\n,sector to in deg,360\n,,\n0,1,5\n",
            "line 1: a map of rings",
        ),
        ("c_from_deg,c_to_deg,gamma_from_deg\n0,0,1\n", "line 1: not a map"),
        (
            "x_mm,y_mm,e_lx\n0,0,1\n1,0,-100000\n0,1,3\n1,1,3\n",
            "line 3: the value `-100000` is below 0; set readings below the dark level to 0",
        ),
        ("# width_mm = 1\n# height_mm = 1\n1 2\n3 -4\n", "line 4: the value `-4` is below 0"),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0,1\n,,,\n0,2,3,-1\n-2,0,1,2\n",
            "line 4: the value `-1` is below 0",
        ),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0,1\n,,,\n3,4,3,1\n-2,0,1,2\n",
            "line 4: the row does not begin where its neighbour ends",
        ),
        (
            "x_mm,y_mm,e_lx\n0,0,1\n1,1,2\n2,2,3\n",
            "line 2: the 3 points from here on have 3 different places",
        ),
        ("x_mm,y_mm,e_lx\n0,0,1\n1,1,2\n0,1,3\n1,1,3\n", "line 5: a second value"),
        ("x_mm,y_mm,e_lx\n0,0\n", "line 2: fewer than three"),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0,1\n,,,\n0,2,3\n-2,0,1,2\n",
            "line 4: 3 cells, but the first row has 4",
        ),
        (
            "e in lx,u from in mm\n,u to in mm\n,,\n0,2\n-2,0\n",
            "line 4: the values from here on make 0 columns and 2 rows",
        ),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0\n,,,\n0,2,3,4\n-2,0,1,2\n",
            "line 2: 3 cells, but the row before has 4",
        ),
        (
            "e in lx,u from in mm,1,0\n,u to in mm,0,1\n,,,\n0,2,3,4\n-2,0,1,2\n",
            "line 1: the edge 0 follows 1",
        ),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0,0\n,,,\n0,2,3,4\n-2,0,1,2\n",
            "line 2: the edge 0 follows 0",
        ),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0,1\n,,,\n0,2,3,4\n0,0,1,2\n",
            "line 5: the edge 0 follows 0",
        ),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0,1\n",
            "line 2: a matrix of a report has three header rows",
        ),
        (
            "i in cd,c from in deg,0\n,c to in deg,361\n,,\n0,90,3\n90,180,1\n",
            "line 2: C from 0 to 361 deg is more than a circle",
        ),
        (
            "i in cd,c from in deg,0\n,c to in deg,360\n,,\n0,90,3\n90,181,1\n",
            "line 5: γ is 181 deg",
        ),
        (
            "c_from_deg,c_to_deg,gamma_from_deg,gamma_to_deg,i_cd\n0,360,0,45,9\n0,360,45,190,9\n",
            "line 3: γ is 190 deg",
        ),
        (
            "c_from_deg,c_to_deg,gamma_from_deg,gamma_to_deg,i_cd\n0,200,0,45,9\n0,200,45,90,9\n200,380,0,45,9\n",
            "line 4: C from 0 to 380 deg",
        ),
        (
            "c_from_deg,c_to_deg,gamma_from_deg,gamma_to_deg,i_cd\n0,360,0,45,9\n",
            "line 2: the values from here on make 1 column and 1 row",
        ),
        (
            "c_deg,gamma_deg,i_cd\n0,0,9\n0,90,9\n0,181,9\n",
            "line 4: γ is 181 deg, expected 0 to 180 deg",
        ),
        ("c_deg,gamma_deg,i_cd\n0,-5,9\n0,90,9\n", "line 2: γ is -5 deg"),
        (
            "c_deg,gamma_deg,i_cd\n0,0,9\n",
            "line 2: the values from here on make 1 column and 1 row",
        ),
        (
            "c_deg,gamma_deg,i_cd\n0,0,9\n0,90,9\n40,90,9\n50,90,9\n40,0,9\n50,0,9\n",
            "line 5: planes C from 0 to 50 deg are no circle",
        ),
        (
            "c_deg,gamma_deg,i_cd\n0,0,9\n0,90,9\n380,90,9\n380,0,9\n",
            "line 4: planes C from 0 to 380 deg are more than a circle",
        ),
        (
            "c_deg,gamma_deg,i_cd\n0,0,1e20\n0,90,9\n",
            "line 2: no usable distribution: an intensity of 100000000000000000000 cd",
        ),
    ] {
        let said = parse(text.as_bytes()).err().unwrap().to_string();
        assert!(said.contains(words), "{text:?}: {said}");
    }
}

#[test]
fn directions_are_linear_in_between_and_planes_follow_a_symmetry() {
    let text = "c_deg,gamma_deg,intensity_cd\n0,0,100\n0,45,80\n0,90,40\n90,45,60\n90,90,\n";
    let map = parse(text.as_bytes()).unwrap();
    assert!(map.remarks[0].contains("four equal quadrants"), "{:?}", map.remarks);
    assert_eq!(map.unit, Some(StatedUnit { unit: "cd".to_owned(), line: 1 }));
    let MeasuredValues::Directions(own) = map.values else { panic!("no directions") };
    assert_eq!(own.peak(), 100.0);
    for (c, gamma, expected) in [
        (0.0, 45.0, 80.0),
        (180.0, 67.5, 60.0),
        (45.0, 45.0, 70.0),
        (90.0, 22.5, 80.0),
        (270.0, 45.0, 60.0),
    ] {
        let found = own.at(c, gamma);
        assert!((found - expected).abs() < 1e-9, "{c} {gamma}: {found}");
    }
    assert!(
        own.at(45.0, 80.0).is_nan() && own.at(90.0, 90.0).is_nan() && own.at(0.0, 100.0).is_nan()
    );
    let rotational = parse(b"c_deg,gamma_deg,i_cd\n12,0,5\n12,90,5\n").unwrap();
    assert!(rotational.remarks[0].contains("rotational"), "{:?}", rotational.remarks);
}

#[test]
fn lines_may_end_in_cr_and_another_encoding_is_refused_with_its_line() {
    let text = "# unit = lx\nx_mm,y_mm,e\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n";
    for end in ["\n", "\r\n", "\r"] {
        let text = text.replace('\n', end);
        let map = parse(text.as_bytes()).unwrap();
        let unit = map.unit.clone().map(|own| own.unit);
        assert_eq!(cells(map).values, ndarray::array![[1.0, 2.0], [3.0, 4.0]], "{end:?}");
        assert_eq!(unit.as_deref(), Some("lx"));
        let said = parse(text.replace('4', "x").as_bytes()).err().unwrap().to_string();
        assert!(said.contains("line 6: `x` is not"), "{end:?}: {said}");
        let latin = [text.as_bytes(), b"2,0,\xb5", end.as_bytes()].concat();
        let said = parse(&latin).err().unwrap().to_string();
        assert!(said.contains("line 7: not UTF-8 text; save the file"), "{end:?}: {said}");
    }
}

#[test]
fn rows_of_tabs_are_rows_without_a_value_in_a_matrix_alone() {
    let head = "# width_mm = 1\n# height_mm = 1\n";
    for (text, rows) in
        [("\t\n1\t2\n\t\n3\t4\n\t\t\n  \n", 4), ("1\t2\n\t\t\n3\t4\n", 2), ("1 2\n\t\n3 4\n", 2)]
    {
        let grid = cells(parse(format!("{head}{text}").as_bytes()).unwrap());
        assert_eq!(grid.values.dim(), (rows, 2), "{text:?}");
        assert_eq!(grid.values.iter().filter(|value| value.is_nan()).count(), 2 * (rows - 2));
    }
    let points = "\t\t\nx_mm\ty_mm\te\n0\t0\t1\n\t\t\n1\t0\t2\n0\t1\t3\n1\t1\t4\n\t\t\n";
    assert_eq!(cells(parse(points.as_bytes()).unwrap()).values.dim(), (2, 2));
}

#[test]
fn rows_take_the_memory_of_their_cells() {
    for text in ["1\n2\n", "1;2\n3;4\n", "1 2 3 4 5\n"] {
        for row in TextTable::new(text).unwrap().rows {
            assert_eq!(row.cells.capacity(), row.cells.len(), "{text:?}");
        }
    }
}

#[test]
fn damaged_files_are_read_or_refused() {
    const MUTANTS: u64 = 100_000;
    let matrix =
        "# width_mm = 3\n# height_mm = 2\n# rows = top\n# unit = lx\n1;2;3,5\n4;;6\n7;8;nan\n";
    let points = "x_mm,y_mm,e_lx\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n0,2,5\n1,2,nan\n";
    let directions =
        "c_deg,gamma_deg,i_cd\n0,0,9\n0,45,5\n0,90,1\n90,45,4\n90,90,\n180,45,3\n180,90,1\n";
    let list = "c_from_deg,c_to_deg,gamma_from_deg,gamma_to_deg,i_cd\n0,180,0,45,9\n180,360,0,45,8\n0,180,45,90,2\n";
    let report = "e in lx,u from in mm,-1,0\n,u to in mm,0,1\nv from in mm,v to in mm,,\n0,2,3,4\n-2,0,1,2.5\n";
    for text in [matrix, points, directions, list, report] {
        let mut usable = 0;
        for bytes in mutants(text.as_bytes(), MUTANTS, 21) {
            let Ok(map) = parse(&bytes) else { continue };
            usable += 1;
            assert_usable(map);
        }
        assert!((MUTANTS / 100..MUTANTS).contains(&usable), "{text}: {usable} are usable");
    }
}

/// Edges and values can be used as they are.
fn assert_usable(map: MeasuredMap) {
    let grid = match map.values {
        MeasuredValues::Matrix(own) => {
            assert!([own.width, own.height].iter().flatten().all(|size| size.size_mm > 0.0));
            own.centred([3.0, 2.0], FirstRow::Top)
        }
        MeasuredValues::Surface(grid)
        | MeasuredValues::Image(grid)
        | MeasuredValues::Sphere(grid) => grid,
        MeasuredValues::Directions(own) => {
            assert!(own.peak() > 0.0);
            let all = (0..72).map(|place| own.at(f64::from(place * 5), f64::from(place * 2)));
            return assert!(all.into_iter().all(|value| value.is_nan() || value >= 0.0));
        }
    };
    let (rows, columns) = grid.values.dim();
    assert_eq!([grid.x.len(), grid.y.len()], [columns + 1, rows + 1]);
    let is_rising = |edges: &[f64]| edges.windows(2).all(|pair| pair[0] < pair[1]);
    assert!(is_rising(&grid.x) && is_rising(&grid.y), "{:?} {:?}", grid.x, grid.y);
    assert!(grid.values.iter().all(|value| value.is_nan() || *value >= 0.0 && value.is_finite()));
    assert!(grid.values.iter().any(|value| *value > 0.0));
}
