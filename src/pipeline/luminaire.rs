//! Luminaires of goniometers: for the files of a report, and for a file of its own.

use crate::pipeline::version::VERSION;
use lumiduct_base::error::{Error, Result};
use lumiduct_base::units::FluxUnit;
use lumiduct_core::measure::Measures;
use lumiduct_core::scene::{Goniometer, SensorKind};
use lumiduct_files::luminaire::LuminaireFormat;
use lumiduct_input::{Job, LuminaireExport};
use lumiduct_report::{Existing, LuminaireOrigin, MeasuredLuminaire, Report, write_whole};
use std::path::{Path, PathBuf};

/// The luminaires of a report.
pub(super) fn luminaires(job: &Job, measures: &Measures) -> Result<Vec<MeasuredLuminaire>> {
    job.exports.luminaires.iter().map(|export| luminaire(job, export, measures)).collect()
}

fn luminaire(
    job: &Job,
    export: &LuminaireExport,
    measures: &Measures,
) -> Result<MeasuredLuminaire> {
    let origin = LuminaireOrigin {
        title: &job.title,
        hash: &job.hash,
        date: job.project.as_ref().and_then(|project| project.date.as_deref()),
        version: VERSION,
    };
    MeasuredLuminaire::new(export, measures, &origin)
}

/// A luminaire file that was written outside the folder of the report.
#[derive(Debug)]
pub struct WrittenFile {
    /// Where it is.
    pub path: PathBuf,
    /// Its format.
    pub format: LuminaireFormat,
    /// What was assumed, and what it cannot say, as far as the report does not tell.
    pub remarks: Vec<String>,
}

/// A luminaire file outside the folder of the report.
#[derive(Debug)]
pub(super) struct LuminaireFile {
    path: PathBuf,
    format: LuminaireFormat,
    export: LuminaireExport,
    existing: Existing,
}

impl LuminaireFile {
    /// Checks, before any work is done, that the scene has one luminaire and that the file can be written: that of the only
    /// sensor with a key `luminaire` or, without such a key, that of the only goniometer or of the only one in the far field.
    pub(super) fn open(job: &Job, path: &Path, existing: Existing) -> Result<Self> {
        let refuse = |why: String| Error::Usage(format!("--ies {}: {why}", path.display()));
        let format = LuminaireFormat::of(path).map_err(|error| refuse(error.to_string()))?;
        if path.is_dir() {
            return Err(refuse("is a folder; name a file".to_owned()));
        }
        if existing == Existing::Keep && path.exists() {
            return Err(refuse("the file exists; use --overwrite to replace it".to_owned()));
        }
        let export = match &job.exports.luminaires[..] {
            [only] => only.clone(),
            [] => finest_export(job).map_err(refuse)?,
            _ => {
                let why = "several sensors have a key `luminaire`; their files are in the report";
                return Err(refuse(why.to_owned()));
            }
        };
        // The key may ask for another edition of the format that the name has.
        let has_name = |own: &&LuminaireFormat| own.ending() == format.ending();
        let format = export.formats.iter().find(has_name).copied().unwrap_or(format);
        Ok(Self { path: path.to_path_buf(), format, export, existing })
    }

    /// Writes the file. Of its remarks, those that are in the report are left out.
    pub(super) fn write(&self, job: &Job, report: &Report) -> Result<WrittenFile> {
        let (format, export) = (self.format, &self.export);
        let (file, mut remarks) = match &report.luminaires[..] {
            [only] => (only.file(format), only.left_out(format)),
            _ => {
                let export = LuminaireExport { formats: vec![format], ..export.clone() };
                let found = luminaire(job, &export, &report.measures)?;
                let remarks = export.remarks_on_distance(&job.scene).into_iter();
                let remarks =
                    remarks.map(|remark| format!("`sensors.{}`: {remark}", export.sensor));
                (found.file(format), remarks.chain(found.remarks).collect())
            }
        };
        write_whole(&self.path, &file.bytes, self.existing)?;
        remarks.retain(|remark| !report.warnings.contains(remark));
        Ok(WrittenFile { path: self.path.clone(), format, remarks })
    }
}

/// The export of the only goniometer, or of the only one in the far field; or why there is none.
fn finest_export(job: &Job) -> std::result::Result<LuminaireExport, String> {
    if job.scene.unit == FluxUnit::Watt {
        return Err(
            "luminous intensities need sources in lm, and those of the scene are in W".to_owned()
        );
    }
    let all: Vec<(&str, &Goniometer)> = job
        .scene
        .sensors
        .iter()
        .filter_map(|sensor| match &sensor.kind {
            SensorKind::Goniometer(goniometer) => Some((sensor.name.as_str(), goniometer)),
            SensorKind::Surface(_) => None,
        })
        .collect();
    let far = all.iter().copied().filter(|(_, goniometer)| goniometer.radius.is_none());
    let (name, goniometer) = match (&all[..], &far.collect::<Vec<_>>()[..]) {
        ([only], _) | (_, [only]) => *only,
        ([], _) => return Err("the scene has no goniometer".to_owned()),
        (_, _) => {
            return Err("the scene has several goniometers; give one of them the key `luminaire`"
                .to_owned());
        }
    };
    let export = LuminaireExport::of_goniometer(name, goniometer);
    let cells = [goniometer.gamma_cells, goniometer.c_cells];
    let checked = export.layout.expect_cells(cells);
    checked.map(|()| export).map_err(|error| format!("{error}; give `{name}` smaller steps"))
}
