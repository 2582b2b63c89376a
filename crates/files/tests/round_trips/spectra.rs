//! Tables by wavelength in CSV.

use crate::config;
use lumiduct_files::spectral::{SpectralColumn, SpectralValues, parse};
use proptest::array::uniform4;
use proptest::collection::{btree_set, vec};
use proptest::prelude::*;
use proptest::sample::select;
use std::fmt::Write as _;

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn tables_by_wavelength_come_back(
        (head, unit) in select(vec![("nm", 1.0f64), ("Wavelength_NM", 1.0), ("lambda_nm", 1.0), ("um", 1e3), ("wavelength_um", 1e3)]),
        steps in btree_set(1..10_000_000u32, 2..60),
        values in vec(uniform4(prop::num::f64::NORMAL), 60),
        columns in 1..=4usize,
        pick in 0..4usize,
        mark in select(vec!["", "\u{feff}"]),
        end in select(vec!["\n", "\r\n"]),
    ) {
        let names = ["n", "k", "absorption_per_mm", "K2"];
        let place = pick % columns;
        let mut text = format!("{mark}# random\n\n{head}, {}\n", names[..columns].join(", "));
        let mut rows = Vec::new();
        for (row, step) in steps.into_iter().enumerate() {
            let wavelength = f64::from(step) / (1e3 * unit);
            let words = values[row][..columns].iter().map(f64::to_string).collect::<Vec<_>>();
            _ = writeln!(text, "{wavelength},{}", words.join(", "));
            if row % 5 == 0 {
                text += "# a comment, and an empty line\n\n";
            }
            rows.push([unit * wavelength, values[row][place]]);
        }
        let wanted = ["missing", names[place]];
        let column = if place == 0 { SpectralColumn::Second } else { SpectralColumn::Named(&wanted) };
        let found = parse(text.replace('\n', end).as_bytes(), column)?;
        prop_assert_eq!(found, SpectralValues { name: names[place].to_owned(), rows });
    }
}
