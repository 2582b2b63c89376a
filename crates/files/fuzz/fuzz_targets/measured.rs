//! Whatever a file of measured values contains, it is refused, or its values can be used.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lumiduct_files::measured::{FirstRow, MeasuredValues, parse};

fuzz_target!(|bytes: &[u8]| {
    let Ok(map) = parse(bytes) else { return };
    let grid = match map.values {
        MeasuredValues::Matrix(own) => own.centred([1.0; 2], FirstRow::Top),
        MeasuredValues::Surface(grid)
        | MeasuredValues::Image(grid)
        | MeasuredValues::Sphere(grid) => grid,
        MeasuredValues::Directions(own) => {
            assert!(own.peak() > 0.0);
            let value = own.at(45.0, 45.0);
            return assert!(value.is_nan() || value >= 0.0);
        }
    };
    let (rows, columns) = grid.values.dim();
    assert_eq!([grid.x.len(), grid.y.len()], [columns + 1, rows + 1]);
    let is_rising = |edges: &[f64]| edges.windows(2).all(|pair| pair[0] < pair[1]);
    assert!(is_rising(&grid.x) && is_rising(&grid.y));
    assert!(grid.values.iter().all(|value| value.is_nan() || *value >= 0.0 && value.is_finite()));
});
