//! What a luminaire file says.

use crate::luminaire::error::LuminaireError;
use crate::luminaire::format::LuminaireFormat;
use crate::luminaire::generation::FileGeneration;
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use lumiduct_base::number::format_value;

/// A luminaire or lamp: its light, its luminous opening and what else its file says.
#[derive(Debug, Clone, PartialEq)]
pub struct Luminaire {
    /// Texts by their keyword in LM-63, in the order of the file: `TEST`, `MANUFAC`, ... A keyword may occur more than once.
    pub texts: Vec<(String, String)>,
    /// How the intensities were obtained.
    pub generation: FileGeneration,
    /// The lamps that the intensities belong to.
    pub lamps: LampFlux,
    /// Input power, W; 0 if it is not known.
    pub power_w: f64,
    /// The luminous opening.
    pub opening: Opening,
    /// The colour of the light.
    pub colour: LuminaireColour,
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

/// Colour temperatures that a text may state, K.
const COLOUR_TEMPERATURES: [f64; 2] = [1000.0, 100_000.0];
/// Colour rendering indices, and not groups of them, that a text may state, 1.
const RENDERING_INDICES: [f64; 2] = [5.0, 100.0];

/// The colour of light in the words of a file, empty where it is not known.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LuminaireColour {
    /// Correlated colour temperature: `3000`, `3000 K`, `warm white`.
    pub temperature: String,
    /// Colour rendering: an index such as `82`, or a group such as `1B`.
    pub rendering: String,
}

impl LuminaireColour {
    /// Correlated colour temperature, K; `None` if the words state none.
    pub fn temperature_k(&self) -> Option<f64> {
        let number = self.temperature.trim_end_matches(['K', 'k', ' ']);
        within(number, COLOUR_TEMPERATURES)
    }

    /// General colour rendering index Ra, 1; `None` if the words state none, but a group or a bound.
    pub fn rendering_ra(&self) -> Option<f64> {
        within(&self.rendering, RENDERING_INDICES)
    }
}

fn within(number: &str, [least, most]: [f64; 2]) -> Option<f64> {
    number.trim().parse().ok().filter(|number| (least..=most).contains(number))
}

/// A luminaire as read, with what was assumed or left out.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadLuminaire {
    /// The luminaire.
    pub luminaire: Luminaire,
    /// Line of the first intensity, from 1.
    pub table_line: usize,
    /// Sentences for the user, in the order of the file.
    pub remarks: Vec<String>,
}

/// Spread of the planes at a pole that measurement may leave, as a share of the largest value there, 1.
const POLE_SPREAD: f64 = 0.02;
/// Share of the peak below which values at a pole need no care, 1.
const DARK_POLE: f64 = 1e-3;

/// Light output ratio above which a file contradicts itself, 1.
const MOST_OUTPUT: f64 = 1.02;
/// Light output ratio that only a wrong unit or a wrong flux of the lamps can give, 1.
const IMPOSSIBLE_OUTPUT: f64 = 10.0;
/// Longest opening of a luminaire, mm; beyond it a remark is due.
const LONGEST_OPENING: f64 = 10_000.0;

impl ReadLuminaire {
    /// A luminaire with remarks, and further ones on its light and its size.
    pub(crate) fn new(
        luminaire: Luminaire,
        format: LuminaireFormat,
        table_line: usize,
        mut remarks: Vec<String>,
    ) -> Result<Self, LuminaireError> {
        let Luminaire { intensities, .. } = &luminaire;
        let ends = |all: &[f64]| [all[0], all[all.len() - 1]];
        let [low, high] = ends(intensities.angles_deg());
        if !(low == 0.0 || low == 90.0) || !(high == 90.0 || high == 180.0) {
            let range = format!("angles go from {low}° to {high}°");
            remarks.push(format!("{range}; beyond them the light is taken as 0"));
        }
        let planes = intensities.planes_deg();
        let step = planes.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        let [first, last] = ends(planes);
        let gap = first + 360.0 - last;
        if intensities.symmetry() == PlaneSymmetry::None && planes.len() > 1 && gap > step {
            remarks.push(format!(
                "no plane lies between {last}° and 360°; the light there is interpolated"
            ));
        }
        if intensities.flux() == 0.0 {
            remarks.push(format!("there is no light in the table from line {table_line} on"));
        }
        if let Some(ratio) = luminaire.light_output_ratio().filter(|ratio| *ratio > MOST_OUTPUT) {
            let percent = 100.0 * ratio;
            let text = format!("the luminaire sends {percent:.0} % of the light of its lamps");
            if ratio > IMPOSSIBLE_OUTPUT {
                let problem = format!("{text}; correct the flux of its lamps or the multiplier");
                return Err(LuminaireError::Violated { format, line: table_line, problem });
            }
            remarks.push(text);
        }
        let Opening { along_c0_mm, along_c90_mm, height_mm, .. } = luminaire.opening;
        let longest = along_c0_mm.max(along_c90_mm).max(height_mm);
        if longest > LONGEST_OPENING {
            let metres = longest / 1000.0;
            remarks.push(format!(
                "the luminous opening is {metres} m long; check the unit of its size"
            ));
        }
        Ok(Self { luminaire, table_line, remarks })
    }
}

/// Remarks where C planes disagree in the directions that all of them share.
pub(crate) fn pole_remarks(intensities: &Intensities) -> impl Iterator<Item = String> {
    let angles = intensities.angles_deg();
    let planes = || (0..intensities.planes_deg().len()).map(|plane| intensities.plane(plane));
    let peak = planes().flatten().copied().fold(0.0, f64::max);
    let poles = [(0, 0.0, "nadir"), (angles.len() - 1, 180.0, "zenith")];
    poles.into_iter().filter(|(place, angle, _)| angles[*place] == *angle).filter_map(
        move |(place, angle, name)| {
            let values = planes().map(|plane| plane[place]);
            let [low, high] = values.fold([f64::INFINITY, 0.0], |[low, high], value| {
                [low.min(value), high.max(value)]
            });
            (high - low > POLE_SPREAD * high && high > DARK_POLE * peak).then(|| {
                let [low, high] = [low, high].map(format_value);
                format!(
                    "the planes disagree at {angle}° ({name}), which is a single direction: {low} to {high} cd; each plane is used as given"
                )
            })
        },
    )
}

/// The input power, W; 0 with a remark for a negative one.
pub(crate) fn known_power(power_w: f64, remarks: &mut Vec<String>) -> f64 {
    if power_w < 0.0 {
        remarks.push(format!("a power of {power_w} W is taken as not known"));
    }
    power_w.max(0.0)
}

/// A luminaire as written, with what the format cannot hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrittenLuminaire {
    /// The text of the file, in UTF-8.
    pub text: String,
    /// Sentences for the user.
    pub remarks: Vec<String>,
}
