//! From mean intensities over the cells of a sphere of directions to a table of luminous intensities.
//!
//! Of all tables without negative values, this is the one whose interpolation most likely gives the cell means: the maximum of the
//! likelihood of Poisson counts, by expectation maximisation (Shepp & Vardi, IEEE Trans. Med. Imaging 1 (1982) 113). From the means yᵢ over
//! cells of solid angles Ωᵢ, in which nodes have shares aᵢⱼ, the values xⱼ follow by xⱼ ← xⱼ Σᵢ Ωᵢ aᵢⱼ yᵢ / Σₖ aᵢₖ xₖ / Σᵢ Ωᵢ aᵢⱼ. A
//! distribution that is linear between the nodes is recovered from cells without noise; a dark node between bright ones keeps some
//! 0.3 % of their intensity. Beside edges that a table cannot hold, values stay within those of the cells around (`limit`). Every step
//! keeps the flux. Errors are those of a fit by least squares, which is linear in the cells.

mod likely;
mod limit;
pub(crate) mod nodes;

use crate::luminaire::error::LuminaireError;
use crate::luminaire::fit::likely::most_likely;
use crate::luminaire::fit::nodes::{
    NodeGrid, NodeShares, Planes, ring_edges, ring_mean, sector_mean,
};
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use lumiduct_base::math::{linear_over_ring, solve_rows};
use ndarray::{Array2, ArrayView2};
use std::f64::consts::TAU;
use std::ops::Range;

/// Fewest cells of a segment of the table: with fewer its nodes would not be determined.
const CELLS_PER_SEGMENT: usize = 2;
/// Most segments of a table in either angle: finer than any goniometer, and the time of a fit grows with their third power.
const MOST_SEGMENTS: usize = 720;

/// Mean luminous intensities over the cells of a sphere of directions: rings of equal steps of γ from 0° to 180°, by sectors of
/// equal steps of C from 0° to 360°.
#[derive(Debug, Clone, Copy)]
pub struct CellMeans<'a> {
    /// Rings by sectors, cd.
    pub candela: ArrayView2<'a, f64>,
    /// Standard errors of independent cells, same layout, cd.
    pub std_errors: ArrayView2<'a, f64>,
}

impl CellMeans<'_> {
    /// Share of the flux in the rings above 90°, 1.
    pub fn upward_share(&self) -> f64 {
        let rings = self.candela.nrows();
        let upward = flux_of_rings(self, rings.div_ceil(2)..rings);
        let all = flux_of(self);
        if all > 0.0 { upward / all } else { 0.0 }
    }
}

/// The layout of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TableLayout {
    /// Its symmetry: planes that it takes as equal are averaged.
    pub symmetry: PlaneSymmetry,
    /// Segments in γ, from 0° to 180°.
    pub angle_segments: usize,
    /// Segments in C, from 0° to 360°; not used under rotational symmetry.
    pub plane_segments: usize,
}

impl TableLayout {
    /// The layout with the smallest steps for so many rings and sectors, without symmetry if there are sectors.
    pub fn finest([rings, sectors]: [usize; 2]) -> Self {
        let segments = |cells: usize| {
            let per_segment = (CELLS_PER_SEGMENT..=cells).find(|own| cells.is_multiple_of(*own));
            per_segment.map_or(1, |own| cells / own)
        };
        let symmetry = if sectors == 1 { PlaneSymmetry::Rotational } else { PlaneSymmetry::None };
        let [angle_segments, plane_segments] = [rings, sectors].map(segments);
        Self { symmetry, angle_segments, plane_segments }
    }

    /// Whether this many rings and sectors make such a table.
    ///
    /// # Errors
    ///
    /// [`LuminaireError::NoDistribution`] if a step of the table has no whole number of cells or fewer than
    /// two, or if the symmetry has no planes at the ends of its range.
    pub fn expect_cells(&self, [rings, sectors]: [usize; 2]) -> Result<(), LuminaireError> {
        let &Self { symmetry, angle_segments, plane_segments } = self;
        expect_segments(rings, angle_segments, "γ")?;
        if symmetry == PlaneSymmetry::Rotational {
            return Ok(());
        }
        expect_segments(sectors, plane_segments, "C")?;
        let divisor = match symmetry {
            PlaneSymmetry::Rotational | PlaneSymmetry::None => 1,
            PlaneSymmetry::AboutC0 => 2,
            PlaneSymmetry::AboutC90 | PlaneSymmetry::Quadrants => 4,
        };
        if !plane_segments.is_multiple_of(divisor) {
            let problem = format!(
                "{plane_segments} planes over 360 deg; the symmetry ({}) needs a multiple of {divisor}",
                symmetry.name()
            );
            return Err(LuminaireError::NoDistribution(problem));
        }
        Ok(())
    }
}

/// A table with the errors of its values.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedIntensities {
    /// The table. It has the flux of the cells, apart from that of negative ones.
    pub intensities: Intensities,
    /// Standard errors of its values, planes by angles, cd.
    pub std_errors: Array2<f64>,
    /// Flux of the table above that of the cells, because negative cell means are taken as zero, as a share of the latter, 1.
    pub added_share: f64,
    /// Where the table differs most from the cells, averaged over those that its symmetry takes as equal, if noise does not explain
    /// it: there the light changes faster than a table of its steps can.
    pub misfit: Option<Misfit>,
}

/// A difference between the mean over a cell and that of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    /// The size of the difference, cd.
    pub candela: f64,
    /// The middle of the ring of the cell, deg.
    pub angle_deg: f64,
}

/// Standard errors of a cell that noise explains.
const NOISE: f64 = 4.0;
/// Share of the peak by which a table may differ from cells, 1.
const NEGLIGIBLE_MISFIT: f64 = 0.01;

impl Misfit {
    fn of(values: &Array2<f64>, means: &CellMeans<'_>, grid: &NodeGrid) -> Option<Self> {
        let peak = values.iter().copied().fold(0.0, f64::max);
        let step = 180.0 / grid.of_ring.len() as f64;
        let equal = grid.equal_sectors();
        let differences =
            (0..grid.of_ring.len()).flat_map(|ring| equal.iter().map(move |own| (ring, own)));
        let differences = differences.filter_map(|(ring, equal)| {
            let count = equal.len() as f64;
            let cells = || equal.iter().map(|sector| [ring, *sector]);
            let mean = cells().map(|cell| means.candela[cell].max(0.0)).sum::<f64>() / count;
            let variance: f64 = cells().map(|cell| means.std_errors[cell].powi(2)).sum();
            let candela = (grid.mean(values, [ring, equal[0]]) - mean).abs();
            let explained = NOISE * variance.sqrt() / count + NEGLIGIBLE_MISFIT * peak;
            let angle_deg = step * (ring as f64 + 0.5);
            (candela > explained).then_some(Self { candela, angle_deg })
        });
        differences.max_by(|a, b| a.candela.total_cmp(&b.candela))
    }
}

/// Fits a table to cell means.
///
/// # Errors
///
/// As [`TableLayout::expect_cells`]; [`LuminaireError::NoDistribution`] if a value is not finite.
pub fn fit(
    means: &CellMeans<'_>,
    layout: &TableLayout,
) -> Result<FittedIntensities, LuminaireError> {
    let (rings, sectors) = means.candela.dim();
    layout.expect_cells([rings, sectors])?;
    if let Some(value) = means.candela.iter().find(|value| !value.is_finite()) {
        return Err(LuminaireError::NoDistribution(format!("a cell has {value} cd")));
    }
    let step = 180.0 / layout.angle_segments as f64;
    let angles_deg = (0..=layout.angle_segments).map(|place| step * place as f64).collect();
    let planes = Planes::of(layout.symmetry, layout.plane_segments);
    let grid = NodeGrid::new([rings, sectors], layout.angle_segments, &planes);
    let values = most_likely(means.candela, means.std_errors, &grid, &planes);
    let misfit = Misfit::of(&values, means, &grid);
    let candela = values.into_iter().collect();
    let intensities =
        Intensities::new(layout.symmetry, planes.degrees.clone(), angles_deg, candela)?;
    let flux = flux_of(means);
    let added = intensities.flux() - flux;
    Ok(FittedIntensities {
        std_errors: std_errors(means, layout, &planes)?,
        intensities,
        misfit,
        added_share: if flux > 0.0 { added / flux } else { 0.0 },
    })
}

/// Flux of the cells, lm.
fn flux_of(means: &CellMeans<'_>) -> f64 {
    flux_of_rings(means, 0..means.candela.nrows())
}

/// Flux of the cells of some rings, lm.
fn flux_of_rings(means: &CellMeans<'_>, some: Range<usize>) -> f64 {
    let (rings, sectors) = means.candela.dim();
    let flux = |ring: usize| {
        means.candela.row(ring).sum() * TAU / sectors as f64
            * linear_over_ring(ring_edges(ring, rings), [1.0; 2])
    };
    some.map(flux).sum()
}

/// Standard errors of the values by least squares, planes by angles.
fn std_errors(
    means: &CellMeans<'_>,
    layout: &TableLayout,
    planes: &Planes,
) -> Result<Array2<f64>, LuminaireError> {
    let (rings, sectors) = means.candela.dim();
    let shape = (planes.degrees.len(), layout.angle_segments + 1);
    // An unknown error would make all of them not a number.
    if !means.std_errors.iter().all(|error| error.is_finite()) {
        return Ok(Array2::from_elem(shape, f64::INFINITY));
    }
    let along = weights(shape.1, rings, |ring| ring_mean(ring, rings, layout.angle_segments))?;
    let circle = planes.of_circle.len();
    let of_circle = weights(circle, sectors, |sector| sector_mean(sector, sectors, circle))?;
    let mut across = Array2::zeros((shape.0, sectors));
    for plane in 0..shape.0 {
        let equal: Vec<usize> =
            (0..circle).filter(|place| planes.of_circle[*place] == plane).collect();
        for place in &equal {
            across.row_mut(plane).scaled_add(1.0 / equal.len() as f64, &of_circle.row(*place));
        }
    }
    let squared = |all: &Array2<f64>| all.mapv(|own| own * own);
    let by_angle = squared(&along).dot(&means.std_errors.mapv(|error| error * error));
    let mut variances = squared(&across).dot(&by_angle.t());
    // At the poles all sectors count alike.
    for pole in [0, layout.angle_segments] {
        let mean = by_angle.row(pole).sum() / (sectors * sectors) as f64;
        variances.column_mut(pole).fill(mean);
    }
    Ok(variances.mapv(f64::sqrt))
}

fn expect_segments(cells: usize, segments: usize, what: &str) -> Result<(), LuminaireError> {
    if segments > MOST_SEGMENTS {
        let problem = format!("{segments} steps in {what}, expected at most {MOST_SEGMENTS}");
        return Err(LuminaireError::NoDistribution(problem));
    }
    if segments == 0 || !cells.is_multiple_of(segments) || cells / segments < CELLS_PER_SEGMENT {
        let problem = format!(
            "{segments} steps in {what} from {cells} cells; each step needs a whole number of cells, at least {CELLS_PER_SEGMENT}"
        );
        return Err(LuminaireError::NoDistribution(problem));
    }
    Ok(())
}

/// Weights of cells in the values at nodes, nodes by cells: (A W Aᵀ)⁻¹ A W, where A has the shares of the nodes in the cells.
fn weights(
    nodes: usize,
    cells: usize,
    mean: impl Fn(usize) -> NodeShares,
) -> Result<Array2<f64>, LuminaireError> {
    let mut rows = vec![vec![0.0; nodes + cells]; nodes];
    for cell in 0..cells {
        let NodeShares { nodes: ends, shares, weight } = mean(cell);
        for (own, share) in ends.into_iter().zip(shares) {
            rows[own][nodes + cell] += share * weight;
            for (other, further) in ends.into_iter().zip(shares) {
                rows[own][other] += share * further * weight;
            }
        }
    }
    let undetermined =
        || LuminaireError::NoDistribution("the cells do not determine the table".to_owned());
    solve_rows(&mut rows, 0.0).ok_or_else(undetermined)?;
    Ok(Array2::from_shape_fn((nodes, cells), |(node, cell)| rows[node][nodes + cell]))
}

#[cfg(test)]
mod tests;
