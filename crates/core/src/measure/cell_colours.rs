//! Chromaticity of the light in the cells of a sensor (CIE 1976 u', v') and how even it is.

#[cfg(test)]
mod tests;

use crate::colour::Chromaticity;
use crate::measure::colour_spread::{
    CorrectedDistance, NoisyColour, WeightedColour, colour_spread, denoised_spread,
};
use crate::measure::evidence::{Evidence, MIN_COUNTS, enough_batches};
use crate::measure::noisy::Noisy;
use crate::measure::{Measure, Status};
use crate::scene::SensorId;
use crate::transport::NoisyStimuli;
use glam::{DMat3, DVec2, DVec3};
use ndarray::Array2;
use serde::Serialize;
use std::ops::Range;

/// What the names of the measures here begin with.
pub(crate) const NONUNIFORMITY: &str = "colour_nonuniformity";
/// Cells with less than this share of the largest level do not count for the evenness of colours, 1 (IES LM-79-08, section 12.5: angles with
/// less than 10 % of the peak intensity).
const LEAST_LEVEL: f64 = 0.1;
/// Fewest counts of a map whose colours have known errors. A colour that makes up one in this many counts is missing from n counts with
/// probability e^(-n/50); the covariance of all cells takes this share in that of a cell.
const COLOUR_COUNTS: f64 = 50.0;

/// The sum s = X + 15Y + 3Z that chromaticities u', v' are divided by (CIE 15:2018, eq. 8.2).
const OF_SUM: DVec3 = DVec3::new(1.0, 15.0, 3.0);
/// Covariance of what is not known.
const UNKNOWN: DMat3 = DMat3::from_cols(DVec3::INFINITY, DVec3::INFINITY, DVec3::INFINITY);

/// Chromaticities of cells, in the layout of the values beside them; NaN without light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColourTable {
    /// CIE 1976 u', 1.
    pub u: Array2<f64>,
    /// CIE 1976 v', 1.
    pub v: Array2<f64>,
    /// Standard errors of u', 1; infinite where too little was counted to know them.
    pub u_std_errors: Array2<f64>,
    /// Standard errors of v', 1, likewise.
    pub v_std_errors: Array2<f64>,
}

/// Colours of some cells of a sensor, each `None` without light.
pub(crate) struct CellColours(Vec<Option<NoisyColour>>);

impl CellColours {
    /// Those of cells of a sensor in all light; `None` without spectra.
    pub(crate) fn of(evidence: &Evidence<'_>, id: SensorId, cells: Range<usize>) -> Option<Self> {
        let stimuli = evidence.readings.sensors[id.index()].stimuli.as_ref()?;
        let batches = evidence.readings.batch_count();
        let cells: Vec<NoisyStimuli> = cells.map(|cell| stimuli.mean(cell, batches)).collect();
        Some(Self::new(&cells, evidence.rounding(1.0)))
    }

    /// Those of some stimuli. Standard errors below `rounding`, relative to a sum, 1, are what rounding may cause.
    ///
    /// A cell with few counts may lack a colour by chance, and then its covariance lacks it too. So the covariance of all cells, scaled to the
    /// luminous flux of the cell, takes a share, which is larger the fewer the counts are.
    fn new(cells: &[NoisyStimuli], rounding: f64) -> Self {
        let all: DVec3 = cells.iter().map(|own| own.mean).sum();
        let covariance = cells.iter().fold(DMat3::ZERO, |sum, own| sum + own.covariance);
        let per_flux = covariance * all.y.recip();
        // Flux of one count: n counts have a mean of n and a variance of n squares.
        let count = per_flux.y_axis.y;
        let are_enough = all.y >= COLOUR_COUNTS * count;
        // With less, the sum that chromaticities are divided by has an error above 32 % in light of the mean colour.
        let sum = OF_SUM.dot(all / all.y);
        let least = MIN_COUNTS * OF_SUM.dot(per_flux * OF_SUM) / (sum * sum);
        let noisy = |own: &NoisyStimuli| {
            let counts = (own.mean.y / count).max(0.0);
            let share_of_all = if count > 0.0 { (-counts / COLOUR_COUNTS).exp() } else { 0.0 };
            let of_all = per_flux * own.mean.y.max(0.0);
            let covariance = (1.0 - share_of_all) * own.covariance + share_of_all * of_all;
            let colour = colour_of(&NoisyStimuli { covariance, ..*own }, rounding)?;
            let is_known = are_enough && own.mean.y >= least && colour.covariance.is_finite();
            Some(if is_known { colour } else { NoisyColour { covariance: UNKNOWN, ..colour } })
        };
        Self(cells.iter().map(noisy).collect())
    }

    /// As a table with this many columns.
    pub(crate) fn table(&self, columns: usize) -> ColourTable {
        let table = |of: &dyn Fn(&NoisyColour) -> f64| {
            Array2::from_shape_fn((self.0.len() / columns, columns), |(row, column)| {
                self.0[row * columns + column].as_ref().map_or(f64::NAN, of)
            })
        };
        ColourTable {
            u: table(&|own| own.read.uv.x),
            v: table(&|own| own.read.uv.y),
            u_std_errors: table(&|own| own.covariance.x_axis.x.sqrt()),
            v_std_errors: table(&|own| own.covariance.y_axis.y.sqrt()),
        }
    }

    /// How far colours lie from their mean, by the last part of the names of these measures. Each cell has its level of light, by which it
    /// counts or not; `None` for those that never do.
    pub(crate) fn spread(
        &self,
        evidence: &Evidence<'_>,
        levels: &[Option<Noisy>],
    ) -> [(String, Measure); 2] {
        let status = enough_batches(evidence.readings.batch_count());
        let [largest, rms] = self.distances(levels).map(|own| {
            let status = status.worst(own.status);
            let measure = evidence.measure(own.value, own.std_error, "1", status);
            Measure { bias: own.bias, ..measure }
        });
        [(NONUNIFORMITY.to_owned(), largest), (format!("{NONUNIFORMITY}_rms"), rms)]
    }

    /// The largest distance and the root mean square.
    fn distances(&self, levels: &[Option<Noisy>]) -> [CorrectedDistance; 2] {
        let unknown = |status| {
            [CorrectedDistance { value: 0.0, std_error: f64::INFINITY, bias: None, status }; 2]
        };
        let brightest = levels.iter().flatten().max_by(|a, b| a.value.total_cmp(&b.value));
        let Some(brightest) = brightest.filter(|own| own.value > 0.0) else {
            return unknown(Status::NoSignal);
        };
        if levels.iter().flatten().any(|level| !level.std_error.is_finite()) {
            return unknown(Status::TooFew);
        }
        // The cells that count if levels are this many errors higher.
        let counting = |errors: f64| -> Option<Vec<NoisyColour>> {
            let counts = |level: &Option<Noisy>| {
                level.is_some_and(|level| {
                    let error = level.std_error.hypot(LEAST_LEVEL * brightest.std_error);
                    level.value + errors * error >= LEAST_LEVEL * brightest.value
                })
            };
            let cells = self.0.iter().zip(levels).filter(|(_, level)| counts(level));
            cells.map(|(colour, _)| colour.filter(|own| own.covariance.is_finite())).collect()
        };
        let Some(colours) = counting(0.0) else { return unknown(Status::TooFew) };
        if colours.len() < 2 {
            return unknown(Status::Undefined);
        }
        let found = colour_spread(&colours);
        // Levels have errors as well: what other cells would change is a possible bias.
        let [Some(fewer), Some(more)] = [-1.0, 1.0].map(counting) else {
            return unknown(Status::TooFew);
        };
        let read = denoised_spread(&colours);
        // There is none where not even the brightest cell counts for certain.
        let others = [&fewer, &more].map(|own| denoised_spread(own));
        let found = [found.largest, found.rms];
        std::array::from_fn(|place| {
            let own = found[place];
            let change = others.map(|other| (other[place] - read[place]).abs());
            let change = change.into_iter().fold(0.0, f64::max);
            let bias = own.bias.unwrap_or(0.0).hypot(change);
            CorrectedDistance { bias: (bias > 0.0).then_some(bias), ..own }
        })
    }
}

/// The chromaticity of stimuli, with its errors to first order; `None` without light.
fn colour_of(
    &NoisyStimuli { mean, covariance }: &NoisyStimuli,
    rounding: f64,
) -> Option<NoisyColour> {
    let uv = DVec2::from_array(Chromaticity::from_tristimulus(mean.to_array())?.uv_1976());
    // u' = 4X/s and v' = 9Y/s, so du' = (4 dX - u' ds)/s.
    let sum = OF_SUM.dot(mean);
    if sum <= 0.0 || mean.y <= 0.0 {
        return None;
    }
    let of = [4.0 * DVec3::X - uv.x * OF_SUM, 9.0 * DVec3::Y - uv.y * OF_SUM, OF_SUM];
    let of = of.map(|own| own / sum);
    let covariance =
        DMat3::from_cols_array_2d(&of.map(|one| of.map(|other| one.dot(covariance * other))));
    // What remains where all light of a cell has one colour is rounding.
    let kept = of.map(|own| own.abs().dot(mean) * rounding);
    let is_rounding = |axis: usize| covariance.col(axis)[axis] <= kept[axis] * kept[axis];
    let known = DVec3::from_array(std::array::from_fn(|axis| f64::from(!is_rounding(axis))));
    let covariance = DMat3::from_diagonal(known) * covariance * DMat3::from_diagonal(known);
    Some(NoisyColour { read: WeightedColour { uv, weight: sum }, covariance })
}
