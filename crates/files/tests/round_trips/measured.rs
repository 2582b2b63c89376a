//! Measured maps and intensities in the forms of CSV.

use crate::{Verdict, config};
use lumiduct_files::measured::{FirstRow, MeasuredGrid, MeasuredMap, MeasuredValues, parse};
use proptest::collection::{btree_set, vec};
use proptest::prelude::*;
use proptest::sample::select;
use std::fmt::Write as _;

/// Edges of columns and rows, and values row by row; NaN where nothing was measured.
#[derive(Debug)]
struct RandomMap {
    x: Vec<f64>,
    y: Vec<f64>,
    values: Vec<f64>,
}

/// Maps with light; the edges are eighths up to a limit.
fn random_map([x, y]: [u32; 2]) -> impl Strategy<Value = RandomMap> {
    let edges = |most: u32| {
        let places = btree_set(0..=8 * most, 3..8);
        places.prop_map(|all| all.into_iter().map(|n| f64::from(n) / 8.0).collect::<Vec<f64>>())
    };
    let value = prop_oneof![4 => 0.001..1e6f64, 1 => Just(0.0), 1 => Just(f64::NAN)];
    (edges(x), edges(y), vec(value, 49)).prop_map(|(x, y, mut values)| {
        values.truncate((x.len() - 1) * (y.len() - 1));
        values[0] = 5.25;
        RandomMap { x, y, values }
    })
}

impl RandomMap {
    fn columns(&self) -> usize {
        self.x.len() - 1
    }

    /// Row, column and value of each cell.
    fn cells(&self) -> impl Iterator<Item = ([usize; 2], f64)> {
        let columns = self.columns();
        self.values.iter().zip(0..).map(move |(value, at)| ([at / columns, at % columns], *value))
    }

    fn expect(&self, found: &MeasuredGrid) -> Verdict {
        prop_assert_eq!((&found.x, &found.y), (&self.x, &self.y));
        self.expect_values(found)
    }

    fn expect_values(&self, found: &MeasuredGrid) -> Verdict {
        prop_assert_eq!(found.values.dim(), (self.y.len() - 1, self.columns()));
        let is_same = |(own, found): (&f64, &f64)| own == found || own.is_nan() && found.is_nan();
        prop_assert!(self.values.iter().zip(&found.values).all(is_same), "{:?}", found.values);
        Ok(())
    }
}

/// A value as a cell; nothing where nothing was measured.
fn word(value: f64) -> String {
    if value.is_nan() { String::new() } else { value.to_string() }
}

fn read(text: &str, end: &str) -> Result<MeasuredMap, TestCaseError> {
    Ok(parse(text.replace('\n', end).as_bytes())?)
}

/// Middles of cells.
fn middles(edges: &[f64]) -> Vec<f64> {
    edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect()
}

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn points_in_any_order_come_back(
        map in random_map([100, 100]),
        first in 0..49usize,
        (head, is_image) in select(vec![("x_mm,y_mm", false), ("u_mm,v_mm", false), ("u_deg,v_deg", true)]),
        end in select(vec!["\n", "\r\n", "\r"]),
    ) {
        let [x, y] = [middles(&map.x), middles(&map.y)];
        let mut rows: Vec<String> = map
            .cells()
            .map(|([row, column], value)| format!("{},{},{},7\n", x[column], y[row], word(value)))
            .collect();
        let turn = first % rows.len();
        rows.rotate_left(turn);
        let found = read(&format!("# a map\n{head},e_lx,more\n{}", rows.concat()), end)?;
        prop_assert_eq!(found.unit.as_ref().map(|own| &*own.unit), Some("lx"));
        let grid = match (found.values, is_image) {
            (MeasuredValues::Surface(grid), false) | (MeasuredValues::Image(grid), true) => grid,
            (other, _) => return Err(TestCaseError::fail(format!("{other:?}"))),
        };
        map.expect_values(&grid)?;
        for (middles, edges) in [(&x, &grid.x), (&y, &grid.y)] {
            let pairs = middles.windows(2).zip(&edges[1..]);
            for (pair, edge) in pairs {
                prop_assert_eq!(0.5 * (pair[0] + pair[1]), *edge);
            }
        }
    }

    #[test]
    fn matrices_of_reports_come_back(
        map in random_map([100, 180]),
        (kind, unit) in select(vec![("u", "mm"), ("right", "deg"), ("c", "deg")]),
        end in select(vec!["\n", "\r\n", "\r"]),
    ) {
        let list = |edges: &[f64]| edges.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let last = map.columns();
        let mut rows: Vec<String> = map
            .values
            .chunks(last)
            .zip(map.y.windows(2))
            .map(|(values, ends)| {
                let words: Vec<String> = values.iter().map(|value| word(*value)).collect();
                format!("{},{}\n", list(ends), words.join(","))
            })
            .collect();
        // Angles γ grow downwards.
        if kind != "c" {
            rows.reverse();
        }
        let text = format!(
            "\u{feff}e in cd,{kind} from in {unit},{}\n,{kind} to in {unit},{}\nfrom,to{}\n{}",
            list(&map.x[..last]),
            list(&map.x[1..]),
            ",".repeat(last),
            rows.concat()
        );
        let found = read(&text, end)?;
        prop_assert_eq!(found.unit.as_ref().map(|own| &*own.unit), Some("cd"));
        match (found.values, kind) {
            (MeasuredValues::Surface(grid), "u") | (MeasuredValues::Image(grid), "right") => {
                map.expect(&grid)?;
            }
            (MeasuredValues::Sphere(mut grid), "c") => {
                // The rest of the circle was not measured.
                prop_assert_eq!(grid.x.pop(), Some(map.x[0] + 360.0));
                let (rest, columns) = (grid.values.column(last).to_owned(), 0..last);
                prop_assert!(rest.iter().all(|value| value.is_nan()));
                grid.values = grid.values.select(ndarray::Axis(1), &columns.collect::<Vec<_>>());
                map.expect(&grid)?;
            }
            (other, _) => return Err(TestCaseError::fail(format!("{kind}: {other:?}"))),
        }
    }

    #[test]
    fn plain_matrices_come_back(
        map in random_map([100, 100]),
        separator in select(vec![";", "\t", "; ", ","]),
        comma in any::<bool>(),
        (rows, first_row) in select(vec![("top", FirstRow::Top), ("bottom", FirstRow::Bottom)]),
    ) {
        let mut text = format!("# width_mm = {}\n# rows = {rows}\n", map.x[1] + 1.0);
        let mut lines: Vec<&[f64]> = map.values.chunks(map.columns()).collect();
        if first_row == FirstRow::Top {
            lines.reverse();
        }
        for line in lines {
            let words: Vec<String> = line.iter().map(|value| word(*value)).collect();
            _ = writeln!(text, "{}", words.join(separator));
        }
        if comma && separator != "," {
            text = text.replace('.', ",").replace("width_mm = ", "width_mm_ = ");
        }
        let found = read(&text, "\n")?;
        let MeasuredValues::Matrix(matrix) = found.values else {
            return Err(TestCaseError::fail("no matrix"));
        };
        prop_assert_eq!(matrix.first_row.map(|own| own.side), Some(first_row));
        prop_assert_eq!(matrix.width.is_some(), !comma || separator == ",");
        map.expect_values(&matrix.centred([2.0, 3.0], first_row))?;
    }
}
