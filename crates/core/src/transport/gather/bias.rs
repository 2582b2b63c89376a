//! The estimate of gathered light: which stage gives it, and the bias that may remain in it.
//!
//! The same pairs give estimates of second, fourth and sixth order, E1, E0 and E00 (`kernel`). The value is E0. For smooth
//! light its bias is a small part of E0 - E1. An edge of the light inside the windows leaves the most: if the bias is
//! proportional to their size, 2/3 of E0 - E1 remains in E0, which is 2.8 times E00 - E0. The stated bias is therefore 2.8
//! times the larger of |E00 - E0| and its standard error, within 1/4 and 2/3 of |E0 - E1|; where E0 - E1 is noise, half of the
//! root of the squares of that difference and its error. A bias in proportion to the window would also have changed E0 from
//! the stage before: the larger of that change and its error limits it. If |E00 - E0| exceeds half of |E0 - E1|, higher orders do not converge, and the bias
//! is not resolved.
//!
//! Share and stage are chosen once per sensor, from its flux, never per cell. If photons of the same run contradict the
//! flux, its bias is at least that difference. No measure of the sensor has a smaller relative bias than the flux, since
//! the orders of a single measure may agree by chance.

use crate::plan::Estimator;
use crate::tally::Tally;
use crate::transport::estimate::{Bias, Estimate, Resolution};
use crate::transport::gather::stages::{FIRST_PASSES, Orders};
use crate::transport::tally::readings::{Group, MIN_LIT_GROUPS};
use crate::transport::{Readings, Stage};
use std::f64::consts::SQRT_2;

/// Share of |E0 - E1|, with its error added in quadrature, that is stated as the bias where the difference is noise, and the
/// smallest share of |E0 - E1| elsewhere, 1. Chosen by trials in scenes with known values.
pub(super) const USUAL_SHARE: f64 = 0.5;
const LEAST_SHARE: f64 = 0.25;
/// What E0 keeps of a bias in proportion to the window's size, over |E0 - E1| and over |E00 - E0|, 1: with the means over
/// a disk of √s, 2/3, and of √s times the kernels, 4/15 and 6/35.
const EDGE: [f64; 2] = [2.0 / 3.0, 2.8];
/// Share of |E0 - E1| that |E00 - E0| may reach where higher orders converge, 1.
const CONVERGING: f64 = 0.5;
/// Possible relative rounding of a flux, 1.
const ROUNDING: f64 = 1e-9;
/// Standard errors beyond which a difference counts as more than noise.
const OUT_OF_NOISE: f64 = 2.0;
/// Standard errors beyond which photons contradict a flux: they are often few, and two errors then happen by chance.
const CONTRADICTED: f64 = 3.0;
/// Number of stages, counted from the latest, from which the value is taken.
const CANDIDATES: usize = 2;
/// Standard errors above which a bias ends a stage before its planned passes.
const PLAIN: f64 = 2.0;

/// A stage, and what is known about the bias of a sensor's flux in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Judged<'a> {
    pub(super) stage: &'a Stage,
    pub(super) orders: Orders<'a>,
    pub(super) resolution: Resolution,
    /// The value.
    pub(super) flux: Tally,
    /// Share that is stated as the bias, 1: of |E0 - E1|, with its error added in quadrature where it is noise.
    share: f64,
    /// The stated bias, lm or W.
    pub(super) bias: f64,
    /// Difference from the flux of photons of the same run, and the error of that flux, lm or W; `None` where either has
    /// found too little.
    pub(super) off_photons: Option<[f64; 2]>,
}

impl<'a> Judged<'a> {
    /// Judges the sum of some scalars in a stage, which follows another one or none; `photons` carried the same light.
    pub(super) fn new(
        (stage, before): (&'a Stage, Option<&Stage>),
        photons: &Readings,
        slots: &[usize],
    ) -> Self {
        let orders = Orders::of(&stage.counts);
        let flux = orders.fourth.sum(slots);
        let lower = difference([orders.second, orders.fourth], slots);
        let higher = difference([orders.sixth, orders.fourth], slots);
        let (mut share, resolution) = bias_share(&lower, &higher);
        let apart = match resolution {
            // The orders may agree by chance alone.
            Resolution::InNoise => lower.mean().hypot(lower.std_error()),
            Resolution::Resolved | Resolution::NotResolved => lower.mean().abs(),
        };
        if let (Resolution::Resolved, Some(before)) = (resolution, before) {
            let larger = Orders::of(&before.counts).fourth.sum(slots);
            let left = left_by_stages([&larger, &flux], stage.number - before.number);
            share = share.min(left / apart).max(LEAST_SHARE);
        }
        let is_lit = |readings: &Readings| readings.lit_groups(slots) >= MIN_LIT_GROUPS;
        let off_photons = (is_lit(photons) && is_lit(orders.fourth)).then(|| {
            let photons = photons.sum(slots);
            let off = flux.mean() - photons.mean();
            let is_rounding = off.abs() <= ROUNDING * flux.mean().abs();
            [if is_rounding { 0.0 } else { off }, photons.std_error()]
        });
        let by_windows = share * apart;
        let bias =
            off_photons.map_or(by_windows, |off| by_windows.max(bias_by_photons(&flux, off)));
        Self { stage, orders, resolution, flux, share, bias, off_photons }
    }

    /// Standard error and bias together, relative to the value.
    pub(super) fn total_error(&self) -> f64 {
        let error = self.flux.std_error().hypot(self.bias) / self.flux.mean().abs();
        if error.is_nan() { f64::INFINITY } else { error }
    }

    /// Whether the bias exceeds two standard errors: enough to end a stage after a few passes.
    pub(super) fn is_plainly_limiting(&self) -> bool {
        self.bias > PLAIN * self.flux.std_error()
    }

    /// How many times the window should shrink where bias limits: once, or twice where bias and noise together are then
    /// expected to be smaller. `growth` has the variance of a pass after one and two shrinks over that of now, 1; a shrink is
    /// taken to halve the bias, as for smooth light. The next stage has at least the passes of a first one.
    pub(super) fn shrinks(&self, growth: [f64; 2]) -> u32 {
        let passes = self.orders.fourth.batch_count() as f64;
        let variance = self.flux.std_error().powi(2) * passes / passes.max(FIRST_PASSES as f64);
        let [once, twice] = [(2.0, growth[0]), (4.0, growth[1])]
            .map(|(factor, growth)| (self.bias / factor).powi(2) + growth * variance);
        if twice < once { 2 } else { 1 }
    }

    /// Whether the bias is above the noise.
    pub(super) fn is_limiting(&self) -> bool {
        self.resolution == Resolution::NotResolved || self.bias > self.flux.std_error()
    }
}

/// The stage with the smallest total error of the sum of some scalars, out of the last two, or of those of them that have passes
/// enough for an error if any has.
pub(super) fn best<'a>(
    stages: &'a [Stage],
    photons: &Readings,
    slots: &[usize],
) -> Option<Judged<'a>> {
    let earlier = stages.len().saturating_sub(CANDIDATES);
    let judged = stages.iter().enumerate().skip(earlier).map(|(place, stage)| {
        let before = place.checked_sub(1).map(|place| &stages[place]);
        Judged::new((stage, before), photons, slots)
    });
    let order = |judged: &Judged<'_>| {
        let passes = judged.orders.fourth.batch_count();
        (passes < MIN_LIT_GROUPS as u64, judged.total_error())
    };
    judged.min_by(|a, b| {
        let ((a_few, a_error), (b_few, b_error)) = (order(a), order(b));
        a_few.cmp(&b_few).then(a_error.total_cmp(&b_error))
    })
}

/// The estimate of the sensor with these scalars of flux; `None` before the first pass.
pub(crate) fn estimate<'a>(
    estimator: Estimator,
    (stages, photons): (&'a [Stage], &Readings),
    slots: &[usize],
) -> Option<Estimate<'a>> {
    let judged = best(stages, photons, slots)?;
    let Judged { orders, resolution, share, flux, bias, .. } = judged;
    // A flux that is all noise must not make every cell uncertain without bound.
    let least = if flux.mean() == 0.0 { 0.0 } else { (bias / flux.mean().abs()).min(1.0) };
    let bias = Some(Bias { other: orders.second, share, least, resolution });
    Some(Estimate { estimator, readings: orders.fourth, bias, is_contradicted: false })
}

/// The share of |E0 - E1| that may remain in E0, from E1 - E0 and E00 - E0, and how far it can be trusted.
fn bias_share(lower: &Tally, higher: &Tally) -> (f64, Resolution) {
    let size = lower.mean().abs();
    if size <= OUT_OF_NOISE * lower.std_error() || size == 0.0 {
        return (USUAL_SHARE, Resolution::InNoise);
    }
    let seen = (higher.mean().abs() - OUT_OF_NOISE * higher.std_error()).max(0.0) / size;
    if seen > CONVERGING {
        return (seen.max(1.0), Resolution::NotResolved);
    }
    let [of_lower, of_higher] = EDGE;
    let at_most = higher.mean().abs().max(higher.std_error()) / size;
    ((of_higher * at_most).clamp(LEAST_SHARE, of_lower), Resolution::Resolved)
}

/// The bias that may remain in the second of two fluxes, lm or W, by stages between which the window shrank this many times:
/// docs/method.md, eq. (32).
fn left_by_stages([before, now]: [&Tally; 2], shrinks: u32) -> f64 {
    let ratio = SQRT_2.powi(shrinks as i32);
    let apart = (before.mean() - now.mean()).abs();
    apart.max(before.std_error().hypot(now.std_error())) / (ratio - 1.0)
}

/// The least bias, lm or W, of a flux that differs from that of photons by `off`, with the error of the latter: 0 if noise
/// explains the difference.
fn bias_by_photons(flux: &Tally, [off, error]: [f64; 2]) -> f64 {
    let both = flux.std_error().hypot(error);
    if off.abs() > CONTRADICTED * both { off.abs() + error } else { 0.0 }
}

/// The difference of the sum of some scalars between two readings, pass by pass.
fn difference([one, other]: [&Readings; 2], slots: &[usize]) -> Tally {
    let of_group = |(one, other): (&Group, &Group)| {
        let apart = slots.iter().map(|&slot| one.sums[slot] - other.sums[slot]);
        apart.sum::<f64>() / one.batches as f64
    };
    Tally::of(one.groups.iter().zip(&other.groups).map(of_group))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::tally::Counts;

    fn tally(mean: f64, std_error: f64) -> Tally {
        Tally::of([mean - std_error, mean + std_error])
    }

    #[test]
    fn noise_alone_leaves_a_half() {
        let (share, resolution) = bias_share(&tally(0.1, 0.1), &tally(0.5, 0.4));
        assert_eq!((share, resolution), (USUAL_SHARE, Resolution::InNoise));
        let (share, resolution) = bias_share(&tally(0.0, 0.0), &tally(0.0, 0.0));
        assert_eq!((share, resolution), (USUAL_SHARE, Resolution::InNoise), "in the dark");
    }

    #[test]
    fn smooth_light_leaves_a_quarter_and_an_edge_two_thirds() {
        let (share, resolution) = bias_share(&tally(1.0, 0.1), &tally(0.02, 0.01));
        assert_eq!((share, resolution), (LEAST_SHARE, Resolution::Resolved));
        // Means of √s over a disk with the weights of each order: 2/3, 4/15, 6/35.
        let [second, fourth, sixth] = [2.0 / 3.0, 4.0 / 15.0, 6.0 / 35.0];
        let [lower, higher] = [second - fourth, sixth - fourth];
        let (share, resolution) = bias_share(&tally(lower, 0.0), &tally(higher, 0.0));
        assert_eq!(resolution, Resolution::Resolved);
        assert!((share * lower - fourth).abs() < 1e-12, "{share}");
    }

    #[test]
    fn a_difference_or_its_error_counts_whichever_is_larger() {
        let edge = |mean: f64, error: f64| bias_share(&tally(1.0, 0.1), &tally(mean, error)).0;
        assert!((edge(0.12, 0.08) - 2.8 * 0.12).abs() < 1e-12);
        assert!((edge(0.08, 0.12) - 2.8 * 0.12).abs() < 1e-12);
        let left = |before: f64| left_by_stages([&tally(before, 0.003), &tally(1.0, 0.004)], 2);
        assert!((left(1.006) - 0.006).abs() < 1e-12 && (left(1.004) - 0.005).abs() < 1e-12);
    }

    #[test]
    fn orders_that_do_not_converge_are_not_resolved() {
        let (share, resolution) = bias_share(&tally(1.0, 0.1), &tally(-1.5, 0.1));
        assert_eq!(resolution, Resolution::NotResolved);
        assert!((share - 1.3).abs() < 1e-12, "{share}");
    }

    #[test]
    fn an_earlier_stage_limits_the_stated_bias() {
        // In proportion to the window, 1 % of bias would have been 2 % before two shrinks.
        assert!((left_by_stages([&tally(1.02, 0.0), &tally(1.01, 0.0)], 2) - 0.01).abs() < 1e-12);
        let noise = left_by_stages([&tally(1.0, 0.003), &tally(1.0, 0.004)], 2);
        assert!((noise - 0.005).abs() < 1e-12, "{noise}");
        let photons = readings(0.0, 0.0, 8);
        let judged = |before: Option<&Stage>| {
            let orders = [0.9, 1.0, 1.03].map(|flux| readings(flux, 1e-6, 16));
            let stage = Stage { number: 2, counts: Counts::closed(orders), segments: 0 };
            Judged::new((&stage, before), &photons, &[0]).bias
        };
        assert!((judged(None) - 0.2 / 3.0).abs() < 1e-5, "an edge");
        assert!((judged(Some(&stage(0, 0.6, 1e-6, 16))) - 0.025).abs() < 1e-5, "none");
    }

    #[test]
    fn photons_contradict_beyond_three_errors() {
        let flux = tally(1.0, 0.1);
        assert_eq!(bias_by_photons(&flux, [0.4, 0.1]), 0.0);
        assert!((bias_by_photons(&flux, [-0.5, 0.1]) - 0.6).abs() < 1e-12);
    }

    #[test]
    fn orders_that_agree_by_chance_leave_their_noise_as_bias() {
        let photons = readings(0.0, 0.0, 8);
        let alternate = |sign: f64| readings(1.0, sign * 0.1, 9);
        let counts = Counts::closed([alternate(1.0), alternate(-1.0), alternate(-1.0)]);
        let stage = Stage { number: 0, counts, segments: 0 };
        let judged = Judged::new((&stage, None), &photons, &[0]);
        assert_eq!(judged.resolution, Resolution::InNoise);
        let [mean, error] = [0.2 / 9.0, 0.2 * ((80.0 / 81.0) / 8.0_f64).sqrt()];
        assert!((judged.bias - USUAL_SHARE * mean.hypot(error)).abs() < 1e-12, "{}", judged.bias);
    }

    /// Readings of passes with one scalar, which is alternately a little more and less than this.
    fn readings(flux: f64, scatter: f64, passes: u64) -> Readings {
        let of_pass = |pass: u64| Group {
            group: pass,
            batches: 1,
            sums: vec![flux + if pass.is_multiple_of(2) { scatter } else { -scatter }],
        };
        Readings::of_groups((0..passes).map(of_pass).collect())
    }

    /// A stage whose E1 differs from E0 and E00, which agree.
    fn stage(number: u32, second: f64, scatter: f64, passes: u64) -> Stage {
        let orders = [second, 1.0, 1.0].map(|flux| readings(flux, scatter, passes));
        Stage { number, counts: Counts::closed(orders), segments: 0 }
    }

    #[test]
    fn a_bias_of_two_errors_is_plain() {
        let photons = readings(0.0, 0.0, 8);
        let judged = |second| {
            let stage = stage(0, second, 0.1, 8);
            let judged = Judged::new((&stage, None), &photons, &[0]);
            [judged.is_limiting(), judged.is_plainly_limiting()]
        };
        // Standard error 0.038 of either; a quarter of |E0 - E1| is stated.
        assert_eq!(judged(1.12), [false, false]);
        assert_eq!(judged(1.2), [true, false]);
        assert_eq!(judged(1.4), [true, true]);
    }

    #[test]
    fn a_bias_far_above_the_noise_shrinks_the_window_twice() {
        let photons = readings(0.0, 0.0, 8);
        let shrinks_where = |second, passes, growth| {
            let stage = stage(0, second, 0.1, passes);
            Judged::new((&stage, None), &photons, &[0]).shrinks(growth)
        };
        let shrinks = |second, passes| shrinks_where(second, passes, [2.0, 4.0]);
        // Biases of a quarter of 0.3 and of 0.5. Standard error 0.038 of 8 passes, 0.027 of 16 to come: 0.053 after one shrink
        // and 0.057 after two for the first, 0.073 and 0.062 for the second.
        assert_eq!([shrinks(1.3, 8), shrinks(1.5, 8)], [1, 2]);
        assert_eq!([shrinks(1.3, 64), shrinks(1.5, 64)], [2, 2], "less noise");
        assert_eq!(shrinks_where(1.5, 8, [4.0, 16.0]), 1, "gather paths that grow no more");
    }

    #[test]
    fn a_stage_of_few_passes_gives_no_value_while_another_has_more() {
        let photons = readings(0.0, 0.0, 8);
        let few = MIN_LIT_GROUPS as u64 - 1;
        let stages = [stage(0, 1.4, 0.1, 16), stage(1, 1.0, 1e-6, few)];
        let chosen = |stages| best(stages, &photons, &[0]).map(|judged| judged.stage.number);
        assert_eq!(chosen(&stages), Some(0));
        assert_eq!(chosen(&stages[1..]), Some(1));
        let stages = [stage(0, 1.4, 0.1, 16), stage(1, 1.0, 1e-6, few + 1)];
        assert_eq!(chosen(&stages), Some(1));
    }
}
