//! A curve over rings about the pole, averaged over as many rings as its noise requires.

use crate::measure::noisy::NoisySample;

/// The number of rings on each side over which each ring of a curve is averaged.
#[derive(Debug, Clone)]
pub(crate) struct Smoothing(Vec<usize>);

impl Smoothing {
    /// As few rings as contain this many counts of a line, limited on each side.
    pub(crate) fn of(sample: &NoisySample, line: &[f64], counts: f64, most: usize) -> Self {
        let counts_of = |ring: usize| match (sample.counts[ring], line[ring]) {
            (count, value) if count > 0.0 => value / count,
            (_, value) => {
                if value > 0.0 {
                    f64::INFINITY
                } else {
                    0.0
                }
            }
        };
        let window = |ring| {
            let mut held = 0.0;
            let is_enough = |&window: &usize| {
                held += outermost(line.len(), ring, window).map(counts_of).sum::<f64>();
                held >= counts
            };
            (0..most).find(is_enough).unwrap_or(most)
        };
        Self((0..line.len()).map(window).collect())
    }

    /// Over twice as many rings.
    pub(crate) fn wider(&self) -> Self {
        Self(self.0.iter().map(|window| 2 * window).collect())
    }

    /// A line averaged by solid angle, the weights of `sample`.
    pub(crate) fn smooth(&self, sample: &NoisySample, line: &[f64]) -> Vec<f64> {
        let mean = |(ring, window): (usize, &usize)| {
            let rings = around(line.len(), ring, *window);
            let (sum, weight) = rings.fold((0.0, 0.0), |(sum, weight), at| {
                (sum + sample.weights[at] * line[at], weight + sample.weights[at])
            });
            sum / weight
        };
        self.0.iter().enumerate().map(mean).collect()
    }
}

/// Rings at most `window` away. A line is mirrored beyond its ends. That is exact for a curve that
/// is the same all round, and an approximation about γ = 180° for a line with two different halves,
/// which would join there.
fn around(rings: usize, ring: usize, window: usize) -> impl Iterator<Item = usize> {
    let window = window.min(rings);
    (rings + ring - window..=rings + ring + window).map(move |at| mirrored(rings, at))
}

/// The two rings `window` away; the ring itself for 0.
fn outermost(rings: usize, ring: usize, window: usize) -> impl Iterator<Item = usize> {
    let at = rings + ring;
    let both = [at - window.min(rings), at + window];
    both.into_iter().take(if window == 0 { 1 } else { 2 }).map(move |at| mirrored(rings, at))
}

/// The ring at a position of a line mirrored at its ends, counted from `rings` before the first.
fn mirrored(rings: usize, at: usize) -> usize {
    let at = at % (2 * rings);
    if at < rings { rings - 1 - at } else { at - rings }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::noisy::{Noisy, WeightedValue};

    fn sample(counts: &[f64]) -> NoisySample {
        let read = |&value: &f64| Noisy { value, std_error: value.sqrt(), count: 1.0 };
        let parts = counts.iter().map(|value| WeightedValue { read: read(value), weight: 1.0 });
        NoisySample::of(&parts.collect::<Vec<_>>())
    }

    #[test]
    fn a_line_is_mirrored_at_its_ends() {
        assert_eq!(around(4, 0, 2).collect::<Vec<_>>(), [1, 0, 0, 1, 2]);
        assert_eq!(around(4, 3, 2).collect::<Vec<_>>(), [1, 2, 3, 3, 2]);
        assert_eq!(around(2, 0, 9).count(), 5);
    }

    #[test]
    fn windows_hold_the_counts_asked_for_and_are_no_wider_than_allowed() {
        let line = [1000.0, 4.0, 4.0, 4.0, 0.0, 0.0];
        let sample = sample(&line);
        assert_eq!(Smoothing::of(&sample, &line, 10.0, 2).0, [0, 1, 1, 2, 2, 2]);
        assert_eq!(Smoothing::of(&sample, &line, 0.0, 2).0, [0; 6]);
    }

    #[test]
    fn a_straight_line_stays_straight_and_a_constant_one_constant() {
        let line: Vec<f64> = (0..9).map(|ring| 100.0 - 10.0 * f64::from(ring)).collect();
        let sample = sample(&line);
        let smooth = Smoothing(vec![2; 9]).smooth(&sample, &line);
        assert!((2..7).all(|ring| (smooth[ring] - line[ring]).abs() < 1e-12), "{smooth:?}");
        assert!(
            Smoothing(vec![3; 9])
                .smooth(&sample, &[2.0; 9])
                .iter()
                .all(|at| (at - 2.0).abs() < 1e-15)
        );
    }
}
