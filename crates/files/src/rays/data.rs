//! What ray files hold.

use lumiduct_base::number::{format_percent, format_value};
use lumiduct_base::units::FluxUnit;

/// Largest coordinate, mm.
const MOST_MM: f32 = 1e7;
/// Largest flux of a ray, lm or W: that of the brightest scene. Sums of it, too, are finite in single precision.
pub(crate) const MOST_FLUX: f32 = 1e30;
/// Relative difference between the flux that a file states and that of its rays that needs no remark, 1.
const SAME_FLUX: f64 = 0.01;
/// Largest deviation of a direction's length from 1.
const UNIT_WITHIN: f32 = 1e-3;

/// One ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileRay {
    /// Start, mm.
    pub position_mm: [f32; 3],
    /// Unit vector.
    pub direction: [f32; 3],
    /// Flux, in the unit of its file.
    pub flux: f32,
}

/// What a file says of its rays.
#[derive(Debug, Clone, PartialEq)]
pub struct RaySetInfo {
    /// Number of rays.
    pub count: u64,
    /// Unit of their fluxes.
    pub unit: FluxUnit,
    /// Flux of all of them, in this unit; 0 if the file does not state it.
    pub flux: f64,
    /// Luminous flux that a file with radiant rays states beside, lm.
    pub luminous_flux_lm: Option<f64>,
    /// Whether the rays were measured, not computed, as far as the file says.
    pub is_measured: bool,
    /// Texts.
    pub texts: Vec<(RayText, String)>,
}

/// The texts of TM-25, in their order (IES TM-25-13, section 4.7.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayText {
    /// Name of the light source.
    Name,
    /// Its manufacturer.
    Manufacturer,
    /// Who made the model of the light source.
    ModelCreator,
    /// Who made the file.
    Creator,
    /// Equipment that measured, or program that computed.
    Equipment,
    /// Camera.
    Camera,
    /// How the light source was operated.
    Operation,
    /// Anything else.
    Information,
    /// Where data come from.
    Reference,
}

impl RayText {
    /// All of them, in order.
    pub const ALL: [Self; 9] = [
        Self::Name,
        Self::Manufacturer,
        Self::ModelCreator,
        Self::Creator,
        Self::Equipment,
        Self::Camera,
        Self::Operation,
        Self::Information,
        Self::Reference,
    ];

    /// A word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Name => "name",
            Self::Manufacturer => "manufacturer",
            Self::ModelCreator => "model by",
            Self::Creator => "file by",
            Self::Equipment => "equipment",
            Self::Camera => "camera",
            Self::Operation => "operation",
            Self::Information => "information",
            Self::Reference => "reference",
        }
    }
}

impl RaySetInfo {
    /// A text, if it is there.
    pub fn text(&self, kind: RayText) -> Option<&str> {
        self.texts.iter().find(|(own, _)| *own == kind).map(|(_, text)| text.as_str())
    }

    /// A remark if the flux that the file states is not that of its rays, in the same unit: a sentence without a full stop.
    pub fn remark_on_flux(&self, of_rays: f64) -> Option<String> {
        let off = (self.flux / of_rays - 1.0).abs();
        (self.flux > 0.0 && off > SAME_FLUX).then(|| {
            let [stated, sum] = [self.flux, of_rays].map(format_value);
            let (unit, off) = (self.unit.flux(), format_percent(off));
            format!("its header states {stated} {unit}, {off} from the {sum} {unit} of its rays, which count")
        })
    }
}

impl FileRay {
    /// The ray of seven numbers, its direction with a length of 1; or what is wrong with it.
    pub(crate) fn checked(numbers: [f32; 7]) -> Result<Self, String> {
        let [x, y, z, dx, dy, dz, flux] = numbers;
        if let Some(wrong) = numbers.iter().find(|number| !number.is_finite()) {
            return Err(format!("one of its numbers is {wrong}"));
        }
        if let Some(far) = [x, y, z].into_iter().find(|own| own.abs() > MOST_MM) {
            return Err(format!("it starts at {far} mm; at most {MOST_MM:e} mm can be used"));
        }
        if flux < 0.0 {
            return Err(format!("its flux is {flux}; a flux cannot be negative"));
        }
        if flux > MOST_FLUX {
            return Err(format!("its flux is {flux:e}; at most {MOST_FLUX:e} can be used"));
        }
        let [dx64, dy64, dz64] = [dx, dy, dz].map(f64::from);
        let length = (dx64 * dx64 + dy64 * dy64 + dz64 * dz64).sqrt();
        if (length - 1.0).abs() > f64::from(UNIT_WITHIN) {
            return Err(format!(
                "its direction has a length of {length:.4}; a unit vector is needed"
            ));
        }
        // Single precision leaves unit vectors as they are, to a few times its rounding.
        let is_unit = (length - 1.0).abs() < 4.0 * f64::from(f32::EPSILON);
        let direction = if is_unit {
            [dx, dy, dz]
        } else {
            [dx64, dy64, dz64].map(|own| (own / length) as f32)
        };
        Ok(Self { position_mm: [x, y, z], direction, flux })
    }

    /// Its seven numbers.
    pub(crate) fn numbers(&self) -> [f32; 7] {
        let ([x, y, z], [dx, dy, dz]) = (self.position_mm, self.direction);
        [x, y, z, dx, dy, dz, self.flux]
    }
}
