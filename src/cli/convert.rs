//! Arguments of `lumiduct convert`.

mod luminaires;
mod rays;
mod scatter;

use crate::cli::exit::{fail, finish};
use crate::cli::values::parse_count;
use clap::{Args, ValueEnum};
use lumiduct_base::error::{Error, Result};
use lumiduct_files::luminaire::LuminaireFormat;
use lumiduct_files::rays::RayFormat;
use lumiduct_files::scatter::{ScatterFormat, is_scatter_table};
use lumiduct_report::Existing;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(super) struct ConvertArgs {
    /// A luminaire, .ies (LM-63-1986 to -2019, goniometer types A, B and C) or .ldt (EULUMDAT); or rays, .tm25ray (IES TM-25), .sdf or .dat (source
    /// file of OpticStudio) or .csv. A BSDF, .xml or .csv by angles, is only described.
    from: PathBuf,
    /// The file to write, of the same kind: .ies (LM-63-2002), .ldt or .xml (TM-33, which is written only); .tm25ray, .sdf, .dat or .csv. Left out, the file is
    /// only described.
    to: Option<PathBuf>,
    /// Edition of LM-63 to write; that of 2019 says how the file was made.
    #[arg(long, value_name = "YEAR", requires = "to")]
    edition: Option<EditionChoice>,
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

/// An edition of LM-63.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum EditionChoice {
    /// LM-63-2002.
    #[value(name = "2002")]
    Of2002,
    /// LM-63-2019.
    #[value(name = "2019")]
    Of2019,
}

pub(super) fn convert(args: &ConvertArgs) -> ExitCode {
    match converted(args) {
        Ok(text) => finish(Ok(text)),
        Err(error) => fail(&error),
    }
}

fn converted(args: &ConvertArgs) -> Result<String> {
    let ConvertArgs { from, to, edition, rays, seed, overwrite } = args;
    let existing = if *overwrite { Existing::Replace } else { Existing::Keep };
    let to = to.as_deref();
    let is_bsdf = match ScatterFormat::of(from) {
        Ok(ScatterFormat::Xml) => true,
        Ok(ScatterFormat::Csv) => is_scatter_table(from),
        Err(_) => false,
    };
    if RayFormat::of(from).is_ok() && !is_bsdf {
        if edition.is_some() {
            let why = format!("--edition: {} is not a luminaire", from.display());
            return Err(Error::Usage(why));
        }
        return rays::converted(from, to, rays.map(|count| (count, *seed)), existing);
    }
    if is_bsdf {
        return match to {
            None if rays.is_none() => scatter::description(from),
            None => Err(Error::Usage(format!("--rays: {} is not a ray file", from.display()))),
            Some(_) => Err(Error::Usage(format!(
                "{} is read as a BSDF, which is only described: leave the second file out; luminaires are read from .ies and .ldt",
                from.display()
            ))),
        };
    }
    if LuminaireFormat::of(from).is_err() {
        return Err(Error::Usage(format!(
            "{}: not the ending of a known file; luminaires have .ies or .ldt, rays .tm25ray, .sdf, .dat or .csv, BSDFs .xml or .csv",
            from.display()
        )));
    }
    if rays.is_some() {
        return Err(Error::Usage(format!("--rays: {} is not a ray file", from.display())));
    }
    let to = to.map(|to| Ok((to, format_of(to, *edition)?))).transpose()?;
    luminaires::converted(from, to, existing)
}

/// The format of a luminaire file to write.
fn format_of(to: &Path, edition: Option<EditionChoice>) -> Result<LuminaireFormat> {
    let wrong = |why: String| Error::Usage(format!("{}: {why}", to.display()));
    let format = LuminaireFormat::of(to).map_err(|error| wrong(error.to_string()))?;
    match (format, edition) {
        (LuminaireFormat::Ies, Some(EditionChoice::Of2019)) => Ok(LuminaireFormat::Ies2019),
        (LuminaireFormat::Ies | LuminaireFormat::Ies2019, _)
        | (LuminaireFormat::Ldt | LuminaireFormat::Tm33, None) => Ok(format),
        (LuminaireFormat::Ldt | LuminaireFormat::Tm33, Some(_)) => {
            Err(wrong("--edition is for .ies files only; leave it out".to_owned()))
        }
    }
}
