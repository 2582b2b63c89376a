//! Arguments of `lumiduct film`.

use crate::cli::exit::{fail, finish, warn};
use crate::cli::values::{parse_index, parse_step};
use clap::Args;
use lumiduct_base::error::Error;
use lumiduct_input::{self as input, Settings};
use lumiduct_report::film_tables;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(super) struct FilmArgs {
    /// The scene file.
    scene: PathBuf,
    /// Set a key of the scene.
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    define: Vec<String>,
    /// Step of the angle, in degrees from 0.1 to 45.
    #[arg(long, value_parser = parse_step, value_name = "DEG", default_value = "5")]
    step_deg: f64,
    /// Refractive index of the medium on both sides.
    #[arg(long, value_parser = parse_index, value_name = "INDEX", default_value = "1")]
    index: f64,
}

pub(super) fn film(args: &FilmArgs) -> ExitCode {
    let settings = Settings { overrides: args.define.clone(), ..Settings::default() };
    let job = match input::load(&args.scene, &settings) {
        Ok(job) => job,
        Err(error) => return fail(&error),
    };
    warn(&job.warnings);
    let tables = film_tables(&job.scene.finishes, args.index, args.step_deg);
    finish(tables.ok_or_else(|| {
        let scene = args.scene.display();
        Error::Usage(format!(
            "{scene} defines no `prism_film` finish; docs/scene_format.md shows one"
        ))
    }))
}
