//! The cells of a surface sensor, or the pixels of its image: flux, area, and their joint noise.
//!
//! A cell's error is that of the mean over batches; cells are treated as independent. Cells without
//! area are not part of the sensor. The area of a pixel is the aperture times its projected solid
//! angle, in mm² sr. Cells that the rim or a hole cuts to less than half of their own area hold few
//! counts. For the extremes they are merged with their neighbours along the rim until half a cell
//! is full, so that all light of the sensor counts and the average lies between the extremes.

use crate::measure::evidence::Evidence;
use crate::measure::light::LightSelection;
use crate::measure::noisy::{Noisy, WeightedValue};
use crate::scene::{Grid, Seeing, SensorId, SurfaceSensor};
use glam::DVec2;
use lumiduct_base::units::MM2_PER_M2;
use std::borrow::Cow;

/// Cells with less than this share of their own area on the sensor are not part of it.
const NO_AREA: f64 = 1e-9;
/// Cells with at least this share of their own area count individually for the extremes.
const ENOUGH_AREA: f64 = 0.5;

/// A value for a picture: a value that negative weights made negative is shown as zero.
pub fn not_below_zero(value: f64) -> f64 {
    // NaN, off the sensor, stays.
    if value < 0.0 { 0.0 } else { value }
}

/// The bits of a column and a row in turn.
fn interleaved(column: usize, row: usize) -> u64 {
    let bit = |of: usize, place: u32| (of as u64 >> place) & 1;
    (0..u32::BITS).map(|place| (bit(column, place) | bit(row, place) << 1) << (2 * place)).sum()
}

/// The cells of one view, lit by all light or by a light group.
pub(crate) struct SensorCells<'a> {
    /// Mean flux per cell with its standard error, lm or W.
    flux: Vec<(f64, f64)>,
    /// Area per cell, mm², or mm² sr.
    pub(crate) areas: Cow<'a, [f64]>,
    /// Fraction of each cell that lies on the sensor, 1; `None` for pixels, which are all whole.
    covered: Option<&'a [f64]>,
    grid: &'a Grid,
    pub(crate) area: f64,
    /// From flux per area to the unit of the map.
    pub(crate) factor: f64,
    /// Flux of one count, lm or W.
    count: f64,
    /// The scalars of the same light; `None` for a view, which is only a part of what they sum.
    pub(crate) flux_slots: Option<Vec<usize>>,
    /// Whether this is light that no source emits.
    pub(crate) is_dark: bool,
}

impl<'a> SensorCells<'a> {
    pub(crate) fn of(
        evidence: &Evidence<'_>,
        id: SensorId,
        sensor: &'a SurfaceSensor,
        light: LightSelection,
        view: Option<usize>,
    ) -> Self {
        let (areas, covered, grid) = match &sensor.seeing {
            Seeing::All | Seeing::Views(_) => {
                (Cow::Borrowed(&*sensor.areas), Some(&*sensor.covered), &sensor.grid)
            }
            Seeing::Pixels(pixels) => {
                let area = sensor.area();
                let areas = pixels.projected.iter().map(|projected| area * projected).collect();
                (Cow::Owned(areas), None, &pixels.grid)
            }
        };
        let projected = match (&sensor.seeing, view) {
            (Seeing::Views(views), Some(view)) => views.projected[view],
            (Seeing::Views(_), None) | (Seeing::All | Seeing::Pixels(_), _) => 1.0,
        };
        let first = view.unwrap_or(0) * areas.len();
        let flux = evidence.cell_flux(id, light, first..first + areas.len());
        let flux_slots = || light.flux_slots(evidence.scene, &evidence.layout, id);
        Self {
            covered,
            grid,
            area: areas.iter().sum(),
            areas,
            factor: MM2_PER_M2 / projected,
            count: evidence.count_flux(&flux),
            flux_slots: view.is_none().then(flux_slots),
            is_dark: light.is_dark(evidence.scene),
            flux,
        }
    }

    pub(crate) fn is_on(&self, cell: usize) -> bool {
        self.cover(cell) > NO_AREA
    }

    pub(crate) fn is_full(&self, cell: usize) -> bool {
        self.cover(cell) >= ENOUGH_AREA
    }

    /// The fraction of a cell that lies on the sensor, 1.
    pub(crate) fn cover(&self, cell: usize) -> f64 {
        self.covered.map_or(1.0, |covered| covered[cell])
    }

    /// The parts for the extremes, in the unit of the map: the full cells, and those cut by the
    /// rim, some merged. The average is their mean by area. They follow a curve that fills the grid
    /// (Morton 1966), so that neighbours in the list are neighbours on the sensor.
    pub(crate) fn for_extremes(&self) -> Vec<WeightedValue> {
        let full = (0..self.areas.len()).filter(|&cell| self.is_full(cell)).map(|cell| vec![cell]);
        let mut parts: Vec<Vec<usize>> = full.chain(self.rim()).collect();
        let (columns, _) = self.grid.shape();
        parts.sort_by_cached_key(|cells| interleaved(cells[0] % columns, cells[0] / columns));
        let part = |cells: Vec<usize>| WeightedValue {
            weight: cells.iter().map(|&cell| self.areas[cell]).sum(),
            read: self.mean(cells),
        };
        parts.into_iter().map(part).collect()
    }

    /// The cells cut to less than half, ordered by their direction from the middle of the grid, and
    /// merged until they make half a cell.
    fn rim(&self) -> Vec<Vec<usize>> {
        let rect = self.grid.rect();
        let middle = 0.5 * (rect.min + rect.max);
        let direction = |cell: usize| {
            let DVec2 { x, y } = self.grid.center(cell) - middle;
            y.atan2(x)
        };
        let mut cut: Vec<usize> =
            (0..self.areas.len()).filter(|&cell| self.is_on(cell) && !self.is_full(cell)).collect();
        // A stable sort: cells in one direction keep their order.
        cut.sort_by(|&a, &b| direction(a).total_cmp(&direction(b)));
        let (mut groups, mut cover) = (Vec::<Vec<usize>>::new(), ENOUGH_AREA);
        for cell in cut {
            if cover >= ENOUGH_AREA {
                groups.push(Vec::new());
                cover = 0.0;
            }
            cover += self.cover(cell);
            groups.last_mut().expect("a group was pushed for the first cell").push(cell);
        }
        // The remainder at the end joins the previous group.
        if cover < ENOUGH_AREA && groups.len() > 1 {
            let rest = groups.pop().expect("there are two");
            groups.last_mut().expect("there are two").extend(rest);
        }
        groups
    }

    /// A cell in the unit of the map.
    pub(crate) fn at(&self, cell: usize) -> Noisy {
        self.over(self.flux[cell], self.areas[cell])
    }

    fn over(&self, (mean, error): (f64, f64), area: f64) -> Noisy {
        let factor = self.factor / area;
        Noisy { value: mean * factor, std_error: error * factor, count: self.count * factor }
    }

    /// Some cells merged, in the unit of the map.
    pub(crate) fn mean(&self, cells: impl IntoIterator<Item = usize>) -> Noisy {
        let (mut flux, mut variance, mut area) = (0.0, 0.0, 0.0);
        for cell in cells {
            flux += self.flux[cell].0;
            variance += self.flux[cell].1.powi(2);
            area += self.areas[cell];
        }
        self.over((flux, variance.sqrt()), area)
    }

    /// Counts in an average of `cells` parts of the sensor, 1.
    pub(crate) fn counts_per_cell(&self, cells: usize) -> f64 {
        let flux: f64 = self.flux.iter().map(|(flux, _)| flux).sum();
        flux / cells as f64 / self.count
    }
}
