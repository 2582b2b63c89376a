//! The estimate of gathered light: which stage gives it, and whether its bias is known.
//!
//! Within nested windows of size 1, 1/√2 and 1/2 the same photons give E1, E2 and E3. A bias that
//! scales with the square of the window, as that of a smooth field does, gives (E1 - E2)/(E2 - E3)
//! = 2. If this holds, within its error and above the noise, the value is E0, which is free of such
//! a bias. Where all differences are noise the value is also E0, but the bias is not resolved.
//! Where they follow another law the value is E3, and its bias is not resolved. |E1 - E2| is the
//! indicator of bias in all cases. The decision is made once per sensor and stage, from its flux,
//! never per cell.

use crate::plan::Estimator;
use crate::tally::Tally;
use crate::transport::estimate::{Bias, Estimate, Resolution};
use crate::transport::gather::stages::Windows;
use crate::transport::{Readings, Stage};

/// Standard errors that E2 - E3 must exceed to count as more than noise.
const OUT_OF_NOISE: f64 = 2.0;
/// Standard errors within which (E1 - E2) - 2 (E2 - E3) must vanish.
const WITHIN: f64 = 2.0;
/// Deviation of the ratio from 2 that is accepted however well it is known, 1: higher orders of the
/// window's size.
const RATIO_TOLERANCE: f64 = 0.15;

/// A stage, and what is known about the bias of a sensor's flux in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Judged<'a> {
    pub(super) stage: &'a Stage,
    pub(super) windows: Windows<'a>,
    pub(super) resolution: Resolution,
}

/// The stage with the smallest total error of the sum of some scalars.
pub(super) fn best<'a>(stages: &'a [Stage], slots: &[usize]) -> Option<Judged<'a>> {
    let with_error = stages.iter().map(|stage| {
        let windows = Windows::of(&stage.counts);
        let resolution = resolution(windows, slots);
        (total_error(windows, resolution, slots), Judged { stage, windows, resolution })
    });
    with_error.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, judged)| judged)
}

/// The estimate of the sensor with these scalars of flux; `None` before the first pass.
pub(crate) fn estimate<'a>(
    estimator: Estimator,
    stages: &'a [Stage],
    slots: &[usize],
) -> Option<Estimate<'a>> {
    let Judged { windows, resolution, .. } = best(stages, slots)?;
    let bias = Some(Bias { between: [windows.wide, windows.middle], resolution });
    let readings = chosen(windows, resolution);
    Some(Estimate { estimator, readings, bias, is_contradicted: false })
}

/// Whether the bias of the sum of some scalars in a stage is above its noise.
pub(super) fn is_limiting(stage: &Stage, slots: &[usize]) -> bool {
    let windows = Windows::of(&stage.counts);
    let resolution = resolution(windows, slots);
    let apart = difference(windows, slots, |[e1, e2, _]| e1 - e2).mean().abs();
    resolution == Resolution::NotResolved
        || apart > chosen(windows, resolution).sum(slots).std_error()
}

/// Whether the bias of the sum of some scalars is resolved.
fn resolution(windows: Windows<'_>, slots: &[usize]) -> Resolution {
    let outer = difference(windows, slots, |[e1, e2, _]| e1 - e2);
    let inner = difference(windows, slots, |[_, e2, e3]| e2 - e3);
    let curved = difference(windows, slots, |[e1, e2, e3]| e1 - 3.0 * e2 + 2.0 * e3);
    let is_seen = |tally: &Tally| tally.mean().abs() > OUT_OF_NOISE * tally.std_error();
    let room = (WITHIN * curved.std_error()).max(RATIO_TOLERANCE * inner.mean().abs());
    // Noise alone must not make the ratio acceptable: both differences have one sign.
    let quadratic = curved.mean().abs() <= room && outer.mean() * inner.mean() > 0.0;
    if is_seen(&inner) && quadratic {
        Resolution::Resolved
    } else if is_seen(&inner) || is_seen(&outer) {
        Resolution::NotResolved
    } else {
        Resolution::InNoise
    }
}

/// Combined standard error and bias of the sum of some scalars, relative to it.
pub(super) fn total_error(windows: Windows<'_>, resolution: Resolution, slots: &[usize]) -> f64 {
    let delta = difference(windows, slots, |[e1, e2, _]| e1 - e2).mean();
    let value = chosen(windows, resolution).sum(slots);
    let error = value.std_error().hypot(delta) / value.mean().abs();
    if error.is_nan() { f64::INFINITY } else { error }
}

/// The readings that give the values.
pub(super) fn chosen(windows: Windows<'_>, resolution: Resolution) -> &Readings {
    match resolution {
        Resolution::Resolved | Resolution::InNoise => windows.extrapolated,
        Resolution::NotResolved => windows.narrow,
    }
}

/// A function of the sum of some scalars within the three windows, pass by pass.
fn difference(windows: Windows<'_>, slots: &[usize], f: impl Fn([f64; 3]) -> f64) -> Tally {
    let Windows { wide, middle, narrow, .. } = windows;
    let groups = wide.groups.iter().zip(&middle.groups).zip(&narrow.groups);
    Tally::of(groups.map(|((wide, middle), narrow)| {
        f([wide, middle, narrow].map(|group| {
            slots.iter().map(|&slot| group.sums[slot]).sum::<f64>() / group.batches as f64
        }))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::samples::{add, readings, rectangle, scene};
    use crate::scene::{SensorId, SourceId};
    use crate::transport::Layout;

    /// Passes that each find these fluxes within the three windows, and some noise.
    fn decided(means: [f64; 3], noise: impl Fn(u64) -> [f64; 3]) -> Resolution {
        let scene = scene(&[("lamp", 10.0)], vec![("cell", rectangle(2.0, 1, 1))]);
        let slot = Layout::new(&scene).sensor_flux(SensorId::new(0), SourceId::new(0));
        let [wide, middle, narrow] = [0, 1, 2].map(|window: usize| {
            let found = readings(&scene, 32, |pass, _, batch| {
                add(batch, slot, means[window] + noise(pass)[window]);
            });
            found.photons
        });
        let extrapolated = middle.combined([2.0, -1.0], &wide);
        resolution(
            Windows { wide: &wide, middle: &middle, narrow: &narrow, extrapolated: &extrapolated },
            &[slot],
        )
    }

    /// Plus and minus the size, alternating.
    fn wobble(pass: u64, size: f64) -> f64 {
        if pass.is_multiple_of(2) { size } else { -size }
    }

    #[test]
    fn a_bias_by_the_square_of_the_window_is_resolved() {
        let noise = |pass| [0.0, wobble(pass, 1e-3), wobble(pass / 2, 2e-3)];
        assert_eq!(decided([0.6, 0.8, 0.9], noise), Resolution::Resolved);
        assert_eq!(decided([1.4, 1.2, 1.1], noise), Resolution::Resolved);
    }

    #[test]
    fn a_bias_of_another_law_is_not_resolved() {
        let noise = |pass| [0.0, wobble(pass, 1e-3), wobble(pass / 2, 2e-3)];
        assert_eq!(decided([0.6, 0.7, 0.9], noise), Resolution::NotResolved, "still rising");
        assert_eq!(decided([0.6, 0.9, 0.8], noise), Resolution::NotResolved, "both ways");
    }

    #[test]
    fn windows_that_differ_by_noise_alone_are_told_so() {
        let noise = |pass| [0.0, wobble(pass, 1.0), wobble(pass / 2, 2.0)];
        assert_eq!(decided([0.6, 0.8, 0.9], noise), Resolution::InNoise);
        assert_eq!(decided([0.0; 3], |_| [0.0; 3]), Resolution::InNoise, "in the dark");
    }
}
