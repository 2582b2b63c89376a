//! The library as text: what scenes can name, with the sources of its numbers.

use indexmap::IndexMap;
use lumiduct_base::number::{format_fixed, format_value};
use lumiduct_core::optics::REFERENCE_WAVELENGTH;
use lumiduct_input::library::{self, LibraryEntry};
use std::fmt::Write;

/// The media, finishes and emissions that scenes can name, with their sources.
pub fn library_table() -> String {
    let finishes = entries("\nFinishes, for `finish = \"NAME\"`:\n", library::finishes());
    let emissions = entries("\nEmissions, for `emission = \"NAME\"`:\n", library::emissions());
    [media(), finishes, emissions].concat()
}

fn media() -> String {
    let mut text =
        String::from("Media, for `medium = \"NAME\"` or `index = { library = \"NAME\" }`:\n");
    for (name, medium) in library::media() {
        let law = medium.law();
        let [first, last] = medium.range_nm.map(format_value);
        let absorption = medium.absorption().map_or("no absorption".to_owned(), |absorption| {
            format!(
                "absorption {} /mm at 555 nm",
                format_value(absorption.at(REFERENCE_WAVELENGTH))
            )
        });
        // Writing to a string cannot fail.
        _ = write!(
            text,
            "\n{name}: {}\n  index {} at {REFERENCE_WAVELENGTH} nm, Abbe number {}, from {first} to {last} nm; {absorption}\n  {} ({})\n",
            medium.description,
            format_fixed(law.at(REFERENCE_WAVELENGTH), 4),
            format_fixed(law.abbe_number(), 1),
            medium.source,
            medium.licence
        );
    }
    text
}

fn entries<Spec>(heading: &str, entries: &IndexMap<String, LibraryEntry<Spec>>) -> String {
    let mut text = String::from(heading);
    for (name, entry) in entries {
        let LibraryEntry { description, source, licence, keys, .. } = entry;
        // Writing to a string cannot fail.
        _ = write!(text, "\n{name}: {description}\n  {keys}\n  {source} ({licence})\n");
    }
    text
}
