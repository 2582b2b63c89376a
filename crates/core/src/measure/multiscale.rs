//! A map or curve with its noise removed, scale by scale.
//!
//! Neighbours in the list are neighbours on the sensor. The list is halved repeatedly, and the two
//! halves differ by a contrast of known noise. Of N contrasts d of one scale with variances s², the
//! excess of mean d²/s² over 1 estimates their ratio of signal to noise, q. All are shrunk by
//! (q/(1+q))^0.4, so that the result has slightly more than the spread of the signal, which the
//! power ½ would give (constrained empirical Bayes: Louis, J. Am. Stat. Assoc. 79 (1984) 393; by
//! scales as in Abramovich, Sapatinas & Silverman, J. R. Stat. Soc. B 60 (1998) 725). A contrast
//! far above the noise of its scale is kept (threshold a little above s (2 ln N)^½: Donoho &
//! Johnstone, Biometrika 81 (1994) 425). Means over halves are kept, and so is the mean of all. The
//! cost is linear in the length of the list.

/// Excess of mean d²/s² that counts as noise, in its standard errors (2/N)^½.
const EXCESS: f64 = 1.2;
/// Power of the share of signal that contrasts are shrunk by, 1; chosen with the trials of
/// docs/trials.md, like all numbers here.
const SHRINKAGE: f64 = 0.4;
/// Cap on d²/s² in the mean of a scale: larger contrasts are judged one by one.
const LARGEST: f64 = 8.0;
/// Values below this part of the mean are rounding, 1.
const ROUNDING: f64 = 1e-12;
/// Margin beyond 2 ln N by which the square of a contrast is kept, in squares of its standard
/// error.
const MARGIN: f64 = 2.75;
/// Squares of contrasts this many times above the threshold are kept whole; between, a part of them
/// (firm shrinkage: Gao & Bruce, Stat. Sinica 7 (1997) 855).
const FIRM: f64 = 2.5;

/// The halves of a list, the halves of those, and so on.
#[derive(Debug)]
pub(crate) struct Multiscale {
    leaves: usize,
    /// Children before parents; the last one spans all.
    nodes: Vec<ScaleNode>,
    levels: usize,
}

#[derive(Debug)]
struct ScaleNode {
    /// Positions of both halves: leaves first, then nodes.
    halves: [usize; 2],
    /// Their shares of the weight.
    shares: [f64; 2],
    level: usize,
    /// Variance of the contrast over the mean.
    noise: f64,
}

/// The known values of a part of the list.
struct ListSpan {
    place: usize,
    weight: f64,
    /// Variance of the mean over the mean.
    noise: f64,
}

impl Multiscale {
    /// From values with these weights, and variances over their means.
    pub(crate) fn new(weights: &[f64], noise: &[f64]) -> Self {
        let leaves = weights.len();
        let mut tree = Self { leaves, nodes: Vec::with_capacity(leaves), levels: 0 };
        tree.halve(0, weights, noise, 0);
        tree
    }

    fn halve(&mut self, first: usize, weights: &[f64], noise: &[f64], level: usize) -> ListSpan {
        if let [weight] = weights {
            return ListSpan { place: first, weight: *weight, noise: noise[0] };
        }
        let half = weights.len() / 2;
        let a = self.halve(first, &weights[..half], &noise[..half], level + 1);
        let b = self.halve(first + half, &weights[half..], &noise[half..], level + 1);
        let weight = a.weight + b.weight;
        let shares = [a.weight / weight, b.weight / weight];
        let (halves, noise) = ([a.place, b.place], a.noise + b.noise);
        self.nodes.push(ScaleNode { halves, shares, level, noise });
        self.levels = self.levels.max(level + 1);
        let noise = shares[0].powi(2) * a.noise + shares[1].powi(2) * b.noise;
        ListSpan { place: self.leaves + self.nodes.len() - 1, weight, noise }
    }

    /// The values without their noise.
    pub(crate) fn without_noise(&self, values: &[f64]) -> Vec<f64> {
        let mut means = values.to_vec();
        // Excess over 1 of d²/s², and the number of contrasts, by scale.
        let mut scales = vec![(0.0, 0.0); self.levels];
        for node in &self.nodes {
            let [a, b] = node.halves.map(|half| means[half]);
            let mean = node.shares[0] * a + node.shares[1] * b;
            means.push(mean);
            let variance = node.noise * mean;
            if variance > 0.0 {
                let (excess, count) = &mut scales[node.level];
                *excess += ((a - b).powi(2) / variance).min(LARGEST) - 1.0;
                *count += 1.0;
            }
        }
        let scales: Vec<ShrunkScale> = scales.into_iter().map(ShrunkScale::of).collect();
        let mut denoised = means.clone();
        for (index, node) in self.nodes.iter().enumerate().rev() {
            let mean = denoised[self.leaves + index];
            let [a, b] = node.halves.map(|half| means[half]);
            let kept =
                scales[node.level].keeps((a - b).powi(2), node.noise * means[self.leaves + index]);
            denoised[node.halves[0]] = (mean + node.shares[1] * kept * (a - b)).max(0.0);
            denoised[node.halves[1]] = (mean - node.shares[0] * kept * (a - b)).max(0.0);
        }
        denoised.truncate(self.leaves);
        // A dark cell that holds only rounding is zero.
        let faint = ROUNDING * means.last().copied().unwrap_or(0.0);
        denoised.iter_mut().filter(|value| **value < faint).for_each(|value| *value = 0.0);
        denoised
    }
}

/// How contrasts of one scale are shrunk.
struct ShrunkScale {
    /// The factor applied to all, 1.
    factor: f64,
    /// The d²/s² up to which no contrast is kept individually.
    threshold: f64,
}

impl ShrunkScale {
    fn of((excess, count): (f64, f64)) -> Self {
        let count = f64::max(count, 1.0);
        let signal = ((excess - EXCESS * (2.0 * count).sqrt()) / count).max(0.0);
        let factor = (signal / (1.0 + signal)).powf(SHRINKAGE);
        Self { factor, threshold: MARGIN + 2.0 * count.ln() }
    }

    /// The fraction of a contrast with this square that is kept.
    fn keeps(&self, square: f64, variance: f64) -> f64 {
        if variance <= 0.0 {
            return 1.0;
        }
        let own = (square / (self.threshold * variance) - 1.0) / (FIRM - 1.0);
        own.clamp(0.0, 1.0).sqrt().max(self.factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::noise::Noise;

    fn denoised(truth: &[f64], counts: f64) -> Vec<f64> {
        let mut noise = Noise::new();
        let weights = vec![1.0; truth.len()];
        let values: Vec<f64> =
            truth.iter().map(|value| noise.poisson(value * counts) / counts).collect();
        let noise = vec![1.0 / counts; truth.len()];
        Multiscale::new(&weights, &noise).without_noise(&values)
    }

    fn rms(values: &[f64], truth: &[f64]) -> f64 {
        let squares: f64 = values.iter().zip(truth).map(|(a, b)| (a - b).powi(2)).sum();
        (squares / truth.len() as f64).sqrt()
    }

    #[test]
    fn values_without_noise_stay_as_they_are() {
        let values = [1.0, 5.0, 2.0, 0.0, 3.0];
        let found = Multiscale::new(&[1.0, 2.0, 1.0, 1.0, 3.0], &[0.0; 5]).without_noise(&values);
        assert!(rms(&found, &values) < 1e-15, "{found:?}");
    }

    #[test]
    fn a_flat_field_is_flat_again_and_a_step_and_a_spot_stay() {
        let flat = vec![1.0; 1000];
        // Of a noise of 0.1.
        assert!(rms(&denoised(&flat, 100.0), &flat) < 0.03);
        let step: Vec<f64> = (0..1024).map(|i| if i < 512 { 0.5 } else { 1.0 }).collect();
        assert!(rms(&denoised(&step, 100.0), &step) < 0.03);
        let mut spot = flat.clone();
        spot[700] = 5.0;
        assert!((denoised(&spot, 100.0)[700] - 5.0).abs() < 0.6);
    }

    #[test]
    fn the_mean_by_weight_is_kept() {
        let (weights, values) = ([1.0, 3.0, 2.0], [2.0, 1.0, 4.0]);
        let found = Multiscale::new(&weights, &[0.3, 0.1, 0.2]).without_noise(&values);
        let mean = |of: &[f64]| weights.iter().zip(of).map(|(w, v)| w * v).sum::<f64>();
        assert!((mean(&found) - mean(&values)).abs() < 1e-14);
    }
}
