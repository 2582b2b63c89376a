//! Arguments of `lumiduct check`.

use crate::cli::exit::{fail, finish, warn};
use crate::pipeline::{self, CheckPage, CheckPictures};
use clap::Args;
use glam::DVec3;
use lumiduct_input::Settings;
use lumiduct_report::{CutPlane, Existing, SectionView};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(super) struct CheckArgs {
    /// The scene file.
    scene: PathBuf,
    /// Set a key of the scene.
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    define: Vec<String>,
    /// PNG file of the cross-section [default: NAME.check.png in this folder].
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace an existing FILE; NAME.check.png and NAME.check.html are always replaced.
    #[arg(long)]
    overwrite: bool,
    /// Cut along this plane: xz, yz or xy through the middle, xz@y=5 at a place in mm [default: the plane of the guide's
    /// centre line].
    #[arg(long, value_name = "PLANE", value_parser = parse_plane)]
    plane: Option<CutPlane>,
    /// Show the surroundings of one face, solid, sheet, source or sensor, such as pipe.exit.
    #[arg(long, value_name = "NAME")]
    zoom: Option<String>,
    /// The direction that points up in the picture: x, y, z, -x, -y or -z [default: z under a sky].
    #[arg(long, value_name = "AXIS", value_parser = parse_direction, allow_hyphen_values = true)]
    up: Option<DVec3>,
    /// Write NAME.check.html beside the picture as well: the scene in three dimensions, with names and local axes.
    #[arg(long)]
    html: bool,
}

pub(super) fn check(args: &CheckArgs) -> ExitCode {
    let settings = Settings { overrides: args.define.clone(), ..Settings::default() };
    let wished = CheckPictures {
        picture: args.output.clone(),
        existing: if args.overwrite { Existing::Replace } else { Existing::Keep },
        section: SectionView { plane: args.plane, zoom: args.zoom.clone(), up: args.up },
        page: if args.html { CheckPage::Wanted } else { CheckPage::Unwanted },
    };
    match pipeline::check(&args.scene, &settings, &wished) {
        Ok(checked) => {
            warn(&checked.warnings);
            finish(Ok(checked.text))
        }
        Err(error) => fail(&error),
    }
}

/// The number of an axis of the coordinates.
fn axis_of(name: &str) -> Option<usize> {
    ["x", "y", "z"].iter().position(|axis| *axis == name)
}

/// A plane of two axes, and where it lies on the third: `xz`, `xz@y=5`.
fn parse_plane(text: &str) -> Result<CutPlane, String> {
    let (axes, place) = match text.split_once('@') {
        Some((axes, place)) => (axes, Some(place)),
        None => (text, None),
    };
    let across = match axes {
        "yz" | "zy" => 0,
        "xz" | "zx" => 1,
        "xy" | "yx" => 2,
        _ => return Err(format!("`{axes}` is not a plane; try xz, yz, xy or xz@y=5")),
    };
    let Some(place) = place else { return Ok(CutPlane { across, at_mm: None }) };
    let name = ["x", "y", "z"][across];
    let at = place
        .split_once('=')
        .filter(|(axis, _)| axis_of(axis) == Some(across))
        .and_then(|(_, at)| at.parse::<f64>().ok())
        .filter(|at| at.is_finite())
        .ok_or_else(|| {
            format!("`{place}` is not a position of this plane; try {axes}@{name}=5, in mm")
        })?;
    Ok(CutPlane { across, at_mm: Some(at) })
}

/// A direction along an axis: `z`, `+z`, `-x`.
fn parse_direction(text: &str) -> Result<DVec3, String> {
    let (sign, axis) = match text.strip_prefix('-') {
        Some(axis) => (-1.0, axis),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    axis_of(axis)
        .map(|axis| sign * DVec3::AXES[axis])
        .ok_or_else(|| format!("`{text}` is not a direction; try x, y, z, -x, -y or -z"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_two_axes_and_a_place_on_the_third() {
        assert_eq!(parse_plane("xz"), Ok(CutPlane { across: 1, at_mm: None }));
        assert_eq!(parse_plane("zy@x=-2.5"), Ok(CutPlane { across: 0, at_mm: Some(-2.5) }));
        for wrong in ["", "xx", "xz@x=5", "xz@5", "xy@z=nan", "xy@z="] {
            assert!(parse_plane(wrong).is_err(), "{wrong}");
        }
        assert!(parse_plane("xy@5").unwrap_err().contains("xy@z=5"));
    }

    #[test]
    fn directions_are_axes_with_a_sign() {
        assert_eq!(parse_direction("-y"), Ok(-DVec3::Y));
        assert_eq!(parse_direction("+z"), Ok(DVec3::Z));
        assert!(parse_direction("up").unwrap_err().contains("try x"));
    }
}
