//! The cells of a surface sensor, or the pixels of its image: flux, area, and the noise of both together.
//!
//! A cell's error is that of the mean over batches; cells are taken as independent. Cells without area are not part
//! of the sensor. The area of a pixel is the aperture times its projected solid angle, in mm² sr. Cells cut by its rim to less than half of the largest cell's area hold few counts: they belong to
//! maps and averages, but extremes are not taken of them.

use crate::measure::evidence::Evidence;
use crate::measure::extremes::Noisy;
use crate::scene::{Seeing, SensorId, SurfaceSensor};
use crate::units::MM2_PER_M2;
use std::borrow::Cow;

/// Cells with less than this share of the largest cell's area are not part of the sensor.
const NO_AREA: f64 = 1e-9;
/// Cells with at least this share count for the extremes.
const ENOUGH_AREA: f64 = 0.5;

/// The cells of one view.
pub(crate) struct SensorCells<'a> {
    /// Mean flux per cell with its standard error, lm or W.
    flux: Vec<(f64, f64)>,
    /// Area per cell, mm², or mm² sr.
    pub(crate) areas: Cow<'a, [f64]>,
    largest: f64,
    pub(crate) area: f64,
    /// From flux per area to the unit of the map.
    pub(crate) factor: f64,
    /// Flux of one count, lm or W.
    count: f64,
    /// Whether this is all light that the sensor counts.
    pub(crate) all_light: bool,
}

impl<'a> SensorCells<'a> {
    pub(crate) fn of(
        evidence: &Evidence<'_>,
        id: SensorId,
        sensor: &'a SurfaceSensor,
        view: Option<usize>,
    ) -> Self {
        let areas = match &sensor.seeing {
            Seeing::All | Seeing::Views(_) => Cow::Borrowed(&*sensor.areas),
            Seeing::Pixels(pixels) => {
                let area = sensor.area();
                Cow::Owned(pixels.projected.iter().map(|projected| area * projected).collect())
            }
        };
        let projected = match (&sensor.seeing, view) {
            (Seeing::Views(views), Some(view)) => views.projected[view],
            (Seeing::Views(_), None) | (Seeing::All | Seeing::Pixels(_), _) => 1.0,
        };
        let first = view.unwrap_or(0) * areas.len();
        let flux = evidence.cell_flux(id, first..first + areas.len());
        Self {
            largest: areas.iter().copied().fold(0.0, f64::max),
            area: areas.iter().sum(),
            areas,
            factor: MM2_PER_M2 / projected,
            count: evidence.count_flux(&flux),
            all_light: view.is_none(),
            flux,
        }
    }

    pub(crate) fn is_on(&self, cell: usize) -> bool {
        self.areas[cell] > NO_AREA * self.largest
    }

    pub(crate) fn is_full(&self, cell: usize) -> bool {
        self.areas[cell] >= ENOUGH_AREA * self.largest
    }

    /// A cell in the unit of the map.
    pub(crate) fn at(&self, cell: usize) -> Noisy {
        self.over(self.flux[cell], self.areas[cell])
    }

    fn over(&self, (mean, error): (f64, f64), area: f64) -> Noisy {
        let factor = self.factor / area;
        Noisy { value: mean * factor, std_error: error * factor, count: self.count * factor }
    }

    /// Some cells taken together, in the unit of the map.
    pub(crate) fn mean(&self, cells: impl IntoIterator<Item = usize>) -> Noisy {
        let (mut flux, mut variance, mut area) = (0.0, 0.0, 0.0);
        for cell in cells {
            flux += self.flux[cell].0;
            variance += self.flux[cell].1.powi(2);
            area += self.areas[cell];
        }
        self.over((flux, variance.sqrt()), area)
    }

    /// Counts in an average cell that counts for the extremes, 1.
    pub(crate) fn counts_per_cell(&self, full: usize) -> f64 {
        let flux: f64 =
            (0..self.areas.len()).filter(|&c| self.is_full(c)).map(|c| self.flux[c].0).sum();
        flux / full as f64 / self.count
    }
}
