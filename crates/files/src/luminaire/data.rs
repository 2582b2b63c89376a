//! What a luminaire file says.

use crate::luminaire::intensities::Intensities;

/// A luminaire or lamp: its light, its luminous opening and what else its file says.
#[derive(Debug, Clone, PartialEq)]
pub struct Luminaire {
    /// Texts by their keyword in LM-63, in the order of the file: `TEST`, `MANUFAC`, ... A keyword may occur more than once.
    pub texts: Vec<(String, String)>,
    /// The lamps that the intensities belong to.
    pub lamps: LampFlux,
    /// Input power, W; 0 if it is not known.
    pub power_w: f64,
    /// The luminous opening.
    pub opening: Opening,
    /// Luminous intensities with these lamps.
    pub intensities: Intensities,
}

/// The flux of the lamps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LampFlux {
    /// Not known: the photometry is absolute.
    Absolute,
    /// The photometry is relative to lamps of this number and total flux.
    Relative {
        /// Number of lamps.
        count: u32,
        /// Flux of all lamps, lm.
        flux_lm: f64,
    },
}

/// The luminous opening, seen from the middle of the luminaire.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Opening {
    /// Whether it is round: an ellipse or, with equal axes, a circle.
    pub is_round: bool,
    /// Size along the axis from C0 to C180, mm.
    pub along_c0_mm: f64,
    /// Size along the axis from C90 to C270, mm.
    pub along_c90_mm: f64,
    /// Height, mm.
    pub height_mm: f64,
}

impl Luminaire {
    /// The first text of a keyword.
    pub fn text(&self, keyword: &str) -> Option<&str> {
        self.texts.iter().find(|(own, _)| own == keyword).map(|(_, text)| text.as_str())
    }

    /// Flux of the luminaire over that of its lamps, 1; `None` where that is not known.
    pub fn light_output_ratio(&self) -> Option<f64> {
        match self.lamps {
            LampFlux::Absolute => None,
            LampFlux::Relative { flux_lm, .. } => Some(self.intensities.flux() / flux_lm),
        }
    }
}

/// A luminaire as read, with what was assumed or left out.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadLuminaire {
    /// The luminaire.
    pub luminaire: Luminaire,
    /// Sentences for the user, in the order of the file.
    pub remarks: Vec<String>,
}

impl ReadLuminaire {
    /// A luminaire with remarks, and one more where its angles leave out a part of a half-space.
    pub(crate) fn new(luminaire: Luminaire, mut remarks: Vec<String>) -> Self {
        let angles = luminaire.intensities.angles_deg();
        let [low, high] = [angles[0], angles[angles.len() - 1]];
        if !(low == 0.0 || low == 90.0) || !(high == 90.0 || high == 180.0) {
            remarks.push(format!(
                "angles go from {low}° to {high}°; beyond them the light is taken as 0"
            ));
        }
        Self { luminaire, remarks }
    }
}
