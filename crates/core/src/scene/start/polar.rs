//! How often gather paths start at which angle to their sensor.
//!
//! Light from the end of a long tube arrives nearly along its axis, where the cosine law draws few directions. A learned law draws
//! each angle in proportion to the root mean square of the radiance found there, for which the variance is least (Lepage,
//! J. Comput. Phys. 27 (1978) 192). All laws keep the order of the numbers that they are given, so that points which fill a
//! cell evenly still do so. This module does not know paths.

/// Bins of the angle. Bin i begins where sin²θ = (i/BINS)⁴, so that narrow beams are resolved.
const BINS: usize = 32;
/// Share of the starts that follow the cosine law whatever was learned, 1: where light was overlooked, or for a cell with other light
/// than most, the mean square of what a path finds grows at most by its reciprocal.
const COSINE_SHARE: f64 = 0.4;
/// A learned law is used only if it reduces this mean square below this share of that of the cosine law, 1.
const LARGEST_RATIO: f64 = 0.75;

/// The law of the angles θ to the normal at which gather paths start.
#[derive(Debug, Clone)]
pub enum PolarLaw {
    /// A density in proportion to cos θ.
    Cosine,
    /// Every bin equally often, to learn what light comes from where.
    EvenBins,
    /// What has been learned.
    Learned(Box<LearnedLaw>),
}

/// A density that is linear in sin²θ within each bin, and continuous.
#[derive(Debug, Clone)]
pub struct LearnedLaw {
    /// Density over that of the cosine law at the start of each bin and at the end of the last.
    density: [f64; BINS + 1],
    /// Share of the starts before each bin, and 1.
    before: [f64; BINS + 1],
}

/// Sums of squared radiances found in each bin, where all are drawn from equally often.
pub type PolarSquares = [f64; BINS];

impl PolarLaw {
    /// sin²θ for uniform `u`.
    #[inline]
    pub(super) fn draw(&self, u: f64) -> f64 {
        match self {
            Self::Cosine => u,
            Self::EvenBins => {
                let place = u * BINS as f64;
                let bin = place as usize;
                edge(bin) + (place - bin as f64) * width(bin)
            }
            Self::Learned(law) => law.draw(u),
        }
    }

    /// The density of the cosine law over that of this law at sin²θ.
    #[inline]
    pub(super) fn reciprocal(&self, sin2: f64) -> f64 {
        match self {
            Self::Cosine => 1.0,
            Self::EvenBins => BINS as f64 * width(bin(sin2)),
            Self::Learned(law) => 1.0 / law.density(sin2),
        }
    }

    /// Learns from two independent sets of paths by [`PolarLaw::EvenBins`]: the cosine law, unless what is learned from each set
    /// helps the other.
    pub fn learned(sets: &[PolarSquares; 2]) -> Self {
        let [one, other] = sets;
        let cosine = LearnedLaw { density: [1.0; BINS + 1], before: std::array::from_fn(edge) };
        let helps = |from: &PolarSquares, with: &PolarSquares| {
            LearnedLaw::fitted(from)
                .is_some_and(|law| law.mean_square(with) < LARGEST_RATIO * cosine.mean_square(with))
        };
        let both: PolarSquares = std::array::from_fn(|bin| one[bin] + other[bin]);
        match LearnedLaw::fitted(&both) {
            Some(law) if helps(one, other) && helps(other, one) => Self::Learned(Box::new(law)),
            Some(_) | None => Self::Cosine,
        }
    }
}

impl LearnedLaw {
    /// The best law for these squares; `None` without light.
    fn fitted(squares: &PolarSquares) -> Option<Self> {
        let roots = squares.map(f64::sqrt);
        // At an edge, the mean of the bins beside it.
        let wanted: [f64; BINS + 1] = std::array::from_fn(|edge| {
            let [below, above] = [edge.saturating_sub(1), edge.min(BINS - 1)];
            0.5 * (roots[below] + roots[above])
        });
        let share = |density: &[f64; BINS + 1], bin: usize| {
            0.5 * (density[bin] + density[bin + 1]) * width(bin)
        };
        let all: f64 = (0..BINS).map(|bin| share(&wanted, bin)).sum();
        if all <= 0.0 {
            return None;
        }
        let density = wanted.map(|wanted| COSINE_SHARE + (1.0 - COSINE_SHARE) * wanted / all);
        let mut before = [0.0; BINS + 1];
        for bin in 0..BINS {
            before[bin + 1] = before[bin] + share(&density, bin);
        }
        // The sum is 1 but for rounding.
        before[BINS] = 1.0;
        Some(Self { density, before })
    }

    fn draw(&self, u: f64) -> f64 {
        let bin = (self.before.partition_point(|before| *before <= u) - 1).min(BINS - 1);
        let [from, to] = [bin, bin + 1].map(edge);
        let [first, last] = [self.density[bin], self.density[bin + 1]];
        // ∫ (first + slope x) dx = share, with x from the start of the bin.
        let share = u - self.before[bin];
        let slope = (last - first) / (to - from);
        let x = 2.0 * share / (first + (first * first + 2.0 * slope * share).max(0.0).sqrt());
        // The last bin ends at 90°, which no start may have.
        (from + x).min(to.next_down())
    }

    /// Density at sin²θ over that of the cosine law.
    fn density(&self, sin2: f64) -> f64 {
        let bin = bin(sin2);
        let [from, to] = [bin, bin + 1].map(edge);
        let [first, last] = [self.density[bin], self.density[bin + 1]];
        first + (last - first) * ((sin2 - from) / (to - from)).clamp(0.0, 1.0)
    }

    /// Mean square of what paths by this law find, up to a factor.
    fn mean_square(&self, squares: &PolarSquares) -> f64 {
        let of_bin = |bin: usize| {
            width(bin) * squares[bin] / (0.5 * (self.density[bin] + self.density[bin + 1]))
        };
        (0..BINS).map(of_bin).sum()
    }
}

/// The bin of sin²θ.
pub(super) fn bin(sin2: f64) -> usize {
    ((BINS as f64 * sin2.max(0.0).sqrt().sqrt()) as usize).min(BINS - 1)
}

/// sin²θ where a bin begins.
fn edge(bin: usize) -> f64 {
    (bin as f64 / BINS as f64).powi(4)
}

/// Growth of sin²θ over a bin.
fn width(bin: usize) -> f64 {
    edge(bin + 1) - edge(bin)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares of radiances that fall by e at this sin²θ.
    fn beam(sin2: f64) -> PolarSquares {
        std::array::from_fn(|bin| (-(edge(bin) + 0.5 * width(bin)) / sin2).exp())
    }

    fn laws() -> [PolarLaw; 4] {
        let of = |sin2| PolarLaw::learned(&[beam(sin2); 2]);
        [PolarLaw::Cosine, PolarLaw::EvenBins, of(0.1), of(1e-4)]
    }

    #[test]
    fn numbers_keep_their_order_and_have_the_density_of_the_law() {
        const STEPS: usize = 100_000;
        for law in laws() {
            let at = |step: usize| law.draw(step as f64 / STEPS as f64);
            for step in 0..STEPS {
                let [from, to] = [at(step), if step + 1 < STEPS { at(step + 1) } else { 1.0 }];
                assert!(0.0 <= from && from < to && to <= 1.0, "{law:?}: {from}, {to}");
                if bin(from) == bin(to) {
                    let expected = law.reciprocal(0.5 * (from + to)) / STEPS as f64;
                    assert!(((to - from) / expected - 1.0).abs() < 1e-3, "{law:?} at {from}");
                }
            }
            assert!(law.draw(1.0f64.next_down()) < 1.0 && law.draw(0.0) == 0.0);
        }
    }

    #[test]
    fn a_bin_begins_at_its_edge() {
        for own in 0..BINS {
            assert_eq!(bin(edge(own) + 0.5 * width(own)), own);
        }
        assert_eq!([bin(0.0), bin(1.0)], [0, BINS - 1]);
    }

    #[test]
    fn narrow_beams_are_drawn_often_and_others_never_rarely() {
        let [.., wide, narrow] = laws();
        for (law, sin2, gain) in [(wide, 0.1, 2.0), (narrow, 1e-4, 500.0)] {
            assert!(1.0 / law.reciprocal(0.1 * sin2) > gain, "{law:?}");
            let least = (0..1000).map(|step| 1.0 / law.reciprocal(f64::from(step) / 999.0));
            assert!(least.fold(f64::INFINITY, f64::min) >= COSINE_SHARE, "{law:?}");
        }
    }

    fn is_learned(sets: &[PolarSquares; 2]) -> bool {
        matches!(PolarLaw::learned(sets), PolarLaw::Learned(_))
    }

    #[test]
    fn nothing_is_learned_without_light_from_even_light_or_from_single_finds() {
        let dark = [0.0; BINS];
        let spike = |bin: usize| {
            let mut squares = [1e-3; BINS];
            squares[bin] = 1.0;
            squares
        };
        for sets in [[dark, dark], [beam(0.1), dark], [beam(1e3); 2], [spike(20), spike(25)]] {
            assert!(!is_learned(&sets), "{sets:?}");
        }
        assert!(is_learned(&[spike(20); 2]), "both sets know it");
    }
}
