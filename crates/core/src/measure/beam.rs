//! The angle over which a beam keeps a share of its largest intensity.
//!
//! A plane through the pole has two half-planes. In each, the edge of the beam is where the
//! intensity, interpolated linearly between rings, first falls below the level on the way outward
//! from that half-plane's own maximum: a maximum off the axis, or a dip on it, is inside the beam,
//! and weak lobes further out are not. Where one half-plane never reaches the level, the beam lies
//! wholly in the other, and the inner edge there bounds it. The level is a share of the largest
//! intensity in the plane, corrected for noise. A curve that never falls below the level gives 360
//! deg.

use crate::measure::Status;
use crate::measure::evidence::status_by_error;
use crate::measure::noise::Noise;
use crate::measure::noisy::{Noisy, NoisySample, WeightedValue};
use crate::measure::smoothing::Smoothing;
use crate::tally::Tally;
use std::f64::consts::{PI, TAU};

/// Number of redraws of the curve with its noise that give the error of the angle: good to 1/sqrt(2
/// · 100) = 7 %.
const REPLICAS: usize = 100;
/// Fraction of the mean deviation of replicas that is subtracted as bias, 1. This and the next four
/// were chosen with the trials of docs/trials.md.
const BIAS_TAKEN: f64 = 0.8;
/// Counts over which the curve is averaged to find its edges, and its top, which moves both.
const COUNTS_AT_EDGE: f64 = 100.0;
const COUNTS_AT_TOP: f64 = 20.0;
/// Largest number of rings used for this on each side, as a fraction of those that contain the
/// middle half of the light.
const REACH_AT_EDGE: f64 = 0.25;
const REACH_AT_TOP: f64 = 0.5;
/// Richardson's 2² - 1: twice the window adds three times a bias that scales with its square.
const RICHARDSON: f64 = 3.0;
/// Fraction of the top that averaging for the edges must keep, 1; otherwise edges are read from the
/// curve averaged for the top.
const TOP_KEPT: f64 = 0.6;

/// A full angle, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FullAngle {
    pub(crate) value: f64,
    pub(crate) std_error: f64,
    /// Possible bias from rings and averages of finite width, rad.
    pub(crate) bias: f64,
    pub(crate) status: Status,
}

/// Full angle at `share` of the maximum; `gammas` are the angles of the rings from the pole, rad. `None` in the dark.
///
/// The angle is read off the curve averaged over neighbouring rings. The effect of noise on this
/// reading is found from curves redrawn about this one (a parametric bootstrap, as in
/// [`crate::measure::extremes`]): their scatter is the error, and most of their mean deviation is
/// subtracted.
pub(crate) fn full_angle(gammas: &[f64], halves: [&[Noisy]; 2], share: f64) -> Option<FullAngle> {
    let plane = PlaneLine::of(gammas, halves);
    let read = &plane.sample.values;
    let peak = plane.parts[highest(read)].read;
    if peak.value <= 0.0 {
        return None;
    }
    let averaging = plane.averaging(read);
    let angle = |line: &[f64], averaging: &Averaging| plane.angle(gammas, line, share, averaging);
    let value = angle(read, &averaging);
    let status = status_by_error(peak.value, peak.std_error);
    let rings =
        plane.split(read, |halves| ring_bias(gammas, halves, |halves| share * highest_of(halves)));
    if plane.parts.iter().any(|part| !part.read.std_error.is_finite()) {
        return Some(FullAngle { value, std_error: f64::INFINITY, bias: rings.abs(), status });
    }
    let averaged = (angle(read, &averaging.wider()) - value) / RICHARDSON;
    let means = averaging.edge.smooth(&plane.sample, read);
    let mut noise = Noise::new();
    let drawn = Tally::of(
        (0..REPLICAS).map(|_| angle(&plane.sample.drawn(&means, &mut noise), &averaging)),
    );
    let deviation = drawn.mean() - angle(&means, &averaging);
    Some(FullAngle {
        value: (value - BIAS_TAKEN * deviation).clamp(0.0, TAU),
        std_error: drawn.std_deviation(),
        bias: rings.hypot(averaged),
        status,
    })
}

/// The windows over which a curve is averaged.
struct Averaging {
    top: Smoothing,
    edge: Smoothing,
}

impl Averaging {
    fn wider(&self) -> Self {
        Self { top: self.top.wider(), edge: self.edge.wider() }
    }
}

/// The curve in a plane through the pole, as one line across it.
struct PlaneLine {
    parts: Vec<WeightedValue>,
    sample: NoisySample,
    rings: usize,
}

impl PlaneLine {
    /// A curve that is the same on both sides has the same noise on both, and is one half only.
    fn of(gammas: &[f64], [ahead, behind]: [&[Noisy]; 2]) -> Self {
        let part =
            |(read, gamma): (&Noisy, &f64)| WeightedValue { read: *read, weight: gamma.sin() };
        let half = |half: &[Noisy]| half.iter().zip(gammas).map(part).collect::<Vec<_>>();
        let mut parts = half(ahead);
        if ahead != behind {
            // From the far end of one half over the pole to that of the other.
            let mut line = half(behind);
            line.reverse();
            line.append(&mut parts);
            parts = line;
        }
        Self { sample: NoisySample::of(&parts), parts, rings: ahead.len() }
    }

    /// Applies a function to both halves of a line.
    fn split<T>(&self, line: &[f64], of: impl Fn([&[f64]; 2]) -> T) -> T {
        if line.len() == self.rings {
            return of([line, line]);
        }
        let (behind, ahead) = line.split_at(self.rings);
        let behind: Vec<f64> = behind.iter().rev().copied().collect();
        of([ahead, &behind])
    }

    /// The full angle of a line at a share of its largest value, each from its own average of the
    /// line.
    fn angle(&self, gammas: &[f64], line: &[f64], share: f64, averaging: &Averaging) -> f64 {
        let top = averaging.top.smooth(&self.sample, line);
        let level = share * top[highest(&top)];
        let line = averaging.edge.smooth(&self.sample, line);
        self.split(&line, |halves| width(gammas, halves, level))
    }

    /// The averaging that the noise of a line requires.
    fn averaging(&self, line: &[f64]) -> Averaging {
        let half = self.half_of_light(line);
        let over = |counts: f64, reach: f64| {
            Smoothing::of(&self.sample, line, counts, (reach * half) as usize)
        };
        let top = over(COUNTS_AT_TOP, REACH_AT_TOP);
        let edge = over(COUNTS_AT_EDGE, REACH_AT_EDGE);
        let largest = |by: &Smoothing| {
            let line = by.smooth(&self.sample, line);
            line[highest(&line)]
        };
        let is_flattened = largest(&edge) < TOP_KEPT * largest(&top);
        Averaging { edge: if is_flattened { top.clone() } else { edge }, top }
    }

    /// Rings on each side of the middle that contain half of the light of a line.
    fn half_of_light(&self, line: &[f64]) -> f64 {
        let light = || line.iter().zip(&self.sample.weights).map(|(value, weight)| value * weight);
        let total: f64 = light().sum();
        let up_to = |share: f64| {
            let mut rest = share * total;
            let is_beyond = |light: f64| {
                rest -= light;
                rest <= 0.0
            };
            light().position(is_beyond).unwrap_or(0) as f64
        };
        if line.len() == self.rings { up_to(0.5) } else { 0.5 * (up_to(0.75) - up_to(0.25)) }
    }
}

fn highest_of(halves: [&[f64]; 2]) -> f64 {
    halves.map(|half| half[highest(half)]).into_iter().fold(0.0, f64::max)
}

/// Shift of the angle by the width of the rings: half of its change when rings are taken in pairs.
/// This is half of an error that scales with the width, and one and a half times one that scales
/// with its square.
fn ring_bias(gammas: &[f64], halves: [&[f64]; 2], level: impl Fn([&[f64]; 2]) -> f64) -> f64 {
    // Solid angles of rings of equal width are proportional to the sine.
    let paired = |values: &[f64]| -> Vec<f64> {
        let rings = values.chunks(2).zip(gammas.chunks(2));
        let mean = |(values, gammas): (&[f64], &[f64])| {
            let weights: Vec<f64> = gammas.iter().map(|gamma| gamma.sin()).collect();
            let sum: f64 = values.iter().zip(&weights).map(|(value, weight)| value * weight).sum();
            sum / weights.iter().sum::<f64>()
        };
        rings.map(mean).collect()
    };
    let cosine = |gammas: &[f64]| gammas.iter().map(|gamma| gamma.cos()).sum::<f64>();
    let middles: Vec<f64> =
        gammas.chunks(2).map(|pair| (cosine(pair) / pair.len() as f64).acos()).collect();
    let coarse = halves.map(paired);
    let coarse = [coarse[0].as_slice(), coarse[1].as_slice()];
    0.5 * (width(&middles, coarse, level(coarse)) - width(gammas, halves, level(halves)))
}

/// Angle between the two edges, rad.
fn width(gammas: &[f64], halves: [&[f64]; 2], level: f64) -> f64 {
    let edges =
        [edge(gammas, halves[0], halves[1], level), edge(gammas, halves[1], halves[0], level)];
    (edges[0] + edges[1]).max(0.0)
}

/// γ of the beam's edge in a half-plane, rad; negative if the beam lies wholly in the other one.
fn edge(gammas: &[f64], own: &[f64], other: &[f64], level: f64) -> f64 {
    let peak = highest(own);
    if own[peak] >= level {
        let below = (peak + 1..own.len()).find(|&ring| own[ring] < level);
        return below.map_or(PI, |ring| crossing(gammas, own, ring, level));
    }
    let peak = highest(other);
    let below = (0..peak).rev().find(|&ring| other[ring] < level);
    // Without an inner edge the beam ends at the pole.
    -below.map_or(0.0, |ring| crossing(gammas, other, ring + 1, level))
}

/// Where the line from the previous ring to this one crosses the level, rad.
fn crossing(gammas: &[f64], values: &[f64], ring: usize, level: f64) -> f64 {
    let (before, after) = (values[ring - 1], values[ring]);
    let part = if before == after { 0.5 } else { (before - level) / (before - after) };
    gammas[ring - 1] + part.clamp(0.0, 1.0) * (gammas[ring] - gammas[ring - 1])
}

fn highest(values: &[f64]) -> usize {
    (1..values.len()).fold(0, |best, ring| if values[ring] > values[best] { ring } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gammas(rings: usize) -> Vec<f64> {
        (0..rings).map(|ring| PI * (ring as f64 + 0.5) / rings as f64).collect()
    }

    fn curve(gammas: &[f64], noise: f64, f: impl Fn(f64) -> f64) -> Vec<Noisy> {
        gammas
            .iter()
            .map(|&gamma| Noisy { value: f(gamma), std_error: noise * f(gamma), count: 0.0 })
            .collect()
    }

    fn degrees(gammas: &[f64], ahead: &[Noisy], behind: &[Noisy], share: f64) -> f64 {
        full_angle(gammas, [ahead, behind], share).unwrap().value.to_degrees()
    }

    #[test]
    fn a_cosine_power_has_the_known_half_angles() {
        // cos^5: half at acos(0.5^(1/5)) = 29.477 deg, a tenth at acos(0.1^(1/5)) = 50.88 deg.
        let gammas = gammas(1800);
        let beam = curve(&gammas, 0.0, |gamma| gamma.cos().max(0.0).powi(5));
        assert!((degrees(&gammas, &beam, &beam, 0.5) - 2.0 * 29.477).abs() < 2e-3);
        let tenth = 0.1f64.powf(0.2).acos().to_degrees();
        assert!((degrees(&gammas, &beam, &beam, 0.1) - 2.0 * tenth).abs() < 2e-3);
    }

    #[test]
    fn what_wide_rings_hide_of_the_top_is_in_the_bias() {
        // Means of cos^20 over rings of 2 and 1 degrees; half of it is at acos(0.5^(1/20)) = 14.998 deg.
        for rings in [90, 180] {
            let gammas = gammas(rings);
            let half = 0.5 * PI / f64::from(rings as u32);
            let mean = |gamma: f64| {
                let [inner, outer] = [gamma - half, gamma + half].map(f64::cos);
                (inner.powi(21) - outer.powi(21)) / (21.0 * (inner - outer))
            };
            let beam = curve(&gammas[..rings / 2], 0.0, mean);
            let found = full_angle(&gammas, [&beam, &beam], 0.5).unwrap();
            let off = (found.value.to_degrees() - 2.0 * 14.99767).abs();
            let bias = found.bias.to_degrees();
            assert!(off > 0.3 * bias && off < bias, "off by {off}, bias {bias}");
        }
    }

    #[test]
    fn a_batwing_is_as_wide_as_its_outer_edges() {
        let gammas = gammas(1800);
        // Peaks at 40 deg, a dip below half on the axis, a weak lobe at 120 deg.
        let bell = |gamma: f64, at: f64| (-(gamma.to_degrees() - at).powi(2) / 200.0).exp();
        let wing = curve(&gammas, 0.0, |gamma| bell(gamma, 40.0) + 0.3 * bell(gamma, 120.0));
        // exp(-x²/200) = 1/2 at x = 11.774.
        assert!((degrees(&gammas, &wing, &wing, 0.5) - 2.0 * 51.774).abs() < 0.01);
    }

    #[test]
    fn a_tilted_beam_is_measured_across_itself() {
        let gammas = gammas(1800);
        let bell =
            |at: f64| curve(&gammas, 0.0, move |g| (-(g.to_degrees() - at).powi(2) / 200.0).exp());
        // Centred at 30 deg in one half-plane, at -30 deg seen from the other.
        assert!((degrees(&gammas, &bell(30.0), &bell(-30.0), 0.5) - 2.0 * 11.774).abs() < 0.01);
        assert!((degrees(&gammas, &bell(5.0), &bell(-5.0), 0.5) - 2.0 * 11.774).abs() < 0.01);
    }

    #[test]
    fn an_even_sphere_is_all_beam_and_a_dark_one_none() {
        let gammas = gammas(18);
        let even = curve(&gammas, 0.0, |_| 2.0);
        assert_eq!(degrees(&gammas, &even, &even, 0.5), 360.0);
        let dark = curve(&gammas, 0.0, |_| 0.0);
        assert_eq!(full_angle(&gammas, [&dark, &dark], 0.5), None);
    }

    #[test]
    fn a_narrow_peak_of_few_counts_has_its_own_width() {
        // 60 counts in the first ring on 10,000 of a Lambertian source: half of the peak is within the second ring.
        let gammas = gammas(180);
        for stream in 0..5 {
            let mut noise = Noise::of_stream(stream);
            let edge = |ring: usize| (PI * ring as f64 / 180.0).cos();
            let curve: Vec<Noisy> = (0..180)
                .map(|ring| {
                    let [inner, outer] = [edge(ring), edge(ring + 1)];
                    let lambertian = 1e4 * (inner.max(0.0).powi(2) - outer.max(0.0).powi(2));
                    let count = 1.0 / (inner - outer);
                    let found = noise.poisson(lambertian + if ring == 0 { 60.0 } else { 0.0 });
                    Noisy { value: found * count, std_error: found.sqrt() * count, count }
                })
                .collect();
            let found = degrees(&gammas, &curve, &curve, 0.5);
            assert!((1.0..4.0).contains(&found), "stream {stream}: {found}");
        }
    }

    #[test]
    fn noise_gives_an_error_of_the_right_size() {
        // One crossing of a straight slope: I = 1 - γ/γ₀ falls to half with slope 1/γ₀, so an error of ε in the two
        // rings about it and in the maximum moves each edge by about ε γ₀.
        let gammas = gammas(90);
        let slope = |gamma: f64| (1.0 - gamma / 1.5).max(0.0);
        let noisy: Vec<Noisy> = gammas
            .iter()
            .map(|&gamma| Noisy { value: slope(gamma), std_error: 0.01, count: 0.0 })
            .collect();
        let found = full_angle(&gammas, [&noisy, &noisy], 0.5).unwrap();
        assert!(found.std_error > 0.015 && found.std_error < 0.05, "{}", found.std_error);
        assert_eq!(found.status, Status::Ok);
    }
}
