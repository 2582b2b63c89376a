//! How the cube is split into boxes of even light: a density estimation tree (P. Ram and A. Gray, Density estimation trees, KDD 2011),
//! grown from half of the rays and pruned with the help of those held out.

use crate::rng::{Dimension, Sampler, stream};

/// Coordinates in the cube, from 0 to 1.
pub(super) type Coordinates = [f64; 4];

/// A ray as a point of the cube.
#[derive(Debug, Clone, Copy)]
pub(super) struct CubeRay {
    pub(super) at: [f32; 4],
    pub(super) flux: f32,
    /// Not used to choose splits, but to choose how many of them are kept.
    pub(super) is_held_out: bool,
}

/// A box of the cube.
#[derive(Debug, Clone, Copy)]
pub(super) struct CubeBox {
    pub(super) from: Coordinates,
    pub(super) to: Coordinates,
    /// The parts of box n are 2n and 2n + 1, without what overflows.
    number: u64,
}

/// A split across one axis, into a lower and an upper part; a part that is not split further is a leaf.
#[derive(Debug, Clone)]
pub(super) struct BoxSplit {
    pub(super) axis: usize,
    pub(super) at: f64,
    /// For each penalty, whether it is kept.
    is_kept: [bool; PENALTIES.len()],
    pub(super) parts: [Option<Box<BoxSplit>>; 2],
}

/// Sums over rays.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FluxSums {
    pub(super) flux: f64,
    pub(super) squares: f64,
    pub(super) rays: usize,
}

/// Of a box that is split as each penalty has it, relative to a cube of even light.
#[derive(Debug, Clone, Copy)]
struct PruningScores {
    /// -∫ f² and the penalty, for the density f of the rays that choose splits.
    cost: [f64; PENALTIES.len()],
    /// ∫ f² - 2 Σ f over the rays held out: the integrated squared error but for a constant.
    risk: [f64; PENALTIES.len()],
}

/// Penalties on leaves, in units of the variance of their share over their volume. 2 makes the cost of given leaves the expectation of
/// the risk; leaves chosen by the same rays need more. The rays held out find the penalty of least risk of a tree.
const PENALTIES: [f64; 10] = [1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0];
/// Candidates for a split along each axis, evenly spaced and shifted at random.
const CANDIDATES: usize = 16;
/// A box with fewer rays is not split.
const FEWEST: usize = 8;
/// The narrowest side of a box that is split: the coordinates of rays are in single precision.
const NARROWEST: f64 = 1.0 / (1 << 18) as f64;
/// Chi-square, with one degree of freedom, from which on two parts of a box differ significantly: p = 1/2000 for one of the 64 candidates.
const SIGNIFICANT: f64 = 12.0;
/// Boxes with more rays are split on several threads.
const MANY: usize = 10_000;

/// What all boxes of a tree share.
#[derive(Debug)]
struct TreeBuilder {
    /// Number of the tree: each has candidates of its own, so that borders are smooth in the mean of trees.
    tree: u64,
    /// All rays that choose splits.
    own: FluxSums,
    /// Those held out.
    held_out: FluxSums,
}

/// Splits the cube for some rays; `None` if their light is even.
pub(super) fn split_cube(rays: &mut [CubeRay], tree: u64) -> Option<Box<BoxSplit>> {
    let [own, held_out] = FluxSums::of_both(rays);
    let (split, scores) = TreeBuilder { tree, own, held_out }.grow(rays, &CubeBox::WHOLE);
    let best = (1..PENALTIES.len())
        .fold(0, |best, other| if scores.risk[other] < scores.risk[best] { other } else { best });
    // Sampling noise averages out over the many leaves that a sensor sees; what is smoothed away does not.
    let finer = 0.5 * PENALTIES[best];
    pruned(split, PENALTIES.partition_point(|penalty| *penalty <= finer).saturating_sub(1))
}

/// Without the splits that a penalty does not keep.
fn pruned(split: Option<Box<BoxSplit>>, penalty: usize) -> Option<Box<BoxSplit>> {
    let mut split = split.filter(|split| split.is_kept[penalty])?;
    split.parts = split.parts.map(|part| pruned(part, penalty));
    Some(split)
}

impl TreeBuilder {
    fn grow(&self, rays: &mut [CubeRay], cube: &CubeBox) -> (Option<Box<BoxSplit>>, PruningScores) {
        let [own, held_out] = FluxSums::of_both(rays);
        let leaf = self.scores_of_leaf(own, held_out, cube);
        let chosen = (own.rays >= FEWEST).then(|| self.choose(rays, cube, own)).flatten();
        let Some((axis, at)) = chosen else { return (None, leaf) };
        let [below, above] = cube.split(axis, at);
        let (lower, upper) = partition(rays, axis, at);
        let (lower, upper) = if lower.len().max(upper.len()) > MANY {
            rayon::join(|| self.grow(lower, &below), || self.grow(upper, &above))
        } else {
            (self.grow(lower, &below), self.grow(upper, &above))
        };
        let mut scores = leaf;
        let mut is_kept = [false; PENALTIES.len()];
        for (penalty, is_kept) in is_kept.iter_mut().enumerate() {
            let cost = lower.1.cost[penalty] + upper.1.cost[penalty];
            if cost < leaf.cost[penalty] {
                *is_kept = true;
                scores.cost[penalty] = cost;
                scores.risk[penalty] = lower.1.risk[penalty] + upper.1.risk[penalty];
            }
        }
        let split = BoxSplit { axis, at, is_kept, parts: [lower.0, upper.0] };
        (is_kept.contains(&true).then(|| Box::new(split)), scores)
    }

    fn scores_of_leaf(&self, own: FluxSums, held_out: FluxSums, cube: &CubeBox) -> PruningScores {
        let over = |part: f64, all: f64| if all > 0.0 { part / all } else { 0.0 };
        let share = over(own.flux, self.own.flux);
        let variance = over(own.squares, self.own.flux.powi(2));
        let of_others = over(held_out.flux, self.held_out.flux);
        let volume = cube.volume();
        PruningScores {
            cost: PENALTIES.map(|penalty| (penalty * variance - share * share) / volume),
            risk: [share * (share - 2.0 * of_others) / volume; PENALTIES.len()],
        }
    }

    /// The axis and the place of a split: where the parts differ most, or, if they do not differ significantly, near the middle of the longest side,
    /// as a density that depends on several coordinates at once may look even along each. `None` for a box that is too narrow.
    fn choose(&self, rays: &[CubeRay], cube: &CubeBox, own: FluxSums) -> Option<(usize, f64)> {
        let mut sampler = Sampler::for_path(self.tree, stream::SPLITS, cube.number);
        let shift = 0.25 + 0.5 * sampler.one(Dimension::Resampling);
        let mut histograms = [[0.0; CANDIDATES + 1]; 4];
        for ray in rays.iter().filter(|ray| !ray.is_held_out) {
            for (axis, histogram) in histograms.iter_mut().enumerate() {
                let bin = cube.within(axis, ray.at[axis]) * CANDIDATES as f64 + 1.0 - shift;
                histogram[(bin as usize).min(CANDIDATES)] += f64::from(ray.flux);
            }
        }
        let mut best = (SIGNIFICANT, None);
        for (axis, histogram) in histograms.iter().enumerate() {
            if cube.side(axis) < NARROWEST {
                continue;
            }
            let mut below = 0.0;
            for (candidate, flux) in histogram[..CANDIDATES].iter().enumerate() {
                below += flux;
                let even = (candidate as f64 + shift) / CANDIDATES as f64;
                let share = below / own.flux;
                let square = own.count() * (share - even).powi(2) / (even * (1.0 - even));
                if square > best.0 {
                    best = (square, Some((axis, even)));
                }
            }
        }
        let longest = || {
            let longer = |best, axis| if cube.side(axis) > cube.side(best) { axis } else { best };
            let longest = (1..4).fold(0, longer);
            let near_middle = 0.25 + 0.5 * sampler.one(Dimension::Resampling);
            (cube.side(longest) >= NARROWEST).then_some((longest, near_middle))
        };
        let (axis, within) = best.1.or_else(longest)?;
        Some((axis, cube.from[axis] + within * cube.side(axis)))
    }
}

/// Sorts rays into those below and those from a place on.
pub(super) fn partition(
    rays: &mut [CubeRay],
    axis: usize,
    at: f64,
) -> (&mut [CubeRay], &mut [CubeRay]) {
    let mut below = 0;
    for place in 0..rays.len() {
        if f64::from(rays[place].at[axis]) < at {
            rays.swap(below, place);
            below += 1;
        }
    }
    rays.split_at_mut(below)
}

impl CubeBox {
    pub(super) const WHOLE: Self = Self { from: [0.0; 4], to: [1.0; 4], number: 1 };

    pub(super) fn volume(&self) -> f64 {
        (0..4).map(|axis| self.side(axis)).product()
    }

    fn side(&self, axis: usize) -> f64 {
        self.to[axis] - self.from[axis]
    }

    /// Where in its side a coordinate lies, 0 to 1.
    fn within(&self, axis: usize, at: f32) -> f64 {
        (f64::from(at) - self.from[axis]) / self.side(axis)
    }

    pub(super) fn split(&self, axis: usize, at: f64) -> [Self; 2] {
        let (mut below, mut above) = (*self, *self);
        below.to[axis] = at;
        above.from[axis] = at;
        below.number = self.number.wrapping_mul(2);
        above.number = below.number.wrapping_add(1);
        [below, above]
    }
}

impl FluxSums {
    pub(super) fn add(&mut self, ray: &CubeRay) {
        let flux = f64::from(ray.flux);
        self.flux += flux;
        self.squares += flux * flux;
        self.rays += 1;
    }

    /// Over the rays that choose splits, and over those held out.
    fn of_both(rays: &[CubeRay]) -> [Self; 2] {
        let mut sums = [Self::default(); 2];
        rays.iter().for_each(|ray| sums[usize::from(ray.is_held_out)].add(ray));
        sums
    }

    /// Effective number of rays, as of `RaySet`.
    fn count(&self) -> f64 {
        if self.squares > 0.0 { self.flux * self.flux / self.squares } else { 0.0 }
    }
}
