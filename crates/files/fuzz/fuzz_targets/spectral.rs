//! Whatever a table by wavelength contains, it is refused, or its rows can be used.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lumiduct_files::spectral::{SpectralColumn, parse};

fuzz_target!(|input: (bool, &[u8])| {
    let (is_second, bytes) = input;
    let column = if is_second { SpectralColumn::Second } else { SpectralColumn::Named(&["n"]) };
    if let Ok(values) = parse(bytes, column) {
        assert!(values.rows.iter().flatten().all(|number| number.is_finite()));
        assert!(values.rows.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    }
});
