//! Writes the comparisons of estimators of docs/comparison.

use crate::{root, verify};
use clap::Args;
use std::io;
use std::path::PathBuf;
use std::process::Command;

/// What is compared.
const ESTIMATORS: &str = "forward,backward,sppm,metropolis,mix,gather,mis,auto";
/// The scenes that are compared. Each has one sensor, with one cell.
const SCENES: [&str; 5] =
    ["remote_cell_sun", "remote_cell_rod", "remote_cell_led", "remote_cell_scatter", "white_box"];
/// Divides the cell, so that there are errors per cell.
const CELLS: &str = "sensors.cell.plane.cells=[4,4]";

/// What is compared, and for how long.
#[derive(Debug, Args)]
pub(crate) struct CompareTimes {
    /// Scenes [default: all five].
    #[arg(value_parser = clap::builder::PossibleValuesParser::new(SCENES))]
    scenes: Vec<String>,
    /// Time for each estimator, all its runs together.
    #[arg(long, default_value = "60s")]
    time: String,
    /// Time for the truth of a scene.
    #[arg(long, default_value = "10min")]
    truth_time: String,
    /// Independent runs of each estimator.
    #[arg(long, default_value = "8")]
    runs: String,
    /// Folder of the results.
    #[arg(long, default_value = "docs/comparison")]
    output: PathBuf,
    /// The program to run, instead of one that is built for it.
    #[arg(long)]
    program: Option<PathBuf>,
}

/// Compares the estimators; returns whether all comparisons were written.
pub(crate) fn compare(times: &CompareTimes) -> io::Result<bool> {
    let program = match &times.program {
        Some(program) => program.canonicalize()?,
        None => verify::build()?,
    };
    let mut is_good = true;
    for name in SCENES {
        if !times.scenes.is_empty() && !times.scenes.iter().any(|scene| scene == name) {
            continue;
        }
        println!("{name}");
        let mut command = Command::new(&program);
        command.current_dir(root()).arg("compare").arg(format!("scenes/{name}.toml"));
        command.args(["-D", CELLS, "--estimators", ESTIMATORS, "--overwrite"]);
        command.args(["--time", &times.time, "--truth-time", &times.truth_time]);
        command.args(["--runs", &times.runs]).arg("-o").arg(times.output.join(name));
        is_good &= command.status()?.success();
    }
    Ok(is_good)
}
