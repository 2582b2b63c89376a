//! Arguments of `lumiduct convert`.

mod luminaires;
mod rays;
mod scatter;

use crate::cli::exit::{fail, finish};
use crate::cli::values::parse_count;
use clap::Args;
use lumiduct_base::error::{Error, Result};
use lumiduct_files::luminaire::LuminaireFormat;
use lumiduct_files::rays::RayFormat;
use lumiduct_files::scatter::ScatterFormat;
use lumiduct_report::Existing;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(super) struct ConvertArgs {
    /// A luminaire, .ies (LM-63-1986 to -2019, goniometer types A, B and C) or .ldt (EULUMDAT); or rays, .tm25ray (IES TM-25), .sdf or .dat (source
    /// file of OpticStudio) or .csv. A BSDF, .xml, is only described.
    from: PathBuf,
    /// The file to write, of the same kind: .ies (LM-63-2002) or .ldt; .tm25ray, .sdf, .dat or .csv. Left out, the file is only described.
    to: Option<PathBuf>,
    /// Of a ray file, take no more than this many rays, drawn at random; their fluxes are scaled to the flux of all.
    #[arg(long, value_name = "COUNT", value_parser = parse_count)]
    rays: Option<u64>,
    /// Seed of the drawing.
    #[arg(long, default_value_t = 0, requires = "rays")]
    seed: u64,
    /// Replace an existing file.
    #[arg(long)]
    overwrite: bool,
}

pub(super) fn convert(args: &ConvertArgs) -> ExitCode {
    match converted(args) {
        Ok(text) => finish(Ok(text)),
        Err(error) => fail(&error),
    }
}

fn converted(args: &ConvertArgs) -> Result<String> {
    let ConvertArgs { from, to, rays, seed, overwrite } = args;
    let existing = if *overwrite { Existing::Replace } else { Existing::Keep };
    let to = to.as_deref();
    if RayFormat::of(from).is_ok() {
        return rays::converted(from, to, rays.map(|count| (count, *seed)), existing);
    }
    let is_bsdf = ScatterFormat::of(from).is_ok_and(|format| format == ScatterFormat::Xml);
    if is_bsdf {
        return match to {
            None if rays.is_none() => scatter::description(from),
            _ => Err(Error::Usage(format!("{}: a BSDF is only described", from.display()))),
        };
    }
    if LuminaireFormat::of(from).is_err() {
        return Err(Error::Usage(format!(
            "{}: not the ending of a known file; luminaires have .ies or .ldt, rays .tm25ray, .sdf, .dat or .csv, BSDFs .xml",
            from.display()
        )));
    }
    if rays.is_some() {
        return Err(Error::Usage(format!("--rays: {} is not a ray file", from.display())));
    }
    luminaires::converted(from, to, existing)
}
