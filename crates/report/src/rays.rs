//! Ray files of sensors.

use crate::OutputFile;
use lumiduct_base::error::{Error, Result};
use lumiduct_base::number::format_value;
use lumiduct_base::units::FluxUnit;
use lumiduct_files::rays::{FileRay, RayFormat, RaySetInfo, RayText, write};

/// Rays that a sensor counted, for files.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredRays {
    /// Name of the sensor, and of the files.
    pub sensor: String,
    /// The formats to write.
    pub formats: Vec<RayFormat>,
    /// Unit of their flux.
    pub unit: FluxUnit,
    /// The rays, in the coordinates of the scene.
    pub rays: Vec<FileRay>,
    /// What made them: the title of the scene with its hash, and the program.
    pub origin: [String; 2],
}

impl MeasuredRays {
    fn file_name(&self, format: RayFormat) -> String {
        let part = match format {
            RayFormat::Tm25 | RayFormat::Zemax => "",
            // Maps are CSV, too.
            RayFormat::Csv => ".rays",
        };
        format!("{}{part}.{}", self.sensor, format.ending())
    }

    fn file(&self, format: RayFormat) -> Result<OutputFile> {
        let name = self.file_name(format);
        let [scene, program] = self.origin.clone();
        let info = RaySetInfo {
            count: self.rays.len() as u64,
            unit: self.unit,
            flux: self.flux(),
            luminous_flux_lm: None,
            is_measured: false,
            texts: vec![(RayText::Name, scene), (RayText::Equipment, program)],
        };
        let mut bytes = Vec::new();
        let rays = self.rays.iter().copied().map(Ok);
        match write(&mut bytes, format, &info, rays) {
            Ok(_) => Ok(OutputFile { name, bytes }),
            Err(error) => Err(Error::Output { what: name, reason: error.to_string() }),
        }
    }

    fn flux(&self) -> f64 {
        self.rays.iter().map(|ray| f64::from(ray.flux)).sum()
    }
}

/// The files of all sensors.
///
/// # Errors
///
/// [`Error::Output`] if a format cannot hold the rays.
pub(crate) fn files(all: &[MeasuredRays]) -> Result<Vec<OutputFile>> {
    let each = |rays: &MeasuredRays| {
        rays.formats.iter().map(|format| rays.file(*format)).collect::<Vec<_>>()
    };
    all.iter().flat_map(each).collect()
}

/// A sentence on the ray files of a sensor, if it writes any.
pub(crate) fn sentence(all: &[MeasuredRays], sensor: &str) -> Option<String> {
    let found = all.iter().find(|rays| rays.sensor == sensor)?;
    let files: Vec<String> = found.formats.iter().map(|format| found.file_name(*format)).collect();
    Some(format!(
        "{}: {} rays with {} {} in the coordinates of the scene, mm; they were traced after the run.",
        files.join(" and "),
        found.rays.len(),
        format_value(found.flux()),
        found.unit.flux(),
    ))
}
