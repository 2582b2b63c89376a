//! Cells of a sensor in the unrolled coordinates of its face, or pixels in the plane of an image.

use crate::scene::shape::ChartRect;
use glam::DVec2;
use std::f64::consts::TAU;

/// How a face is divided into cells. Cells are numbered row by row.
#[derive(Debug, Clone, PartialEq)]
pub enum Grid {
    /// `nu` columns by `nv` rows over a rectangle of the chart.
    Cartesian {
        /// The rectangle, mm.
        rect: ChartRect,
        /// Number of columns, along u.
        nu: usize,
        /// Number of rows, along v.
        nv: usize,
    },
    /// Rings of equal width and sectors of equal angle about the chart's origin.
    Polar {
        /// Outer radius, mm.
        radius: f64,
        /// Number of rings, from the centre outward.
        rings: usize,
        /// Number of sectors, from +u counter-clockwise.
        sectors: usize,
    },
}

impl Grid {
    /// Number of cells.
    pub(crate) fn cells(&self) -> usize {
        match self {
            Self::Cartesian { nu, nv, .. } => nu * nv,
            Self::Polar { rings, sectors, .. } => rings * sectors,
        }
    }

    /// Columns and rows of a table of the cells: (u, v), or (sectors, rings).
    pub(crate) fn shape(&self) -> (usize, usize) {
        match self {
            Self::Cartesian { nu, nv, .. } => (*nu, *nv),
            Self::Polar { rings, sectors, .. } => (*sectors, *rings),
        }
    }

    /// The cell of a point of the chart; `None` outside the grid.
    #[inline]
    pub(crate) fn cell(&self, uv: DVec2) -> Option<usize> {
        match self {
            Self::Cartesian { rect, nu, nv } => {
                let place = (uv - rect.min) / (rect.max - rect.min);
                let column = bin(place.x, *nu)?;
                Some(bin(place.y, *nv)? * nu + column)
            }
            Self::Polar { radius, rings, sectors } => {
                let ring = bin(uv.length() / radius, *rings)?;
                let sector = bin(uv.y.atan2(uv.x).rem_euclid(TAU) / TAU, *sectors)?;
                Some(ring * sectors + sector)
            }
        }
    }

    /// Middle of a cell: (u, v) in mm, or (radius in mm, angle in rad).
    pub(crate) fn center(&self, cell: usize) -> DVec2 {
        match self {
            Self::Cartesian { rect, nu, nv } => {
                let place = DVec2::new((cell % nu) as f64 + 0.5, (cell / nu) as f64 + 0.5);
                rect.min + place / DVec2::new(*nu as f64, *nv as f64) * (rect.max - rect.min)
            }
            Self::Polar { radius, rings, sectors } => DVec2::new(
                radius * ((cell / sectors) as f64 + 0.5) / *rings as f64,
                TAU * ((cell % sectors) as f64 + 0.5) / *sectors as f64,
            ),
        }
    }

    /// The rectangle of the chart that the grid covers, mm.
    pub(crate) fn rect(&self) -> ChartRect {
        match self {
            Self::Cartesian { rect, .. } => *rect,
            Self::Polar { radius, .. } => {
                ChartRect { min: DVec2::splat(-radius), max: DVec2::splat(*radius) }
            }
        }
    }

    /// The share of every cell that lies on the sensor, 1: of the area of the chart, which bends and cones stretch. Where a rim
    /// cuts cells, the chart keeps areas. `charted_in` gives the area of the chart that the sensor fills within a rectangle.
    pub fn cell_cover(&self, charted_in: impl Fn(ChartRect) -> f64) -> Vec<f64> {
        match self {
            // The only cell is the whole sensor.
            Self::Cartesian { nu: 1, nv: 1, .. } => vec![1.0],
            Self::Cartesian { .. } => (0..self.cells())
                .map(|cell| self.cell_rect(cell))
                .map(|rect| cover(charted_in(rect) / rect.area()))
                .collect(),
            // Rings end at the rim.
            Self::Polar { .. } => vec![1.0; self.cells()],
        }
    }

    /// The rectangle of a cell in the chart; for a polar cell, that of the whole grid.
    pub(crate) fn cell_rect(&self, cell: usize) -> ChartRect {
        match self {
            Self::Cartesian { rect, nu, nv } => {
                let step = (rect.max - rect.min) / DVec2::new(*nu as f64, *nv as f64);
                let min = rect.min + step * DVec2::new((cell % nu) as f64, (cell / nu) as f64);
                ChartRect { min, max: min + step }
            }
            Self::Polar { .. } => self.rect(),
        }
    }

    /// Area of the sensor in every cell, mm²: cells cut by its rim count only their remaining part.
    /// `area_in` gives the area within a rectangle of the chart.
    pub fn cell_areas(&self, area_in: impl Fn(ChartRect) -> f64) -> Vec<f64> {
        match self {
            Self::Cartesian { .. } => {
                (0..self.cells()).map(|cell| area_in(self.cell_rect(cell))).collect()
            }
            Self::Polar { radius, rings, sectors } => {
                let width = radius / *rings as f64;
                (0..self.cells())
                    .map(|cell| {
                        let ring = (cell / sectors) as f64;
                        // π(r₂² - r₁²)/sectors with r = ring · width.
                        0.5 * TAU * width * width * (2.0 * ring + 1.0) / *sectors as f64
                    })
                    .collect()
            }
        }
    }
}

/// A share of a cell without the rounding of areas, 1.
fn cover(share: f64) -> f64 {
    const ROUNDING: f64 = 1e-9;
    match share {
        share if share >= 1.0 - ROUNDING => 1.0,
        share if share <= ROUNDING => 0.0,
        share => share,
    }
}

/// The bin of a position in 0..=1; the far end belongs to the last bin, up to rounding of points on
/// the rim.
#[inline]
fn bin(place: f64, bins: usize) -> Option<usize> {
    // A point computed to lie on a rim may be a few ulp beyond it.
    const RIM: f64 = 1e-12;
    if !(-RIM..=1.0 + RIM).contains(&place) {
        return None;
    }
    Some(((place * bins as f64) as usize).min(bins - 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::{Cone, Flat, Region, Shape};
    use lumiduct_base::math::Frame;
    use std::f64::consts::PI;

    #[test]
    fn centres_lie_in_their_cells() {
        let rect = ChartRect { min: DVec2::new(-1.0, 2.0), max: DVec2::new(3.0, 5.0) };
        let cartesian = Grid::Cartesian { rect, nu: 7, nv: 3 };
        for cell in 0..cartesian.cells() {
            assert_eq!(cartesian.cell(cartesian.center(cell)), Some(cell));
        }
        let polar = Grid::Polar { radius: 2.0, rings: 4, sectors: 6 };
        for cell in 0..polar.cells() {
            let center = polar.center(cell);
            assert_eq!(polar.cell(DVec2::from_angle(center.y) * center.x), Some(cell));
        }
    }

    #[test]
    fn points_outside_have_no_cell_and_the_rim_has_one() {
        let rect = ChartRect { min: DVec2::ZERO, max: DVec2::ONE };
        let grid = Grid::Cartesian { rect, nu: 2, nv: 2 };
        assert_eq!(grid.cell(DVec2::ONE), Some(3));
        assert_eq!(grid.cell(DVec2::new(1.1, 0.5)), None);
        assert_eq!(grid.cell(DVec2::new(0.5, -0.1)), None);
    }

    #[test]
    fn the_cover_of_a_cell_is_its_share_of_the_disk() {
        // A corner cell of 2 x 2 over a disk is covered to π/4, one of 1000 x 1000 hardly or not at all.
        let disk = Shape::Flat(Flat::new(Frame::WORLD, Region::Annulus { inner: 0.0, outer: 2.0 }));
        let cover = |cells: usize| {
            let grid = Grid::Cartesian { rect: disk.chart_bounds(), nu: cells, nv: cells };
            grid.cell_cover(|rect| disk.charted_in(rect))
        };
        assert!((cover(2)[0] - 0.25 * PI).abs() < 1e-12);
        for cells in [3, 8, 32, 100] {
            let sum: f64 = cover(cells).iter().sum();
            assert!((sum / (cells * cells) as f64 - 0.25 * PI).abs() < 1e-9, "{sum}");
        }
        // The second cell of 7: what lies above -10/7 mm, by the midpoint rule.
        let (from, width) = (-10.0 / 7.0, 4.0 / 7.0);
        let chord = |step: i32| {
            let u: f64 = from + width * (f64::from(step) + 0.5) / 10_000.0;
            ((4.0 - u * u).sqrt() + from).max(0.0) / width
        };
        let share = (0..10_000).map(chord).sum::<f64>() / 10_000.0;
        assert!((cover(7)[1] - share).abs() < 1e-6, "{share}");
    }

    #[test]
    fn cells_of_stretched_charts_are_whole() {
        let cone = Shape::Cone(Cone::new(Frame::WORLD, 3.0, 1.0, 5.0));
        let grid = Grid::Cartesian { rect: cone.chart_bounds(), nu: 5, nv: 4 };
        assert!(grid.cell_cover(|rect| cone.charted_in(rect)).iter().all(|cover| *cover == 1.0));
    }

    #[test]
    fn rings_add_up_to_the_disk() {
        let grid = Grid::Polar { radius: 2.0, rings: 5, sectors: 3 };
        let total: f64 = grid.cell_areas(|_| 0.0).iter().sum();
        assert!((total - std::f64::consts::PI * 4.0).abs() < 1e-12);
    }
}
