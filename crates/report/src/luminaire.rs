//! Luminaire files of what goniometers measured.

pub(crate) mod page;
mod ugr;

use crate::OutputFile;
use lumiduct_base::error::{Error, Result};
use lumiduct_base::number::{format_percent, format_value};
use lumiduct_core::measure::{IntensityTable, Measures, Status};
use lumiduct_files::luminaire::{
    CellMeans, FileGeneration, FittedIntensities, LampFlux, Luminaire, LuminaireColour,
    LuminaireFormat, Misfit, asymmetry, fit, written,
};
use lumiduct_input::LuminaireExport;
use ndarray::Array2;

/// Flux of negative cells, or above a flat opening, that needs no remark, as a share of all, 1.
pub(crate) const NEGLIGIBLE_FLUX: f64 = 1e-3;

/// Difference of planes that are taken as equal that needs no remark, as a share of the intensities, 1.
const NEGLIGIBLE_ASYMMETRY: f64 = 0.01;

/// A luminaire from a goniometer.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredLuminaire {
    /// Name of the sensor, and of the files.
    pub sensor: String,
    /// The formats to write.
    pub formats: Vec<LuminaireFormat>,
    /// The luminaire.
    pub luminaire: Luminaire,
    /// Distance at which its intensities were measured, mm; `None` for the far field.
    pub distance_mm: Option<f64>,
    /// Standard errors of its intensities, planes by angles, cd.
    pub std_errors: Array2<f64>,
    /// Share of its light above 90°, 1.
    pub upward_share: f64,
    /// Sentences for the user.
    pub remarks: Vec<String>,
}

/// What a file says of its making.
#[derive(Debug, Clone, Copy)]
pub struct LuminaireOrigin<'a> {
    /// Title of the scene.
    pub title: &'a str,
    /// Its hash.
    pub hash: &'a str,
    /// Date of the project.
    pub date: Option<&'a str>,
    /// Version of the program.
    pub version: &'a str,
}

impl MeasuredLuminaire {
    /// The luminaire of an export.
    ///
    /// # Errors
    ///
    /// [`Error::Output`] if the readings make no table, such as values that are not finite.
    pub fn new(
        export: &LuminaireExport,
        measures: &Measures,
        origin: &LuminaireOrigin<'_>,
    ) -> Result<Self> {
        let failed = |reason: String| Error::Output {
            what: format!("luminaire of {}", export.sensor),
            reason,
        };
        let is_own =
            |table: &&IntensityTable| table.sensor == export.sensor && table.light.is_none();
        let readings = measures.intensities.iter().find(is_own);
        let readings = readings.ok_or_else(|| failed("it has no intensities".to_owned()))?;
        let means =
            CellMeans { candela: readings.values.view(), std_errors: readings.std_errors.view() };
        let fitted = fit(&means, &export.layout).map_err(|error| failed(error.to_string()))?;
        let lamps = match export.lamps {
            Some(count) => LampFlux::Relative { count, flux_lm: measures.source_flux },
            None => LampFlux::Absolute,
        };
        let asymmetry = asymmetry(&means, export.layout.symmetry);
        let upward_share = means.upward_share();
        let mut remarks = remarks(export, readings, &fitted, [asymmetry, upward_share]);
        let FittedIntensities { intensities, std_errors, .. } = fitted;
        let colour = colour(export, measures);
        let distance_mm = readings.radius_mm;
        let texts = texts(export, origin, distance_mm, &std_errors);
        let opening = export.opening.unwrap_or_default();
        let luminaire = Luminaire {
            texts,
            generation: FileGeneration::Simulated,
            lamps,
            power_w: export.power_w,
            opening,
            colour,
            intensities,
        };
        let (sensor, formats) = (export.sensor.clone(), export.formats.clone());
        let mut found = Self {
            sensor,
            formats,
            luminaire,
            distance_mm,
            std_errors,
            upward_share,
            remarks: Vec::new(),
        };
        remarks.extend(export.formats.iter().flat_map(|format| found.left_out(*format)));
        found.remarks = remarks;
        Ok(found)
    }

    /// What its file in a format cannot say.
    pub fn left_out(&self, format: LuminaireFormat) -> Vec<String> {
        let remarks = written(&self.luminaire, format).remarks;
        remarks.into_iter().map(|text| format!("{format} file: {text}")).collect()
    }

    /// Its file in a format.
    pub fn file(&self, format: LuminaireFormat) -> OutputFile {
        OutputFile::text(self.file_name(format), written(&self.luminaire, format).text)
    }

    fn file_name(&self, format: LuminaireFormat) -> String {
        format!("{}.{}", self.sensor, format.ending())
    }
}

/// The files of all luminaires.
pub(crate) fn files(luminaires: &[MeasuredLuminaire]) -> impl Iterator<Item = OutputFile> {
    luminaires
        .iter()
        .flat_map(|luminaire| luminaire.formats.iter().map(|format| luminaire.file(*format)))
}

/// What was assumed, and what the files cannot say.
fn remarks(
    export: &LuminaireExport,
    readings: &IntensityTable,
    fitted: &FittedIntensities,
    [asymmetry, upward_share]: [f64; 2],
) -> Vec<String> {
    let &FittedIntensities { added_share, misfit, .. } = fitted;
    let mut remarks = Vec::new();
    let mut remark = |text: String| {
        remarks.push(format!("luminaire files of `{}`: {text}", export.sensor));
    };
    if readings.weathers > 1 {
        let count = readings.weathers;
        remark(format!("they contain the sum over {count} weathers, which never occur together"));
    }
    if added_share > NEGLIGIBLE_FLUX {
        let share = format_percent(added_share);
        remark(format!(
            "noise made cells negative; they count as dark, so that the files have {share} more light than `flux`"
        ));
    }
    if asymmetry > NEGLIGIBLE_ASYMMETRY {
        let symmetry = export.layout.symmetry.name();
        let share = format_percent(asymmetry);
        remark(format!(
            "the light is less symmetric than `symmetry` says ({symmetry}): planes treated as equal differ from their mean by {share} \
                rms of the intensities, more than noise explains; choose a lower symmetry"
        ));
    }
    if let Some(Misfit { candela, angle_deg }) = misfit {
        let step = format_value(180.0 / export.layout.angle_segments as f64);
        let (candela, angle_deg) = (format_value(candela), format_value(angle_deg));
        remark(format!(
            "the light changes within the steps of the table ({step} deg): at {angle_deg} deg the table differs by {candela} cd from the mean \
                over a cell of the goniometer, which the errors in the files do not contain; smaller cells allow smaller steps"
        ));
    }
    let bias = readings.biases.iter().flatten().copied().fold(0.0, f64::max);
    if bias > 0.0 {
        let bias = format_value(bias);
        remark(format!(
            "cells of the goniometer have a bias of up to {bias} cd, which the errors in the files do not contain"
        ));
    }
    match export.opening {
        None => remark(
            "without the key `opening` they state a point, which has no luminance".to_owned(),
        ),
        Some(_) if upward_share > NEGLIGIBLE_FLUX => {
            let share = format_percent(upward_share);
            remark(format!(
                "{share} of the light leaves above 90 deg, which a flat opening cannot emit; no luminance is given"
            ));
        }
        Some(_) => {}
    }
    remarks
}

/// The colour of the light of the goniometer, if the sources have spectra.
fn colour(export: &LuminaireExport, measures: &Measures) -> LuminaireColour {
    let whole = |name: &str| {
        let measure = measures.values.get(&format!("{}.{name}", export.sensor));
        let known = measure.filter(|measure| measure.status == Status::Ok);
        known.map_or(String::new(), |measure| format!("{:.0}", measure.value))
    };
    let (temperature, rendering) = (whole("colour_temperature"), whole("colour_rendering_ra"));
    LuminaireColour { temperature, rendering }
}

/// Texts of the files: those of the user, and what is known without them.
fn texts(
    export: &LuminaireExport,
    origin: &LuminaireOrigin<'_>,
    distance_mm: Option<f64>,
    std_errors: &Array2<f64>,
) -> Vec<(String, String)> {
    let distance = distance_mm.map(|distance| format!("{} mm", format_value(distance)));
    // Formats may cut a text: what it means comes before names.
    let before = distance.as_ref().map_or(String::new(), |distance| format!("at {distance}, "));
    let error = std_errors.iter().copied().fold(0.0, f64::max);
    let error = error.is_finite().then(|| format_value(error));
    let LuminaireOrigin { title, hash, date, version } = *origin;
    let near = distance.map(|distance| {
        format!("intensities: illuminance at a distance of {distance} times distance squared")
    });
    let own = [
        ("TEST", Some(format!("scene {hash}, {before}sensor {}", export.sensor))),
        ("TESTLAB", Some(format!("computed by Lumiduct {version}, not measured"))),
        ("ISSUEDATE", date.map(str::to_owned)),
        ("LUMINAIRE", Some(title.to_owned())),
        ("OTHER", error.map(|error| format!("standard error of an intensity: at most {error} cd"))),
        ("OTHER", near),
    ];
    // OTHER may occur more than once.
    let is_given =
        |word: &str| word != "OTHER" && export.texts.iter().any(|(given, _)| given == word);
    let own = own.into_iter().filter(|(word, _)| !is_given(word));
    let own = own.filter_map(|(word, text)| Some((word.to_owned(), text?)));
    own.chain(export.texts.iter().cloned()).collect()
}
