//! Whatever a luminaire file contains, it is refused, or can be written and read again.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lumiduct_files::luminaire::{LuminaireFormat, parse, written};

fuzz_target!(|input: (bool, &[u8])| {
    let (is_ies, bytes) = input;
    let format = if is_ies { LuminaireFormat::Ies } else { LuminaireFormat::Ldt };
    if let Ok(read) = parse(bytes, format) {
        assert!(read.luminaire.intensities.flux().is_finite());
        assert!(parse(written(&read.luminaire, format).text.as_bytes(), format).is_ok());
    }
});
