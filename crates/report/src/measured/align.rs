//! The shift between a measured and a computed map, and their scale.
//!
//! With the computed cells cᵢ, their areas or solid angles aᵢ, and the measured map moved by d, mᵢ(d), a search on half cells begins
//! with the shift of least 1 - (Σ a c m)² / (Σ a c² Σ a m²), which no scale changes. Noise in m is smoothed most half way between
//! its cells, so the minimum of a residual is drawn there. The shift is therefore where Σ a c' (c - k m(d)) = 0 with the slopes c' of
//! the computed map, found by Newton's method: noise in m does not move the mean of that (the slopes are instrumental variables).
//! The scale follows by least squares, k = Σ a c m / Σ a m², and the measured values are 1/k of the computed ones. Weights are areas,
//! not 1/σ²: errors that are themselves estimated correlate with their values, which biases such a fit.

use crate::measured::computed::ComputedCells;
use crate::measured::intensities::MOST_ROTATION;
use crate::measured::resample::resampled;
use lumiduct_base::math::solve_rows;
use lumiduct_base::number::format_with_error;
use lumiduct_files::measured::MeasuredGrid;
use ndarray::Array2;

/// Share of the size of a map over which a shift is searched to either side, but at least one cell.
const RANGE: f64 = 0.125;
/// Fewest rows and columns of a map that is aligned.
const FEWEST_LINES: usize = 5;
/// Resolution of a shift, as a share of a cell.
const RESOLUTION: f64 = 1e-6;
/// Standard errors by which a shift has to differ from 0 to be applied.
const CLEAR_SHIFT: f64 = 2.0;
/// Shift of no importance, as a share of a cell.
const NO_SHIFT: f64 = 1e-3;
/// Most steps towards a shift; a few suffice.
const MOST_STEPS: usize = 50;
/// Step of the derivatives, as a share of a cell.
const DERIVATIVE_STEP: f64 = 0.05;
/// Share of the area of the report that a measured map has to cover.
pub(crate) const LEAST_COVER: f64 = 0.5;
/// Pivot below which a shift is not determined, as a share of the largest.
const SINGULAR: f64 = 1e-9;

/// Where the measured pattern lies, relative to the computed one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundShift {
    /// Along both axes, mm or deg.
    pub value: [f64; 2],
    /// Their standard errors, by the errors of the computed cells and by what is left of the difference.
    pub std_errors: [f64; 2],
    /// Most shift that was searched; 0 for an axis that is not aligned.
    pub range: [f64; 2],
}

impl FoundShift {
    /// Whether an axis was aligned.
    pub(crate) fn is_found(&self, axis: usize) -> bool {
        self.range[axis] > 0.0
    }

    /// Whether the shift along an axis may be noise.
    fn is_within_error(&self, axis: usize) -> bool {
        self.is_found(axis) && self.value[axis].abs() < CLEAR_SHIFT * self.std_errors[axis]
    }
}

/// Measured over computed values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundScale {
    /// The factor, 1.
    pub value: f64,
    /// Its standard error, by the errors of the computed cells and by what is left of the difference.
    pub std_error: f64,
}

/// A measured map and the computed one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MapPair<'a> {
    pub(crate) grid: &'a MeasuredGrid,
    pub(crate) computed: &'a ComputedCells,
}

impl MapPair<'_> {
    /// The measured means over the computed cells, with the measured map moved back by `shift`; NaN where either is unknown.
    pub(crate) fn measured(&self, shift: [f64; 2]) -> Array2<f64> {
        let mut means = resampled(self.grid, self.computed.edges(), shift);
        let values = self.computed.cells.values.iter();
        means
            .iter_mut()
            .zip(values)
            .filter(|(_, own)| own.is_nan())
            .for_each(|(m, _)| *m = f64::NAN);
        means
    }

    /// Width and height of a computed cell.
    fn cell(&self) -> [f64; 2] {
        self.computed
            .edges()
            .map(|edges| (edges[edges.len() - 1] - edges[0]) / (edges.len() - 1) as f64)
    }

    /// The sum of a product over cells where the measured map is known, by their sizes.
    fn sum(&self, measured: &Array2<f64>, f: impl Fn(f64, f64) -> f64) -> f64 {
        let cells = self.computed.cells.values.iter().zip(&self.computed.sizes).zip(measured);
        let known = cells.filter(|(_, m)| m.is_finite());
        known.map(|((c, a), m)| a * f(*c, *m)).sum()
    }

    /// Share of the computed area that the measured map covers.
    pub(crate) fn cover(&self, measured: &Array2<f64>) -> f64 {
        let computed = &self.computed.cells.values;
        self.sum(measured, |_, _| 1.0) / self.sum(computed, |_, _| 1.0)
    }

    /// What no scale explains, 0 to 1; infinite where too little is covered.
    pub(crate) fn loss(&self, measured: &Array2<f64>) -> f64 {
        if self.cover(measured) < LEAST_COVER {
            return f64::INFINITY;
        }
        let both = self.sum(measured, |c, m| c * m);
        let norms = self.sum(measured, |c, _| c * c) * self.sum(measured, |_, m| m * m);
        // A negative factor is no likeness.
        if both <= 0.0 { 1.0 } else { 1.0 - both * both / norms }
    }

    /// The shift along the axes wanted; an axis along which the maps do not change enough is left alone, with a sentence.
    pub(crate) fn align(&self, wanted: [bool; 2], remarks: &mut Vec<String>) -> FoundShift {
        let names = self.computed.kind.places.names;
        let unit = self.computed.kind.places.units[0];
        let mut is_free = wanted;
        for axis in [0, 1] {
            let lines = self.computed.edges()[axis].len() - 1;
            if is_free[axis] && lines < FEWEST_LINES {
                is_free[axis] = false;
                let name = names[axis];
                remarks.push(format!(
                    "no shift is searched along {name}: {lines} cells are too few, {FEWEST_LINES} are needed"
                ));
            }
        }
        loop {
            let range = self.range(is_free);
            let (value, std_errors) = self.refined(range, is_free);
            let doubtful = |axis: &usize| {
                is_free[*axis] && (std_errors[*axis].is_nan() || std_errors[*axis] >= range[*axis])
            };
            let worst = [0, 1].into_iter().filter(doubtful).max_by(|a, b| {
                (std_errors[*a] / range[*a]).total_cmp(&(std_errors[*b] / range[*b]))
            });
            let Some(axis) = worst else {
                let shift = FoundShift { value, std_errors, range };
                let within = [0, 1].into_iter().filter(|axis| shift.is_within_error(*axis));
                let score = |axis: usize| (value[axis] / std_errors[axis]).abs();
                if let Some(axis) = within.min_by(|a, b| score(*a).total_cmp(&score(*b))) {
                    is_free[axis] = false;
                    if value[axis].abs() > NO_SHIFT * self.cell()[axis] {
                        let found = format_with_error(value[axis], std_errors[axis]);
                        let name = names[axis];
                        remarks.push(format!(
                            "a shift of {found} {unit} along {name} is less than two standard errors from 0, so it is not applied"
                        ));
                    }
                    continue;
                }
                for axis in [0, 1].into_iter().filter(|axis| shift.is_found(*axis)) {
                    if value[axis].abs() >= range[axis] * (1.0 - 1e-9) {
                        let (name, most) = (names[axis], range[axis]);
                        remarks.push(format!(
                            "the shift along {name} lies at the limit of the search, {most} {unit}: check the places of the \
                             measured file"
                        ));
                    }
                }
                return shift;
            };
            is_free[axis] = false;
            remarks.push(format!(
                "no shift is determined along {}: the maps hardly change that way",
                names[axis]
            ));
        }
    }

    fn range(&self, is_free: [bool; 2]) -> [f64; 2] {
        let edges = self.computed.edges();
        let cell = self.cell();
        [0, 1].map(|axis| match is_free[axis] {
            false => 0.0,
            true if self.computed.is_intensity() => MOST_ROTATION,
            true => {
                let own = edges[axis];
                (RANGE * (own[own.len() - 1] - own[0])).max(cell[axis])
            }
        })
    }

    /// The shift of least loss on a grid of half cells, which no noise displaces by more than that.
    fn start(&self, range: [f64; 2]) -> [f64; 2] {
        let cell = self.cell();
        let places = [0, 1].map(|axis| {
            let count = (2.0 * range[axis] / cell[axis]).floor() as i64;
            (-count..=count).map(|n| 0.5 * n as f64 * cell[axis]).collect::<Vec<_>>()
        });
        let all = places[1].iter().flat_map(|y| places[0].iter().map(|x| [*x, *y]));
        let scored = all.map(|at| (self.loss(&self.measured(at)), at));
        // Of equal ones, the smallest shift.
        let size = |at: [f64; 2]| (at[0] / cell[0]).hypot(at[1] / cell[1]);
        let best = scored.min_by(|a, b| a.0.total_cmp(&b.0).then(size(a.1).total_cmp(&size(b.1))));
        best.map_or([0.0; 2], |(_, at)| at)
    }

    /// The shift where the slopes of the computed map and what is left of the difference are uncorrelated, and its standard
    /// errors; these are infinite where it is not determined.
    fn refined(&self, range: [f64; 2], is_free: [bool; 2]) -> ([f64; 2], [f64; 2]) {
        let free: Vec<usize> = [0, 1].into_iter().filter(|axis| is_free[*axis]).collect();
        let mut shift = self.start(range);
        let mut errors = [0.0; 2];
        if free.is_empty() {
            return (shift, errors);
        }
        let cell = self.cell();
        let slopes: Vec<Array2<f64>> = free.iter().map(|axis| self.slope(*axis)).collect();
        for _ in 0..MOST_STEPS {
            let at = self.measured(shift);
            let factor = self.factor(&at);
            let rest = &self.computed.cells.values - &(&at * factor);
            let (mut columns, mut instruments) = (vec![at.clone()], vec![at]);
            for (axis, slope) in free.iter().zip(&slopes) {
                let step = DERIVATIVE_STEP * cell[*axis];
                let side = |sign: f64| {
                    let mut at = shift;
                    at[*axis] += sign * step;
                    self.measured(at)
                };
                columns.push((side(1.0) - side(-1.0)) * (0.5 * factor / step));
                instruments.push(slope.clone());
            }
            let Some(found) = self.linear_fit(&instruments, &columns, &rest) else {
                free.iter().for_each(|axis| errors[*axis] = f64::INFINITY);
                return (shift, errors);
            };
            let before = shift;
            for (axis, (step, error)) in free.iter().zip(&found[1..]) {
                // A step of more than a cell leaves the range where the slopes are known.
                let step = step.clamp(-cell[*axis], cell[*axis]);
                shift[*axis] = (shift[*axis] + step).clamp(-range[*axis], range[*axis]);
                errors[*axis] = *error;
            }
            let is_still =
                |axis: usize| (shift[axis] - before[axis]).abs() <= RESOLUTION * cell[axis];
            if is_still(0) && is_still(1) {
                break;
            }
        }
        (shift, errors)
    }

    /// The slope of the computed map between the neighbours of each cell; NaN at an edge, unless the axis closes a circle.
    fn slope(&self, axis: usize) -> Array2<f64> {
        let values = &self.computed.cells.values;
        let edges = self.computed.edges()[axis];
        let count = edges.len() - 1;
        let is_circle = self.computed.is_intensity() && axis == 0;
        Array2::from_shape_fn(values.dim(), |(row, column)| {
            let own = if axis == 0 { column } else { row };
            if !is_circle && (own == 0 || own + 1 == count) {
                return f64::NAN;
            }
            let at = |place: usize| {
                if axis == 0 { values[[row, place]] } else { values[[place, column]] }
            };
            let width = 2.0 * (edges[own + 1] - edges[own]);
            (at((own + 1) % count) - at((own + count - 1) % count)) / width
        })
    }

    /// The coefficients of columns, with standard errors, that leave a rest uncorrelated with instruments: linear least squares where
    /// these are the columns. The errors are those of the computed cells, all enlarged by one factor where they do not explain what
    /// is left (as in Particle Data Group, Review of Particle Physics, introduction, section 5.2.2).
    fn linear_fit(
        &self,
        instruments: &[Array2<f64>],
        columns: &[Array2<f64>],
        rest: &Array2<f64>,
    ) -> Option<Vec<(f64, f64)>> {
        let count = columns.len();
        let mut rows = vec![vec![0.0; 2 * count + 1]; count];
        let [mut noise, mut flat] = [Array2::zeros((count, count)), Array2::zeros((count, count))];
        let mut norms = vec![[0.0; 2]; count];
        let (mut left, mut expected, mut whole) = (0.0, 0.0, 0.0);
        for (at, size) in self.computed.sizes.indexed_iter() {
            let (z, x): (Vec<f64>, Vec<f64>) =
                instruments.iter().zip(columns).map(|(z, x)| (z[at], x[at])).unzip();
            if z.iter().chain(&x).chain([&rest[at]]).any(|value| !value.is_finite()) {
                continue;
            }
            let error = self.computed.cells.errors[at];
            left += size * rest[at] * rest[at];
            expected += size * error * error;
            whole += size;
            for i in 0..count {
                norms[i][0] += size * z[i] * z[i];
                norms[i][1] += size * x[i] * x[i];
                rows[i][count] += size * z[i] * rest[at];
                for j in 0..count {
                    rows[i][j] += size * z[i] * x[j];
                    flat[[i, j]] += size * size * z[i] * z[j];
                    noise[[i, j]] += (size * error).powi(2) * z[i] * z[j];
                }
            }
        }
        let noise = if left > expected && expected > 0.0 {
            noise * (left / expected)
        } else if expected > 0.0 {
            noise
        } else {
            flat * (left / whole)
        };
        // Instruments and columns have different units, so each is measured by its norm.
        let norms: Vec<[f64; 2]> = norms.into_iter().map(|pair| pair.map(f64::sqrt)).collect();
        if norms.iter().flatten().any(|norm| *norm <= 0.0) {
            return None;
        }
        for i in 0..count {
            (0..count).for_each(|j| rows[i][j] /= norms[i][0] * norms[j][1]);
            rows[i][count] /= norms[i][0];
            rows[i][count + 1 + i] = 1.0;
        }
        solve_rows(&mut rows, SINGULAR)?;
        let inverse = Array2::from_shape_fn((count, count), |(i, j)| {
            rows[i][count + 1 + j] / (norms[i][1] * norms[j][0])
        });
        let covariance = inverse.dot(&noise).dot(&inverse.t());
        let found = |i: usize| (rows[i][count] / norms[i][1], covariance[[i, i]].max(0.0).sqrt());
        Some((0..count).map(found).collect())
    }

    /// Computed over measured values, by least squares.
    fn factor(&self, measured: &Array2<f64>) -> f64 {
        self.sum(measured, |c, m| c * m) / self.sum(measured, |_, m| m * m)
    }

    /// Measured over computed values; `None` if nothing is in common.
    pub(crate) fn scale(&self, measured: &Array2<f64>) -> Option<FoundScale> {
        let factor = self.factor(measured);
        let value = 1.0 / factor;
        let own = std::slice::from_ref(measured);
        let rest = &self.computed.cells.values - &(measured * factor);
        let (_, error) = *self.linear_fit(own, own, &rest)?.first()?;
        let std_error = error / (factor * factor);
        (value.is_finite() && value > 0.0).then_some(FoundScale { value, std_error })
    }
}
