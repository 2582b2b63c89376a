//! The command line: arguments, progress, exit codes. Only its child `console` prints.

mod batch;
mod check;
mod compare;
mod console;
mod convert;
mod diff;
mod display;
mod exit;
mod film;
mod junit;
mod measured;
mod merge;
mod mesh;
mod optimise;
mod process;
mod run;
mod values;

use crate::cli::batch::BatchArgs;
use crate::cli::check::CheckArgs;
use crate::cli::compare::CompareArgs;
use crate::cli::console::print_error;
use crate::cli::convert::ConvertArgs;
use crate::cli::diff::DiffArgs;
use crate::cli::exit::finish;
use crate::cli::film::FilmArgs;
use crate::cli::merge::MergeArgs;
use crate::cli::mesh::MeshArgs;
use crate::cli::optimise::OptimiseArgs;
use crate::cli::run::RunArgs;
use clap::{CommandFactory, Parser, Subcommand};
use lumiduct_base::error::Error;
use lumiduct_base::text::visible;
use lumiduct_input as input;
use lumiduct_report::library_table;
use std::path::PathBuf;
use std::process::ExitCode;

/// Photometric sensor data for light tubes and light guides: flux, uniformity, maps and far fields with error bars.
#[derive(Debug, Parser)]
#[command(name = "lumiduct", version, about, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 good; 1 a check was missed, or reports differ; 2 not run (usage or input); 3 internal or I/O \
error; 130 stopped by Ctrl-C.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Trace a scene and write its report.
    Run(RunArgs),
    /// Trace all designs of a study and write the results.
    Batch(BatchArgs),
    /// Find sizes or pitches of a pattern that give the wanted light, and check them. Exits with 1 if the target is not reached.
    Optimise(OptimiseArgs),
    /// Merge the parts of a run or a study that were computed with --shard.
    Merge(MergeArgs),
    /// Run several estimators and baselines for the same time and compare their errors against a reference value.
    Compare(CompareArgs),
    /// Compare two reports, of runs or of studies. Exits with 1 if a measure differs by more than its error allows.
    Diff(DiffArgs),
    /// Validate a scene, print what is in it, and draw a cross-section with 50 traced paths.
    Check(CheckArgs),
    /// Print reflectance and transmittance of the prism films of a scene against the angle.
    Film(FilmArgs),
    /// Print the media, finishes and emissions that scenes can name without defining them, with the sources of their numbers.
    Library,
    /// Examine a mesh file: is it closed, the right way out, and fine enough? Exits with 1 if it is not a valid solid.
    Mesh(MeshArgs),
    /// Convert luminaires (.ies, .ldt; to .xml, TM-33) or ray files (.tm25ray, .sdf, .dat, .csv), or describe them; describe a BSDF (.xml, .csv).
    Convert(ConvertArgs),
    /// List scenes and sensor files in a folder.
    List {
        /// The folder to look in.
        #[arg(default_value = ".")]
        folder: PathBuf,
    },
    /// Print the JSON Schema of scene, study, optimisation or sensor files, for editors.
    Schema {
        /// The kind of file.
        #[arg(value_enum, default_value = "scene")]
        of: SchemaOf,
    },
    /// Print a completion script.
    Completions {
        /// The shell to print it for.
        shell: clap_complete::Shell,
    },
    /// Print the manual page.
    Man,
}

/// Files that have a schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum SchemaOf {
    Scene,
    Study,
    Optimisation,
    Sensor,
}

/// Runs the program on the arguments of the process.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            print_usage(&error);
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    match cli.command {
        Command::Run(args) => run::run(&args),
        Command::Merge(args) => merge::merge(&args),
        Command::Batch(args) => batch::batch(&args),
        Command::Optimise(args) => optimise::optimise(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Convert(args) => convert::convert(&args),
        Command::Diff(args) => diff::run(&args),
        Command::Check(args) => check::check(&args),
        Command::Film(args) => film::film(&args),
        Command::Library => finish(Ok(library_table())),
        Command::Mesh(args) => mesh::mesh(&args),
        Command::List { folder } => finish(input::list(&folder)),
        Command::Schema { of } => {
            let schema = match of {
                SchemaOf::Scene => input::editor_schema::scene_file_schema(),
                SchemaOf::Study => input::schema::study_schema(),
                SchemaOf::Optimisation => input::schema::optimisation_schema(),
                SchemaOf::Sensor => input::editor_schema::sensor_file_schema(),
            };
            finish(Ok(format!("{schema:#}\n")))
        }
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "lumiduct", &mut script);
            finish(Ok(String::from_utf8_lossy(&script).into_owned()))
        }
        Command::Man => {
            let mut page = Vec::new();
            let rendered = clap_mangen::Man::new(Cli::command()).render(&mut page);
            finish(rendered.map(|()| String::from_utf8_lossy(&page).into_owned()).map_err(
                |reason| Error::Output { what: "manual page".into(), reason: reason.to_string() },
            ))
        }
    }
}

/// Prints what is wrong with the arguments, or the requested help. Control characters of arguments
/// are escaped; a closed pipe is not an error.
fn print_usage(error: &clap::Error) {
    let arguments = std::env::args_os().map(|argument| visible(&argument.to_string_lossy()));
    match Cli::try_parse_from(arguments) {
        Err(error) => _ = error.print(),
        Ok(_) => print_error(&error.render().to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_make_sense_together() {
        Cli::command().debug_assert();
    }
}
