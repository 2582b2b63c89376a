//! The library of media as a table.

use lumiduct_base::number::{format_fixed, format_value};
use lumiduct_core::optics::REFERENCE_WAVELENGTH;
use lumiduct_input::library;
use std::fmt::Write;

/// The media that scenes can name, with their sources.
pub fn library_table() -> String {
    let mut text =
        String::from("Media, for `medium = \"NAME\"` or `index = { library = \"NAME\" }`:\n");
    for (name, medium) in library::media() {
        let law = medium.law();
        let [first, last] = medium.range_nm.map(format_value);
        // Writing to a string cannot fail.
        _ = write!(
            text,
            "\n{name}: {}\n  index {} at {REFERENCE_WAVELENGTH} nm, Abbe number {}, from {first} to {last} nm; no absorption\n  {} ({})\n",
            medium.description,
            format_fixed(law.at(REFERENCE_WAVELENGTH), 4),
            format_fixed(law.abbe_number(), 1),
            medium.source,
            medium.licence
        );
    }
    text
}
