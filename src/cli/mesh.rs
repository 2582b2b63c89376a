//! Arguments of `lumiduct mesh`.

use crate::cli::console::print;
use crate::cli::exit::fail;
use clap::{Args, ValueEnum};
use lumiduct_base::error::Error;
use lumiduct_files::mesh::{LengthUnit, MeshFormat, read};
use lumiduct_report::mesh_report;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(super) struct MeshArgs {
    /// The mesh: glTF, GLB, STL or OBJ.
    file: PathBuf,
    /// The unit of its lengths [default: m for glTF and GLB, mm for all others].
    #[arg(long)]
    unit: Option<Unit>,
}

/// Length units by their names on the command line.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Unit {
    Mm,
    Cm,
    M,
    Inch,
}

impl From<Unit> for LengthUnit {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::Mm => Self::Millimetre,
            Unit::Cm => Self::Centimetre,
            Unit::M => Self::Metre,
            Unit::Inch => Self::Inch,
        }
    }
}

pub(super) fn mesh(args: &MeshArgs) -> ExitCode {
    let name = args.file.display().to_string();
    let usual = match MeshFormat::of(&args.file) {
        Ok(MeshFormat::Gltf) => Unit::M,
        Ok(MeshFormat::Stl | MeshFormat::Obj) | Err(_) => Unit::Mm,
    };
    let mesh = match read(&args.file, args.unit.unwrap_or(usual).into()) {
        Ok(mesh) => mesh,
        Err(error) => return fail(&Error::Usage(format!("{name}: {error}"))),
    };
    let health = mesh.health();
    match print(&mesh_report(&name, &mesh, &health)) {
        Ok(()) if health.is_sound() => ExitCode::SUCCESS,
        Ok(()) => ExitCode::from(1),
        Err(error) => fail(&error),
    }
}
