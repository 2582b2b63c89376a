//! Files that sensors are to write.

use lumiduct_core::scene::{Goniometer, SensorId};
use lumiduct_files::luminaire::{LuminaireFormat, Opening, TableLayout};
use lumiduct_files::rays::RayFormat;

/// The files that the sensors of a scene are to write.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Exports {
    /// Luminaire files.
    pub luminaires: Vec<LuminaireExport>,
    /// Ray files.
    pub rays: Vec<RayExport>,
}

/// Ray files to write from a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct RayExport {
    /// The sensor.
    pub sensor: SensorId,
    /// The formats.
    pub formats: Vec<RayFormat>,
    /// Number of rays.
    pub count: usize,
}

/// Luminaire files to write from a goniometer.
#[derive(Debug, Clone, PartialEq)]
pub struct LuminaireExport {
    /// Name of the sensor.
    pub sensor: String,
    /// The formats.
    pub formats: Vec<LuminaireFormat>,
    /// Layout of the table.
    pub layout: TableLayout,
    /// Number of lamps, if intensities refer to lamps with the flux of all sources.
    pub lamps: Option<u32>,
    /// The luminous opening; `None` for a point.
    pub opening: Option<Opening>,
    /// Input power, W; 0 if it is not known.
    pub power_w: f64,
    /// Texts by their keyword.
    pub texts: Vec<(String, String)>,
}

impl LuminaireExport {
    /// The finest table, in the formats that are written without the key `formats`.
    pub fn of_goniometer(sensor: &str, goniometer: &Goniometer) -> Self {
        let &Goniometer { c_cells, gamma_cells, .. } = goniometer;
        Self {
            sensor: sensor.to_owned(),
            formats: vec![LuminaireFormat::Ies, LuminaireFormat::Ldt],
            layout: TableLayout::finest([gamma_cells, c_cells]),
            lamps: None,
            opening: None,
            power_w: 0.0,
            texts: Vec::new(),
        }
    }
}
