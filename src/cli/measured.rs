//! Arguments of `lumiduct diff REPORT FILE`: a report beside a measured file.

use crate::cli::values::{parse_length, parse_percent};
use clap::{Args, ValueEnum};
use lumiduct_base::error::{Error, Result};
use lumiduct_files::measured::FirstRow;
use lumiduct_report::measured::{MatrixPlace, MeasuredOptions};

/// Arguments for a measured file alone.
#[derive(Debug, Args)]
#[command(next_help_heading = "With a measured file")]
pub(super) struct MeasuredArgs {
    /// Compare with this sensor, or with one of its tables, such as `exit.illuminance`.
    #[arg(long, value_name = "NAME")]
    sensor: Option<String>,
    /// Width along u of a matrix of numbers, mm.
    #[arg(long, value_parser = parse_length, value_name = "MM")]
    width_mm: Option<f64>,
    /// Height along v of a matrix of numbers, mm.
    #[arg(long, value_parser = parse_length, value_name = "MM")]
    height_mm: Option<f64>,
    /// Which side of a matrix of numbers its first row is (top unless given).
    #[arg(long, value_name = "SIDE")]
    rows: Option<MatrixSide>,
    /// Take the places of the file as they are: search no shift, and no rotation.
    #[arg(long)]
    no_align: bool,
    /// Take the values of the file as they are.
    #[arg(long)]
    no_scale: bool,
    /// Exit with 1 if the rms difference after alignment and scale is above this share of the largest computed value.
    #[arg(long, value_parser = parse_percent, value_name = "PERCENT")]
    max_difference: Option<f64>,
}

/// A side of a matrix.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum MatrixSide {
    /// The largest v, as in a picture.
    Top,
    /// The smallest v.
    Bottom,
}

impl MeasuredArgs {
    /// Refuses these options where two reports are compared.
    pub(super) fn expect_none(&self) -> Result<()> {
        let given = [
            ("--sensor", self.sensor.is_some()),
            ("--width-mm", self.width_mm.is_some()),
            ("--height-mm", self.height_mm.is_some()),
            ("--rows", self.rows.is_some()),
            ("--no-align", self.no_align),
            ("--no-scale", self.no_scale),
            ("--max-difference", self.max_difference.is_some()),
        ];
        refuse(&given, "is for a measured file (.ies, .ldt or .csv), not for two reports")
    }

    /// How the file is compared.
    pub(super) fn options(&self) -> MeasuredOptions {
        let first_row = self.rows.map(|side| match side {
            MatrixSide::Top => FirstRow::Top,
            MatrixSide::Bottom => FirstRow::Bottom,
        });
        MeasuredOptions {
            sensor: self.sensor.clone(),
            place: MatrixPlace { width_mm: self.width_mm, height_mm: self.height_mm, first_row },
            no_align: self.no_align,
            no_scale: self.no_scale,
            limit: self.max_difference,
        }
    }
}

/// Refuses the first option that is given.
pub(super) fn refuse(given: &[(&str, bool)], why: &str) -> Result<()> {
    match given.iter().find(|(_, is_given)| *is_given) {
        None => Ok(()),
        Some((flag, _)) => Err(Error::Usage(format!("{flag} {why}"))),
    }
}
