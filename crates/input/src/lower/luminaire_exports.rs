//! Luminaire files that goniometers are to write.

use crate::export::{Exports, LuminaireExport};
use crate::keys::Key;
use crate::lower::context::Context;
use crate::problems::Problems;
use crate::spec::luminaire::{ExportFormat, ExportPhotometry, ExportSymmetry, LuminaireExportSpec};
use crate::spec::sensor::SensorSpec;
use crate::spec::sweep::AreaSpec;
use lumiduct_base::units::FluxUnit;
use lumiduct_core::scene::{Goniometer, Scene};
use lumiduct_files::luminaire::{LuminaireFormat, Opening, PlaneSymmetry, TableLayout, is_keyword};

/// Notes luminaire files from spheres of finite radius.
pub(super) fn note_distances(scene: &Scene, exports: &Exports, problems: &mut Problems) {
    for export in &exports.luminaires {
        let key = Key::of(&["sensors", &export.sensor, "luminaire"]);
        for remark in export.remarks_on_distance(scene) {
            problems.warning(&key, remark);
        }
    }
}

impl Context<'_> {
    /// Notes the files that a sensor is to write.
    pub(super) fn lower_luminaire_export(
        &mut self,
        name: &str,
        spec: &SensorSpec,
        goniometer: Option<&Goniometer>,
        key: &Key,
    ) -> Option<()> {
        let own = spec.luminaire.as_ref()?;
        let key = key.field("luminaire");
        if spec.goniometer.is_none() {
            let message = "is for a `goniometer` only";
            return self.refuse(&key, message, "remove it, or add a sensor with a `goniometer`");
        }
        if self.builder.scene().unit == FluxUnit::Watt {
            let message =
                "a luminaire file has luminous intensities, but the fluxes of the scene are in W";
            return self.refuse(&key, message, "give the flux of the sources in lm");
        }
        self.check_keywords(own, &key);
        if own.lamps.is_some() && own.photometry == ExportPhotometry::Absolute {
            let message = "has no meaning with absolute photometry";
            let hint = "add photometry = \"relative\", or remove `lamps`";
            self.problems.error(&key.field("lamps"), message).hint(hint);
        }
        let mut media = self.builder.scene().media.iter();
        if own.photometry == ExportPhotometry::Relative
            && media.any(|own| own.fluorescence().is_some())
        {
            let message =
                "has no meaning where media fluoresce: they change the lumens of the lamp";
            let hint = "write photometry = \"absolute\"";
            return self.refuse(&key.field("photometry"), message, hint);
        }
        let goniometer = goniometer?;
        let finest = LuminaireExport::of_goniometer(name, goniometer);
        let layout = self.layout(own, &finest.layout, goniometer, &key)?;
        let formats: Vec<LuminaireFormat> = own
            .formats
            .iter()
            .map(|format| match format {
                ExportFormat::Ies => LuminaireFormat::Ies,
                ExportFormat::Ies2019 => LuminaireFormat::Ies2019,
                ExportFormat::Ldt => LuminaireFormat::Ldt,
                ExportFormat::Tm33 => LuminaireFormat::Tm33,
            })
            .collect();
        self.check_file_names(name, &formats, &key.field("formats"));
        let opening = own.opening.as_ref();
        let opening = opening.map(|area| self.luminous_opening(area, &key.field("opening")));
        if matches!(opening, Some(None)) {
            return None;
        }
        self.exports.luminaires.push(LuminaireExport {
            formats,
            layout,
            lamps: (own.photometry == ExportPhotometry::Relative).then_some(own.lamps.unwrap_or(1)),
            opening: opening.flatten(),
            power_w: own.power_w.unwrap_or(0.0),
            texts: own.texts.iter().map(|(word, text)| (word.clone(), text.clone())).collect(),
            ..finest
        });
        Some(())
    }

    /// Refuses formats whose files would have one name.
    fn check_file_names(&mut self, sensor: &str, formats: &[LuminaireFormat], key: &Key) {
        for (place, format) in formats.iter().enumerate() {
            let ending = format.ending();
            if formats[..place].iter().any(|before| before.ending() == ending) {
                let message = format!("two of them would write `{sensor}.{ending}`");
                self.problems.error(key, message).hint("give one of them");
            }
        }
    }

    /// The layout of the table, if the goniometer has cells for it.
    fn layout(
        &mut self,
        spec: &LuminaireExportSpec,
        finest: &TableLayout,
        goniometer: &Goniometer,
        key: &Key,
    ) -> Option<TableLayout> {
        let symmetry = spec.symmetry.map_or(finest.symmetry, |symmetry| match symmetry {
            ExportSymmetry::None => PlaneSymmetry::None,
            ExportSymmetry::Rotational => PlaneSymmetry::Rotational,
            ExportSymmetry::Quadrants => PlaneSymmetry::Quadrants,
            ExportSymmetry::AboutC0 => PlaneSymmetry::AboutC0,
            ExportSymmetry::AboutC90 => PlaneSymmetry::AboutC90,
        });
        let segments = |context: &mut Self,
                        step: Option<f64>,
                        full: f64,
                        finest: usize,
                        name: &str| match step {
            Some(step) => {
                context.steps(step, full, &key.field(name)).map(|count| count.round() as usize)
            }
            None => Some(finest),
        };
        let angle_segments =
            segments(self, spec.gamma_step_deg, 180.0, finest.angle_segments, "gamma_step_deg");
        let plane_segments =
            segments(self, spec.c_step_deg, 360.0, finest.plane_segments, "c_step_deg");
        let layout = TableLayout {
            symmetry,
            angle_segments: angle_segments?,
            plane_segments: plane_segments?,
        };
        let &Goniometer { c_cells, gamma_cells, .. } = goniometer;
        match layout.expect_cells([gamma_cells, c_cells]) {
            Ok(()) => Some(layout),
            Err(error) => {
                let hint = "give smaller steps to the goniometer, larger ones to the table, or another symmetry";
                self.refuse(key, error.to_string(), hint)
            }
        }
    }

    /// Refuses keywords that no file may have, and texts of more than one line.
    fn check_keywords(&mut self, spec: &LuminaireExportSpec, key: &Key) {
        for (word, text) in &spec.texts {
            let key = key.field("texts").field(word);
            if !is_keyword(word) {
                let message = "is not a keyword for a text in LM-63";
                let hint = "use at most 18 capital letters, digits, - and _, such as MANUFAC";
                self.problems.error(&key, message).hint(hint);
            }
            if text.chars().any(char::is_control) {
                let message = "must be a single line without control characters";
                self.problems.error(&key, message);
            }
        }
    }

    fn luminous_opening(&mut self, area: &AreaSpec, key: &Key) -> Option<Opening> {
        match (area.rectangle, area.disk) {
            (Some(own), None) => Some(Opening {
                is_round: false,
                along_c0_mm: own.width_mm,
                along_c90_mm: own.height_mm,
                height_mm: 0.0,
            }),
            (None, Some(disk)) => {
                let diameter = 2.0 * disk.radius_mm;
                Some(Opening {
                    is_round: true,
                    along_c0_mm: diameter,
                    along_c90_mm: diameter,
                    height_mm: 0.0,
                })
            }
            (None, None) | (Some(_), Some(_)) => {
                let message = "needs exactly one of `rectangle`, `disk`";
                self.refuse(key, message, "such as disk = { radius_mm = 30 }")
            }
        }
    }
}
