//! Chromaticity of the light in the cells of a sensor (CIE 1976 u', v') and how even it is.

use crate::colour::Chromaticity;
use crate::measure::colour_spread::{NoisyColour, colour_spread};
use crate::measure::evidence::{Evidence, MIN_COUNTS, enough_batches};
use crate::measure::{Measure, Status};
use crate::scene::SensorId;
use crate::transport::CellStimuli;
use glam::{DMat2, DVec2, DVec3};
use indexmap::IndexMap;
use ndarray::Array2;
use serde::Serialize;
use std::ops::Range;

/// Cells with less than this share of the largest level do not count for the evenness of colours, 1 (ANSI/IES LM-79-19, section
/// 7.8: intensities below 10 % of the peak).
const LEAST_LEVEL: f64 = 0.1;

/// Chromaticities of cells, in the layout of the values beside them; NaN without light.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColourTable {
    /// CIE 1976 u', 1.
    pub u: Array2<f64>,
    /// CIE 1976 v', 1.
    pub v: Array2<f64>,
    /// Standard errors of u', 1.
    pub u_std_errors: Array2<f64>,
    /// Standard errors of v', 1.
    pub v_std_errors: Array2<f64>,
}

/// Colours of some cells of a sensor.
pub(crate) struct ColouredCells {
    cells: Vec<CellStimuli>,
    /// Largest standard error of a sum over itself that rounding may cause, 1.
    rounding: f64,
}

impl ColouredCells {
    /// The colours of some cells; `None` without spectra.
    pub(crate) fn of(evidence: &Evidence<'_>, id: SensorId, cells: Range<usize>) -> Option<Self> {
        let reading = &evidence.readings.sensors[id.index()];
        let colours = reading.colours.as_ref()?;
        let batches = evidence.readings.batch_count();
        let stimuli = |cell| colours.stimuli(cell, batches, reading.cells.mean(cell, batches));
        Some(Self { cells: cells.map(stimuli).collect(), rounding: evidence.rounding(1.0) })
    }

    /// As a table with this many columns.
    pub(crate) fn table(&self, columns: usize) -> ColourTable {
        let colours: Vec<Option<NoisyColour>> =
            self.cells.iter().map(|cell| self.noisy(cell)).collect();
        let table = |of: &dyn Fn(&NoisyColour) -> f64| {
            Array2::from_shape_fn((colours.len() / columns, columns), |(row, column)| {
                colours[row * columns + column].as_ref().map_or(f64::NAN, of)
            })
        };
        ColourTable {
            u: table(&|own| own.uv.x),
            v: table(&|own| own.uv.y),
            u_std_errors: table(&|own| own.covariance.x_axis.x.sqrt()),
            v_std_errors: table(&|own| own.covariance.y_axis.y.sqrt()),
        }
    }

    /// How far colours lie from their mean, by the last part of the names of these measures. Each cell has its level of light, by which it
    /// counts or not; `None` for those that never do.
    pub(crate) fn spread(
        &self,
        evidence: &Evidence<'_>,
        levels: impl Iterator<Item = Option<f64>> + Clone,
    ) -> IndexMap<String, Measure> {
        let most = levels.clone().flatten().fold(0.0, f64::max);
        let counts = |level: Option<f64>| level.is_some_and(|level| level >= LEAST_LEVEL * most);
        let cells = self.cells.iter().zip(levels).filter(|(_, level)| counts(*level));
        let cells: Vec<&CellStimuli> = cells.map(|(cell, _)| cell).collect();
        let mut status = enough_batches(evidence.readings.batch_count());
        if !cells.iter().all(|cell| is_known(cell)) {
            status = status.worst(Status::TooFew);
        }
        let unknown =
            |status| std::array::from_fn(|_| evidence.measure(0.0, f64::INFINITY, "1", status));
        let colours: Option<Vec<_>> = cells.into_iter().map(|cell| self.noisy(cell)).collect();
        let [largest, rms] = match colours {
            Some(colours)
                if most > 0.0 && !colours.iter().all(|own| own.covariance.is_finite()) =>
            {
                unknown(Status::TooFew)
            }
            Some(colours) if most > 0.0 => {
                let found = colour_spread(&colours);
                [found.largest, found.rms].map(|own| {
                    let status = status.worst(own.status);
                    let measure = evidence.measure(own.value, own.std_error, "1", status);
                    Measure { bias: own.bias, ..measure }
                })
            }
            _ => unknown(Status::NoSignal),
        };
        [("colour_nonuniformity", largest), ("colour_nonuniformity_rms", rms)]
            .map(|(name, measure)| (name.to_owned(), measure))
            .into()
    }

    /// The chromaticity of a cell, with its errors to first order; `None` without light.
    fn noisy(&self, cell: &CellStimuli) -> Option<NoisyColour> {
        let &CellStimuli { mean, covariance } = cell;
        let uv = DVec2::from_array(Chromaticity::from_tristimulus(mean.to_array())?.uv_1976());
        // u' = 4X/s and v' = 9Y/s with s = X + 15Y + 3Z (CIE 15:2018, eq. 8.2), so du' = (4 dX - u' ds)/s.
        let of_sum = DVec3::new(1.0, 15.0, 3.0);
        let sum = of_sum.dot(mean);
        let of_u = (4.0 * DVec3::X - uv.x * of_sum) / sum;
        let of_v = (9.0 * DVec3::Y - uv.y * of_sum) / sum;
        // What remains where all light of a cell has one colour is rounding.
        let variance = |of: DVec3| {
            let found = of.dot(covariance * of);
            let least = (self.rounding * of.abs().dot(mean)).powi(2);
            match found {
                // Of a single batch.
                _ if found.is_nan() => f64::INFINITY,
                _ if found > least => found,
                _ => 0.0,
            }
        };
        let [u, v] = [of_u, of_v].map(variance);
        let most = (u * v).sqrt();
        let both = of_u.dot(covariance * of_v);
        let both = if most.is_finite() { both.clamp(-most, most) } else { 0.0 };
        let weight_error = of_sum.dot(covariance * of_sum).max(0.0).sqrt();
        let covariance = DMat2::from_cols_array(&[u, both, both, v]);
        Some(NoisyColour { uv, covariance, weight: sum, weight_error })
    }
}

/// Whether the light of a cell is known well enough for an error of its colour.
fn is_known(cell: &CellStimuli) -> bool {
    MIN_COUNTS * cell.covariance.y_axis.y <= cell.mean.y * cell.mean.y
}
