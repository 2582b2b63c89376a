//! Files that sensors are to write.

use lumiduct_base::number::format_value;
use lumiduct_core::scene::{Goniometer, Scene, SensorId, SensorKind};
use lumiduct_files::luminaire::{LuminaireFormat, Opening, TableLayout};
use lumiduct_files::rays::RayFormat;

/// Distance from which the inverse-square law holds within 1 % for uniform luminance, in largest dimensions of the source
/// (ANSI/IES LS-1, definition 9.1.1, inverse-square law).
const LEAST_DISTANCE: f64 = 5.0;

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
            formats: Vec::new(),
            layout: TableLayout::finest([gamma_cells, c_cells]),
            lamps: None,
            opening: None,
            power_w: 0.0,
            texts: Vec::new(),
        }
    }

    /// Sentences for the user on files from a sphere of finite radius in its scene; none in the far field.
    pub fn remarks_on_distance(&self, scene: &Scene) -> Vec<String> {
        let own = scene.sensors.iter().find(|sensor| sensor.name == self.sensor);
        let goniometer = own.and_then(|sensor| match &sensor.kind {
            SensorKind::Goniometer(goniometer) => Some(goniometer),
            SensorKind::Surface(_) => None,
        });
        let Some((goniometer, radius)) = goniometer.and_then(|own| Some((own, own.radius?))) else {
            return Vec::new();
        };
        let ratio = self.opening.map(|opening| radius / largest_dimension(&opening));
        let beside = ratio.map_or(String::new(), |ratio| {
            let ratio = format_value(ratio);
            format!(", {ratio} times the largest dimension of the luminous opening")
        });
        let caution = match ratio {
            Some(ratio) if ratio >= LEAST_DISTANCE => {
                "the far field of a narrow beam may still differ".to_owned()
            }
            Some(_) => format!("those of the far field need {LEAST_DISTANCE} times or more"),
            None => format!(
                "those of the far field need {LEAST_DISTANCE} times the largest dimension of the luminous opening or more"
            ),
        };
        let distance = format_value(radius);
        let mut remarks = vec![format!(
            "its files have the intensities at a distance of {distance} mm{beside}; {caution}"
        )];
        if !scene.lies_within(goniometer.frame.origin, radius) {
            remarks.push(
                "the boxes around all parts of the scene do not lie within its sphere: light that starts outside of it is \
                    missing in the intensities, and light that returns into it counts again when it leaves"
                    .to_owned(),
            );
        }
        remarks
    }
}

/// Diameter or diagonal of an opening, mm.
fn largest_dimension(opening: &Opening) -> f64 {
    let &Opening { is_round, along_c0_mm, along_c90_mm, height_mm } = opening;
    let across =
        if is_round { along_c0_mm.max(along_c90_mm) } else { along_c0_mm.hypot(along_c90_mm) };
    across.hypot(height_mm)
}
