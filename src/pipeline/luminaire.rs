//! Luminaires of goniometers: for the files of a report, and for a file of its own.

use crate::pipeline::version::VERSION;
use lumiduct_base::error::{Diagnostic, DiagnosticKind, Error, Result};
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
    existing: Existing,
}

impl LuminaireFile {
    /// Checks, before any work is done, that the scene has one luminaire and that the file can be written: that of the only
    /// sensor with a key `luminaire` or, without such a key, that of the only goniometer or of the only one in the far field,
    /// which then has its pages in the report, too.
    pub(super) fn open(job: &mut Job, path: &Path, existing: Existing) -> Result<Self> {
        let refuse = |why: String| Error::Usage(format!("--ies {}: {why}", path.display()));
        let format = LuminaireFormat::of(path).map_err(|error| refuse(error.to_string()))?;
        if path.is_dir() {
            return Err(refuse("is a folder; name a file".to_owned()));
        }
        if existing == Existing::Keep && path.exists() {
            return Err(refuse("the file exists; use --overwrite to replace it".to_owned()));
        }
        let format = match &job.exports.luminaires[..] {
            // The key may ask for another edition of the format that the name has.
            [only] => only.formats.iter().find(|own| own.ending() == format.ending()).copied(),
            [] => {
                let export = finest_export(job).map_err(refuse)?;
                let remark = |message| Diagnostic {
                    kind: DiagnosticKind::Warning,
                    file: None,
                    line: None,
                    span: None,
                    key: format!("sensors.{}", export.sensor),
                    message,
                    hint: None,
                };
                let remarks = export.remarks_on_distance(&job.scene);
                job.warnings.extend(remarks.into_iter().map(remark));
                job.exports.luminaires.push(export);
                None
            }
            _ => {
                let why = "several sensors have a key `luminaire`; their files are in the report";
                return Err(refuse(why.to_owned()));
            }
        }
        .unwrap_or(format);
        Ok(Self { path: path.to_path_buf(), format, existing })
    }

    /// Writes the file. Of its remarks, those that are in the report are left out.
    pub(super) fn write(&self, report: &Report) -> Result<Option<WrittenFile>> {
        let write = |found: &MeasuredLuminaire| {
            write_whole(&self.path, &found.file(self.format).bytes, self.existing)?;
            let mut remarks = found.left_out(self.format);
            remarks.retain(|remark| !report.warnings.contains(remark));
            Ok(WrittenFile { path: self.path.clone(), format: self.format, remarks })
        };
        report.luminaires.first().map(write).transpose()
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
