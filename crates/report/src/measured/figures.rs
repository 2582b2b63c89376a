//! Figures of a measured beside a computed map.

use crate::measured::computed::ComputedCells;
use ndarray::Array2;

/// Share of the centre beam intensity at the edge of the beam (CIE S 017:2020, 17-27-077), 1.
const BEAM_EDGE: f64 = 0.5;

/// How far two maps differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferenceFigures {
    /// Root mean square of the difference over the cells, by their sizes, in the unit of the map.
    pub rms: f64,
    /// The same over the largest computed cell, 1.
    pub rms_of_max: f64,
    /// The same over the mean of the computed cells, 1.
    pub rms_of_mean: f64,
    /// Part of `rms_of_max` that the errors of the computed cells cause, 1.
    pub noise_of_max: f64,
    /// Correlation coefficient (Pearson), 1.
    pub correlation: f64,
    /// Cells that are compared.
    pub cells: usize,
}

/// One of the two maps in figures, over the cells that both have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideFigures {
    /// Mean, in the unit of the map.
    pub mean: f64,
    /// Least cell.
    pub min: f64,
    /// Largest cell.
    pub max: f64,
    /// For intensities only: the flux of the cells, lm.
    pub flux_lm: Option<f64>,
    /// For intensities only: beam angles in the planes C0-C180 and C90-C270, deg; `None` without light at γ = 0, or where the
    /// intensity does not fall to half of that from there on.
    pub beams_deg: [Option<f64>; 2],
}

/// The difference of measured values, divided by a scale, from the computed ones.
pub(crate) fn difference_figures(
    computed: &ComputedCells,
    measured: &Array2<f64>,
    scale: f64,
) -> DifferenceFigures {
    let cells = computed.cells.values.iter().zip(measured).zip(&computed.cells.errors);
    let known: Vec<[f64; 4]> = cells
        .zip(&computed.sizes)
        .filter(|(((_, m), _), _)| m.is_finite())
        .map(|(((c, m), error), size)| [*c, m / scale, *error, *size])
        .collect();
    let whole: f64 = known.iter().map(|[.., size]| size).sum();
    let mean = |f: &dyn Fn(&[f64; 4]) -> f64| -> f64 {
        known.iter().map(|cell| cell[3] * f(cell)).sum::<f64>() / whole
    };
    let rms = mean(&|[c, m, ..]| (m - c).powi(2)).sqrt();
    let noise = mean(&|[_, _, error, _]| error * error).sqrt();
    let middles = [mean(&|cell| cell[0]), mean(&|cell| cell[1])];
    let spread = |i: usize, j: usize| mean(&|cell| (cell[i] - middles[i]) * (cell[j] - middles[j]));
    let max = known.iter().map(|cell| cell[0]).fold(0.0, f64::max);
    DifferenceFigures {
        rms,
        rms_of_max: rms / max,
        rms_of_mean: rms / middles[0],
        noise_of_max: noise / max,
        correlation: spread(0, 1) / (spread(0, 0) * spread(1, 1)).sqrt(),
        cells: known.len(),
    }
}

/// Figures of values where `known` is.
pub(crate) fn side_figures(
    computed: &ComputedCells,
    values: &Array2<f64>,
    known: &Array2<f64>,
) -> SideFigures {
    let cells = values.iter().zip(known).zip(&computed.sizes);
    let cells: Vec<(f64, f64)> =
        cells.filter(|((_, known), _)| known.is_finite()).map(|((v, _), a)| (*v, *a)).collect();
    let flux: f64 = cells.iter().map(|(value, size)| value * size).sum();
    let of = |f: fn(f64, f64) -> f64| cells.iter().map(|cell| cell.0).reduce(f).unwrap_or(f64::NAN);
    let is_intensity = computed.is_intensity();
    let beam = |plane: f64| beam_angle(computed, values, plane).filter(|_| is_intensity);
    SideFigures {
        mean: flux / cells.iter().map(|cell| cell.1).sum::<f64>(),
        min: of(f64::min),
        max: of(f64::max),
        flux_lm: is_intensity.then_some(flux),
        beams_deg: [beam(0.0), beam(90.0)],
    }
}

/// Full angle in a plane between the directions of half the intensity at γ = 0, deg.
fn beam_angle(computed: &ComputedCells, values: &Array2<f64>, plane: f64) -> Option<f64> {
    let level = BEAM_EDGE * values.row(0).mean().filter(|centre| *centre > 0.0)?;
    let halves = [plane, plane + 180.0].map(|plane| {
        let points = half_plane(computed, values, plane);
        let edge = points.windows(2).find(|ends| ends[1][1] < level)?;
        let [from, above] = edge[0];
        let [to, below] = edge[1];
        // The half-plane may be darker than the pole from its first cell on.
        (above >= level).then(|| from + (above - level) / (above - below) * (to - from))
    });
    Some(halves[0]? + halves[1]?)
}

/// γ in deg and intensity along a half-plane C: the mean of the columns beside it, or of the one that contains it.
pub(crate) fn half_plane(
    computed: &ComputedCells,
    values: &Array2<f64>,
    plane: f64,
) -> Vec<[f64; 2]> {
    let [c, gamma] = computed.edges();
    let count = c.len() - 1;
    let column = |at: f64| {
        let at = at.rem_euclid(360.0);
        c.partition_point(|edge| *edge <= at).clamp(1, count) - 1
    };
    /// Less than any sector, deg.
    const BESIDE: f64 = 1e-3;
    let beside = [column(plane - BESIDE), column(plane + BESIDE)];
    let point = |row: usize| {
        let [one, other] = beside.map(|column| values[[row, column]]);
        [0.5 * (gamma[row] + gamma[row + 1]), 0.5 * (one + other)]
    };
    (0..gamma.len() - 1).map(point).collect()
}
