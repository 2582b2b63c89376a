//! Converts a luminaire file, reads it back and compares both:
//! `cargo run -p lumiduct-files --example convert_luminaire lamp.ies lamp.ldt`, and `lamp.ldt back.ies` for the way back.
//!
//! The endings give the formats: .ies or .ldt to read, .ies, .ldt or .xml (TM-33) to write. No file is replaced.

#![allow(clippy::print_stdout, reason = "a program for the command line")]

use lumiduct_files::luminaire::{LuminaireFormat, parse, read, written};
use std::error::Error;
use std::fs::File;
use std::io::Write;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let [from, to] = &names[..] else {
        return Err("usage: convert_luminaire FROM.ies|ldt TO.ies|ldt|xml".into());
    };
    let format = LuminaireFormat::of(Path::new(to)).map_err(|error| format!("{to}: {error}"))?;
    let source = read(Path::new(from)).map_err(|error| format!("{from}: {error}"))?;
    let file = written(&source.luminaire, format);
    let mut out = File::create_new(to).map_err(|error| format!("{to}: {error}"))?;
    out.write_all(file.text.as_bytes())?;
    for remark in source.remarks.iter().chain(&file.remarks) {
        println!("remark: {remark}");
    }
    for keyword in format.keywords_left_out(&source.luminaire) {
        println!("remark: {format} has no field for the text {keyword}");
    }
    let flux = source.luminaire.intensities.flux();
    println!("{from}: {flux:.2} lm");
    match format {
        LuminaireFormat::Ies | LuminaireFormat::Ies2019 | LuminaireFormat::Ldt => {
            let again = parse(file.text.as_bytes(), format)?.luminaire;
            println!("{to}: {:.2} lm", again.intensities.flux());
        }
        LuminaireFormat::Tm33 => println!("{to}: TM-33 is written only"),
    }
    Ok(())
}
