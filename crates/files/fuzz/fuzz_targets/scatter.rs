//! Whatever a scatter file contains, it is refused, or its values can be used.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lumiduct_files::scatter::{ScatterFormat, parse};

fuzz_target!(|input: (bool, &[u8])| {
    let (is_xml, bytes) = input;
    let format = if is_xml { ScatterFormat::Xml } else { ScatterFormat::Csv };
    if let Ok(file) = parse(bytes, format) {
        for side in [file.front, file.back] {
            for matrix in [side.reflection, side.transmission].into_iter().flatten() {
                let [from, to] = matrix.pairs.counts();
                assert_eq!(matrix.values.len(), from * to);
            }
        }
    }
});
